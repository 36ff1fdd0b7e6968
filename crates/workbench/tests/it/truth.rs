//! What is said of a mission is true of the present one: of its text, its plan, and no other.

use link::Response;
use review::review;
use serde_json::{Value, json};
use test_support::App;
use workbench::command::Command;
use workbench::host::{FileKind, HostEvent};
use workbench::host_io::Remote as _;
use workbench::state::editor::EditorCommand;
use workbench::state::execution::ExecutionCommand;
use workbench::state::no_plan::NO_PLAN;
use workbench::state::review::ReviewCommand;
use workbench::state::search::SearchCommand;
use workbench::state::settings::SettingsCommand;
use workbench::workspace::Workspace;

/// A mission without a plan: a wait of 8 minutes in one of 5.
const TOO_LONG: &str = "scenario S[0,5] = {\n    delay[8,9]\n}\n";

fn showing(source: &str) -> App {
    let mut app = test_support::start();
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
fn what_nature_can_break_is_underlined_at_the_bound_that_it_breaks() {
    let source = "primitive Drive() contingent [20,40];\nscenario S[0,60] = { { delay; Drive() }[30,35] }\n";
    let app = showing(source);
    let problems = no_plan(&app);
    let [problem] = problems.as_slice() else { panic!("{problems:?}") };
    let at = |side: &str| problem["span"][side].as_u64().expect("a place") as usize;
    assert_eq!(&source[at("start")..at("end")], "[30,35]");
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
    let mut app = test_support::start();
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
    let mut app = test_support::start();
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
    app.run(Command::Settings(SettingsCommand::SetSeed(app.session.state().settings.plan.seed + 1)));
    assert_eq!(stale(&app), true, "another seed");
    app.run(Command::OpenExample("both-paths".into()));
    assert_eq!(app.json()["review"]["hash"], Value::Null, "another mission");
    assert_eq!(app.json()["review"]["items"], json!([]));
}

#[test]
fn a_review_that_comes_after_another_mission_was_opened_is_dropped() {
    let mut app = test_support::start();
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

#[test]
fn a_review_and_an_approval_of_another_plan_of_the_same_text_are_not_shown_as_those_of_the_plan_that_is_drawn()
 {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada" }));
    let told =
        |app: &App| (app.json()["review"]["stale"].clone(), app.json()["review"]["planStatus"].clone());
    assert_eq!(told(&app), (json!(false), json!("approved")));
    let exported = |app: &mut App| {
        app.dispatch("export.schedule", &json!({ "as": "json" }));
        serde_json::from_str::<Value>(&app.world.saved_text()).expect("JSON")["plan_status"].clone()
    };
    assert_eq!(exported(&mut app), "approved");
    // The core answers with another plan of the very same text, as where planning was stopped: without its orderings.
    let shown = app.session.state().shown().expect("a plan").clone();
    let mut other = (*shown).clone();
    let mut planning = other.planning.as_deref().expect("it is planned").clone();
    let window = planning.outcome.plans[0].windows.iter_mut().flatten().last().expect("an event");
    window.earliest = window.earliest.checked_add(exact::Time::ONE).expect("it fits");
    other.planning = Some(planning.into());
    app.world.news.borrow_mut().push_back(HostEvent::Answer(Response::Snapshot(other.into())));
    app.settle();
    assert_eq!(told(&app), (json!(true), json!("lapsed")));
    assert_eq!(exported(&mut app), "lapsed");
    app.world.news.borrow_mut().push_back(HostEvent::Answer(Response::Snapshot(shown)));
    app.settle();
    assert_eq!(told(&app), (json!(false), json!("approved")), "the plan that was approved again");
}

/// The lines of a section of the review.
fn lines(app: &App, section: &str) -> Vec<Value> {
    let items = app.json()["review"]["items"].as_array().expect("a list").clone();
    items.into_iter().filter(|it| it["section"] == section).collect()
}

#[test]
fn runs_with_chance_are_kept_by_content_and_held_against_the_rule() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    assert_eq!(lines(&app, "robustness"), Vec::<Value>::new());
    app.sample(20, 5);
    let made = app.json()["robustness"].clone();
    let line = lines(&app, "robustness");
    let [line] = line.as_slice() else { panic!("one line: {line:?}") };
    let text = line["text"].as_str().expect("words");
    assert!(text.contains("of 20 runs reached the end (Monte Carlo, seed 5;"), "{text}");
    assert!(line["criterion"].as_str().is_some_and(|it| it.starts_with("success rate at least 95 %")));
    // Of another text nothing is known.
    let source = app.session.source();
    app.run(Command::SetSource(format!("{source} ")));
    assert_eq!(app.session.state().robustness(), None);
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(app.json()["robustness"], made, "the same mission again");
    assert_eq!(lines(&app, "robustness"), std::slice::from_ref(line));
    // The report has it.
    app.world.saved.borrow_mut().clear();
    app.run(Command::WriteReport);
    let page = app.world.saved_text();
    assert!(page.contains("of 20 runs reached the end (Monte Carlo, seed 5;"));
}

#[test]
fn passed_lines_are_contradicted_a_few_tries_at_a_time_and_what_is_found_replays() {
    let mut app = test_support::start();
    app.run(Command::SetSource(
        "primitive Walk()[5,9]; primitive Rest()[1,2]; scenario S[0,30] = { Walk(); delay; Rest() }"
            .to_owned(),
    ));
    app.run(Command::Review(ReviewCommand::Run));
    assert_eq!(app.json()["contradiction"], json!(null));
    app.dispatch("review.contradict", &json!(null));
    for _ in 0..300 {
        app.settle();
    }
    let found = app.json()["contradiction"].clone();
    assert_eq!(found["isRunning"], false, "{found}");
    let items = found["items"].as_array().expect("a list").clone();
    let passed = app.json()["review"]["items"].as_array().expect("a list").clone();
    let passed = passed.iter().filter(|it| it["status"] == "passed").count();
    // Sections that have passed without lines are tried, too.
    assert!(items.len() > passed, "{found}");
    let survived = items.iter().find(|it| it["status"] == "survived").expect("a line that schedules try");
    assert!(survived["outcome"].as_str().is_some_and(|it| it.starts_with("survived ")), "{survived}");
    // Of another text nothing is known, and undoing finds it again.
    let source = app.session.source();
    app.run(Command::SetSource(source.replace("[5,9]", "[5,8]")));
    app.run(Command::Review(ReviewCommand::Run));
    assert_eq!(app.json()["contradiction"], json!(null));
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(app.json()["contradiction"], found);
    // A schedule is replayed in Execute.
    let script = executive::Script {
        schedule: [("Rest#1.start".into(), exact::Time::from(20))].into(),
        ..executive::Script::default()
    };
    app.dispatch("view.workspace", &json!({ "name": "execute" }));
    app.run(Command::Execution(ExecutionCommand::Replay(Box::new(script.clone()))));
    let state = app.session.state();
    assert!(state.execution.is_replay());
    let run = state.execution.run().expect("it is executed");
    assert_eq!(run.script, script);
    let is_late = |entry: &executive::Entry| {
        matches!(&entry.happening, executive::Happening::Executed { name } if name == "Rest#1.start")
            && entry.time == exact::Time::from(20)
    };
    assert!(run.log.iter().any(is_late), "{:?}", run.log);
}

#[test]
fn rules_are_proven_in_every_plan_and_the_plan_that_breaks_one_opens() {
    let mut app = test_support::start();
    app.run(Command::SetSource(
        "primitive Walk()[5,9]; primitive Run()[1,2]; scenario S[0,30] = { choose { Walk(), Run() }; delay }"
            .to_owned(),
    ));
    let rules = json!([
        { "name": "Floor", "rule": "never (Walk and Run)" },
        { "name": "Walk", "rule": "never Run" },
        { "name": "Own", "rule": "never Walk from 6 to 20" },
    ]);
    app.dispatch("review.createKey", &json!({ "name": "Ada" }));
    app.dispatch("review.rules", &json!({ "rules": rules }));
    app.run(Command::Review(ReviewCommand::Run));
    assert_eq!(app.json()["ruleProofs"], json!(null));
    app.dispatch("review.proveRules", &json!(null));
    for _ in 0..20 {
        app.settle();
    }
    let found = app.json()["ruleProofs"].clone();
    let verdict = |index: usize| found["rules"][index]["verdict"].clone();
    assert_eq!(found["isRunning"], false, "{found}");
    assert_eq!([verdict(0), verdict(1), verdict(2)], ["holds", "broken", "broken"], "{found}");
    let outcome = found["rules"][1]["outcome"].as_str().expect("a sentence");
    assert!(outcome.starts_with("another plan can violate it: "), "{outcome}");
    // Another plan is compared with this one, and a schedule of this one is replayed.
    app.dispatch("review.openRulePlan", &json!({ "rule": "Walk" }));
    let side = app.session.state().compare.reference().expect("a plan to compare with").clone();
    assert!(side.is_planned && side.name.contains("never Run"), "{}", side.name);
    app.dispatch("review.openRulePlan", &json!({ "rule": "Own" }));
    assert!(app.session.state().execution.is_replay());
    // Of another text nothing is known.
    let source = app.session.source();
    app.run(Command::SetSource(source.replace("[5,9]", "[5,8]")));
    app.run(Command::Review(ReviewCommand::Run));
    assert_eq!(app.json()["ruleProofs"], json!(null));
}

#[test]
fn flight_rules_are_changed_kept_with_the_mission_and_part_of_what_is_signed() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    let link = |app: &App| lines(app, "causal-links")[0]["status"].clone();
    assert_eq!(link(&app), "attention", "a margin of 0 has not passed");
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada" }));
    assert_eq!(app.json()["review"]["signed"]["stale"], false);
    app.dispatch("review.rules", &json!({ "margin": null }));
    assert_eq!(link(&app), "passed");
    assert_eq!(app.json()["review"]["stale"], false, "the plan is the same");
    assert_eq!(app.json()["review"]["signed"]["stale"], true, "these rules were not signed");
    app.dispatch("review.rules", &json!({ "margin": 0 }));
    assert_eq!(
        app.json()["review"]["signed"]["stale"],
        true,
        "rules that were changed and set again do not bring it back"
    );
    app.dispatch("review.rules", &json!({ "slope_deg": 2.5 }));
    let wrong = app.session.dispatch("review.rules", &json!({ "clearance_m": -1 }));
    assert!(wrong.is_err() && app.json()["review"]["rules"]["clearance_m"] == 0.25);
    // Another run finds them with the mission.
    let again = test_support::start_in(std::rc::Rc::clone(&app.world));
    drop(app);
    let mut again = again;
    again.settle();
    assert_eq!(again.json()["review"]["rules"]["slope_deg"], 2.5);
    again.run(Command::Review(ReviewCommand::SaveRules));
    let saved = again.world.saved_text();
    again.dispatch("review.rules", &json!({ "slope_deg": 15 }));
    again.world.open_file(FileKind::Json, "rules.json", saved.as_bytes());
    again.settle();
    assert_eq!(again.json()["review"]["rules"]["slope_deg"], 2.5);
}

#[test]
fn a_mission_that_is_being_written_shows_its_places_and_not_the_mission_before() {
    let mut app = test_support::start();
    assert!(!app.session.state().shown().expect("an example").traverses.is_empty());
    let source = "location BASE (24, 52);\nvehicle Rover1 : ATRV at BASE;\n";
    app.run(Command::SetSource(source.to_owned()));
    assert_eq!((&app.json()["status"], &app.json()["isStale"]), (&json!("empty"), &json!(false)));
    let shown = app.session.state().shown().expect("what is written so far");
    let names: Vec<&str> = shown.program.world.locations.iter().map(|it| it.name.text.as_str()).collect();
    assert_eq!(names, ["BASE"]);
    assert!(shown.network.is_none() && shown.plan().is_none());
    // A slip in the middle of a word leaves what was shown.
    app.run(Command::SetSource(format!("{source}location RIM (1")));
    assert_eq!(app.session.state().shown().expect("as before").program.world.vehicles.len(), 1);
}
