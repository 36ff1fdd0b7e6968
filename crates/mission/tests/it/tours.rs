//! The quickest tours of one vehicle and of two, against all orders of their stops.

use crate::support::Mission;
use nalgebra::{Point2, distance};
use tpn::generate::Rng;

/// Where each vehicle stands at first.
const BASES: [Point2<f64>; 3] =
    [Point2::new(500.0, 500.0), Point2::new(150.0, 850.0), Point2::new(900.0, 300.0)];
/// Paths are planned for four fifths of a vehicle's greatest speed, which is 60 m a minute here.
const METERS_PER_MINUTE: f64 = 0.8 * 60.0;

/// A place to go to, no earlier than at a time in minutes.
struct Stop {
    place: Point2<f64>,
    release: f64,
}

/// When a vehicle is done at the earliest that makes all of these stops.
fn quickest(at: Point2<f64>, time: f64, stops: &[&Stop]) -> f64 {
    let then = (0..stops.len()).map(|next| {
        let left: Vec<&Stop> =
            stops.iter().enumerate().filter(|(other, _)| *other != next).map(|(_, stop)| *stop).collect();
        let begun = time.max(stops[next].release);
        let over = begun + distance(&at, &stops[next].place) / METERS_PER_MINUTE;
        quickest(stops[next].place, over, &left)
    });
    then.reduce(f64::min).unwrap_or(time)
}

/// The same for several vehicles that share the stops.
fn quickest_of(vehicles: u32, stops: &[Stop]) -> f64 {
    let shares = (0..vehicles.pow(stops.len() as u32)).map(|share| {
        let ends = (0..vehicles).map(|vehicle| {
            let own = stops.iter().enumerate();
            let own = own.filter(|(at, _)| share / vehicles.pow(*at as u32) % vehicles == vehicle);
            quickest(BASES[vehicle as usize], 0.0, &own.map(|(_, stop)| stop).collect::<Vec<&Stop>>())
        });
        ends.fold(0.0, f64::max)
    });
    shares.fold(f64::INFINITY, f64::min)
}

fn mission(vehicles: u32, stops: &[Stop]) -> String {
    let mut text = String::new();
    for (at, stop) in stops.iter().enumerate() {
        text += &format!("location S{at} ({}, {});\n", stop.place.x, stop.place.y);
    }
    for vehicle in 0..vehicles {
        let base = BASES[vehicle as usize];
        text += &format!("location BASE{vehicle} ({}, {});\n", base.x, base.y);
        text += &format!("vehicle R{vehicle} : ATRV at BASE{vehicle};\n");
        text += &format!("primitive Go{vehicle}(to) moves R{vehicle} speed (0.01, 1);\n");
    }
    let visits: Vec<String> = (stops.iter().enumerate())
        .map(|(at, stop)| {
            let ways: Vec<String> = (0..vehicles).map(|vehicle| format!("Go{vehicle}(S{at})")).collect();
            format!("{{ delay[{},9999]; choose {{ {} }} }}", stop.release, ways.join(", "))
        })
        .collect();
    format!("{text}objective minimize end;\nscenario Tour[0,9999] = {{ {} }}\n", visits.join(", "))
}

#[test]
fn tours_are_as_quick_as_the_best_order_of_their_stops() {
    let mut random = Rng::new(23);
    for case in 0..40 {
        let vehicles = 1 + case % 3;
        let count = random.between(3, 6);
        let mut number = |least: i64, most: i64| random.between(least, most) as f64;
        let stops: Vec<Stop> = (0..count)
            .map(|_| Stop {
                place: Point2::new(number(0, 1000), number(0, 1000)),
                release: if number(0, 2) == 0.0 { number(1, 30) } else { 0.0 },
            })
            .collect();
        let best = quickest_of(vehicles, &stops);
        let text = mission(vehicles, &stops);
        Mission::read(&text).with_plan((kirk::Options::default(), 0), |_, planned, _, _| {
            let plan = &planned.planning.outcome.plans[0];
            assert_eq!(plan.quality.is_optimal, Some(true), "case {case}\n{text}");
            let end = plan.quality.end.to_f64();
            assert!((end - best).abs() < 0.01, "case {case}: {end} where {best} is possible\n{text}");
        });
    }
}

#[test]
fn a_search_that_is_stopped_keeps_its_best_plan_and_does_not_call_it_optimal() {
    let mut random = Rng::new(5);
    let mut is_any_unproven = false;
    for case in 0..12 {
        let mut number = |least: i64, most: i64| random.between(least, most) as f64;
        let stops: Vec<Stop> = (0..6)
            .map(|_| Stop { place: Point2::new(number(0, 1000), number(0, 1000)), release: 0.0 })
            .collect();
        let best = quickest_of(2, &stops);
        let mission = Mission::read(&mission(2, &stops));
        for most in [0, 40, 400] {
            let mut asked = 0;
            let mut stop = || {
                asked += 1;
                asked > most
            };
            mission.with_plan_until((kirk::Options::default(), 0), &mut stop, |_, planned, _, _| {
                let what = format!("case {case}, {most} questions");
                assert!(planned.planning.verdict.as_ref().is_some_and(|verdict| verdict.valid), "{what}");
                let quality = &planned.planning.outcome.plans[0].quality;
                let (end, is_optimal) = (quality.end.to_f64(), quality.is_optimal);
                assert!(end > best - 0.01, "{what}: {end} where {best} is possible");
                if is_optimal == Some(true) {
                    assert!(end < best + 0.01, "{what}: {end} where {best} is possible");
                } else {
                    let bound = planned.planning.outcome.bound.expect("a bound").to_f64();
                    assert!(bound < best + 0.01, "{what}: a bound of {bound} where {best} is possible");
                    is_any_unproven = true;
                }
            });
        }
    }
    assert!(is_any_unproven);
}
