//! The shell as a user meets it: bars, workspaces, commands, dialogs, and the host's side of it.

use crate::support;
use std::rc::Rc;

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::host_io::Remote as _;

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
    for width in [680.0, 800.0, 1_000.0, 1_100.0, 1_200.0, 1_245.0, 1_440.0] {
        let mut app = support::start_in(Rc::default(), |builder| builder.with_size([width, 600.0]));
        app.settle();
        let is_list = app.harness.query_by_label("Workspace").is_some();
        assert_eq!(is_list, width < 880.0, "{width} points");
        let last = app.harness.get_by_label(if is_list { "Workspace" } else { "Lessons" }).rect();
        let status = app.harness.get_by_label("Status: plan found").rect();
        assert!(last.right() < status.left(), "{width} points: {last:?} {status:?}");
        // The longest that is there.
        app.harness
            .state_mut()
            .run(workbench::command::Command::OpenSource { name: "broken".into(), source: "(".into() });
        app.settle();
        let status = app.harness.get_by_label_contains("Status: ").rect();
        assert!(last.right() < status.left(), "{width} points: {last:?} {status:?}");
        assert!(!is_list || status.width() > 60.0, "{width} points: the words are there: {status:?}");
    }
}

#[test]
fn no_text_of_the_bars_lies_over_another_in_a_narrow_window() {
    for width in [333.0, 426.0, 500.0, 560.0, 640.0] {
        let mut app = support::start_in(Rc::default(), |builder| builder.with_size([width, 400.0]));
        app.settle();
        for bar in [
            egui::Rect::from_x_y_ranges(0.0..=2_000.0, 0.0..=40.0),
            egui::Rect::from_x_y_ranges(0.0..=2_000.0, 374.0..=402.0),
        ] {
            let texts: Vec<_> =
                app.texts(bar).into_iter().filter(|(text, _)| !text.trim().is_empty()).collect();
            assert!(!texts.is_empty(), "{width} points: nothing is in the bar");
            for (at, (text, rect)) in texts.iter().enumerate() {
                assert!(rect.right() <= width, "{width} points: {text} is cut off: {rect:?}");
                for (other, beside) in &texts[at + 1..] {
                    assert!(
                        !rect.shrink(0.5).intersects(beside.shrink(0.5)),
                        "{width} points: {text} and {other}"
                    );
                }
            }
        }
    }
}

#[test]
fn firefox_is_shown_the_keys_that_it_leaves_to_the_page() {
    for (is_firefox, keys) in [(false, "Ctrl+Shift+P  or  F1"), (true, "F1  or  Ctrl+Shift+P")] {
        let world: Rc<support::World> = Rc::default();
        world.is_firefox.set(is_firefox);
        let mut app = support::start_in(world, |builder| builder);
        app.settle();
        app.harness.get_by_label("Keyboard shortcuts").click();
        app.settle();
        app.harness.get_by_label(keys);
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
    for spec in workbench::registry::all_commands().filter(|spec| !spec.keys.is_empty()) {
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
    app.harness.get_by_label("Switch mission").click();
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
fn the_system_decides_on_light_or_dark_until_somebody_chooses() {
    let mut app = support::start();
    app.settle();
    assert_eq!(app.json()["theme"], "dark", "where the system says nothing");
    app.harness.input_mut().system_theme = Some(egui::Theme::Light);
    app.settle();
    assert_eq!(app.json()["theme"], "light");
    app.harness.state_mut().dispatch("view.theme", &serde_json::Value::Null).expect("a command");
    app.settle();
    assert_eq!(app.json()["theme"], "dark", "the other one, whatever the system says");
    app.harness.state_mut().dispatch("view.systemTheme", &serde_json::Value::Null).expect("a command");
    app.settle();
    assert_eq!(app.json()["theme"], "light");
}

#[test]
fn a_ring_is_drawn_around_a_panel_only_for_those_who_use_keys() {
    // The ring lies over everything else: one shape more or less tells whether it is there.
    let rings = |app: &support::App| {
        let accent = theme::DARK.accent;
        let is_ring = |shape: &egui::epaint::ClippedShape| {
            matches!(&shape.shape, egui::Shape::Rect(rect) if rect.stroke.color == accent
                && (rect.stroke.width - 1.5).abs() < 0.01)
        };
        app.harness.output().shapes.iter().filter(|shape| is_ring(shape)).count()
    };
    let mut app = support::start();
    app.settle();
    app.harness.get_by_label("Teach").click();
    app.settle();
    assert_eq!(app.json()["activePanel"], "search");
    assert_eq!(rings(&app), 0, "the pointer brought it there");
    app.harness.key_press(Key::F6);
    app.settle();
    if app.json()["activePanel"] == "editor" {
        app.harness.key_press(Key::F6);
        app.settle();
    }
    assert_eq!(rings(&app), 1, "a key brought it to {}", app.json()["activePanel"]);
}

#[test]
fn the_palette_turns_the_network_of_another_tool_into_rmpl() {
    let network = r#"{"network-id": "net", "net": {"tpn-type": "network", "begin-node": "a", "end-node": "b"},
        "a": {"tpn-type": "state", "activities": ["drive"]}, "b": {"tpn-type": "state", "activities": []},
        "drive": {"tpn-type": "activity", "name": "Drive", "end-node": "b", "constraints": ["bounds"]},
        "bounds": {"tpn-type": "temporal-constraint", "value": [2, 5], "end-node": "b"}}"#;
    let mut app = support::start();
    app.settle();
    let arguments = json!({ "text": network });
    app.harness.state_mut().dispatch("edit.setSource", &arguments).expect("a text");
    app.settle();
    app.harness.key_press(Key::F1);
    app.settle();
    app.harness.get_by_role_and_label(egui::Role::TextInput, "Command palette").type_text("to rmpl");
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    let source = app.harness.state().source();
    assert!(source.contains("Drive()[2,5]"), "{source}");
    assert_eq!(app.json()["status"], "plan");
}
