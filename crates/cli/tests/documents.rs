//! The commands that write a mission's review and schedule, as they are called.

use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_enroute"));
    command.current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).args(arguments);
    command.output().expect("the command runs")
}

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
    let row = "Group-Wait#1,primitive,Group-Wait,TAI_HOLD1 TAI_HOLD2,415,460,415,514,45,99\r\n";
    assert!(written(&output).contains(row), "{}", written(&output));
}

#[test]
fn a_file_with_errors_has_no_schedule() {
    let output = enroute(&["export", "tests/conformance/e02_bad_bounds.rmpl", "--as", "csv"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty());
}
