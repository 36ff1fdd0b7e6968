//! The missions as a user meets them: the name on the bar, its menu, the list, and what is said of keeping.

use crate::support;
use std::rc::Rc;

use egui::{Event, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::command::Command;
use workbench::host_io::Remote as _;

use crate::support::{App, World};

fn start() -> App {
    let mut app = support::start();
    app.settle();
    app
}

fn names(app: &App) -> Vec<String> {
    let library = app.json()["library"]["missions"].clone();
    let missions = library.as_array().cloned().unwrap_or_default();
    missions.iter().filter_map(|it| it["name"].as_str().map(str::to_owned)).collect()
}

fn edit(app: &mut App, text: &str) {
    app.harness.state_mut().run(Command::SetSource(text.to_owned()));
    app.settle();
}

fn list(app: &mut App) {
    app.harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::O);
    app.settle();
    assert_eq!(app.json()["dialog"], "missions");
}

fn click(app: &mut App, label: &str) {
    app.harness.get_by_label(label).click();
    app.settle();
}

#[test]
fn the_name_on_the_bar_is_edited_in_place() {
    let mut app = start();
    app.harness.get_by_role_and_label(Role::TextInput, "Mission name").click();
    app.settle();
    app.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    app.settle();
    app.harness.event(Event::Text("Sol 12".to_owned()));
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!((app.json()["mission"].clone(), names(&app)), (json!("Sol 12"), vec!["Sol 12".to_owned()]));
    // Escape takes back what was typed.
    app.harness.get_by_role_and_label(Role::TextInput, "Mission name").click();
    app.settle();
    app.harness.event(Event::Text("wrong".to_owned()));
    app.settle();
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["mission"], "Sol 12");
}

#[test]
fn the_menu_beside_the_name_lists_the_missions_and_the_examples() {
    let mut app = start();
    edit(&mut app, "// mine\n");
    click(&mut app, "Switch mission");
    click(&mut app, "Threats");
    assert_eq!(app.json()["mission"], "threats");
    click(&mut app, "Switch mission");
    click(&mut app, "Enroute (copy)");
    assert_eq!(app.harness.state().source(), "// mine\n");
    click(&mut app, "Switch mission");
    click(&mut app, "New mission");
    assert_eq!(app.harness.state().source(), "");
}

#[test]
fn the_list_opens_renames_duplicates_deletes_and_brings_back() {
    let mut app = start();
    edit(&mut app, "// mine\n");
    list(&mut app);
    click(&mut app, "Duplicate Enroute (copy)");
    assert_eq!(names(&app).len(), 2);
    list(&mut app);
    click(&mut app, "Rename Enroute (copy 2)");
    app.harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    app.harness.event(Event::Text("Twin".to_owned()));
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert!(names(&app).contains(&"Twin".to_owned()), "{:?}", names(&app));
    click(&mut app, "Delete Twin");
    assert_eq!(names(&app), ["Enroute (copy)"]);
    // The list stays open over what is open now.
    assert_eq!(
        (app.json()["dialog"].clone(), app.json()["mission"].clone()),
        (json!("missions"), json!("Enroute (copy)"))
    );
    app.harness.get_by_label("Restore Twin").scroll_to_me();
    app.settle();
    click(&mut app, "Restore Twin");
    assert_eq!(names(&app).len(), 2);
    list(&mut app);
    app.harness.get_by_label("Open Enroute (copy)").scroll_to_me();
    app.settle();
    click(&mut app, "Open Enroute (copy)");
    assert_eq!(app.json()["dialog"], json!(null));
    assert_eq!(app.json()["mission"], "Enroute (copy)");
}

#[test]
fn escape_closes_a_menu_and_nothing_else() {
    let mut app = start();
    app.harness.state_mut().dispatch("edit.find", &json!(null)).expect("the find bar");
    app.settle();
    click(&mut app, "Switch mission");
    app.harness.get_by_label("New mission");
    app.harness.key_press(Key::Escape);
    app.settle();
    assert!(app.harness.query_by_label("New mission").is_none());
    app.harness.get_by_label("Close find bar");
}

#[test]
fn versions_are_kept_and_taken_back_in_the_list() {
    let mut app = start();
    edit(&mut app, "// one\n");
    list(&mut app);
    click(&mut app, "Save version…");
    app.harness.event(Event::Text("first".to_owned()));
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["library"]["missions"][0]["versions"], json!(["first"]));
    edit(&mut app, "// two\n");
    list(&mut app);
    click(&mut app, "Restore first");
    assert_eq!(app.json()["dialog"], json!(null), "{}", app.json()["toasts"]);
    assert_eq!(app.harness.state().source(), "// one\n");
}

#[test]
fn what_is_not_kept_is_said_on_the_bar_and_can_be_saved() {
    let world = Rc::<World>::default();
    world.is_full.set(true);
    let mut app = support::start_in(world, |builder| builder);
    app.settle();
    edit(&mut app, "// mine\n");
    click(&mut app, "Not saved");
    let saved = app.world.saved.borrow();
    assert_eq!(saved.first().map(|(name, _)| name.as_str()), Some("Enroute (copy).enroute"));
}

#[test]
fn the_list_closes_with_escape_and_a_name_being_typed_stays_as_it_was() {
    let mut app = start();
    edit(&mut app, "// mine\n");
    list(&mut app);
    click(&mut app, "Rename Enroute (copy)");
    app.harness.event(Event::Text("other".to_owned()));
    app.settle();
    app.harness.key_press(Key::Escape);
    app.settle();
    assert_eq!(app.json()["dialog"], json!(null));
    assert_eq!(names(&app), ["Enroute (copy)"]);
}
