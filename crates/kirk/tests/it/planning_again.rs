//! Planning again after changes of bounds.

use crate::support;
use crate::support::{network, options, plan};
use exact::{Bound, Time};
use kirk::{ExpansionLimit, Outcome, Planner, Search, Status, Unlimited};
use tpn::generate::{Recipe, Rng, Tightness, mission};
use tpn::{ArcId, Network, Plan};

/// Makes one upper bound after the other up to `most` tighter or wider, and shows what a search from scratch and the
/// planner answer.
fn change(
    (tightness, seed): (Tightness, u64),
    search: Search,
    most: i64,
    mut look: impl FnMut(&Network, Outcome, Outcome),
) {
    let network = support::network(&mission(Recipe { nodes: 80, tightness, seed }));
    let mut planner = Planner::new(network.clone(), None);
    let mut random = Rng::new(seed);
    for _ in 0..30 {
        let arc = ArcId::from_index(random.below(network.arcs.len() as u64) as usize);
        let bounds = &network.arcs[arc.index()];
        let upper = bounds.upper.finite().filter(|_| bounds.kind == tpn::ArcKind::Activity);
        let Some(upper) = upper else { continue };
        let more = Time::from(random.between(-most, most));
        let upper = upper.checked_add(more).expect("a small time").max(bounds.lower);
        planner.set_bounds(arc, bounds.lower, Bound::Finite(upper));
        let options = support::options(search, false);
        let fresh = kirk::plan(planner.network(), &options, &mut ExpansionLimit(2_000));
        let again = planner.plan(&options, &mut ExpansionLimit(2_000));
        if fresh.status != Status::Limit {
            look(planner.network(), fresh, again);
        }
    }
}

#[test]
fn planning_again_in_textual_order_gives_the_plan_of_a_search_from_scratch_whatever_was_asked_before() {
    for seed in 0..40 {
        for tightness in [Tightness::Feasible, Tightness::Boundary] {
            change((tightness, seed), Search::Chronological, 2, |_, fresh, again| {
                assert_eq!((again.status, again.plans), (fresh.status, fresh.plans), "{tightness:?} {seed}");
            });
        }
    }
}

#[test]
fn planning_again_keeps_what_still_is_a_plan() {
    let (mut kept, mut others) = (0, 0);
    for seed in 0..60 {
        for tightness in [Tightness::Feasible, Tightness::Boundary] {
            let mut last: Option<Plan> = None;
            change((tightness, seed), Search::ConflictDirected, 15, |network, fresh, again| {
                assert_eq!(again.status, fresh.status, "{tightness:?} {seed}");
                let plan = again.plans.first().cloned();
                if let Some(plan) = &plan {
                    let verdict = verify::check_plan(network, plan);
                    assert!(verdict.violations.is_empty(), "{tightness:?} {seed}: {verdict:?}");
                }
                if let (Some(last), Some(plan)) = (&last, &plan) {
                    let chose = |plan: &Plan| (plan.choices.clone(), plan.causal_links.clone());
                    *if chose(last) == chose(plan) { &mut kept } else { &mut others } += 1;
                }
                last = plan;
            });
        }
    }
    assert!(kept > 500 && others > 0, "{kept} kept, {others} not");
}

/// A shop whose orders only the solver finds keeps them while a duration gets longer and shorter.
#[test]
fn orders_are_kept_while_they_fit() {
    for seed in 0..20 {
        let original = network(&tpn::families::open_shop(4, 105, seed));
        let mut planner = Planner::new(original.clone(), None);
        let options = options(Search::ConflictDirected, false);
        let Some(first) = planner.plan(&options, &mut Unlimited).plans.pop() else { continue };
        let operation = original.arcs.iter().rposition(|arc| arc.kind == tpn::ArcKind::Assertion);
        let arc = ArcId::from_index(operation.expect("a shop has operations"));
        let shorter = original.arcs[arc.index()].lower.checked_sub(Time::from(1)).expect("a small time");
        planner.set_bounds(arc, shorter.max(Time::ZERO), original.arcs[arc.index()].upper);
        let wider = planner.plan(&options, &mut Unlimited).plans.pop().expect("what fitted fits");
        assert_eq!(wider.conflict_order, first.conflict_order, "{seed}");
        planner.set_bounds(arc, original.arcs[arc.index()].lower, original.arcs[arc.index()].upper);
        let tighter = planner.plan(&options, &mut Unlimited).plans.pop().expect("it is the first again");
        assert_eq!(tighter.conflict_order, first.conflict_order, "{seed}");
    }
}

#[test]
fn planning_again_after_a_change_answers_as_planning_anew() {
    for seed in 0..12 {
        let recipe = Recipe { nodes: 60, tightness: Tightness::Boundary, seed };
        let original = network(&mission(recipe));
        let mut planner = Planner::new(original.clone(), None);
        let mut random = Rng::new(seed);
        for change in 0..12 {
            let arc = ArcId::from_index(random.below(original.arcs.len() as u64) as usize);
            let lower = Time::new(random.between(0, 12), random.between(1, 2)).expect("a fraction");
            let longer = lower.checked_add(random.between(0, 30).into()).expect("a small time");
            let upper = Bound::Finite(longer);
            planner.set_bounds(arc, lower, upper);
            let anew = plan(planner.network(), Search::ConflictDirected, false);
            let again = planner.plan(&options(Search::ConflictDirected, false), &mut Unlimited);
            assert_eq!(again.status, anew.status, "{recipe:?}, change {change}");
            if change % 3 == 2 {
                let old = &original.arcs[arc.index()];
                planner.set_bounds(arc, old.lower, old.upper);
            }
        }
    }
}
