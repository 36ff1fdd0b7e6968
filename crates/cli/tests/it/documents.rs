//! The commands that write a mission's review and schedule, as they are called.

use std::path::PathBuf;
use std::process::{Command, Output};

use review::keys::{KeyRing, Person, SecretKey};
use review::record::{Act, Entry, LineKey, Record, Runs, Said, Subject, Who};
use review::seat::Seat;
use review::{FlightRules, Section};
use serde_json::{Value, json};
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use crate::command::enroute;

fn written(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

const MISSION: &str = "assets/missions/enroute.rmpl";

#[test]
fn a_report_is_written_and_its_figures_are_data_too() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("report.html");
    let output =
        enroute(&["report", MISSION, "-o", path.to_str().expect("a path in UTF-8"), "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let page = std::fs::read_to_string(&path).expect("the report");
    let review: Value = serde_json::from_str(&written(&output)).expect("JSON");
    assert_eq!(review["format"], "enroute-report/1");
    assert_eq!(review["causal_links"][0]["margin"], json!([0, 45]));
    assert_eq!(review["conflicts"][0]["gap"], json!([1, 185]));
    assert!(page.contains(review["content_hash"].as_str().expect("a hash")));
}

#[test]
fn what_is_written_says_which_version_wrote_it() {
    let said = enroute(&["--version"]);
    let version = written(&said).trim().replacen("enroute", "Enroute", 1);
    assert_eq!(version, format!("Enroute {}", env!("CARGO_PKG_VERSION")));
    let program = |arguments: &[&str]| {
        let document: Value = serde_json::from_str(&written(&enroute(arguments))).expect("JSON");
        document["program"].as_str().map(str::to_owned)
    };
    assert_eq!(program(&["check", SMALL, "--format", "json"]), Some(version.clone()));
    assert_eq!(program(&["export", SMALL, "--as", "json"]), Some(version.clone()));
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("version.html");
    enroute(&["report", SMALL, "-o", path.to_str().expect("a path in UTF-8")]);
    let page = std::fs::read_to_string(path).expect("the report");
    assert!(page.contains(&format!("<meta name=\"generator\" content=\"{version}\">")));
    let calendar = enroute(&["export", SMALL, "--as", "icalendar", "--epoch", "2004-01-25"]);
    assert!(written(&calendar).contains(&format!("PRODID:-//Enroute//{version}//EN")));
    let (_, history, _) = approved_history("version.review.json");
    assert!(history.contains(&format!("\"program\": \"{version}\"")));
}

#[test]
fn a_calendar_needs_to_know_when_the_mission_starts() {
    let without = enroute(&["export", MISSION, "--as", "icalendar"]);
    assert_eq!(without.status.code(), Some(2), "{without:?}");
    let wrong = enroute(&["export", MISSION, "--as", "icalendar", "--epoch", "soon"]);
    assert_eq!(wrong.status.code(), Some(2), "{wrong:?}");
    let with = enroute(&["export", MISSION, "--as", "icalendar", "--epoch", "2004-01-25T05:05:00Z"]);
    assert_eq!(with.status.code(), Some(0), "{with:?}");
    assert!(written(&with).contains("DTSTART:20040125T051500Z\r\n"));
}

#[test]
fn the_schedule_of_a_mission_is_a_table() {
    let output = enroute(&["export", MISSION, "--as", "csv"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let row = "Group-Wait#1,primitive,Group-Wait,TAI_HOLD1 TAI_HOLD2,415,460,415,514,45,99,min,,,,draft,";
    assert!(written(&output).contains(row), "{}", written(&output));
}

#[test]
fn a_file_with_errors_has_no_schedule() {
    let output = enroute(&["export", "tests/conformance/e02_bad_bounds.rmpl", "--as", "csv"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty());
}

#[test]
fn a_plan_does_not_differ_from_its_mission() {
    let plan = written(&enroute(&["plan", MISSION, "--format", "json"]));
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("enroute.plan.json");
    std::fs::write(&path, plan).expect("a writable folder");
    let output = enroute(&["compare", path.to_str().expect("UTF-8"), MISSION, "--format", "json"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let document: Value = serde_json::from_str(&written(&output)).expect("JSON");
    assert_eq!(document["format"], "enroute-compare/1");
    assert_eq!(document["same"], json!(true));
    assert_eq!(document["differences"], json!([]));
    // SPEC 3.6.
    let drive = json!([[10, 55], [415, 460]]);
    assert_eq!(document["windows"]["Group-Traverse-Path#1"], json!({ "before": drive, "after": drive }));
}

#[test]
fn two_revisions_are_compared_by_name() {
    let source = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../",
        "assets/missions/enroute.rmpl"
    ))
    .expect("the mission");
    let changed = source.replace("PATH1=OK [450,450]", "PATH1=OK [460,460]");
    assert_ne!(changed, source);
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("changed.rmpl");
    std::fs::write(&path, changed).expect("a writable folder");
    let path = path.to_str().expect("UTF-8");
    let output = enroute(&["compare", MISSION, path]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let line = "condition Tell(PATH1=OK)#1 moved: starts [10, 10], ends [460, 460] → starts [10, 10], ends [470, 470]";
    assert!(written(&output).contains(line), "{}", written(&output));
    let output = enroute(&["compare", MISSION, path, "--format", "json"]);
    let document: Value = serde_json::from_str(&written(&output)).expect("JSON");
    assert!(document["counts"]["moved"].as_u64().expect("a count") >= 2, "{}", document["counts"]);
    assert_eq!(document["counts"]["added"], json!(0));
}

#[test]
fn what_is_no_plan_cannot_be_compared() {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("no-plan.json");
    std::fs::write(&path, "{\"format\":\"enroute-stn/1\"}").expect("a writable folder");
    let output = enroute(&["compare", path.to_str().expect("UTF-8"), MISSION]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty());
}

#[test]
fn every_command_that_plans_stops_at_its_time_limit() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let observed = folder.join("nothing-observed.json");
    std::fs::write(&observed, "{}").expect("written");
    let observed = observed.to_str().expect("a path in UTF-8");
    let page = folder.join("late.html");
    let page = page.to_str().expect("a path in UTF-8");
    for arguments in [
        &["plan", MISSION][..],
        &["execute", MISSION, "--observe", observed],
        &["simulate", MISSION],
        &["robustness", MISSION, "--runs", "3"],
        &["report", MISSION, "-o", page],
        &["export", MISSION, "--as", "csv"],
        &["compare", MISSION, MISSION],
    ] {
        let late = enroute(&[arguments, &["--time-limit", "1e-9"]].concat());
        assert_eq!(late.status.code(), Some(3), "{arguments:?}: {late:?}");
        let in_time = enroute(&[arguments, &["--time-limit", "1e300"]].concat());
        assert_eq!(in_time.status.code(), Some(0), "{arguments:?}: {in_time:?}");
    }
}

/// A file of these tests.
fn written_file(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("a file");
    path.to_str().expect("a path in UTF-8").to_owned()
}

/// Ada's key, and the keys that a board trusts, as a file.
fn ada(name: &str) -> (SecretKey, String) {
    let secret = SecretKey::from_bytes([7; 32]);
    let mut ring = KeyRing::default();
    ring.add(Person::new("Ada", secret.clone())).expect("a name");
    (secret, written_file(name, &ring.to_json(false)))
}

/// The history of a board that approved the mission, as a file, with the keys of the board; what was approved is taken
/// from a report.
fn approved_history(name: &str) -> (String, String, String) {
    let output = enroute(&["report", SMALL, "--format", "json"]);
    let report: Value = serde_json::from_str(&written(&output)).expect("JSON");
    let text = |member: &str| report[member].as_str().expect("a text").to_owned();
    let who = || Who {
        by: "Ada".to_owned(),
        role: "Reviewer".to_owned(),
        time: "2024-01-02T03:04:05Z".to_owned(),
        content_hash: text("content_hash"),
        plan_hash: text("plan_hash"),
    };
    let (secret, keys) = ada(&format!("{name}.keys.json"));
    let mut record = Record::new("small");
    let ring = KeyRing::from_json(&std::fs::read_to_string(&keys).expect("a file")).expect("keys");
    record.seed([6; 32]);
    record.judge(&ring.trust(), "2024-01-03T00:00:00Z");
    acknowledge(&report, &mut record, || (secret.clone(), who()));
    let source = std::fs::read_to_string(root().join(SMALL)).expect("the mission");
    let subject = small_subject(source, FlightRules::default());
    let relied_on = record.entries().iter().map(|entry| entry.digest().to_owned()).collect();
    record.approve(who(), subject, String::new(), relied_on, &secret);
    (written_file(name, &record.to_json()), record.to_json(), keys)
}

/// Acknowledges the items of a report's plan that need attention.
fn acknowledge(report: &Value, record: &mut Record, mut who: impl FnMut() -> (SecretKey, Who)) {
    for line in report["plan"].as_array().expect("lines").iter().filter(|line| line["status"] == "attention")
    {
        let said = |member: &str| line[member].as_str().map(str::to_owned);
        let (section, criterion) = (Section::Plan, said("criterion"));
        let (text, place) = (said("text").expect("words"), said("place").expect("a place"));
        let line = LineKey { section, text, criterion, place, needs_waiver: false };
        let (secret, who) = who();
        record.add(who, Act::Acknowledge { line, text: "As meant.".to_owned() }, &secret);
    }
}

/// Returns what is approved of the small mission.
fn small_subject(source: String, rules: FlightRules) -> Subject {
    Subject {
        source,
        goal: snapshot::Goal::Default,
        seed: 0,
        map: None,
        rules,
        counts: [0; 3],
        lines: Vec::new(),
        plan: Value::Null,
        robustness: None,
        runs: None,
    }
}

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// A mission of which nothing fails.
const SMALL: &str = "tests/conformance/t08_sequence_windows.rmpl";

/// Returns what `enroute review verify` says of a history: its status, and the document.
fn verified(arguments: &[&str]) -> (Option<i32>, Value) {
    let output = enroute(&[&["review", "verify", "--format", "json"], arguments].concat());
    (output.status.code(), serde_json::from_str(&written(&output)).expect("JSON"))
}

#[test]
fn a_history_is_checked_and_says_how_the_plan_stands() {
    let (path, text, keys) = approved_history("approved.review.json");
    let alone = enroute(&["review", "verify", &path, "--trust", &keys]);
    assert_eq!(alone.status.code(), Some(0), "{alone:?}");
    let said = written(&alone);
    assert!(said.contains("history intact") && said.contains("[valid]"), "{said}");
    let (status, answer) = verified(&[&path, "--trust", &keys, "--mission", SMALL]);
    assert_eq!((status, &answer["plan_status"]), (Some(0), &json!("approved")), "{answer}");
    assert_eq!((&answer["intact"], &answer["format"]), (&json!(true), &json!("enroute-review-check/1")));
    assert_eq!((&answer["approved"], &answer["blockers"]), (&json!(true), &json!([])));
    let last = answer["entries"].as_array().and_then(|all| all.last()).expect("an entry").clone();
    assert_eq!((&last["signature"], &last["counts"]), (&json!("valid"), &json!(true)));
    let of_other = enroute(&["review", "verify", &path, "--trust", &keys, "--mission", MISSION]);
    assert_eq!(of_other.status.code(), Some(1), "{of_other:?}");
    assert!(written(&of_other).contains("approval lapsed"), "{}", written(&of_other));
    // Without keys nothing counts.
    let (status, answer) = verified(&[&path]);
    assert_eq!((status, &answer["approved"]), (Some(1), &json!(false)));
    assert!(answer["blockers"].to_string().contains("--trust"), "{answer}");
    assert!(answer["entries"].as_array().expect("a list").iter().all(|it| it["signature"] == "unknown"));
    // What was altered is said, and is not an approval.
    let altered = written_file("altered.review.json", &text.replace("\"by\": \"Ada\"", "\"by\": \"Eve\""));
    let found = enroute(&["review", "verify", &altered, "--trust", &keys]);
    assert_eq!(found.status.code(), Some(1), "{found:?}");
    assert!(written(&found).contains("was altered: entry 1 (Eve"), "{}", written(&found));
    for refused in [
        enroute(&["report", SMALL, "--review", &altered, "--format", "json"]),
        enroute(&["review", "verify", SMALL]),
        enroute(&["review", "verify", &path, "--trust", &path]),
    ] {
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    }
}

#[test]
fn forged_signatures_and_entries_that_are_left_out_are_no_approval() {
    let (path, text, keys) = approved_history("forged.review.json");
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    let last = document["entries"].as_array().expect("a list").len() - 1;
    document["entries"][last]["signature"] = json!("00".repeat(64));
    let forged = written_file("broken.review.json", &document.to_string());
    let (status, answer) = verified(&[&forged, "--trust", &keys]);
    assert_eq!((status, &answer["entries"][last]["signature"]), (Some(1), &json!("broken")), "{answer}");
    assert_eq!(answer["approved"], false);
    // Signed by a stranger under Ada's name.
    let mut ring = KeyRing::default();
    ring.add(Person::new("Ada", SecretKey::from_bytes([8; 32]))).expect("a name");
    let others = written_file("others.keys.json", &ring.to_json(false));
    let (status, answer) = verified(&[&path, "--trust", &others]);
    assert_eq!((status, &answer["entries"][last]["signature"]), (Some(1), &json!("unknown")), "{answer}");
    // Who knows an entry notices that it is not there.
    let head = document["heads"][0].as_str().expect("a digest").to_owned();
    assert_eq!(verified(&[&path, "--trust", &keys, "--has", &head]).0, Some(0));
    let (status, answer) = verified(&[&path, "--trust", &keys, "--has", &"0".repeat(64)]);
    assert_eq!((status, &answer["intact"]), (Some(1), &json!(false)));
    // Unsigned, as earlier versions wrote it.
    for entry in document["entries"].as_array_mut().expect("a list") {
        entry.as_object_mut().expect("members").remove("signature");
    }
    document["format"] = json!("enroute-review/2");
    let bare = written_file("unsigned.review.json", &document.to_string());
    let (status, answer) = verified(&[&bare, "--trust", &keys]);
    assert_eq!((status, &answer["entries"][0]["signature"]), (Some(1), &json!("unsigned")));
}

/// A history in which the Chair set a board of so many, and the keys of the board; `then` continues it.
fn before_a_board_of(
    approvals: u32,
    name: &str,
    then: impl FnOnce(&mut Record, &dyn Fn(&str) -> (SecretKey, Who)),
) -> [String; 2] {
    let output = enroute(&["report", SMALL, "--format", "json"]);
    let report: Value = serde_json::from_str(&written(&output)).expect("JSON");
    let text = |member: &str| report[member].as_str().expect("a text").to_owned();
    let secret = |name: &str| SecretKey::from_bytes([name.as_bytes()[0]; 32]);
    let mut ring = KeyRing::default();
    for name in ["Chair", "Ada", "Grace"] {
        ring.add(Person::new(name, secret(name))).expect("a name");
    }
    let minute = std::cell::Cell::new(0);
    let who = |by: &str| {
        minute.set(minute.get() + 1);
        let time = format!("2024-01-02T03:{:02}:00Z", minute.get());
        let (content_hash, plan_hash) = (text("content_hash"), text("plan_hash"));
        let who = Who { by: by.to_owned(), role: "Reviewer".to_owned(), time, content_hash, plan_hash };
        (secret(by), who)
    };
    let mut record = Record::new("small");
    record.seed([name.as_bytes()[0]; 32]);
    record.judge(&ring.trust(), "2024-01-03T00:00:00Z");
    let (secret, chair) = who("Chair");
    record.add(chair, Act::Rules { rules: board_of(approvals) }, &secret);
    acknowledge(&report, &mut record, || who("Chair"));
    then(&mut record, &who);
    let keys = written_file(&format!("{name}.keys.json"), &ring.to_json(false));
    [written_file(&format!("{name}.review.json"), &record.to_json()), keys]
}

fn board_of(approvals: u32) -> FlightRules {
    FlightRules { board: vec![Seat::new("Reviewer", approvals)], ..FlightRules::default() }
}

/// Someone approves the small mission under these flight rules.
fn approve_small(record: &mut Record, rules: &FlightRules, (secret, who): (SecretKey, Who)) {
    let source = std::fs::read_to_string(root().join(SMALL)).expect("the mission");
    let relied_on = record.entries().iter().filter(|entry| matches!(entry.act, Act::Acknowledge { .. }));
    let relied_on = relied_on.map(|entry| entry.digest().to_owned()).collect();
    record.approve(who, small_subject(source, rules.clone()), String::new(), relied_on, &secret);
}

/// The figures of a history are only what someone wrote there; the runs are made again.
#[test]
fn monte_carlo_runs_of_a_history_are_repeated() {
    let output = enroute(&["robustness", SMALL, "--runs", "20", "--run-seed", "5", "--format", "json"]);
    let made: Value = serde_json::from_str(&written(&output)).expect("JSON");
    let tally: Tally = serde_json::from_value(made["tally"].clone()).expect("a tally");
    let settings = RobustnessSettings { runs: 20, seed: 5, uncertainty: Uncertainty::default() };
    let content = made["mission"].as_str().expect("a hash");
    let (_, text, keys) = approved_history("repeated.review.json");
    let reached = tally.succeeded;
    assert!(reached < 20, "some fail");
    let other = format!("with another result: {reached} reached the end, but the history says 20\n");
    for (succeeded, expected) in
        [(reached, "Monte Carlo: 20 runs repeated, with the same result\n"), (20, &other)]
    {
        let tally = Tally { succeeded, ..tally.clone() };
        let mut record = Record::from_json(&text).expect("a history");
        record.keep_runs(Runs::new(content, &Robustness { settings: settings.clone(), tally }));
        let path = written_file("repeated.review.json", &record.to_json());
        let verify = ["review", "verify", &path, "--trust", &keys, "--mission", SMALL];
        let said = written(&enroute(&verify));
        assert!(said.contains(expected), "{said}");
        let (_, answer) = verified(&verify[2..]);
        let found = &answer["robustness"];
        assert_eq!(found["is_same"], succeeded == reached, "{found}");
        assert_eq!(
            (&found["repeated"]["succeeded"], &found["kept"]["succeeded"]),
            (&json!(reached), &json!(succeeded))
        );
        let report = enroute(&["report", SMALL, "--review", &path, "--trust", &keys, "--format", "json"]);
        let report: Value = serde_json::from_str(&written(&report)).expect("JSON");
        // Standard input is read once.
        let piped = Command::new(env!("CARGO_BIN_EXE_enroute"))
            .args(["report", "-", "--review", &path, "--trust", &keys, "--format", "json"])
            .stdin(std::fs::File::open(root().join(SMALL)).expect("the mission"))
            .output()
            .expect("the command runs");
        let piped: Value = serde_json::from_str(&written(&piped)).expect("JSON");
        assert_eq!(piped["robustness"]["text"], report["robustness"]["text"]);
        let line = format!("{} % of 20 runs reached the end", reached * 5);
        let said = &report["robustness"]["text"];
        assert!(said.as_str().is_some_and(|said| said.contains(&line)), "{said} {line}");
    }
}

#[test]
fn one_person_who_weakens_the_board_does_not_approve_alone() {
    let [path, keys] = before_a_board_of(2, "weakened", |record, who| {
        let (secret, ada) = who("Ada");
        record.add(ada, Act::Rules { rules: board_of(1) }, &secret);
        approve_small(record, &board_of(1), who("Ada"));
    });
    let (status, answer) = verified(&[&path, "--trust", &keys, "--mission", SMALL]);
    assert_eq!((status, &answer["approved"]), (Some(1), &json!(false)), "{answer}");
    let rules = &answer["rules"];
    assert_eq!(rules["in_force"]["board"][0]["approvals"], 2);
    assert_eq!(
        (&rules["board_by"][0]["by"], &rules["by"][0]["time"]),
        (&json!("Chair"), &json!("2024-01-02T03:01:00Z"))
    );
    assert_eq!((&rules["proposed"][0]["agreed"], &rules["proposed"][0]["wanted"]), (&json!(1), &json!(2)));
    let proposed = answer["entries"].as_array().expect("a list").iter().rev().nth(1).expect("an entry");
    assert!(proposed["without_effect"].as_str().is_some_and(|why| why.contains("1 of 2")), "{answer}");
    let said = written(&enroute(&["review", "verify", &path, "--trust", &keys, "--mission", SMALL]));
    for line in [
        "board: 2 Reviewer; set by Chair 2024-01-02T03:01:00Z\n",
        "proposed board: 1 Reviewer; set by Ada 2024-01-02T03:",
        "[valid; weakens the board, with 1 of 2 approvals of the board in force]\n",
    ] {
        assert!(said.contains(line), "{line}{said}");
    }
}

#[test]
fn the_board_and_the_rules_of_a_file_have_to_be_in_force() {
    let verify = |path: &str, keys: &str, rules: &str| {
        let rules = written_file("required.rules.json", rules);
        verified(&[path, "--trust", keys, "--mission", SMALL, "--rules", &rules])
    };
    // A new history: the usual board needs one approval, and one is given.
    let (alone, _, key) = approved_history("alone.review.json");
    assert_eq!(verified(&[&alone, "--trust", &key, "--mission", SMALL]).0, Some(0));
    let (status, answer) = verify(&alone, &key, &board_of(2).to_json());
    assert_eq!((status, &answer["approved"]), (Some(1), &json!(false)));
    assert_eq!(answer["blockers"], json!(["not the required flight rules: board"]));
    assert_eq!(answer["rules"]["board_by"], json!([]), "no one has set any");
    let said = written(&enroute(&["review", "verify", &alone, "--trust", &key]));
    assert!(said.contains("board: 1 Reviewer; default, no one has set any\n"), "{said}");
    // Both approve.
    let [path, keys] = before_a_board_of(2, "both", |record, who| {
        for by in ["Ada", "Grace"] {
            approve_small(record, &board_of(2), who(by));
        }
    });
    let strict = FlightRules { slope_deg: Some(1.0), ..board_of(2) }.to_json();
    let part = |members: &str| format!("{{\"format\": \"enroute-rules/1\", {members}}}");
    for (rules, expected) in [
        (board_of(2).to_json(), None),
        (part("\"board\": [{\"role\": \"Reviewer\", \"approvals\": 2}]"), None),
        (part("\"slope_deg\": 15, \"margin\": 0"), None),
        (strict, Some("slope_deg")),
        (part("\"slope_deg\": null"), Some("slope_deg")),
        (board_of(1).to_json(), Some("board")),
        (part("\"board\": [{\"role\": \"Press\", \"approvals\": 2}]"), Some("board")),
    ] {
        let (status, answer) = verify(&path, &keys, &rules);
        assert_eq!(status, Some(i32::from(expected.is_some())), "{rules}: {answer}");
        let blockers = expected.map(|name| format!("not the required flight rules: {name}"));
        assert_eq!(answer["blockers"], json!(blockers.as_slice()), "{rules}");
    }
    for wrong in [part("\"slope\": 1"), "{\"format\": \"enroute-rules/1\"}".to_owned(), "{}".to_owned()] {
        let rules = written_file("wrong.rules.json", &wrong);
        let output = enroute(&["review", "verify", &path, "--trust", &keys, "--rules", &rules]);
        assert_eq!(output.status.code(), Some(2), "{wrong}: {output:?}");
    }
}

#[test]
fn rules_of_another_history_of_the_same_mission_do_not_make_one_approval_enough() {
    let [lax, keys] = before_a_board_of(1, "lax", |_, _| {});
    let read =
        |path: &str| Record::from_json(&std::fs::read_to_string(path).expect("a file")).expect("a record");
    let theirs = read(&lax).entries()[0].clone();
    let mut approval = None;
    let [path, _] = before_a_board_of(2, "mine", |record, who| {
        let (secret, ada) = who("Ada");
        let before: Vec<String> = record.heads().map(str::to_owned).collect();
        approve_small(record, &board_of(1), (secret.clone(), ada));
        let said = record.entries().last().expect("the approval").said();
        let former = [before, vec![theirs.digest().to_owned()]].concat();
        let said = Said { former, rules: board_of(1).digest(), ..(**said).clone() };
        approval = Some(Entry::signed(said, &secret));
    });
    let approval = approval.expect("it was signed");
    let mut document: Value = serde_json::from_str(&read(&path).to_json()).expect("JSON");
    let entries = document["entries"].as_array_mut().expect("a list");
    entries.pop();
    for entry in [&theirs, &approval] {
        entries
            .push(json!({ "digest": entry.digest(), "said": entry.raw(), "signature": entry.signature() }));
    }
    document["heads"] = json!([approval.digest()]);
    let spliced = written_file("spliced.review.json", &document.to_string());
    let (status, answer) = verified(&[&spliced, "--trust", &keys, "--mission", SMALL]);
    assert_eq!(
        (status, &answer["intact"], &answer["approved"]),
        (Some(1), &json!(true), &json!(false)),
        "{answer}"
    );
    assert_eq!(
        (&answer["history"], &answer["rules"]["in_force"]["board"][0]["approvals"]),
        (&document["history"], &json!(2))
    );
    let entries = answer["entries"].as_array().expect("a list").clone();
    let added = entries.iter().find(|entry| entry["digest"] == theirs.digest()).expect("it is told");
    assert!(added["problem"].as_str().is_some_and(|why| why.contains("follows no entry")), "{added}");
}

#[test]
fn several_entries_can_be_required() {
    let [path, keys] = before_a_board_of(2, "several", |record, who| {
        for by in ["Ada", "Grace"] {
            approve_small(record, &board_of(2), who(by));
        }
    });
    let document: Value =
        serde_json::from_str(&std::fs::read_to_string(&path).expect("a file")).expect("JSON");
    let [first, .., last] = document["entries"].as_array().expect("a list").as_slice() else {
        panic!("at least two entries");
    };
    let digest = |entry: &Value| entry["digest"].as_str().expect("a digest").to_owned();
    let (first, last, other) = (digest(first), digest(last), "0".repeat(64));
    let has = |digests: [&str; 2]| {
        verified(&[&path, "--trust", &keys, "--mission", SMALL, "--has", digests[0], "--has", digests[1]])
    };
    assert_eq!(has([&first, &last]).0, Some(0));
    for digests in [[&first, &other], [&other, &last]] {
        let (status, answer) = has(digests.map(String::as_str));
        assert_eq!((status, &answer["intact"]), (Some(1), &json!(false)));
        assert!(answer["reason"].as_str().is_some_and(|why| why.contains(&other)), "{answer}");
    }
}

/// Comments and names cannot add lines to the answer.
#[test]
fn words_of_a_history_are_one_line_each_and_names_that_hide_are_refused() {
    let (path, _, keys) = approved_history("spoofed.review.json");
    let (secret, _) = ada("spoofed.keys.json");
    let line = "   9  2024-01-02T03:04:05Z  Grace (Reviewer) approved [valid]";
    let with = |by: &str, text: &str| {
        let mut record =
            Record::from_json(&std::fs::read_to_string(&path).expect("a file")).expect("a record");
        let (time, role) = ("2024-01-02T03:04:06Z".to_owned(), "Reviewer".to_owned());
        let who = Who { by: by.to_owned(), role, time, ..Who::default() };
        record.add(who, Act::Comment { about: None, to: None, text: text.to_owned() }, &secret);
        written_file("spoofed-again.review.json", &record.to_json())
    };
    for breaks in ["\n", "\r", "\r\n", "\u{2028}", "\u{1b}[1G", "\u{b}"] {
        let said = written(&enroute(&["review", "verify", &with("Ada", &format!("Fine.{breaks}{line}"))]));
        assert!(said.contains("commented: Fine. ") && !said.contains(&format!("{breaks}{line}")), "{said}");
        assert!(!said.contains('\u{1b}') && !said.contains('\r'), "{said}");
    }
    for name in [format!("Ada\n{line}"), "\u{202e}adA".to_owned(), "A\u{200b}da".to_owned()] {
        let output = enroute(&["review", "verify", &with(&name, "Fine."), "--trust", &keys]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains("invisible characters") && !said.contains(line), "{said}");
    }
}

#[test]
fn reports_and_schedules_say_how_the_plan_stands() {
    let (path, _, keys) = approved_history("for-report.review.json");
    let (path, keys) = (path.as_str(), keys.as_str());
    let page = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("approved.html");
    let output = enroute(&[
        "report",
        SMALL,
        "--review",
        path,
        "--trust",
        keys,
        "-o",
        page.to_str().expect("a path in UTF-8"),
    ]);
    assert!(written(&output).contains("approved; approvals: Reviewer 1 of 1"), "{}", written(&output));
    let page = std::fs::read_to_string(page).expect("the report");
    assert!(
        page.contains("History of the review")
            && page.contains("approved</span>; approvals: Reviewer 1 of 1")
    );
    let schedule = enroute(&[
        "export",
        SMALL,
        "--as",
        "json",
        "--review",
        path,
        "--trust",
        keys,
        "--epoch",
        "2004-01-25",
    ]);
    let schedule: Value = serde_json::from_str(&written(&schedule)).expect("JSON");
    assert_eq!(schedule["plan_status"], "approved");
    assert_eq!(schedule["epoch"], "2004-01-25T00:00:00Z");
    let without = enroute(&["export", SMALL, "--as", "json"]);
    let without: Value = serde_json::from_str(&written(&without)).expect("JSON");
    assert_eq!((&without["plan_status"], &without["epoch"]), (&json!("draft"), &Value::Null));
    assert_eq!(without["content_hash"], schedule["content_hash"]);
}

#[test]
fn a_plan_is_held_against_rules_of_its_mission() {
    let held = |rule: &str| {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("held.rules.json");
        let rules = json!([{ "name": "Way", "rule": rule, "source": "FR 2", "waivable": true }]);
        let document = json!({ "format": "enroute-rules/1", "rules": rules });
        std::fs::write(&path, document.to_string()).expect("a file");
        let path = path.to_str().expect("a path in UTF-8").to_owned();
        let output = enroute(&["plan", MISSION, "--rules", &path, "--format", "json"]);
        let answer: Value = serde_json::from_str(&written(&output)).expect("JSON");
        (output.status.code(), answer["rules"][0].clone(), path)
    };
    let (status, rule, _) = held("PATH1=OK while Group-Traverse-Path");
    assert_eq!((status, &rule["outcome"], &rule["status"]), (Some(0), &json!("holds"), &json!("passed")));
    // What may be waived still has to be looked at.
    let (status, rule, path) = held("never Group-Traverse-Path while PATH1=OK");
    assert_eq!((status, &rule["outcome"], &rule["status"]), (Some(1), &json!("broken"), &json!("attention")));
    assert!(!rule["breaks"].as_array().expect("a list").is_empty());
    let report = enroute(&["report", MISSION, "--rules", &path, "--format", "json"]);
    let report: Value = serde_json::from_str(&written(&report)).expect("JSON");
    assert_eq!(report["mission_rules"][0]["status"], "attention");
    let (status, rule, _) = held("PATH9=OK");
    assert_eq!(
        (status, &rule["outcome"], &rule["status"]),
        (Some(1), &json!("unreadable"), &json!("failed"))
    );
}

#[test]
fn every_plan_of_a_list_is_held_against_the_rules() {
    let file = |name: &str, text: &str| {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a path in UTF-8").to_owned()
    };
    let mission = file(
        "two-ways.rmpl",
        "primitive Walk()[5,5]; primitive Ride()[2,2]; scenario S[0,9] = { choose { Walk(), Ride() }; delay }",
    );
    let rules = file(
        "two-ways.rules.json",
        r#"{"format": "enroute-rules/1", "rules": [{"name": "no ride", "rule": "never Ride"}, {"name": "all", "rule": "never Walk while Ride"}]}"#,
    );
    let first = enroute(&["plan", &mission, "--rules", &rules]);
    assert_eq!(first.status.code(), Some(0), "{}", written(&first));
    let all = enroute(&["plan", &mission, "--all", "--rules", &rules, "--format", "json"]);
    let answer: Value = serde_json::from_str(&written(&all)).expect("JSON");
    assert_eq!(all.status.code(), Some(1), "the other plan rides");
    let outcomes = |rules: &Value| -> Vec<Value> {
        rules.as_array().expect("a list").iter().map(|rule| rule["outcome"].clone()).collect()
    };
    assert_eq!(answer["plans"].as_array().map(Vec::len), Some(2));
    let by_plan: Vec<_> = answer["rules_by_plan"].as_array().expect("a list").iter().map(outcomes).collect();
    assert_eq!(by_plan, [["holds", "never-applies"], ["broken", "holds"]]);
    assert_eq!(outcomes(&answer["rules"]), ["broken", "holds"]);
    assert_eq!((&answer["rules"][0]["plan"], &answer["rules"][1]["plan"]), (&json!(2), &json!(2)));
    let text = written(&enroute(&["plan", &mission, "--all", "--rules", &rules]));
    assert!(text.contains("rules of plan 2 of 2\nfailed: no ride"), "{text}");
}

#[test]
fn lines_that_have_passed_are_listed_with_how_they_were_tried() {
    let effort = ["--budget", "1000", "--schedules", "20", "--runs", "1", "--format", "json"];
    let output = enroute(&[&["contradict", MISSION][..], &effort].concat());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let document: Value = serde_json::from_str(&written(&output)).expect("JSON");
    assert_eq!(document["format"], "enroute-contradict/1");
    let items = document["items"].as_array().expect("a list");
    let ids: std::collections::BTreeSet<&str> = items.iter().filter_map(|item| item["id"].as_str()).collect();
    assert_eq!(ids.len(), items.len(), "{items:#?}");
    assert!(ids.contains("choices/1"), "{ids:?}");
    let survived = items.iter().filter(|item| item["status"] == "survived").count();
    assert!(survived > 0, "{items:#?}");
    for item in items {
        let tried = &item["tried"];
        let is_tried = ["schedules", "runs", "plans"].iter().any(|by| tried[by].as_u64() > Some(0));
        assert_eq!(item["status"], if is_tried { "survived" } else { "not-tried" }, "{item}");
        assert_eq!(item.get("counterexample"), None, "{item}");
    }
    let none = enroute(&["contradict", MISSION, "--budget", "1e-9", "--format", "json"]);
    let document: Value = serde_json::from_str(&written(&none)).expect("JSON");
    let is_untried = |item: &Value| item["status"] == "not-tried";
    assert!(document["items"].as_array().is_some_and(|items| items.iter().all(is_untried)), "{document}");
}

#[test]
fn a_plan_that_is_given_is_tried_and_a_schedule_replays() {
    let file = |name: &str, text: &str| {
        let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a path in UTF-8").to_owned()
    };
    let mission = file(
        "contradict.rmpl",
        "primitive Walk()[5,5]; primitive Ride()[2,2]; primitive Rest()[1,1];
scenario S[0,20] = { choose { Walk(), Ride() }; delay; Rest() }",
    );
    let all = enroute(&["plan", &mission, "--all", "--format", "json"]);
    let mut document: Value = serde_json::from_str(&written(&all)).expect("JSON");
    let plans = document["plans"].as_array_mut().expect("a list");
    let other = plans.pop().expect("two plans");
    assert_eq!((plans.len(), &other["choices"]["D1"]), (1, &json!(1)));
    let other = file("contradict.plan.json", &other.to_string());
    let tried = enroute(&["contradict", &mission, "--plan", &other, "--format", "json"]);
    assert_eq!(tried.status.code(), Some(0), "{tried:?}");
    let tried: Value = serde_json::from_str(&written(&tried)).expect("JSON");
    let choice = tried["items"].as_array().expect("a list").iter().find(|it| it["id"] == "choices/1");
    let text = choice.and_then(|it| it["text"].as_str()).expect("the choice");
    assert!(text.contains("Ride") && !text.contains("takes Walk"), "{text}");
    let wrong = file("contradict.wrong.json", r#"{"choices": {"D7": 0}}"#);
    let refused = enroute(&["contradict", &mission, "--plan", &wrong]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let script = file("contradict.script.json", r#"{"disturbances": [], "schedule": {"Rest#1.start": 11}}"#);
    let run = enroute(&["simulate", &mission, "--disturb", &script, "--format", "json"]);
    let run: Value = serde_json::from_str(&written(&run)).expect("JSON");
    assert_eq!((&run["status"], &run["schedule"]), (&json!("finished"), &json!({ "Rest#1.start": 11 })));
    let log = run["log"].as_array().expect("a list");
    let start = log.iter().find(|it| it["name"] == "Rest#1.start").expect("it happens");
    assert_eq!(start["time"], json!(11));
}
