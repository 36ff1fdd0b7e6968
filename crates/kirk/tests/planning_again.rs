//! Planning again after changes of bounds.

mod support;

use exact::{Bound, Time};
use kirk::{ExpansionLimit, Planner, Search, Status, Unlimited};
use support::{network, options, plan};
use tpn::ArcId;
use tpn::generate::{Recipe, Rng, Tightness, mission};

#[test]
fn planning_again_gives_the_plan_of_a_search_from_scratch_whatever_was_asked_before() {
    for seed in 0..40 {
        for tightness in [Tightness::Feasible, Tightness::Boundary] {
            let network = support::network(&mission(Recipe { nodes: 80, tightness, seed }));
            for search in [Search::Chronological, Search::ConflictDirected] {
                let mut planner = Planner::new(network.clone(), None);
                let mut random = Rng::new(seed);
                for step in 0..30 {
                    let arc = ArcId::from_index(random.below(network.arcs.len() as u64) as usize);
                    let bounds = &network.arcs[arc.index()];
                    let Some(upper) = bounds.upper.finite().filter(|_| bounds.kind == tpn::ArcKind::Activity)
                    else {
                        continue;
                    };
                    let more = Time::from(random.between(-2, 2));
                    let upper = upper.checked_add(more).expect("a small time").max(bounds.lower);
                    planner.set_bounds(arc, bounds.lower, Bound::Finite(upper));
                    let options = support::options(search, false);
                    let fresh = kirk::plan(planner.network(), &options, &mut ExpansionLimit(2_000));
                    let again = planner.plan(&options, &mut ExpansionLimit(2_000));
                    if fresh.status != Status::Limit {
                        let (fresh, again) = ((fresh.status, fresh.plans), (again.status, again.plans));
                        assert_eq!(again, fresh, "{tightness:?} {seed} {search:?} {step}");
                    }
                }
            }
        }
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
            assert_eq!((again.status, again.plans), (anew.status, anew.plans), "{recipe:?}, change {change}");
            if change % 3 == 2 {
                let old = &original.arcs[arc.index()];
                planner.set_bounds(arc, old.lower, old.upper);
            }
        }
    }
}
