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
