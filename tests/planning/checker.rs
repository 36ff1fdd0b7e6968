//! The checker finds what is wrong with plans that planning made: each with one thing changed is refused. The checker's
//! rules, one by one, are tested in its own crate.

use acceptance::mission::{all_plans, network, sound};
use acceptance::random::small_mission;
use exact::Time;
use kirk::Search;
use tpn::generate::Rng;

/// Random missions, each plan changed in one random way that matters.
#[test]
fn random_plans_with_one_thing_changed_are_refused() {
    let mut rng = Rng::new(7);
    let mut changed = 0;
    for seed in 0..400 {
        let network = network(&small_mission(seed));
        for plan in all_plans(&network, Search::ConflictDirected).plans.iter().take(3) {
            let mut wrong = plan.clone();
            match rng.below(4) {
                0 if !plan.causal_links.is_empty() => {
                    wrong.causal_links.remove(rng.below(plan.causal_links.len() as u64) as usize);
                }
                1 if !plan.conflict_order.is_empty() => {
                    wrong.conflict_order.remove(rng.below(plan.conflict_order.len() as u64) as usize);
                }
                2 => {
                    let arc = rng.below(network.arcs.len() as u64) as usize;
                    wrong.selected_arcs[arc] = !wrong.selected_arcs[arc];
                }
                _ => {
                    let window = wrong.windows.iter_mut().flatten().nth(rng.below(4) as usize);
                    let Some(window) = window else { continue };
                    let later = Time::new(1, 7).and_then(|seventh| window.earliest.checked_add(seventh));
                    window.earliest = later.expect("a small time");
                }
            }
            assert!(sound(&network, &wrong).is_err(), "seed {seed}");
            changed += 1;
        }
    }
    assert!(changed > 200, "only {changed} plans were changed");
}
