//! The review as a reviewer meets it: computed lines that lead to their places, staleness, comments, acknowledgments, approvals, files.

use crate::support;
use egui::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use serde_json::{Value, json};
use workbench::PanelKind;
use workbench::command::Command;
use workbench::host::FileKind;
use workbench::host_io::Remote as _;
use workbench::state::compare::CompareCommand;
use workbench::state::search::SearchCommand;
use workbench::state::settings::SettingsCommand;
use workbench::state::window::WindowCommand;

use crate::support::App;

/// The Review workspace in a window with room for everything.
fn reviewing() -> App {
    reviewing_in(std::rc::Rc::default(), [1600.0, 3000.0])
}

fn reviewing_in(world: std::rc::Rc<support::World>, size: [f32; 2]) -> App {
    let mut app = support::start_in(world, |builder| builder.with_size(size));
    app.settle();
    app.harness.state_mut().dispatch("view.workspace", &json!("review")).expect("a workspace");
    app.settle();
    app
}

fn review(app: &App) -> Value {
    app.json()["review"].clone()
}

fn has(app: &App, start: &str) -> bool {
    app.harness
        .query_all_by_role(Role::Button)
        .any(|node| node.accesskit_node().label().is_some_and(|label| label.starts_with(start)))
}

/// Clicks the button whose name starts like this.
fn click(app: &mut App, start: &str) {
    let is_it = |node: &egui_kittest::kittest::AccessKitNode<'_>| {
        node.role() == Role::Button && node.label().is_some_and(|label| label.starts_with(start))
    };
    app.harness.get_by(is_it).scroll_to_me();
    app.settle();
    app.harness.get_by(is_it).click();
    app.settle();
}

/// Clicks the button of this very name.
fn click_exactly(app: &mut App, name: &str) {
    app.harness.get_by_role_and_label(Role::Button, name).scroll_to_me();
    app.settle();
    app.harness.get_by_role_and_label(Role::Button, name).click();
    app.settle();
}

fn type_into(app: &mut App, field: &str, text: &str) {
    app.harness.get_by_role_and_label(Role::TextInput, field).focus();
    app.settle();
    app.harness.get_by_role_and_label(Role::TextInput, field).type_text(text);
    app.settle();
}

/// Creates a key of this name, as a host page does, where there is none.
fn sign_as(app: &mut App, name: &str) {
    if !review(app)["people"].as_array().is_some_and(|people| people.iter().any(|it| it["name"] == name)) {
        app.harness.state_mut().dispatch("review.createKey", &json!({ "name": name })).expect("a name");
        app.settle();
    }
}

/// Creates a key of this name in the panel.
fn create_key(app: &mut App, name: &str) {
    type_into(app, "Your name", name);
    click_exactly(app, "Create key");
}

fn edit(app: &mut App) {
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("PATH1=OK [450,450]", "PATH1=OK [460,460]"));
    app.settle();
}

fn undo(app: &mut App) {
    app.harness.state_mut().dispatch("edit.undo", &json!(null)).expect("something to undo");
    app.settle();
}

#[test]
fn the_checklist_is_computed_when_the_reviewer_comes() {
    let app = reviewing();
    let review = review(&app);
    assert_eq!(review["stale"], false, "{review}");
    assert_eq!(review["hash"], review["currentHash"]);
    let sections: std::collections::BTreeSet<&str> =
        review["items"].as_array().expect("lines").iter().filter_map(|it| it["section"].as_str()).collect();
    for section in ["plan", "choices", "causal-links", "conflicts", "events", "traverses", "warnings"] {
        assert!(sections.contains(section), "{section}: {sections:?}");
    }
    // SPEC 3.6: the drive is over 0 to 45 minutes before path 1 closes. A margin that may be 0 has not passed.
    assert!(has(
        &app,
        "needs attention: Tell(PATH1=OK)#1 supports PATH1=OK during Group-Traverse-Path(PATH1_1, …, TAI_POS) and outlasts it by 0 to 45 min"
    ));
    assert!(has(&app, "Causal links, needs attention, 1 needs attention"));
    assert!(has(&app, "Robustness, not run yet"));
    assert!(has(&app, "Conflicts between vehicles"));
}

#[test]
fn why_the_other_path_was_not_taken_is_said() {
    let app = reviewing();
    let found = app.harness.query_all_by_role(Role::Button).any(|node| {
        node.accesskit_node().label().is_some_and(|label| {
            label.starts_with("Group-Traverse-Path(PATH2_1, …, TAI_POS)")
                && label.contains("Impossible")
                && label.contains("PATH2")
        })
    });
    assert!(found);
}

#[test]
fn one_edit_makes_the_review_stale_and_undoing_it_makes_it_current_again() {
    let mut app = reviewing();
    let before = review(&app);
    edit(&mut app);
    let stale = review(&app);
    assert_eq!(stale["stale"], true);
    assert_eq!(stale["hash"], before["hash"]);
    assert_ne!(stale["currentHash"], before["hash"]);
    app.harness.get_by_label("Out of date");
    undo(&mut app);
    assert_eq!(review(&app), before);
    assert!(app.harness.query_by_label("Out of date").is_none());
}

#[test]
fn nothing_of_a_stale_review_has_passed() {
    let mut app = reviewing();
    assert!(has(&app, "passed: ") && has(&app, "Choices, passed"));
    for text in ["primitive A(); scenario S = { A( }", "primitive A(); scenario S[0,9] = { A() }"] {
        app.harness.state_mut().set_source(text);
        app.settle();
        assert!(!has(&app, "passed: ") && !has(&app, "Choices, passed"), "{text}");
        assert!(has(&app, "had passed: ") && has(&app, "Choices, had passed"), "{text}");
        app.harness.get_by_label("Out of date");
    }
    undo(&mut app);
    undo(&mut app);
    assert!(has(&app, "passed: "));
}

#[test]
fn a_step_of_the_search_beside_the_review_is_said_to_be_one() {
    let mut app = reviewing();
    let note = "The panels show step 1 of the search, not the reviewed plan.";
    assert!(app.harness.query_by_label(note).is_none());
    app.harness.state_mut().run(Command::Settings(SettingsCommand::SetTrace(true)));
    app.settle();
    app.harness.state_mut().run(Command::Search(SearchCommand::GoTo(0)));
    app.settle();
    app.harness.get_by_label(note);
    click(&mut app, "Show plan");
    assert!(app.harness.query_by_label(note).is_none());
}

#[test]
fn a_review_that_is_run_again_is_of_the_present_text_and_the_old_one_is_found_again() {
    let mut app = reviewing();
    let before = review(&app);
    edit(&mut app);
    click(&mut app, "Review again");
    let after = review(&app);
    assert_eq!(after["stale"], false);
    assert_ne!(after["hash"], before["hash"]);
    undo(&mut app);
    assert_eq!(review(&app), before, "nothing has to be reviewed twice");
}

/// Acknowledges every item that needs attention, as a host page does.
fn acknowledge_all(app: &mut App) {
    sign_as(app, "Ada");
    let items = review(app)["items"].as_array().expect("lines").clone();
    for (index, item) in items.iter().enumerate() {
        if item["status"] == "attention" && item["acknowledged"].is_null() {
            let arguments = json!({ "name": "Ada", "item": index, "text": "As meant." });
            app.harness.state_mut().dispatch("review.acknowledge", &arguments).expect("a line");
            app.settle();
        }
    }
}

/// Approves what is shown, as a host page does.
fn approve(app: &mut App, name: &str) {
    acknowledge_all(app);
    sign_as(app, name);
    app.harness.state_mut().dispatch("review.approve", &json!({ "name": name })).expect("a current review");
    app.settle();
}

#[test]
fn an_approval_is_for_one_content_and_stays_with_it() {
    let mut app = reviewing();
    create_key(&mut app, "Ada Lovelace");
    // Each item that needs attention is acknowledged below itself, with the keyboard.
    let left = |app: &App| {
        let items = review(app)["items"].as_array().expect("lines").clone();
        items.iter().filter(|it| it["status"] == "attention" && it["acknowledged"].is_null()).count()
    };
    let lines = left(&app);
    assert!(lines > 0);
    for done in 1..=lines {
        let label = app.harness.query_all_by_role(Role::Button).find_map(|node| {
            node.accesskit_node().label().filter(|label| label.starts_with("Acknowledge… "))
        });
        click(&mut app, &label.expect("a line to acknowledge"));
        type_into(&mut app, "Why is this acceptable?", "As meant.");
        app.harness.key_press(egui::Key::Enter);
        app.settle();
        assert_eq!(left(&app), lines - done);
    }
    click_exactly(&mut app, "Approve");
    let signed = review(&app)["signed"].clone();
    assert_eq!(signed["name"], "Ada Lovelace");
    assert_eq!(signed["stale"], false);
    assert_eq!(signed["hash"], review(&app)["currentHash"]);
    assert!(signed["time"].as_str().is_some_and(|time| time.starts_with("2026-01-02T03:04:")), "{signed}");
    assert_eq!(review(&app)["planStatus"], "approved");
    app.harness.get_by_label("Plan: approved");
    edit(&mut app);
    assert_eq!(review(&app)["signed"]["stale"], true);
    app.harness.get_by_label("Plan: approval lapsed");
    let refused = app.harness.state_mut().dispatch("review.approve", &json!({ "name": "Ada Lovelace" }));
    assert!(refused.is_err(), "a stale review cannot be approved");
    click(&mut app, "Review again");
    assert!(has(&app, "Since the last approval, text 1, plan "));
    // The review of what was approved is back before its plan is: nothing is compared in between.
    app.world.is_slow.set(true);
    undo(&mut app);
    assert_eq!(review(&app)["signed"], signed);
    assert!(!has(&app, "Since the last approval, text 1"));
    app.world.is_slow.set(false);
    app.settle();
    assert!(has(&app, "Since the last approval, no differences"));
    // Taking it back is an entry of the history.
    click(&mut app, "Withdraw… Ada Lovelace");
    type_into(&mut app, "Reason for withdrawing", "Too early.");
    click_exactly(&mut app, "Withdraw");
    assert_eq!(review(&app)["planStatus"], "in-review");
    let last = review(&app)["history"].as_array().and_then(|all| all.last().cloned()).expect("an entry");
    assert_eq!((&last["act"], &last["text"]), (&json!("took back"), &json!("Too early.")));
}

#[test]
fn a_comment_is_resolved_and_opened_again_by_name() {
    let mut app = reviewing();
    sign_as(&mut app, "Grace");
    sign_as(&mut app, "Ada");
    let asked = json!({ "author": "Grace", "to": "Ada", "text": "Why so long?" });
    app.harness.state_mut().dispatch("review.comment", &asked).expect("a comment");
    app.settle();
    assert!(has(&app, "Comments, 1 open of 1"));
    click(&mut app, "Resolve… Why so long?");
    type_into(&mut app, "How was it resolved?", "It waits for light.");
    click_exactly(&mut app, "Resolve");
    assert!(has(&app, "Comments, 0 open of 1"));
    click(&mut app, "Reopen… Why so long?");
    click_exactly(&mut app, "Reopen");
    assert_eq!(review(&app)["comments"][0]["open"], true);
    assert_eq!(review(&app)["history"].as_array().map(Vec::len), Some(3));
}

#[test]
fn the_board_is_part_of_the_flight_rules() {
    let mut app = reviewing();
    create_key(&mut app, "Chris");
    click(&mut app, "Add role");
    type_into(&mut app, "Role 2", "Mobility");
    click(&mut app, "Apply rules");
    let board = review(&app)["rules"]["board"].clone();
    assert_eq!(board[1], json!({ "role": "Mobility", "approvals": 1, "people": [] }));
    assert!(has(&app, "Approval, Reviewer 0 of 1, Mobility 0 of 1"));
}

#[test]
fn a_mission_without_a_plan_cannot_be_approved() {
    let mut app = reviewing();
    let source = app.harness.state().source();
    app.harness.state_mut().set_source(&source.replace("PATH1=OK [450,450]", "PATH1=OK [404,404]"));
    app.settle();
    click(&mut app, "Review again");
    assert_eq!(review(&app)["status"], "failed");
    sign_as(&mut app, "Ada");
    let refused = app.harness.state_mut().dispatch("review.approve", &json!({ "name": "Ada" }));
    assert!(refused.is_err_and(|error| error.to_string().contains("no plan")));
}

#[test]
fn a_line_leads_to_its_place_in_every_panel() {
    let mut app = reviewing();
    click(&mut app, "needs attention: Tell(PATH1=OK)#1 supports");
    let state = app.json();
    assert_eq!(state["selection"]["kind"], "link");
    let source = app.harness.state().source();
    let range = state["caret"]["anchor"].as_u64().zip(state["caret"]["head"].as_u64());
    let (from, to) = range.expect("a caret");
    assert!(source[from as usize..to as usize].contains("PATH1"), "the caret is at the requirement");
    click(&mut app, "passed: not(PROCEED=OK) during Group-Wait(TAI_HOLD1, TAI_HOLD2) ends");
    assert_eq!(app.json()["selection"]["kind"], "ordering");
    click(&mut app, "Group-Wait(TAI_HOLD1, TAI_HOLD2).end [415, 514], slack 99");
    assert_eq!(app.json()["selection"]["name"], "Group-Wait#1.end");
    let label = app.harness.query_all_by_role(Role::Button).find_map(|node| {
        node.accesskit_node().label().filter(|label| {
            label.contains(": Group-Traverse-Path(PATH1_1, …, TAI_POS): ") && label.contains(" m in ")
        })
    });
    click(&mut app, &label.expect("the traverse"));
    assert_eq!(app.json()["selection"]["name"], "Group-Traverse-Path#1");
}

#[test]
fn sections_fold_with_the_keyboard() {
    let mut app = reviewing();
    assert!(has(&app, "Group-Wait(TAI_HOLD1, TAI_HOLD2).end [415, 514]"));
    let heading = |app: &App| {
        let label = app.harness.query_all_by_role(Role::Button).find_map(|node| {
            node.accesskit_node().label().filter(|label| label.starts_with("Windows and slack"))
        });
        label.expect("a heading")
    };
    let name = heading(&app);
    app.harness.get_by_role_and_label(Role::Button, &name).focus();
    app.settle();
    app.harness.key_press(egui::Key::Enter);
    app.settle();
    assert!(!has(&app, "Group-Wait(TAI_HOLD1, TAI_HOLD2).end [415, 514]"));
}

#[test]
fn comments_are_about_what_is_selected_and_are_found_in_the_next_run() {
    let mut app = reviewing();
    app.harness.state_mut().dispatch("go.select", &json!("Group-Wait#1")).expect("an activity");
    app.settle();
    create_key(&mut app, "Grace");
    app.harness.get_by_role_and_label(Role::MultilineTextInput, "Comment").focus();
    app.settle();
    let field = app.harness.get_by_role_and_label(Role::MultilineTextInput, "Comment");
    field.type_text("Is such a long wait intended?");
    app.settle();
    click(&mut app, "Add comment");
    let comments = review(&app)["comments"].clone();
    assert_eq!(comments[0]["about"], "Group-Wait#1");
    assert_eq!(comments[0]["author"], "Grace");
    let again = reviewing_in(app.world.clone(), [1600.0, 3000.0]);
    assert_eq!(review(&again)["comments"], comments);
}

#[test]
fn a_full_storage_is_said_and_loses_nothing() {
    let mut app = reviewing();
    sign_as(&mut app, "Grace");
    app.harness
        .state_mut()
        .dispatch("review.comment", &json!({ "author": "Grace", "text": "first" }))
        .expect("a comment");
    app.settle();
    let kept = app.world.storage.borrow().clone();
    app.world.is_full.set(true);
    app.harness
        .state_mut()
        .dispatch("review.comment", &json!({ "author": "Grace", "text": "second" }))
        .expect("a comment");
    app.settle();
    assert!(review(&app)["unkept"].as_str().is_some_and(|reason| reason.contains("no space")));
    app.harness.get_by_label("Review history not saved");
    let key = "enroute/review-1/enroute";
    assert_eq!(app.world.storage.borrow().get(key), kept.get(key), "what was kept is unharmed");
    // Another mission and back: what could not be kept is still there.
    app.harness.state_mut().open("threats").expect("an example");
    app.settle();
    assert_eq!(review(&app)["comments"], json!([]));
    app.harness.state_mut().open("enroute").expect("an example");
    app.settle();
    assert_eq!(review(&app)["comments"].as_array().map(Vec::len), Some(2));
    // With room again, the next entry keeps all of them.
    app.world.is_full.set(false);
    app.harness
        .state_mut()
        .dispatch("review.comment", &json!({ "author": "Grace", "text": "third" }))
        .expect("a comment");
    app.settle();
    assert_eq!(review(&app)["unkept"], Value::Null);
    let again = reviewing_in(app.world.clone(), [1600.0, 3000.0]);
    assert_eq!(review(&again)["comments"].as_array().map(Vec::len), Some(3));
}

#[test]
fn what_was_said_goes_into_a_file_and_comes_back_from_it() {
    let mut app = reviewing();
    sign_as(&mut app, "Grace");
    app.harness
        .state_mut()
        .dispatch("review.comment", &json!({ "author": "Grace", "text": "Fine." }))
        .expect("a comment");
    let id = review(&app)["comments"][0]["id"].clone();
    let resolve = json!({ "name": "Grace", "id": id, "text": "It is." });
    app.harness.state_mut().dispatch("review.resolve", &resolve).expect("an open comment");
    approve(&mut app, "Grace");
    app.harness.state_mut().dispatch("review.save", &json!(null)).expect("something to save");
    app.settle();
    let (name, bytes) = app.world.saved.borrow().last().cloned().expect("a file");
    assert_eq!(name, "enroute.review.json");
    let document: Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(document["format"], "enroute-review/3");

    let mut other = reviewing();
    assert_eq!(review(&other)["signed"], Value::Null);
    other.world.open_file(FileKind::Json, &name, &bytes);
    other.settle();
    assert_eq!(review(&other)["signed"], Value::Null, "nobody knows these keys");
    // Each key that the history names can be trusted, beside its fingerprint.
    for name in ["Ada", "Grace"] {
        click(&mut other, &format!("Trust {name}"));
    }
    assert_eq!(review(&other)["signed"], review(&app)["signed"]);
    assert_eq!(review(&other)["comments"], review(&app)["comments"]);
    // A second time adds nothing.
    other.world.open_file(FileKind::Json, &name, &bytes);
    other.settle();
    assert_eq!(review(&other)["comments"].as_array().map(Vec::len), Some(1));
}

#[test]
fn the_review_fits_into_a_narrow_panel() {
    let mut app = reviewing_in(std::rc::Rc::default(), [360.0, 3000.0]);
    for panel in ["plan", "timeline", "compare", "network", "terrain", "editor", "problems", "outline"] {
        app.harness.state_mut().dispatch("view.closePanel", &json!(panel)).expect("a panel");
        app.settle();
    }
    let lines: Vec<egui::Rect> = app
        .harness
        .query_all_by_role(Role::Button)
        .filter(|node| {
            let label = node.accesskit_node().label().unwrap_or_default();
            label.starts_with("passed: ") || label.starts_with("Group-") || label.contains(", passed")
        })
        .map(|node| node.rect())
        .collect();
    assert!(lines.len() > 10, "{}", lines.len());
    for line in lines {
        assert!(line.left() >= 0.0 && line.right() <= 360.0, "{line:?}");
    }
}

#[test]
fn the_report_is_written_with_the_review_that_is_shown() {
    let mut app = reviewing();
    approve(&mut app, "Ada & Co");
    click(&mut app, "Write report");
    let (name, bytes) = app.world.saved.borrow().last().cloned().expect("a file");
    assert_eq!(name, "enroute.report.html");
    let page = String::from_utf8(bytes).expect("UTF-8");
    assert!(page.contains(review(&app)["hash"].as_str().expect("a hash")));
    assert!(page.contains("Ada &amp; Co"));
    assert!(page.contains("<svg") && page.contains("Group-Traverse-Path(PATH1_1, …, TAI_POS)"));
}

#[test]
fn the_report_of_a_text_that_was_not_reviewed_waits_for_the_review() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().dispatch("file.report", &json!(null)).expect("a mission");
    app.settle();
    let saved = app.world.saved.borrow();
    assert_eq!(saved.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["enroute.report.html"]);
}

#[test]
fn schedules_are_written_from_the_menu_once_the_start_is_known() {
    let mut app = support::start();
    app.settle();
    app.harness.state_mut().dispatch("export.csv", &json!(null)).expect("a plan");
    app.settle();
    click(&mut app, "Export");
    app.harness.state_mut().dispatch("export.icalendar", &json!(null)).expect("a plan");
    app.settle();
    assert_eq!(app.json()["dialog"], "epoch");
    type_into(&mut app, "Mission start (date and time, UTC)", "2004-01-25T05:05:00Z");
    click(&mut app, "Export");
    assert_eq!(app.json()["dialog"], Value::Null);
    let open_mct = json!({ "as": "open-mct", "epoch": "2004-01-25T05:05:00Z" });
    app.harness.state_mut().dispatch("export.schedule", &open_mct).expect("a plan");
    app.settle();
    let saved = app.world.saved.borrow();
    let names: Vec<&str> = saved.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["enroute.schedule.csv", "enroute.ics", "enroute.open-mct.json"]);
    let text = |index: usize| String::from_utf8(saved[index].1.clone()).expect("UTF-8");
    assert!(text(0).contains(
        "Group-Wait#1,primitive,Group-Wait,TAI_HOLD1 TAI_HOLD2,415,460,415,514,45,99,min,,,,draft,"
    ));
    assert!(text(1).contains("DTSTART:20040125T051500Z\r\n"));
    let plan: Value = serde_json::from_str(&text(2)).expect("JSON");
    assert!(plan["Activities"].as_array().is_some_and(|entries| !entries.is_empty()));
}

#[test]
fn a_pinned_plan_shows_what_an_edit_changes() {
    let mut app = reviewing();
    app.harness.state_mut().run(Command::Compare(CompareCommand::Pin));
    app.settle();
    app.harness.get_by_label("The plans are identical");
    edit(&mut app);
    assert!(has(
        &app,
        "condition Tell(PATH1=OK)#1 moved: starts [10, 10], ends [460, 460] → starts [10, 10], ends [470, 470]"
    ));
    assert!(has(&app, "Group-Traverse-Path(PATH1_1, …, TAI_POS), moved: "));
    undo(&mut app);
    app.harness.get_by_label("The plans are identical");
}

/// Returns what is written on the drawings, which no role tells.
fn painted(app: &App) -> Vec<String> {
    fn collect(shape: &egui::Shape, found: &mut Vec<String>) {
        match shape {
            egui::Shape::Text(text) => found.push(text.galley.text().to_owned()),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    for shape in &app.harness.output().shapes {
        collect(&shape.shape, &mut found);
    }
    found
}

#[test]
fn the_network_in_a_review_says_what_the_approved_plan_had_otherwise() {
    let mut app = reviewing();
    approve(&mut app, "Ada");
    let says = |app: &App| painted(app).iter().any(|text| text == "end was 460");
    let show = |app: &mut App, panel: Option<PanelKind>| {
        app.harness.state_mut().run(Command::Window(WindowCommand::Maximize(panel)));
        app.settle();
    };
    show(&mut app, Some(PanelKind::Network));
    assert!(!says(&app), "nothing differs from what was approved");
    show(&mut app, None);
    edit(&mut app);
    click(&mut app, "Review again");
    show(&mut app, Some(PanelKind::Network));
    assert!(says(&app), "{:?}", painted(&app));
    undo(&mut app);
    assert!(!says(&app));
}

#[test]
fn the_last_approval_can_be_compared_with_the_present_text() {
    let mut app = reviewing();
    approve(&mut app, "Ada");
    edit(&mut app);
    app.harness.state_mut().dispatch("compare.approved", &json!(null)).expect("it is approved");
    app.settle();
    assert_eq!(app.json()["compare"]["with"], "approved by Ada on 2026-01-02");
    assert!(has(&app, "condition Tell(PATH1=OK)#1 moved"));
    // The edit itself is there, and not only what came of it.
    app.harness.state_mut().dispatch("view.panel", &json!("compare")).expect("a panel");
    app.settle();
    let texts = painted(&app);
    let is_line =
        |sign: &str, bounds: &str| texts.iter().any(|text| text.starts_with(sign) && text.contains(bounds));
    assert!(is_line("− ", "PATH1=OK [450,450]") && is_line("+ ", "PATH1=OK [460,460]"));
}

#[test]
fn a_saved_plan_and_another_mission_can_be_compared_with() {
    let mut app = reviewing();
    let plan = app.json()["plan"].to_string();
    let open = |app: &mut App, name: &str, text: &str| {
        app.world.open_file(FileKind::Comparison, name, text.as_bytes());
        app.settle();
    };
    open(&mut app, "saved.json", &plan);
    assert_eq!(app.json()["compare"]["with"], "saved.json");
    app.harness.state_mut().dispatch("view.panel", &json!("compare")).expect("a panel");
    app.settle();
    app.harness.get_by_label("The plans are identical");
    let both = include_str!("../../../../assets/missions/both-paths.rmpl");
    open(&mut app, "both-paths.rmpl", both);
    assert_eq!(app.json()["compare"]["with"], "both-paths.rmpl");
    open(&mut app, "wrong.json", "{\"plans\": 3}");
    assert_eq!(app.json()["compare"]["with"], "both-paths.rmpl", "a wrong file changes nothing");
}

#[test]
fn a_rule_says_whether_it_holds_in_this_plan_only_or_in_every_plan() {
    let mut app = reviewing();
    let source = "primitive Walk()[5,9]; primitive Run()[1,2]; \
        scenario S[0,30] = { choose { Walk(), Run() }; delay }";
    app.harness.state_mut().run(Command::SetSource(source.to_owned()));
    app.settle();
    let rules = json!([
        { "name": "Floor", "rule": "never (Walk and Run)" },
        { "name": "Pace", "rule": "never Run" },
    ]);
    app.harness.state_mut().dispatch("review.createKey", &json!({ "name": "Ada" })).expect("a key");
    app.settle();
    app.harness.state_mut().dispatch("review.rules", &json!({ "rules": rules })).expect("flight rules");
    app.harness.state_mut().dispatch("review.run", &json!(null)).expect("a review");
    app.settle();
    click_exactly(&mut app, "Prove: Floor");
    let says = |app: &App, words: &str| app.harness.query_all_by_label_contains(words).next().is_some();
    assert!(says(&app, "Holds in every plan"), "{}", app.json()["ruleProofs"]);
    assert!(!says(&app, "Holds in this plan only"));
    click_exactly(&mut app, "Prove all rules");
    assert!(
        says(&app, "Holds in this plan only. Another plan can violate it"),
        "{}",
        app.json()["ruleProofs"]
    );
    click_exactly(&mut app, "Open plan: Pace");
    assert_eq!(app.json()["compare"]["with"], json!("plan that can violate \u{201c}never Run\u{201d}"));
}
