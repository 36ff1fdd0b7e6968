//! The Enroute mission from text to rovers on their way.

use std::sync::Arc;

use exact::{Bound, Time};
use link::{Request, Response, Update};
use mission::Core;
use snapshot::{Snapshot, Stage};
use test_core::Answers;
use tpn::NodeId;

fn source() -> String {
    include_str!("../../../../assets/missions/enroute.rmpl").to_owned()
}

fn ask(core: &mut Core, answers: &mut Answers, source: &str) -> Arc<Snapshot> {
    let update = Update::new(answers.0.len() as u64, source);
    core.handle(Request::Update(Update { search: kirk::Search::Chronological, seed: 1, ..update }), answers);
    let last = answers.snapshot();
    assert_eq!(last.stage, Stage::Complete);
    last
}

fn answer(source: &str) -> Arc<Snapshot> {
    ask(&mut Core::default(), &mut Answers::default(), source)
}

fn window(snapshot: &Snapshot, event: &str) -> (Time, Bound) {
    let network = snapshot.network.as_ref().expect("it compiles");
    let plan = snapshot.plan().expect("there is a plan");
    let node = (0..network.nodes.len())
        .map(NodeId::from_index)
        .find(|node| network.nodes[node.index()].events.iter().any(|&it| network.event_name(it) == event))
        .expect("the event exists");
    let window = plan.windows[node.index()].expect("the event is selected");
    (window.earliest, window.latest)
}

#[test]
fn the_mission_has_the_windows_of_the_paper_with_its_paths_inserted() {
    let snapshot = answer(&source());
    let errors = snapshot.problems.iter().filter(|problem| problem.severity == rmpl::Severity::Error);
    assert_eq!(errors.count(), 0, "{:?}", snapshot.problems);
    let planning = snapshot.planning.as_ref().expect("it is planned");
    assert!(planning.verdict.as_ref().is_some_and(|verdict| verdict.valid), "{:?}", planning.verdict);
    assert!(planning.undrivable.is_empty(), "{:?}", planning.undrivable);
    let finite = |low: i64, high: i64| (Time::from(low), Bound::Finite(Time::from(high)));
    for (event, expected) in [
        ("Group-Enroute#1.start", finite(10, 55)),
        ("Group-Traverse-Path#1.end", finite(415, 460)),
        ("Group-Wait#1.end", finite(415, 514)),
        ("Group-Transmit#1.end", finite(415, 462)),
        ("Group-Enroute#1.end", finite(460, 595)),
        ("Tell(PROCEED=OK)#1.start", finite(460, 600)),
        ("scenario#1.end", finite(660, 800)),
    ] {
        assert_eq!(window(&snapshot, event), expected, "{event}");
    }
    assert_eq!(snapshot.traverses.len(), 1);
    assert_eq!(snapshot.traverses[0].legs.len(), 4);
}

#[test]
fn both_rovers_drive_from_base_to_the_target_and_the_leader_stays_clear() {
    let snapshot = answer(&source());
    assert_eq!(snapshot.motions.len(), 2, "{:?}", snapshot.planning.as_ref().map(|it| &it.undrivable));
    let (start, _) = snapshot.motions[0].at(0.0).expect("it has keyframes");
    let (end, _) = snapshot.motions[0].at(800.0).expect("it has keyframes");
    assert_eq!((start, end), ([24.0, 52.0].into(), [256.0, 238.0].into()));
    let under_way = snapshot.motions[0].at(200.0).expect("it has keyframes").0;
    assert!(under_way != start && under_way != end);
    assert!(snapshot.traverses[0].clearance_m >= 0.0);
    assert!(snapshot.separation_violations.is_empty());
}

#[test]
fn a_path_open_for_404_minutes_leaves_no_plan_and_450_brings_it_back() {
    let (mut core, mut answers) = (Core::default(), Answers::default());
    let good = source();
    let short = good.replace("PATH1=OK [450,450]", "PATH1=OK [404,404]");
    assert_ne!(good, short);
    assert!(ask(&mut core, &mut answers, &good).plan().is_some());
    let failed = ask(&mut core, &mut answers, &short);
    assert!(failed.plan().is_none());
    let failure = failed.planning.as_ref().and_then(|planning| planning.outcome.failure.clone());
    assert!(!failure.expect("the failure is explained").reasons.is_empty());
    assert!(ask(&mut core, &mut answers, &good).plan().is_some());
    let maps = answers.0.iter().filter(|it| matches!(it, Response::Map { .. }));
    assert_eq!(maps.count(), 1, "the ground is sent once");
}

#[test]
fn the_same_text_and_seed_give_the_same_snapshot_whatever_came_before() {
    let fresh = answer(&source());
    let (mut core, mut answers) = (Core::default(), Answers::default());
    ask(&mut core, &mut answers, &source().replace("North-Ridge", "Other-Ridge"));
    ask(&mut core, &mut answers, &source().replace("circle (72, 92, 13)", "circle (72, 92, 5)"));
    let later = ask(&mut core, &mut answers, &source());
    // Keys are counted by a core.
    let same = Snapshot { revision: fresh.revision, keys: fresh.keys, ..(*later).clone() };
    assert_eq!(*fresh, same);
}

#[test]
fn an_enclosed_first_path_makes_the_search_take_the_second() {
    let both = include_str!("../../../../assets/missions/both-paths.rmpl");
    let free = answer(both);
    assert_eq!(free.plan().map(|plan| plan.choices[0].alternative), Some(0));
    let wall = "obstacle Wall polygon (56, 206, 72, 206, 72, 222, 56, 222);\nvehicle Rover1";
    let blocked = answer(&both.replacen("vehicle Rover1", wall, 1));
    assert_eq!(blocked.plan().map(|plan| plan.choices[0].alternative), Some(1));
    let planning = blocked.planning.as_ref().expect("it is planned");
    assert_eq!(planning.undrivable.len(), 1);
    assert!(planning.undrivable[0].reason.contains("PATH1_2"), "{}", planning.undrivable[0].reason);
}

#[test]
fn a_broken_text_still_gets_a_complete_answer_with_its_problems() {
    let snapshot = answer("scenario S = { A(; }");
    assert!(snapshot.network.is_none());
    assert!(!snapshot.problems.is_empty());
}

#[test]
fn an_answer_with_a_recorded_search_survives_the_way_to_the_page() {
    let mut answers = Answers::default();
    let source = include_str!("../../../../assets/missions/backjump.rmpl");
    let search = kirk::Search::Chronological;
    let update = Update { search, seed: 1, trace: Some(search), ..Update::new(1, source) };
    Core::default().handle(Request::Update(update), &mut answers);
    let last = answers.snapshot();
    assert!(last.planning.as_ref().is_some_and(|planning| planning.outcome.trace.is_some()));
    let bytes = postcard::to_stdvec(&Response::Snapshot(Arc::clone(&last))).expect("it can be written");
    let back: Response = postcard::from_bytes(&bytes).expect("it can be read");
    assert_eq!(back, Response::Snapshot(last));
}

#[test]
fn both_searches_of_a_mission_are_recorded_for_comparison() {
    let mut answers = Answers::default();
    let mut core = Core::default();
    let source = include_str!("../../../../assets/missions/backjump.rmpl");
    let search = kirk::Search::ConflictDirected;
    let update = Update { search, seed: 1, ..Update::new(7, source) };
    core.handle(Request::Update(update.clone()), &mut answers);
    core.handle(Request::CompareSearches(update), &mut answers);
    let Some(Response::Searches(comparison)) = answers.0.pop() else { panic!("it is answered") };
    let [chronological, directed] = &comparison.searches;
    assert_eq!(chronological.search, kirk::Search::Chronological);
    assert_eq!(directed.search, kirk::Search::ConflictDirected);
    // The lesson of this mission: sixteen combinations of the later choices are tried in vain, or one.
    assert!(chronological.stats.backtracks > 8 * directed.stats.backtracks);
    for searched in &comparison.searches {
        assert!(matches!(
            searched.trace.events.last().map(|it| &it.event),
            Some(kirk::Event::Solution { .. })
        ));
    }
}
