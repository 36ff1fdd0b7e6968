//! Missions executed from the command line: once with disturbances, and many times with chance, whole and in parts.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::{Value, json};

fn orbit() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../assets/missions/orbit.rmpl")
}

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command starts")
}

fn file(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("the file can be written");
    path.to_string_lossy().into_owned()
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_fault_in_a_script_brings_the_backup_engine_and_the_log_replays() {
    let fault = json!({ "disturbances": [
        { "kind": "fault", "activity": "Insert#1", "step": 3, "component": "EngineA", "mode": "Failed" }
    ]});
    let script = file("fault.json", &fault.to_string());
    let mission = orbit().to_string_lossy().into_owned();
    let first = enroute(&["simulate", &mission, "--disturb", &script, "--format", "json"]);
    assert_eq!(first.status.code(), Some(0), "{first:?}");
    let document: Value = serde_json::from_str(&text(&first)).expect("JSON");
    assert_eq!(document["status"], "finished");
    let log = document["log"].as_array().expect("a log");
    assert!(log.iter().any(|entry| entry["text"].as_str().is_some_and(|text| text.contains("EngineB.fire"))));
    let saved = file("run.json", &text(&first));
    let second = enroute(&["simulate", &mission, "--disturb", &saved, "--format", "json"]);
    assert_eq!(text(&first), text(&second), "the written log is a script that gives the same log");
}

#[test]
fn the_seed_of_a_run_changes_its_durations_and_not_its_plan() {
    let mission = file(
        "uncertain.rmpl",
        "primitive Drive() contingent [20,40]; scenario S[0,100] = { Drive(); delay }",
    );
    let log = |arguments: &[&str]| {
        let output = enroute(&[&["simulate", &mission, "--format", "json"], arguments].concat());
        let document: Value = serde_json::from_str(&text(&output)).expect("JSON");
        document["log"].to_string()
    };
    let usual = log(&[]);
    assert_eq!(usual, log(&["--run-seed", "0"]));
    assert_ne!(usual, log(&["--run-seed", "7"]));
    assert_eq!(log(&["--seed", "7"]), log(&["--run-seed", "7"]));
}

#[test]
fn parts_of_many_runs_add_up_to_the_whole() {
    let mission = orbit().to_string_lossy().into_owned();
    let common = ["robustness", &mission, "--runs", "40", "--seed", "5", "--format", "json"];
    let whole: Value = serde_json::from_str(&text(&enroute(&common))).expect("JSON");
    assert_eq!(whole["tally"]["runs"], 40);
    let mut files = Vec::new();
    for part in 1..=3 {
        let shard = format!("{part}/3");
        let output = enroute(&[&common[..], &["--shard", &shard]].concat());
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        assert_eq!(text(&output).lines().count(), 1, "one line for each part");
        files.push(file(&format!("part-{part}.jsonl"), &text(&output)));
    }
    let names: Vec<&str> = files.iter().map(String::as_str).collect();
    let merged = enroute(&[&["robustness", "--format", "json", "--merge"][..], &names].concat());
    let merged: Value = serde_json::from_str(&text(&merged)).expect("JSON");
    for member in ["tally", "probability", "interval", "settings", "mission", "is_complete"] {
        assert_eq!(merged[member], whole[member], "{member}");
    }
    let twice = enroute(&["robustness", "--merge", names[0], names[0]]);
    assert_eq!(twice.status.code(), Some(2), "a part that is there twice is refused");
}

#[test]
fn a_duration_near_the_greatest_number_never_comes_to_an_end_before_it_began() {
    let simulate = |program: &str, duration: &str| {
        let mission = file("huge.rmpl", program);
        let script = format!(
            r#"{{"disturbances": [{{"kind": "duration", "activity": "Dig#1", "duration": {duration}}}]}}"#
        );
        enroute(&["simulate", &mission, "--disturb", &file("huge.json", &script)])
    };
    // From the start it still fits, and is later than the plan allows.
    let early = simulate(
        "primitive Dig()[1,20]; primitive Pack()[1,5]; scenario S[0,100] = { Dig(); Pack() }",
        "9223372036854775800",
    );
    assert_eq!(early.status.code(), Some(1), "{early:?}");
    assert!(text(&early).contains("VIOLATION  Dig#1.end did not happen by its latest time 20"), "{early:?}");
    // From 415 it does not: an error that names the event.
    let late = simulate(
        "primitive Dig()[1,20]; primitive Pack()[1,5]; scenario S[0,900] = { delay[415,415]; Dig(); Pack() }",
        "9223372036854775800",
    );
    assert_eq!(late.status.code(), Some(2), "{late:?}");
    let message = String::from_utf8_lossy(&late.stderr).into_owned();
    assert!(message.contains("the time of Dig#1.end is too large to represent exactly"), "{message}");
    // One more does not fit by itself.
    let beyond = simulate("primitive Dig()[1,20]; scenario S[0,100] = { Dig() }", "9223372036854775808");
    assert_eq!(beyond.status.code(), Some(2), "{beyond:?}");
    assert!(String::from_utf8_lossy(&beyond.stderr).contains("to represent exactly"), "{beyond:?}");
}

#[test]
fn disturbances_that_mean_nothing_are_refused_where_they_are_read() {
    let mission = file("dig.rmpl", "primitive Dig()[1,20]; scenario S[0,100] = { Dig(); c [5,5] }");
    for (disturbance, reason) in [
        (r#"{"kind": "duration", "activity": "Dig#1", "duration": -1}"#, "a duration must not be negative"),
        (r#"{"kind": "duration", "activity": "Dig#1", "duration": "soon"}"#, "`soon` is not a number"),
        (r#"{"kind": "slow", "activity": "Dig#1", "factor": 0}"#, "greater than 0 and at most 1"),
        (r#"{"kind": "late", "condition": "Tell(c)#1", "at": "-1/2"}"#, "before the mission starts"),
        (
            r#"{"kind": "obstacle", "at": 0, "x": 1, "y": 1, "radius": 0}"#,
            "radius of an obstacle must be greater than 0",
        ),
    ] {
        let script = file("nothing.json", &format!(r#"{{"disturbances": [{disturbance}]}}"#));
        let output = enroute(&["simulate", &mission, "--disturb", &script]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains(reason), "{message}");
    }
}

#[test]
fn disturbances_and_uncertainty_that_mean_nothing_are_refused() {
    let mission = orbit().to_string_lossy().into_owned();
    let refused = |name: &str, document: &Value| {
        let script = file(name, &document.to_string());
        let option = if document.get("disturbances").is_some() { "--disturb" } else { "--uncertainty" };
        let command = if option == "--disturb" { "simulate" } else { "robustness" };
        let output = enroute(&[command, &mission, option, &script]);
        assert_ne!(output.status.code(), Some(0), "{document}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let one = |disturbance: Value| json!({ "disturbances": [disturbance] });
    let said = refused("kind.json", &one(json!({ "kind": "withdrawn", "condition": "Insert#1", "at": 3 })));
    assert!(said.contains("Insert#1 is not a condition"), "{said}");
    let said =
        refused("short.json", &one(json!({ "kind": "duration", "activity": "Insert#1", "duration": -5 })));
    assert!(said.contains("a duration must not be negative"), "{said}");
    let said = refused("name.json", &one(json!({ "kind": "slow", "activity": "Inset#1", "factor": "1/2" })));
    assert!(said.contains("no Inset#1"), "{said}");
    let said = refused("durations.json", &json!({ "durations": { "Inset": { "fixed": 3 } } }));
    assert!(said.contains("unknown activity or condition Inset"), "{said}");
    let said = refused("fall.json", &json!({ "durations": { "Insert": { "uniform": [3, 2] } } }));
    assert!(said.contains("the distribution of"), "{said}");
}

#[test]
fn a_plan_is_checked_with_the_gap_it_was_planned_with() {
    let text_of =
        "objective minimize end;\nscenario S[0,30] = { { delay; ARM=a [4,4] }, { delay; ARM=b [3,3] } }\n";
    let mission = file("gap.rmpl", text_of);
    for (gap, end) in [("0", "[7, 30]"), ("0.5", "[7.5, 30]"), ("1", "[8, 30]")] {
        let output = enroute(&["plan", &mission, "--threat-gap", gap]);
        assert_eq!(output.status.code(), Some(0), "{output:?}");
        let text = text(&output);
        let line = text.lines().find(|line| line.contains("scenario#1.end")).expect("the end is told");
        assert!(line.ends_with(end) && text.contains("verified by the independent checker"), "{text}");
    }
}

const SOL: &str = "location BASE (0, 0); location ROCK (30, 0);
    model Scout { resource battery 0..200 = 90; state drill : {IN, OUT} = IN; }
    vehicle R : Scout at BASE; vehicle S[1..2] : Scout at BASE;
    primitive Drive(r, to)[1,30] moves r speed (0.02, 0.3) consumes r.battery 50;
    primitive Charge(r)[5,5] produces r.battery 30;
    primitive Deploy(r)[1,1] sets r.drill=OUT;";

fn sol(name: &str, scenario: &str) -> String {
    file(name, &format!("{SOL} scenario Sol[0,100] = {{ {scenario} }}"))
}

#[test]
fn text_names_calls_by_their_arguments_and_json_by_their_identifiers() {
    let mission = sol("calls.rmpl", "Drive(R, ROCK); Charge(S[2]); Charge(R); Charge(R)");
    let plan = text(&enroute(&["plan", &mission, "--no-paths"]));
    for name in ["Drive(R, ROCK).start", "Charge(S[2]).end", "Charge(R)#2.start", "Charge(R)#3.end"] {
        assert!(plan.contains(&format!("  {name} ")), "{name}: {plan}");
    }
    assert!(!plan.contains("Drive#1") && !plan.contains("Charge#"), "{plan}");
    let run = text(&enroute(&["simulate", &mission]));
    assert!(run.contains("R.at=ROCK by Drive(R, ROCK)") && !run.contains("Drive#1"), "{run}");
    let document: Value =
        serde_json::from_str(&text(&enroute(&["plan", &mission, "--no-paths", "--format", "json"])))
            .expect("JSON");
    assert!(document["plans"][0]["windows"].get("Drive#1.end").is_some(), "{document}");
    // An explanation, too.
    let short = sol("short-calls.rmpl", "Drive(S[1], ROCK); Drive(S[1], BASE)");
    let failure = text(&enroute(&["plan", &short, "--no-paths"]));
    let both = "Drive(S[1], ROCK) and Drive(S[1], BASE) together take 100";
    assert!(failure.contains(both) && !failure.contains("Drive#1"), "{failure}");
}

/// What simulation writes is what planning starts from: tomorrow's mission begins where today's ends.
#[test]
fn a_state_that_a_run_ends_in_is_the_start_of_the_next_plan() {
    let today = sol("today.rmpl", "Drive(R, ROCK); Deploy(R); Deploy(S[2])");
    let saved = file("saved.json", "");
    let run = enroute(&["simulate", &today, "--state", &saved]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let state: Value =
        serde_json::from_str(&std::fs::read_to_string(&saved).expect("it is written")).expect("JSON");
    assert_eq!(
        state,
        json!({
            "states": { "R.drill": "OUT", "S[1].drill": "IN", "S[2].drill": "OUT" },
            "levels": { "R.battery": 40, "S[1].battery": 90, "S[2].battery": 90 },
            "places": { "R": "ROCK", "S[1]": "BASE", "S[2]": "BASE" },
        })
    );
    let plan = |scenario: &str, state: &[&str]| {
        let next = sol("next.rmpl", scenario);
        let output = enroute(&[&["plan", next.as_str(), "--format", "json"][..], state].concat());
        output.status.code()
    };
    let from = ["--state", saved.as_str()];
    assert_eq!(plan("Drive(R, ROCK)", &[]), Some(0));
    assert_eq!(plan("Drive(R, BASE)", &from), Some(1), "the way back needs a charge now");
    assert_eq!(plan("Charge(R); ask R.drill=OUT and R.at=ROCK [0,0]; Drive(R, BASE)", &from), Some(0));
    assert_eq!(plan("ask S[1].drill=OUT [1,1]", &from), Some(1));
    // A vehicle may be between locations.
    let between = file("between.json", r#"{"places": {"R": [12.5, 3]}}"#);
    assert_eq!(plan("ask R.at=BASE [1,1]", &["--state", between.as_str()]), Some(1));
    assert_eq!(plan("Drive(R, BASE); ask R.at=BASE [1,1]", &["--state", between.as_str()]), Some(0));
    // The mission's own rules count for what is read: a level is in its range.
    let full = file("full.json", r#"{"levels": {"R.battery": 201}}"#);
    assert_eq!(plan("Charge(R)", &["--state", full.as_str()]), Some(2));
}

#[test]
fn a_state_that_cannot_be_written_is_one_document() {
    let today = sol("unwritten.rmpl", "Drive(R, ROCK)");
    let nowhere = format!("{}/none/state.json", env!("CARGO_TARGET_TMPDIR"));
    let run = enroute(&["simulate", &today, "--state", &nowhere, "--format", "json"]);
    assert_eq!(run.status.code(), Some(2));
    let document: Value = serde_json::from_slice(&run.stdout).expect("one document");
    assert!(document["diagnostics"].to_string().contains("state.json"), "{document}");
}

#[test]
fn no_state_is_written_while_an_activity_is_under_way() {
    let mission = file(
        "under-way.rmpl",
        "state A : {X, Y} = X;\nprimitive Use()[20,20] requires A=X;\nscenario M[0,60] = { Use() }\n",
    );
    let script = r#"{"disturbances": [{"kind": "state", "variable": "A", "value": "Y", "at": 5}]}"#;
    let script = file("under-way.json", script);
    let saved = file("under-way-state.json", "as before");
    let run = enroute(&["simulate", &mission, "--disturb", &script, "--state", &saved]);
    assert_eq!(run.status.code(), Some(2), "{run:?}");
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(said.contains("Use#1 is in progress at the end of the run"), "{said}");
    assert_eq!(std::fs::read_to_string(&saved).expect("it is still there"), "as before");
}

#[test]
fn a_state_of_what_the_mission_does_not_declare_is_refused() {
    let mission = sol("declared.rmpl", "Deploy(R)");
    let refused = |state: &str| {
        let output = enroute(&["plan", &mission, "--state", &file("undeclared.json", state)]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    for (state, told) in [
        (r#"{"states": {"Q.drill": "IN"}}"#, "no state `Q.drill`"),
        (r#"{"states": {"R.drill": "AWAY"}}"#, "`AWAY` is not a value of `R.drill`"),
        (r#"{"levels": {"R.fuel": 3}}"#, "no reservoir `R.fuel`"),
        (r#"{"places": {"T": "BASE"}}"#, "no vehicle `T`"),
        (r#"{"places": {"R": "MOON"}}"#, "no location `MOON`"),
        (r#"{"place": {"R": "BASE"}}"#, "unknown field"),
    ] {
        let said = refused(state);
        assert!(said.contains(told), "{state}: {said}");
    }
}
