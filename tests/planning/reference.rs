//! Both searches against the exhaustive reference on many small random missions: the same plans, each one sound.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};

use acceptance::mission::{all_plans, compile, first_plan};
use acceptance::random::small_mission;
use acceptance::reference::{Answer, Found, search};
use kirk::Search;
use tpn::{Network, Plan, Top};

/// Missions that the reference finishes; the issue asks for at least this many.
const MISSIONS: u64 = 20_000;
/// The reference gives up on missions with more steps than this, and another one takes their place.
const MOST_STEPS: u64 = 1_500;

#[test]
fn both_searches_find_exactly_the_plans_that_exist() {
    let compared = AtomicU64::new(0);
    let feasible = AtomicU64::new(0);
    let with_conditions = AtomicU64::new(0);
    std::thread::scope(|scope| {
        for worker in 0..2_u64 {
            let (compared, feasible, with_conditions) = (&compared, &feasible, &with_conditions);
            scope.spawn(move || {
                let mut seed = worker;
                while compared.load(Ordering::Relaxed) < MISSIONS {
                    if let Some(answer) = compare(seed) {
                        compared.fetch_add(1, Ordering::Relaxed);
                        feasible.fetch_add(u64::from(!answer.plans.is_empty()), Ordering::Relaxed);
                        let has_links = answer
                            .plans
                            .iter()
                            .any(|plan| !plan.links.is_empty() || !plan.conflicts.is_empty());
                        with_conditions.fetch_add(u64::from(has_links), Ordering::Relaxed);
                    }
                    seed += 2;
                }
            });
        }
    });
    // The comparison says little unless the missions are mixed.
    let (feasible, with_conditions) = (feasible.into_inner(), with_conditions.into_inner());
    assert!(
        feasible > MISSIONS / 5 && feasible < MISSIONS * 4 / 5,
        "{feasible} missions of {MISSIONS} have a plan"
    );
    assert!(
        with_conditions > MISSIONS / 20,
        "{with_conditions} missions of {MISSIONS} have links or conflicts"
    );
    println!(
        "{MISSIONS} missions compared, {feasible} with plans, {with_conditions} with links or conflicts in them"
    );
}

fn compare(seed: u64) -> Option<Answer> {
    let text = small_mission(seed);
    let (network, diagnostics) = compile(&text, &Top::Scenario(None));
    let network = network.unwrap_or_else(|| panic!("seed {seed}\n{text}{diagnostics:#?}"));
    let answer = search(&network, MOST_STEPS)?;
    let expected: BTreeSet<Comparable> = answer.plans.iter().map(found_key).collect();
    for kind in [Search::Chronological, Search::ConflictDirected] {
        let outcome = all_plans(&network, kind);
        let found: BTreeSet<Comparable> = outcome.plans.iter().map(|plan| plan_key(&network, plan)).collect();
        assert_eq!(found, expected, "seed {seed}, {kind:?}\n{text}");
        let first = first_plan(&network, kind);
        assert_eq!(
            first.plans.first().map(|plan| plan_key(&network, plan)),
            answer.plans.first().map(found_key),
            "the first plan; seed {seed}, {kind:?}\n{text}"
        );
    }
    Some(answer)
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
