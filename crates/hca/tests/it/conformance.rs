//! The `hca-*` cases of the conformance suite, and the orbit insertion of SPEC 8.4 with its failures.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use hca::{Automaton, Estimate, Trace, Vocabulary, compile_text, trace};
use serde_json::{Value, json};
use smol_str::SmolStr;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/conformance")
}

fn cases(kind: &str) -> Vec<(String, Value, String)> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder()).expect("conformance folder") {
        let path = entry.expect("entry").path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let case: Value = serde_json::from_str(&std::fs::read_to_string(&path).expect("case")).expect("JSON");
        if case["kind"] == kind {
            let program = std::fs::read_to_string(folder().join(case["program"].as_str().expect("program")))
                .expect("program");
            found.push((case["id"].as_str().expect("id").to_owned(), case, program));
        }
    }
    found.sort_by(|left, right| left.0.cmp(&right.0));
    found
}

fn strings(value: &Value) -> Vec<SmolStr> {
    value.as_array().into_iter().flatten().filter_map(Value::as_str).map(SmolStr::new).collect()
}

fn vocabulary(case: &Value) -> Vocabulary {
    let domains: BTreeMap<SmolStr, Vec<SmolStr>> = case["domains"]
        .as_object()
        .into_iter()
        .flatten()
        .map(|(name, values)| (SmolStr::new(name), strings(values)))
        .collect();
    let program_variables: BTreeSet<SmolStr> = strings(&case["program_vars"]).into_iter().collect();
    Vocabulary { domains, program_variables }
}

fn estimate(automaton: &Automaton, value: &Value) -> Estimate {
    let known = value.as_object().into_iter().flatten();
    automaton.estimate(known.filter_map(|(name, value)| Some((name.as_str(), value.as_str()?))))
}

#[test]
fn every_trace_of_the_suite_is_reproduced() {
    let cases = cases("hca-trace");
    assert!(cases.len() >= 6, "the suite has its traces");
    for (id, case, program) in cases {
        let compilation = compile_text(&program, &vocabulary(&case));
        assert_eq!(compilation.diagnostics, [], "{id}");
        let automaton = compilation.automaton.expect("compiles");
        let estimates: Vec<Estimate> = case["estimates"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|value| estimate(&automaton, value))
            .collect();
        let run = trace(&automaton, &estimates);
        let expected = case["expect"]["steps"].as_array().expect("steps");
        assert_eq!(run.steps.len(), expected.len(), "{id}");
        for (step, expected) in run.steps.iter().zip(expected) {
            assert_eq!(Value::from(step.step), expected["step"], "{id}");
            assert_eq!(Value::from(step.marked.len()), expected["num_marked"], "{id} step {}", step.step);
            assert_eq!(step.goals, strings(&expected["goals"]), "{id} step {}", step.step);
            assert_eq!(step.labels, strings(&expected["labels"]), "{id} step {}", step.step);
        }
        assert_eq!(Value::from(run.terminated), case["expect"]["terminated"], "{id}");
    }
}

#[test]
fn every_program_in_time_of_the_suite_has_the_goals_of_its_case() {
    let cases = cases("timed-trace");
    assert!(cases.len() >= 5, "the suite has its programs in time");
    for (id, case, program) in cases {
        let compilation = compile_text(&program, &vocabulary(&case));
        assert_eq!(compilation.diagnostics, [], "{id}");
        let automaton = compilation.automaton.expect("compiles");
        let estimates = case["estimates"].as_array().into_iter().flatten();
        let estimates: Vec<Estimate> = estimates.map(|value| estimate(&automaton, value)).collect();
        let run = trace(&automaton, &estimates);
        let goals: Vec<Value> =
            run.steps.iter().map(|step| json!({ "step": step.step, "goals": step.goals })).collect();
        assert_eq!(Value::from(goals), case["expect"]["steps"], "{id}");
        assert_eq!(Value::from(run.terminated), case["expect"]["terminated"], "{id}");
    }
}

#[test]
fn every_error_of_the_suite_is_found_once() {
    let cases = cases("hca-error");
    assert!(cases.len() >= 2, "the suite has its errors");
    for (id, case, program) in cases {
        let codes: Vec<&str> = compile_text(&program, &vocabulary(&case))
            .diagnostics
            .iter()
            .filter(|diagnostic| diagnostic.severity == rmpl::Severity::Error)
            .map(|diagnostic| diagnostic.code.0)
            .collect();
        assert_eq!(codes, [case["expect"]["error"].as_str().expect("code")], "{id}");
    }
}

/// The markings of orbit insertion under estimates of the two engines; the camera is off from the first step on.
fn orbit(engines: &[(&str, &str)]) -> (Vec<Vec<String>>, Trace) {
    let (_, case, program) =
        cases("hca-trace").into_iter().find(|(id, ..)| id == "h01_orbit_nominal").expect("orbit insertion");
    let automaton = compile_text(&program, &vocabulary(&case)).automaton.expect("compiles");
    let estimates: Vec<Estimate> = engines
        .iter()
        .map(|(a, b)| automaton.estimate([("EngineA", *a), ("EngineB", *b), ("Camera", "Off")]))
        .collect();
    let run = trace(&automaton, &estimates);
    let names = run
        .steps
        .iter()
        .map(|step| step.marked.iter().map(|location| automaton.location_name(*location)).collect())
        .collect();
    (names, run)
}

#[test]
fn an_engine_that_fails_hands_over_to_the_other_at_whichever_step_it_fails() {
    let (off, standby, firing, failed) = ("Off", "Standby", "Firing", "Failed");
    let first = [(off, off), (standby, standby)];
    let at_three = [&first[..], &[(failed, standby), (failed, standby), (failed, firing)]].concat();
    let (names, run) = orbit(&at_three);
    assert_eq!(names[3..], [vec!["a5"], vec!["a5"], vec![]]);
    assert!(run.terminated);
    let at_four =
        [&first[..], &[(standby, standby), (failed, standby), (failed, standby), (failed, firing)]].concat();
    let (names, _) = orbit(&at_four);
    assert_eq!(names[3..], [vec!["a4", "w2"], vec!["a5"], vec!["a5"], vec![]]);
    let before_standby = [(off, off), (failed, off), (failed, standby), (failed, standby), (failed, firing)];
    let (names, _) = orbit(&before_standby);
    assert_eq!(names[2], ["a1", "a2", "w2"]);
    assert_eq!(names[3..], [vec!["a1", "a5"], vec!["a1", "a5"], vec![]]);
    let (names, run) = orbit(&[(off, off), (failed, failed), (failed, failed), (failed, failed)]);
    assert_eq!(names.last().expect("last"), &["a1", "a2", "w2"]);
    assert!(!run.terminated, "with both engines failed the program waits for ever");
}

#[test]
fn what_is_true_in_all_possible_states_is_known() {
    let vocabulary = Vocabulary {
        domains: BTreeMap::from([(SmolStr::new("c"), ["on", "off", "odd"].map(SmolStr::new).to_vec())]),
        ..Vocabulary::default()
    };
    let text = "(PARALLEL (WHEN-DONEXT ((c = on) OR (c = off)) (x = a)) (WHEN-DONEXT (c = on) (x = b)))";
    let automaton = compile_text(text, &vocabulary).automaton.expect("compiles");
    let mut stepper = hca::Stepper::new(&automaton);
    stepper.step_observed(
        &[automaton.estimate([("c", "on")]), automaton.estimate([("c", "off")])],
        &mut hca::Unobserved,
    );
    assert_eq!(automaton.labels(stepper.marking()), ["assert x=a", "when c=on"]);
}

#[test]
fn a_disjunction_over_the_whole_of_a_closed_domain_is_known_without_knowing_the_value() {
    let closed = Vocabulary {
        domains: BTreeMap::from([(SmolStr::new("c"), ["on", "off"].map(SmolStr::new).to_vec())]),
        ..Vocabulary::default()
    };
    let text = "(WHEN-DONEXT (((c = on) AND (true)) OR (NOT (c = on))) (x = a))";
    let split =
        "(WHEN-DONEXT (((c = on) AND (d = on)) OR ((c = on) AND (NOT (d = on))) OR (c = off)) (x = a))";
    for (text, vocabulary, known) in [
        (text, &closed, true),
        (text, &Vocabulary::default(), true),
        (split, &closed, true),
        (split, &Vocabulary::default(), false),
    ] {
        let automaton = compile_text(text, vocabulary).automaton.expect("compiles");
        let mut stepper = hca::Stepper::new(&automaton);
        stepper.step(&automaton.estimate([]));
        assert_eq!(automaton.labels(stepper.marking()) == ["assert x=a"], known, "{text}");
    }
}

#[test]
fn a_step_asks_for_what_is_waited_for_and_watched_and_goes_by_what_it_is_told() {
    let text = "(DO-WATCHING (s = on) (SEQUENCE (WHEN-DONEXT (x = a) (y = b)) (z = c)))";
    let automaton = compile_text(text, &Vocabulary::default()).automaton.expect("compiles");
    let guard = |test: hca::TestId| automaton.guard(test).expect("its own");
    let asked = |stepper: &hca::Stepper| -> Vec<String> {
        stepper.asked().into_iter().map(|test| guard(test).to_string()).collect()
    };
    let mut stepper = hca::Stepper::new(&automaton);
    for (before, entailed, after) in [
        (&["~s=on", "x=a", "~x=a"][..], "", &["when x=a"][..]),
        (&["~s=on", "x=a", "~x=a"][..], "x=a", &["assert y=b"][..]),
        (&["~s=on", "y=b"][..], "y=b", &["assert z=c"][..]),
        (&["~s=on", "z=c"][..], "s=on", &[][..]),
    ] {
        assert_eq!(asked(&stepper), before);
        stepper.step_told(&|test| guard(test).constraint.to_string() == entailed, &mut hca::Unobserved);
        assert_eq!(automaton.labels(stepper.marking()), after, "{entailed}");
    }
}
