//! Networks of other tools as the text that the core is asked about: planned, reviewed and executed as missions are.

use std::sync::Arc;

use link::{Request, Response, Update};
use mission::Core;
use snapshot::{Problem, Snapshot, Stage};
use test_core::Answers;

fn shown(core: &mut Core, revision: u64, source: &str) -> Arc<Snapshot> {
    let mut answers = Answers::default();
    core.handle(Request::Update(Update::new(revision, source)), &mut answers);
    let snapshot = answers.snapshot();
    assert_eq!((snapshot.revision, snapshot.stage), (revision, Stage::Complete));
    snapshot
}

/// The run that was answered.
fn run(answers: &Answers) -> String {
    answers.last(|answer| match answer {
        Response::Execution(execution) => Some(format!("{execution:?}")),
        _ => None,
    })
}

fn codes(problems: &[Problem]) -> Vec<&str> {
    problems.iter().map(|problem| problem.code.as_ref()).collect()
}

/// Drives for 2 to 5 or waits for 8 to 9, at a cost, within 1 to 100.
const CHOICE: &str = r#"{"network-id": "net",
  "net": {"uid": "net", "tpn-type": "network", "begin-node": "n1", "end-node": "n2"},
  "n1": {"uid": "n1", "tpn-type": "c-begin", "activities": ["a1", "a2"], "constraints": ["whole"], "end-node": "n2"},
  "n2": {"uid": "n2", "tpn-type": "c-end", "activities": [], "constraints": []},
  "a1": {"uid": "a1", "tpn-type": "activity", "name": "Drive", "end-node": "n2", "constraints": ["c1"], "cost": 7},
  "a2": {"uid": "a2", "tpn-type": "delay-activity", "end-node": "n2", "constraints": ["c2"]},
  "c1": {"uid": "c1", "tpn-type": "temporal-constraint", "value": [2, 5], "end-node": "n2"},
  "c2": {"uid": "c2", "tpn-type": "temporal-constraint", "value": [8, 9], "end-node": "n2"},
  "whole": {"uid": "whole", "tpn-type": "temporal-constraint", "value": [1, 100], "end-node": "n2"}}"#;

#[test]
fn a_network_is_planned_reviewed_and_executed_and_what_is_not_honored_is_said() {
    let mut core = Core::default();
    for (revision, text) in [(1, CHOICE.to_owned()), (2, format!("\u{feff}{CHOICE}"))] {
        let snapshot = shown(&mut core, revision, &text);
        assert_eq!(codes(&snapshot.problems), ["W-NETWORK"]);
        assert!(snapshot.problems[0].message.contains("a cost"));
        let plan = snapshot.plan().expect("a plan");
        let end = snapshot.network.as_ref().expect("a network").end;
        let window = plan.windows[end.index()].expect("the end is selected");
        assert_eq!((window.earliest.to_f64(), window.latest.to_f64()), (2.0, 5.0));
        assert!(snapshot.planning.as_ref().and_then(|it| it.verdict.as_ref()).is_some_and(|it| it.valid));
    }
    let mut answers = Answers::default();
    let text = Update::new(2, format!("\u{feff}{CHOICE}"));
    core.handle(Request::Review { update: text.clone(), rules: Vec::new() }, &mut answers);
    assert!(matches!(answers.0.last(), Some(Response::Review { .. })));
    let script = executive::Script::default();
    core.handle(Request::Execute { update: text, script }, &mut answers);
    assert!(run(&answers).contains("Drive"));
}

#[test]
fn a_text_turns_from_a_network_to_a_mission_and_back() {
    let mut core = Core::default();
    let mission = "primitive Work()[1,2];\nscenario S[0,10] = { Work() }";
    let names = |snapshot: &Snapshot| {
        let network = snapshot.network.as_ref().expect("a network");
        network.occurrences.iter().map(|it| it.activity.to_string()).collect::<Vec<_>>().join(" ")
    };
    for revision in 1..=6 {
        let is_network = revision % 3 != 0;
        // An edit that says the same comes second.
        let text = if is_network { CHOICE } else { mission };
        let snapshot = shown(&mut core, revision, text);
        assert_eq!(names(&snapshot).contains("Drive"), is_network, "{revision}");
        assert_eq!(names(&snapshot).contains("Work"), !is_network, "{revision}");
        assert!(snapshot.plan().is_some());
    }
    let snapshot = shown(&mut core, 7, "");
    assert!(snapshot.network.is_none());
}

#[test]
fn what_cannot_be_read_says_where_and_is_no_list_of_mistakes_in_rmpl() {
    let mut core = Core::default();
    let broken = CHOICE.replace("\"end-node\": \"n2\", \"constraints\": [\"c1\"]", "\"end-node\": \"n7\"");
    let snapshot = shown(&mut core, 1, &broken);
    assert_eq!(codes(&snapshot.problems), ["E-NETWORK"]);
    assert!(snapshot.problems[0].message.contains("n7"), "{}", snapshot.problems[0].message);
    assert!(snapshot.network.is_none());
    let snapshot = shown(&mut core, 2, &CHOICE[..CHOICE.len() / 2]);
    assert_eq!(codes(&snapshot.problems), ["E-NETWORK"]);
    let edn = include_str!("../../../../tests/fuzz/corpus/networks/network.tpn.edn");
    assert!(shown(&mut core, 3, edn).plan().is_some());
}

#[test]
fn what_alternatives_that_were_not_taken_would_have_brought_holds_up_no_run() {
    // Both activities end at one node; the environment may draw a duration for either.
    let both = CHOICE.replace(r#""delay-activity", "end-node""#, r#""activity", "name": "Rest", "end-node""#);
    let settings =
        snapshot::RobustnessSettings { runs: 20, seed: 3, uncertainty: snapshot::Uncertainty::default() };
    let mut core = Core::default();
    let snapshot = shown(&mut core, 1, &both);
    let (network, plan) = (snapshot.network.as_ref().expect("a network"), snapshot.plan().expect("a plan"));
    let windows = tpn::plan_json::plan_to_json(network, plan)["windows"].to_string();
    assert!(windows.contains("Drive") && !windows.contains("Rest"), "{windows}");
    let mut answers = Answers::default();
    core.handle(Request::Sample { update: Update::new(1, &*both), settings, from: 0 }, &mut answers);
    let tally = answers.last(|answer| match answer {
        Response::Sampled { tally, .. } => Some(tally),
        _ => None,
    });
    assert_eq!((tally.runs, tally.succeeded), (20, 20), "{tally:?}");
    let script = r#"{"disturbances": [{"kind": "duration", "activity": "Rest#1", "duration": 8}]}"#;
    let script = serde_json::from_str(script).expect("a script");
    core.handle(Request::Execute { update: Update::new(1, &*both), script }, &mut answers);
    let run = run(&answers);
    assert!(run.contains("Finished") && run.contains("Drive") && !run.contains("Rest#1.end"), "{run}");
}
