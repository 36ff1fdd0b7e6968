//! Vehicles that share a place (SPEC 10.3): each has a place of its own there, at the start and wherever they meet.

use crate::support::Mission;
use mission::planning::Planned;
use nalgebra::{Point2, distance};

const WORLD: &str = "option time_unit = second;
    location BASE (30, 30); location EAST (80, 30); location WEST (10, 60);
    vehicle R1 : ATRV-Jr at BASE; vehicle R2 : ATRV-Jr at BASE; vehicle R3 : ATRV at BASE; vehicle R4 : ATRV-Jr at BASE;
    primitive Drive(rover, to) moves rover speed (0.1, 0.5);
    ";
/// The least distance of two vehicles here: radii of 0.661 and 0.515 m with a meter between them.
const APART_M: f64 = 0.515 + 0.515 + 1.0;

fn plan(rest: &str) -> Planned {
    let source = format!("{WORLD}{rest}");
    let planned = Mission::read(&source).with_plan((kirk::Options::default(), 1), |_, planned, _, _| planned);
    let failure = &planned.planning.outcome.failure;
    let verdict = planned.planning.verdict.as_ref().unwrap_or_else(|| panic!("{failure:?}"));
    assert!(verdict.valid, "{verdict:?}");
    planned
}

/// Where the vehicles that move are at a time.
fn places(planned: &Planned, time: f64) -> Vec<Point2<f64>> {
    planned.motions.iter().map(|motion| motion.at(time).expect("it moves").0).collect()
}

fn assert_apart(places: &[Point2<f64>], count: usize) {
    assert_eq!(places.len(), count);
    for (index, place) in places.iter().enumerate() {
        for other in &places[..index] {
            assert!(distance(place, other) >= APART_M, "{place} and {other}");
        }
    }
}

#[test]
fn four_rovers_that_start_and_end_at_one_location_stand_beside_each_other() {
    let planned = plan(
        "scenario S[0,2000] = {
            Drive(R1, EAST); Drive(R2, EAST); Drive(R3, EAST); Drive(R4, EAST); Drive(R2, WEST); Drive(R1, WEST)
        }",
    );
    assert_apart(&places(&planned, 0.0), 4);
    assert_apart(&places(&planned, 1e6), 4);
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    // Each path begins where the one before it ends.
    let ends = |occurrence: usize| {
        let points = planned.traverses[occurrence].legs.iter().flat_map(|leg| &leg.points_m);
        let points: Vec<Point2<f64>> = points.copied().collect();
        [points[0], points[points.len() - 1]]
    };
    assert_eq!(ends(0)[1], ends(5)[0], "R1 leaves EAST from where it came");
    assert_eq!(ends(1)[1], ends(4)[0], "so does R2");
    assert_eq!(
        ends(0),
        [Point2::new(30.0, 30.0), Point2::new(80.0, 30.0)],
        "the first has the location itself"
    );
}

#[test]
fn vehicles_that_drive_together_keep_formation_and_one_place() {
    let planned = plan(
        "primitive Convoy(to) moves R1, R2 speed (0.1, 0.5);
        scenario S[0,2000] = { Convoy(EAST); Drive(R3, WEST) }",
    );
    let slots: Vec<usize> = {
        let program = rmpl::parse(&format!("{WORLD}primitive Convoy(to) moves R1, R2;")).program();
        snapshot::standing::start_slots(&program)
    };
    assert_eq!(slots, [0, 0, 1, 2]);
    assert_apart(&places(&planned, 0.0), 4);
    assert_apart(&places(&planned, 1e6), 4);
}
