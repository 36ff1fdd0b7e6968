//! A run against the environment, chosen by the user: in its panel, on the timeline, and in the page's state; and the
//! run in which a mission fails that does not withstand the environment.

use crate::support;
use egui::Role;
use egui_kittest::kittest::Queryable as _;
use serde_json::{Value, json};
use workbench::host_io::Remote as _;

use crate::support::App;

fn opened(fragment: &str) -> App {
    let world = std::rc::Rc::<support::World>::default();
    fragment.clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder.with_size([1440.0, 900.0]));
    app.settle();
    app
}

fn click(app: &mut App, name: &str) {
    app.harness.get_by_role_and_label(Role::Button, name).click();
    app.settle();
}

fn run(app: &App) -> Value {
    app.json()["pinned"]["run"].clone()
}

#[test]
fn the_user_ends_what_nature_chooses_and_the_executive_follows() {
    let mut app = opened("mission=storm&workspace=teach");
    app.harness.state_mut().dispatch("view.panel", &json!({ "name": "strategy" })).expect("a panel");
    app.settle();
    assert_eq!(run(&app), Value::Null);
    click(&mut app, "Start run");
    for _ in 0..20 {
        if run(&app)["underWay"]["Drive#1"] != Value::Null {
            break;
        }
        click(&mut app, "Advance time");
    }
    let before = run(&app);
    assert_eq!(before["now"], json!(0.0));
    assert_eq!(before["underWay"]["Drive#1"], json!([20, 40]));
    click(&mut app, "End Drive#1 at 20");
    let after = run(&app);
    assert_eq!(after["now"], json!(20.0));
    let starts = |run: &Value, name: &str| {
        let acts = run["acts"].as_array().cloned().unwrap_or_default();
        acts.iter()
            .find(|act| {
                act["events"].as_array().is_some_and(|events| events.iter().any(|event| event == name))
            })
            .map(|act| act["time"].clone())
    };
    assert_eq!(starts(&after, "Survey#1.start"), Some(json!(20.0)), "the executive goes on at once: {after}");
    assert_eq!(app.json()["pinned"]["windows"]["Survey#1.start"], json!([20, 20]));
    click(&mut app, "Undo last step");
    assert_eq!(run(&app)["now"], json!(0.0));
    assert_eq!(starts(&run(&app), "Survey#1.start"), None);
    for _ in 0..40 {
        if run(&app)["next"] == Value::Null {
            break;
        }
        click(&mut app, "Advance time");
    }
    app.harness.get_by_label_contains("the plan held");
    let over = run(&app);
    assert_eq!(starts(&over, "Survey#1.start"), Some(json!(40.0)), "the drive lasted as long as it can");
    click(&mut app, "Restart");
    assert_eq!(run(&app), Value::Null);
}

#[test]
fn a_mission_that_nature_breaks_shows_the_run_in_which_it_fails() {
    let mut app = opened("mission=storm");
    let example = workbench::mission_file::example("storm").expect("an example");
    let source = example.source.replace("[20,40] moves", "[20,45] moves");
    app.harness.state_mut().dispatch("edit.setSource", &json!({ "text": source })).expect("a text");
    app.settle();
    let state = app.json();
    assert_eq!(state["status"], json!("no-plan"), "{state}");
    app.harness.get_by_label_contains("Counterexample");
    app.harness.get_by_label_contains("ends Drive");
}
