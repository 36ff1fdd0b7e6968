//! The workbench as a host page drives it, without a window.

use serde_json::{Value, json};
use workbench::host::{HostEvent, RemoteError};
use workbench::host_io::Remote as _;
use workbench::mission_file::EXAMPLES;
use workbench::registry::all_commands;

#[test]
fn a_host_page_can_drive_the_app_and_is_told_what_is_wrong_with_a_call() {
    let mut app = test_support::start();
    let enroute = &mut app.session;
    enroute.set_source("scenario S[0,10] = { delay[5,5] }");
    enroute.dispatch("view.workspace", &json!({ "name": "teach" })).expect("a workspace");
    assert_eq!(enroute.source(), "scenario S[0,10] = { delay[5,5] }");
    assert!(matches!(enroute.open("nowhere"), Err(RemoteError::UnknownMission { .. })));
    assert!(matches!(enroute.dispatch("no.such", &json!(null)), Err(RemoteError::UnknownCommand { .. })));
    assert!(matches!(
        enroute.dispatch("view.workspace", &json!({ "name": "kitchen" })),
        Err(RemoteError::BadArguments { .. })
    ));
    app.settle();
    let state = app.json();
    assert_eq!(state["workspace"], "teach");
    assert_eq!(state["status"], "plan");
    assert_eq!(state["plan"]["windows"]["delay#1.end"], json!([5, 5]));
    assert_eq!(state["revision"], state["shownRevision"]);
}

#[test]
fn an_error_in_the_text_keeps_the_last_good_network_and_says_so() {
    let mut app = test_support::start();
    let nodes = app.json()["tpn"]["nodes"].clone();
    let source = app.session.source();
    app.session.set_source(&source.replace("choose {", "choose"));
    app.settle();
    let state = app.json();
    assert_eq!(state["status"], "broken");
    assert_eq!(state["isStale"], true);
    assert_eq!(state["tpn"]["nodes"], nodes);
    assert!(!state["diagnostics"].as_array().expect("a list").is_empty());
}

#[test]
fn a_host_page_sees_resources_and_what_a_plan_is_worth() {
    let mut app = test_support::start();
    assert!(app.json()["plan"].get("resources").is_none(), "the first mission has none");
    let text = "resource Battery 0..100 = 60;
        resource Drill;
        primitive Drive()[4,8] consumes Battery 50 costs 2;
        primitive Dig()[3,3] uses Drill rewards 9;
        scenario S[0,100] = { Drive(); { free Dig(), free Dig() } }";
    app.session.set_source(text);
    app.settle();
    let state = app.json();
    assert_eq!(state["verdict"]["valid"], json!(true), "{state}");
    let plan = &state["plan"];
    assert_eq!(
        plan["resources"],
        json!({
            "Battery": { "least": 0, "greatest": 100, "low": 10, "high": 60 },
            "Drill": { "capacity": 1, "peak": 1 },
        })
    );
    assert_eq!((&plan["cost"], &plan["reward"]), (&json!(2), &json!(18)));
    // Which of the two comes first is up to planning.
    let mut ordered: Vec<&str> =
        plan["uses_ordered"][0].as_array().expect("a pair").iter().filter_map(Value::as_str).collect();
    ordered.sort_unstable();
    assert_eq!(ordered, ["Uses(Drill)@Dig#1", "Uses(Drill)@Dig#2"]);
    assert_eq!(state["bound"], json!(null));
}

#[test]
fn every_mission_that_comes_with_the_app_has_no_errors() {
    let mut app = test_support::start();
    for example in EXAMPLES {
        app.session.open(example.name).expect("it is known");
        app.settle();
        let state = app.json();
        let problems = state["diagnostics"].as_array().expect("a list");
        // That there is no plan is what some of them show.
        let is_mistake = |it: &&Value| it["severity"] == "error" && it["code"] != "E-NOPLAN";
        assert!(!problems.iter().any(|it| is_mistake(&it)), "{}: {problems:?}", example.name);
        assert_ne!(state["status"], "broken", "{}", example.name);
    }
}

#[test]
fn what_opens_on_a_first_visit_has_a_plan_and_neither_errors_nor_warnings() {
    let mut app = test_support::start();
    app.session.open(EXAMPLES[0].name).expect("it is known");
    app.settle();
    let state = app.json();
    assert_eq!((&state["status"], &state["diagnostics"]), (&json!("plan"), &json!([])));
    assert_eq!(workbench::state::AppState::new().mission, EXAMPLES[0].name);
}

#[test]
fn the_battery_s_mission_charges_between_its_drives() {
    let mut app = test_support::start();
    app.session.open("battery").expect("it is known");
    app.settle();
    let state = app.json();
    assert_eq!((&state["status"], &state["verdict"]["valid"]), (&json!("plan"), &json!(true)));
    let earliest = |event: &str| -> exact::Time {
        serde_json::from_value(state["plan"]["windows"][event][0].clone()).expect("a time")
    };
    assert!(earliest("Charge#1.end") <= earliest("Drive#3.start"), "{}", state["plan"]["windows"]);
    assert!(earliest("Drive#1.start") < earliest("Charge#1.start"), "{}", state["plan"]["windows"]);
}

#[test]
fn time_plays_to_the_end_of_the_plan_and_stops() {
    let mut app = test_support::start();
    app.session.dispatch("play.toggle", &json!(null)).expect("there is a plan");
    assert_eq!(app.json()["isPlaying"], true);
    for _ in 0..200 {
        app.world.now_secs.set(app.world.now_secs.get() + 0.2);
        app.step();
    }
    let state = app.json();
    assert_eq!(state["isPlaying"], false);
    assert_eq!(state["time"], state["endTime"]);
    assert_eq!(state["endTime"], 660.0);
}

#[test]
fn the_address_opens_a_mission_in_a_workspace() {
    let world = std::rc::Rc::<test_support::World>::default();
    "mission=threats&workspace=review".clone_into(&mut world.fragment.borrow_mut());
    let mut app = test_support::start_in(world);
    app.settle();
    assert_eq!(app.json()["mission"], "threats");
    assert_eq!(app.json()["workspace"], "review");
}

#[test]
fn pins_stay_when_the_text_changes_elsewhere_and_go_when_their_time_is_over() {
    let mut app = test_support::start();
    let pin = json!({ "event": "Group-Enroute#1.start", "time": 40 });
    app.session.dispatch("plan.pin", &pin).expect("an event");
    app.settle();
    let source = app.session.source();
    app.session.set_source(&source.replace("[0,2]", "[0,3]"));
    app.settle();
    assert_eq!(app.json()["pinned"]["events"], json!({ "Group-Enroute#1.start": 40.0 }));
    // The drive of at least 405 must now end by 420.
    app.session.set_source(&source.replace("PATH1=OK [450,450]", "PATH1=OK [410,410]"));
    app.settle();
    assert_eq!(app.json()["status"], "plan");
    assert_eq!(app.json()["pinned"], Value::Null);
}

#[test]
fn command_names_are_unique_and_no_two_commands_share_a_key_where_both_work() {
    for (index, left) in all_commands().enumerate() {
        for right in all_commands().skip(index + 1) {
            assert_ne!(left.id, right.id);
            for key in left.keys {
                assert!(!right.keys.contains(key), "{} and {} share {key:?}", left.id, right.id);
            }
        }
    }
}

/// A text whose planning takes long: it is asked for, and not answered.
fn at_work() -> test_support::App {
    let mut app = test_support::start();
    app.world.is_deaf.set(true);
    app.session.set_source("scenario S[0,10] = { delay[5,5] }");
    app.settle();
    app
}

#[test]
fn work_that_was_stopped_leaves_its_text_undecided_until_it_is_planned_again() {
    let mut app = at_work();
    assert_eq!(app.json()["status"], "working");
    app.dispatch("plan.stop", &json!(null));
    assert_eq!(app.json()["status"], "undecided");
    assert_eq!(app.world.stopped.get(), 1, "the core is told");
    assert!(app.session.dispatch("plan.stop", &json!(null)).is_err(), "there is nothing to stop any more");

    app.world.is_deaf.set(false);
    app.dispatch("plan.again", &json!(null));
    assert_eq!(app.json()["status"], "plan");
    assert_eq!(app.session.source(), "scenario S[0,10] = { delay[5,5] }");
}

#[test]
fn the_best_plan_so_far_is_kept_when_looking_for_a_better_one_is_stopped() {
    let mut planned = test_support::start();
    planned.session.set_source("scenario S[0,10] = { delay[5,5] }");
    planned.settle();
    let mut snapshot = planned.session.state().shown().expect("it is planned").as_ref().clone();
    let mut app = at_work();
    snapshot.revision = app.json()["revision"].as_u64().expect("a number");
    snapshot.stage = snapshot::Stage::Improving;
    let answer = link::Response::Snapshot(std::sync::Arc::new(snapshot));
    app.world.news.borrow_mut().push_back(HostEvent::Answer(answer));
    app.settle();
    assert_eq!(app.json()["status"], "working", "a better one may come");
    assert!(app.session.state().is_improving());
    assert!(app.json()["plan"].is_object(), "and this one is shown");
    app.dispatch("plan.stop", &json!(null));
    assert_eq!((app.world.stopped.get(), &app.json()["status"]), (1, &json!("plan")));
    assert!(app.json()["plan"].is_object());
    assert!(app.session.dispatch("plan.stop", &json!(null)).is_err(), "there is nothing to stop any more");
}

#[test]
fn an_edit_is_planned_after_a_stop() {
    let mut app = at_work();
    app.dispatch("plan.stop", &json!(null));
    app.world.is_deaf.set(false);
    app.session.set_source("scenario S[0,10] = { delay[6,6] }");
    app.settle();
    assert_eq!(app.json()["status"], "plan");
}

#[test]
fn a_text_over_which_the_core_died_is_undecided() {
    let mut app = at_work();
    let revision = app.json()["revision"].as_u64();
    let died = HostEvent::CoreFailed { revision, message: "out of memory".into() };
    app.world.news.borrow_mut().push_back(died);
    app.settle();
    let state = app.json();
    assert_eq!(state["status"], "undecided");
    assert!(state["toasts"].to_string().contains("out of memory"));
}

#[test]
fn work_that_takes_long_can_be_stopped_on_screen() {
    let mut app = at_work();
    assert!(!app.session.state().is_long_at_work());
    app.world.now_secs.set(app.world.now_secs.get() + 1.0);
    app.step();
    assert!(app.session.state().is_long_at_work());
    assert_eq!(app.session.state().secs_at_work(), 1, "how long it has taken is told");
    app.world.now_secs.set(app.world.now_secs.get() + 6.0);
    app.step();
    assert_eq!(app.session.state().secs_at_work(), 7);
}
