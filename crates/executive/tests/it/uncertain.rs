//! Plans whose durations the environment chooses (SPEC 13.2): controllable ones never fail for a duration inside its
//! range, and those that are not fail against the adversary.

use std::collections::BTreeMap;
use std::sync::Arc;

use controllability::{plan_network, scale};
use exact::{Bound, Time};
use executive::world::natures_ranges;
use executive::{
    AsPlanned, Disturbance, Ending, Facts, Happening, Replanner, RunOutcome, Stage, World, run_stage,
};
use rmpl::program::Controllability;
use smol_str::SmolStr;
use tpn::generate::{Recipe, Rng, Tightness};
use tpn::{Network, OccurrenceKind, Plan, Top};

/// No one plans again.
struct Nobody;

impl Replanner for Nobody {
    fn replan(&mut self, _: &Facts) -> Result<(Arc<Network>, Plan), String> {
        Err("nobody plans again".to_owned())
    }
}

/// Plans again, with the facts.
struct Kirk(Arc<Network>);

impl Replanner for Kirk {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        let network = Arc::new(facts.apply(&self.0, self.0.nodes.len()));
        let plan = first_plan(&network).ok_or("no plan")?;
        Ok((network, plan))
    }
}

fn compiled(source: &str) -> Network {
    let (network, diagnostics) = tpn::compile(&rmpl::parse(source).program(), &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{diagnostics:?}"))
}

fn first_plan(network: &Network) -> Option<Plan> {
    let options = kirk::Options { relax: false, explain: false, ..kirk::Options::default() };
    kirk::plan(network, &options, &mut kirk::Unlimited).plans.into_iter().next()
}

/// Leaves some durations to the environment, as chance likes.
fn leave_to_nature(network: &mut Network, rng: &mut Rng) {
    for occurrence in network.occurrences.clone() {
        let is_duration = matches!(
            occurrence.kind,
            OccurrenceKind::Primitive | OccurrenceKind::Delay | OccurrenceKind::Assertion
        );
        if let Some(arc) = occurrence.arc.filter(|_| is_duration && rng.chance(25)) {
            let arc = &mut network.arcs[arc.index()];
            arc.is_contingent = arc.upper != Bound::Infinite;
        }
    }
}

/// Returns whether the plan takes a duration that the environment really chooses.
fn is_uncertain(network: &Network, plan: &Plan) -> bool {
    network
        .arcs
        .iter()
        .zip(&plan.selected_arcs)
        .any(|(arc, is_selected)| *is_selected && arc.is_contingent && Bound::Finite(arc.lower) != arc.upper)
}

const HALF: i64 = 2;

fn half() -> Time {
    Time::ONE.checked_div(HALF).expect("a half")
}

/// Returns what the environment chooses: anything by halves, or an end of each range.
fn choose(network: &Network, rng: &mut Rng, only_ends: bool) -> BTreeMap<SmolStr, Time> {
    let mut chosen = BTreeMap::new();
    for (occurrence, [lower, upper]) in natures_ranges(network) {
        let steps = upper.checked_sub(lower).and_then(|width| width.integer_parts(2)).expect("a small range");
        let step = match only_ends {
            true if rng.chance(50) => 0,
            true => steps,
            false => rng.between(0, steps),
        };
        let more = Time::from(step).checked_div(HALF).expect("a small time");
        chosen.insert(occurrence.name.clone(), lower.checked_add(more).expect("a small time"));
    }
    chosen
}

fn run(stage: &Stage, network: &Network, world: &World, replanner: &mut dyn Replanner) -> RunOutcome {
    run_stage(stage.clone(), network.nodes.len(), world, &mut AsPlanned, replanner).expect("small times")
}

fn violations(outcome: &RunOutcome) -> Vec<&str> {
    let reasons = outcome.log.iter().filter_map(|entry| match &entry.happening {
        Happening::Violation { reason, .. } => Some(reason.as_str()),
        _ => None,
    });
    reasons.collect()
}

#[test]
fn controllable_plans_never_fail_in_ten_thousand_runs() {
    let (mut runs, mut plans, mut seed) = (0, 0, 0);
    while runs < 10_000 {
        seed += 1;
        let source = tpn::generate::mission(Recipe { nodes: 36, tightness: Tightness::Feasible, seed });
        let mut network = compiled(&source);
        let mut rng = Rng::new(seed);
        leave_to_nature(&mut network, &mut rng);
        let Some(plan) = first_plan(&network).filter(|plan| is_uncertain(&network, plan)) else { continue };
        plans += 1;
        let network = Arc::new(network);
        let stage = Stage::new(Arc::clone(&network), plan.clone(), &[half()]).expect("small times");
        for number in 0..50 {
            let chosen = choose(&network, &mut rng, number % 5 == 0);
            let world = World::default().with_chosen(chosen.clone()).with_adversary();
            let outcome = run(&stage, &network, &world, &mut Nobody);
            assert_eq!(outcome.ending, Ending::Finished, "seed {seed}: {chosen:?} {:?}", outcome.log.last());
            assert_eq!(violations(&outcome), Vec::<&str>::new(), "seed {seed}: {chosen:?}");
            let times = &outcome.last().times;
            let verdict = verify::check_schedule(&network, &plan, times);
            assert!(verdict.valid, "seed {seed}: {chosen:?} {:?}", verdict.violations);
            for (occurrence, _) in natures_ranges(&network) {
                let (start, end) = (times[occurrence.start.index()], times[occurrence.end.index()]);
                let lasted = start.zip(end).and_then(|(start, end)| end.checked_sub(start));
                if let Some(lasted) = lasted.filter(|_| is_of(&network, &plan, occurrence)) {
                    assert_eq!(lasted, chosen[&occurrence.name], "seed {seed}: {}", occurrence.name);
                }
            }
            runs += 1;
        }
    }
    assert!(plans > 100, "{plans} plans");
}

/// Returns whether the plan selects the duration of an occurrence.
fn is_of(_: &Network, plan: &Plan, occurrence: &tpn::Occurrence) -> bool {
    occurrence.arc.is_some_and(|arc| plan.selected_arcs[arc.index()])
}

#[test]
fn plans_that_are_not_controllable_fail_against_the_adversary_and_only_they_do() {
    let (mut lost, mut kept) = (0, 0);
    for seed in 0..300 {
        let source = tpn::generate::mission(Recipe { nodes: 30, tightness: Tightness::Feasible, seed });
        let mut network = compiled(&source);
        // Planned as if the environment chose nothing.
        let Some(plan) = first_plan(&network) else { continue };
        leave_to_nature(&mut network, &mut Rng::new(seed));
        if !is_uncertain(&network, &plan) {
            continue;
        }
        let precedences = plan.precedences(&network);
        let read = plan_network(&network, &plan.selected_arcs, &precedences, scale(&network).expect("small"));
        let refuted = read.expect("small").refute(Controllability::Dynamic, &mut || false).expect("small");
        let network = Arc::new(network);
        let stage = Stage::new(Arc::clone(&network), plan, &[]).expect("small times");
        let outcome = run(&stage, &network, &World::default().with_adversary(), &mut Nobody);
        if refuted.is_some() {
            lost += 1;
            assert_eq!(outcome.ending, Ending::Stopped, "seed {seed}: {refuted:?}");
            assert_eq!(violations(&outcome).len(), 1, "seed {seed}: {:?}", outcome.log);
        } else {
            kept += 1;
            assert_eq!(outcome.ending, Ending::Finished, "seed {seed}: {:?}", violations(&outcome));
        }
    }
    assert!(lost > 50 && kept > 50, "{lost} lost, {kept} kept");
}

#[test]
fn a_mission_that_asks_for_nothing_is_executed_as_planned_but_against_the_adversary() {
    let source = "option controllability = none; primitive Drive()contingent[20,40]; \
                  scenario S = { { Drive(); delay[0,0] }[30,35] }";
    let network = Arc::new(compiled(source));
    let plan = first_plan(&network).expect("read as ordinary");
    let stage = Stage::new(Arc::clone(&network), plan, &[]).expect("small times");
    let chosen = BTreeMap::from([(SmolStr::from("Drive#1"), Time::from(20))]);
    let world = World::default().with_chosen(chosen);
    assert_eq!(run(&stage, &network, &world, &mut Nobody).ending, Ending::Finished);
    let outcome = run(&stage, &network, &world.with_adversary(), &mut Nobody);
    assert_eq!(outcome.ending, Ending::Stopped);
}

#[test]
fn planning_again_keeps_what_nature_has_ended_and_what_is_under_way() {
    let (mut replanned, mut finished) = (0, 0);
    for seed in 0..200 {
        let source = tpn::generate::mission(Recipe { nodes: 36, tightness: Tightness::Feasible, seed });
        let mut network = compiled(&source);
        let mut rng = Rng::new(seed);
        leave_to_nature(&mut network, &mut rng);
        let Some(plan) = first_plan(&network).filter(|plan| is_uncertain(&network, plan)) else { continue };
        let network = Arc::new(network);
        // One activity takes what it likes, in or outside its bounds.
        let primitives: Vec<&SmolStr> = (network.occurrences.iter())
            .filter(|occurrence| occurrence.kind == OccurrenceKind::Primitive)
            .map(|occurrence| &occurrence.name)
            .collect();
        if primitives.is_empty() {
            continue;
        }
        let name = primitives[rng.below(primitives.len() as u64) as usize].clone();
        let duration = Time::from(rng.between(0, 60));
        let world = World::new(&[Disturbance::Duration { activity: name, duration }])
            .with_chosen(choose(&network, &mut rng, false));
        let stage = Stage::new(Arc::clone(&network), plan, &[half()]).expect("small times");
        let outcome = run(&stage, &network, &world, &mut Kirk(Arc::clone(&network)));
        if outcome.plans.len() > 1 {
            replanned += 1;
            if outcome.ending == Ending::Finished {
                finished += 1;
                let last = outcome.last();
                let verdict = verify::check_schedule(&last.network, &last.plan, &last.times);
                assert!(verdict.valid, "seed {seed}: {:?}", verdict.violations);
            }
        }
        // What was decided stays.
        for pair in outcome.plans.windows(2) {
            for (node, time) in pair[0].times.iter().enumerate().filter(|(_, time)| time.is_some()) {
                assert_eq!(pair[1].times[node], *time, "seed {seed}");
            }
        }
        assert_eq!(
            violations(&outcome).len(),
            outcome.plans.len() - usize::from(outcome.ending == Ending::Finished),
            "seed {seed}: {:?}",
            violations(&outcome)
        );
    }
    assert!(replanned > 15 && finished > 5, "{replanned} planned again, {finished} finished");
}

fn named(network: &Network, name: &str) -> tpn::NodeId {
    let is_named = |node: &tpn::Node| node.events.iter().any(|&event| network.event_name(event) == name);
    tpn::NodeId::from_index(network.nodes.iter().position(is_named).unwrap_or_else(|| panic!("{name}")))
}

/// Dig begins at the earliest 3 before the drive is over, whenever that is, and no later than at 17.
fn waiting() -> (Network, Plan) {
    let source = "primitive Drive()contingent[5,20]; primitive Dig()[1,1]; \
                  scenario S = { Drive(), { delay[0,inf]; Dig() }[0,18] }";
    let mut network = compiled(source);
    let mut plan = first_plan(&network).expect("nothing keeps them apart");
    let (drive, dig) = (named(&network, "Drive#1.end"), named(&network, "Dig#1.start"));
    // Drive is over no later than 3 after the dig begins.
    let bounds = (Time::from(-30), Bound::Finite(Time::from(3)));
    network.connect(tpn::Arc::bare(dig, drive, bounds, tpn::ArcKind::Span));
    plan.selected_arcs.push(true);
    (network, plan)
}

#[test]
fn what_waits_for_nature_is_told_with_its_time() {
    let (network, plan) = waiting();
    let drive = ["Drive#1.start", "Drive#1.end"].map(|name| named(&network, name));
    let dig = named(&network, "Dig#1.start");
    let at = |times: &[(tpn::NodeId, i64)], now: i64| {
        let executed = times.iter().map(|&(node, time)| (node, Time::from(time))).collect();
        let observed = executive::Observations { executed, now: Time::from(now) };
        executive::progress(&network, &plan, &observed).expect("small times")
    };
    let window = |earliest: i64, latest: i64| {
        Some(tpn::Window { earliest: Time::from(earliest), latest: Bound::Finite(Time::from(latest)) })
    };
    // Nothing but the start: the drive takes until 20 at most, and Dig has to wait until 3 before that.
    let executive::Progress::Consistent(windows, waits) = at(&[(drive[0], 0)], 2) else {
        panic!("consistent")
    };
    assert_eq!(windows[drive[1].index()], window(5, 20));
    assert_eq!(windows[dig.index()], window(5, 17));
    let [wait] = waits.as_slice() else { panic!("{waits:?}") };
    assert_eq!((wait.event, wait.until), (dig, Time::from(17)));
    assert_eq!(network.arcs[wait.natures.index()].to, drive[1]);
    // It is over at 8: nothing waits any longer.
    let executive::Progress::Consistent(windows, waits) = at(&[(drive[0], 0), (drive[1], 8)], 9) else {
        panic!("consistent")
    };
    assert_eq!(waits, []);
    assert_eq!(windows[dig.index()], window(9, 17));
    // Outside its range, and too early a dig, which the environment may still break.
    assert!(matches!(at(&[(drive[0], 0), (drive[1], 21)], 21), executive::Progress::Violated(_)));
    let executive::Progress::Violated(reasons) = at(&[(drive[0], 0), (dig, 10)], 10) else {
        panic!("violated")
    };
    assert!(reasons.iter().any(|reason| reason.contains("(uncontrolled)")), "{reasons:?}");
}
