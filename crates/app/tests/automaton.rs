//! A control program as a user meets it: opened, stepped, broken, watched.

mod support;

use app::host::Remote as _;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;

fn opened(source: &str) -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().set_source(source);
    app.settle();
    app
}

fn orbit_insertion() -> support::App {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().open("orbit-insertion").expect("it is an example");
    app.settle();
    app
}

fn press(app: &mut support::App, name: &str) {
    app.harness.get_by_role_and_label(Role::Button, name).scroll_to_me();
    app.settle();
    app.harness.get_by_role_and_label(Role::Button, name).click();
    app.settle();
}

/// The names of the buttons that stand for marked locations.
fn marked(app: &support::App) -> Vec<String> {
    let buttons = app.harness.query_all_by_role(Role::Button);
    let mut names: Vec<String> = buttons
        .filter_map(|node| node.accesskit_node().label())
        .filter_map(|label| label.strip_suffix(", marked").map(str::to_owned))
        .collect();
    names.sort();
    names
}

/// SPEC 8.4, nominal: five, five minus the camera, and after three steps the goal to fire and the reserve.
#[test]
fn orbit_insertion_shows_its_marking_step_by_step() {
    let mut app = orbit_insertion();
    let names = |app: &support::App| {
        marked(app)
            .iter()
            .map(|name| name.split(':').next().unwrap_or_default().to_owned())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&app), ["a1", "a2", "a3", "w1", "w2"]);
    press(&mut app, "Step");
    assert_eq!(names(&app), ["a1", "a2", "w1", "w2"]);
    press(&mut app, "Step");
    press(&mut app, "Step");
    assert_eq!(
        marked(&app),
        ["a4: assert EngineA=Firing", "w2: when (EngineA=Failed AND EngineB=Standby AND Camera=Off)"]
    );
    press(&mut app, "Step back");
    press(&mut app, "Step back");
    assert_eq!(names(&app), ["a1", "a2", "w1", "w2"]);
}

#[test]
fn the_keys_that_step_through_plans_step_the_program() {
    let mut app = orbit_insertion();
    app.harness.key_press(egui::Key::Period);
    app.settle();
    assert_eq!(marked(&app).len(), 4, "one step on");
    app.harness.key_press(egui::Key::Comma);
    app.settle();
    assert_eq!(marked(&app).len(), 5, "and back");
}

#[test]
fn a_fault_is_injected_by_pressing_a_component() {
    let mut app = orbit_insertion();
    press(&mut app, "Step");
    press(&mut app, "Step");
    press(&mut app, "EngineA");
    press(&mut app, "Failed");
    press(&mut app, "Step");
    press(&mut app, "Step");
    assert_eq!(marked(&app), ["a5: assert EngineB=Firing"]);
    let tells_why = app.harness.query_all_by_label_contains("EngineA=Firing contradicts").next().is_some();
    assert!(tells_why, "the diagnosis says what contradicts what");
}

#[test]
fn a_program_is_no_mission_with_errors() {
    let app = orbit_insertion();
    assert_eq!(app.json()["status"], json!("program"));
    assert_eq!(app.json()["diagnostics"], json!([]));
    let app = opened("Main ():: (WHEN-DONEXT (start = on) (shutter = open))");
    assert_eq!(app.json()["status"], json!("program"));
}
