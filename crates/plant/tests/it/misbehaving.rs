//! Outcomes, guarded faults, sensors with errors and equality, against enumeration by the specification's sentences (9.1).

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::Arc;

use num_rational::BigRational;
use num_traits::{One as _, Zero as _};
use plant::{
    Belief, ComponentId, Effort, Formula, Interval, Model, Observation, Planner, Random, SimulatedPlant,
    State, compile, update_best, update_bounded, update_exact,
};

use crate::estimation::{assignments, model};

fn ratio(numerator: u64, denominator: u64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

/// The codes and messages of what is wrong with a text.
fn found(text: &str) -> Vec<(&'static str, String)> {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    let found = compile(&parsed.file).1.into_iter().filter(|found| found.code.0 != "W-UNREACHABLE");
    found.map(|found| (found.code.0, found.message)).collect()
}

/// Returns where one component goes in a step from a mode, by names.
fn moves(text: &str, from: &str, commands: &[(&str, &str)]) -> BTreeMap<String, String> {
    let model = model(text);
    let name = model.components[0].name.to_string();
    let start = Belief::certain(model.state_from_names([(name.as_str(), from)]).expect("a mode"));
    let commands = model.commands_from_names(commands.iter().copied()).expect("commands");
    let next = update_exact(&model, &start, &commands, &Observation::default()).expect("an update");
    let named = next.states().map(|(state, probability)| {
        (model.mode_name(ComponentId(0), state.0[0]).to_owned(), probability.to_string())
    });
    named.collect()
}

fn named(expected: &[(&str, &str)]) -> BTreeMap<String, String> {
    expected.iter().map(|(mode, probability)| ((*mode).to_owned(), (*probability).to_owned())).collect()
}

const VALVE: &str = "(DEFCLASS Valve () (COMMAND cmd {none open close reset})
  (MODE Closed true) (MODE Open true) (MODE Ajar true) (MODE Stuck true)
  (TRANSITION Closed Open (cmd = open)) (TRANSITION Closed Ajar (cmd = open) 0.1)
  (TRANSITION Closed Stuck (NOT (NOT (cmd = open))) 0.02)
  (TRANSITION Open Closed (cmd = close) 0.9)
  (TRANSITION * Closed (cmd = reset) 1/2)
  (FAULT Closed Stuck 0.1 (cmd = open)) (FAULT * Stuck 0.2))
(DEFINSTANCE V Valve)";

#[test]
fn outcomes_of_one_guard_share_what_faults_leave() {
    // A fault that names the mode keeps the one written with `*` away, whether or not it is possible.
    assert_eq!(
        moves(VALVE, "Closed", &[("V", "open")]),
        named(&[("Open", "99/125"), ("Ajar", "9/100"), ("Stuck", "59/500")])
    );
    assert_eq!(moves(VALVE, "Closed", &[]), named(&[("Closed", "1")]));
    // Without an outcome that has the rest, the rest stays.
    assert_eq!(
        moves(VALVE, "Open", &[("V", "close")]),
        named(&[("Closed", "18/25"), ("Open", "2/25"), ("Stuck", "1/5")])
    );
    assert_eq!(
        moves(VALVE, "Ajar", &[("V", "reset")]),
        named(&[("Closed", "2/5"), ("Ajar", "2/5"), ("Stuck", "1/5")])
    );
    // The fault leads to all modes but its own.
    assert_eq!(moves(VALVE, "Stuck", &[]), named(&[("Stuck", "1")]));
}

#[test]
fn a_transition_from_all_modes_gives_way_where_one_that_names_the_mode_is_enabled() {
    let text = "(DEFCLASS V () (COMMAND cmd {none go stop}) (COMMAND arm {none yes})
      (MODE A true) (MODE B true) (MODE C true)
      (TRANSITION A B ((cmd = stop) AND (arm = yes))) (TRANSITION * C (cmd = stop)))
    (DEFINSTANCE v V)";
    assert_eq!(moves(text, "A", &[("v.cmd", "stop")]), named(&[("C", "1")]));
    assert_eq!(moves(text, "A", &[("v.cmd", "stop"), ("v.arm", "yes")]), named(&[("B", "1")]));
    assert_eq!(moves(text, "B", &[("v.cmd", "stop"), ("v.arm", "yes")]), named(&[("C", "1")]));
}

#[test]
fn what_is_written_for_all_modes_is_inherited_mode_by_mode() {
    let text = "(DEFCLASS Base () (COMMAND cmd {none go}) (MODE A true) (MODE B true) (FAULT * B 0.1))
    (DEFCLASS Special (Base) (MODE C true) (FAULT A B 0.3) (FAULT C B 0.4))
    (DEFINSTANCE s Special)";
    assert_eq!(moves(text, "A", &[]), named(&[("A", "7/10"), ("B", "3/10")]));
    assert_eq!(moves(text, "C", &[]), named(&[("C", "3/5"), ("B", "2/5")]));
    let text = "(DEFCLASS Base () (MODE A true) (MODE B true) (FAULT A B 0.1))
    (DEFCLASS Special (Base) (MODE C true) (FAULT * B 0.3)) (DEFINSTANCE s Special)";
    assert_eq!(moves(text, "A", &[]), named(&[("A", "7/10"), ("B", "3/10")]), "the special class wins");
    assert_eq!(moves(text, "C", &[]), named(&[("C", "7/10"), ("B", "3/10")]));
}

#[test]
fn faults_between_two_modes_with_different_guards_add_up() {
    let text = "(DEFCLASS V () (COMMAND cmd {none go}) (COMMAND heat {none on})
      (MODE A true) (MODE B true)
      (FAULT A B 0.1) (FAULT A B 0.2 (heat = on)) (FAULT A B 0.3 (cmd = go)))
    (DEFINSTANCE v V)";
    for (commands, expected) in [
        (vec![], "1/10"),
        (vec![("v.heat", "on")], "3/10"),
        (vec![("v.cmd", "go")], "2/5"),
        (vec![("v.cmd", "go"), ("v.heat", "on")], "3/5"),
    ] {
        assert_eq!(moves(text, "A", &commands)["B"], expected, "{commands:?}");
    }
}

#[test]
fn the_planner_and_the_plant_without_chance_take_the_likeliest_outcome_that_leaves_the_mode() {
    let text = "(DEFCLASS V () (COMMAND cmd {none go}) (MODE A true) (MODE B true) (MODE C true)
      (TRANSITION A B (cmd = go) 0.2) (TRANSITION A C (cmd = go) 0.3)) (DEFINSTANCE v V)";
    let model = model(text);
    let goal = |mode: &str| {
        let (component, mode) = model.component_mode("v", mode).expect("a mode");
        plant::Goal::mode(component, mode)
    };
    let planner = Planner::new(&Arc::new(model.clone()));
    assert_eq!(planner.reconfigure(&model.initial_state(), &[goal("C")]).expect("a plan").steps.len(), 1);
    assert!(planner.reconfigure(&model.initial_state(), &[goal("B")]).is_err());
    let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), None);
    let go = model.commands_from_names([("v", "go")]).expect("a command");
    plant.step(&go, &BTreeMap::new()).expect("a step");
    assert_eq!(model.mode_name(ComponentId(0), plant.state().0[0]), "C");
}

const ABC: &str = "(COMMAND cmd {none go}) (COMMAND arm {no yes}) (VAR v {x y}) (MODE A (v = x)) (MODE B true) (MODE C true)";

#[test]
fn transitions_that_are_enabled_together_are_ambiguous_and_the_message_shows_when() {
    for (arcs, expected) in [
        (
            "(TRANSITION A B (cmd = go)) (TRANSITION A C (cmd = go))",
            "from `A`, one guard leads to `B` and to `C`, both without a probability, where V.cmd=go",
        ),
        (
            "(TRANSITION A B (cmd = go)) (TRANSITION A C (arm = yes))",
            "from `A`, the transitions to `B` and to `C` are both enabled where V.cmd=go, V.arm=yes, V.v=x",
        ),
        (
            "(TRANSITION A B (cmd = go) 0.5) (TRANSITION A B ((cmd = go) AND (arm = yes)) 0.6)",
            "from `A`, the transitions to `B` and to `B` are both enabled where V.cmd=go, V.arm=yes, V.v=x",
        ),
        (
            "(TRANSITION * B true) (TRANSITION C B (v = y)) (TRANSITION A C (v = x)) (TRANSITION A B (NOT (v = y)))",
            "from `A`, one guard leads to `C` and to `B`, both without a probability, where V.v=x",
        ),
    ] {
        for instance in ["", "(DEFINSTANCE V V)"] {
            let found = found(&format!("(DEFCLASS V () {ABC} {arcs}) {instance}"));
            assert_eq!(found, [("E-AMBIGUOUS", expected.to_owned())], "{arcs}");
        }
    }
    for arcs in [
        // The constraint of the mode rules one of them out.
        "(TRANSITION A B (cmd = go)) (TRANSITION A C ((cmd = go) AND (v = y)))",
        "(TRANSITION A B (cmd = go)) (TRANSITION A B (arm = yes))",
        "(TRANSITION A B (cmd = go) 0.5) (TRANSITION A B (arm = yes) 1/2)",
        "(TRANSITION A B ((cmd = go) AND (arm = yes)) 0.5) (TRANSITION A C ((arm = yes) AND (cmd = go)) 0.5)",
        "(TRANSITION * B (cmd = go)) (TRANSITION A C (cmd = go))",
    ] {
        assert_eq!(found(&format!("(DEFCLASS V () {ABC} {arcs})")), [], "{arcs}");
    }
}

#[test]
fn probabilities_of_a_model_are_checked() {
    for arcs in [
        "(FAULT A B 0)",
        "(FAULT A B 1.5)",
        "(FAULT * B often)",
        "(TRANSITION A B (cmd = go) 0)",
        "(TRANSITION A B (cmd = go) 2)",
        "(VAR w {x y} OBSERVABLE ERROR 0)",
        "(TRANSITION A B (cmd = go) 0.6) (TRANSITION A C (cmd = go) 0.6)",
        "(FAULT A B 0.6) (FAULT A C 0.6)",
        "(FAULT A B 0.6 (cmd = go)) (FAULT A C 0.6 (arm = yes))",
        "(FAULT A B 1/999999999999999989) (FAULT A C 1/999999999999999967)",
    ] {
        for instance in ["", "(DEFINSTANCE V V)"] {
            let found = found(&format!("(DEFCLASS V () {ABC} {arcs}) {instance}"));
            assert_eq!(
                found.iter().map(|(code, _)| *code).collect::<Vec<_>>(),
                ["E-PROBABILITY"],
                "{arcs}: {found:?}"
            );
        }
    }
    let together =
        found(&format!("(DEFCLASS V () {ABC} (FAULT A B 0.6 (cmd = go)) (FAULT A C 0.6 (arm = yes)))"));
    assert_eq!(
        together[0].1,
        "the probabilities of the faults of `A` must sum to at most 1, but exceed 1 where V.cmd=go, V.arm=yes, V.v=x"
    );
    let apart = "(FAULT A B 0.6 (cmd = go)) (FAULT A C 0.6 (cmd = none)) (FAULT A C 0.6 (v = y))";
    assert_eq!(found(&format!("(DEFCLASS V () {ABC} {apart})")), []);
}

#[test]
fn equality_holds_between_variables_of_one_domain_only() {
    let class = "(DEFCLASS Feed () (VAR out {no yes odd}) (MODE Off (out = no)) (MODE On (out = yes)))";
    for (constraint, code) in [
        ("(feed.out = in)", None),
        ("(NOT (in = feed.out))", None),
        ("(a = b)", None),
        ("(in = lamp)", Some("E-VALUE")),
        ("(in = other)", Some("E-VALUE")),
        ("(in = cmd)", Some("E-CONSTRAINT")),
    ] {
        let found = found(&format!(
            "{class} (DEFCLASS R () (PORT feed Feed) (PORT a Feed) (PORT b Feed) (VAR in {{odd no yes}}) (VAR lamp {{no yes}})
               (COMMAND cmd {{no yes odd}}) (MODE M {constraint}))"
        ));
        assert_eq!(found.first().map(|(code, _)| *code), code, "{constraint}: {found:?}");
    }
    // A guard may compare a command, and two modes.
    let text = format!(
        "{class} (DEFCLASS R () (PORT a Feed) (PORT b Feed) (COMMAND cmd {{no yes odd}}) (COMMAND want {{no yes odd}})
           (MODE M true) (MODE N true) (TRANSITION M N ((cmd = a.out) AND (NOT (a = b)) AND (cmd = want))))
         (DEFINSTANCE r R (a f) (b g)) (DEFINSTANCE f Feed INIT On) (DEFINSTANCE g Feed)"
    );
    assert_eq!(moves(&text, "M", &[("r.cmd", "yes"), ("r.want", "yes")]), named(&[("N", "1")]));
    assert_eq!(moves(&text, "M", &[("r.cmd", "yes")]), named(&[("M", "1")]));
    assert_eq!(moves(&text, "M", &[]), named(&[("M", "1")]));
}

#[test]
fn a_sensor_with_errors_weighs_states_and_excludes_none() {
    let text = "(DEFCLASS Lamp () (VAR light {dark dim lit} OBSERVABLE ERROR 0.2)
      (MODE Ok (light = lit)) (MODE Weak (NOT (light = dark))) (MODE Broken (light = dark)))
    (DEFINSTANCE L Lamp INIT *)";
    let model = model(text);
    let prior = Belief::initial(&model, 10).expect("a prior");
    for (seen, expected) in [
        // Weak is dim or lit, each with one half: 0.8 / 2 + 0.1 / 2.
        ("lit", [("Ok", "16/27"), ("Weak", "1/3"), ("Broken", "2/27")]),
        ("dark", [("Ok", "1/10"), ("Weak", "1/10"), ("Broken", "4/5")]),
    ] {
        let observation = model.observation_from_names([("L.light", seen)]).expect("a value");
        let updated = update_exact(&model, &prior, &model.idle(), &observation).expect("an update");
        let told = updated.states().map(|(state, probability)| {
            (model.mode_name(ComponentId(0), state.0[0]).to_owned(), probability.to_string())
        });
        assert_eq!(told.collect::<BTreeMap<_, _>>(), named(&expected), "{seen}");
        // What is observed with errors is not known.
        let state = State(vec![1]);
        let lit = model.value_is(plant::VariableId(0), 2);
        assert!(!plant::Situation::new(&model, &state, &observation).entails(&lit));
    }
    // A sensor that is always wrong tells what is not.
    let wrong = self::model(&text.replace("0.2", "1"));
    let observation = wrong.observation_from_names([("L.light", "dark")]).expect("a value");
    let updated = update_exact(&wrong, &prior, &wrong.idle(), &observation).expect("an update");
    assert!(updated.states().all(|(state, _)| wrong.mode_name(ComponentId(0), state.0[0]) != "Broken"));
}

#[test]
fn the_simulated_plant_moves_and_shows_as_often_as_its_model_says() {
    let text = "(DEFCLASS Lamp () (VAR a {0 1} OBSERVABLE) (VAR b {0 1 2} OBSERVABLE ERROR 0.3) (VAR c {0 1} OBSERVABLE SHOWS 1)
      (COMMAND cmd {none go})
      (MODE Off ((a = 0) AND (b = 0) AND (c = 0))) (MODE On ((a = 0) OR (b = 0)))
      (TRANSITION Off On (cmd = go) 0.75) (FAULT Off On 0.2 (cmd = none)))
    (DEFINSTANCE L Lamp)";
    let model = Arc::new(model(text));
    let mut random = Random::new(11);
    let mut counts: BTreeMap<(u8, Vec<u8>), f64> = BTreeMap::new();
    let runs = 40_000;
    for run in 0..runs {
        let commands = model.commands_from_names((run % 2 == 0).then_some(("L", "go"))).expect("a command");
        let mut plant = SimulatedPlant::new(&model, None);
        plant.step_with_chance(&commands, &BTreeMap::new(), &mut random).expect("a step");
        let shown = plant.observation_with_chance(&mut random).0.into_values().collect();
        *counts.entry((plant.state().0[0], shown)).or_default() += 1.0 / f64::from(runs);
    }
    // On in 0.75 or 0.2 of the runs; then a, b in 00 01 02 10 with c as it says, and b with an error.
    let on = f64::midpoint(0.75, 0.2);
    let (right, wrong) = (0.7, 0.15);
    for (mode, a, b, expected) in [
        (0, 0, 0, (1.0 - on) * right),
        (0, 0, 1, (1.0 - on) * wrong),
        (1, 0, 0, on * (right + 2.0 * wrong) / 4.0),
        (1, 1, 0, on * right / 4.0),
        (1, 1, 2, on * wrong / 4.0),
    ] {
        let found = counts.get(&(mode, vec![a, b, mode])).copied().unwrap_or_default();
        assert!(
            (found - expected).abs() < 0.01,
            "{mode} {a} {b}: {found} instead of {expected} with seed 11"
        );
    }
}

/// Components in a chain or tree with everything that can go wrong.
fn random_plant(random: &mut Random) -> String {
    let mut text = String::from(
        "(DEFCLASS Source () (VAR out {no yes}) (COMMAND cmd {none stop go})
          (MODE On (out = yes)) (MODE Off (out = no)) (MODE Dead (out = no))
          (TRANSITION On Off (cmd = stop) 0.8) (TRANSITION Off On (cmd = go)) (TRANSITION Off Dead (cmd = go) 1/9)
          (FAULT * Dead 0.02) (FAULT On Dead 1/5 (cmd = go)) (FAULT On Off 0.1))
        (DEFINSTANCE c0 Source)\n",
    );
    for at in 1..=1 + random.below(2) {
        let before = random.below(at);
        let (class, good) =
            if before == 0 { ("Source".to_owned(), "On") } else { (format!("Relay{before}"), "Closed") };
        let error = ["", " ERROR 0.1", " ERROR 3/7", " ERROR 1"][random.below(4) as usize];
        let seen = ["", " OBSERVABLE", " OBSERVABLE ERROR 1/20"][random.below(3) as usize];
        let stuck =
            ["true", "(NOT (out = feed.out))", "((out = no) OR (lamp = odd))"][random.below(3) as usize];
        let asked =
            [format!("(feed = {good})"), "(feed.out = yes)".to_owned()][random.below(2) as usize].clone();
        let _ = writeln!(
            text,
            "(DEFCLASS Relay{at} () (PORT feed {class}) (VAR out {{yes no}}{seen}) (VAR lamp {{dark lit odd}} OBSERVABLE{error})
              (COMMAND cmd {{none open close}})
              (MODE Closed ((feed.out = out) AND (((out = yes) AND (lamp = lit)) OR ((out = no) AND (lamp = dark)))))
              (MODE Open ((out = no) AND (NOT (lamp = lit))))
              (MODE Stuck {stuck})
              (TRANSITION Closed Open (cmd = open) 0.7) (TRANSITION Closed Stuck (cmd = open) 0.1)
              (TRANSITION Open Closed ((cmd = close) AND {asked}))
              (TRANSITION * Stuck ((cmd = close) AND (NOT {asked})) 0.25)
              (FAULT Closed Stuck 1/7) (FAULT Closed Stuck 0.3 {asked}) (FAULT * Open 0.05 (cmd = close)))
            (DEFINSTANCE c{at} Relay{at} (feed c{before}))"
        );
    }
    text
}

/// All values of all variables with which the modes of a state hold together.
fn worlds(model: &Model, state: &[u8]) -> Vec<Vec<u8>> {
    let counts: Vec<u8> = model.variables.iter().map(|variable| variable.values.len() as u8).collect();
    let holds = |values: &Vec<u8>| {
        let parts = model.components.iter().zip(state);
        parts.clone().all(|(component, mode)| {
            is_true(&component.modes[usize::from(*mode)].constraint, state, values, &[])
        })
    };
    assignments(&counts).into_iter().filter(holds).collect()
}

fn is_true(formula: &Formula, state: &[u8], values: &[u8], commands: &[u8]) -> bool {
    let all = |parts: &[Formula]| -> Vec<bool> {
        parts.iter().map(|part| is_true(part, state, values, commands)).collect()
    };
    match formula {
        Formula::Constant(value) => *value,
        Formula::All(parts) => !all(parts).contains(&false),
        Formula::Any(parts) => all(parts).contains(&true),
        Formula::Member { symbol, set } => {
            let symbols: Vec<u8> = state.iter().chain(values).chain(commands).copied().collect();
            set.contains(symbols[*symbol as usize])
        }
    }
}

/// Returns how likely a component is to move to a mode, by the sentences of the specification.
fn chance(model: &Model, at: usize, before: &[u8], to: u8, commands: &[u8]) -> BigRational {
    let mode = &model.components[at].modes[usize::from(before[at])];
    let worlds = worlds(model, before);
    let holds = |guard: &Formula| worlds.iter().all(|values| is_true(guard, before, values, commands));
    let mut faulty = BigRational::zero();
    let mut sum = BigRational::zero();
    for fault in mode.faults.iter().filter(|fault| holds(&fault.guard)) {
        let probability = ratio(fault.numerator, mode.denominator);
        faulty += &probability;
        if fault.to == to {
            sum += probability;
        }
    }
    let left = BigRational::one() - faulty;
    let enabled: Vec<_> = mode.choices.iter().filter(|choice| holds(&choice.guard)).collect();
    assert!(enabled.len() < 2, "not ambiguous");
    match enabled.first() {
        None if before[at] == to => sum + left,
        None => sum,
        Some(choice) => {
            let of = |(_, weight): &(u8, u64)| ratio(*weight, choice.denominator);
            let share: BigRational = choice.outcomes.iter().filter(|(mode, _)| *mode == to).map(of).sum();
            sum + left * share
        }
    }
}

/// Returns how likely an observation is in a state: true values of what is read are equally likely, and errors come
/// after that.
fn likelihood(model: &Model, state: &[u8], observation: &Observation) -> BigRational {
    let read: std::collections::BTreeSet<Vec<u8>> = worlds(model, state)
        .into_iter()
        .map(|values| observation.0.keys().map(|id| values[id.0 as usize]).collect())
        .collect();
    let count = read.len() as u64;
    let of_one = |values: &Vec<u8>| {
        let each = observation.0.iter().zip(values).map(|((id, seen), value)| {
            let data = &model.variables[id.0 as usize];
            let (part, whole) = data.error.unwrap_or((0, 1));
            let others = data.values.len() as u64 - 1;
            if seen == value { ratio(whole - part, whole) } else { ratio(part, whole * others.max(1)) }
        });
        each.product::<BigRational>()
    };
    let sum: BigRational = read.iter().map(of_one).sum();
    if count == 0 { sum } else { sum / BigRational::from_integer(count.into()) }
}

fn by_enumeration(
    model: &Model,
    prior: &[(State, BigRational)],
    commands: &[u8],
    observation: &Observation,
) -> BTreeMap<State, BigRational> {
    let counts: Vec<u8> = model.components.iter().map(|component| component.modes.len() as u8).collect();
    let possible: Vec<(Vec<u8>, BigRational)> = assignments(&counts)
        .into_iter()
        .filter(|state| !worlds(model, state).is_empty())
        .map(|state| (state.clone(), likelihood(model, &state, observation)))
        .collect();
    let mut posterior: BTreeMap<State, BigRational> = BTreeMap::new();
    for (before, weight) in prior {
        let of = |(after, _): &(Vec<u8>, BigRational)| {
            let each = after.iter().enumerate().map(|(at, to)| chance(model, at, &before.0, *to, commands));
            each.product::<BigRational>()
        };
        let chances: Vec<BigRational> = possible.iter().map(of).collect();
        let all: BigRational = chances.iter().sum();
        for ((after, likelihood), chance) in possible.iter().zip(&chances) {
            let part = weight * chance / &all * likelihood;
            if !part.is_zero() {
                *posterior.entry(State(after.clone())).or_insert_with(BigRational::zero) += part;
            }
        }
    }
    let total: BigRational = posterior.values().sum();
    for value in posterior.values_mut() {
        *value /= &total;
    }
    posterior
}

#[test]
fn estimates_are_those_of_enumeration_whatever_goes_wrong() {
    let (mut updates, mut inexact) = (0, 0);
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let model = model(&random_plant(&mut random));
        let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), None);
        let mut belief = Belief::certain(model.initial_state());
        let mut cut = belief.clone();
        for step in 0..3 {
            let about = format!("seed {seed} step {step}");
            let mut commands = model.idle();
            for (value, variable) in commands.0.iter_mut().zip(&model.command_variables) {
                if random.below(2) == 0 {
                    *value = random.below(variable.values.len() as u64) as u8;
                }
            }
            plant.step_with_chance(&commands, &BTreeMap::new(), &mut random).expect("a step");
            let mut observation = plant.observation_with_chance(&mut random);
            observation.0.retain(|_, _| random.below(5) > 0);
            let known = |probability: Interval| probability.exact().expect("nothing was dropped").clone();
            let prior: Vec<(State, BigRational)> =
                belief.states().map(|(state, probability)| (state.clone(), known(probability))).collect();
            let expected = by_enumeration(&model, &prior, &commands.0, &observation);
            let exact = update_exact(&model, &belief, &commands, &observation).expect("an update");
            let told: BTreeMap<State, BigRational> =
                exact.states().map(|(state, value)| (state.clone(), known(value))).collect();
            assert_eq!(told, expected, "{about}");
            let (all, _) =
                update_best(&model, &belief, &commands, &observation, usize::MAX, 1_000_000).expect("update");
            assert_eq!(all, exact, "{about}: unbounded");
            for most in [1, 3] {
                let (best, _) =
                    update_best(&model, &belief, &commands, &observation, most, 1_000_000).expect("update");
                for ((state, bounds), (expected, probability)) in best.states().zip(exact.states()) {
                    assert_eq!(state, expected, "{about}: {most} best");
                    assert!(bounds.contains(&known(probability)), "{about}: {most} best");
                }
            }
            let update =
                update_bounded(&model, &cut, &commands, &observation, 4, Effort::AsNeeded, &|_| true)
                    .expect("an update");
            let Some(next) = update.belief else {
                assert!(update.is_open, "{about}: refuted, though a state explains it");
                break;
            };
            for id in model.component_ids() {
                for (bounds, truth) in next.marginal(&model, id).iter().zip(exact.marginal(&model, id)) {
                    let truth = known(truth);
                    assert!(bounds.contains(&truth), "{about}: {bounds} without {truth}");
                    inexact += u32::from(bounds.exact().is_none());
                }
            }
            (belief, cut) = (exact, next);
            updates += 1;
        }
    }
    assert!(updates > 80 && inexact > 100, "{updates} updates, {inexact} intervals");
}

#[test]
fn modes_that_nothing_reaches_and_constraints_that_nothing_satisfies_are_reported() {
    let found = |text: &str| -> Vec<(&'static str, String)> {
        let parsed = rmpl::control::parse(text);
        assert_eq!(parsed.diagnostics, [], "{text}");
        compile(&parsed.file).1.into_iter().map(|found| (found.code.0, found.message)).collect()
    };
    let unreachable =
        |mode: &str| ("W-UNREACHABLE", format!("no transition or fault leads a `V` to the mode `{mode}`"));
    let class =
        "(DEFCLASS V () (COMMAND cmd {none go}) (MODE A true) (MODE B true) (MODE C true) (MODE D true)
      (TRANSITION A B (cmd = go)) (FAULT D C 0.1))";
    assert_eq!(found(class), [], "nothing starts anywhere");
    assert_eq!(found(&format!("{class} (DEFINSTANCE v V)")), [unreachable("C"), unreachable("D")]);
    let second = format!("{class} (DEFINSTANCE v V) (DEFINSTANCE w V INIT A 0.5 D 0.5)");
    assert_eq!(found(&second), [], "the second one starts in D");
    for (field, code) in [
        ("(MODE E ((v = x) AND (v = y)))", "E-CONSTRAINT"),
        ("(MODE E false)", "E-CONSTRAINT"),
        ("(TRANSITION A B ((v = x) AND (NOT (v = x))))", "E-CONSTRAINT"),
    ] {
        let text = format!("(DEFCLASS V () (VAR v {{x y}}) (MODE A true) (MODE B true) {field})");
        assert_eq!(found(&text).iter().map(|(code, _)| *code).collect::<Vec<_>>(), [code], "{field}");
    }
    let inherited =
        "(DEFCLASS Base () (VAR v {x y}) (MODE A (v = x))) (DEFCLASS Half (Base) (MODE A (v = y)))";
    assert_eq!(found(inherited).len(), 1, "both constraints hold together");
}

/// What is shown without chance, what chance draws, and what a proof explores rest on one reading of `SHOWS`.
#[test]
fn what_chance_shows_is_among_the_possible_observations() {
    let text = "(DEFCLASS G () (VAR c {0 1} OBSERVABLE) (VAR a {0 1} OBSERVABLE SHOWS 1) (VAR b {0 1} OBSERVABLE SHOWS 1)
          (VAR d {0 1} OBSERVABLE)
          (MODE M ((NOT ((c = 0) AND (a = 1))) AND (NOT ((a = 1) AND (b = 1))))))
        (DEFINSTANCE g G)";
    let model = Arc::new(model(text));
    let plant = SimulatedPlant::new(&model, None);
    let components = model.component_ids().collect();
    let possible = plant::observations(&model, plant.state(), &components, 100).expect("there are few");
    assert_eq!(possible[0], plant.observation());
    assert_eq!(plant::observations(&model, plant.state(), &components, 1), None);
    let mut random = Random::new(3);
    let drawn: BTreeSet<_> = (0..200).map(|_| plant.observation_with_chance(&mut random)).collect();
    assert_eq!(drawn, possible.into_iter().collect());
}
