//! The hitting-set tree over the conflicts of a step, built by hand: wrong steps are refused with their reason, and the finished
//! diagnoses agree with the estimate, which does not use the tree.

use plant::hitting_sets::Refusal;
use serde_json::json;
use test_support::{App, start};
use workbench::command::Command;
use workbench::lesson::{Lesson, course_lesson};
use workbench::state::diagnosing::{Diagnosing, refusal_text, set_text};
use workbench::state::lesson::LessonCommand;

/// The step of the lesson that has the student build the tree.
fn lesson() -> App {
    let course = course_lesson("estimation").expect("a lesson");
    let (lesson, _) = Lesson::read(course.name, course.text);
    let stop =
        lesson.stops.iter().position(|stop| stop.title == "Build the hitting-set tree").expect("a stop");
    let mut app = start();
    app.run(Command::Lesson(LessonCommand::Open("estimation".into(), stop)));
    app.settle();
    app
}

fn diagnosing(app: &App) -> &Diagnosing {
    app.session.state().automaton.diagnosing().expect("it was begun")
}

/// Lets a node become something, and gives why it cannot.
fn label(app: &mut App, node: usize, label: &str, conflict: usize) -> Option<Refusal> {
    app.dispatch("program.diagnose", &json!({ "node": node, "as": label, "conflict": conflict }));
    diagnosing(app).refused().map(|(_, refusal)| refusal.clone())
}

#[test]
fn the_diagnoses_of_a_step_are_found_once() {
    let mut app = lesson();
    let found = |app: &App| {
        let step = app.session.state().automaton.step_conflicts();
        step.map(|step| (step.diagnoses().as_ptr(), step.diagnoses().len()))
    };
    let first = found(&app);
    assert_eq!(first.map(|(_, count)| count), Some(3));
    app.dispatch("program.diagnose", &json!({}));
    assert_eq!(found(&app), first, "building the tree changes no diagnoses");
    app.dispatch("program.goTo", &json!({ "moment": 0 }));
    assert_eq!(found(&app), None);
    app.dispatch("program.goTo", &json!({ "moment": 1 }));
    assert_eq!(found(&app).map(|(_, count)| count), Some(3));
}

#[test]
fn a_tree_is_built_by_hand_and_agrees_with_the_estimate() {
    let mut app = lesson();
    let is_done = |app: &App| app.json()["lesson"]["open"]["question"]["isRight"] == true;
    assert!(app.session.state().automaton.diagnosing().is_none());
    app.dispatch("program.diagnose", &json!({}));
    let model = app.session.state().automaton.program().and_then(|it| it.model()).expect("a plant").clone();
    let conflicts: Vec<Vec<&str>> = (diagnosing(&app).tree().conflicts().iter())
        .map(|it| it.modes.iter().map(|(id, _)| model.component(*id).expect("one").name.as_str()).collect())
        .collect();
    assert_eq!(conflicts, [vec!["Battery", "Switch", "LampB"], vec!["LampA", "LampB"]]);
    assert_eq!(label(&mut app, 0, "closed", 1), Some(Refusal::NothingCovers));
    assert!(matches!(label(&mut app, 0, "diagnosis", 1), Some(Refusal::Contradicts(_))));
    // The shorter conflict first: below it are nodes 1, without LampA, and 2, without LampB.
    assert_eq!(label(&mut app, 0, "conflict", 2), None);
    let refusal = label(&mut app, 2, "conflict", 1).expect("it is hit");
    let text = refusal_text(&model, diagnosing(&app).tree(), &refusal);
    assert_eq!(
        text,
        "The path already has LampB, which this conflict contains. Choose a conflict without it."
    );
    assert_eq!(label(&mut app, 2, "diagnosis", 1), None);
    assert_eq!(label(&mut app, 1, "conflict", 1), None);
    assert_eq!(label(&mut app, 3, "diagnosis", 1), None);
    assert_eq!(label(&mut app, 4, "diagnosis", 1), None);
    assert!(matches!(label(&mut app, 5, "diagnosis", 1), Some(Refusal::NotMinimal { by: 2 })));
    assert!(!is_done(&app), "a node is open");
    assert_eq!(label(&mut app, 5, "closed", 1), None);
    app.settle();
    assert!(is_done(&app));
    let tree = diagnosing(&app).tree();
    let sets: Vec<String> = tree.diagnoses().map(|(_, set)| set_text(&model, set)).collect();
    assert_eq!(sets, ["{LampB}", "{Battery, LampA}", "{Switch, LampA}"]);
    let moment = app.session.state().automaton.moment().and_then(|it| it.plant.as_ref()).expect("a plant");
    let agreement = diagnosing(&app).agreement(&model, &moment.belief);
    assert!(agreement.states >= 3, "{agreement:?}");
    assert_eq!(agreement.explained, agreement.states);
    assert!(agreement.probabilities[0] > 0.9, "one fault is more likely than two: {agreement:?}");
    assert!(agreement.probabilities[1..].iter().all(|&it| it > 0.0), "{agreement:?}");
    // Another step has another tree, or none.
    app.dispatch("program.goTo", &json!({ "moment": 0 }));
    app.settle();
    assert!(app.session.state().automaton.diagnosing().is_none());
}
