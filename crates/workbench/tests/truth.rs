//! What is said of a mission is true of the present one: of its text, its plan, and no other.

mod support;

use mission::Response;
use mission::review::review;
use serde_json::{Value, json};
use support::App;
use workbench::command::{Command, EditorCommand};
use workbench::host::{HostEvent, Remote as _};
use workbench::state::no_plan::NO_PLAN;
use workbench::state::review::ReviewCommand;
use workbench::state::search::SearchCommand;
use workbench::workspace::Workspace;

/// A mission without a plan: a wait of 8 minutes in one of 5.
const TOO_LONG: &str = "scenario S[0,5] = {\n    delay[8,9]\n}\n";

fn showing(source: &str) -> App {
    let mut app = support::start();
    app.run(Command::SetSource(source.to_owned()));
    app
}

fn no_plan(app: &App) -> Vec<Value> {
    let all = app.json()["diagnostics"].as_array().expect("a list").clone();
    all.into_iter().filter(|it| it["code"] == NO_PLAN).collect()
}

#[test]
fn no_plan_is_a_problem_at_what_the_reason_names() {
    let app = showing(TOO_LONG);
    assert_eq!(app.json()["status"], "no-plan");
    let problems = no_plan(&app);
    let [problem] = problems.as_slice() else { panic!("{problems:?}") };
    assert_eq!(problem["severity"], "error");
    let message = problem["message"].as_str().expect("a message");
    assert!(message.starts_with("No plan: "), "{message}");
    let at = |side: &str| problem["span"][side].as_u64().expect("a place") as usize;
    let underlined = &TOO_LONG[at("start")..at("end")];
    assert!(["[0,5]", "[8,9]", "delay[8,9]"].contains(&underlined), "{underlined}");
    assert!(!problem["fixes"].as_array().expect("a list").is_empty(), "{problem}");
}

#[test]
fn its_fixes_are_quick_fixes_in_the_text() {
    let mut app = showing(TOO_LONG);
    app.run(Command::Editor(EditorCommand::GoToProblem { forwards: true }));
    app.run(Command::Editor(EditorCommand::QuickFix));
    let items = app.session.state().editor.popup.as_ref().expect("a list of fixes").items.len();
    assert_eq!(items, app.json()["failure"]["relaxations"].as_array().expect("a list").len());
    app.run(Command::Editor(EditorCommand::TakeFromPopup(Some(0))));
    assert_eq!(app.json()["status"], "plan");
    assert_eq!(no_plan(&app), Vec::<Value>::new());
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(no_plan(&app).len(), 1);
}

#[test]
fn a_text_with_errors_is_never_said_to_have_a_plan_or_none() {
    let mut app = support::start();
    let source = app.session.source();
    // The network is complete without the unknown word, and yet the text has an error.
    app.run(Command::SetSource(format!("{source}\nactivity Broken() = {{ Nowhere( }}")));
    assert_eq!(app.json()["status"], "broken");
    assert_eq!(no_plan(&app), Vec::<Value>::new());
}

#[test]
fn leaving_teach_on_a_failure_shows_no_schedule_of_that_failure() {
    for workspace in [Workspace::Review, Workspace::Author, Workspace::Execute] {
        let mut app = showing(TOO_LONG);
        app.run(Command::ShowWorkspace(Workspace::Teach));
        app.run(Command::Search(SearchCommand::Step(1)));
        assert!(app.session.state().search.step().is_some());
        app.run(Command::ShowWorkspace(workspace));
        assert!(app.session.state().search.step().is_none(), "{workspace:?}");
    }
}

#[test]
fn a_review_of_another_text_is_stale_and_of_another_mission_gone() {
    let mut app = support::start();
    app.run(Command::Review(ReviewCommand::Run));
    let stale = |app: &App| app.json()["review"]["stale"].clone();
    assert_eq!(stale(&app), false);
    let source = app.session.source();
    app.run(Command::SetSource(format!("{source} ")));
    assert_eq!(stale(&app), true, "another text");
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(stale(&app), false, "the same again");
    app.run(Command::SetSource(source.replace("choose {", "choose")));
    assert_eq!(app.json()["status"], "broken");
    assert_eq!(stale(&app), true, "errors");
    app.dispatch("edit.undo", &json!(null));
    app.run(Command::SetSeed(app.session.state().settings.plan.seed + 1));
    assert_eq!(stale(&app), true, "another seed");
    app.run(Command::OpenExample("both-paths".into()));
    assert_eq!(app.json()["review"]["hash"], Value::Null, "another mission");
    assert_eq!(app.json()["review"]["items"], json!([]));
}

#[test]
fn a_review_that_comes_after_another_mission_was_opened_is_dropped() {
    let mut app = support::start();
    let shown = app.session.state().shown().expect("a plan").clone();
    let plan = app.session.state().settings.plan.clone();
    app.world.is_deaf.set(true);
    app.run(Command::Review(ReviewCommand::Run));
    app.world.is_deaf.set(false);
    app.run(Command::OpenExample("both-paths".into()));
    let late = review(&shown, &plan.goal, plan.seed, &mut || false);
    let answer = Response::Review { revision: shown.revision, review: late.into() };
    app.world.news.borrow_mut().push_back(HostEvent::Answer(answer));
    app.settle();
    assert_eq!(app.json()["review"]["hash"], Value::Null);
}
