//! A mission as it is executed and disturbed by hand.

use crate::support;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::{Value, json};
use workbench::host::{FileKind, HostEvent};
use workbench::host_io::Remote as _;

fn executing(mission: &str) -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().open(mission).expect("it is an example");
    app.settle();
    press(&mut app, "Execute");
    app
}

/// A mission without a world, in which no one drives: its runs are worked out at once.
fn executing_text(source: &str) -> support::App {
    let mut app = support::start();
    app.settle();
    dispatch(&mut app, "edit.setSource", &json!({ "text": source }));
    press(&mut app, "Execute");
    app
}

const SCENARIO: &str = include_str!("../../../../tests/conformance/t01_enroute_scenario.rmpl");
const BOTH_PATHS: &str = include_str!("../../../../tests/conformance/t03_enroute_both_paths.rmpl");

fn press(app: &mut support::App, name: &str) {
    let role =
        if app.harness.query_by_role_and_label(Role::Tab, name).is_some() { Role::Tab } else { Role::Button };
    app.harness.get_by_role_and_label(role, name).scroll_to_me();
    app.settle();
    app.harness.get_by_role_and_label(role, name).click();
    app.settle();
}

fn dispatch(app: &mut support::App, command: &str, arguments: &Value) {
    app.harness.state_mut().dispatch(command, arguments).expect("the command can be used");
    app.settle();
}

/// The events of the log, by their kind.
fn kinds(execution: &Value) -> Vec<&str> {
    execution["log"].as_array().expect("a log").iter().filter_map(|entry| entry["event"].as_str()).collect()
}

/// Both paths open at different times: the rovers wait for the first one until 10, and the second opens at 300.
#[test]
fn withdrawing_the_window_of_path_1_while_the_rovers_wait_takes_two_presses_and_switches_to_path_2() {
    let mut app = executing("both-paths");
    let before = app.json();
    assert_eq!(before["execution"]["status"], "under-way");
    assert_eq!(before["plan"]["choices"], json!({ "D1": 0 }));
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    let after = app.json();
    assert_eq!(after["plan"]["choices"], json!({ "D1": 1 }), "the plan drawn is the new one");
    assert!(kinds(&after["execution"]).contains(&"violation"));
    assert!(kinds(&after["execution"]).contains(&"replanned"));
    assert_eq!(after["execution"]["status"], "under-way");
    let tells_why = app.harness.query_all_by_label_contains("Tell(PATH1=OK)#1 was withdrawn at 0").next();
    assert!(tells_why.is_some(), "the panel says why");
    dispatch(&mut app, "play.end", &Value::Null);
    assert_eq!(app.json()["execution"]["status"], "finished");
    dispatch(&mut app, "play.seek", &json!({ "time": 0 }));
    press(&mut app, "Remove: Tell(PATH1=OK)#1 ends at 0");
    assert_eq!(app.json()["plan"]["choices"], json!({ "D1": 0 }), "what is taken back did not happen");
}

/// The SPEC's windows after partial execution, on the mission with paths: the traverse has departed at 10.
#[test]
fn the_state_says_what_is_under_way_and_what_is_due() {
    let mut app = executing("enroute");
    dispatch(&mut app, "play.seek", &json!({ "time": 100 }));
    let execution = app.json()["execution"].clone();
    assert_eq!(execution["underWay"], json!(["Group-Traverse-Path#1"]));
    assert_eq!(execution["holding"], json!(["Tell(PATH1=OK)#1"]));
    assert_eq!(execution["deadline"], json!({ "event": "Group-Traverse-Path#1.end", "time": 460 }));
    assert!(execution["waitedFor"].as_array().is_some_and(|list| list.contains(&json!("Group-Wait#1"))));
    let windows = app.json()["plan"]["windows"].clone();
    assert_eq!(
        windows["Group-Traverse-Path#1.start"],
        json!([10, 10]),
        "what happened has no window any more"
    );
}

/// The rovers are driving along path 1 when it closes: they end that drive early and take path 2 when it opens.
#[test]
fn an_activity_that_was_ended_early_stays_on_the_timeline() {
    let mut app = executing("exploration");
    dispatch(&mut app, "play.seek", &json!({ "time": 100 }));
    let is_aborted = |app: &support::App| {
        let bars = app
            .harness
            .query_all_by_label_contains("Group-Traverse-Path(PATH1_1, …, TAI_POS): started 10, aborted 10");
        bars.count()
    };
    assert_eq!(is_aborted(&app), 0);
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    assert_eq!(app.json()["plan"]["choices"]["D1"], 1);
    dispatch(&mut app, "play.seek", &json!({ "time": 300 }));
    assert_eq!(is_aborted(&app), 1);
    dispatch(&mut app, "play.seek", &json!({ "time": 50 }));
    assert_eq!(is_aborted(&app), 0, "it has not happened yet");
}

#[test]
fn a_condition_withdrawn_on_the_way_stops_the_mission_safely_and_says_why() {
    let mut app = executing_text(SCENARIO);
    dispatch(&mut app, "play.seek", &json!({ "time": 100 }));
    let before = app.json()["execution"]["log"].clone();
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    let execution = app.json()["execution"].clone();
    assert_eq!(execution["status"], "stopped");
    let log = execution["log"].as_array().expect("a log").clone();
    let past = before.as_array().expect("a log").len();
    assert_eq!(log[..past], before.as_array().expect("a log")[..], "a disturbance does not change the past");
    let stops = app.harness.query_all_by_label_contains("Stopped safely at 100").next().is_some();
    assert!(stops, "the panel says that it stopped");
}

#[test]
fn a_saved_run_replays_exactly_and_a_changed_log_is_told() {
    let mut app = executing_text(BOTH_PATHS);
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    press(&mut app, "Save run…");
    let (name, bytes) = app.world.saved.borrow().last().cloned().expect("a file was saved");
    assert!(name.ends_with("-run.json"), "{name}");
    let last_toast = |app: &support::App| {
        let toasts = app.json()["toasts"].as_array().cloned().unwrap_or_default();
        toasts.last().and_then(|toast| toast.as_str().map(str::to_owned)).unwrap_or_default()
    };
    let open = |app: &mut support::App, bytes: Vec<u8>| {
        let event =
            HostEvent::FileOpened { kind: FileKind::Json, name: "run.json".to_owned(), bytes, token: None };
        app.world.news.borrow_mut().push_back(event);
        app.settle();
    };
    press(&mut app, "Restart");
    assert_eq!(app.json()["execution"]["disturbances"], json!([]));
    open(&mut app, bytes.clone());
    assert!(last_toast(&app).starts_with("Replay matches"), "{}", last_toast(&app));
    assert_eq!(app.json()["plan"]["choices"], json!({ "D1": 1 }));
    let mut changed: Value = serde_json::from_slice(&bytes).expect("JSON");
    changed["log"].as_array_mut().expect("a log").pop();
    open(&mut app, serde_json::to_vec(&changed).expect("it can be written"));
    assert!(last_toast(&app).contains("differs"), "{}", last_toast(&app));
}

/// The disturbances made by hand are those that a script holds.
#[test]
fn a_rover_is_stopped_and_an_obstacle_appears_from_the_time_shown_on() {
    let mut app = executing("detour");
    dispatch(&mut app, "play.seek", &json!({ "time": 5 }));
    press(&mut app, "Stop Scout");
    let stopped = app.json()["execution"].clone();
    let stop = json!({ "kind": "vehicle-slow", "vehicle": "Scout", "factor": 0, "from": 5, "until": 25 });
    assert_eq!(stopped["disturbances"], json!([stop]));
    let rock = json!({ "kind": "obstacle", "at": 5, "x": 150.0, "y": 70.4, "radius": 0.8 });
    dispatch(&mut app, "execute.disturb", &rock);
    let both = app.json()["execution"].clone();
    assert_eq!(both["disturbances"], json!([stop, rock]), "an obstacle replaces nothing");
    dispatch(&mut app, "play.end", &Value::Null);
    let end = app.json();
    assert_eq!(end["execution"]["status"], "finished");
    // The drive and the hand-over take 19.4 minutes at least, and 20 more stood still.
    assert!(end["time"].as_f64().is_some_and(|time| time > 39.0), "{}", end["time"]);
}

#[test]
fn a_click_on_the_ground_makes_an_obstacle_appear_at_the_time_shown() {
    let mut app = executing("both-paths");
    dispatch(&mut app, "play.seek", &json!({ "time": 100 }));
    let log = app.json()["execution"]["log"].clone();
    dispatch(&mut app, "terrain.appear", &Value::Null);
    assert_eq!(app.json()["terrain"]["tool"], "appear");
    let map = app.harness.query_all_by_role(Role::Image).find_map(|node| {
        let is_map = node.accesskit_node().label().is_some_and(|label| label.starts_with("Terrain"));
        is_map.then(|| node.rect())
    });
    // A place to the side of the paths, on which nothing else stands.
    let map = map.expect("the terrain");
    let pos = map.min + map.size() * egui::vec2(0.5, 0.66);
    app.harness.event(egui::Event::PointerMoved(pos));
    app.harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        app.harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
        app.harness.step();
    }
    app.settle();
    let state = app.json();
    let obstacle = &state["execution"]["disturbances"][0];
    assert_eq!(obstacle["kind"], "obstacle", "{}", state["execution"]["disturbances"]);
    assert_eq!((&obstacle["at"], &obstacle["radius"]), (&json!(100), &json!(5.0)));
    assert_eq!(state["terrain"]["tool"], "look");
    assert_eq!(state["execution"]["log"], log, "what happened until now stays as it was");
    dispatch(&mut app, "execute.reset", &Value::Null);
    assert_eq!(app.json()["execution"]["disturbances"], json!([]));
}

/// The camera that the mission starts fails while it comes up: what was to be set has not come, and the other camera looks.
#[test]
fn the_next_fault_of_the_plant_is_offered_and_sends_the_mission_to_the_other_camera() {
    let mut app = executing("flyby");
    assert_eq!(app.json()["plan"]["choices"], json!({ "D1": 0 }));
    dispatch(&mut app, "play.seek", &json!({ "time": 1 }));
    // The component and the mode that it can come into by a fault stand first in the lists.
    let mut nodes = app.harness.get_all_by_role_and_label(Role::Button, "Inject");
    nodes.next().expect("it can happen").scroll_to_me();
    drop(nodes);
    app.settle();
    let mut nodes = app.harness.get_all_by_role_and_label(Role::Button, "Inject");
    nodes.next().expect("it can happen").click();
    drop(nodes);
    app.settle();
    let fault = json!({ "kind": "fault", "activity": "Start-Up#1", "step": 1, "component": "CameraA", "mode": "Failed" });
    assert_eq!(app.json()["execution"]["disturbances"], json!([fault]));
    dispatch(&mut app, "play.end", &Value::Null);
    let state = app.json();
    assert_eq!(state["execution"]["status"], "finished");
    assert_eq!(state["plan"]["choices"], json!({ "D1": 1 }));
    let log = state["execution"]["log"].as_array().expect("a log");
    let happens = |name: &str| log.iter().any(|entry| entry["name"] == name);
    assert!(happens("Look#2.end") && !happens("Look#1.start"), "{log:?}");
    let says =
        |part: &str| log.iter().any(|entry| entry["reason"].as_str().is_some_and(|it| it.contains(part)));
    assert!(says("Calibrate#1 needs CameraA.mode=Ready"), "{log:?}");
    // Nothing goes otherwise that means nothing, or before now.
    let wrong = json!({ "kind": "duration", "activity": "Turn#1", "duration": -5 });
    let _ = app.harness.state_mut().dispatch("execute.disturb", &wrong);
    app.settle();
    assert_eq!(app.json()["execution"]["disturbances"], json!([fault]));
}

/// SPEC 9.3: an engine that fails in the third step is diagnosed in the fourth, and the other one takes over.
#[test]
fn a_component_fails_while_its_activity_runs_its_program() {
    let mut app = executing("orbit");
    let end = |app: &mut support::App| {
        dispatch(app, "play.end", &Value::Null);
        app.json()["time"].as_f64().expect("a time")
    };
    let nominal = end(&mut app);
    dispatch(&mut app, "play.seek", &json!({ "time": 0 }));
    let fault = json!({ "kind": "fault", "activity": "Insert#1", "step": 3, "component": "EngineA", "mode": "Failed" });
    assert!(app.harness.query_by_label_contains("of the plant controlled by Insert#1").is_some());
    dispatch(&mut app, "execute.disturb", &fault);
    assert_eq!(app.json()["execution"]["disturbances"], json!([fault]));
    let seen = end(&mut app);
    let log = app.json()["execution"]["log"].to_string();
    assert!(log.contains("EngineA goes to Failed"), "{log}");
    assert!(seen >= nominal, "{seen} after {nominal}");
}

#[test]
fn the_end_of_a_run_says_how_it_came_about_and_nothing_ends_while_a_change_is_simulated() {
    let says =
        |app: &support::App, words: &str| app.harness.query_all_by_label_contains(words).next().is_some();
    let mut app = executing("both-paths");
    dispatch(&mut app, "play.end", &Value::Null);
    assert!(says(&app, "as planned"));
    dispatch(&mut app, "play.seek", &json!({ "time": 0 }));
    // The run before the withdrawal has ended, but the run after it has not.
    app.world.is_slow.set(true);
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    dispatch(&mut app, "play.end", &Value::Null);
    assert!(says(&app, "Simulating the change…"));
    for words in ["Mission completed", "✓ finished", "as planned"] {
        assert!(!says(&app, words), "{words}");
    }
    app.world.is_slow.set(false);
    app.settle();
    dispatch(&mut app, "play.end", &Value::Null);
    assert!(says(&app, "after 1 replan"));
    assert!(!says(&app, "as planned"));
}

/// What was planned, what happened and what was replanned are on one timeline.
#[test]
fn the_timeline_shows_the_original_plan_and_the_turns_of_the_run() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 2400.0]));
    app.settle();
    app.harness.state_mut().open("both-paths").expect("it is an example");
    app.settle();
    press(&mut app, "Execute");
    let removed = |app: &support::App| !app.texts_of("Removed from the plan").is_empty();
    let flag = |app: &support::App| app.harness.query_all_by_label_contains("Replanned at 0").count();
    assert!(!removed(&app) && flag(&app) == 0);
    press(&mut app, "Withdraw Tell(PATH1=OK)#1");
    assert!(removed(&app), "the traverse of path 1 was planned");
    // In the Execution panel, and as a flag above the timeline, which goes to its time.
    assert_eq!(flag(&app), 2);
    dispatch(&mut app, "play.seek", &json!({ "time": 400 }));
    let flags = app.harness.query_all_by_role(Role::Button);
    let label = |node: &egui_kittest::Node<'_>| node.accesskit_node().label().unwrap_or_default();
    flags.into_iter().find(|node| label(node).starts_with("Replanned at 0")).expect("a flag").click();
    app.settle();
    assert_eq!(app.json()["time"], 0.0);
    let views = json!({ "name": "structure" });
    dispatch(&mut app, "view.grouping", &views);
    assert!(removed(&app), "in other lanes, too");
}

#[test]
fn what_may_go_wrong_next_is_in_sight_in_small_windows_too() {
    for size in [[1024.0, 700.0], [1280.0, 800.0], [1920.0, 1080.0]] {
        let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size(size));
        app.settle();
        app.harness.state_mut().open("both-paths").expect("it is an example");
        app.settle();
        dispatch(&mut app, "view.workspace", &json!("execute"));
        app.settle();
        let panel = app.harness.get_by_label("Execution panel").rect();
        for name in
            ["Withdraw Tell(PATH1=OK)#1", "Extend Group-Traverse-Path(PATH1_1, …, TAI_POS)", "Stop Rover1"]
        {
            let button = app.harness.get_by_role_and_label(Role::Button, name).rect();
            assert!(panel.contains_rect(button), "{size:?}: {name} at {button} in {panel}");
        }
    }
}

#[test]
fn stepping_goes_from_event_to_event_of_the_run() {
    let mut app = executing_text(BOTH_PATHS);
    dispatch(&mut app, "play.forward", &Value::Null);
    assert_eq!(app.json()["time"], 10.0);
    dispatch(&mut app, "play.back", &Value::Null);
    assert_eq!(app.json()["time"], 0.0);
}

#[test]
fn runs_with_chance_are_made_in_the_background_and_end_in_a_probability() {
    let mut app = executing("threats");
    dispatch(&mut app, "view.panel", &json!({ "name": "robustness" }));
    press(&mut app, "Run Monte Carlo");
    for _ in 0..40 {
        app.settle();
    }
    let robustness = app.json()["robustness"].clone();
    assert_eq!(robustness["runs"], 1000);
    assert_eq!(robustness["isRunning"], false);
    let share = robustness["probability"].as_f64().expect("a probability");
    let low = robustness["interval"][0].as_f64().expect("a number");
    let high = robustness["interval"][1].as_f64().expect("a number");
    assert!(low <= share && share <= high && high - low < 0.07, "{robustness}");
}
