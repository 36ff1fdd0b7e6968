//! The network panel as a user meets it: pointing, selecting, searching, collapsing, and a text with errors.

use crate::support;
use egui::Key;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::json;
use workbench::command::Command;
use workbench::host_io::Remote as _;
use workbench::state::Selection;
use workbench::state::settings::SettingsCommand;

fn started() -> support::App {
    let mut app = support::start();
    app.settle();
    app
}

/// The same in a window where all of the first mission is drawn.
fn roomy() -> support::App {
    let world = std::rc::Rc::<support::World>::default();
    let mut app = support::start_in(world, |builder| builder.with_size([1920.0, 1200.0]));
    app.settle();
    app
}

fn has(app: &support::App, label: &str) -> bool {
    app.harness.query_all_by_label(label).next().is_some()
}

#[test]
fn the_network_says_what_it_shows() {
    let app = started();
    let nodes = app.json()["tpn"]["nodes"]
        .as_array()
        .map(Vec::len)
        .or_else(|| app.json()["tpn"]["nodes"].as_u64().map(|count| count as usize));
    let nodes = nodes.expect("the state tells how many nodes there are");
    let found = app.harness.query_all_by_role(egui::Role::Image).any(|node| {
        node.accesskit_node().label().is_some_and(|label| {
            label.starts_with(&format!("Network. {nodes} events")) && label.contains("Chosen: D1=0.")
        })
    });
    assert!(found, "no image says so");
}

#[test]
fn clicking_an_activity_selects_it_everywhere() {
    let mut app = roomy();
    app.harness
        .get_by_role_and_label(egui::Role::Button, "Group-Wait(TAI_HOLD1, TAI_HOLD2) in the network")
        .click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Wait#1"));
    app.harness.get_by_role_and_label(egui::Role::Button, "D1 in the network").click();
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("D1"));
}

#[test]
fn searching_selects_one_match_after_the_other() {
    let mut app = roomy();
    let field = app.harness.get_by_role_and_label(egui::Role::TextInput, "Search the network");
    field.focus();
    app.settle();
    app.harness.get_by_role_and_label(egui::Role::TextInput, "Search the network").type_text("traverse");
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Traverse-Path#1"));
    app.harness.key_press(Key::Enter);
    app.settle();
    assert_eq!(app.json()["selection"]["name"], json!("Group-Traverse-Path#2"));
}

#[test]
fn a_text_with_errors_keeps_the_last_network_and_says_so() {
    let mut app = roomy();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&format!("{source}\nscenario {{"));
    app.settle();
    assert!(has(&app, "Group-Wait(TAI_HOLD1, TAI_HOLD2) in the network"), "the network is still there");
    let says_so = app.harness.query_all_by_role(egui::Role::Image).any(|node| {
        node.accesskit_node()
            .label()
            .is_some_and(|label| label.starts_with("Network of the last valid version"))
    });
    assert!(says_so);
}

#[test]
fn a_double_click_closes_an_activity_and_another_opens_it() {
    let mut app = roomy();
    let double_click = |app: &mut support::App, label: &str| {
        for _ in 0..2 {
            app.harness.get_by_role_and_label(egui::Role::Button, label).click();
        }
        app.settle();
        app.settle();
    };
    assert!(has(&app, "Group-Transmit(MCC, ARRIVED_TAI) in the network"));
    double_click(&mut app, "Group-Enroute#1 in the network");
    assert!(!has(&app, "Group-Transmit(MCC, ARRIVED_TAI) in the network"), "what is inside is hidden");
    // Apart from the clicks before, so that the four do not count as one.
    for _ in 0..40 {
        app.settle();
    }
    double_click(&mut app, "Group-Enroute#1 in the network");
    assert!(has(&app, "Group-Transmit(MCC, ARRIVED_TAI) in the network"), "and comes back");
}

/// The text of the file of this name that was saved.
fn saved(app: &support::App, name: &str) -> String {
    let saved = app.world.saved.borrow();
    let (_, bytes) = saved.iter().find(|(saved, _)| saved == name).expect("it was saved");
    String::from_utf8(bytes.clone()).expect("it is text")
}

#[test]
fn the_saved_picture_shows_what_is_switched_on_of_all_that_is_drawn() {
    let mut app = started();
    app.harness.state_mut().dispatch("file.networkSvg", &json!(null)).expect("there is a network");
    app.settle();
    app.settle();
    let svg = saved(&app, "enroute-network.svg");
    let nodes = app.json()["tpn"]["nodes"].as_u64().expect("a count");
    // Every event is a circle, and a decision is two.
    let decisions = app.json()["tpn"]["decisions"].as_u64().expect("a count");
    assert_eq!(svg.matches("<circle").count() as u64, nodes + decisions);
    for text in ["Group-Traverse-Path(PATH1_1", "Group-Wait(TAI_HOLD1", ">D1<", "[450,540]", "PROCEED=OK"] {
        assert!(svg.contains(text), "{text}");
    }
    app.world.saved.borrow_mut().clear();
    let mut views = app.harness.state().app_state().settings.views.clone();
    (views.network.bounds, views.network.unselected) = (false, false);
    app.harness
        .state_mut()
        .run(workbench::command::Command::Settings(SettingsCommand::SetViews(Box::new(views))));
    app.harness.state_mut().dispatch("file.networkSvg", &json!(null)).expect("there is a network");
    app.settle();
    app.settle();
    let svg = saved(&app, "enroute-network.svg");
    assert!(!svg.contains("[450,540]") && !svg.contains("PATH2_1"), "what is switched off is left out");
}

#[test]
fn a_picture_is_saved_as_often_as_it_is_asked_for() {
    let mut app = started();
    for _ in 0..2 {
        app.harness.state_mut().dispatch("file.networkPng", &json!(null)).expect("there is a network");
        for _ in 0..3 {
            app.settle();
        }
    }
    assert_eq!(app.world.saved.borrow().len(), 2);
    let [width, height] = app.world.picture_size.get();
    assert!(width > 1000 && height > 300, "{width} × {height}");
    assert!(saved(&app, "enroute-network.png").starts_with("<svg"), "hosts make the PNG");
}

#[test]
fn an_error_is_marked_at_the_activity_that_it_is_in() {
    let mut app = roomy();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(
        &source.replace("Group-Transmit(MCC,ARRIVED_TAI)[0,2]", "Group-Transmit(MCC,ARRIVED_TAI)[3,2]"),
    );
    app.settle();
    assert_eq!(app.json()["status"], "broken");
    let marks = app.harness.query_all_by_role(egui::Role::Button).filter_map(|node| {
        let label = node.accesskit_node().label()?;
        label.starts_with("Error on the network").then(|| (label, node.rect().center()))
    });
    let marks: Vec<_> = marks.collect();
    let [(label, at)] = marks.as_slice() else { panic!("{marks:?}") };
    let activity = app
        .harness
        .get_by_role_and_label(egui::Role::Button, "Group-Transmit(MCC, ARRIVED_TAI) in the network")
        .rect();
    assert!((*at - activity.center()).length() < 120.0, "{label} at {at}, the activity is at {activity}");
    app.harness.get_by_label(label).click();
    app.settle();
    let start = app.json()["caret"]["anchor"].as_u64().expect("an offset") as usize;
    assert!(app.harness.state().source()[start..].starts_with("[3,2]"), "the caret is at {start}");
}

#[test]
fn time_shows_on_the_network_while_it_is_not_at_the_start() {
    let mut app = started();
    let now = theme::DARK.now;
    let dots = |app: &support::App| {
        let is_dot = |shape: &&egui::epaint::ClippedShape| match &shape.shape {
            egui::Shape::Circle(circle) => circle.fill == now,
            _ => false,
        };
        app.harness.output().shapes.iter().filter(is_dot).count()
    };
    assert_eq!(dots(&app), 0);
    app.harness.state_mut().dispatch("play.seek", &json!(430)).expect("a time");
    app.settle();
    let under_way = dots(&app);
    app.harness.state_mut().dispatch("play.seek", &json!(660)).expect("a time");
    app.settle();
    assert!(0 < under_way && under_way < dots(&app), "{under_way}, then {}", dots(&app));
}

#[test]
fn lanes_carry_the_names_of_the_threads() {
    let mut app = started();
    let mut views = app.harness.state().app_state().settings.views.clone();
    views.network.lanes = true;
    app.harness
        .state_mut()
        .run(workbench::command::Command::Settings(SettingsCommand::SetViews(Box::new(views))));
    app.settle();
    let is_written = |name: &str| {
        app.harness.output().shapes.iter().any(|shape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text() == name,
            _ => false,
        })
    };
    assert!(is_written("Thread 1 · delay") || is_written("Thread 1 · Group-Enroute"));
}

/// A mission of one long sequence.
fn long(app: &mut support::App, steps: usize) {
    let calls: Vec<String> = (0..steps).map(|at| format!("Step{}()", at % 5)).collect();
    let declared: String = (0..5).map(|at| format!("primitive Step{at}()[1,5];\n")).collect();
    let source = format!("{declared}scenario Long = {{ {} }}\n", calls.join("; "));
    app.harness.state_mut().set_source(&source);
    for _ in 0..4 {
        app.settle();
    }
}

/// The names of the boxes that represent several activities.
fn folded(app: &support::App) -> Vec<String> {
    let buttons = app.harness.query_all_by_role(egui::Role::Button);
    let labels = buttons.filter_map(|node| node.accesskit_node().label());
    labels.filter(|label| label.ends_with(", collapsed, in the network")).collect()
}

#[test]
fn a_long_mission_is_boxes_that_open_and_the_overview_folds_them_again() {
    let mut app = started();
    long(&mut app, 600);
    let boxes = folded(&app);
    assert!((3..40).contains(&boxes.len()), "{boxes:?}");
    assert!(boxes.iter().all(|name| name.starts_with("Step")), "{boxes:?}");
    app.harness.query_all_by_label(&boxes[0]).next().expect("a box").focus();
    app.settle();
    app.harness.key_press(Key::Enter);
    app.settle();
    app.settle();
    assert_ne!(folded(&app), boxes, "the box is open");
    app.harness.get_by_role_and_label(egui::Role::Button, "Fit detail").click();
    app.settle();
    app.settle();
    assert_eq!(folded(&app), boxes);
}

#[test]
fn a_box_opens_where_the_selection_is() {
    let mut app = started();
    long(&mut app, 600);
    assert!(!has(&app, "Step1#61 in the network"));
    let shown = app.harness.state().app_state().shown().cloned().expect("a snapshot");
    let network = shown.network.as_ref().expect("a network");
    let at = network.occurrences.iter().position(|it| it.name == "Step1#61").expect("it is there");
    let selection = Selection::Occurrence(tpn::OccurrenceId::from_index(at));
    app.harness.state_mut().run(Command::Select(selection));
    app.settle();
    app.settle();
    assert!(has(&app, "Step1#61 in the network"), "{:?}", folded(&app));
}

/// A long mission with a choice in its middle, whose first alternative takes too long.
fn long_with_a_choice(app: &mut support::App) {
    let half = vec!["Step()"; 300].join("; ");
    let source = format!(
        "primitive Step()[1,1];\nprimitive Slow()[90,99];\nprimitive Quick()[2,3];\n\
         scenario Long[0,640] = {{ {half}; choose {{ Slow(), Quick() }}; {half} }}\n"
    );
    app.harness.state_mut().set_source(&source);
    for _ in 0..4 {
        app.settle();
    }
    assert!(!has(app, "Slow#1 in the network"), "it is in a box");
}

#[test]
fn a_box_opens_for_the_alternatives_of_a_selected_decision() {
    let mut app = started();
    long_with_a_choice(&mut app);
    app.harness.state_mut().run(Command::Select(Selection::Decision(tpn::DecisionId::from_index(0))));
    app.settle();
    app.settle();
    for name in ["Slow#1", "Quick#1"] {
        assert!(has(&app, &format!("{name} in the network")), "{name} is still in {:?}", folded(&app));
    }
}

#[test]
fn a_box_opens_for_what_a_key_step_is_about() {
    let mut app = started();
    long_with_a_choice(&mut app);
    let stops = json!({ "decision": true, "failure": false, "threat": false, "solution": false });
    let teach = json!("teach");
    for (command, arguments) in
        [("view.workspace", &teach), ("search.breakpoints", &stops), ("search.run", &json!(null))]
    {
        app.harness.state_mut().dispatch(command, arguments).expect("a search");
        app.settle();
    }
    for _ in 0..30 {
        app.settle();
    }
    assert_eq!(app.json()["search"]["known"]["event"], "decide");
    assert!(has(&app, "Slow#1 in the network"), "what is decided about is in {:?}", folded(&app));
}

#[test]
fn two_fingers_move_the_drawing() {
    let mut app = started();
    let place = |app: &support::App| app.harness.get_by_label("Group-Enroute#1 in the network").rect().min;
    let before = place(&app);
    let middle = app.harness.get_by(|node| {
        node.role() == egui::Role::Image && node.label().is_some_and(|label| label.starts_with("Network"))
    });
    let middle = middle.rect().center();
    let away = egui::vec2(-30.0, 24.0);
    let steps =
        [(egui::TouchPhase::Start, 0.0), (egui::TouchPhase::Move, 0.5), (egui::TouchPhase::Move, 1.0)];
    for (phase, part) in steps.into_iter().chain([(egui::TouchPhase::End, 1.0)]) {
        for (id, aside) in [(0, -40.0), (1, 40.0)] {
            let pos = middle + egui::vec2(aside, 0.0) + away * part;
            // A browser takes the first finger for the pointer, too.
            if id == 0 {
                app.harness.event(egui::Event::PointerMoved(pos));
            }
            if id == 0 && phase != egui::TouchPhase::Move {
                app.harness.event(egui::Event::PointerButton {
                    pos,
                    button: egui::PointerButton::Primary,
                    pressed: phase == egui::TouchPhase::Start,
                    modifiers: egui::Modifiers::NONE,
                });
            }
            let (device_id, id) = (egui::TouchDeviceId(0), egui::TouchId(id));
            app.harness.event(egui::Event::Touch { device_id, id, phase, pos, force: None });
        }
        app.harness.step();
    }
    app.settle();
    assert!((place(&app) - before - away).length() < 3.0, "{before:?} {:?}", place(&app));
}
