//! Networks that other tools wrote, given to every command that takes a mission.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command runs")
}

fn told(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_default()
}

/// Two activities one after the other, or another one: within 1 to 100, with what other tools say beside that.
fn network(change: impl Fn(&mut Value)) -> Value {
    let mut file = json!({
        "network-id": "net",
        "net": { "uid": "net", "tpn-type": "network", "begin-node": "n1", "end-node": "n4" },
        "n1": { "uid": "n1", "tpn-type": "state", "activities": ["a1"], "constraints": ["whole"] },
        "n2": { "uid": "n2", "tpn-type": "state", "activities": ["a2"], "constraints": [] },
        "n4": { "uid": "n4", "tpn-type": "state", "activities": [], "constraints": [] },
        "a1": { "uid": "a1", "tpn-type": "activity", "name": "Drive", "end-node": "n2", "constraints": ["c1"] },
        "a2": { "uid": "a2", "tpn-type": "activity", "name": "Dig", "end-node": "n4", "constraints": ["c2"] },
        "c1": { "uid": "c1", "tpn-type": "temporal-constraint", "value": [2, 5], "end-node": "n2" },
        "c2": { "uid": "c2", "tpn-type": "temporal-constraint", "value": [3, 6], "end-node": "n4" },
        "whole": { "uid": "whole", "tpn-type": "temporal-constraint", "value": [1, 100], "end-node": "n4" },
    });
    change(&mut file);
    file
}

fn written(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("networks");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[test]
fn a_network_is_checked_planned_executed_reported_and_exported() {
    let file = written("whole.tpn.json", &network(|_| {}).to_string());
    let file = text(&file);
    let check = enroute(&["check", file, "--format", "json"]);
    assert_eq!((check.status.code(), &told(&check)["diagnostics"]), (Some(0), &json!([])));
    let plan = enroute(&["plan", file, "--format", "json"]);
    assert_eq!(told(&plan)["plans"][0]["windows"]["Dig#1.end"], json!([5, 11]));
    assert_eq!(told(&plan)["verdict"]["valid"], json!(true));
    let run = enroute(&["simulate", file, "--format", "json"]);
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let last = told(&run)["log"].as_array().and_then(|log| log.last().cloned()).expect("a log");
    assert_eq!(last["time"], json!(5));
    let runs = enroute(&["robustness", file, "--runs", "20", "--format", "json"]);
    assert_eq!((runs.status.code(), &told(&runs)["tally"]["runs"]), (Some(0), &json!(20)), "{runs:?}");
    let page = written("report.html", "");
    let report = enroute(&["report", file, "-o", text(&page), "--format", "json"]);
    assert_eq!(report.status.code(), Some(0), "{report:?}");
    assert!(std::fs::read_to_string(&page).expect("a report").contains("Dig#1"));
    let table = enroute(&["export", file, "--as", "csv"]);
    assert_eq!(table.status.code(), Some(0), "{table:?}");
    assert!(
        String::from_utf8_lossy(&table.stdout).contains("Dig#1,primitive,Dig,,2,5,5,11,3,6"),
        "{table:?}"
    );
}

#[test]
fn a_network_that_nobody_can_execute_has_no_plan_in_any_command() {
    let impossible = network(|file| file["whole"]["value"] = json!([50, 100]));
    let file = written("impossible.tpn.json", &impossible.to_string());
    for command in [&["plan"][..], &["simulate"], &["robustness"], &["export", "--as", "csv"]] {
        let output = enroute(&[command, &[text(&file)]].concat());
        assert_eq!(output.status.code(), Some(1), "{command:?}: {output:?}");
    }
}

#[test]
fn what_a_file_says_in_vain_is_said_at_every_verdict() {
    let file = written(
        "more.tpn.json",
        &network(|file| {
            file["a1"]["cost"] = json!(5);
            file["a2"]["controllable"] = json!(false);
            file["a2"]["reward"] = json!(0);
            file["n1"]["constraints"] = json!(["whole", "cheap"]);
            file["cheap"] = json!({ "tpn-type": "cost<=-constraint", "value": 9, "end-node": "n4" });
            file["a1"]["guard"] = json!("(= x 1)");
        })
        .to_string(),
    );
    let expected = "ignored when planning: a cost, a duration that is not controllable, a guard, \
                    a limit on cost";
    for command in ["check", "plan", "simulate", "report", "tpn"] {
        let output = enroute(&[command, text(&file), "--format", "json"]);
        let message = &told(&output)["diagnostics"][0]["message"];
        assert_eq!(message, expected, "{command}: {output:?}");
    }
    for command in [&["robustness", "--runs", "5"][..], &["export", "--as", "csv"]] {
        let output = enroute(&[command, &[text(&file)]].concat());
        assert!(String::from_utf8_lossy(&output.stderr).contains("W-NETWORK"), "{command:?}: {output:?}");
    }
}

#[test]
fn what_tools_write_differently_is_read() {
    let window = |name: &str, text: &str| {
        let file = written(name, text);
        let output = enroute(&["plan", file.to_str().expect("UTF-8"), "--format", "json"]);
        told(&output)["plans"][0]["windows"]["Dig#1.end"].clone()
    };
    let plain = network(|_| {}).to_string();
    assert_eq!(window("mark.tpn.json", &format!("\u{feff}{plain}")), json!([5, 11]));
    let loud = network(|file| {
        for object in ["net", "n1", "a1", "a2", "c1", "whole"] {
            let kind = file[object]["tpn-type"].as_str().unwrap_or_default().to_uppercase();
            file[object]["tpn-type"] = json!(kind);
        }
    });
    assert_eq!(window("loud.tpn.json", &loud.to_string()), json!([5, 11]));
    let open = network(|file| {
        file["c2"]["value"] = json!(null);
        file["c1"]["value"] = json!([2, null]);
    });
    assert_eq!(window("open.tpn.json", &open.to_string()), json!([2, 100]));
    // A constraint from an event to itself that allows 0 says nothing; another one cannot be kept.
    let itself = |value: Value| {
        network(|file| {
            file["n2"]["constraints"] = json!(["self"]);
            file["self"] = json!({ "tpn-type": "temporal-constraint", "value": value, "end-node": "n2" });
        })
        .to_string()
    };
    assert_eq!(window("idle.tpn.json", &itself(json!([0, 9]))), json!([5, 11]));
    let file = written("never.tpn.json", &itself(json!([1, 9])));
    let never = enroute(&["plan", text(&file), "--format", "json"]);
    assert_eq!((never.status.code(), &told(&never)["status"]), (Some(1), &json!("no-plan")));
    let file = written("reversed.tpn.json", &network(|file| file["c1"]["value"] = json!([5, 2])).to_string());
    assert_eq!(enroute(&["plan", text(&file)]).status.code(), Some(2));
}

#[test]
fn a_network_becomes_a_mission_with_the_same_windows_or_says_why_not() {
    let file = written("to-rmpl.tpn.json", &network(|_| {}).to_string());
    let output = enroute(&["tpn", text(&file), "--as", "rmpl"]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let mission = String::from_utf8(output.stdout).expect("UTF-8");
    let plan = enroute(&["plan", text(&written("from-network.rmpl", &mission)), "--format", "json"]);
    assert_eq!(told(&plan)["plans"][0]["windows"]["Dig#1.end"], json!([5, 11]), "{mission}");
    // A third activity leads past the middle to nothing.
    let loose = network(|file| {
        file["n2"]["activities"] = json!(["a2", "a3"]);
        file["net"]["end-node"] = json!("n4");
        file["n5"] = json!({ "tpn-type": "state", "activities": [], "constraints": [] });
        file["a3"] = json!({ "tpn-type": "activity", "name": "Look", "end-node": "n5", "constraints": [] });
    });
    let file = written("loose.tpn.json", &loose.to_string());
    let output = enroute(&["tpn", text(&file), "--as", "rmpl"]);
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        said.contains("the node `n5` has no outgoing arc, but is not the end of the network (`a3`)"),
        "{said}"
    );
    let output = enroute(&["tpn", text(&file), "--as", "rmpl", "--format", "json"]);
    assert_eq!((&told(&output)["rmpl"], output.status.code()), (&json!(null), Some(1)));
}

#[test]
fn variables_for_bounds_stand_at_their_default_and_other_files_of_the_tool_are_refused_by_name() {
    let variable = json!({ "type": "lvar", "name": "dig-bounds", "default": [4, 7] });
    let file =
        written("variable.tpn.json", &network(|file| file["c2"]["value"] = variable.clone()).to_string());
    let plan = told(&enroute(&["plan", text(&file), "--format", "json"]));
    assert_eq!(plan["plans"][0]["windows"]["Dig#1.end"], json!([6, 12]), "{plan}");
    assert!(plan["diagnostics"].to_string().contains("bounds given by a variable"), "{plan}");
    let open = json!({ "type": "lvar", "name": "dig-bounds" });
    let file = written("open.tpn.json", &network(|file| file["c2"]["value"] = open.clone()).to_string());
    let plan = told(&enroute(&["plan", text(&file), "--format", "json"]));
    assert_eq!(plan["plans"][0]["windows"]["Dig#1.end"], json!([2, 100]), "{plan}");
    for (name, content, said) in [
        (
            "day.htn.json",
            r#"{"a": {"type": "htn-network"}, "b": {"type": "edge"}}"#,
            "hierarchical task network",
        ),
        ("day.merged.edn", "[{:plans/plans [:a] :plan/by-plid {}}]", "plans merged by plan-schema"),
    ] {
        let refused = enroute(&["plan", text(&written(name, content))]);
        assert_eq!(refused.status.code(), Some(2), "{name}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains(said), "{name}: {refused:?}");
    }
}

#[test]
fn a_network_that_was_written_here_says_of_what_is_nature_s_only_that() {
    let mission = "primitive A()[1,2]; scenario S[0,20] = { A(); B() contingent [2,3]; delay[1,1] }";
    let file = written("nature.rmpl", mission);
    let out = enroute(&["tpn", text(&file), "--as", "plan-schema"]);
    let again = written("nature.tpn.json", &String::from_utf8(out.stdout).expect("text"));
    let check = told(&enroute(&["check", text(&again), "--format", "json"]));
    let said = check["diagnostics"].to_string();
    assert!(said.contains("a duration that is not controllable\""), "{said}");
}
