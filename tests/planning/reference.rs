//! Both searches against the exhaustive reference on many small random missions: the same plans, each one sound.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use acceptance::mission::{compile, try_plans};
use acceptance::random::{crowded_mission, small_mission};
use acceptance::reference::{Found, search};
use exact::{Bound, Time};
use kirk::Search;
use tpn::{LabelId, Network, Plan, Top};

/// Missions of any kind that the reference finishes.
const MISSIONS: u64 = 60_000;
/// Missions with many orders in little time.
const CROWDED_MISSIONS: u64 = 30_000;
/// The reference gives up on missions with more steps than this, and another one takes their place.
const MAX_STEPS: u64 = 1_500;
/// What ordered intervals are kept apart by: it decides what touching means (SPEC 5.3).
const GAPS: [&str; 4] = ["1", "0", "2", "0.5"];

#[test]
fn both_searches_find_exactly_the_plans_that_exist() {
    let tally = compare_all(MISSIONS, small_mission);
    tally.tell("missions of any kind");
    // The comparison says little unless the missions are mixed.
    let (feasible, with_conditions) = (tally.feasible.into_inner(), tally.with_conditions.into_inner());
    assert!(
        feasible > MISSIONS / 5 && feasible < MISSIONS * 4 / 5,
        "{feasible} missions of {MISSIONS} have a plan"
    );
    assert!(
        with_conditions > MISSIONS / 20,
        "{with_conditions} missions of {MISSIONS} have links or conflicts"
    );
}

#[test]
fn both_searches_find_exactly_the_plans_that_exist_where_intervals_crowd() {
    let tally = compare_all(CROWDED_MISSIONS, crowded_mission);
    tally.tell("crowded missions");
    let (feasible, has_touching) = (tally.feasible.into_inner(), tally.with_touching.into_inner());
    assert!(
        feasible > CROWDED_MISSIONS / 5 && feasible < CROWDED_MISSIONS * 4 / 5,
        "{feasible} missions of {CROWDED_MISSIONS} have a plan"
    );
    let others = tally.with_other_first.into_inner();
    assert!(
        others < CROWDED_MISSIONS / 30,
        "{others} missions have another first plan where the search learns"
    );
    // Failures that a gap alone causes are only tried where other choices may force intervals to touch.
    assert!(
        has_touching > CROWDED_MISSIONS / 20,
        "{has_touching} missions of {CROWDED_MISSIONS} have intervals that touch"
    );
}

/// What a comparison went over.
#[derive(Default)]
struct Tally {
    compared: AtomicU64,
    feasible: AtomicU64,
    with_conditions: AtomicU64,
    with_touching: AtomicU64,
    with_other_first: AtomicU64,
    plans: AtomicU64,
}

impl Tally {
    fn add(&self, answer: &Compared) {
        self.compared.fetch_add(1, Ordering::Relaxed);
        self.plans.fetch_add(answer.plans, Ordering::Relaxed);
        self.feasible.fetch_add(u64::from(answer.plans > 0), Ordering::Relaxed);
        self.with_conditions.fetch_add(u64::from(answer.has_conditions), Ordering::Relaxed);
        self.with_touching.fetch_add(u64::from(answer.has_touching), Ordering::Relaxed);
        self.with_other_first.fetch_add(u64::from(answer.has_other_first), Ordering::Relaxed);
    }

    #[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
    fn tell(&self, what: &str) {
        println!(
            "{:?} {what} compared: {:?} with plans, {:?} with links or conflicts, {:?} with intervals that touch; {:?} plans; \
             {:?} with another first plan where the search learns",
            self.compared,
            self.feasible,
            self.with_conditions,
            self.with_touching,
            self.plans,
            self.with_other_first
        );
    }
}

/// Compares `count` missions; all must agree.
fn compare_all(count: u64, mission: fn(u64) -> String) -> Tally {
    let tally = Tally::default();
    let disagreements = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 0..2_u64 {
            let (tally, disagreements) = (&tally, &disagreements);
            scope.spawn(move || {
                let (mut seed, mut compared) = (worker, 0);
                while compared < count / 2 {
                    // Half the missions have the language's gap, the others have each a third.
                    let gap = GAPS[if seed % 4 < 2 { 0 } else { 1 + (seed / 4 % 3) as usize }];
                    match compare(&mission(seed), gap.parse().expect("a time")) {
                        Ok(Some(answer)) => {
                            tally.add(&answer);
                            compared += 1;
                        }
                        Ok(None) => {}
                        Err(problem) => {
                            compared += 1;
                            disagreements
                                .lock()
                                .expect("no thread panics")
                                .push(format!("seed {seed}, gap {gap}, {problem}"));
                        }
                    }
                    seed += 2;
                }
            });
        }
    });
    let disagreements = disagreements.into_inner().expect("no thread panics");
    let shown = &disagreements[..disagreements.len().min(5)];
    assert!(
        disagreements.is_empty(),
        "{} of {count} missions differ, such as {shown:#?}",
        disagreements.len()
    );
    tally
}

/// What one mission was like.
struct Compared {
    plans: u64,
    has_conditions: bool,
    has_touching: bool,
    /// Whether the search that learns finds a first plan with other choices or links than the canonical one.
    has_other_first: bool,
}

/// Returns what the mission is like, if the reference finishes and both searches agree with it.
fn compare(text: &str, gap: Time) -> Result<Option<Compared>, String> {
    let (network, diagnostics) = compile(text, &Top::Scenario(None));
    let mut network = network.ok_or_else(|| format!("does not compile: {diagnostics:?}\n{text}"))?;
    network.threat_gap = gap;
    let Some(answer) = search(&network, MAX_STEPS) else { return Ok(None) };
    let plan_key = |plan: &Plan| plan_key(&network, plan);
    let mut has_other_first = false;
    let expected: BTreeSet<Comparable> = answer.plans.iter().map(found_key).collect();
    for kind in [Search::Chronological, Search::ConflictDirected] {
        let plans =
            |all| try_plans(&network, kind, all).map_err(|problem| format!("{kind:?}: {problem}\n{text}"));
        let outcome = plans(true)?;
        let found: BTreeSet<Comparable> = outcome.plans.iter().map(plan_key).collect();
        if found != expected {
            let missing: Vec<&Comparable> = expected.difference(&found).collect();
            let wrong: Vec<&Comparable> = found.difference(&expected).collect();
            return Err(format!(
                "{kind:?}: {} plans are missing, {} are wrong, such as {:?} and {:?}\n{text}",
                missing.len(),
                wrong.len(),
                missing.first(),
                wrong.first()
            ));
        }
        if outcome.plans.len() != expected.len() {
            return Err(format!("{kind:?}: a plan is listed twice\n{text}"));
        }
        let first = plans(false)?;
        // The search that learns may find a later plan where the canonical one rests on intervals forced to touch.
        let (first, canonical) = (first.plans.first().map(plan_key), answer.plans.first().map(found_key));
        let is_right = match (&first, &canonical) {
            (Some(first), Some(_)) if kind == Search::ConflictDirected => expected.contains(first),
            _ => first == canonical,
        };
        if !is_right {
            return Err(format!("{kind:?}: the first plan is not the canonical one\n{text}"));
        }
        // Which of two orders a plan has says nothing of what comes first in the text.
        let told = |key: &Option<Comparable>| {
            key.as_ref().map(|(choices, links, ..)| (choices.clone(), links.clone()))
        };
        has_other_first |= told(&first) != told(&canonical);
    }
    Ok(Some(Compared {
        has_other_first,
        plans: answer.plans.len() as u64,
        has_conditions: answer.plans.iter().any(|plan| !plan.links.is_empty() || !plan.conflicts.is_empty()),
        has_touching: answer.plans.iter().any(|plan| touches(&network, plan)),
    }))
}

/// Returns whether an interval must begin at the very time at which one that excludes it ends.
fn touches(network: &Network, plan: &Found) -> bool {
    let arc = |label: LabelId| &network.arcs[network.labels[label.index()].arc.index()];
    plan.conflicts.iter().any(|order| {
        let (end, start) = (arc(order.first).to, arc(order.then).from);
        end != start
            && plan.windows[end.index()]
                .zip(plan.windows[start.index()])
                .is_some_and(|(end, start)| end == start && Bound::Finite(end.0) == end.1)
    })
}

/// Choices, links, order of conflicts, windows.
type Comparable = (Vec<(u32, u32)>, Vec<(u32, u32)>, Vec<(u32, u32)>, Vec<String>);

fn found_key(found: &Found) -> Comparable {
    let mut conflicts: Vec<(u32, u32)> =
        found.conflicts.iter().map(|order| (order.first.0, order.then.0)).collect();
    conflicts.sort_unstable();
    (
        found.choices.iter().map(|choice| (choice.decision.0, choice.alternative)).collect(),
        found.links.iter().map(|link| (link.ask.0, link.tell.0)).collect(),
        conflicts,
        found.windows.iter().map(|window| format!("{window:?}")).collect(),
    )
}

fn plan_key(network: &Network, plan: &Plan) -> Comparable {
    assert_eq!(plan.windows.len(), network.nodes.len());
    let mut conflicts: Vec<(u32, u32)> =
        plan.conflict_order.iter().map(|order| (order.first.0, order.then.0)).collect();
    let mut links: Vec<(u32, u32)> = plan.causal_links.iter().map(|link| (link.ask.0, link.tell.0)).collect();
    conflicts.sort_unstable();
    links.sort_unstable();
    (
        plan.choices.iter().map(|choice| (choice.decision.0, choice.alternative)).collect(),
        links,
        conflicts,
        plan.windows
            .iter()
            .map(|window| format!("{:?}", window.map(|window| (window.earliest, window.latest))))
            .collect(),
    )
}
