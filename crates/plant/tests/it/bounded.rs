//! Bounded estimates against exact inference on random plants: the truth lies within what is printed, always.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::sync::Arc;

use num_rational::BigRational;
use num_traits::{One as _, Signed as _, ToPrimitive as _, Zero as _};
use plant::bounded::MAX_STATES;
use plant::{
    Belief, Commands, ComponentId, Effort, FactoredBelief, Interval, Model, Observation, Random,
    SimulatedPlant, State, compile, groups, probability, update_bounded, update_exact,
};

fn model(text: &str) -> Model {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    let (model, diagnostics) = compile(&parsed.file);
    assert!(
        diagnostics.iter().all(|found| found.severity != rmpl::Severity::Error),
        "{text}: {diagnostics:?}"
    );
    model.expect("a model")
}

/// Up to twelve components that may fail, some fed by others, some of which rule out modes of what feeds them. Some sensors show
/// wrong values, some commands have two outcomes, and some faults have guards.
fn random_plant(random: &mut Random) -> String {
    let mut text = String::from(
        "(DEFCLASS Source () (VAR out {no yes}) (VAR lamp {dark lit} OBSERVABLE) (COMMAND cmd {none stop go})
          (MODE On (out = yes)) (MODE Off ((out = no) AND (lamp = dark))) (MODE Dead (out = no))
          (TRANSITION On Off (cmd = stop)) (TRANSITION Off On (cmd = go))
          (FAULT On Dead 0.03) (FAULT Off Dead 1/50) (FAULT On Off 0.1))\n",
    );
    let count = 2 + random.below(11);
    for at in 0..count {
        if at == 0 || random.below(3) == 0 {
            let _ =
                writeln!(text, "(DEFINSTANCE c{at} Source INIT {})", ["On", "Off"][random.below(2) as usize]);
            let _ = writeln!(text, "; {at} is a source");
            continue;
        }
        let sources: Vec<u64> =
            (0..at).filter(|other| text.contains(&format!("; {other} is a source"))).collect();
        let feed = sources[random.below(sources.len() as u64) as usize];
        let observed = ["", "", " OBSERVABLE", " OBSERVABLE ERROR 0.05"][random.below(4) as usize];
        let outcomes = [
            "(TRANSITION Closed Open (cmd = open))",
            "(TRANSITION Closed Open (cmd = open)) (TRANSITION Closed Stuck (cmd = open) 0.2)",
        ][random.below(2) as usize];
        let fault =
            ["(FAULT Open Stuck 0.05)", "(FAULT Open Stuck 0.05 (feed.out = yes))"][random.below(2) as usize];
        let stuck = ["true", "(out = no)", "(NOT (feed = Dead))"][random.below(3) as usize];
        let chance = ["0.1", "1/7", "0.02"][random.below(3) as usize];
        let _ = writeln!(
            text,
            "(DEFCLASS Relay{at} () (PORT feed Source) (VAR out {{no yes}}{observed}) (COMMAND cmd {{none open close}})
              (MODE Closed (((feed.out = yes) AND (out = yes)) OR ((feed.out = no) AND (out = no))))
              (MODE Open (out = no)) (MODE Stuck {stuck})
              {outcomes} (TRANSITION Open Closed ((cmd = close) AND (feed = On)))
              (FAULT Closed Stuck {chance}) {fault} (FAULT Closed Open 0.04))
            (DEFINSTANCE c{at} Relay{at} (feed c{feed}))"
        );
    }
    text
}

/// The probability of each mode of each component, from exact beliefs.
fn exact_marginals(model: &Model, belief: &Belief) -> Vec<Vec<BigRational>> {
    let exact = |interval: Interval| interval.exact().expect("nothing was dropped").clone();
    model.component_ids().map(|id| belief.marginal(model, id).into_iter().map(exact).collect()).collect()
}

/// A limit as it is printed.
fn printed(interval: &Interval) -> Interval {
    let limit = |text: String| probability::parse_exact(&text).expect("a number");
    if let Some(exact) = interval.exact() {
        return Interval::certain(exact.clone());
    }
    let (low, high) = interval.decimals();
    Interval { low: limit(low), high: limit(high) }
}

/// What was compared.
#[derive(Default)]
struct Comparison {
    plants: u32,
    compared: u64,
    inexact: u64,
    /// Of the inexact ones, how many contain the truth.
    within: u64,
    /// The most by which the middle of one differs from the truth.
    deviation: BigRational,
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { plants, compared, inexact, within, .. } = self;
        let deviation = self.deviation.to_f64().unwrap_or(f64::NAN);
        let share = 100.0 * *within as f64 / (*inexact).max(1) as f64;
        write!(f, "| {plants} | {compared} | {inexact} | {share:.1}% | {deviation:.4} |")
    }
}

impl Comparison {
    fn take(&mut self, about: &str, bounds: &Interval, truth: &BigRational) {
        let bounds = printed(bounds);
        self.compared += 1;
        if bounds.exact().is_none() {
            self.inexact += 1;
            self.within += u64::from(bounds.contains(truth));
        }
        assert!(bounds.contains(truth), "{about}: {bounds} without {truth}");
        let middle = (&bounds.low + &bounds.high) / BigRational::from_integer(2.into());
        self.deviation = (middle - truth).abs().max(self.deviation.clone());
    }
}

/// The bounded estimates of a plant with at most `most` states for each group, and the exact ones of the whole plant.
fn compare(seed: u64, most: usize, steps: u32, comparisons: &mut [Comparison; 3]) {
    let mut random = Random::new(seed);
    let model = model(&random_plant(&mut random));
    let comparison = &mut comparisons[model.component_ids().count().saturating_sub(1) / 4];
    let parts = groups(&model);
    let mut plant = SimulatedPlant::new(&Arc::new(model.clone()), None);
    let start = State(plant.state().0.clone());
    let mut exact: Vec<Belief> = parts.iter().map(|part| Belief::certain(part.state(&start))).collect();
    let mut bounded: Vec<Arc<Belief>> = exact.iter().cloned().map(Arc::new).collect();
    comparison.plants += 1;
    for step in 0..steps {
        let commands = random_commands(&model, &mut random);
        if plant.step_with_chance(&commands, &BTreeMap::new(), &mut random).is_err() {
            return;
        }
        let observation = random_observation(&plant, &mut random);
        for (at, part) in parts.iter().enumerate() {
            let about = format!("seed {seed}, {most} states, step {step}, group {at}");
            let (commands, seen) = (part.commands(&commands), part.observation(&observation));
            // Groups that exact inference cannot follow are not tested.
            let Ok(next) = update_exact(&part.model, &exact[at], &commands, &seen) else { return };
            exact[at] = next;
            let update =
                update_bounded(&part.model, &bounded[at], &commands, &seen, most, Effort::AsNeeded, &|_| {
                    true
                })
                .expect("deterministic");
            let Some(belief) = update.belief else {
                assert!(update.is_open, "{about}: refuted, though a state explains it");
                return;
            };
            let truths = exact_marginals(&part.model, &exact[at]);
            for (id, truths) in part.model.component_ids().zip(truths) {
                for (bounds, truth) in belief.marginal(&part.model, id).iter().zip(&truths) {
                    comparison.take(&about, bounds, truth);
                }
            }
            bounded[at] = Arc::new(belief);
        }
        let whole = FactoredBelief::new(&parts, bounded.clone());
        for (state, bounds) in whole.states().take(3) {
            let truth = parts.iter().zip(&exact).fold(BigRational::one(), |truth, (part, exact)| {
                let own = part.state(&state);
                let found = exact.states().find(|(state, _)| **state == own);
                truth * found.map_or_else(BigRational::zero, |(_, interval)| interval.low)
            });
            comparison.take(&format!("seed {seed}, {most} states, step {step}, whole"), &bounds, &truth);
        }
    }
}

fn random_commands(model: &Model, random: &mut Random) -> Commands {
    let mut commands = model.idle();
    for (value, variable) in commands.0.iter_mut().zip(&model.command_variables) {
        if random.below(3) == 0 {
            *value = random.below(variable.values.len() as u64) as u8;
        }
    }
    commands
}

fn random_observation(plant: &SimulatedPlant, random: &mut Random) -> Observation {
    let mut observation = plant.observation();
    observation.0.retain(|_, _| random.below(4) > 0);
    observation
}

#[test]
#[expect(clippy::print_stdout, reason = "the table is part of the evidence")]
fn the_truth_lies_within_the_printed_interval_of_random_plants() {
    let mut comparisons = <[Comparison; 3]>::default();
    for seed in 0..120 {
        // Few states are kept in most plants, so that much is dropped.
        compare(seed, [2, 5, 20, MAX_STATES][seed as usize % 4], 4, &mut comparisons);
    }
    println!("| components | plants | probabilities | intervals | with the truth | largest deviation |");
    println!("|---|---|---|---|---|---|");
    for (components, comparison) in ["2 to 4", "5 to 8", "9 to 12"].iter().zip(&comparisons) {
        println!("| {components} {comparison}");
        assert_eq!(comparison.within, comparison.inexact, "{components} {comparison}");
        assert!(comparison.inexact > 200, "much is dropped: {components} {comparison}");
    }
}

/// Components that may fail unseen, tied together by one that none of them affects.
fn tied(count: usize, fault: &str) -> Model {
    let mut text = format!(
        "(DEFCLASS Bus () (MODE On true))
         (DEFCLASS Valve () (PORT bus Bus) (MODE Ok true) (MODE Worn true) (MODE Stuck true)
           (FAULT Ok Worn {fault}) (FAULT Ok Stuck {fault}))
         (DEFINSTANCE Main Bus)\n"
    );
    for at in 0..count {
        let _ = writeln!(text, "(DEFINSTANCE V{at} Valve (bus Main))");
    }
    model(&text)
}

#[test]
fn what_is_dropped_of_many_unseen_failures_is_within_the_interval() {
    let model = tied(11, "0.02");
    assert_eq!(groups(&model).len(), 1, "a port ties them");
    let mut belief = Belief::certain(model.initial_state());
    let nominal = BigRational::new(24.into(), 25.into());
    for step in 1..=3 {
        let update = update_bounded(
            &model,
            &belief,
            &model.idle(),
            &Observation::default(),
            MAX_STATES,
            Effort::AsNeeded,
            &|_| true,
        );
        belief = update.expect("deterministic").belief.expect("nothing is observed");
        let bounds = belief.marginal(&model, ComponentId(1)).swap_remove(0);
        let truth = num_traits::pow(nominal.clone(), step);
        assert!(bounds.contains(&truth), "step {step}: {bounds} without {truth}");
        let all_ok = belief.highest_probability();
        assert!(all_ok.contains(&num_traits::pow(nominal.clone(), 11 * step)), "step {step}: {all_ok}");
    }
}

#[test]
fn components_that_nothing_ties_are_estimated_apart() {
    let mut text = String::from(
        "(DEFCLASS Valve () (MODE Ok true) (MODE Worn true) (MODE Stuck true) (FAULT Ok Worn 0.02) (FAULT Ok Stuck 0.02))",
    );
    for at in 0..300 {
        let _ = writeln!(text, "(DEFINSTANCE V{at} Valve INIT Ok)");
    }
    let model = model(&text);
    let parts = groups(&model);
    assert_eq!(parts.len(), 300);
    let one = update_exact(
        &parts[7].model,
        &Belief::certain(State(vec![0])),
        &Commands(Vec::new()),
        &Observation::default(),
    );
    let one = Arc::new(one.expect("nothing is observed"));
    let whole = FactoredBelief::new(&parts, vec![one; 300]);
    let nominal = BigRational::new(24.into(), 25.into());
    assert_eq!(whole.highest_probability().exact(), Some(&num_traits::pow(nominal.clone(), 300)));
    assert_eq!(whole.marginal(&model, ComponentId(299))[0].exact(), Some(&nominal));
    assert_eq!(whole.len(), usize::MAX);
    let states: Vec<(State, Interval)> = whole.states().take(4).collect();
    assert_eq!(states[0].0, model.initial_state());
    // Equally likely states come in the order of their modes: the last component differs first.
    assert_eq!((states[1].0.0[299], states[2].0.0[299], states[3].0.0[298]), (1, 2, 1));
}

#[test]
fn an_interval_is_as_wide_as_what_was_dropped() {
    let model = model(
        "(DEFCLASS Valve () (MODE Ok true) (MODE Stuck true) (FAULT Ok Stuck 0.1)) (DEFINSTANCE V Valve INIT Ok)",
    );
    let start = Belief::certain(model.initial_state());
    let update =
        update_bounded(&model, &start, &model.idle(), &Observation::default(), 1, Effort::AsNeeded, &|_| {
            true
        });
    let belief = update.expect("deterministic").belief.expect("nothing is observed");
    let nine_tenths = BigRational::new(9.into(), 10.into());
    assert_eq!(belief.highest_probability(), Interval { low: nine_tenths, high: BigRational::one() });
}
