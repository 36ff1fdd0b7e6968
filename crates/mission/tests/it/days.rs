//! Whole days, as operators plan them: proven to be the best, kept by the checker, robust in simulation.

use exact::Time;
use kirk::Options;
use mission::sampling::Sampler;
use snapshot::{RobustnessSettings, Tally, Uncertainty};

use crate::support::Mission;

const SOL: &str = include_str!("../../../../assets/missions/sol.rmpl");
const FLEET: &str = include_str!("../../../../assets/missions/fleet.rmpl");

/// What a mission's best plan came to.
struct Day {
    reward: Time,
    length_m: f64,
    /// The occurrences of activities that the plan selects.
    chosen: Vec<String>,
    tally: Tally,
}

fn day(source: &str, is_optimal: bool) -> Day {
    let mission = Mission::read(source);
    mission.with_plan((Options::default(), 0), |problem, planned, grounds, paths| {
        let plan = planned.planning.outcome.plans.first().expect("the day has a plan");
        assert_eq!(plan.quality.is_optimal, Some(is_optimal));
        let verdict = verify::check_plan(&planned.network, plan);
        assert!(verdict.valid, "{:?}", verdict.violations);
        let settings = RobustnessSettings { runs: 30, seed: 1, uncertainty: Uncertainty::default() };
        let sampler = Sampler::new(problem, &planned, &settings.uncertainty);
        let sampler = sampler.expect("there is a plan").expect("its times fit");
        let mut tally = Tally::default();
        for number in 0..settings.runs {
            sampler.run(problem, &settings, number, grounds, paths, &mut tally).expect("its times fit");
        }
        let selected = planned.network.occurrences.iter().filter(|it| plan.selected_nodes[it.start.index()]);
        let chosen = selected.filter(|it| it.kind == tpn::OccurrenceKind::Primitive);
        Day {
            reward: Time::from_units(plan.quality.reward),
            length_m: plan.quality.length_m,
            chosen: chosen.map(|it| it.name.to_string()).collect(),
            tally,
        }
    })
}

fn has(day: &Day, activity: &str) -> bool {
    day.chosen.iter().any(|name| name.split('#').next() == Some(activity))
}

#[test]
fn a_sol_takes_what_is_worth_most_and_another_worth_changes_the_plan() {
    let planned = day(SOL, true);
    // Two contacts, two of the better pictures, a panorama or what is ahead: by hand, no better set fits the battery.
    assert_eq!(planned.reward, Time::from(168));
    assert!(!has(&planned, "Drill"), "{:?}", planned.chosen);
    assert_eq!(planned.tally.succeeded, planned.tally.runs, "{:?}", planned.tally.breaks);
    let other = day(&SOL.replace("const CORE = 60;", "const CORE = 120;"), true);
    assert!(has(&other, "Drill"), "{:?}", other.chosen);
    assert!(other.chosen.iter().filter(|name| name.starts_with("Contact")).count() < 2, "{:?}", other.chosen);
}

#[test]
fn a_fleet_shares_its_sites_by_the_meters_it_drives() {
    // In another order, the rovers at one place may stand nearer to where they come from.
    let planned = day(FLEET, false);
    assert_eq!(planned.tally.succeeded, planned.tally.runs, "{:?}", planned.tally.breaks);
    let scouts = |day: &Day| {
        let drives = day.chosen.iter().filter(|name| name.starts_with("Look#"));
        drives.cloned().collect::<Vec<String>>()
    };
    let other = day(&FLEET.replace("Scout1 : ATRV-Jr at NORTH", "Scout1 : ATRV-Jr at EAST"), false);
    // From the east the first scout is nearer, and drives to both sites; before, the second did.
    assert_ne!(scouts(&planned), scouts(&other));
    assert!(other.length_m < planned.length_m, "{} and {}", other.length_m, planned.length_m);
}
