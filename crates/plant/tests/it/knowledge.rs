//! Priors, and how probable conditions are, against enumeration of all states of random plants (SPEC3 17.4, 17.5).

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use num_rational::BigRational;
use num_traits::{One as _, Zero as _};
use plant::{
    Belief, ComponentId, Effort, FactoredBelief, Formula, Group, Interval, Known, Model, Observation, Random,
    SimulatedPlant, Situation, State, compile, draw_initial, groups, update_bounded,
};

fn compiled(text: &str) -> (Option<Model>, Vec<&'static str>) {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    let (model, found) = compile(&parsed.file);
    let codes = found.iter().map(|found| found.code.0).filter(|code| *code != "W-UNREACHABLE");
    (model, codes.collect())
}

fn model(text: &str) -> Model {
    let (model, found) = compiled(text);
    assert!(found.iter().all(|code| !code.starts_with("E-")), "{text}: {found:?}");
    model.expect("a model")
}

fn ratio(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

const PUMP: &str = "(DEFCLASS Pump () (MODE Off true) (MODE Idle true) (MODE On true))";

/// The probabilities of all states by modes.
fn told(belief: &Belief) -> BTreeMap<Vec<u8>, String> {
    belief.states().map(|(state, probability)| (state.0.clone(), probability.to_string())).collect()
}

#[test]
fn a_component_starts_in_the_modes_of_its_prior() {
    for (init, expected) in [
        ("", vec![(0, "1")]),
        ("INIT Idle", vec![(1, "1")]),
        ("INIT Off 0.9 Idle 0.1", vec![(0, "9/10"), (1, "1/10")]),
        ("INIT On 1/2 Off 1/3 Idle 1/6", vec![(0, "1/3"), (1, "1/6"), (2, "1/2")]),
        ("INIT *", vec![(0, "1/3"), (1, "1/3"), (2, "1/3")]),
    ] {
        let model = model(&format!("{PUMP} (DEFINSTANCE P Pump {init})"));
        let belief = Belief::initial(&model, 10).expect("possible");
        let expected = expected.into_iter().map(|(mode, probability)| (vec![mode], probability.to_owned()));
        assert_eq!(told(&belief), expected.collect(), "{init}");
        assert!(belief.is_exact());
    }
}

/// A switch that is on exactly if its feed is: their modes speak of each other.
const TIED: &str = "(DEFCLASS Feed () (VAR out {no yes}) (MODE Dead (out = no)) (MODE Live (out = yes)))
(DEFCLASS Lamp () (PORT feed Feed) (MODE Dark (feed.out = no)) (MODE Lit (feed.out = yes)) (MODE Broken true))";

#[test]
fn only_modes_that_can_hold_together_share_the_prior() {
    let model = model(&format!(
        "{TIED} (DEFINSTANCE F Feed INIT Dead 0.4 Live 0.6) (DEFINSTANCE L Lamp (feed F) INIT Dark 1/2 Lit 1/4 Broken 1/4)"
    ));
    // Weights: Dead Dark 0.2, Dead Broken 0.1, Live Lit 0.15, Live Broken 0.15; 0.6 in all.
    let belief = Belief::initial(&model, 10).expect("possible");
    let expected = [([0, 0], "1/3"), ([0, 2], "1/6"), ([1, 1], "1/4"), ([1, 2], "1/4")];
    let expected = expected.into_iter().map(|(state, probability)| (state.to_vec(), probability.to_owned()));
    assert_eq!(told(&belief), expected.collect());
    // The likeliest mode of the feed by itself is not that of the likeliest state.
    assert_eq!((belief.most_likely().0.as_slice(), model.initial_state().0[0]), (&[0, 0][..], 1));
}

#[test]
fn a_prior_of_modes_that_all_contradict_each_other_is_refused() {
    let text = format!("{TIED} (DEFINSTANCE F Feed INIT Dead) (DEFINSTANCE L Lamp (feed F) INIT Lit)");
    assert_eq!(compiled(&text).1, [""; 0], "modes that are named alone are taken as they are");
    let text = format!(
        "{TIED} (DEFCLASS Half (Lamp) (MODE Broken (feed.out = yes)))
        (DEFINSTANCE F Feed INIT Dead) (DEFINSTANCE L Half (feed F) INIT Lit 0.5 Broken 0.5)"
    );
    let (model, found) = compiled(&text);
    assert_eq!((model.is_none(), found), (true, vec!["E-CONSTRAINT"]));
    let (_, found) = compiled(&format!("{PUMP} (DEFINSTANCE P Pump INIT Off 0.5 Odd 0.5)"));
    assert_eq!(found, ["E-UNDEF"]);
}

#[test]
fn what_is_cut_of_a_large_prior_is_within_the_interval() {
    let mut text = format!("(DEFCLASS Bus () (MODE On true)) {PUMP} (DEFCLASS Tied (Pump) (PORT bus Bus))");
    text.push_str("(DEFINSTANCE B Bus)");
    for at in 0..12 {
        let _ = writeln!(text, "(DEFINSTANCE P{at} Tied (bus B) INIT Off 0.9 Idle 0.1)");
    }
    let model = model(&text);
    for most in [1, 13, 200, 5000] {
        let belief = Belief::initial(&model, most).expect("possible");
        assert!(belief.len() <= most);
        assert_eq!(belief.is_exact(), most == 5000);
        let bounds = belief.highest_probability();
        assert!(bounds.contains(&num_traits::pow(ratio(9, 10), 12)), "{most}: {bounds}");
        let off = belief.marginal(&model, ComponentId(3)).swap_remove(0);
        assert!(off.contains(&ratio(9, 10)), "{most}: {off}");
    }
}

#[test]
fn a_state_is_found_where_all_that_were_kept_lead_nowhere() {
    // The likeliest modes of the feeds leave the last component none of its own.
    let mut text = String::from(
        "(DEFCLASS Feed () (VAR out {no yes}) (MODE Dead (out = no)) (MODE Live (out = yes)))
        (DEFCLASS Sum () (PORT a Feed) (PORT b Feed) (PORT c Feed)
          (MODE Ok ((a.out = yes) AND (b.out = yes) AND (c.out = yes))))",
    );
    for name in ["A", "B", "C"] {
        let _ = writeln!(text, "(DEFINSTANCE {name} Feed INIT Dead 0.9 Live 0.1)");
    }
    text.push_str("(DEFINSTANCE S Sum (a A) (b B) (c C))");
    let model = model(&text);
    let belief = Belief::initial(&model, 2).expect("possible");
    assert_eq!(belief.most_likely(), &State(vec![1, 1, 1, 0]));
    assert!(belief.highest_probability().contains(&BigRational::one()));
}

#[test]
fn a_plant_starts_in_each_state_as_often_as_its_prior_says() {
    let model = model(&format!(
        "{TIED} (DEFINSTANCE F Feed INIT Dead 0.4 Live 0.6) (DEFINSTANCE L Lamp (feed F) INIT Dark 1/2 Lit 1/4 Broken 1/4)"
    ));
    let likeliest = Belief::initial(&model, 10).expect("possible").most_likely().clone();
    let mut random = Random::new(3);
    let mut counts: BTreeMap<Vec<u8>, u32> = BTreeMap::new();
    for _ in 0..6000 {
        *counts.entry(draw_initial(&model, &likeliest, &mut random).0).or_default() += 1;
    }
    for (state, expected) in [([0, 0], 2000), ([0, 2], 1000), ([1, 1], 1500), ([1, 2], 1500)] {
        let found = counts[&state.to_vec()];
        assert!(
            found.abs_diff(expected) < 150,
            "{state:?}: {found} of 6000 draws of seed 3, not about {expected}"
        );
    }
    assert_eq!(counts.len(), 4);
    let certain = self::model(&format!("{PUMP} (DEFINSTANCE P Pump INIT Idle)"));
    let mut untouched = random.clone();
    draw_initial(&certain, &certain.initial_state(), &mut untouched);
    assert_eq!(untouched, random, "what is certain takes no draw");
}

/// Components in several groups, some with constraints that leave values open.
fn random_plant(random: &mut Random) -> String {
    let mut text = String::from(
        "(DEFCLASS Source () (VAR out {no low yes}) (VAR lamp {dark lit} OBSERVABLE) (COMMAND cmd {none stop})
          (MODE On ((out = low) OR (out = yes))) (MODE Off ((out = no) AND (lamp = dark)))
          (MODE Odd (((out = no) AND (lamp = lit)) OR ((out = yes) AND (lamp = dark))))
          (TRANSITION On Off (cmd = stop)) (FAULT On Odd 0.1) (FAULT Off Odd 0.2) (FAULT Odd Off 1/7))
        (DEFCLASS Relay () (PORT feed Source) (VAR out {no yes})
          (MODE Closed (((NOT (feed.out = no)) AND (out = yes)) OR ((feed.out = no) AND (out = no))))
          (MODE Open (out = no)) (MODE Stuck true)
          (FAULT Closed Stuck 0.1) (FAULT Open Closed 0.3))\n",
    );
    let inits = ["", "INIT *", "INIT On 0.7 Off 0.3", "INIT Odd 1/5 On 4/5"];
    let relays = ["", "INIT *", "INIT Open 0.6 Stuck 0.4"];
    for at in 0..=random.below(2) {
        let _ = writeln!(text, "(DEFINSTANCE s{at} Source {})", inits[random.below(4) as usize]);
        if random.below(3) > 0 {
            let _ =
                writeln!(text, "(DEFINSTANCE r{at} Relay (feed s{at}) {})", relays[random.below(3) as usize]);
        }
    }
    text
}

fn random_condition(model: &Model, random: &mut Random, depth: u32) -> Formula {
    match if depth == 0 { random.below(2) } else { random.below(5) } {
        0 => {
            let component = random.below(model.components.len() as u64) as usize;
            let modes = model.components[component].modes.len() as u64;
            Model::mode_is(ComponentId(component as u32), random.below(modes) as u8)
        }
        1 => {
            let variable = random.below(model.variables.len() as u64) as usize;
            let values = model.variables[variable].values.len() as u64;
            model.value_is(plant::VariableId(variable as u32), random.below(values) as u8)
        }
        2 => model.opposite(random_condition(model, random, depth - 1)),
        kind => {
            let parts =
                (0..2 + random.below(2)).map(|_| random_condition(model, random, depth - 1)).collect();
            if kind == 3 { Formula::All(parts) } else { Formula::Any(parts) }
        }
    }
}

/// Returns whether a formula is true under values of modes and variables.
fn is_true(model: &Model, condition: &Formula, state: &State, values: &[u8]) -> bool {
    match condition {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => {
            let at = *symbol as usize;
            let value = state.0.get(at).copied().unwrap_or_else(|| values[at - model.components.len()]);
            set.contains(value)
        }
        Formula::All(parts) => parts.iter().all(|part| is_true(model, part, state, values)),
        Formula::Any(parts) => parts.iter().any(|part| is_true(model, part, state, values)),
    }
}

/// Returns whether a condition holds in a state, by trying all values of all variables.
fn is_entailed(model: &Model, condition: &Formula, state: &State, observation: &Observation) -> bool {
    let counts: Vec<u64> = model.variables.iter().map(|variable| variable.values.len() as u64).collect();
    (0..counts.iter().product::<u64>()).all(|number| {
        let mut rest = number;
        let values: Vec<u8> = counts
            .iter()
            .map(|count| {
                let value = rest % count;
                rest /= count;
                value as u8
            })
            .collect();
        let is_seen = observation.0.iter().all(|(id, value)| values[id.0 as usize] == *value);
        let agrees = model.components.iter().zip(&state.0).all(|(component, mode)| {
            is_true(model, &component.modes[usize::from(*mode)].constraint, state, &values)
        });
        !is_seen || !agrees || is_true(model, condition, state, &values)
    })
}

#[test]
fn the_probability_of_a_condition_is_that_of_the_states_that_entail_it() {
    let (mut compared, mut undecided, mut several) = (0, 0, 0);
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let model = model(&random_plant(&mut random));
        let parts = groups(&model);
        let exact = FactoredBelief::initial(&parts, 1000);
        assert!(exact.is_exact());
        let start = draw_initial(&model, exact.most_likely(), &mut random);
        let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), Some(start));
        let idle = model.idle();
        if plant.step_with_chance(&idle, &BTreeMap::new(), &mut random).is_err() {
            continue;
        }
        let observation = plant.observation();
        let update = |belief: &FactoredBelief, most: usize| -> Option<FactoredBelief> {
            let each = parts.iter().zip(belief.beliefs()).map(|(part, belief)| {
                let seen = part.observation(&observation);
                let update = update_bounded(
                    &part.model,
                    belief,
                    &part.commands(&idle),
                    &seen,
                    most,
                    Effort::AsNeeded,
                    &|_| true,
                );
                update.expect("deterministic").belief.map(Arc::new)
            });
            Some(FactoredBelief::new(&parts, each.collect::<Option<_>>()?))
        };
        let exact = update(&exact, 1000).expect("the plant shows what a state explains");
        let Some(cut) = update(&FactoredBelief::initial(&parts, 2), 2) else { continue };
        for number in 0..12 {
            let condition = random_condition(&model, &mut random, 3);
            let holding =
                exact.states().filter(|(state, _)| is_entailed(&model, &condition, state, &observation));
            let truth = holding.fold(BigRational::zero(), |sum, (_, probability)| sum + probability.low);
            let about = format!("seed {seed}, condition {number}: {condition:?}");
            for (state, _) in exact.states() {
                assert_eq!(
                    Situation::new(&model, &state, &observation).entails(&condition),
                    is_entailed(&model, &condition, &state, &observation),
                    "{about}, {state:?}"
                );
            }
            let known = |belief| Known { groups: &parts, belief, observation: &observation };
            assert_eq!(known(&exact).probability(&condition), Interval::certain(truth.clone()), "{about}");
            let bounds = known(&cut).probability(&condition);
            assert!(bounds.contains(&truth), "{about}: {bounds} without {truth}");
            let without = exact.states().map(|(state, _)| state);
            let mut without = without.filter(|state| !is_entailed(&model, &condition, state, &observation));
            let found = known(&exact).likeliest_without(&model, std::slice::from_ref(&condition));
            assert_eq!(found, without.next(), "{about}");
            compared += 1;
            undecided += u32::from(bounds.exact().is_none());
            several += u32::from(known(&exact).groups_of(&condition).len() > 1);
        }
    }
    assert!(compared > 500 && undecided > 100 && several > 100, "{compared} {undecided} {several}");
}

/// Valves that nothing ties together, each worn with a probability of one half.
fn apart(count: usize) -> (Model, Vec<Group>) {
    let mut text = String::from("(DEFCLASS Valve () (MODE Ok true) (MODE Worn true))");
    for at in 0..count {
        let _ = writeln!(text, "(DEFINSTANCE V{at} Valve INIT *)");
    }
    let model = model(&text);
    let parts = groups(&model);
    (model, parts)
}

#[test]
fn a_condition_about_many_groups_takes_no_product_of_their_states() {
    let (model, parts) = apart(60);
    let belief = FactoredBelief::initial(&parts, 10);
    let observation = Observation::default();
    let known = Known { groups: &parts, belief: &belief, observation: &observation };
    let all = Formula::All(model.component_ids().map(|id| Model::mode_is(id, 0)).collect());
    assert_eq!(known.probability(&all), Interval::certain(num_traits::pow(ratio(1, 2), 60)));
    let none = model.opposite(Formula::Any(model.component_ids().map(|id| Model::mode_is(id, 0)).collect()));
    assert_eq!(known.probability(&none), Interval::certain(num_traits::pow(ratio(1, 2), 60)));
}
