//! The panels that show what planning found: problems, plan, outline, timeline.

use crate::support;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;
use workbench::PanelKind;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::window::WindowCommand;

/// Shows the plan's tables where there is room for all of them.
fn show_windows(app: &mut support::App) {
    app.harness.state_mut().dispatch("view.workspace", &json!("review")).expect("a workspace");
    app.harness.state_mut().dispatch("view.panel", &json!("plan")).expect("a panel");
    app.settle();
}

#[test]
fn every_event_of_the_plan_is_listed_with_its_window() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 2200.0]));
    app.settle();
    show_windows(&mut app);
    // SPEC 3.6.
    for (event, window) in [
        ("Group-Enroute#1.start", "[10, 55]"),
        ("Group-Traverse-Path(PATH1_1, …, TAI_POS).end", "[415, 460]"),
        ("Group-Wait(TAI_HOLD1, TAI_HOLD2).end", "[415, 514]"),
        ("Group-Transmit(MCC, ARRIVED_TAI).end", "[415, 462]"),
        ("Group-Enroute#1.end", "[460, 595]"),
        ("Tell(PROCEED=OK)#1.start", "[460, 600]"),
        ("scenario#1.end", "[660, 800]"),
    ] {
        app.harness.get_by_role_and_label(Role::Button, &format!("{event} {window}"));
    }
}

#[test]
fn the_windows_are_sorted_by_the_column_that_is_clicked() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 2200.0]));
    app.settle();
    show_windows(&mut app);
    let top =
        |app: &support::App, label: &str| app.harness.get_by_role_and_label(Role::Button, label).rect().top();
    let (early, late) = ("scenario#1.start [0, 0]", "scenario#1.end [660, 800]");
    assert!(top(&app, early) < top(&app, late));
    app.harness.get_by_label("Sort by latest").click();
    app.settle();
    app.harness.get_by_label("Sort by latest").click();
    app.settle();
    assert!(top(&app, early) > top(&app, late));
}

#[test]
fn a_mission_without_a_plan_offers_a_change_of_bounds_that_gives_one() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 2200.0]));
    app.settle();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("PATH1=OK [450,450]", "PATH1=OK [404,404]"));
    app.settle();
    assert_eq!(app.json()["status"], "no-plan");
    let relaxations = app.json()["failure"]["relaxations"].clone();
    let label = relaxations[0].as_str().expect("a relaxation").to_owned();
    app.harness.get_by_label(&format!("Fix: {label}")).click();
    app.settle();
    assert_eq!(app.json()["status"], "plan");
}

#[test]
fn a_problem_leads_to_its_place_and_can_be_explained() {
    let mut app = support::start();
    app.settle();
    let source = "primitive Drive(to);\nscenario S = { Driv(A) }";
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: source.to_owned() });
    app.settle();
    app.harness.state_mut().run(Command::Window(WindowCommand::ShowPanel(PanelKind::Problems)));
    app.settle();
    let problem = app.json()["diagnostics"][0].clone();
    let code = problem["code"].as_str().expect("a code").to_owned();
    let place = format!("Line {}: {code}", problem["span"]["line"]);
    app.harness.get_by(|node| node.label().is_some_and(|label| label.starts_with(&place))).click();
    app.settle();
    assert_eq!(app.json()["caret"]["anchor"], problem["span"]["start"]);
    app.harness.get_by_label("Explain").click();
    app.settle();
    assert_eq!(app.json()["dialog"], "explain");
    app.harness.get_by_label("Close").click();
    app.settle();
    assert_eq!(app.json()["dialog"], serde_json::Value::Null);
}

#[test]
fn that_there_is_no_plan_is_listed_counted_and_mended_like_any_problem() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().run(Command::SetSource("scenario S[0,5] = {\n    delay[8,9]\n}\n".to_owned()));
    app.settle();
    app.harness.get_by_label("Status: no plan");
    app.harness.get_by_label_contains("1 error, ");
    app.harness.state_mut().run(Command::Window(WindowCommand::ShowPanel(PanelKind::Problems)));
    app.settle();
    let is_row = |label: String| label.contains("E-NOPLAN") && label.starts_with("Line ");
    app.harness.get_by(|node| node.label().is_some_and(is_row)).click();
    app.settle();
    app.harness.get_by_label("Show why");
    let diagnostics = app.json()["diagnostics"].as_array().expect("a list").clone();
    let no_plan = diagnostics.iter().find(|it| it["code"] == "E-NOPLAN").expect("a problem");
    let fix = no_plan["fixes"][0].as_str().expect("a fix").to_owned();
    let name = format!("Fix: {fix}");
    // The Plan panel offers the same, farther down than its room.
    app.harness.query_all_by_label(&name).next().expect("a fix to press").click();
    app.settle();
    assert_eq!(app.json()["status"], "plan");
    app.harness.get_by_label_contains("0 errors, ");
}

#[test]
fn what_is_selected_in_a_panel_is_shown_in_the_text_and_the_caret_stays() {
    let mut app = support::start();
    app.settle();
    let line_number = |app: &support::App, line: &str| {
        app.harness.output().shapes.iter().any(|shape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text() == line,
            _ => false,
        })
    };
    let source = app.harness.state().source();
    let call = source.rfind("Group-Enroute").expect("a call");
    let line = (source[..call].matches('\n').count() + 1).to_string();
    assert!(!line_number(&app, &line));
    app.harness.state_mut().dispatch("go.select", &json!("Group-Enroute#1")).expect("an occurrence");
    app.settle();
    assert!(line_number(&app, &line));
    assert_eq!(app.json()["caret"], json!({ "anchor": 0, "head": 0 }));
}

#[test]
fn a_click_on_the_time_axis_goes_to_that_time() {
    let mut app = support::start();
    app.settle();
    let axis = app.harness.get_by_label("Time axis").rect();
    app.harness.drag_at(axis.center());
    app.settle();
    app.harness.drop_at(axis.center());
    app.settle();
    let time = app.json()["time"].as_f64().expect("a time");
    assert!((300.0..500.0).contains(&time), "{time}");
}

#[test]
fn the_outline_lists_the_declarations_and_leads_to_them() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().dispatch("view.panel", &json!("outline")).expect("a panel");
    app.settle();
    app.harness.get_by_role_and_label(Role::Button, "location PATH1_2").click();
    app.settle();
    let source = app.harness.state().source();
    let at = source.find("PATH1_2").expect("a location");
    assert_eq!(app.json()["caret"]["anchor"], at);
}

#[test]
fn a_text_of_ten_thousand_lines_lays_out_only_what_is_seen() {
    let mut source = String::from("scenario S = {\n");
    for line in 0..10_000 {
        source.push_str(&format!("  Step-{line}()[1,2];\n"));
    }
    source.push('}');
    let world = std::rc::Rc::<support::World>::default();
    let mut app = support::start_in(std::rc::Rc::clone(&world), |builder| builder);
    app.settle();
    world.is_deaf.set(true);
    app.harness.state_mut().run(Command::OpenSource { name: "long".into(), source });
    app.harness.state_mut().dispatch("edit.select", &json!({ "start": 120_000 })).expect("an offset");
    app.settle();
    let lines = app.harness.output().shapes.iter().filter(|shape| is_line(&shape.shape)).count();
    assert!((10..120).contains(&lines), "{lines} lines of text are painted");
}

/// Returns whether a shape is a line of the long text.
fn is_line(shape: &egui::Shape) -> bool {
    match shape {
        egui::Shape::Text(text) => text.galley.text().contains("Step-"),
        egui::Shape::Vec(shapes) => shapes.iter().any(is_line),
        _ => false,
    }
}

#[test]
fn a_double_click_on_a_tab_gives_its_panel_the_window_and_another_puts_the_panels_back() {
    let mut app = support::start();
    app.settle();
    let shown = |app: &support::App| app.harness.state().app_state().window.panels_on_screen.clone();
    let all = shown(&app);
    assert!(all.len() > 3);
    let double_click = |app: &mut support::App| {
        for _ in 0..40 {
            app.settle();
        }
        for _ in 0..2 {
            app.harness.get_by_role_and_label(Role::Tab, "Network").click();
        }
        app.settle();
        app.settle();
    };
    double_click(&mut app);
    assert_eq!(shown(&app), [PanelKind::Network]);
    double_click(&mut app);
    assert_eq!(shown(&app), all);
    app.harness.key_press_modifiers(egui::Modifiers::ALT, egui::Key::Enter);
    app.settle();
    app.settle();
    assert_eq!(shown(&app), [PanelKind::Network], "the panel used last, by keys");
    app.harness.state_mut().dispatch("view.panel", &json!("plan")).expect("a panel");
    app.settle();
    app.settle();
    assert_eq!(shown(&app), all, "another panel that is asked for is seen");
}

#[test]
fn f6_gives_a_panel_the_keyboard_and_tab_goes_to_what_it_holds() {
    let mut app = support::start();
    app.settle();
    app.harness.key_press(egui::Key::F6);
    app.settle();
    app.settle();
    let active = app.harness.state().app_state().window.active_panel;
    assert_ne!(active, PanelKind::Editor);
    let region = panels::region_id(active);
    let focused = |app: &support::App| app.harness.ctx.memory(egui::Memory::focused);
    assert_eq!(focused(&app), Some(region));
    app.harness.get_by_role_and_label(Role::Group, active.title());
    app.harness.key_press(egui::Key::Tab);
    app.settle();
    let inside = focused(&app).expect("something has the keyboard");
    assert_ne!(inside, region);
    let place = app.harness.ctx.read_response(inside).expect("it is shown").rect;
    let tree_has_it = app.harness.state().app_state().window.panels_on_screen.contains(&active);
    assert!(tree_has_it && place.is_positive());
}

#[test]
fn letters_act_only_where_a_panel_was_turned_to() {
    let mut app = support::start();
    app.settle();
    app.harness.key_press(egui::Key::L);
    app.settle();
    assert!(!app.harness.state().app_state().lesson.is_beside(), "the text was used last");
    app.harness.key_press(egui::Key::F6);
    app.settle();
    app.harness.key_press(egui::Key::L);
    app.settle();
    assert!(app.harness.state().app_state().lesson.is_beside());
}

#[test]
fn a_mission_that_is_being_written_is_told_what_is_missing_and_a_button_writes_it() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 1200.0]));
    app.settle();
    let source = "location BASE (24, 52);\nvehicle Scout : ATRV at BASE;\n";
    app.harness.state_mut().run(Command::OpenSource { name: "test".into(), source: source.to_owned() });
    app.settle();
    app.harness.get_by_label("This mission has no scenario yet. With one, its plan appears here.");
    app.harness.get_by_label("This mission has no scenario yet. With one, its timeline appears here.");
    app.harness.get_by_label("Add scenario").click();
    app.settle();
    assert_eq!(app.json()["status"], "plan", "{}", app.json());
    assert!(app.harness.state().source().starts_with(source));
    app.harness
        .state_mut()
        .run(Command::OpenSource { name: "other".into(), source: "scenario (".to_owned() });
    app.settle();
    app.harness
        .get_by_label("The text has errors: see the Problems panel. Without them, its plan appears here.");
}

#[test]
fn what_is_of_an_earlier_text_is_marked_and_says_nothing_good_of_the_present_one() {
    let mut app = support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 1200.0]));
    app.settle();
    app.harness.get_by_label("Verified by the independent checker.");
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("vehicle Rover1 :", "vehicle ((Rover1 :"));
    app.settle();
    assert_eq!(app.json()["status"], "broken");
    let marks = app.harness.query_all_by_label("Out of date: the current text has errors").count();
    assert_eq!(marks, 3, "plan, timeline and terrain");
    assert!(app.harness.query_by_label("Verified by the independent checker.").is_none());
    app.harness.get_by_label("The independent checker verified this plan of a previous version.");
    app.harness.state_mut().set_source(&source);
    app.settle();
    assert!(app.harness.query_by_label_contains("Out of date").is_none());
    app.harness.get_by_label("Verified by the independent checker.");
}

/// In files, `Group-Wait#1` is a call's identifier. Nobody has to know which of several calls that is.
#[test]
fn calls_are_named_by_their_arguments_in_every_workspace() {
    for workspace in ["author", "teach", "review", "execute"] {
        let mut app =
            support::start_in(std::rc::Rc::default(), |builder| builder.with_size([1600.0, 1200.0]));
        app.settle();
        app.harness.state_mut().dispatch("view.workspace", &json!(workspace)).expect("a workspace");
        app.settle();
        let mut named = 0;
        for node in app.harness.root().children_recursive() {
            let node = node.accesskit_node();
            for text in [node.label(), node.value(), node.description()].into_iter().flatten() {
                named += usize::from(text.contains("Group-Wait(TAI_HOLD1, TAI_HOLD2)"));
                for activity in ["Group-Traverse-Path", "Group-Transmit", "Group-Wait"] {
                    assert!(!text.contains(&format!("{activity}#")), "{workspace}: {text}");
                }
            }
        }
        assert!(named > 0, "{workspace}");
    }
}
