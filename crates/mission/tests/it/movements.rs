//! Vehicles in one place at a time (SPEC 10.3): the order of sites is found, each path starts where the vehicle is, and
//! what a path takes of a resource counts.

use crate::support::Mission;
use exact::Time;
use mission::planning::Planned;
use nalgebra::{Point2, distance};
use tpn::Levels;

const WORLD: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location BASE (10, 10); location A (30, 12); location B (50, 40); location C (15, 45);
    location D (60, 15); location E (35, 55);
    vehicle R1 : ATRV-Jr at BASE;
    ";

fn plan(declarations: &str) -> Planned {
    let source = format!("{WORLD}{declarations}");
    Mission::read(&source).with_plan((kirk::Options::default(), 0), |_, planned, _, _| planned)
}

/// The first and the last point of each traverse, in the order of the plan, with their times.
fn drives(planned: &Planned) -> Vec<(Time, Time, Point2<f64>, Point2<f64>)> {
    let plan = &planned.planning.outcome.plans[0];
    let earliest = |node: tpn::NodeId| plan.windows[node.index()].expect("selected").earliest;
    let mut drives: Vec<_> = planned
        .traverses
        .iter()
        .map(|traverse| {
            let occurrence = &planned.network.occurrences[traverse.occurrence.index()];
            let first = traverse.legs.first().and_then(|leg| leg.points_m.first());
            let last = traverse.legs.last().and_then(|leg| leg.points_m.last());
            (
                earliest(occurrence.start),
                earliest(occurrence.end),
                *first.expect("it has a path"),
                *last.expect("it has a path"),
            )
        })
        .collect();
    drives.sort_by_key(|drive| drive.0);
    drives
}

fn assert_driven_one_after_the_other(planned: &Planned, count: usize) {
    let verdict = planned.planning.verdict.as_ref().expect("it is checked");
    assert!(verdict.valid, "{verdict:?}");
    let drives = drives(planned);
    assert_eq!(drives.len(), count, "every movement has its path");
    let mut at = Point2::new(10.0, 10.0);
    let mut time = Time::ZERO;
    for (start, end, from_m, to_m) in drives {
        assert!(start >= time, "one vehicle drives one way at a time");
        assert!(distance(&from_m, &at) < 1e-6, "the path starts where the vehicle is");
        (time, at) = (end, to_m);
    }
}

const DRIVE: &str = "primitive Drive(to) moves R1 speed (0.02, 0.5);";

#[test]
fn the_order_of_sites_is_found_where_the_textual_one_takes_too_long() {
    let sites = |most: &str| {
        let visits = "unordered { Drive(A); Drive(B); Drive(C); Drive(D); Drive(E) }";
        plan(&format!("{DRIVE} scenario X[0,{most}] = {{ {visits} }}"))
    };
    // A, B, C, D, E takes 6.39 minutes; the shortest way, A, D, B, E, C, takes 4.03.
    for most in ["60", "5", "4.05"] {
        assert_driven_one_after_the_other(&sites(most), 5);
    }
    let failure = sites("4").planning.outcome.failure.clone().expect("there is no plan");
    assert!(failure.reasons[0].message.contains("R1, which is in one place at a time"), "{failure:?}");
}

#[test]
fn one_vehicle_does_not_drive_to_two_places_at_once() {
    let at_once = plan(&format!("{DRIVE} scenario X[0,1500] = {{ Drive(A), Drive(B) }}"));
    let failure = at_once.planning.outcome.failure.as_ref().expect("there is no plan");
    assert_eq!(failure.reasons[0].kind, kirk::FailureKind::Threat);
    assert!(failure.reasons[0].message.starts_with("Drive(A) and Drive(B) both move R1"), "{failure:?}");
    let waiting = plan(&format!("{DRIVE} scenario X[0,1500] = {{ free Drive(A), free Drive(B) }}"));
    assert_driven_one_after_the_other(&waiting, 2);
}

#[test]
fn what_a_path_takes_for_each_meter_counts() {
    let drive = "primitive Drive(to) moves R1 speed (0.02, 0.5) consumes Battery 0.5 per metre;";
    let mission = |level: &str| {
        plan(&format!(
            "resource Battery 0..100 = {level}; {drive} scenario X[0,60] = {{ Drive(A); Drive(BASE) }}"
        ))
    };
    let there_and_back = mission("70");
    assert_driven_one_after_the_other(&there_and_back, 2);
    let plan = &there_and_back.planning.outcome.plans[0];
    let Levels::Range { low, .. } = plan.levels[0] else { panic!("{:?}", plan.levels) };
    let taken = 70.0 - low.to_f64();
    // What drivers need beyond their paths is counted too, for each of the two.
    let counted_m: f64 =
        there_and_back.traverses.iter().map(|it| motion::driven_at_most_m(it.length_m, 0, it.rocks)).sum();
    assert!((taken - 0.5 * counted_m).abs() < 0.01, "{taken} for {counted_m} m");
    assert!(counted_m > plan.quality.length_m);
    let outcome = mission("15").planning.outcome.clone();
    assert!(outcome.plans.is_empty(), "20 m there and back take 20");
    assert_eq!(outcome.failure.expect("it is explained").reasons[0].kind, kirk::FailureKind::Resource);
}

#[test]
fn the_shortest_way_is_found_and_proven() {
    let sites = |objective: &str, clause: &str| {
        plan(&format!(
            "{objective} primitive Drive(to) moves R1 speed (0.02, 0.5){clause};
             scenario X[0,60] = {{ unordered {{ Drive(A); Drive(B); Drive(C); Drive(D); Drive(E) }} }}"
        ))
    };
    let shortest = sites("objective minimize length;", "");
    assert_driven_one_after_the_other(&shortest, 5);
    let best = &shortest.planning.outcome.plans[0].quality;
    assert_eq!(best.is_optimal, Some(true));
    // A, D, B, E, C takes 4.03 minutes at half a meter per second.
    assert!((best.length_m - 4.03 * 30.0).abs() < 0.5, "{} m", best.length_m);
    let cheapest = sites("objective minimize cost;", " costs 2 per metre");
    let quality = &cheapest.planning.outcome.plans[0].quality;
    assert_eq!(quality.is_optimal, Some(true));
    assert!((quality.length_m - best.length_m).abs() < 0.01, "{} m", quality.length_m);
    assert!((quality.cost.to_f64() - 2.0 * quality.length_m).abs() < 0.05, "{}", quality.cost.to_f64());
    // How long the longest way is, no straight line tells.
    let longest = sites("objective maximize length;", "");
    assert_eq!(longest.planning.outcome.plans[0].quality.is_optimal, Some(false));
}

#[test]
fn of_two_ways_the_shorter_one_is_taken_though_it_stands_second() {
    let ways = plan(
        "objective minimize length; primitive Drive(to) moves R1 speed (0.02, 0.5);
         scenario X[0,60] = { choose { { Drive(D); Drive(E) }, Drive(A) }; Drive(B) }",
    );
    let plan = &ways.planning.outcome.plans[0];
    assert_eq!((plan.choices[0].alternative, plan.quality.is_optimal), (1, Some(true)));
    assert_driven_one_after_the_other(&ways, 2);
}

/// The first order that fits the time takes too much of the battery; another one does not.
#[test]
fn the_shortest_order_is_tried_where_meters_take_too_much() {
    let sites = |level: &str| {
        plan(&format!(
            "resource Battery 0..300 = {level}; primitive Drive(to) moves R1 speed (0.02, 0.5) consumes Battery 1 per metre;
             scenario X[0,600] = {{ unordered {{ Drive(A); Drive(B); Drive(C); Drive(D); Drive(E) }} }}"
        ))
    };
    let tight = sites("290");
    assert_driven_one_after_the_other(&tight, 5);
    assert_eq!(tight.planning.outcome.plans[0].quality.is_optimal, None);
    assert!(sites("270").planning.outcome.failure.is_some(), "the shortest way needs more");
}

/// What meters take of a battery is known before an order is chosen, and what is called optimal is.
#[test]
fn what_is_worth_driving_to_depends_on_the_meters_that_a_battery_allows() {
    let best = |level: &str, visits: &str| {
        let planned = plan(&format!(
            "resource Battery 0..200 = {level}; objective maximize reward, minimize end;
             primitive Drive(to) moves R1 speed (0.02, 0.5) consumes Battery 1 per metre rewards 5;
             primitive Photo(at)[1,1] requires R1.at=at rewards 50;
             scenario X[0,600] = {{ {visits} }}"
        ));
        let plan = planned.planning.outcome.plans.first().expect("there is one");
        (plan.quality.reward, plan.quality.is_optimal)
    };
    let any = "unordered { optional Drive(A); optional Drive(B); optional { Drive(C); Photo(C) };
        optional Drive(D); optional Drive(E) }";
    for level in ["70", "90", "120"] {
        let (reward, is_optimal) = best(level, any);
        assert!(reward >= exact::Rational::from_integer(55), "{level}: {reward}, with the picture alone 55");
        if level == "90" && is_optimal == Some(true) {
            assert!(reward >= best(level, "Drive(C); Photo(C); Drive(E)").0);
        }
    }
}
