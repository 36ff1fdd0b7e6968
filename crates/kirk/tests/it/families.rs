//! Missions that are hard for searches that do not learn: known answers of the literature, and simple shapes.

use crate::support::{network, options};
use kirk::{ExpansionLimit, Search, Status};
use tpn::families::{JOB_SHOPS, JobShop, chain, pigeonholes, symmetric};

/// The status of the search that learns, within a number of alternatives tried that no enumeration would do with. Its
/// plans are checked.
fn status(text: &str) -> Status {
    let network = network(text);
    let outcome =
        kirk::plan(&network, &options(Search::ConflictDirected, false), &mut ExpansionLimit(200_000));
    for plan in &outcome.plans {
        let verdict = verify::check_plan(&network, plan);
        assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
    }
    outcome.status
}

fn shop(name: &str) -> JobShop {
    *JOB_SHOPS.iter().find(|shop| shop.name == name).expect("a known job shop")
}

#[test]
fn small_job_shops_are_planned_at_their_optimum_and_refuted_one_below() {
    for name in ["ft06", "la01", "la03", "la05"] {
        let shop = shop(name);
        assert_eq!(status(&shop.mission(shop.optimum)), Status::Plan, "{name}");
        assert_eq!(status(&shop.mission(shop.optimum - 1)), Status::NoPlan, "{name}");
        assert_eq!(status(&shop.mission(shop.optimum * 3 / 2)), Status::Plan, "{name}");
    }
}

#[test]
fn too_many_uses_of_one_resource_are_refuted() {
    for count in [5, 12, 40] {
        assert_eq!(status(&pigeonholes(count, 0)), Status::Plan, "{count}");
        assert_eq!(status(&pigeonholes(count, 1)), Status::NoPlan, "{count}");
    }
}

#[test]
fn alternatives_that_are_alike_are_tried_once() {
    assert_eq!(status(&symmetric(10, 5, 0)), Status::Plan);
    assert_eq!(status(&symmetric(10, 5, 1)), Status::NoPlan);
}

#[test]
fn what_an_early_choice_decides_late_is_found() {
    assert_eq!(status(&chain(300, true)), Status::Plan);
    assert_eq!(status(&chain(300, false)), Status::NoPlan);
}

/// Jobs of steps in order, each on one of three machines; a pseudorandom one for each seed.
fn flexible_shop(jobs: u64, machines: u64, seed: u64) -> String {
    let mut state = seed * 2 + 1;
    let mut random = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let mut text = "option threat_gap = 0; objective minimize end;\n".to_owned();
    for machine in 0..machines {
        text += &format!("resource M{machine};\n");
    }
    let mut threads = Vec::new();
    for job in 0..jobs {
        let mut steps = Vec::new();
        for step in 0..machines {
            let first = random(machines);
            let names: Vec<String> = (0..3).map(|at| format!("J{job}S{step}M{at}")).collect();
            for (at, name) in names.iter().enumerate() {
                let (machine, length) = ((first + at as u64) % machines, 1 + random(20));
                text += &format!("primitive {name}()[{length},{length}] uses M{machine};\n");
            }
            steps.push(format!("{{ choose {{ {}() }} }}", names.join("(), ")));
        }
        threads.push(format!("{{ delay; {}; delay }}", steps.join("; delay; ")));
    }
    text + &format!("scenario S[0,10000] = {{ {} }}", threads.join(",\n"))
}

/// The end of the plan found within so many conflicts, and the bound, which is the end itself for an optimal plan.
fn end_and_bound(text: &str, conflicts: u64) -> (f64, f64) {
    let network = network(text);
    let mut enough = |stats: &kirk::Stats| stats.conflicts > conflicts;
    let outcome = kirk::plan(&network, &options(Search::ConflictDirected, false), &mut enough);
    let plan = &outcome.plans[0];
    assert!(verify::check_plan(&network, plan).valid, "{text}");
    let end = plan.windows[network.end.index()].expect("the end is in the plan").earliest.to_f64();
    (end, outcome.bound.map_or(end, exact::Rational::to_f64))
}

#[test]
fn flexible_shops_are_good_at_once_and_better_soon() {
    for seed in 0..4 {
        let text = flexible_shop(12, 6, seed);
        let ((first, _), (later, bound)) = (end_and_bound(&text, 1), end_and_bound(&text, 3_000));
        assert!(
            bound <= later && later < first && first < 1.5 * later,
            "seed {seed}: {first} {later} {bound}"
        );
    }
}

#[test]
fn the_bound_of_a_job_shop_is_near_its_optimum() {
    for shop in JOB_SHOPS {
        let text = format!("objective minimize end; {}", shop.mission(2 * shop.optimum));
        let (end, bound) = end_and_bound(&text, 300);
        let optimum = shop.optimum as f64;
        assert!(bound <= optimum && optimum <= end, "{}: {end} {bound}", shop.name);
        assert!(bound > 0.85 * optimum && end < 1.2 * optimum, "{}: {end} {bound}", shop.name);
    }
}

#[test]
fn the_bound_of_a_sum_that_is_maximized_is_found() {
    let lasts: Vec<u32> = (0..26).map(|at| 20 + (at * at * 37 + at * 11) % 81).collect();
    let mut text = "resource Body; objective maximize reward;\n".to_owned();
    for (at, lasts) in lasts.iter().enumerate() {
        text += &format!("primitive W{at}()[{lasts},{lasts}] uses Body rewards {};\n", lasts + 10);
    }
    let wishes: Vec<String> = (0..26).map(|at| format!("{{ delay; optional W{at}() }}")).collect();
    let room = lasts.iter().sum::<u32>() * 2 / 5;
    text += &format!("scenario S[0,{room}] = {{ {} }}", wishes.join(", "));
    let network = network(&text);
    let reward = |conflicts: u64| {
        let mut enough = |stats: &kirk::Stats| stats.conflicts > conflicts;
        let outcome = kirk::plan(&network, &options(Search::ConflictDirected, false), &mut enough);
        (outcome.plans[0].quality.reward, outcome.bound)
    };
    let (best, open) = reward(u64::MAX);
    let (soon, bound) = reward(200);
    assert!(open.is_none() && soon <= best && bound.is_none_or(|bound| best <= bound));
}
