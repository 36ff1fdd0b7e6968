//! Durations that the environment chooses: the planner against all plans of the same mission without the environment,
//! of which only those with a controllable network are left; and the cases with known answers.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use acceptance::lasting_missions::{Kind, lasting_mission};
use acceptance::mission::{compile, network, try_plans};
use acceptance::random::{crowded_mission, small_mission};
use acceptance::{lasting, reference};
use exact::{Bound, Time};
use kirk::{Options, Search, Unlimited};
use rmpl::program::Controllability;
use stnu::{Link, PointId, StrongVerdict, Verdict};
use tpn::selection::closure;
use tpn::{ArcKind, Choice, DecisionId, LabelId, Network, NodeId, Plan, Top};

use crate::lasting::sides;

/// Missions of each kind that the reference finishes.
const MISSIONS: u64 = 2_000;

/// Choices, links, and what else tells plans apart: the order of conflicts, or of producers.
type Key = (Vec<(u32, u32)>, Vec<(u32, u32)>, Vec<(u32, u32)>);

/// All plans of a network with the environment's durations, which the reference says of the one without.
type Reference = fn(&Network) -> Option<Vec<Key>>;

#[test]
fn conditions_are_planned_exactly() {
    compare_plans("conditions", small_mission, conflicts, all_conflicts);
}

#[test]
fn crowded_missions_are_planned_exactly() {
    compare_plans("crowded", crowded_mission, conflicts, all_conflicts);
}

#[test]
fn states_are_planned_exactly() {
    compare_plans("states", |seed| lasting_mission(seed, Kind::STATES), sides, all_sides);
}

/// Compares [`MISSIONS`] missions plan by plan.
fn compare_plans(
    what: &str,
    mission: fn(u64) -> String,
    order: fn(&Network, &Plan) -> Vec<(u32, u32)>,
    reference: Reference,
) {
    compare_all(what, MISSIONS, MISSIONS / 12, &|seed| compare(&mission(seed), seed, order, reference));
}

/// Compares so many missions; all must agree, and more than `least_decisive` must be decided by the environment. `compare`
/// says how many plans one has with nature and without, if its reference finishes.
#[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
pub fn compare_all(
    what: &str,
    missions: u64,
    least_decisive: u64,
    compare: &(dyn Fn(u64) -> Result<Option<(usize, usize)>, String> + Sync),
) {
    let (feasible, decisive) = (AtomicU64::new(0), AtomicU64::new(0));
    let disagreements = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 0..2_u64 {
            let (feasible, decisive, disagreements) = (&feasible, &decisive, &disagreements);
            scope.spawn(move || {
                let (mut seed, mut compared) = (worker, 0);
                while compared < missions / 2 {
                    match compare(seed) {
                        Ok(Some((plans, ordinary))) => {
                            feasible.fetch_add(u64::from(plans > 0), Ordering::Relaxed);
                            decisive.fetch_add(u64::from(plans < ordinary), Ordering::Relaxed);
                            compared += 1;
                        }
                        Ok(None) => {}
                        Err(problem) => {
                            compared += 1;
                            let mut disagreements = disagreements.lock().expect("no thread panics");
                            disagreements.push(format!("seed {seed}, {problem}"));
                        }
                    }
                    seed += 2;
                }
            });
        }
    });
    let (feasible, decisive) = (feasible.into_inner(), decisive.into_inner());
    println!(
        "{what}: {missions} missions compared: {feasible} with plans, nature excludes plans of {decisive}"
    );
    let disagreements = disagreements.into_inner().expect("no thread panics");
    let shown = &disagreements[..disagreements.len().min(3)];
    assert!(disagreements.is_empty(), "{} missions differ, such as {shown:#?}", disagreements.len());
    assert!(feasible > missions / 8 && decisive > least_decisive, "the missions are not mixed");
}

/// Returns how many plans the mission has with nature and without, if the reference finishes and planning agrees with
/// it.
fn compare(
    text: &str,
    seed: u64,
    order: fn(&Network, &Plan) -> Vec<(u32, u32)>,
    reference: Reference,
) -> Result<Option<(usize, usize)>, String> {
    let (network, diagnostics) = compile(text, &Top::Scenario(None));
    let mut network = network.ok_or_else(|| format!("does not compile: {diagnostics:?}\n{text}"))?;
    // Which of two touching intervals comes first would depend on more than the reference tells.
    network.threat_gap = Time::ZERO;
    let natures = leave_to_nature(&mut network, seed);
    if natures == 0 {
        return Ok(None);
    }
    if seed.is_multiple_of(5) {
        network.controllability = Controllability::Strong;
    }
    let Some(ordinary) = reference(&network) else { return Ok(None) };
    let expected: BTreeSet<&Key> = ordinary.iter().filter(|key| is_controllable(&network, key)).collect();
    let problem = |problem: String| format!("{natures} of nature's, {problem}\n{text}");
    let plans = |all| try_plans(&network, Search::ConflictDirected, all).map_err(problem);
    let outcome = plans(true)?;
    let found: BTreeSet<Key> = outcome.plans.iter().map(|plan| key(&network, plan, order)).collect();
    let missing = expected.iter().filter(|key| !found.contains(**key)).count();
    let wrong = found.iter().filter(|key| !expected.contains(key)).count();
    // Intervals at one instant are in both orders, of which the reference tells one.
    let has_instants = network.labels.iter().any(|label| network.arcs[label.arc.index()].lower == Time::ZERO);
    let differs = if has_instants {
        expected.is_empty() != found.is_empty() || !found.iter().all(|key| is_controllable(&network, key))
    } else {
        missing > 0 || wrong > 0
    };
    if differs {
        return Err(problem(format!("{missing} plans are missing, {wrong} are wrong")));
    }
    let first = plans(false)?;
    let is_right = match first.plans.first() {
        Some(plan) => is_controllable(&network, &key(&network, plan, order)),
        None => expected.is_empty(),
    };
    if !is_right {
        return Err(problem("the first plan is not one of all".to_owned()));
    }
    Ok(Some((expected.len(), ordinary.len())))
}

/// Leaves half of the durations that can differ to the environment. How many they are.
pub fn leave_to_nature(network: &mut Network, seed: u64) -> usize {
    let mut natures = 0;
    for (id, arc) in (0_u64..).zip(&mut network.arcs) {
        let is_duration = matches!(arc.kind, ArcKind::Activity | ArcKind::Assertion | ArcKind::Delay);
        let differs = arc.upper.finite().is_some_and(|upper| arc.lower < upper);
        let is_drawn = (seed * 31 + id).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 63 == 1;
        if is_duration && differs && is_drawn {
            arc.is_contingent = true;
            natures += 1;
        }
    }
    natures
}

fn key(network: &Network, plan: &Plan, order: fn(&Network, &Plan) -> Vec<(u32, u32)>) -> Key {
    let mut key: Key = (
        plan.choices.iter().map(|it| (it.decision.0, it.alternative)).collect(),
        plan.causal_links.iter().map(|it| (it.ask.0, it.tell.0)).collect(),
        order(network, plan),
    );
    key.0.sort_unstable();
    key.1.sort_unstable();
    key.2.sort_unstable();
    key
}

fn conflicts(_: &Network, plan: &Plan) -> Vec<(u32, u32)> {
    plan.conflict_order.iter().map(|it| (it.first.0, it.then.0)).collect()
}

fn all_conflicts(network: &Network) -> Option<Vec<Key>> {
    let answer = reference::search(network, 1_500)?;
    let keys = answer.plans.iter().map(|found| {
        let mut conflicts: Vec<(u32, u32)> =
            found.conflicts.iter().map(|it| (it.first.0, it.then.0)).collect();
        conflicts.sort_unstable();
        (
            found.choices.iter().map(|it| (it.decision.0, it.alternative)).collect(),
            found.links.iter().map(|it| (it.ask.0, it.tell.0)).collect(),
            conflicts,
        )
    });
    Some(keys.collect())
}

fn all_sides(network: &Network) -> Option<Vec<Key>> {
    let limits = lasting::Limits { schedules: 20_000, plans: 300 };
    let answer = lasting::search(network, limits)?;
    Some(answer.plans.into_iter().map(|key| (key.choices, key.links, key.sides)).collect())
}

/// Returns whether the network of a plan is controllable as the mission asks for.
fn is_controllable(network: &Network, (choices, links, order): &Key) -> bool {
    let choices: Vec<Choice> = choices
        .iter()
        .map(|&(decision, alternative)| Choice { decision: DecisionId(decision), alternative })
        .collect();
    let mut before: Vec<(NodeId, NodeId)> = Vec::new();
    for &(ask, tell) in links {
        let (asked, told) = (network.interval(LabelId(ask)), network.interval(LabelId(tell)));
        if network.is_lasting(LabelId(ask)) {
            before.push((network.ready(LabelId(tell)), asked.0));
        } else {
            before.extend([(told.0, asked.0), (asked.1, told.1)]);
        }
    }
    for &(first, then) in order {
        let (first, then) = (LabelId(first), LabelId(then));
        before.push((network.interval(first).1, network.interval(then).0));
        if !network.is_lasting(first) {
            continue;
        }
        // What would break a requirement is on the side of what it rests on.
        for &(ask, tell) in links {
            let (ask, tell) = (LabelId(ask), LabelId(tell));
            if tell == first && network.conflict(ask, then) {
                before.push((network.interval(ask).1, network.interval(then).0));
            } else if tell == then && network.conflict(ask, first) {
                before.push((network.interval(first).1, network.ready(tell)));
            }
        }
    }
    is_controllable_with(network, &choices, &before)
}

/// Returns whether the arcs that `choices` select, with an order of events, are controllable as the mission asks for.
pub fn is_controllable_with(network: &Network, choices: &[Choice], before: &[(NodeId, NodeId)]) -> bool {
    let (_, selected_arcs) = closure(network, choices);
    let mut uncertain = stnu::Network::new(network.nodes.len());
    // What is tied to an event of the environment's counts as the environment's.
    let mut same: Vec<usize> = (0..network.nodes.len()).collect();
    for (arc, _) in network.arcs.iter().zip(&selected_arcs).filter(|(_, is_selected)| **is_selected) {
        if !arc.is_contingent && arc.lower == Time::ZERO && arc.upper == Bound::ZERO {
            let (from, to) = (same[arc.from.index()], same[arc.to.index()]);
            same.iter_mut().filter(|own| **own == to).for_each(|own| *own = from);
        }
    }
    let point = |node: NodeId| PointId(same[node.index()] as u32);
    let units = |time: Time| {
        (0..10_000).find(|&units| Time::from(units) == time).expect("the missions have small whole times")
    };
    for (arc, _) in network.arcs.iter().zip(&selected_arcs).filter(|(_, is_selected)| **is_selected) {
        let (from, to, lower) = (point(arc.from), point(arc.to), units(arc.lower));
        let upper = if let Bound::Finite(upper) = arc.upper { Some(units(upper)) } else { None };
        if let Some(upper) = upper.filter(|_| arc.is_contingent) {
            let mut link = Link { activation: from, end: to, lower, upper };
            if uncertain.link_ending_at(to).is_some() {
                link.end = uncertain.add_point();
                uncertain.add_edge(to, link.end, 0);
                uncertain.add_edge(link.end, to, 0);
            }
            if uncertain.add_link(link).is_err() {
                // It begins and ends at one time, and the environment may choose another.
                return false;
            }
        } else {
            uncertain.add_edge(to, from, -lower);
            if let Some(upper) = upper {
                uncertain.add_edge(from, to, upper);
            }
        }
    }
    for &(earlier, later) in before {
        uncertain.add_edge(point(later), point(earlier), 0);
    }
    if network.controllability == Controllability::Strong {
        return matches!(stnu::check_strong(&uncertain), Ok(StrongVerdict::Controllable(_)));
    }
    stnu::check(&uncertain, &mut || false).expect("times fit") == Verdict::Controllable
}

/// The kinds of failure of a mission, or nothing if it has a plan.
fn failures(text: &str) -> Vec<&'static str> {
    let outcome = kirk::plan(&network(text), &Options::default(), &mut Unlimited);
    let reasons = outcome.failure.map(|failure| failure.reasons).unwrap_or_default();
    assert_eq!(outcome.plans.is_empty(), !reasons.is_empty(), "{text}");
    reasons.iter().map(|reason| reason.kind.name()).collect()
}

#[test]
fn a_storm_does_not_wait_for_the_survey() {
    let storm = |delay: &str, rest: &str| {
        format!(
            "var DUST : {{STORM}}; primitive Survey()[20,30];
             scenario S[0,200] = {{ {{ {rest} do {{ Survey() }} watching DUST=STORM }},
                                    {{ delay {delay}; DUST=STORM [10,20] }} }}"
        )
    };
    assert_eq!(failures(&storm("[5,100]", "delay;")), [""; 0]);
    // The survey waits until the storm is over.
    assert_eq!(failures(&storm("contingent [5,100]", "delay;")), [""; 0]);
    assert_eq!(failures(&storm("contingent [5,100]", "")), ["controllability"]);
    assert_eq!(failures(&storm("contingent [30,100]", "")), [""; 0]);
}

#[test]
fn a_drive_ends_when_nature_lets_it() {
    let drive = |from: i64, to: i64| {
        format!(
            "primitive Drive() contingent [20,40]; scenario S[0,100] = {{ delay; Drive() [{from},{to}] }}"
        )
    };
    assert_eq!(failures(&drive(30, 35)), ["controllability"]);
    assert_eq!(failures(&drive(20, 39)), ["controllability"]);
    assert_eq!(failures(&drive(0, 40)), [""; 0]);
    assert_eq!(failures(&drive(41, 50)), ["temporal"]);
}

/// From where it begins a drive takes at least 10 and 25: the environment has less to choose, and is asked for nothing.
#[test]
fn the_least_time_of_a_movement_raises_what_nature_chooses() {
    let text = "vehicle R : ATRV at A; location A (0,0); location B (10,0); location C (30,0);
        primitive Drive(to) contingent [5,40] moves R;
        scenario S[0,100] = { { delay; Drive(B) }, { delay; Drive(C) } }";
    let mut network = network(text);
    let (arrivals, places): (Vec<LabelId>, Vec<_>) = (0..network.labels.len() as u32)
        .map(LabelId)
        .filter(|&id| network.labels[id.index()].extent == tpn::Extent::Effect)
        .map(|id| (id, network.labels[id.index()].literal.clone()))
        .unzip();
    assert_eq!(arrivals.len(), 2);
    let values = network.variables[places[0].variable.index()].values.len() as u32;
    for &arrival in &arrivals {
        network.departures.extend((0..values).map(|from| tpn::Departure {
            arrival,
            from: tpn::ValueId(from),
            least: Some(Time::from(10)),
        }));
    }
    let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
    assert_eq!(outcome.plans.len(), 1, "{:?}", outcome.failure);
    let verdict = verify::check_plan(&network, &outcome.plans[0]);
    assert!(verdict.valid, "{:?}", verdict.violations);
}
