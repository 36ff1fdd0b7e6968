//! The author's desk: nothing jumps, nothing is out of sight, and keys do what they say wherever the pointer was last.

use crate::support;
use egui::{Key, Modifiers, Rect, Role};
use egui_kittest::kittest::Queryable as _;
use serde_json::json;
use workbench::command::Command;
use workbench::host_io::Remote as _;

fn sized(size: [f32; 2]) -> support::App {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size(size));
    app.settle();
    app
}

fn dispatch(app: &mut support::App, command: &str, arguments: &serde_json::Value) {
    app.harness.state_mut().dispatch(command, arguments).expect("a command that can be used");
    app.settle();
}

fn places(app: &support::App) -> Vec<Rect> {
    let axis = app.harness.get_by_label("Time axis").rect();
    let images = app.harness.query_all_by_role(Role::Image).map(|image| image.rect());
    images.chain([axis]).collect()
}

#[test]
fn a_text_with_errors_moves_no_panel() {
    let mut app = sized([1440.0, 900.0]);
    let before = places(&app);
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("vehicle Rover1 :", "vehicle ((Rover1 :"));
    app.settle();
    assert_eq!(app.json()["status"], "broken");
    assert!(app.harness.query_all_by_label_contains("Out of date").next().is_some(), "it is said");
    assert_eq!(places(&app), before);
}

#[test]
fn space_plays_after_a_click_on_the_network() {
    let mut app = sized([1920.0, 1200.0]);
    let network = app.harness.query_all_by_role(Role::Image).find_map(|image| {
        let node = egui_kittest::kittest::NodeT::accesskit_node(&image);
        node.label().filter(|label| label.starts_with("Network. ")).map(|_| image.rect())
    });
    let at = network.expect("the network is shown").left_bottom() + egui::vec2(20.0, -20.0);
    for pressed in [true, false] {
        app.harness.event(egui::Event::PointerMoved(at));
        let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::NONE);
        app.harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        app.harness.step();
    }
    app.settle();
    assert_eq!(app.json()["isPlaying"], false);
    app.harness.key_press(Key::Space);
    app.settle();
    assert_eq!(app.json()["isPlaying"], true);
}

#[test]
fn the_fix_of_what_was_edited_last_is_first_and_in_sight() {
    let mut app = sized([1440.0, 900.0]);
    dispatch(&mut app, "view.panel", &json!("plan"));
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source);
    let start = source.find("PATH1=OK [450,450]").expect("the window of the path") + "PATH1=OK [".len();
    for side in [start + 4, start] {
        let span = rmpl::Span::new(side as u32, side as u32 + 3);
        let edits = vec![rmpl::Edit { span, text: "404".to_owned() }];
        app.harness.state_mut().run(Command::Edit { edits, kind: text_editing::EditKind::Single });
    }
    app.settle();
    assert_eq!(app.json()["status"], "no-plan");
    let fixes = app.harness.query_all_by_label_contains("Fix: ");
    let places: Vec<(Rect, String)> = fixes
        .map(|fix| {
            let label = egui_kittest::kittest::NodeT::accesskit_node(&fix).label().unwrap_or_default();
            (fix.rect(), label)
        })
        .collect();
    let region = app.harness.get_by_label("Plan panel").rect();
    let first = places.first().expect("a fix");
    assert!(region.contains_rect(first.0), "{first:?} in {region:?}");
    assert!(first.1.contains("PATH1"), "{places:?}");
    app.harness.query_all_by_label(&first.1).next().expect("the fix").click();
    app.settle();
    assert_eq!(app.json()["status"], "plan");
}

#[test]
fn choices_are_told_by_what_they_do() {
    let mut app = sized([1440.0, 1400.0]);
    dispatch(&mut app, "view.panel", &json!("plan"));
    app.settle();
    let taken = app.harness.query_all_by_label_contains("Group-Traverse-Path(PATH1_1, …, TAI_POS)").count();
    let others = app
        .harness
        .query_all_by_label_contains("instead of Group-Traverse-Path(PATH2_1, …, TAI_POS)")
        .count();
    assert!(taken > 0 && others == 1, "{taken} {others}");
    assert!(app.harness.query_by_label("0: Group-Traverse-Path(PATH1_1, …, TAI_POS)").is_none());
}

#[test]
fn the_settings_are_a_page() {
    let mut app = sized([1440.0, 900.0]);
    app.harness.key_press_modifiers(Modifiers::COMMAND, Key::Comma);
    app.settle();
    assert_eq!(app.json()["dialog"], "settings");
    app.harness.get_by_role_and_label(Role::RadioButton, "Light").click();
    app.settle();
    assert_eq!(app.json()["theme"], "light");
    app.harness.get_by_role_and_label(Role::CheckBox, "Word wrap").click();
    app.settle();
    assert!(app.harness.state().app_state().settings.views.editor.wraps);
}

#[test]
fn the_gallery_shows_what_each_example_is_about() {
    let mut app = sized([1440.0, 900.0]);
    dispatch(&mut app, "file.missions", &json!(null));
    app.settle();
    let about = "Drag a boulder into the gap and see the plan change to the long path.";
    app.harness.get_by_label(about);
    app.harness.get_by_role_and_label(Role::Button, "Detour").click();
    app.settle();
    assert_eq!(app.json()["mission"], "detour");
}

#[test]
fn toolbars_show_at_most_five_things_in_every_workspace() {
    for workspace in ["author", "teach", "review", "execute"] {
        let mut app = sized([1920.0, 1080.0]);
        dispatch(&mut app, "view.workspace", &json!(workspace));
        app.settle();
        let Some(field) = app.harness.query_by_label("Search the network") else { continue };
        let row = field.rect();
        let region = app.harness.get_by_label("Network panel").rect();
        let is_there = |rect: Rect| {
            region.contains(rect.center())
                && row.y_range().contains(rect.center().y)
                && rect.top() > region.top()
        };
        let buttons = app.harness.query_all_by_role(Role::Button).filter(|it| is_there(it.rect())).count();
        assert!(buttons <= 4, "{workspace}: the field and {buttons} buttons");
    }
}

#[test]
fn a_layout_is_saved_with_the_mission_and_comes_back_by_its_name() {
    let mut app = sized([1440.0, 900.0]);
    let has =
        |app: &support::App, panel: &str| app.harness.query_by_role_and_label(Role::Tab, panel).is_some();
    dispatch(&mut app, "view.closePanel", &json!("terrain"));
    app.settle();
    assert!(!has(&app, "Terrain"));
    dispatch(&mut app, "view.settings", &json!(null));
    let field = app.harness.get_by_label("Layout name");
    field.focus();
    app.settle();
    app.harness.get_by_label("Layout name").type_text("No map");
    app.settle();
    app.harness.get_by_label("Save layout").click();
    app.settle();
    dispatch(&mut app, "view.resetWorkspace", &json!(null));
    app.settle();
    assert!(has(&app, "Terrain"));
    // The mission's file contains the layout.
    let mission = app.harness.state().app_state().library.open_mission().expect("a mission").to_json();
    let read = workbench::library::Mission::from_json(&mission).expect("it is sound");
    assert_eq!(read.layouts[0].name, "No map");
    app.harness.get_by_label("Show layout No map").click();
    app.settle();
    app.settle();
    assert!(!has(&app, "Terrain"));
}

#[test]
fn menus_fit_into_a_small_window_and_their_last_entry_can_be_reached() {
    // What is read of an entry ends with its keys.
    fn entry<'a>(app: &'a support::App, name: &str) -> Option<egui_kittest::Node<'a>> {
        let is_it = |node: &egui_kittest::Node<'_>| {
            let label = egui_kittest::kittest::NodeT::accesskit_node(node).label();
            label.is_some_and(|label| label.starts_with(name))
        };
        app.harness.query_all_by_role(Role::MenuItem).find(is_it)
    }
    let open = |app: &mut support::App, name: &str| {
        entry(app, name).expect("it is in the menu").click();
        app.settle();
        app.settle();
    };
    for size in [[1440.0, 420.0], [1024.0, 700.0]] {
        let mut app = sized(size);
        if entry(&app, "Menu").is_some() {
            open(&mut app, "Menu");
        }
        open(&mut app, "View");
        let first = entry(&app, "Panels").expect("the first entry of the menu").rect();
        let last =
            |app: &support::App| entry(app, "Maximize or restore panel").expect("its last entry").rect();
        let is_seen = |rect: Rect| first.top() < rect.top() && rect.bottom() < size[1] - 8.0;
        assert!(is_seen(first.translate(egui::vec2(0.0, 1.0))), "{size:?}: {first}");
        for _ in 0..40 {
            if is_seen(last(&app)) {
                break;
            }
            let (unit, delta) = (egui::MouseWheelUnit::Point, egui::vec2(0.0, -60.0));
            let (modifiers, phase) = (Modifiers::NONE, egui::TouchPhase::Move);
            let source = egui::MouseWheelSource::Wheel;
            app.harness.event(egui::Event::PointerMoved(first.center() + egui::vec2(0.0, 90.0)));
            app.harness.event(egui::Event::MouseWheel { unit, delta, phase, modifiers, source });
            app.settle();
        }
        assert!(is_seen(last(&app)), "{size:?}: {}", last(&app));
    }
}
