//! The closed loop of SPEC 9.3: the conformance cases, the failures, stepping back, chance.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use executive::model_based::{
    Options, ProgramTally, Run, RunStatus, StepInput, StepOutcome, StepRecord, System, Trials, run_seed,
    sample, wilson_interval,
};
use plant::Observation;
use serde_json::Value;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).expect(name)
}

fn orbit() -> Arc<System> {
    let compilation = System::compile(&text("h01_orbit_nominal.rmpl"), Some(&text("orbit_plant.rmpl")));
    assert_eq!(compilation.program_diagnostics, []);
    assert_eq!(compilation.model_diagnostics, []);
    compilation.system.expect("compiles")
}

fn input(system: &System, step: u32, faults: &[(u32, &str, &str)]) -> StepInput {
    let mut input = StepInput::default();
    for (at, component, mode) in faults {
        if *at == step {
            let (component, mode) = system.model.component_mode(component, mode).expect("fault");
            input.injected.insert(component, mode);
        }
    }
    input
}

fn run_with(system: &Arc<System>, faults: &[(u32, &str, &str)], most: u32) -> Run {
    let mut run = Run::new(system, Options::default());
    for step in 1..=most {
        if run.is_done() {
            break;
        }
        run.step(&input(system, step, faults)).expect("step");
    }
    run
}

/// The record in the shape of the conformance cases.
fn shown(system: &System, record: &StepRecord) -> BTreeMap<&'static str, Value> {
    let goals: BTreeMap<&str, &str> =
        record.trace.goals.iter().filter_map(|goal| goal.split_once('=')).collect();
    BTreeMap::from([
        ("step", Value::from(record.trace.step)),
        ("marked", Value::from(record.trace.labels.iter().map(ToString::to_string).collect::<Vec<_>>())),
        ("goals", serde_json::to_value(goals).expect("goals")),
        ("commands", serde_json::to_value(system.model.command_names(&record.commands)).expect("commands")),
        (
            "unachievable",
            Value::from(record.unachievable.iter().map(|(goal, _)| goal.to_string()).collect::<Vec<_>>()),
        ),
        (
            "observations",
            serde_json::to_value(system.model.observation_names(&record.observation)).expect("observations"),
        ),
        ("prob", Value::from(record.belief.highest_probability().to_string())),
    ])
}

#[test]
fn every_closed_loop_of_the_suite_is_reproduced() {
    let mut count = 0;
    for entry in std::fs::read_dir(folder()).expect("folder") {
        let path = entry.expect("entry").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("case")).expect("JSON");
        if case["kind"] != "closed-loop" || !case["fault"].is_null() {
            continue;
        }
        count += 1;
        let name = |key: &str| case[key].as_str().expect("file").to_owned();
        let system =
            System::compile(&text(&name("program")), Some(&text(&name("model")))).system.expect("compiles");
        let expected = case["expect"].as_array().expect("steps");
        let run = run_with(&system, &[], expected.len() as u32);
        for (record, expected) in run.records().iter().zip(expected) {
            for (key, value) in shown(&system, record) {
                assert_eq!(value, expected[key], "{} step {} {key}", case["id"], record.trace.step);
            }
            let estimate = system.model.state_names(record.belief.most_likely());
            for (component, mode) in expected["estimate"].as_object().expect("estimate") {
                assert_eq!(Some(estimate[component].as_str()), mode.as_str(), "{} {component}", case["id"]);
            }
        }
        let last = expected.last().expect("last");
        assert_eq!(last["marked"].as_array().map(Vec::len), Some(run.marking().len()));
        assert_eq!(last["step"], run.records().len() as u64 + 1);
    }
    assert!(count >= 1, "the suite has closed loops");
}

#[test]
fn a_failure_hidden_at_step_three_is_found_when_firing_shows_no_thrust() {
    let system = orbit();
    for fails_at in [3, 4] {
        let run = run_with(&system, &[(fails_at, "EngineA", "Failed")], 20);
        let engine = |step: usize| {
            system.model.state_names(run.records()[step - 1].belief.most_likely())["EngineA"].clone()
        };
        assert_eq!(engine(3), "Standby", "the failure shows nothing at step 3");
        assert_eq!(run.records()[2].belief.highest_probability().to_string(), "156816/157609");
        assert_eq!(engine(4), "Failed");
        let marked: Vec<Vec<String>> = run.records()[4..]
            .iter()
            .map(|record| record.trace.labels.iter().map(ToString::to_string).collect())
            .collect();
        assert_eq!(marked, [["assert EngineB=Firing"], ["assert EngineB=Firing"]]);
        assert!(run.is_done());
        let conflicts: Vec<String> =
            run.records()[3].conflicts.iter().map(|conflict| conflict.describe(&system.model)).collect();
        assert_eq!(conflicts, ["EngineA=Firing contradicts EngineA.thrust=zero"]);
    }
}

#[test]
fn a_goal_lost_to_a_failure_is_reported_with_its_reason() {
    let program = "(SEQUENCE (EngineA = Standby) (EngineA = Firing))";
    let system = System::compile(program, Some(&text("orbit_plant.rmpl"))).system.expect("compiles");
    let mut run = Run::new(&system, Options::default());
    let power = system.model.variable_named("EngineA.power_in").expect("variable");
    for step in 1..=4 {
        let mut input = input(&system, step, &[(3, "EngineA", "Failed")]);
        if step == 3 {
            // Power gone at once gives the failure away, which full power would hide.
            input.observed.insert(power, 0);
        }
        run.step(&input).expect("step");
    }
    let lost = &run.records()[3].unachievable;
    assert_eq!(lost.len(), 1);
    assert_eq!(lost[0].0, "EngineA=Firing");
    assert_eq!(lost[0].1, "no commanded transition of `EngineA` leads from Failed to Firing");
    assert!(run.records()[3].commands == system.model.idle(), "nothing is commanded for a lost goal");
}

#[test]
fn an_observation_that_nothing_explains_refutes_the_belief_and_ends_the_run() {
    let system = orbit();
    let power = system.model.variable_named("EngineA.power_in").expect("variable");
    let mut run = Run::new(&system, Options::default());
    run.step(&StepInput::default()).expect("step");
    // From Off no fault leads anywhere: without power the engine cannot be in Standby, and it can be nowhere else.
    let odd = StepInput { observed: BTreeMap::from([(power, 0)]), ..StepInput::default() };
    let record = run.step(&odd).expect("step");
    let conflict = Observation(BTreeMap::from([(power, 0)]));
    assert_eq!(
        record.outcome,
        StepOutcome::Refuted { conflict },
        "nothing else is needed to contradict the plant"
    );
    assert!(record.trace.fired.is_empty() && record.trace.continued.is_empty(), "no transition fires");
    let conflicts: Vec<String> =
        record.conflicts.iter().map(|conflict| conflict.describe(&system.model)).collect();
    assert_eq!(conflicts, ["EngineA=Standby contradicts EngineA.power_in=zero"]);
    let before = &system.model.state_names(record.belief.most_likely())["EngineA"];
    assert_eq!(before, "Off", "the belief is that of the step before");
    assert_eq!(run.status(), RunStatus::Refuted);
    assert!(run.step(&StepInput::default()).is_err(), "no step follows");
    assert!(run.step_back() && run.status() == RunStatus::Running);
}

#[test]
fn contradicting_and_impossible_goals_are_reported_and_the_others_still_pursued() {
    let text = "(PARALLEL (EngineA = Standby) (EngineA = Firing) (EngineB = Failed) (Camera = Off) false)";
    let system = System::compile(text, Some(&self::text("orbit_plant.rmpl"))).system.expect("compiles");
    let run = run_with(&system, &[], 1);
    let record = &run.records()[0];
    let goals: Vec<&str> = record.unachievable.iter().map(|(goal, _)| goal.as_str()).collect();
    assert_eq!(goals, ["EngineA=Firing", "EngineA=Standby", "EngineB=Failed", "false"]);
    assert!(record.unachievable[0].1.contains("inconsistent"), "{:?}", record.unachievable);
    assert_eq!(record.unachievable[2].1, "no commanded transition of `EngineB` leads from Off to Failed");
    let commands = system.model.command_names(&record.commands);
    assert_eq!(commands, BTreeMap::from([("Camera".to_owned(), "turn-off".to_owned())]));
}

#[test]
fn program_variables_end_a_trap_in_the_loop_and_a_misspelled_component_is_no_program_variable() {
    let plant = text("orbit_plant.rmpl");
    let trap = "(DO-WATCHING (exit = true) (PARALLEL (ALWAYS true) (WHEN-DONEXT (Camera = Off) (exit = true)) (Camera = Off)))";
    let system = System::compile(trap, Some(&plant)).system.expect("compiles");
    let run = run_with(&system, &[], 10);
    assert!(run.is_done());
    assert_eq!(run.records().len(), 2);
    let wrong = System::compile("(PARALLEL (Camra = Off) (Camera = Of))", Some(&plant));
    let found: Vec<(&str, Option<&str>)> = wrong
        .program_diagnostics
        .iter()
        .map(|diagnostic| (diagnostic.code.0, diagnostic.hint.as_deref()))
        .collect();
    assert_eq!(
        found,
        [("E-UNDEF", Some("did you mean `Camera`?")), ("E-VALUE", Some("did you mean `Off`?"))]
    );
}

#[test]
fn goals_over_plant_variables_and_disjunctions_choose_modes_that_ensure_them() {
    let text = "(PARALLEL (EngineA.power_in = nominal) ((EngineB = Failed) OR (EngineB = Standby)) (NOT (Camera = On)))";
    let system = System::compile(text, Some(&self::text("orbit_plant.rmpl"))).system.expect("compiles");
    let run = run_with(&system, &[], 10);
    assert!(run.is_done());
    let state = system.model.state_names(run.true_state());
    assert_eq!(
        (state["EngineA"].as_str(), state["EngineB"].as_str(), state["Camera"].as_str()),
        ("Standby", "Standby", "Off")
    );
}

#[test]
fn stepping_back_and_replaying_the_log_give_the_same_run() {
    let system = orbit();
    let options = Options { seed: Some(7), ..Options::default() };
    let mut run = Run::new(&system, options);
    for _ in 0..4 {
        run.step(&StepInput::default()).expect("step");
    }
    let records = run.records().to_vec();
    run.jump(2).expect("jump");
    assert_eq!(run.records(), &records[..1]);
    run.jump(5).expect("jump");
    assert_eq!(run.records(), records);
    let again = Run::replay(&system, options, &run.log()).expect("replay");
    assert_eq!(again.records(), records);
}

#[test]
fn chance_ends_orbit_insertion_as_often_as_the_engines_allow() {
    let system = orbit();
    let result = tally(&system, &BTreeMap::new(), 0..400);
    assert_eq!(result.runs, 400);
    // Both engines have to fail: in about four steps at one in a hundred each that is roughly one run in a thousand.
    assert!(result.probability() > 0.97, "{result:?}");
    let (low, high) = result.interval();
    assert!(low < result.probability() && result.probability() <= high + 1e-12);
    assert_eq!(tally(&system, &BTreeMap::new(), 0..400), result, "seeded");
}

fn tally(
    system: &Arc<System>,
    inputs: &BTreeMap<u32, StepInput>,
    numbers: std::ops::Range<u64>,
) -> ProgramTally {
    let trials = Trials { options: Options::default(), seed: 11, most_steps: 30, inputs };
    sample(system, &trials, numbers, &mut || true).expect("runs")
}

#[test]
fn runs_that_are_shared_out_add_up_to_the_same() {
    let system = orbit();
    let mut sum = tally(&system, &BTreeMap::new(), 250..400);
    sum.merge(&tally(&system, &BTreeMap::new(), 0..250));
    assert_eq!(sum, tally(&system, &BTreeMap::new(), 0..400));
}

#[test]
fn a_run_that_got_stuck_is_made_again_from_its_seed() {
    let system = orbit();
    // With engine A failed, the end hangs on engine B alone.
    let inputs: BTreeMap<u32, StepInput> =
        [(3, input(&system, 3, &[(3, "EngineA", "Failed")]))].into_iter().collect();
    let result = tally(&system, &inputs, 0..400);
    let faults = result.faults["EngineB=Failed"];
    assert!(result.reached < 400 && faults.runs > 0, "{result:?}");
    assert_eq!(400 - result.reached, faults.runs - faults.reached, "only engine B keeps it from its end");
    assert!(!result.faults.contains_key("EngineA=Failed"), "that was no chance");
    let number = result.first_stuck.expect("a run got stuck");
    let options = Options { seed: Some(run_seed(11, number)), ..Options::default() };
    let mut run = Run::new(&system, options);
    for step in 1..=30 {
        run.step(inputs.get(&step).unwrap_or(&StepInput::default())).expect("step");
    }
    assert!(!run.is_done());
    for label in run.upcoming().labels {
        assert!(result.stuck.contains_key(&label), "{label} is marked for ever");
    }
}

#[test]
fn the_interval_is_wilsons() {
    // Wilson's interval of 8 in 10, computed by hand: center 0.716740, half width 0.226577.
    let (low, high) = wilson_interval(8, 10);
    assert!((low - 0.490_162).abs() < 1e-5 && (high - 0.943_318).abs() < 1e-5, "{low} {high}");
    assert_eq!(wilson_interval(0, 0), (0.0, 1.0));
}
