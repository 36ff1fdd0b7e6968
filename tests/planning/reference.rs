//! Both searches against the exhaustive reference on many small random missions: the same plans, each one sound.

use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use acceptance::mission::{compile, try_plans};
use acceptance::random::small_mission;
use acceptance::reference::{Answer, Found, search};
use kirk::Search;
use rmpl::Rational;
use tpn::{Network, Plan, Top};

/// Missions that the reference finishes; the issue asks for a third of them.
const MISSIONS: u64 = 60_000;
/// The reference gives up on missions with more steps than this, and another one takes their place.
const MOST_STEPS: u64 = 1_500;

#[test]
#[expect(clippy::print_stdout, reason = "the count is part of the evidence")]
fn both_searches_find_exactly_the_plans_that_exist() {
    let compared = AtomicU64::new(0);
    let feasible = AtomicU64::new(0);
    let with_conditions = AtomicU64::new(0);
    let disagreements = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 0..2_u64 {
            let (compared, feasible, with_conditions) = (&compared, &feasible, &with_conditions);
            let disagreements = &disagreements;
            scope.spawn(move || {
                let mut seed = worker;
                while compared.load(Ordering::Relaxed) < MISSIONS {
                    match compare(seed) {
                        Ok(Some(answer)) => {
                            let has_conditions = answer
                                .plans
                                .iter()
                                .any(|plan| !plan.links.is_empty() || !plan.conflicts.is_empty());
                            compared.fetch_add(1, Ordering::Relaxed);
                            feasible.fetch_add(u64::from(!answer.plans.is_empty()), Ordering::Relaxed);
                            with_conditions.fetch_add(u64::from(has_conditions), Ordering::Relaxed);
                        }
                        Ok(None) => {}
                        Err(problem) => {
                            compared.fetch_add(1, Ordering::Relaxed);
                            disagreements
                                .lock()
                                .expect("no thread panics")
                                .push(format!("seed {seed}, {problem}"));
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
        "{} of {MISSIONS} missions differ, such as {shown:#?}",
        disagreements.len()
    );
    // The comparison says little unless the missions are mixed.
    let (feasible, with_conditions) = (feasible.into_inner(), with_conditions.into_inner());
    println!(
        "{MISSIONS} missions compared, {feasible} with plans, {with_conditions} with links or conflicts in them"
    );
    assert!(
        feasible > MISSIONS / 5 && feasible < MISSIONS * 4 / 5,
        "{feasible} missions of {MISSIONS} have a plan"
    );
    assert!(
        with_conditions > MISSIONS / 20,
        "{with_conditions} missions of {MISSIONS} have links or conflicts"
    );
}

/// The reference's answer, if it finishes and both searches agree with it.
fn compare(seed: u64) -> Result<Option<Answer>, String> {
    let text = small_mission(seed);
    let (network, diagnostics) = compile(&text, &Top::Scenario(None));
    let mut network = network.ok_or_else(|| format!("does not compile: {diagnostics:?}\n{text}"))?;
    // The gap decides what touching means (SPEC 5.3), so every fourth mission has another one.
    network.threat_gap = match seed % 8 {
        0 => Rational::from_integer(0),
        4 => Rational::new(1, 2),
        _ => Rational::from_integer(1),
    };
    let Some(answer) = search(&network, MOST_STEPS) else { return Ok(None) };
    // Without a gap, two intervals of no length at one instant are each before the other: which order a plan states, and
    // which of two plans with the same order is listed, means nothing. The checker still looks at every window.
    let has_order = !seed.is_multiple_of(8);
    let comparable = |mut key: Comparable| {
        if !has_order {
            key.2.clear();
            key.3.clear();
        }
        key
    };
    let found_key = |found: &Found| comparable(found_key(found));
    let plan_key = |plan: &Plan| comparable(plan_key(&network, plan));
    let expected: BTreeSet<Comparable> = answer.plans.iter().map(found_key).collect();
    for kind in [Search::Chronological, Search::ConflictDirected] {
        let plans =
            |all| try_plans(&network, kind, all).map_err(|problem| format!("{kind:?}: {problem}\n{text}"));
        let outcome = plans(true)?;
        let found: BTreeSet<Comparable> = outcome.plans.iter().map(plan_key).collect();
        if found != expected {
            let (missing, wrong) = (expected.difference(&found).count(), found.difference(&expected).count());
            return Err(format!("{kind:?}: {missing} plans are missing, {wrong} are wrong\n{text}"));
        }
        let first = plans(false)?;
        if first.plans.first().map(plan_key) != answer.plans.first().map(found_key) {
            return Err(format!("{kind:?}: the first plan is not the canonical one\n{text}"));
        }
    }
    Ok(Some(answer))
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
