//! Plans of `PlanDev` (NASA's Aerie), read and written.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::{Value, json};

fn enroute(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enroute")).args(arguments).output().expect("the command runs")
}

fn told(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn written(name: &str, file: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plandev");
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(name);
    std::fs::write(&path, file).expect("written");
    path
}

fn directive(id: i64, kind: &str, offset: &str, anchor: Option<i64>, of_start: bool) -> Value {
    json!({ "anchor_id": anchor, "anchored_to_start": of_start, "arguments": { "quantity": 10, "flavor": "sweet" },
        "id": id, "metadata": {}, "name": format!("{kind} {id}"), "start_offset": offset, "tags": [], "type": kind })
}

/// As `PlanDev` exports plans, version 2.
fn plan(activities: &[Value]) -> Value {
    json!({ "activities": activities, "duration": "1 day 00:00:00", "id": 59, "model_id": 1, "name": "Banana Plan",
        "simulation_arguments": {}, "start_time": "2024-08-02T00:00:00+00:00", "tags": [], "version": "2" })
}

/// The earliest and latest start of each activity, in minutes, by type.
fn starts(file: &Path) -> Value {
    let path = file.to_str().expect("a path");
    let table = told(&enroute(&["export", path, "--as", "json"]));
    let rows = table["activities"].as_array().expect("activities").iter();
    let rows = rows.filter(|row| row["kind"] == "primitive");
    let rows = rows.map(|row| (row["activity"].as_str().expect("a name").to_owned(), row["start"].clone()));
    rows.map(|(name, start)| (name, json!([start["earliest"], start["latest"]]))).collect()
}

#[test]
fn directives_begin_at_their_offsets_and_after_their_anchors() {
    let mut bake = directive(7, "Bake", "02:00:00", None, true);
    bake["metadata"]["enroute_duration"] = json!("00:45:30");
    let activities = [
        // The anchor comes later in the file and by its id.
        directive(3, "Eat", "00:10:00", Some(7), false),
        bake,
        directive(8, "Heat", "-00:20:00", Some(7), true),
        directive(9, "Clean", "-01:00:00", None, false),
        directive(10, "Peel", "0:00:00", Some(8), true),
    ];
    let file = written("anchors.json", &plan(&activities).to_string());
    let expected = json!({ "Bake 7": [120, 120], "Eat 3": [175.5, 175.5], "Heat 8": [100, 100],
        "Clean 9": [1380, 1380], "Peel 10": [100, 100] });
    assert_eq!(starts(&file), expected);
    let path = file.to_str().expect("a path");
    let check = enroute(&["check", path]);
    let said = String::from_utf8_lossy(&check.stderr).into_owned() + &String::from_utf8_lossy(&check.stdout);
    assert!(said.contains("a duration that is not controllable (4 times)"), "{said}");
    let rmpl = enroute(&["tpn", path, "--as", "rmpl"]);
    let text = String::from_utf8(rmpl.stdout).expect("UTF-8");
    assert_eq!(rmpl.status.code(), Some(0), "{text}");
    // Names of RMPL have no spaces.
    let renamed: Value = serde_json::from_str(
        &expected.to_string().replace("e ", "e_").replace("t ", "t_").replace("n ", "n_").replace("l ", "l_"),
    )
    .expect("JSON");
    assert_eq!(starts(&written("anchors.rmpl", &text)), renamed, "{text}");
}

#[test]
fn a_schedule_comes_back_from_plandev_with_its_times_arguments_and_types() {
    let mission = "option time_unit = second; primitive Drive(rover, goal)[90,100]; primitive Dig()[1/2,1];
        scenario Day[0,200000] = { delay[3600,3600]; Drive(R1, Hill); { Dig(), Take(x)[86400,86400] } }";
    let file = written("mission.rmpl", mission);
    let export = |file: &Path| {
        told(&enroute(&[
            "export",
            file.to_str().expect("a path"),
            "--as",
            "plandev",
            "--epoch",
            "2024-08-02T01:02:03.5Z",
        ]))
    };
    let first = export(&file);
    assert_eq!(
        (&first["start_time"], &first["duration"]),
        (&json!("2024-08-02T01:02:03.5+00:00"), &json!("25:01:30"))
    );
    let of = |plan: &Value, kind: &str| {
        let all = plan["activities"].as_array().expect("activities");
        let found = all.iter().find(|found| found["type"] == kind).expect("the activity");
        json!([found["start_offset"], found["arguments"], found["metadata"]["enroute_duration"]])
    };
    assert_eq!(of(&first, "Drive"), json!(["01:00:00", { "rover": "R1", "goal": "Hill" }, "00:01:30"]));
    assert_eq!(of(&first, "Dig"), json!(["01:01:30", {}, "00:00:00.500000"]));
    let again = export(&written("again.json", &first.to_string()));
    for kind in ["Drive", "Dig", "Take"] {
        assert_eq!(of(&again, kind), of(&first, kind));
    }
    assert_eq!(again["duration"], first["duration"]);
}

#[test]
fn plans_that_cannot_be_read_say_which_directive_is_at_fault() {
    let mut without_type = directive(1, "A", "00:00:00", None, true);
    without_type["type"] = Value::Null;
    for (activities, told) in [
        (vec![directive(1, "A", "-00:00:01", None, true)], "directive 1 starts outside the plan"),
        (vec![directive(1, "A", "00:00:00", Some(4), true)], "directive 1 is anchored to 4"),
        (vec![directive(1, "A", "1 mon", None, true)], "directive 1: `1 mon` is not an interval"),
        (vec![directive(1, "A", "1:00", None, true); 2], "two directives 1"),
        (vec![without_type], "directive 1 has no `type`"),
    ] {
        let file = written("wrong.json", &plan(&activities).to_string());
        let output = enroute(&["check", file.to_str().expect("a path")]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(told), "{said}");
        assert_ne!(output.status.code(), Some(0));
    }
    let late = written("late.json", &plan(&[directive(1, "A", "25:00:00", None, true)]).to_string());
    let output = enroute(&["plan", late.to_str().expect("a path")]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn names_of_directives_survive_however_often_a_plan_is_written() {
    let named = |id: i64, name: &str| {
        let mut directive = directive(id, "Bake", &format!("0{id}:00:00"), None, true);
        directive["name"] = json!(name);
        directive
    };
    let activities = [named(1, "First"), named(2, "Twice"), named(3, "Twice"), named(4, "Bake2")];
    let mut file = written("names-0.json", &plan(&activities).to_string());
    for round in 1..=2 {
        let path = file.to_str().expect("a path");
        let again = told(&enroute(&["export", path, "--as", "plandev", "--epoch", "2024-08-02T00:00:00Z"]));
        let names = again["activities"].as_array().expect("directives").iter();
        let names: Vec<&str> = names.filter_map(|directive| directive["name"].as_str()).collect();
        assert_eq!(names, ["First", "Twice", "Twice", "Bake2"], "round {round}");
        file = written(&format!("names-{round}.json"), &again.to_string());
    }
}
