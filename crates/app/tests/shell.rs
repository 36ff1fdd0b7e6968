//! The shell as a user meets it: bars, workspaces, commands, dialogs, and the host's side of it.

mod support;

use std::rc::Rc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::host::{Remote as _, RemoteError};

#[test]
fn the_app_opens_with_the_enroute_mission_and_its_plan() {
    let mut app = support::start();
    app.settle();
    let state = app.json();
    assert_eq!(state["mission"], "enroute");
    assert_eq!(state["status"], "plan");
    assert_eq!(state["plan"]["choices"], json!({ "D1": 0 }));
    // SPEC 3.6.
    assert_eq!(state["plan"]["windows"]["Group-Traverse-Path#1.start"], json!([10, 55]));
    assert_eq!(state["verdict"]["valid"], true);
    app.harness.get_by_label("Status: plan found");
}

#[test]
fn nothing_on_the_bar_covers_the_workspaces_in_any_window() {
    for width in [800.0, 1_000.0, 1_100.0, 1_200.0, 1_245.0, 1_440.0] {
        let mut app = support::start_in(Rc::default(), |builder| builder.with_size([width, 600.0]));
        app.settle();
        let last = app.harness.get_by_label("Execute").rect();
        let status = app.harness.get_by_label("Status: plan found").rect();
        assert!(last.right() < status.left(), "{width} points: {last:?} {status:?}");
        // The longest that stands there.
        app.harness
            .state_mut()
            .run(workbench::command::Command::OpenSource { name: "broken".into(), source: "(".into() });
        app.settle();
        let status = app.harness.get_by_label_contains("Status: ").rect();
        assert!(last.right() < status.left(), "{width} points: {last:?} {status:?}");
    }
}

#[test]
fn the_workspace_tabs_switch_and_are_remembered_with_the_theme() {
    let mut app = support::start();
    app.settle();
    app.harness.get_by_label("Review").click();
    app.settle();
    assert_eq!(app.json()["workspace"], "review");
    app.harness.get_by_label("Light theme").click();
    app.settle();
    assert_eq!(app.json()["theme"], "light");
    let mut again = support::start_in(app.world.clone(), |builder| builder);
    again.settle();
    assert_eq!(again.json()["theme"], "light");
}

#[test]
fn the_palette_finds_a_command_by_its_letters_and_enter_runs_it() {
    let mut app = support::start();
    app.settle();
    app.harness.key_press(Key::F1);
    app.settle();
    assert_eq!(app.json()["dialog"], "palette");
    app.harness.get_by_role_and_label(egui::Role::TextInput, "Command palette").type_text("tewo");
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["workspace"], "teach");
    assert_eq!(app.json()["dialog"], serde_json::Value::Null);
}

#[test]
fn the_palette_also_opens_with_control_shift_p_and_closes_with_escape() {
    let mut app = support::start();
    app.settle();
    app.harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::P);
    app.settle();
    assert_eq!(app.json()["dialog"], "palette");
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["dialog"], serde_json::Value::Null);
}

#[test]
fn the_key_list_names_every_shortcut_of_the_registry() {
    let mut app = support::start();
    app.settle();
    app.harness.get_by_label("Keyboard shortcuts").click();
    app.settle();
    assert_eq!(app.json()["dialog"], "keys");
    for spec in workbench::command::all_commands().filter(|spec| !spec.keys.is_empty()) {
        assert!(
            app.harness.query_all_by_label(spec.title).next().is_some(),
            "{} is not in the key list",
            spec.title
        );
    }
}

#[test]
fn the_mission_picker_opens_another_example() {
    let mut app = support::start();
    app.settle();
    app.harness.get_by_label("Mission").click();
    app.settle();
    app.harness.get_by_label("Threats").click();
    app.settle();
    assert_eq!(app.json()["mission"], "threats");
    assert_eq!(app.json()["caret"], json!({ "anchor": 0, "head": 0 }));
}

#[test]
fn a_closed_panel_comes_back() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().dispatch("view.closePanel", &json!({ "name": "timeline" })).expect("a panel");
    app.settle();
    assert!(app.harness.query_by_label("Timeline").is_none());
    app.harness.state_mut().dispatch("view.panel", &json!({ "name": "timeline" })).expect("a panel");
    app.settle();
    app.harness.get_by_label("Timeline");
}

#[test]
fn a_host_page_can_drive_the_app_and_is_told_what_is_wrong_with_a_call() {
    let mut app = support::start();
    app.settle();
    let enroute = app.harness.state_mut();
    enroute.set_source("scenario S[0,10] = { delay[5,5] }");
    enroute.dispatch("view.workspace", &json!({ "name": "teach" })).expect("a workspace");
    assert_eq!(enroute.source(), "scenario S[0,10] = { delay[5,5] }");
    assert!(matches!(enroute.open("nowhere"), Err(RemoteError::UnknownMission { .. })));
    assert!(matches!(enroute.dispatch("no.such", &json!(null)), Err(RemoteError::UnknownCommand { .. })));
    assert!(matches!(
        enroute.dispatch("view.workspace", &json!({ "name": "kitchen" })),
        Err(RemoteError::BadArguments { .. })
    ));
    app.settle();
    let state = app.json();
    assert_eq!(state["workspace"], "teach");
    assert_eq!(state["status"], "plan");
    assert_eq!(state["plan"]["windows"]["delay#1.end"], json!([5, 5]));
    assert_eq!(state["revision"], state["shownRevision"]);
}

#[test]
fn a_shorter_window_of_the_path_leaves_no_plan_and_undo_brings_it_back() {
    let mut app = support::start();
    app.settle();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("PATH1=OK [450,450]", "PATH1=OK [404,404]"));
    app.settle();
    assert_eq!(app.json()["status"], "no-plan");
    app.harness.get_by_label("Status: no plan");
    app.harness.state_mut().dispatch("edit.undo", &json!(null)).expect("something to undo");
    app.settle();
    assert_eq!(app.json()["status"], "plan");
    assert_eq!(app.harness.state().source(), source);
}

#[test]
fn an_error_in_the_text_keeps_the_last_good_network_and_says_so() {
    let mut app = support::start();
    app.settle();
    let nodes = app.json()["tpn"]["nodes"].clone();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("choose {", "choose"));
    app.settle();
    let state = app.json();
    assert_eq!(state["status"], "broken");
    assert_eq!(state["isStale"], true);
    assert_eq!(state["tpn"]["nodes"], nodes);
    assert!(!state["diagnostics"].as_array().expect("a list").is_empty());
}

#[test]
fn time_plays_to_the_end_of_the_plan_and_stops() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().dispatch("play.toggle", &json!(null)).expect("there is a plan");
    assert_eq!(app.json()["isPlaying"], true);
    for _ in 0..200 {
        app.world.now_secs.set(app.world.now_secs.get() + 0.2);
        app.harness.step();
    }
    let state = app.json();
    assert_eq!(state["isPlaying"], false);
    assert_eq!(state["time"], state["endTime"]);
    assert_eq!(state["endTime"], 660.0);
}

#[test]
fn saving_hands_the_text_to_the_host() {
    let mut app = support::start();
    app.settle();
    app.harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    app.settle();
    let saved = app.world.saved.borrow();
    let (name, bytes) = saved.first().expect("a file");
    assert_eq!(name, "enroute.rmpl");
    assert_eq!(bytes, app.harness.state().source().as_bytes());
}

#[test]
fn the_address_opens_a_mission_in_a_workspace() {
    let world = std::rc::Rc::<support::World>::default();
    "mission=threats&workspace=review".clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder);
    app.settle();
    assert_eq!(app.json()["mission"], "threats");
    assert_eq!(app.json()["workspace"], "review");
}
