//! `enroute stn` on networks with contingent links.

use std::process::{Command, Output};

use serde_json::{Value, json};

/// The drive of 20 to 40 that must end in [30,35].
const DRIVE: &str = "# KIND OF NETWORK\nSTNU\n# Num Time-Points\n3\n# Num Ordinary Edges\n2\n\
    # Num Contingent Links\n1\n# Names of Time-Points\nZ Drive.start Drive.end\n# Ordinary Edges\n\
    Z 35 Drive.end\nDrive.end -30 Z\n# Contingent Links\nDrive.start 20 40 Drive.end\n";

fn enroute(name: &str, text: &str, arguments: &[&str]) -> Output {
    let path = std::env::temp_dir().join(format!("enroute-stnu-{}-{name}.plainStnu", std::process::id()));
    std::fs::write(&path, text).expect("a writable folder");
    let output = Command::new(env!("CARGO_BIN_EXE_enroute")).arg("stn").arg(&path).args(arguments).output();
    std::fs::remove_file(&path).expect("it was written");
    output.expect("the program runs")
}

fn json_of(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).expect("JSON")
}

#[test]
fn a_drive_to_a_window_is_not_controllable_and_it_is_told_what_would_mend_it() {
    let output = enroute("drive", DRIVE, &["--format", "json"]);
    assert_eq!(output.status.code(), Some(1));
    let answer = json_of(&output);
    assert_eq!(answer["format"], "enroute-stn/1");
    assert_eq!((&answer["consistent"], &answer["controllable"]), (&json!(true), &json!(false)));
    // It ends between 30 and 35, and so starts between −10 and 15.
    assert_eq!(answer["windows"]["Drive.start"], json!([-10, 15]));
    let cycle = answer["cycle"].as_array().expect("a cycle");
    let weight: i64 = cycle.iter().filter_map(|step| step["weight"].as_i64()).sum();
    assert_eq!(weight, -15);
    let cases: Vec<&Value> = cycle.iter().map(|step| &step["case"]).filter(|case| !case.is_null()).collect();
    assert!(cases.contains(&&json!("lower")) && cases.contains(&&json!("upper")));
    let upper =
        answer["relaxations"].as_array().expect("relaxations").iter().find(|one| one["case"] == "upper");
    assert_eq!(upper.map(|one| &one["sufficient"]), Some(&json!(25)));

    let output = enroute("drive-text", DRIVE, &[]);
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.contains("not controllable: a semi-reducible cycle of weight -15"), "{text}");
    assert!(text.contains("Drive.start to Drive.end taking at most 25 instead of 40"), "{text}");
}

#[test]
fn a_wider_window_is_controllable() {
    let output = enroute("wide", &DRIVE.replace("Z 35", "Z 50"), &["--format", "json"]);
    assert_eq!(output.status.code(), Some(0));
    let answer = json_of(&output);
    assert_eq!((&answer["controllable"], &answer["cycle"]), (&json!(true), &Value::Null));
}

#[test]
fn an_inconsistent_network_is_not_controllable_and_a_malformed_one_is_wrong() {
    let output = enroute("inconsistent", &DRIVE.replace("Z 35", "Z 29"), &["--format", "json"]);
    assert_eq!(output.status.code(), Some(1));
    let answer = json_of(&output);
    assert_eq!((&answer["consistent"], &answer["controllable"]), (&json!(false), &json!(false)));
    assert!(answer["cycle"].is_array());
    let output = enroute("malformed", &DRIVE.replace("20 40", "40 20"), &["--format", "json"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(json_of(&output)["diagnostics"][0]["span"]["line"], json!(15));
}
