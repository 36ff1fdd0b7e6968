//! A board at work: from a draft to an approval over one edit, through files, tabs, reloads and what was tampered with.

use std::rc::Rc;

use review::Record;
use serde_json::{Value, json};
use test_support::App;
use workbench::Dialog;
use workbench::command::Command;
use workbench::host::FileKind;
use workbench::host_io::Remote as _;
use workbench::state::keys::KeyChange;
use workbench::state::review::ReviewCommand;
use workbench::state::window::WindowCommand;

/// The open mission, reviewed, before a board of two roles.
fn before_the_board() -> App {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    for name in ["Ada", "Grace", "Chair"] {
        app.sign_as(name);
    }
    let board = json!([{ "role": "Science", "approvals": 1 }, { "role": "Mobility", "approvals": 1 }]);
    app.dispatch("review.rules", &json!({ "board": board }));
    app
}

fn status(app: &App) -> Value {
    app.json()["review"]["planStatus"].clone()
}

fn edit(app: &mut App, from: &str, to: &str) {
    let source = app.session.source();
    assert!(source.contains(from), "{from}");
    app.run(Command::SetSource(source.replace(from, to)));
    app.run(Command::Review(ReviewCommand::Run));
}

fn refused(app: &mut App, command: &str, arguments: &Value) -> String {
    let answer = app.session.dispatch(command, arguments);
    answer.expect_err("it is refused").to_string()
}

/// Returns what the last act was, and by whom.
fn last_act(app: &App) -> (String, String) {
    let history = app.json()["review"]["history"].clone();
    let last = history.as_array().and_then(|all| all.last().cloned()).expect("an entry");
    let text = |member: &str| last[member].as_str().expect("a text").to_owned();
    (text("by"), text("act"))
}

/// The report as it is written now: how it says that the plan stands, and where the board signs.
fn report(app: &mut App) -> (String, String) {
    app.run(Command::WriteReport);
    let page = app.world.saved_text();
    let part = |from: &str, to: &str| {
        let rest = page.split_once(from).unwrap_or_else(|| panic!("no {from}")).1;
        rest.split(to).next().unwrap_or_default().to_owned()
    };
    let hash = app.json()["review"]["hash"].as_str().expect("a hash").to_owned();
    assert!(part("<dd class=\"hash\">", "</dd>").contains(&hash), "the report is of another content");
    let short: String = hash.chars().filter(char::is_ascii_hexdigit).collect();
    assert!(part("@bottom-left", "}").contains(&short), "its pages are of another content");
    (part("<dt>Board</dt>", "</dd>"), part("<h2>Signatures</h2>", "<h2"))
}

#[test]
fn a_report_has_only_the_signatures_that_hold_for_its_content() {
    let mut app = before_the_board();
    let named = |(_, signed): &(String, String)| {
        ["Ada", "Grace"].map(|name| signed.contains(&format!("<td>{name}</td>")))
    };
    let draft = report(&mut app);
    assert!(draft.0.contains("draft") && named(&draft) == [false, false], "{draft:?}");
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    let half = report(&mut app);
    assert!(half.0.contains("in review") && named(&half) == [true, false], "{half:?}");
    app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    let whole = report(&mut app);
    assert!(whole.0.contains("approved") && named(&whole) == [true, true], "{whole:?}");
    // One of them takes it back: the seat is empty again, in the report of the same content.
    let given = app.json()["review"]["history"].as_array().and_then(|all| all.last().cloned());
    let id = given.expect("an entry")["id"].clone();
    let back = json!({ "name": "Grace", "role": "Mobility", "id": id, "text": "Not read to the end." });
    app.dispatch("review.withdraw", &back);
    let taken = report(&mut app);
    assert!(taken.0.contains("in review") && named(&taken) == [true, false], "{taken:?}");
    app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    assert_eq!(named(&report(&mut app)), [true, true]);
    // An edit: no signature is of this content, and the report says whose approval lapsed, and why.
    edit(&mut app, "PATH1=OK [450,450]", "PATH1=OK [460,460]");
    let lapsed = report(&mut app);
    assert!(lapsed.0.contains("lapsed") && lapsed.0.contains("Grace approved"), "{lapsed:?}");
    assert_eq!(named(&lapsed), [false, false], "{lapsed:?}");
    assert!(lapsed.1.contains("Approval blocked"), "{lapsed:?}");
}

#[test]
fn a_board_takes_a_plan_from_draft_to_approval_over_one_edit() {
    let mut app = before_the_board();
    assert_eq!(status(&app), "draft");
    // A comment is open, and is in the way.
    let asked = json!({ "author": "Ada", "role": "Science", "to": "Grace", "about": "Group-Wait#1", "text": "Why so long?" });
    app.dispatch("review.comment", &asked);
    assert_eq!(status(&app), "in-review");
    let ada = json!({ "name": "Ada", "role": "Science" });
    let why = refused(&mut app, "review.approve", &ada);
    assert!(why.contains("not acknowledged") && why.contains("1 comment is open"), "{why}");
    // It is resolved by name; a second time is refused.
    let id = app.json()["review"]["comments"][0]["id"].clone();
    let resolve = json!({ "name": "Grace", "role": "Mobility", "id": id, "text": "It waits for light." });
    app.dispatch("review.resolve", &resolve);
    assert!(refused(&mut app, "review.resolve", &resolve).contains("already resolved"));
    assert_eq!(app.json()["review"]["comments"][0]["open"], false);
    // Items that need attention are acknowledged with a reason, each.
    let items = app.json()["review"]["items"].as_array().expect("a list").clone();
    let index = items.iter().position(|item| item["status"] == "attention").expect("a line");
    let silent = json!({ "name": "Ada", "item": index, "text": " " });
    assert!(refused(&mut app, "review.acknowledge", &silent).contains("reason"));
    app.acknowledge_all("Ada");
    assert_eq!(
        app.json()["review"]["items"][index]["acknowledged"],
        json!({ "by": "Ada", "text": "As meant." })
    );
    // One role, then the other.
    app.dispatch("review.approve", &ada);
    assert_eq!(status(&app), "in-review");
    assert!(refused(&mut app, "review.approve", &ada).contains("already"));
    assert!(refused(&mut app, "review.approve", &json!({ "name": "Ada" })).contains("no role"));
    let grace = json!({ "name": "Grace", "role": "Mobility", "text": "Mind the slope." });
    app.dispatch("review.approve", &grace);
    assert_eq!(status(&app), "approved-with-comments");
    // An edit lapses it, and its undo brings it back.
    edit(&mut app, "PATH1=OK [450,450]", "PATH1=OK [460,460]");
    assert_eq!(status(&app), "lapsed");
    assert_eq!(app.json()["review"]["signed"]["stale"], true);
    // The approved plan lies under the present one, on the timeline and in the report.
    assert!(app.session.state().review.approved_times().is_some());
    app.run(Command::WriteReport);
    let page = app.world.saved_text();
    for part in [
        "Timeline of the plan over the approved one",
        "approved: ",
        "Network of the plan over the approved one",
    ] {
        assert!(page.contains(part), "{part}");
    }
    app.dispatch("edit.undo", &json!(null));
    assert_eq!(status(&app), "approved-with-comments");
    assert_eq!(app.session.state().review.approved_times(), None);
    app.dispatch("edit.redo", &json!(null));
    assert_eq!(status(&app), "lapsed");
    // The board approves the edited plan; what differs is acknowledged again, what does not is not.
    let left = app.json()["review"]["blockers"].clone();
    app.acknowledge_all("Grace");
    assert_eq!(app.json()["review"]["blockers"], json!([]), "{left}");
    app.dispatch("review.approve", &ada);
    assert_eq!(status(&app), "in-review");
    app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    assert_eq!(status(&app), "approved");
    // Grace takes her approval back, and that stays in the history.
    let history = app.json()["review"]["history"].clone();
    let given = history.as_array().and_then(|all| all.last()).expect("an entry")["id"].clone();
    let withdraw =
        json!({ "name": "Grace", "role": "Mobility", "id": given, "text": "Not read to the end." });
    app.dispatch("review.withdraw", &withdraw);
    assert!(refused(&mut app, "review.withdraw", &withdraw).contains("already"));
    assert_eq!(status(&app), "in-review");
    assert_eq!(last_act(&app), ("Grace".to_owned(), "took back".to_owned()));
    let taken = app.json()["review"]["history"]
        .as_array()
        .expect("a list")
        .iter()
        .any(|entry| entry["id"] == given && entry["withdrawn"] == true && entry["act"] == "approved");
    assert!(taken, "what was taken back is still told");
    // Another run finds all of it, and the report has it.
    let told = app.json()["review"]["history"].clone();
    app.run(Command::WriteReport);
    let page = app.world.saved_text();
    for part in ["History of the review", "withdrawn by Grace", "Since the last approval", "Mind the slope."]
    {
        assert!(page.contains(part), "{part}");
    }
    let world = Rc::clone(&app.world);
    drop(app);
    let mut again = test_support::start_in(world);
    again.settle();
    assert_eq!(again.json()["review"]["history"], told);
}

/// What a board's history tells, row by row, as `docs/reviews.md` shows it.
struct Told {
    app: App,
    known: usize,
    rows: Vec<String>,
}

impl Told {
    /// Half an hour later something is done; what that adds to the history becomes rows with the status after it.
    fn then(&mut self, act: impl FnOnce(&mut App)) {
        self.app.world.now_secs.set(self.app.world.now_secs.get() + 1800.0);
        act(&mut self.app);
        let review = self.app.json()["review"].clone();
        let entries = review["history"].as_array().expect("a list").clone();
        let text = |entry: &Value, member: &str| entry[member].as_str().unwrap_or_default().to_owned();
        let new = &entries[self.known..];
        self.known = entries.len();
        let content = text(&review, "hash")[..6].to_owned();
        let status = text(&review, "planStatus").replace('-', " ");
        let Some(first) = new.first() else {
            self.rows.push(format!("| | | *the text is edited* | `{content}` | {status} |"));
            return;
        };
        let words = match text(first, "text") {
            _ if new.len() > 1 => format!(", {} lines", new.len()),
            words if words.is_empty() => String::new(),
            words => format!(": “{words}”"),
        };
        let time = text(first, "time")[11..16].to_owned();
        let (by, act) = (text(first, "by"), text(first, "act"));
        let role = match text(first, "role") {
            role if role.is_empty() => role,
            role => format!(" ({role})"),
        };
        assert!(
            new.iter().all(|entry| text(entry, "hash").starts_with(&content)),
            "each says what it is about"
        );
        self.rows.push(format!("| {time} | {by}{role} | {act}{words} | `{content}` | {status} |"));
    }
}

#[test]
fn the_manual_shows_a_board_s_history_from_draft_to_approval_over_one_edit() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    let mut told = Told { app, known: 0, rows: Vec::new() };
    let by = |name: &str, role: &str| json!({ "name": name, "role": role });
    let (ada, grace) = (by("Ada", "Science"), by("Grace", "Mobility"));
    for name in ["Ada", "Grace", "Chris"] {
        told.app.sign_as(name);
    }
    told.then(|app| {
        app.session.state_mut().settings.reviewer_role = "Chair".to_owned();
        let board = json!([{ "role": "Science", "approvals": 1 }, { "role": "Mobility", "approvals": 1 }]);
        app.dispatch("review.rules", &json!({ "board": board }));
    });
    told.then(|app| {
        let words = "Why so long?";
        let about = json!({ "author": "Ada", "role": "Science", "to": "Grace", "about": "Group-Wait#1", "text": words });
        app.dispatch("review.comment", &about);
    });
    told.then(|app| {
        let id = app.json()["review"]["comments"][0]["id"].clone();
        let words = "It waits for light.";
        app.dispatch(
            "review.resolve",
            &json!({ "name": "Grace", "role": "Mobility", "id": id, "text": words }),
        );
    });
    told.then(|app| app.acknowledge_all("Ada"));
    told.then(|app| app.dispatch("review.approve", &ada));
    told.then(|app| {
        let words = "Mind the slope.";
        app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility", "text": words }));
    });
    told.then(|app| edit(app, "PATH1=OK [450,450]", "PATH1=OK [460,460]"));
    told.then(|app| app.acknowledge_all("Ada"));
    told.then(|app| app.dispatch("review.approve", &ada));
    told.then(|app| app.dispatch("review.approve", &grace));
    let statuses: Vec<&str> =
        told.rows.iter().filter_map(|row| row.trim_matches(['|', ' ']).rsplit(" | ").next()).collect();
    assert_eq!(
        statuses,
        [
            "draft",
            "in review",
            "in review",
            "in review",
            "in review",
            "approved with comments",
            "lapsed",
            "lapsed",
            "in review",
            "approved",
        ]
    );
    let manual = include_str!("../../../../docs/reviews.md");
    let table = told.rows.join("\n");
    assert!(manual.contains(&table), "docs/reviews.md does not show this:\n{table}");
    // What is shown there is what can be checked: the record, saved and read again.
    let record = told.app.session.state().review.record();
    let read = Record::from_json(&record.to_json()).expect("it is intact");
    assert_eq!((read.entries().len(), &read), (told.known, record));
}

fn open_json(app: &mut App, text: &str) {
    app.world.open_file(FileKind::Json, "board.review.json", text.as_bytes());
    app.settle();
}

/// Returns what the last message said.
fn last_toast(app: &App) -> String {
    app.session.state().window.toasts.shown().last().map(|toast| toast.text.clone()).unwrap_or_default()
}

/// A history of one comment, with its text altered.
fn tampered(app: &App) -> String {
    let text = app.session.state().review.record().to_json();
    let altered = text.replace("Why so long?", "Fine as it is.");
    assert_ne!(text, altered);
    altered
}

#[test]
fn a_history_that_was_altered_is_refused_and_nothing_of_it_is_added() {
    let mut author = before_the_board();
    author.dispatch("review.comment", &json!({ "author": "Ada", "role": "Science", "text": "Why so long?" }));
    let altered = tampered(&author);
    let mut app = test_support::start();
    open_json(&mut app, &altered);
    assert_eq!(app.json()["review"]["history"], json!([]));
    let said = last_toast(&app);
    assert!(said.contains("altered") && said.contains("entry 2 (Ada"), "{said}");
    open_json(&mut app, &author.session.state().review.record().to_json());
    share_keys(&author, &mut app);
    assert_eq!(app.json()["review"]["history"], author.json()["review"]["history"]);
}

/// Trusts whom `author` trusts, by a file of public keys.
fn share_keys(author: &App, app: &mut App) {
    open_json(app, &author.session.state().keys.ring().to_json(false));
    trust_file(app);
}

/// Agrees to trust the keys of the file that was opened.
fn trust_file(app: &mut App) {
    let asked = app.session.state().window.dialog.clone();
    let Some(Dialog::TrustKeys { people, .. }) = asked else { panic!("nothing is asked: {asked:?}") };
    app.run(Command::Window(WindowCommand::CloseDialog));
    app.run(Command::Review(ReviewCommand::ChangeKeys(KeyChange::Add(people))));
}

#[test]
fn keys_of_a_file_are_trusted_only_after_a_question() {
    let author = before_the_board();
    let people = author.json()["review"]["people"].as_array().map_or(0, Vec::len);
    let mut app = test_support::start();
    let file = author.session.state().keys.ring().to_json(true);
    open_json(&mut app, &file);
    assert_eq!(app.json()["dialog"], "trust-keys");
    assert_eq!(app.json()["review"]["people"], json!([]));
    app.run(Command::Window(WindowCommand::CloseDialog));
    assert_eq!(app.json()["review"]["people"], json!([]), "who cancels trusts no one");
    open_json(&mut app, &file);
    trust_file(&mut app);
    assert_eq!(app.json()["review"]["people"].as_array().map(Vec::len), Some(people));
    open_json(&mut app, &file);
    assert_eq!(app.json()["dialog"], Value::Null);
    assert!(last_toast(&app).contains("trusted already"), "{}", last_toast(&app));
}

#[test]
fn the_review_of_another_mission_is_refused_and_nothing_of_it_is_added() {
    let mut author = before_the_board();
    author.dispatch("review.comment", &json!({ "author": "Ada", "role": "Science", "text": "Why so long?" }));
    let theirs = author.session.state().review.record().to_json();
    let mut app = test_support::start();
    app.run(Command::OpenExample("both-paths".into()));
    app.run(Command::Review(ReviewCommand::Run));
    let rules = app.session.state().review.record().rules().clone();
    open_json(&mut app, &theirs);
    let said = last_toast(&app);
    assert!(said.contains("is a review of “enroute”") && said.contains("No entries added"), "{said}");
    assert_eq!(app.json()["review"]["history"], json!([]));
    assert_eq!(*app.session.state().review.record().rules(), rules, "its flight rules, neither");
    assert_eq!(status(&app), "draft");
    // Under another name, with the very text that it is about, it belongs there.
    let mut renamed: Value = serde_json::from_str(&theirs).expect("JSON");
    renamed["mission"] = json!("Drive to the target");
    let mut app = test_support::start();
    share_keys(&author, &mut app);
    open_json(&mut app, &renamed.to_string());
    assert_eq!(app.json()["review"]["history"], author.json()["review"]["history"]);
    // None of it counts in another mission, even if the file names that mission.
    renamed["mission"] = json!("both-paths");
    let mut app = test_support::start();
    app.run(Command::OpenExample("both-paths".into()));
    share_keys(&author, &mut app);
    open_json(&mut app, &renamed.to_string());
    let history = app.json()["review"]["history"].as_array().expect("a list").clone();
    assert!(!history.is_empty());
    for entry in history {
        let problem = entry["problem"].as_str().unwrap_or_default();
        assert!(entry["counts"] == false && problem.contains("the history of “enroute”"), "{entry}");
    }
    assert_eq!(*app.session.state().review.record().rules(), rules);
}

#[test]
fn a_mission_with_another_name_keeps_its_history() {
    let mut app = before_the_board();
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    app.dispatch("file.renameTo", &json!({ "name": "Survey of the ridge" }));
    assert_eq!(status(&app), "approved");
    assert_eq!(app.json()["mission"], "Survey of the ridge");
    // Who has the very content under another name, and no history, takes this one over.
    let mut other = test_support::start();
    other.dispatch("file.renameTo", &json!({ "name": "Mine" }));
    share_keys(&app, &mut other);
    other.run(Command::Review(ReviewCommand::Run));
    open_json(&mut other, &app.session.state().review.record().to_json());
    assert_eq!(status(&other), "approved");
}

const KEY: &str = "enroute/review-1/enroute";

#[test]
fn what_is_kept_and_cannot_be_used_is_kept_aside_and_never_lost() {
    let mut author = before_the_board();
    author.dispatch("review.comment", &json!({ "author": "Ada", "role": "Science", "text": "Why so long?" }));
    let altered = tampered(&author);
    let world = Rc::clone(&author.world);
    drop(author);
    world.storage.borrow_mut().insert(KEY.into(), altered.clone());
    let mut app = test_support::start_in(Rc::clone(&world));
    app.settle();
    assert!(app.json()["review"]["aside"].as_str().is_some_and(|why| why.contains("altered")));
    assert_eq!(app.json()["review"]["history"], json!([]));
    app.dispatch("review.comment", &json!({ "author": "Grace", "text": "Begun anew." }));
    assert_eq!(world.storage.borrow().get(&format!("{KEY}/aside")), Some(&altered));
    assert_eq!(app.json()["review"]["unkept"], Value::Null);
    app.run(Command::Review(ReviewCommand::SaveAside));
    assert_eq!(world.saved.borrow().last().expect("a file").1, altered.as_bytes());
    drop(app);
    let mut again = test_support::start_in(world);
    again.settle();
    assert_eq!(again.json()["review"]["comments"][0]["text"], "Begun anew.");
    assert!(again.json()["review"]["aside"].is_string(), "it can still be saved");
}

#[test]
fn a_review_of_a_later_version_is_never_written_over() {
    let world = Rc::<test_support::World>::default();
    let newer = json!({ "format": "enroute-review/4", "votes": [1, 2] }).to_string();
    world.storage.borrow_mut().insert(KEY.into(), newer.clone());
    "mission=enroute".clone_into(&mut world.fragment.borrow_mut());
    let mut app = test_support::start_in(Rc::clone(&world));
    app.settle();
    app.sign_as("Ada");
    app.dispatch("review.comment", &json!({ "author": "Ada", "text": "Here?" }));
    assert_eq!(world.storage.borrow().get(KEY), Some(&newer));
    let why = app.json()["review"]["unkept"].clone();
    assert!(why.as_str().is_some_and(|why| why.contains("later version")), "{why}");
    assert_eq!(app.json()["review"]["comments"][0]["text"], "Here?");
}

#[test]
fn a_whole_mission_with_an_altered_history_opens_and_says_so() {
    let mut author = before_the_board();
    author.dispatch("review.comment", &json!({ "author": "Ada", "role": "Science", "text": "Why so long?" }));
    author.dispatch("file.saveAs", &json!(null));
    let text = author.world.saved_text().replace("Why so long?", "Fine as it is.");
    let mut app = test_support::start();
    open_json(&mut app, &text);
    assert!(app.json()["review"]["aside"].as_str().is_some_and(|why| why.contains("altered")));
    let aside = app.world.storage.borrow().values().any(|kept| kept.contains("Fine as it is."));
    assert!(aside, "it is kept");
}

#[test]
fn runs_with_chance_survive_a_reload_and_reach_the_report_and_the_file() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    app.sample(20, 5);
    let kept = app.session.state().review.record().to_json();
    let record = Record::from_json(&kept).expect("a record");
    let hash = app.json()["review"]["hash"].as_str().expect("a hash").to_owned();
    let runs = record.runs_of(&hash).expect("they are kept by content");
    assert_eq!((runs.seed, runs.runs, runs.tally.runs), (5, 20, 20));
    let world = Rc::clone(&app.world);
    drop(app);
    let mut again = test_support::start_in(world);
    again.settle();
    again.run(Command::Review(ReviewCommand::Run));
    assert_eq!(again.json()["robustness"]["runs"], 20);
    again.run(Command::WriteReport);
    let page = again.world.saved_text();
    assert!(page.contains("of 20 runs reached the end (Monte Carlo, seed 5;"));
}

/// Ada writes better figures into a file, and signs them.
#[test]
fn runs_from_a_file_do_not_count_whoever_signed_them() {
    let mut author = before_the_board();
    author.dispatch("review.rules", &json!({ "success_rate": null }));
    author.sample(20, 5);
    author.acknowledge_all("Ada");
    author.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    let record = author.session.state().review.record().clone();
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    share_keys(&author, &mut app);
    open_json(&mut app, &record.to_json());
    assert!(last_toast(&app).contains("run them again"), "{}", last_toast(&app));
    assert_eq!(app.json()["robustness"]["runs"].as_u64(), None);
    let settings = &app.session.state().chance.settings;
    assert_eq!((settings.runs, settings.seed), (20, 5), "as Ada made them");
    // The same runs, made here, count.
    app.sample(20, 5);
    let hash = app.json()["review"]["hash"].as_str().expect("a hash").to_owned();
    let runs = |record: &Record| record.runs_of(&hash).cloned();
    assert_eq!(runs(app.session.state().review.record()), runs(&record));
}

#[test]
fn schedules_say_how_the_plan_stands_and_what_is_pinned() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada" }));
    assert_eq!(status(&app), "approved");
    app.dispatch("plan.pin", &json!({ "event": "Group-Wait#1.end", "time": 450 }));
    app.dispatch("export.schedule", &json!({ "as": "json", "epoch": "2004-01-25T05:05:00Z" }));
    let schedule: Value = serde_json::from_str(&app.world.saved_text()).expect("JSON");
    assert_eq!(schedule["plan_status"], "pinned", "nobody has approved these times");
    assert_eq!(schedule["plan_status_without_pins"], "approved");
    assert_eq!(schedule["content_hash"], app.json()["review"]["hash"]);
    assert_eq!(schedule["pinned"][0]["time"], 450);
    let rows = schedule["activities"].as_array().expect("a list");
    let wait = rows.iter().find(|row| row["name"] == "Group-Wait#1").expect("the wait");
    assert_eq!((&wait["end"]["earliest"], &wait["end"]["latest"]), (&json!(450), &json!(450)));
    assert_eq!(wait["end"]["earliest_utc"], "2004-01-25T12:35:00Z");
}

#[test]
fn rules_of_the_mission_are_evaluated_as_soon_as_they_are_set() {
    let mut app = before_the_board();
    let lines = |app: &App| -> Vec<(String, String)> {
        let items = app.json()["review"]["items"].as_array().expect("a list").clone();
        let rules = items.iter().filter(|item| item["section"] == "mission-rules");
        let text = |item: &Value, member: &str| item[member].as_str().expect("a text").to_owned();
        rules.map(|item| (text(item, "status"), text(item, "text"))).collect()
    };
    assert_eq!(lines(&app), []);
    let rule = |rule: &str| json!([{ "name": "Way", "rule": rule, "source": "FR 2", "waivable": false }]);
    app.dispatch("review.rules", &json!({ "rules": rule("PATH1=OK while Group-Traverse-Path") }));
    app.settle();
    let held = ("passed".to_owned(), "Way: holds in every schedule of the plan".to_owned());
    assert_eq!(lines(&app), [held]);
    assert_eq!(app.session.state().review.rule_tracks().len(), 1);
    // A rule that the plan breaks keeps the board from approving, whatever is acknowledged.
    app.dispatch("review.rules", &json!({ "rules": rule("never Group-Traverse-Path while PATH1=OK") }));
    app.settle();
    let [(status, text)] = &lines(&app)[..] else { panic!("one line") };
    assert_eq!(status, "failed", "{text}");
    app.acknowledge_all("Ada");
    let why = refused(&mut app, "review.approve", &json!({ "name": "Ada", "role": "Science" }));
    assert!(why.contains("failed"), "{why}");
    // With another text it is stale, and drawn no more; with the text again, it is there again.
    let source = app.session.source();
    app.run(Command::SetSource(source.replace("[450,450]", "[440,440]")));
    assert!(app.session.state().review.rule_tracks().is_empty());
}

/// Returns what the history says of the last entry: its signature, whether it counts, and why not.
fn last_entry(app: &App) -> (Value, Value, String) {
    let history = app.json()["review"]["history"].clone();
    let last = history.as_array().and_then(|all| all.last().cloned()).expect("an entry");
    let problem = last["problem"].as_str().unwrap_or_default().to_owned();
    (last["signature"].clone(), last["counts"].clone(), problem)
}

#[test]
fn names_that_look_alike_get_no_keys_and_nobody_signs_without_one() {
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    let ada = json!({ "author": "Ada", "text": "Why so long?" });
    assert!(refused(&mut app, "review.comment", &ada).contains("Unknown key “Ada”"));
    assert!(refused(&mut app, "review.rules", &json!({ "slope_deg": 2.5 })).contains("key"));
    app.dispatch("review.createKey", &json!({ "name": "Ada" }));
    let hidden = ["A\u{200b}da", "\u{202e}adA", "Ada\u{200f}", "\u{3164}"];
    for name in ["Àda", "\u{410}da", "Ａｄａ", "ada", "Ada\u{a0}", " "].iter().chain(&hidden) {
        let why = refused(&mut app, "review.createKey", &json!({ "name": name }));
        let words = ["taken for “Ada”", "scripts", "must contain letters", "invisible", "usual letter"];
        assert!(words.iter().any(|words| why.contains(words)), "{name:?}: {why}");
        assert!(!hidden.contains(name) || why.contains("invisible"), "{name:?}: {why}");
    }
    app.dispatch("review.comment", &ada);
    let people = app.json()["review"]["people"].clone();
    assert_eq!((people.as_array().map(Vec::len), &people[0]["own"]), (Some(1), &json!(true)));
    assert!(!app.json().to_string().contains("secret"), "host pages never see a secret key");
    // Another run signs with the same key.
    let mut again = test_support::start_in(Rc::clone(&app.world));
    again.settle();
    assert_eq!(again.json()["review"]["people"], people);
    // A key goes elsewhere in a file of its own.
    again.dispatch("review.saveKey", &json!({ "name": "Ada" }));
    let file = again.world.saved_text();
    let mut elsewhere = test_support::start();
    open_json(&mut elsewhere, &file);
    trust_file(&mut elsewhere);
    assert_eq!(elsewhere.json()["review"]["people"], people);
    let key = people[0]["key"].clone();
    elsewhere.dispatch("review.removeKey", &json!({ "key": key }));
    assert_eq!(elsewhere.json()["review"]["people"], json!([]));
    elsewhere.dispatch("review.trust", &json!({ "name": "Ada", "key": key }));
    assert_eq!(elsewhere.json()["review"]["people"][0]["own"], false);
    let other = refused(&mut elsewhere, "review.trust", &json!({ "name": "Grace", "key": key }));
    assert!(other.contains("already"), "{other}");
}

#[test]
fn nobody_takes_back_or_resolves_what_is_another_s() {
    let mut app = before_the_board();
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    let history = app.json()["review"]["history"].clone();
    let given = history.as_array().and_then(|all| all.last()).expect("an entry")["id"].clone();
    let back = json!({ "name": "Grace", "id": given, "text": "Not read." });
    assert!(refused(&mut app, "review.withdraw", &back).contains("Only the person who signed"));
    // A key counts once, in whatever role.
    let twice = json!({ "name": "Ada", "role": "Mobility" });
    assert!(refused(&mut app, "review.approve", &twice).contains("Ada has approved as Science already"));
    app.dispatch("review.comment", &json!({ "author": "Ada", "text": "Why so long?" }));
    let id = app.json()["review"]["comments"][0]["id"].clone();
    let resolve = |name: &str, text: &str| json!({ "name": name, "id": id, "text": text });
    assert!(refused(&mut app, "review.resolve", &resolve("Grace", "Fine.")).contains("Only the author"));
    assert!(refused(&mut app, "review.resolve", &resolve("Ada", " ")).contains("Enter how"));
    app.dispatch("review.resolve", &resolve("Ada", "It waits for light."));
    assert_eq!(app.json()["review"]["comments"][0]["open"], false);
}

#[test]
fn signatures_of_an_imported_history_are_shown_and_nothing_counts_until_it_is_valid() {
    let mut author = before_the_board();
    author.acknowledge_all("Ada");
    author.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    author.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    assert_eq!(status(&author), "approved");
    let text = author.session.state().review.record().to_json();
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    open_json(&mut app, &text);
    assert!(last_toast(&app).contains("don't count"), "{}", last_toast(&app));
    assert_eq!(last_entry(&app), (json!("unknown"), json!(false), String::new()));
    assert_eq!(
        (status(&app), &app.json()["review"]["rules"]["board"][0]["role"]),
        (json!("draft"), &json!("Reviewer"))
    );
    share_keys(&author, &mut app);
    assert_eq!(last_entry(&app), (json!("valid"), json!(true), String::new()));
    assert_eq!(status(&app), "approved");
    // With one signature altered the entry is broken, and the board has not approved.
    let mut document: Value = serde_json::from_str(&text).expect("JSON");
    let last = document["entries"].as_array_mut().and_then(|all| all.last_mut()).expect("an entry");
    last["signature"] = json!("0".repeat(128));
    let mut app = test_support::start();
    app.run(Command::Review(ReviewCommand::Run));
    share_keys(&author, &mut app);
    open_json(&mut app, &document.to_string());
    assert_eq!((last_entry(&app).0, status(&app)), (json!("broken"), json!("in-review")));
    // Someone who is not trusted any more has approved nothing.
    let key = author.json()["review"]["people"][1]["key"].clone();
    author.dispatch("review.removeKey", &json!({ "key": key }));
    assert_eq!(status(&author), "in-review");
}

#[test]
fn two_tabs_see_each_other_s_keys_and_approvals_at_once() {
    let mut one = before_the_board();
    one.acknowledge_all("Ada");
    let mut other = test_support::start_in(Rc::clone(&one.world));
    other.settle();
    other.run(Command::Review(ReviewCommand::Run));
    assert_eq!(other.json()["review"]["history"], one.json()["review"]["history"]);
    one.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    other.settle();
    assert_eq!(other.json()["review"]["board"][0]["given"], json!(["Ada"]));
    other.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    one.settle();
    assert_eq!((status(&one), status(&other)), (json!("approved"), json!("approved")));
    other.dispatch("review.createKey", &json!({ "name": "Katherine" }));
    one.settle();
    let known = one.json()["review"]["people"].as_array().map(Vec::len);
    assert_eq!(known, Some(4), "no tab writes over the keys of another");
    one.dispatch("review.createKey", &json!({ "name": "Dorothy" }));
    other.settle();
    assert_eq!(other.json()["review"]["people"].as_array().map(Vec::len), Some(5));
}

/// Neither tab has heard of the other when it acts: nothing that one does is lost by what the other does.
#[test]
fn two_tabs_that_act_at_the_same_time_lose_nothing_of_each_other() {
    let mut one = before_the_board();
    one.acknowledge_all("Ada");
    let mut other = test_support::start_in(Rc::clone(&one.world));
    other.settle();
    other.run(Command::Review(ReviewCommand::Run));
    one.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    other.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    one.settle();
    other.settle();
    assert_eq!((status(&one), status(&other)), (json!("approved"), json!("approved")));
    let history = one.json()["review"]["history"].clone();
    assert_eq!(other.json()["review"]["history"], history);
    // A key that one tab removes is not there again because the other one adds a key, or signs.
    let people = one.json()["review"]["people"].clone();
    let grace = people.as_array().and_then(|all| all.iter().find(|it| it["name"] == "Grace")).expect("a key");
    one.dispatch("review.removeKey", &json!({ "key": grace["key"] }));
    other.dispatch("review.createKey", &json!({ "name": "Katherine" }));
    one.settle();
    other.settle();
    for app in [&one, &other] {
        let names: Vec<Value> = app.json()["review"]["people"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|person| person["name"].clone())
            .collect();
        assert_eq!(names, ["Ada", "Chair", "Katherine"], "the same in both tabs");
        assert_eq!(status(app), "in-review");
    }
    let by_grace = json!({ "author": "Grace", "text": "Mine." });
    assert!(refused(&mut other, "review.comment", &by_grace).contains("Unknown key"));
}

#[test]
fn a_waiver_stands_for_an_acknowledgment_until_its_day() {
    let mut app = before_the_board();
    let items = app.json()["review"]["items"].as_array().expect("a list").clone();
    let index = items.iter().position(|item| item["status"] == "attention").expect("an item");
    let waive =
        |text: &str, until: &str| json!({ "name": "Chair", "item": index, "text": text, "until": until });
    assert!(refused(&mut app, "review.waive", &waive(" ", "2026-01-20")).contains("reason"));
    assert!(refused(&mut app, "review.waive", &waive("Known.", "soon")).contains("Enter the date"));
    for until in ["2026-02-30", "2026-01-20T00:00:00+14:00"] {
        assert!(
            refused(&mut app, "review.waive", &waive("Known.", until)).contains("Enter the date"),
            "{until}"
        );
    }
    // Of a day that has passed, nothing is waived.
    assert!(
        refused(&mut app, "review.waive", &waive("Known.", "2025-12-31")).contains("a date after the day")
    );
    assert_eq!(app.json()["review"]["waivers"], json!([]));
    app.dispatch("review.waive", &waive("Known, mended in the next version.", "2026-01-20"));
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    app.dispatch("review.approve", &json!({ "name": "Grace", "role": "Mobility" }));
    let state = |app: &App| app.json()["review"]["waivers"][0]["state"].clone();
    assert_eq!((status(&app), state(&app)), (json!("approved"), json!("in-force")));
    app.run(Command::WriteReport);
    assert!(app.world.saved_text().contains("<h2>Waivers</h2>"));
    // Days go by while the page is open.
    let go_on = |app: &mut App, days: f64| {
        app.world.now_secs.set(app.world.now_secs.get() + days * 86_400.0);
        app.settle();
    };
    go_on(&mut app, 12.0);
    assert_eq!((status(&app), state(&app)), (json!("approved"), json!("about-to-lapse")));
    go_on(&mut app, 8.0);
    assert_eq!((status(&app), state(&app)), (json!("in-review"), json!("lapsed")));
    let blockers = app.json()["review"]["blockers"].to_string();
    assert!(blockers.contains("not acknowledged"), "{blockers}");
    app.run(Command::WriteReport);
    assert!(app.world.saved_text().contains("lapsed</span>"));
}

/// The board that decides, and how many people it needs in its first role.
fn board(app: &App) -> (Value, Value) {
    let seat = app.json()["review"]["rules"]["board"][0].clone();
    (seat["role"].clone(), seat["approvals"].clone())
}

#[test]
fn a_board_is_weakened_only_once_it_agrees() {
    let mut app = before_the_board();
    let one = json!({ "board": [{ "role": "Science", "approvals": 1 }] });
    app.sign_as("Ada");
    app.dispatch("review.rules", &one);
    let toast = last_toast(&app);
    assert!(toast.contains("not in force yet") && toast.contains("1 of 2"), "{toast}");
    assert_eq!(app.json()["review"]["board"].as_array().map(Vec::len), Some(2));
    let entry = app.json()["review"]["history"].as_array().and_then(|all| all.last().cloned());
    let entry = entry.expect("an entry");
    assert!(entry["withoutEffect"].is_string() && entry["counts"] == true, "{entry}");
    // Once more is not two people.
    app.dispatch("review.rules", &one);
    assert!(last_toast(&app).contains("already agreed"), "{}", last_toast(&app));
    app.acknowledge_all("Ada");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    assert_eq!(status(&app), "in-review");
    app.sign_as("Grace");
    app.dispatch("review.rules", &one);
    assert_eq!(
        (board(&app), app.json()["review"]["board"].as_array().map(Vec::len)),
        ((json!("Science"), json!(1)), Some(1))
    );
    assert_ne!(status(&app), "approved", "Ada approved under other rules");
    app.dispatch("review.approve", &json!({ "name": "Ada", "role": "Science" }));
    assert_eq!(status(&app), "approved");
    // Who makes it stricter needs no one.
    app.dispatch("review.rules", &json!({ "board": [{ "role": "Science", "approvals": 2 }] }));
    assert_eq!((board(&app), status(&app)), ((json!("Science"), json!(2)), json!("lapsed")));
}
