//! Missions that are drawn: activities made, moved, wrapped and deleted in network, timeline and map, as edits of the text.

use crate::support;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::command::Command;
use workbench::host_io::Remote as _;

const MISSION: &str = "\
primitive Wake()[1,2];
primitive Dig(what)[2,4];
primitive Rest()[5,8];

scenario S[0,60] = {
  Wake();
  Dig(ROCK);
  Rest()
}
";

fn showing(source: &str) -> support::App {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 1100.0]));
    app.settle();
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: source.to_owned() });
    app.settle();
    app.settle();
    app
}

fn dispatch(app: &mut support::App, command: &str, arguments: &serde_json::Value) {
    app.harness.state_mut().dispatch(command, arguments).expect("a command that can be used");
    app.settle();
}

fn scenario(app: &support::App) -> String {
    let source = app.harness.state().source();
    source.split_once("scenario ").map(|(_, rest)| rest.to_owned()).unwrap_or_default()
}

fn press(app: &mut support::App, pos: Pos2, button: PointerButton, pressed: bool) {
    app.harness.event(Event::PointerMoved(pos));
    app.harness.step();
    app.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    app.harness.step();
}

fn click(app: &mut support::App, at: Pos2, button: PointerButton) {
    press(app, at, button, true);
    press(app, at, button, false);
    app.settle();
}

fn in_network(app: &support::App, name: &str) -> Pos2 {
    app.harness.get_by_label(&format!("{name} in the network")).rect().center()
}

/// Opens the menu of something in the network, and goes through it by its entries.
fn choose(app: &mut support::App, name: &str, entries: &[&str]) {
    let at = in_network(app, name);
    click(app, at, PointerButton::Secondary);
    choose_in_menu(app, entries);
}

fn choose_in_menu(app: &mut support::App, entries: &[&str]) {
    for entry in entries {
        app.harness.get_by_role_and_label(egui::Role::MenuItem, entry).click();
        app.settle();
        app.settle();
    }
}

fn type_name(app: &mut support::App, name: &str) {
    app.harness.event(Event::Text(name.to_owned()));
    app.settle();
    app.settle();
}

#[test]
fn each_entry_of_the_menu_is_one_edit_and_undo_takes_it_back() {
    let mut app = showing(MISSION);
    let cases: [(&[&str], &str); 6] = [
        (&["Make optional"], "Wake();\n  optional Dig(ROCK);\n"),
        (&["Wrap in choice"], "Wake();\n  choose {\n    Dig(ROCK)\n  };\n"),
        (&["Allow any order with next"], "unordered {\n    Dig(ROCK);\n    Rest()\n  }\n"),
        (&["Move later"], "Wake();\n  Rest();\n  Dig(ROCK)\n"),
        (&["Delete"], "Wake();\n  Rest()\n"),
        (&["Add after", "Rest()"], "Dig(ROCK);\n  Rest();\n  Rest()\n"),
    ];
    for (entries, expected) in cases {
        choose(&mut app, "Dig(ROCK)", entries);
        assert!(scenario(&app).contains(expected), "{entries:?}: {}", scenario(&app));
        assert_eq!(app.json()["status"], "plan", "{entries:?}");
        dispatch(&mut app, "edit.undo", &json!(null));
        assert_eq!(app.harness.state().source(), MISSION, "{entries:?}");
        app.settle();
    }
}

#[test]
fn the_name_of_a_new_activity_is_typed_over_it_in_all_places() {
    let mut app = showing(MISSION);
    choose(&mut app, "Wake#1", &["Add after", "New activity"]);
    type_name(&mut app, "Look-Around");
    let source = app.harness.state().source();
    assert!(source.contains("primitive Look-Around()[1,5];"), "{source}");
    assert!(source.contains("Wake();\n  Look-Around();\n  Dig(ROCK);"), "{source}");
    assert_eq!(app.json()["status"], "plan");
    choose(&mut app, "Dig(ROCK)", &["Rename…"]);
    assert_eq!(app.json()["dialog"], "rename");
    type_name(&mut app, "Drill");
    app.harness.key_press(Key::Enter);
    app.settle();
    let source = app.harness.state().source();
    assert!(source.contains("primitive Drill(what)") && source.contains("Drill(ROCK);"), "{source}");
}

#[test]
fn keys_add_move_and_delete_what_is_selected_in_the_network() {
    let mut app = showing(MISSION);
    let at = in_network(&app, "Dig(ROCK)");
    click(&mut app, at, PointerButton::Primary);
    app.harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::ArrowLeft);
    app.settle();
    app.settle();
    assert!(scenario(&app).contains("Dig(ROCK);\n  Wake();\n  Rest()"), "{}", scenario(&app));
    assert_eq!(app.json()["selection"]["name"], "Dig#1", "it stays selected");
    app.harness.key_press(Key::Delete);
    app.settle();
    app.settle();
    assert!(scenario(&app).contains("{\n  Wake();\n  Rest()\n}"), "{}", scenario(&app));
    dispatch(&mut app, "edit.undo", &json!(null));
    app.settle();
    assert_eq!(app.json()["selection"]["name"], "Dig#1", "what comes back is selected again");
}

#[test]
fn statements_are_copied_from_the_drawing_and_pasted_into_it() {
    let mut app = showing(MISSION);
    let at = in_network(&app, "Dig(ROCK)");
    click(&mut app, at, PointerButton::Primary);
    app.harness.event(Event::Cut);
    app.settle();
    app.settle();
    assert!(scenario(&app).contains("{\n  Wake();\n  Rest()\n}"), "{}", scenario(&app));
    let at = in_network(&app, "Rest#1");
    click(&mut app, at, PointerButton::Primary);
    app.harness.event(Event::Paste("Dig(ROCK);\nWake()\n".to_owned()));
    app.settle();
    app.settle();
    assert!(scenario(&app).contains("Rest();\n  Dig(ROCK);\n  Wake()\n}"), "{}", scenario(&app));
    // Text that is not a statement is refused with a message.
    let before = app.harness.state().source();
    app.harness.event(Event::Paste("} nonsense {".to_owned()));
    app.settle();
    assert_eq!(app.harness.state().source(), before);
    assert!(app.json()["toasts"].to_string().contains("syntax error"), "{}", app.json()["toasts"]);
}

#[test]
fn a_selected_activity_is_dragged_to_another_place_in_network_and_timeline() {
    let mut app = showing(MISSION);
    let from = in_network(&app, "Wake#1");
    click(&mut app, from, PointerButton::Primary);
    let to = app.harness.get_by_label("Rest#1 in the network").rect();
    let to = to.right_center() - vec2(2.0, 0.0);
    press(&mut app, from, PointerButton::Primary, true);
    for part in [0.3, 0.6, 1.0] {
        app.harness.event(Event::PointerMoved(from + (to - from) * part));
        app.settle();
    }
    assert_eq!(app.harness.state().source(), MISSION, "nothing is done before the button is let go");
    press(&mut app, to, PointerButton::Primary, false);
    app.settle();
    app.settle();
    assert!(scenario(&app).contains("{\n  Dig(ROCK);\n  Rest();\n  Wake()\n}"), "{}", scenario(&app));
}

#[test]
fn a_mission_is_built_by_drawing_alone() {
    let mut app = showing("");
    app.harness.get_by_label("Add activity").click();
    app.settle();
    type_name(&mut app, "Wake-Up");
    app.settle();
    assert_eq!(app.json()["status"], "plan", "{}", app.harness.state().source());
    // The ground, a rover on it, and a place to go.
    app.harness.get_by_label("Add terrain and location").click();
    app.settle();
    app.settle();
    dispatch(&mut app, "terrain.top", &json!(null));
    for _ in 0..20 {
        app.settle();
    }
    let base = app.harness.get_by_label("BASE on the map").rect().center();
    click(&mut app, base, PointerButton::Secondary);
    choose_in_menu(&mut app, &["Add ATRV here"]);
    type_name(&mut app, "Scout");
    let ground = base + vec2(40.0, -30.0);
    click(&mut app, ground, PointerButton::Secondary);
    choose_in_menu(&mut app, &["Add location here"]);
    type_name(&mut app, "CRATER");
    app.settle();
    // The site onto the rover's lane: the drive and the visit.
    let crater = app.harness.get_by_label("CRATER on the map").rect();
    let crater = crater.center_bottom() + vec2(0.0, 3.0);
    click(&mut app, crater, PointerButton::Primary);
    let lane = app.harness.get_by_label_contains("Time axis").rect().center_bottom() + vec2(0.0, 60.0);
    press(&mut app, crater, PointerButton::Primary, true);
    for part in [0.2, 0.5, 0.8, 1.0] {
        app.harness.event(Event::PointerMoved(crater + (lane - crater) * part));
        app.settle();
    }
    let target = {
        let mut boxes =
            app.harness.query_all_by_label_contains("Send Scout to CRATER").map(|it| it.rect().center());
        boxes.next_back().expect("a place for the rover")
    };
    press(&mut app, target, PointerButton::Primary, false);
    app.settle();
    app.settle();
    let source = app.harness.state().source();
    assert!(source.contains("Drive(Scout, CRATER);"), "{source}");
    assert!(source.contains("Visit(Scout, CRATER)"), "{source}");
    assert!(source.contains("location CRATER ("), "{source}");
    assert_eq!(app.json()["status"], "plan", "{source}\n{}", app.json()["diagnostics"]);
    choose(&mut app, "Wake-Up#1", &["Set duration"]);
    type_name(&mut app, "2,3");
    let source = app.harness.state().source();
    assert!(source.contains("Wake-Up()[2,3]"), "{source}");
    assert_eq!(app.json()["status"], "plan", "{source}");
}

/// Drags from one place to another, and says what the text is before the button is released.
fn drag(app: &mut support::App, from: Pos2, to: Pos2) -> String {
    press(app, from, PointerButton::Primary, true);
    for part in [0.3, 0.6, 1.0] {
        app.harness.event(Event::PointerMoved(from + (to - from) * part));
        app.settle();
    }
    let before = app.harness.state().source();
    press(app, to, PointerButton::Primary, false);
    app.settle();
    app.settle();
    before
}

#[test]
fn a_drag_from_the_connector_lets_another_activity_start_after_the_selected_one() {
    const CONSTRAINT: &str = "constrain Wake1.end to Rest1.start [0,inf];";
    let mut app = showing(MISSION);
    let from = in_network(&app, "Wake#1");
    click(&mut app, from, PointerButton::Primary);
    let shown = app.harness.query_all_by_label("Connect Wake#1").map(|it| it.rect().center());
    let connectors: Vec<Pos2> = shown.collect();
    let rest = in_network(&app, "Rest#1");
    let mut bars = app.harness.query_all_by_label_contains("Rest#1: starts");
    let on_timeline = bars.next().expect("a bar").rect().center();
    drop(bars);
    assert_eq!(connectors.len(), 2, "one in the network, one on the timeline");
    for target in [rest, on_timeline] {
        let connector =
            connectors.iter().min_by(|a, b| (a.y - target.y).abs().total_cmp(&(b.y - target.y).abs()));
        let connector = *connector.expect("a connector");
        let before = drag(&mut app, connector, target);
        assert_eq!(before, MISSION, "nothing is done before the button is released");
        let source = app.harness.state().source();
        assert!(source.contains(CONSTRAINT), "{source}");
        assert_eq!(app.json()["status"], "plan", "{source}");
        dispatch(&mut app, "edit.undo", &json!(null));
        assert_eq!(app.harness.state().source(), MISSION, "one step back");
        app.settle();
    }
}

#[test]
fn what_is_pasted_is_declared_where_the_mission_lacks_it() {
    let mut app = showing(MISSION);
    dispatch(&mut app, "draw.paste", &json!("Look(ROCK, 2); Wake(); Look(ROCK, 3)"));
    app.settle();
    let source = app.harness.state().source();
    assert!(source.contains("primitive Rest()[5,8];\nprimitive Look(p1, p2)[1,5];"), "{source}");
    assert!(source.contains("Rest();\n  Look(ROCK, 2); Wake(); Look(ROCK, 3)"), "{source}");
    assert_eq!(app.json()["status"], "plan", "{}", app.json()["diagnostics"]);
    dispatch(&mut app, "edit.undo", &json!(null));
    assert_eq!(app.harness.state().source(), MISSION);
}

#[test]
fn a_new_scenario_and_its_declarations_go_to_the_file_that_is_shown() {
    let places = "location BASE (0, 0);\n";
    let whole = rmpl::files::joined([("", "import \"world.rmpl\";\n"), ("world.rmpl", places)]);
    let mut app = showing(&whole);
    dispatch(&mut app, "draw.paste", &json!("Wake()"));
    app.settle();
    let source = app.harness.state().source();
    let files = rmpl::files::split(&source);
    let expected = "import \"world.rmpl\";\n\nprimitive Wake()[1,5];\n\nscenario Mission = {\n  Wake()\n}";
    assert_eq!(files[0].1.trim_end(), expected);
    assert_eq!(files[1].1, places);
}
