//! What the core keeps between jobs, and what travels of its answers: as much as is new, and no less.

use std::sync::Arc;

use exact::Time;
use executive::{Disturbance, Script};
use link::control_run::{Input, Moment};
use link::wire::{AskerEnd, CoreEnd};
use link::{
    ControlProgram, ControlRun, ControlStanding, GrowthStanding, PathGrowth, Request, Response, Update,
    WantedPlanner,
};
use mission::{Core, CoreHost};
use review::{Review, plan_hash};
use snapshot::{ContentKey, Execution, Snapshot, Stage};

/// Collects answers; gives up after so many looks.
#[derive(Default)]
struct Collected {
    snapshots: Vec<Arc<Snapshot>>,
    standings: Vec<ControlStanding>,
    growths: Vec<GrowthStanding>,
    executions: Vec<Arc<Execution>>,
    /// Reviews, each with how many snapshots had been answered before it.
    reviews: Vec<(Arc<Review>, usize)>,
    /// Looks until the job is superseded.
    patience: Option<u32>,
    /// Milliseconds between two looks.
    pace: f64,
    now_millis: f64,
}

impl CoreHost for Collected {
    fn now_millis(&self) -> f64 {
        self.now_millis
    }

    fn is_superseded(&mut self) -> bool {
        self.now_millis += self.pace;
        match &mut self.patience {
            None => false,
            Some(0) => true,
            Some(left) => {
                *left -= 1;
                false
            }
        }
    }

    fn answer(&mut self, response: Response) {
        match response {
            Response::Snapshot(snapshot) => self.snapshots.push(snapshot),
            Response::ControlRun(standing) => self.standings.push(*standing),
            Response::PathGrowth(standing) => self.growths.push(*standing),
            Response::Execution(run) => self.executions.push(run),
            Response::Review { review, .. } => self.reviews.push((review, self.snapshots.len())),
            _ => {}
        }
    }
}

const LAMP: &str = "Main ():: (PARALLEL (WHENEVER-DONEXT (Lamp = Off) (Lamp = On)) (WHENEVER-DONEXT (Lamp = On) (Lamp = Off)))
    (DEFCLASS Lamp () (VAR light {dark bright} OBSERVABLE) (COMMAND cmd {none on off})
      (MODE Off (light = dark)) (MODE On (light = bright)) (MODE Burnt (light = dark))
      (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off)) (FAULT On Burnt 1/4))
    (DEFINSTANCE Lamp Lamp INIT Off)";

fn wanted(source: &str, inputs: Vec<Input>) -> ControlRun {
    ControlRun {
        token: 1,
        revision: 1,
        source: source.into(),
        plant: None,
        seed: None,
        inputs,
        held_program: ContentKey::default(),
        held_run: ContentKey::default(),
        held: 0,
    }
}

/// The same, by someone who holds what was answered.
fn holding(mut wanted: ControlRun, standing: &ControlStanding, held: u32) -> ControlRun {
    wanted.held_program = standing.program;
    wanted.held_run = standing.run;
    wanted.held = held;
    wanted
}

fn run(core: &mut Core, wanted: ControlRun) -> ControlStanding {
    let mut collected = Collected::default();
    core.handle(Request::RunControl(wanted), &mut collected);
    assert_eq!(collected.standings.len(), 1);
    collected.standings.remove(0)
}

/// The moments as a core finds them that knows nothing.
fn fresh(source: &str, inputs: Vec<Input>) -> Vec<Moment> {
    run(&mut Core::default(), wanted(source, inputs)).moments
}

fn burnt(source: &str) -> Input {
    let standing = run(&mut Core::default(), wanted(source, Vec::new()));
    let content = standing.content.expect("it is new");
    let model = content.model().expect("there is a plant");
    let (lamp, mode) = model.component_mode("Lamp", "Burnt").expect("it can burn out");
    let mut input = Input::default();
    input.plant.injected.insert(lamp, mode);
    input
}

#[test]
fn a_run_steps_on_and_only_new_moments_travel() {
    let mut core = Core::default();
    let first = run(&mut core, wanted(LAMP, vec![Input::default(); 3]));
    assert!(matches!(first.content, Some(ControlProgram::Bound { .. })));
    assert_eq!((first.first, first.moments.len(), first.is_complete), (0, 4, true));
    let next = run(&mut core, holding(wanted(LAMP, vec![Input::default(); 5]), &first, 4));
    assert_eq!((next.run, next.program), (first.run, first.program));
    assert!(next.content.is_none());
    assert_eq!((next.first, next.moments.len()), (4, 2));
    let all: Vec<Moment> = first.moments.into_iter().chain(next.moments).collect();
    assert_eq!(all, fresh(LAMP, vec![Input::default(); 5]));
}

#[test]
fn a_changed_input_goes_back_to_where_it_comes_in() {
    let mut core = Core::default();
    let first = run(&mut core, wanted(LAMP, vec![Input::default(); 6]));
    let mut inputs = vec![Input::default(); 6];
    inputs[2] = burnt(LAMP);
    let changed = run(&mut core, holding(wanted(LAMP, inputs.clone()), &first, 3));
    assert_eq!((changed.run, changed.first), (first.run, 3));
    let all: Vec<Moment> = first.moments.into_iter().take(3).chain(changed.moments).collect();
    let expected = fresh(LAMP, inputs);
    assert_eq!(all, expected);
    assert_ne!(all, fresh(LAMP, vec![Input::default(); 6]));
}

#[test]
fn a_comment_keeps_the_run_and_another_program_takes_the_steps_again() {
    let mut core = Core::default();
    let first = run(&mut core, wanted(LAMP, vec![Input::default(); 4]));
    let commented = format!("; A note.\n{LAMP}");
    let same = run(&mut core, holding(wanted(&commented, vec![Input::default(); 4]), &first, 5));
    assert_eq!((same.run, same.moments.len()), (first.run, 0));
    assert!(same.content.is_some(), "it is written elsewhere");
    let other = LAMP.replace("(Lamp = On) (Lamp = Off)", "(Lamp = On) (Lamp = On)");
    let changed = run(&mut core, holding(wanted(&other, vec![Input::default(); 4]), &same, 5));
    assert_ne!(changed.run, first.run);
    assert_eq!((changed.first, changed.moments), (0, fresh(&other, vec![Input::default(); 4])));
}

#[test]
fn a_run_that_is_given_up_goes_on_from_where_it_was() {
    let mut core = Core::default();
    let mut hurried = Collected { patience: Some(3), ..Collected::default() };
    core.handle(Request::RunControl(wanted(LAMP, vec![Input::default(); 20])), &mut hurried);
    assert!(hurried.standings.is_empty(), "it was not finished");
    // Those who look at it see it on the way.
    let mut slow = Collected { pace: 30.0, ..Collected::default() };
    core.handle(Request::RunControl(wanted(LAMP, vec![Input::default(); 20])), &mut slow);
    assert!(slow.standings.len() > 2, "{}", slow.standings.len());
    let mut all: Vec<Moment> = Vec::new();
    for standing in slow.standings {
        assert_eq!(standing.first as usize, all.len());
        all.extend(standing.moments);
    }
    assert_eq!(all, fresh(LAMP, vec![Input::default(); 20]));
}

#[test]
fn a_text_with_errors_and_a_program_without_a_plant_are_answered_too() {
    let mut core = Core::default();
    assert_eq!(run(&mut core, wanted("Main ():: (", Vec::new())).content, Some(ControlProgram::Broken));
    let alone = "Main ():: (WHEN-DONEXT (start = on) (shutter = open))";
    let standing = run(&mut core, wanted(alone, vec![Input::default()]));
    assert!(matches!(standing.content, Some(ControlProgram::Unbound(_))));
    assert_eq!(standing.moments.len(), 2);
}

fn update(revision: u64, source: &str) -> Update {
    Update { seed: 1, ..Update::new(revision, source) }
}

fn planned(core: &mut Core, revision: u64, source: &str) -> Arc<Snapshot> {
    let mut collected = Collected::default();
    core.handle(Request::Update(update(revision, source)), &mut collected);
    collected.snapshots.pop().expect("it is answered")
}

const MISSIONS: [&str; 4] = [
    include_str!("../../../../assets/missions/enroute.rmpl"),
    include_str!("../../../../assets/missions/threats.rmpl"),
    include_str!("../../../../assets/missions/backjump.rmpl"),
    // No plan: the places of the explanation must move, too.
    "A()[l,u] = { Work()[5,6] }\nscenario S[0,3] = { A() }\n",
];

/// Returns what the answer says, without how long it took and who counted its keys.
fn content(snapshot: &Snapshot) -> Snapshot {
    let mut content = snapshot.clone();
    (content.timings, content.keys, content.revision) = Default::default();
    content
}

#[test]
fn an_edit_of_a_comment_keeps_the_plan_and_moves_its_places() {
    for source in MISSIONS {
        let mut core = Core::default();
        let before = planned(&mut core, 1, source);
        for (revision, text) in [
            (2, format!("// A note.\n{source}")),
            (3, format!("// Another, longer note.\n{source}")),
            (4, format!("// Another, longer note.\n{source}\n// The end.\n")),
        ] {
            let after = planned(&mut core, revision, &text);
            assert_eq!(after.keys, before.keys);
            assert_eq!(content(&after), content(&planned(&mut Core::default(), 1, &text)));
        }
    }
}

#[test]
fn an_edit_of_the_mission_changes_the_keys_of_what_it_changes() {
    let source = MISSIONS[3];
    let mut core = Core::default();
    let before = planned(&mut core, 1, source);
    let relaxed = planned(&mut core, 2, &source.replace("[5,6]", "[2,6]"));
    assert!(before.plan().is_none() && relaxed.plan().is_some());
    assert_ne!(before.keys.network, relaxed.keys.network);
    assert_ne!(before.keys.planning, relaxed.keys.planning);
    assert_eq!(before.keys.traverses, relaxed.keys.traverses, "there are none in both");
    // A text that was broken for a while has its plan again.
    planned(&mut core, 3, &source.replace("[5,6]", "[2,"));
    let again = planned(&mut core, 4, &source.replace("[5,6]", "[2,6]"));
    assert_eq!(again.keys.planning, relaxed.keys.planning);
}

/// Carries answers over as bytes, and counts them.
#[derive(Default)]
struct Wire {
    core: CoreEnd,
    asker: AskerEnd,
}

impl Wire {
    fn carry(&mut self, snapshot: &Arc<Snapshot>) -> (Arc<Snapshot>, usize) {
        let bytes = self.core.write(Response::Snapshot(Arc::clone(snapshot))).expect("it can be written");
        match self.asker.read(&bytes, Arc::clone(&snapshot.source)).expect("it can be read") {
            Response::Snapshot(read) => (read, bytes.len()),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn only_what_is_new_travels_and_what_is_old_is_shared() {
    for source in MISSIONS {
        let (mut core, mut wire) = (Core::default(), Wire::default());
        let first = planned(&mut core, 1, source);
        let (read, whole) = wire.carry(&first);
        assert_eq!(content(&read), content(&first));
        let at_end = planned(&mut core, 2, &format!("{source}// The end.\n"));
        let (same, few) = wire.carry(&at_end);
        assert_eq!(content(&same), content(&at_end));
        assert!(few < 200, "{few} bytes of {whole}");
        let shared = |one: &Option<Arc<tpn::Network>>, other: &Option<Arc<tpn::Network>>| {
            one.as_ref().zip(other.as_ref()).is_some_and(|(one, other)| Arc::ptr_eq(one, other))
        };
        assert!(shared(&read.network, &same.network) && Arc::ptr_eq(&read.traverses, &same.traverses));
        let at_start = planned(&mut core, 3, &format!("// A note.\n{source}// The end.\n"));
        let (moved, few) = wire.carry(&at_start);
        assert_eq!(content(&moved), content(&at_start), "places moved on the other side, too");
        assert_eq!(moved.keys, same.keys);
        let problems = at_start.problems.len();
        assert!(few < 200 + 600 * problems, "{few} bytes with {problems} problems, of {whole}");
        assert!(Arc::ptr_eq(&moved.traverses, &same.traverses));
        // Another text, and back.
        for other in [MISSIONS[0], "", source] {
            let other = planned(&mut core, 4, other);
            assert_eq!(content(&wire.carry(&other).0), content(&other));
        }
    }
}

#[test]
fn keys_of_a_core_that_was_started_anew_are_others() {
    let first = planned(&mut Core::default(), 1, MISSIONS[1]);
    let mut keys = Vec::new();
    for core in 1..=2 {
        let bytes = CoreEnd::default().write(Response::Snapshot(Arc::clone(&first))).expect("bytes");
        let answer = AskerEnd::of_core(core).read(&bytes, Arc::clone(&first.source));
        let Ok(Response::Snapshot(read)) = answer else { panic!("a snapshot") };
        assert_eq!(content(&read), content(&first));
        keys.push(read.keys.network);
    }
    assert_ne!(keys[0], keys[1]);
}

#[test]
fn the_growth_of_a_tree_goes_on_and_is_the_search_itself() {
    let mut core = Core::default();
    let snapshot = planned(&mut core, 1, MISSIONS[0]);
    let network = snapshot.network.as_ref().expect("it compiles");
    let wanted = PathGrowth {
        update: update(1, MISSIONS[0]),
        traverse: network.occurrences[snapshot.traverses[0].occurrence.index()].name.clone(),
        leg: 0,
        planners: vec![unheld(motion::PlannerKind::Rrt)],
    };
    let mut whole = Collected::default();
    Core::default().handle(Request::GrowPath(wanted.clone()), &mut whole);
    let whole = whole.growths.pop().expect("it is answered");
    assert!(whole.is_complete && whole.refusal.is_none() && whole.steps.len() > 20);
    assert!(whole.steps.last().is_some_and(|step| step.path_m.is_some()), "it ends with a path");
    // Given up after ten samples, then watched.
    let mut hurried = Collected { patience: Some(10), ..Collected::default() };
    core.handle(Request::GrowPath(wanted.clone()), &mut hurried);
    assert!(hurried.growths.is_empty());
    let mut slow = Collected { pace: 70.0, ..Collected::default() };
    core.handle(Request::GrowPath(wanted.clone()), &mut slow);
    let mut steps = Vec::new();
    for growth in &slow.growths {
        assert_eq!((growth.first as usize, growth.search), (steps.len(), slow.growths[0].search));
        steps.extend(growth.steps.clone());
    }
    assert!(slow.growths.len() > 1, "it is told in parts");
    assert_eq!(steps, whole.steps);
    // Who holds all gets nothing new.
    let held =
        WantedPlanner { held_search: slow.growths[0].search, held: steps.len() as u32, ..wanted.planners[0] };
    let held = PathGrowth { planners: vec![held], ..wanted };
    let mut again = Collected::default();
    core.handle(Request::GrowPath(held), &mut again);
    assert!(again.growths[0].is_complete && again.growths[0].steps.is_empty());
}

fn unheld(planner: motion::PlannerKind) -> WantedPlanner {
    WantedPlanner { planner, held_search: ContentKey::default(), held: 0 }
}

#[test]
fn planners_that_race_draw_the_samples_that_they_draw_alone_and_by_turns() {
    let mut core = Core::default();
    let snapshot = planned(&mut core, 1, MISSIONS[0]);
    let network = snapshot.network.as_ref().expect("it compiles");
    let wanted = |planners: &[motion::PlannerKind]| PathGrowth {
        update: update(1, MISSIONS[0]),
        traverse: network.occurrences[snapshot.traverses[0].occurrence.index()].name.clone(),
        leg: 0,
        planners: planners.iter().copied().map(unheld).collect(),
    };
    let mut race = Collected { pace: 20.0, ..Collected::default() };
    core.handle(Request::GrowPath(wanted(&motion::PlannerKind::ALL)), &mut race);
    for planner in motion::PlannerKind::ALL {
        let mut alone = Collected::default();
        Core::default().handle(Request::GrowPath(wanted(&[planner])), &mut alone);
        let alone = alone.growths.pop().expect("it is answered");
        let mut steps = Vec::new();
        for growth in race.growths.iter().filter(|it| it.planner == planner) {
            assert_eq!(growth.first as usize, steps.len());
            steps.extend(growth.steps.clone());
        }
        assert_eq!(steps, alone.steps, "{planner:?}");
        let last = race.growths.iter().rfind(|it| it.planner == planner).expect("it is answered");
        assert!(last.is_complete && last.elapsed_millis > 0.0, "{planner:?}");
    }
    // No one waits until someone else is done: RRT* is the longest, and is under way before the others end.
    let first = |planner| race.growths.iter().position(|it| it.planner == planner);
    let last = |planner| race.growths.iter().rposition(|it| it.planner == planner);
    assert!(first(motion::PlannerKind::RrtStar) < last(motion::PlannerKind::Kinodynamic));
    // A race that is over is not run again.
    let mut again = Collected::default();
    core.handle(Request::GrowPath(wanted(&motion::PlannerKind::ALL)), &mut again);
    let keys = |collected: &Collected| {
        collected.growths.iter().map(|it| it.search).collect::<std::collections::BTreeSet<_>>()
    };
    assert_eq!(again.growths.len(), 4);
    assert_eq!(keys(&again), keys(&race));
}

const ERRAND: &str = "primitive Walk()[5,20]; primitive Rest()[1,9]; scenario S[0,40] = { Walk(); Rest() }";

/// The run of `source` when the walk takes so long.
fn walked(core: &mut Core, revision: u64, source: &str, duration: i64) -> Arc<Execution> {
    let update = update(revision, source);
    let disturbance = Disturbance::Duration { activity: "Walk#1".into(), duration: Time::from(duration) };
    let script = Script { disturbances: vec![disturbance], ..Script::default() };
    let mut collected = Collected::default();
    core.handle(Request::Execute { update, script }, &mut collected);
    assert_eq!(collected.executions.len(), 1);
    collected.executions.remove(0)
}

#[test]
fn a_run_is_kept_as_long_as_its_plan() {
    let mut core = Core::default();
    let first = walked(&mut core, 1, ERRAND, 7);
    let other = walked(&mut core, 1, ERRAND, 9);
    assert_ne!(other.log, first.log);
    let again = walked(&mut core, 1, ERRAND, 7);
    assert!(Arc::ptr_eq(&again, &first), "it was run again");
    let changed = ERRAND.replace("Rest()[1,9]", "Rest()[2,9]");
    let changed_run = walked(&mut core, 2, &changed, 7);
    assert_eq!(*changed_run, *walked(&mut Core::default(), 2, &changed, 7));
    assert_ne!(changed_run.log, first.log);
}

#[test]
fn a_run_that_is_kept_moves_with_an_edit_of_a_comment() {
    let mut core = Core::default();
    let first = walked(&mut core, 1, ERRAND, 7);
    let commented = format!("// A note.\n{ERRAND}");
    let moved = walked(&mut core, 2, &commented, 7);
    assert_eq!(*moved, *walked(&mut Core::default(), 2, &commented, 7));
    assert_ne!(moved.plans[0].network, first.plans[0].network, "its places are those of the new text");
}

/// A day with room for two fifths of its wishes, whose worth follows their durations: no plan is much better than another.
fn wishes(count: usize) -> String {
    let durations: Vec<usize> = (0..count).map(|at| 20 + (at * at * 37 + at * 11) % 81).collect();
    let mut text = "resource Body;\n".to_owned();
    let mut branches = Vec::new();
    for (at, lasts) in durations.iter().enumerate() {
        text += &format!("primitive Wish{at}()[{lasts},{lasts}] uses Body rewards {};\n", lasts + 10);
        branches.push(format!("{{ delay; optional Wish{at}() }}"));
    }
    let room = durations.iter().sum::<usize>() * 2 / 5;
    format!("{text}objective maximize reward;\nscenario Day[0,{room}] = {{ {} }}\n", branches.join(", "))
}

#[test]
fn better_plans_are_shown_until_none_is_left_and_the_last_is_the_one_planned_at_once() {
    let source = wishes(26);
    let worth = |snapshot: &Snapshot| snapshot.plan().expect("a plan").quality.reward;
    // A look takes so long that the first plans are answered before the best one.
    let mut slow = Collected { pace: 40.0, ..Collected::default() };
    let mut core = Core::default();
    core.handle(Request::Update(update(1, &source)), &mut slow);
    let (last, before) = slow.snapshots.split_last().expect("it is answered");
    let improving: Vec<&Arc<Snapshot>> = before.iter().filter(|it| it.stage == Stage::Improving).collect();
    assert!(!improving.is_empty(), "{:?}", before.iter().map(|it| it.stage).collect::<Vec<_>>());
    for snapshot in &improving {
        let planning = snapshot.planning.as_ref().expect("it is planned");
        assert!(planning.verdict.as_ref().is_some_and(|verdict| verdict.valid));
        assert_eq!(snapshot.plan().and_then(|plan| plan.quality.is_optimal), Some(false));
        let bound = planning.outcome.bound.expect("what no plan is better than");
        assert!(worth(snapshot) <= worth(last) && worth(last) <= bound);
    }
    assert_eq!(
        (last.stage, last.plan().and_then(|plan| plan.quality.is_optimal)),
        (Stage::Complete, Some(true))
    );
    let at_once = planned(&mut Core::default(), 1, &source);
    assert_eq!(content(last).planning, content(&at_once).planning);
    // Given up while it looks for a better one: what was answered stays, and nothing is kept as if it were the last word.
    let given_up = (1..20).find_map(|patience| {
        let mut hasty = Collected { pace: 40.0, patience: Some(patience * 500), ..Collected::default() };
        let mut core = Core::default();
        core.handle(Request::Update(update(1, &source)), &mut hasty);
        (hasty.snapshots.last()?.stage == Stage::Improving).then_some(core)
    });
    let mut core = given_up.expect("some plan is improved for a while");
    assert_eq!(content(&planned(&mut core, 2, &source)), content(&at_once));
}

#[test]
fn the_plan_that_is_reviewed_is_the_one_that_was_answered_last() {
    let source = wishes(26);
    let review = |core: &mut Core| {
        let mut host = Collected::default();
        core.handle(Request::Review { update: update(1, &source), rules: Vec::new() }, &mut host);
        let [(review, before)] = &host.reviews[..] else { panic!("one review") };
        assert_eq!(*before, host.snapshots.len(), "the plan comes before its review");
        (Arc::clone(review), host.snapshots.pop())
    };
    let mut core = Core::default();
    let whole = planned(&mut core, 1, &source);
    let (of_whole, told) = review(&mut core);
    assert_eq!((of_whole.plan_hash.clone(), told), (plan_hash(&whole), None), "it is known already");
    // Stopped while it looks for a better plan: what is drawn then is not what a review works out.
    let stopped = (1..14).find_map(|patience| {
        let mut hasty = Collected { pace: 40.0, patience: Some(patience * 500), ..Collected::default() };
        let mut core = Core::default();
        core.handle(Request::Update(update(1, &source)), &mut hasty);
        let drawn = hasty.snapshots.pop().filter(|it| it.stage == Stage::Improving)?;
        (plan_hash(&drawn) != plan_hash(&whole)).then_some((core, drawn))
    });
    let (mut core, drawn) = stopped.expect("some first plan is not the best");
    let (reviewed, told) = review(&mut core);
    assert_ne!(reviewed.plan_hash, plan_hash(&drawn));
    let told = told.expect("its plan is answered as well");
    assert_eq!((told.stage, plan_hash(&told)), (Stage::Complete, reviewed.plan_hash.clone()));
}

/// A host whose clock goes on by so much at each look.
struct Ticking {
    millis: f64,
    now_millis: std::cell::Cell<f64>,
    codes: Vec<String>,
}

impl CoreHost for Ticking {
    fn now_millis(&self) -> f64 {
        self.now_millis.replace(self.now_millis.get() + self.millis)
    }

    fn is_superseded(&mut self) -> bool {
        false
    }

    fn answer(&mut self, response: Response) {
        if let Response::Snapshot(snapshot) = response {
            self.codes.extend(snapshot.problems.iter().map(|problem| problem.code.to_string()));
        }
    }
}

#[test]
fn parts_of_a_control_program_that_do_nothing_are_warned_of_if_there_is_time() {
    let with_plant = LAMP.replace("Main ():: (PARALLEL", "Main ():: (SEQUENCE");
    let alone = "Main ():: (SEQUENCE (ALWAYS (x = a)) (y = b))";
    for (source, millis, expected) in [
        (with_plant.as_str(), 0.001, vec!["W-UNREACHABLE"]),
        (with_plant.as_str(), 60.0, vec![]),
        (alone, 0.001, vec!["W-UNREACHABLE"]),
        (alone, 60.0, vec![]),
        (LAMP, 0.001, vec![]),
    ] {
        let mut host = Ticking { millis, now_millis: std::cell::Cell::default(), codes: Vec::new() };
        Core::default().handle(Request::Update(update(1, source)), &mut host);
        assert_eq!(host.codes, expected, "{millis} ms a look: {source}");
    }
}
