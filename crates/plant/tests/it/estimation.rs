//! Belief updates: the engine of the paper, and random models against enumeration of all states.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use num_rational::BigRational;
use num_traits::Zero as _;
use plant::{Belief, Interval, Model, Random, State, compile, conflicts, update_best, update_exact};
use serde_json::Value;

const ENGINE: &str = "(DEFCLASS Engine ()
  (VAR thrust {zero full} OBSERVABLE) (VAR power_in {zero nominal} OBSERVABLE)
  (COMMAND cmd {none off standby fire})
  (MODE Off     ((thrust = zero) AND (power_in = zero)))
  (MODE Standby ((thrust = zero) AND (power_in = nominal)))
  (MODE Firing  ((thrust = full) AND (power_in = nominal)))
  (MODE Failed  true)
  (TRANSITION Off Standby (cmd = standby)) (TRANSITION Standby Firing (cmd = fire))
  (TRANSITION Firing Standby (cmd = standby)) (TRANSITION Standby Off (cmd = off))
  (FAULT Standby Failed 0.01) (FAULT Firing Failed 0.01))
(DEFINSTANCE E Engine INIT Off)";

pub(crate) fn model(text: &str) -> Model {
    let parsed = rmpl::control::parse(text);
    assert_eq!(parsed.diagnostics, [], "{text}");
    let (model, mut diagnostics) = compile(&parsed.file);
    // Small plants have modes for a test to start in.
    diagnostics.retain(|found| found.code.0 != "W-UNREACHABLE");
    assert_eq!(diagnostics, [], "{text}");
    model.expect("a model")
}

fn pairs(value: &Value) -> Vec<(&str, &str)> {
    value
        .as_object()
        .into_iter()
        .flatten()
        .filter_map(|(name, value)| Some((name.as_str(), value.as_str()?)))
        .collect()
}

#[test]
fn the_engine_is_believed_to_be_where_the_suite_says() {
    let model = model(ENGINE);
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance");
    let case: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("p01_engine_update.json")).expect("case"))
            .expect("JSON");
    let cases = case["expect"].as_array().expect("updates");
    assert_eq!(cases.len(), 8);
    for update in cases {
        let prior = pairs(&update["prior"]).into_iter().map(|(mode, probability)| {
            (
                model.state_from_names([("E", mode)]).expect("mode"),
                plant::probability::parse_exact(probability).expect("fraction"),
            )
        });
        let prior = Belief::from_probabilities(prior).expect("prior");
        let commands = model
            .commands_from_names(update["command"].as_str().map(|command| ("E", command)))
            .expect("command");
        let observed: Vec<(String, &str)> =
            pairs(&update["obs"]).into_iter().map(|(name, value)| (format!("E.{name}"), value)).collect();
        let observation = model
            .observation_from_names(observed.iter().map(|(name, value)| (name.as_str(), *value)))
            .expect("observation");
        let expected: BTreeMap<String, String> = pairs(&update["posterior"])
            .into_iter()
            .map(|(mode, value)| (mode.to_owned(), value.to_owned()))
            .collect();
        for posterior in [
            update_exact(&model, &prior, &commands, &observation).expect("update"),
            update_best(&model, &prior, &commands, &observation, usize::MAX, 1000).expect("update").0,
        ] {
            let found: BTreeMap<String, String> = posterior
                .states()
                .map(|(state, probability)| (model.state_names(state)["E"].clone(), probability.to_string()))
                .collect();
            assert_eq!(found, expected, "{update}");
        }
    }
}

/// Components in a chain or tree, some of which pass on what comes in, with observed ends and random faults.
pub(crate) fn random_model(random: &mut Random) -> String {
    let mut text = String::from(
        "(DEFCLASS Source () (VAR out {no yes}) (COMMAND cmd {none stop go})
          (MODE On (out = yes)) (MODE Off (out = no)) (MODE Dead (out = no))
          (TRANSITION On Off (cmd = stop)) (TRANSITION Off On (cmd = go)) (FAULT On Dead 0.02) (FAULT Off Dead 1/50))\n",
    );
    let count = 2 + random.below(3);
    let chances = ["0.1", "1/7", "0.03"];
    text.push_str("(DEFINSTANCE c0 Source)\n");
    for at in 1..=count {
        let before = random.below(at);
        let observed = if random.below(3) > 0 { " OBSERVABLE" } else { "" };
        let chance = chances[random.below(3) as usize];
        let class = if before == 0 { "Source" } else { &format!("Relay{before}") };
        let good = if before == 0 { "On" } else { "Closed" };
        let worst = if before == 0 { "Dead" } else { "Stuck" };
        // The last two ask for the mode of another component: nested deeper than a table, and ruling modes out together.
        let stuck = match random.below(4) {
            0 => "true".to_owned(),
            1 => "(out = no)".to_owned(),
            2 => format!(
                "(((feed = {good}) AND (out = no)) OR ((NOT (feed = {good})) AND ((lamp = odd) OR (out = yes))))"
            ),
            _ => format!("(NOT (feed = {worst}))"),
        };
        text.push_str(&format!(
            "(DEFCLASS Relay{at} () (PORT feed {class}) (VAR out {{no yes}}{observed}) (VAR lamp {{dark lit odd}} OBSERVABLE) (COMMAND cmd {{none open close}})
              (MODE Closed (((feed.out = yes) AND (out = yes) AND (lamp = lit)) OR ((feed.out = no) AND (out = no) AND (lamp = dark))))
              (MODE Open ((out = no) AND (NOT (lamp = lit))))
              (MODE Stuck {stuck})
              (TRANSITION Closed Open (cmd = open)) (TRANSITION Open Closed ((cmd = close) AND (feed = {good})))
              (FAULT Closed Stuck {chance}) (FAULT Open Stuck 0.05))
            (DEFINSTANCE c{at} Relay{at} (feed c{before}))\n"
        ));
    }
    text
}

fn known(probability: &Interval) -> BigRational {
    probability.exact().expect("nothing was dropped").clone()
}

/// Bayes by hand: all predecessors, all successors, all observations, with nothing of the library's inference.
fn by_enumeration(
    model: &Model,
    prior: &[(State, BigRational)],
    commands: &plant::Commands,
    observation: &plant::Observation,
) -> BTreeMap<State, BigRational> {
    let counts: Vec<u8> = model.components.iter().map(|component| component.modes.len() as u8).collect();
    // Modes that contradict each other cannot occur: successors are taken among the others.
    let possible: Vec<(State, std::collections::BTreeSet<Vec<u8>>)> = assignments(&counts)
        .into_iter()
        .map(|modes| {
            let admitted = admitted_observations(model, &modes, observation);
            (State(modes), admitted)
        })
        .filter(|(_, admitted)| !admitted.is_empty())
        .collect();
    let mut posterior: BTreeMap<State, BigRational> = BTreeMap::new();
    let observed: Vec<u8> = observation.0.values().copied().collect();
    for (before, weight) in prior {
        let chances: Vec<BigRational> =
            possible.iter().map(|(after, _)| chance(model, before, after, commands)).collect();
        let all: BigRational = chances.iter().sum();
        for ((after, admitted), chance) in possible.iter().zip(&chances) {
            if admitted.contains(&observed) && !chance.is_zero() {
                let likelihood = BigRational::new(1.into(), admitted.len().into());
                *posterior.entry(after.clone()).or_insert_with(BigRational::zero) +=
                    weight * chance / &all * likelihood;
            }
        }
    }
    let total: BigRational = posterior.values().sum();
    for value in posterior.values_mut() {
        *value /= &total;
    }
    posterior
}

/// Returns how likely all components are to move from their modes to those of `after`, each by itself.
fn chance(model: &Model, before: &State, after: &State, commands: &plant::Commands) -> BigRational {
    let mut product = BigRational::from_integer(1.into());
    for (at, component) in model.components.iter().enumerate() {
        let mode = &component.modes[before.0[at] as usize];
        let target =
            plant::successor(model, plant::ComponentId(at as u32), before, commands).expect("deterministic");
        let mut chance = BigRational::zero();
        let mut left = BigRational::from_integer(1.into());
        for fault in &mode.faults {
            let probability = BigRational::new(fault.numerator.into(), mode.denominator.into());
            left -= &probability;
            if fault.to == after.0[at] {
                chance += probability;
            }
        }
        if target == after.0[at] {
            chance += left;
        }
        product *= chance;
    }
    product
}

pub(crate) fn assignments(counts: &[u8]) -> Vec<Vec<u8>> {
    counts.iter().fold(vec![Vec::new()], |all, count| {
        all.iter()
            .flat_map(|left: &Vec<u8>| {
                (0..*count).map(move |value| left.iter().copied().chain([value]).collect())
            })
            .collect()
    })
}

/// The values of the observed variables that some assignment to all variables allows.
pub(crate) fn admitted_observations(
    model: &Model,
    state: &[u8],
    observation: &plant::Observation,
) -> std::collections::BTreeSet<Vec<u8>> {
    let counts: Vec<u8> = model.variables.iter().map(|variable| variable.values.len() as u8).collect();
    assignments(&counts)
        .into_iter()
        .filter(|values| {
            let symbols: Vec<u8> = state.iter().chain(values).copied().collect();
            model
                .components
                .iter()
                .zip(state)
                .all(|(component, mode)| holds(&component.modes[*mode as usize].constraint, &symbols))
        })
        .map(|values| observation.0.keys().map(|variable| values[variable.0 as usize]).collect())
        .collect()
}

fn holds(formula: &plant::formula::Formula, symbols: &[u8]) -> bool {
    use plant::formula::Formula;
    match formula {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => set.contains(symbols[*symbol as usize]),
        Formula::All(parts) => parts.iter().all(|part| holds(part, symbols)),
        Formula::Any(parts) => parts.iter().any(|part| holds(part, symbols)),
    }
}

#[test]
fn exact_and_best_first_estimates_are_those_of_enumeration_on_random_models() {
    let mut updates = 0;
    for seed in 0..25 {
        let mut random = Random::new(seed);
        let text = random_model(&mut random);
        let model = model(&text);
        let mut plant = plant::SimulatedPlant::new(&Arc::new(model.clone()), None);
        let mut belief = Belief::certain(model.initial_state());
        for step in 0..3 {
            let mut commands = model.idle();
            for (value, variable) in commands.0.iter_mut().zip(&model.command_variables) {
                if random.below(3) == 0 {
                    *value = random.below(variable.values.len() as u64) as u8;
                }
            }
            plant.step_with_chance(&commands, &BTreeMap::new(), &mut random).expect("step");
            let mut observation = plant.observation();
            // Some readings are missing.
            observation.0.retain(|_, _| random.below(5) > 0);
            let prior: Vec<(State, BigRational)> =
                belief.states().map(|(state, probability)| (state.clone(), known(&probability))).collect();
            let expected = by_enumeration(&model, &prior, &commands, &observation);
            let exact = update_exact(&model, &belief, &commands, &observation).expect("update");
            let found: BTreeMap<State, BigRational> =
                exact.states().map(|(state, value)| (state.clone(), known(&value))).collect();
            assert_eq!(found, expected, "seed {seed} step {step}");
            let (all, _) =
                update_best(&model, &belief, &commands, &observation, usize::MAX, 1_000_000).expect("update");
            assert_eq!(all, exact, "seed {seed} step {step}: unbounded");
            for most in [1, 2, 5] {
                let (best, _) =
                    update_best(&model, &belief, &commands, &observation, most, 1_000_000).expect("update");
                let about = format!("seed {seed} step {step}: {most} best");
                assert_eq!(best.len(), most.min(exact.len()), "{about}");
                for ((state, bounds), (expected, probability)) in best.states().zip(exact.states()) {
                    assert_eq!(state, expected, "{about}");
                    assert!(bounds.contains(&known(&probability)), "{about}: {bounds} without {probability}");
                }
            }
            updates += 1;
            belief = exact;
        }
    }
    assert_eq!(updates, 75);
}

#[test]
fn a_diagnosis_names_every_minimal_conflict() {
    let model = model(
        "(DEFCLASS Buffer () (VAR in {0 1}) (VAR out {0 1} OBSERVABLE)
           (MODE Good (((in = 0) AND (out = 0)) OR ((in = 1) AND (out = 1)))) (MODE Bad true) (FAULT Good Bad 0.1))
         (DEFCLASS Next () (PORT from Buffer) (VAR out {0 1} OBSERVABLE)
           (MODE Good (((from.out = 0) AND (out = 0)) OR ((from.out = 1) AND (out = 1)))) (MODE Bad true) (FAULT Good Bad 0.1))
         (DEFCLASS High (Buffer) (MODE Good (in = 1)))
         (DEFINSTANCE a High) (DEFINSTANCE b Next (from a)) (DEFINSTANCE c Next (from a))",
    );
    let observation = model.observation_from_names([("b.out", "0"), ("c.out", "1")]).expect("names");
    let found =
        conflicts(&model, &model.initial_state(), &model.idle(), &observation, 10).expect("deterministic");
    let words: Vec<String> = found.iter().map(|conflict| conflict.describe(&model)).collect();
    assert_eq!(
        words,
        ["a=Good and b=Good contradict b.out=0", "b=Good and c=Good contradict b.out=0 and c.out=1"]
    );
}

#[test]
fn fifty_components_are_estimated_best_first() {
    let mut text = String::from(ENGINE.split("(DEFINSTANCE").next().expect("class"));
    for at in 0..50 {
        text.push_str(&format!("(DEFINSTANCE E{at} Engine INIT Standby)\n"));
    }
    let model = model(&text);
    let plant = plant::SimulatedPlant::new(&Arc::new(model.clone()), None);
    let observation = plant.observation();
    let mut belief = Belief::certain(model.initial_state());
    for _ in 0..3 {
        let (next, statistics) =
            update_best(&model, &belief, &model.idle(), &observation, 10, 100_000).expect("update");
        assert!(!statistics.limit_reached);
        assert_eq!(next.len(), 10);
        assert_eq!(next.most_likely(), &model.initial_state());
        belief = next;
    }
}
