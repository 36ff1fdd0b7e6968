//! The course with the keyboard alone, and as a screen reader meets it: each step is reached and answered without a pointer,
//! and everything that takes input has a name.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::Value;
use workbench::PanelKind;
use workbench::description::Description;
use workbench::lesson::{Answer, COURSE};

use crate::support::{self, App};

/// Widgets of a lesson that Tab passes at most before it is through.
const MAX_STOPS: usize = 60;

fn press(app: &mut App, key: Key) {
    press_with(app, Modifiers::NONE, key);
}

fn press_with(app: &mut App, modifiers: Modifiers, key: Key) {
    app.harness.key_press_modifiers(modifiers, key);
    app.settle();
}

/// The role and the name of what has the keyboard.
fn focused(app: &App) -> Option<(Role, String)> {
    let nodes = app.harness.root().children_recursive();
    let focused =
        nodes.map(|node| node.accesskit_node()).find(egui_kittest::kittest::AccessKitNode::is_focused)?;
    Some((focused.role(), focused.label().unwrap_or_default()))
}

/// Gives a panel the keyboard, with F6 alone.
fn go_to_panel(app: &mut App, panel: PanelKind) {
    for _ in 0..12 {
        press(app, Key::F6);
        let active = app.harness.state().app_state().window.active_panel;
        if active == panel && focused(app).is_some_and(|(_, name)| name == panel.title()) {
            return;
        }
    }
    panic!("F6 does not lead to the panel {}", panel.title());
}

/// Goes from the panel to one of its widgets, with Tab alone.
fn go_to(app: &mut App, panel: PanelKind, role: Role, name: &str) {
    go_to_panel(app, panel);
    let mut passed = Vec::new();
    for _ in 0..MAX_STOPS {
        app.harness.key_press(Key::Tab);
        app.harness.step();
        app.harness.step();
        match focused(app) {
            Some(found) if found.0 == role && found.1 == name => return,
            found => passed.push(found),
        }
    }
    let place = app.json()["lesson"]["open"]["stopTitle"].clone();
    panic!("{place}: Tab does not lead to the {role:?} “{name}”, but to {passed:?}");
}

fn press_button(app: &mut App, name: &str) {
    go_to(app, PanelKind::Lesson, Role::Button, name);
    press(app, Key::Enter);
    for _ in 0..40 {
        if !app.harness.state().app_state().lesson.is_due() {
            break;
        }
        app.settle();
    }
}

fn question(app: &App) -> Value {
    app.json()["lesson"]["open"]["question"].clone()
}

/// Returns what the live region says.
fn announced(app: &App) -> String {
    workbench::host_io::announcement(app.harness.state().app_state())
}

/// Answers the question of the step rightly, with keys alone.
fn answer(app: &mut App) {
    let state = app.harness.state().app_state();
    let Some(ask) = state.lesson.stop().and_then(|stop| stop.ask.clone()) else { return };
    let right = ask.answer.right_now(&Description::of(state));
    match &ask.answer {
        Answer::Choice(choices) => {
            let right: usize = right.and_then(|it| it.parse().ok()).expect("one is right");
            let name = state.lesson_line(&choices[right].text);
            press_button(app, &name);
        }
        Answer::Number(..) | Answer::Word(_) => {
            let field = if matches!(ask.answer, Answer::Word(_)) { "Answer" } else { "Number" };
            go_to(app, PanelKind::Lesson, Role::TextInput, field);
            app.harness.event(egui::Event::Text(right.expect("it is known")));
            app.settle();
            press(app, Key::Enter);
        }
        Answer::Task(_) => press_button(app, "Show me"),
        Answer::Prediction(_) => predict(app),
    }
    let place = app.json()["lesson"]["open"]["stopTitle"].clone();
    if !matches!(ask.answer, Answer::Prediction(_)) {
        assert_eq!(question(app)["isRight"], true, "{place}");
        let said = announced(app);
        assert!(said.contains("Correct.") || said.contains("Done."), "{place}: {said}");
    }
}

/// Predicts whatever is offered first, until nothing more comes.
fn predict(app: &mut App) {
    for _ in 0..MAX_STOPS {
        let state = app.harness.state().app_state();
        if state.lesson.predictions().is_over() {
            let verdict = state.lesson.verdict().expect("something was predicted");
            assert!(announced(app).contains(&verdict), "{verdict}");
            return;
        }
        match state.forecasts().first().cloned() {
            Some(first) => press_button(app, &first),
            None => app.settle(),
        }
    }
    panic!("the predictions do not end");
}

/// Returns what takes input and has no name.
fn nameless(app: &App) -> Vec<String> {
    let nodes = app.harness.root().children_recursive();
    let found = nodes.map(|node| node.accesskit_node()).filter(|node| {
        let takes_input = matches!(
            node.role(),
            Role::Button
                | Role::CheckBox
                | Role::ComboBox
                | Role::Link
                | Role::RadioButton
                | Role::Slider
                | Role::SpinButton
                | Role::TextInput
                | Role::TreeItem
        );
        takes_input && node.label().is_none_or(|label| label.trim().is_empty())
    });
    found.map(|node| format!("{:?} {:?}", node.role(), node.bounding_box())).collect()
}

#[test]
fn the_whole_course_is_walked_with_the_keyboard_alone() {
    let world = std::rc::Rc::<support::World>::default();
    let mut app = support::start_in(world, |builder| builder.with_size([1280.0, 800.0]));
    app.settle();
    press(&mut app, Key::F6);
    press(&mut app, Key::L);
    press_button(&mut app, "1. The first line of a mission");
    let lessons: Vec<&str> = COURSE.iter().flat_map(|it| it.lessons).map(|it| it.name).collect();
    for (number, lesson) in lessons.iter().enumerate() {
        for stop in 1.. {
            let open = app.json()["lesson"]["open"].clone();
            assert_eq!((&open["name"], &open["stop"]), (&Value::from(*lesson), &Value::from(stop)));
            let title = open["stopTitle"].as_str().unwrap_or_default().to_owned();
            assert!(announced(&app).contains(&title), "{title}: {}", announced(&app));
            assert_eq!(nameless(&app), Vec::<String>::new(), "{lesson}, {title}");
            answer(&mut app);
            let is_last = open["stop"] == open["stops"];
            let last = if number + 1 == lessons.len() { "Back to contents" } else { "Next lesson" };
            press_button(&mut app, if is_last { last } else { "Next" });
            if is_last {
                break;
            }
        }
    }
    assert_eq!(app.json()["lesson"]["open"], Value::Null);
}

#[test]
fn steps_turn_with_one_key_and_the_trees_of_the_lesson_are_worked_with_keys() {
    let world = std::rc::Rc::<support::World>::default();
    "lesson=choices&stop=1".clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder.with_size([1280.0, 800.0]));
    app.settle();
    go_to_panel(&mut app, PanelKind::Lesson);
    press(&mut app, Key::N);
    assert_eq!(app.json()["lesson"]["open"]["stop"], 2);
    press_with(&mut app, Modifiers::SHIFT, Key::N);
    assert_eq!(app.json()["lesson"]["open"]["stop"], 1);
    press(&mut app, Key::N);
    // The arrow keys walk the search tree; the item of the state is selected, and its step is told.
    go_to_panel(&mut app, PanelKind::Search);
    let selected = |app: &App| {
        let items = app.harness.query_all_by_role(Role::TreeItem).map(|node| node.accesskit_node());
        // The other tree of the panel is that of trajectories.
        let items = items.filter(|it| !it.label().is_some_and(|label| label.starts_with("before step")));
        let chosen: Vec<String> =
            items.filter(|it| it.is_selected() == Some(true)).filter_map(|it| it.label()).collect();
        chosen.join(", ")
    };
    let before = (selected(&app), announced(&app));
    assert!(before.0.starts_with("D2: Core#1, failed"), "{}", before.0);
    press(&mut app, Key::ArrowUp);
    assert!(selected(&app).starts_with("D1: Long-Way#1"), "{}", selected(&app));
    assert_ne!(announced(&app), before.1);
    press(&mut app, Key::ArrowDown);
    // It is told as it is at its own step, at which it has not failed yet.
    assert!(selected(&app).starts_with("D2: Core#1"), "{}", selected(&app));
}

#[test]
fn the_hitting_set_tree_is_a_tree_and_is_built_with_keys() {
    let world = std::rc::Rc::<support::World>::default();
    "lesson=estimation&stop=7".clone_into(&mut world.fragment.borrow_mut());
    let mut app = support::start_in(world, |builder| builder.with_size([1280.0, 800.0]));
    app.settle();
    let button = |app: &mut App, name: &str| {
        go_to(app, PanelKind::Automaton, Role::Button, name);
        press(app, Key::Enter);
    };
    let items = |app: &App| -> Vec<(String, usize, [usize; 2])> {
        let items = app.harness.query_all_by_role(Role::TreeItem).map(|node| node.accesskit_node());
        // The other tree of the panel is that of trajectories.
        let items = items.filter(|it| !it.label().is_some_and(|label| label.starts_with("before step")));
        let place = |it: &egui_kittest::kittest::AccessKitNode<'_>| {
            [it.position_in_set().expect("a place"), it.size_of_set().expect("a size")]
        };
        items.map(|it| (it.label().unwrap_or_default(), it.level().expect("a level"), place(&it))).collect()
    };
    // The drawing says which component is part of which conflict.
    let of_component: Vec<String> = app
        .harness
        .query_all_by_label_contains("conflict ")
        .filter_map(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value()))
        .filter(|text| text.starts_with("conflict "))
        .collect();
    assert!(of_component.iter().any(|text| text == "conflict 1, 2"), "{of_component:?}");
    // Each is on a card of its own, with room for it.
    let mut labels: Vec<egui::Rect> = app
        .harness
        .query_all_by_label_contains("conflict ")
        .filter(|node| {
            node.accesskit_node()
                .label()
                .or_else(|| node.accesskit_node().value())
                .is_some_and(|it| it.starts_with("conflict "))
        })
        .map(|node| node.rect())
        .collect();
    labels.extend(
        ["Battery", "Switch", "LampA", "LampB"]
            .map(|name| app.harness.get_by_role_and_label(Role::Button, name).rect()),
    );
    for (at, one) in labels.iter().enumerate() {
        assert!(labels[at + 1..].iter().all(|other| !one.intersects(*other)), "{one:?} of {labels:?}");
    }
    button(&mut app, "Build hitting-set tree");
    assert_eq!(items(&app), [("all assumed: open".to_owned(), 1, [0, 1])]);
    button(&mut app, "Diagnosis: all assumed");
    assert!(app.harness.query_by_label_contains("Not a diagnosis").is_some());
    button(&mut app, "Conflict 2: all assumed");
    let level: Vec<_> = items(&app).into_iter().filter(|it| it.1 == 2).collect();
    assert_eq!(level, [("{LampA}: open".to_owned(), 2, [0, 2]), ("{LampB}: open".to_owned(), 2, [1, 2])]);
    for (name, node) in [
        ("Diagnosis", "{LampB}"),
        ("Conflict 1", "{LampA}"),
        ("Diagnosis", "{Battery, LampA}"),
        ("Diagnosis", "{Switch, LampA}"),
        ("Close", "{LampA, LampB}"),
    ] {
        button(&mut app, &format!("{name}: {node}"));
    }
    assert_eq!(question(&app)["isRight"], true, "{:?}", items(&app));
    assert!(announced(&app).contains("Done."), "{}", announced(&app));
}
