//! Two revisions of the Enroute mission, and plans read from JSON; the figures are those of SPEC 3.6.

use link::{Request, Response, Update};
use mission::Core;
use serde_json::json;
use test_core::{Answers, snapshot};

use super::{Change, Comparison, Side, Subject, compare};

const SCENARIO: &str = include_str!("../../../../tests/conformance/t01_enroute_scenario.rmpl");
const BOTH: &str = include_str!("../../../../tests/conformance/t03_enroute_both_paths.rmpl");
const MISSION: &str = include_str!("../../../../assets/missions/enroute.rmpl");

fn side(source: &str) -> Side {
    Side::of_snapshot("side", &snapshot(source))
}

fn found<'a>(comparison: &'a Comparison, name: &str) -> Vec<(Change, Subject, &'a str, &'a str)> {
    let named = comparison.differences.iter().filter(|it| it.name == name);
    named
        .map(|it| {
            let text = |text: &'a Option<String>| text.as_deref().unwrap_or("");
            (it.change, it.subject, text(&it.before), text(&it.after))
        })
        .collect()
}

#[test]
fn a_plan_does_not_differ_from_itself() {
    let comparison = compare(&side(MISSION), &side(MISSION));
    assert!(comparison.is_same(), "{:?}", comparison.differences);
    assert_eq!(comparison.summary(), "no differences");
    assert!(comparison.rows.iter().any(|row| row.name == "Group-Wait#1"));
}

#[test]
fn a_longer_window_moves_what_follows_by_name() {
    // The path is open for 450 minutes from minute 10; ten more let the drive end ten minutes later.
    let longer = SCENARIO.replace("PATH1=OK [450,450]", "PATH1=OK [460,460]");
    let comparison = compare(&side(SCENARIO), &side(&longer));
    assert_eq!(
        found(&comparison, "Tell(PATH1=OK)#1"),
        [(
            Change::Moved,
            Subject::Condition,
            "starts [10, 10], ends [460, 460]",
            "starts [10, 10], ends [470, 470]"
        )]
    );
    let moved = found(&comparison, "Group-Traverse-Path#1");
    assert!(moved.iter().all(|it| it.0 == Change::Moved) && moved.len() == 1, "{moved:?}");
    assert!(moved[0].2.contains("[415, 460]"), "{moved:?}");
    assert!(moved[0].3.contains("[415, 470]"), "{moved:?}");
}

#[test]
fn a_withdrawn_condition_re_chooses_the_path_and_its_carrier() {
    let first = side(BOTH);
    let taken = first.choices["D1"].alternative;
    assert_eq!(taken, 0);
    // Without the first path's condition only the second is left.
    let without = BOTH.replace("PATH1=OK [450,450]", "PATH1=OK [4,4]");
    assert_ne!(without, BOTH);
    let second = side(&without);
    let comparison = compare(&first, &second);
    let choice = found(&comparison, "D1");
    assert_eq!(choice.len(), 1, "{:?}", comparison.differences);
    assert_eq!((choice[0].0, choice[0].1), (Change::Rechosen, Subject::Choice));
    assert!(
        choice[0].2.starts_with("alternative 0") && choice[0].3.starts_with("alternative 1"),
        "{choice:?}"
    );
    // The requirement on path 1 is gone, one on path 2 has come.
    let links: Vec<(&str, Change)> = comparison
        .differences
        .iter()
        .filter(|it| it.subject == Subject::Link)
        .map(|it| (it.name.as_str(), it.change))
        .collect();
    assert!(
        links.iter().any(|(name, change)| name.contains("PATH1") && *change == Change::Removed),
        "{links:?}"
    );
    assert!(
        links.iter().any(|(name, change)| name.contains("PATH2") && *change == Change::Added),
        "{links:?}"
    );
}

#[test]
fn a_plan_saved_as_json_is_the_same_plan() {
    let snapshot = snapshot(MISSION);
    let network = snapshot.network.as_deref().expect("it compiles");
    let plan = snapshot.plan().expect("there is a plan");
    let saved = tpn::plan_json::plan_to_json(network, plan);
    let document = json!({ "format": "enroute-plan/1", "plans": [saved.clone()] });
    for saved in [saved, document] {
        let saved = Side::of_json("saved", &saved).expect("a plan");
        let comparison = compare(&saved, &side(MISSION));
        assert!(comparison.is_same(), "{:?}", comparison.differences);
    }
}

#[test]
fn documents_that_are_no_plans_are_refused() {
    for document in [json!(1), json!({}), json!({ "plans": 1 }), json!({ "choices": { "D1": "a" } })] {
        assert!(Side::of_json("x", &document).is_err(), "{document}");
    }
    let none = Side::of_json("x", &json!({ "plans": [] })).expect("a document without a plan");
    assert!(!none.is_planned);
}

#[test]
fn a_wider_crater_changes_the_path_around_it() {
    let wider = MISSION.replace("West-Crater circle (60, 172, 16)", "West-Crater circle (60, 172, 22)");
    assert_ne!(wider, MISSION);
    let comparison = compare(&side(MISSION), &side(&wider));
    let paths: Vec<(Change, Subject)> =
        found(&comparison, "Group-Traverse-Path#1").into_iter().map(|it| (it.0, it.1)).collect();
    assert!(paths.contains(&(Change::Changed, Subject::Path)), "{:?}", comparison.differences);
    assert!(comparison.differences.iter().all(|it| it.subject != Subject::Choice));
    let pair = comparison.paths.iter().find(|it| it.name == "Group-Traverse-Path#1").expect("a path");
    assert!(pair.before.is_some() && pair.after.is_some());
}

#[test]
fn a_reversed_order_is_re_chosen() {
    let plan = |first: &str, then: &str| {
        let document = json!({
            "choices": {}, "windows": {}, "conflict_order": [[first, then]],
        });
        Side::of_json("x", &document).expect("a plan")
    };
    let comparison = compare(&plan("a", "b"), &plan("b", "a"));
    assert_eq!(found(&comparison, "a and b"), [(Change::Rechosen, Subject::Ordering, "a first", "b first")]);
    assert_eq!(comparison.summary(), "1 re-chosen");
    assert_eq!(comparison.differences[0].sentence(), "ordering a and b re-chosen: a first → b first");
}

#[test]
fn a_text_worked_out_for_comparing_leaves_the_open_plan_alone() {
    let mut core = Core::default();
    let mut answers = Answers::default();
    core.handle(Request::Update(Update::new(1, MISSION)), &mut answers);
    let maps = |answers: &Answers| answers.0.iter().filter(|it| matches!(it, Response::Map { .. })).count();
    assert_eq!(maps(&answers), 1);
    core.handle(Request::Evaluate { token: 7, update: Update::new(1, BOTH) }, &mut answers);
    let Some(Response::Evaluated { token: 7, snapshot }) = answers.0.last() else {
        panic!("{:?}", answers.0.last());
    };
    assert_eq!(&*snapshot.source, BOTH);
    core.handle(Request::Update(Update::new(1, MISSION)), &mut answers);
    assert_eq!(maps(&answers), 1, "the map is not sent again");
}

#[test]
fn plans_differ_in_how_far_they_use_resources_and_in_what_they_are_worth() {
    let mission = |consumed: u32, cost: u32| {
        format!(
            "resource Battery 0..100 = 60;
             primitive Drive()[4,8] consumes Battery {consumed} costs {cost};
             scenario S[0,100] = {{ Drive() }}"
        )
    };
    let comparison = compare(&side(&mission(20, 3)), &side(&mission(50, 3)));
    assert_eq!(
        found(&comparison, "Battery"),
        [(Change::Changed, Subject::Figure, "between 40 and 60", "between 10 and 60")]
    );
    assert_eq!(comparison.differences.len(), 1, "{:?}", comparison.differences);
    let comparison = compare(&side(&mission(20, 3)), &side(&mission(20, 4)));
    assert_eq!(found(&comparison, "cost"), [(Change::Changed, Subject::Figure, "3", "4")]);
    let saved = json!({
        "choices": {}, "activities": [], "causal_links": [], "conflict_order": [], "windows": {},
        "uses_ordered": [["Uses(Drill)@A#1", "Uses(Drill)@B#1"]],
        "resources": { "Drill": { "capacity": 1, "peak": 1 }, "unordered#1": { "capacity": 1, "peak": 1 } },
        "reward": "7/2",
    });
    let saved = Side::of_json("saved", &saved).expect("it is a plan");
    let figures: Vec<(&str, &str)> =
        saved.figures.iter().map(|(name, text)| (name.as_str(), text.as_str())).collect();
    assert_eq!(figures, [("Drill", "at most 1 of 1"), ("reward", "3.5")]);
    assert_eq!(saved.orderings.len(), 1);
}
