//! pTPN: networks in the XML of MIT's MERS group. The files in `fixtures` were written by `RMPyL`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command runs")
}

fn told(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{output:?}"))
}

fn fixture(name: &str) -> String {
    format!("{}/tests/fixtures/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn written(name: &str, file: &str) -> String {
    let folder: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("ptpn");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    std::fs::write(&path, file).expect("written");
    path.to_str().expect("a path").to_owned()
}

/// When the last event of a plan comes at the earliest and at the latest, or that there is no plan.
fn span(file: &str) -> Value {
    let rows = told(&enroute(&["export", file, "--as", "json"]));
    let Some(rows) = rows["activities"].as_array() else { return json!("no plan") };
    let mut ends: Vec<(String, Value, Value)> = rows
        .iter()
        .filter(|row| row["kind"] == "primitive")
        .map(|row| (row["activity"].to_string(), row["start"].clone(), row["end"].clone()))
        .collect();
    ends.sort_by(|a, b| a.0.cmp(&b.0));
    json!(ends)
}

#[test]
fn a_network_of_rmpyl_is_planned_and_its_choice_is_one() {
    let file = fixture("survey.tpn");
    let plan = told(&enroute(&["plan", &file, "--format", "json"]));
    assert_eq!(plan["status"], "plan", "{plan}");
    // The ridge takes 1 + 10 + 2 at the least, and the relay runs beside it.
    let rows = span(&file);
    assert!(rows.to_string().contains("(fly ridge)") || rows.to_string().contains("(fly valley)"), "{rows}");
    assert_eq!(
        rows.as_array().map(Vec::len),
        Some(if rows.to_string().contains("ridge") { 4 } else { 5 }),
        "{rows}"
    );
    // Utilities are not honored, and said.
    let said = plan["diagnostics"].to_string();
    assert!(said.contains("W-NETWORK") && said.contains("a reward (2 times)"), "{said}");

    // Where the whole has less time than the valley takes, the ridge is left; with less than that, nothing.
    let text = std::fs::read_to_string(&file).expect("the file");
    let within = |minutes: &str| written("within.tpn", &text.replace("40.0", minutes));
    let ridge = span(&within("16")).to_string();
    assert!(ridge.contains("(fly ridge)") && !ridge.contains("valley"), "{ridge}");
    assert_eq!(enroute(&["plan", &within("12.5")]).status.code(), Some(1));
}

#[test]
fn what_nature_decides_is_said_at_the_verdict() {
    let plan = told(&enroute(&["plan", &fixture("rover.tpn"), "--format", "json"]));
    let said = plan["diagnostics"][0]["message"].to_string();
    for what in [
        "a choice that is not controllable",
        "a duration that is not controllable (2 times)",
        "the probability `foundC: yes 0.3, no 0.7`",
        "the probability `NORMAL(5.0, 2.0) of (scan)`",
        "a state constraint",
    ] {
        assert!(said.contains(what), "{what}: {said}");
    }
}

#[test]
fn what_is_written_is_read_with_the_same_plans() {
    let mission = "primitive A()[2,4];\nprimitive B()[3,9];\nprimitive C()[1,1];\n\
        scenario S[0,12] = { A(); choose { { B(); C() }, { A(), choose { C(), { C(); C() } } } }; B() }\n";
    let file = written("mission.rmpl", mission);
    let out = enroute(&["tpn", &file, "--as", "ptpn"]);
    assert_eq!(out.status.code(), Some(0), "{out:?}");
    let again = written("again.ptpn", &String::from_utf8(out.stdout).expect("text"));
    let plans = |file: &str| {
        let plans = told(&enroute(&["plan", file, "--format", "json"]));
        assert_eq!(plans["status"], "plan", "{plans}");
    };
    plans(&file);
    plans(&again);
    assert_eq!(span(&file), span(&again));
    // And again, by other names.
    let out = enroute(&["tpn", &fixture("survey.tpn"), "--as", "ptpn"]);
    let survey = written("survey-again.tpn", &String::from_utf8(out.stdout).expect("text"));
    assert_eq!(span(&fixture("survey.tpn")), span(&survey));
}

#[test]
fn what_branches_do_not_say_is_refused_by_name() {
    let text = std::fs::read_to_string(fixture("survey.tpn")).expect("the file");
    let refusal = |text: &str| {
        let output = enroute(&["plan", &written("refused.tpn", text)]);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    // An episode that is not guarded as its events are.
    let (head, episodes) = text.split_once("<episodes>").expect("it has episodes");
    let other = format!("{head}<episodes>{}", episodes.replacen(">ridge<", ">valley<", 1));
    assert!(refusal(&other).contains("depends on more than the choices before it"), "{}", refusal(&other));
    assert!(
        refusal(&text.replacen("<value>valley</value>", "<value>lake</value>", 1))
            .contains("has no value `lake`")
    );
    assert!(refusal(&text.replacen("bounded-duration>", "loose-duration>", 1)).contains("not XML"));
    assert!(refusal("<tpns><tpn/><tpn/></tpns>").contains("2 networks"));
    assert!(refusal("<tpns><tpn><start-event>a</start-event></tpn></tpns>").contains("refers to `a`"));
}
