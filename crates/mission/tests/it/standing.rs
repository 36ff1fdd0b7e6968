//! Vehicles that share a place (SPEC 10.3): each has a place of its own there, at the start and wherever they meet.

use crate::support::Mission;
use executive::Happening;
use kirk::Options;
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

/// Returns where the vehicles that move are at a time.
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
    let slots = |rest: &str| {
        let Mission { program, network } = Mission::read(&format!("{WORLD}{rest}"));
        snapshot::standing::start_slots(&program, &network.occurrences)
    };
    let convoy = "primitive Convoy(to) moves R1, R2; scenario S[0,99] = { choose { Convoy(EAST), delay } }";
    assert_eq!(slots(convoy), [0, 0, 1, 2]);
    let by_parameters = "primitive Convoy(a, b, to) moves a, b; scenario S[0,99] = { choose { Convoy(R4, R2, EAST), delay } }";
    assert_eq!(slots(by_parameters), [0, 1, 2, 1]);
    assert_eq!(slots("scenario S[0,99] = { Drive(R1, EAST) }"), [0, 1, 2, 3]);
    assert_apart(&places(&planned, 0.0), 4);
    assert_apart(&places(&planned, 1e6), 4);
}

/// Vehicles that parameters name set out in formation as those do that the primitive names.
#[test]
fn vehicles_that_parameters_name_set_out_in_formation() {
    let source = "location A (0, 0); location B (40, 10); vehicle F[1..3] : ATRV at A;
         primitive Convoy(a, b, c, to)[1,90] moves a, b, c; scenario S[0,100] = { Convoy(F[1], F[2], F[3], B) }";
    let mission = Mission::read(source);
    let execution = mission.executed(0, &[]);
    assert_eq!(execution.ending, executive::Ending::Finished, "{:?}", execution.log);
}

/// Nothing moves a vehicle to where its formation sets out but a drive.
#[test]
fn a_formation_whose_vehicles_are_apart_does_not_set_out() {
    let source = "location A (0, 0); location B (40, 10); vehicle L : ATRV at A; vehicle F : ATRV at B;
         primitive Convoy(to)[1,90] moves L, F; primitive Drive(r : vehicle, to)[1,90] moves r;
         scenario S[0,400] = { FIRST Convoy(B) }";
    let executed = |first: &str| Mission::read(&source.replace("FIRST", first)).executed(0, &[]);
    let apart = executed("");
    let gives_up = |happening: &Happening| matches!(happening, Happening::Progress { text, .. } if text.starts_with("F is 4") && text.ends_with(" m from its start position, and gives up"));
    assert!(apart.log.iter().any(|it| gives_up(&it.happening)), "{:?}", apart.log);
    let follower = &apart.drives[0].vehicles[1];
    assert!(follower.frames.iter().all(|it| it.position_m == Point2::new(40.0, 10.0)), "{follower:?}");
    assert_eq!(executed("Drive(F, A); delay;").ending, executive::Ending::Finished);
}

/// A follower that alone is somewhere else is drawn there, until its formation sets out.
#[test]
fn a_follower_is_where_it_starts_until_its_formation_sets_out() {
    let source = "location A (0, 0); location B (40, 10); location C (60, 0); vehicle L : ATRV at A; vehicle F : ATRV at B;
         primitive Wait()[5,5]; primitive Convoy(to)[1,90] moves L, F; scenario S[0,100] = { Wait(); Convoy(C) }";
    let planned = Mission::read(source).with_plan((Options::default(), 0), |_, planned, _, _| planned);
    let place = |time: f64| {
        let of_follower = planned.motions.iter().find(|it| it.vehicle == 1);
        of_follower.and_then(|it| it.at(time)).expect("it is there").0
    };
    assert_eq!([place(0.0), place(5.0)], [Point2::new(40.0, 10.0); 2]);
}

/// Vehicles of a formation that the plan does not move are obstacles for others.
#[test]
fn a_formation_that_does_not_set_out_is_in_the_way() {
    let source = "location A (20, 0); location B (40, 0); location C (0, 0); location D (40, 30);
         vehicle L, F : ATRV at A; vehicle X : ATRV at C;
         primitive Convoy(to)[1,90] moves L, F; primitive Drive(to)[1,90] moves X;
         scenario S[0,100] = { choose { delay, Convoy(D) }, Drive(B) }";
    let planned = Mission::read(source).with_plan((kirk::Options::default(), 0), |_, planned, _, _| planned);
    assert!(planned.separation_violations.is_empty(), "{:?}", planned.separation_violations);
    let place = |vehicle: u32, time: f64| {
        planned
            .motions
            .iter()
            .find(|it| it.vehicle == vehicle)
            .and_then(|it| it.at(time))
            .expect("it is there")
            .0
    };
    for step in 0..=400 {
        let time = f64::from(step) / 100.0;
        for other in [0, 1] {
            let away_m = distance(&place(2, time), &place(other, time));
            assert!(away_m > 2.32 - 0.05, "{away_m} at {time}");
        }
    }
}

/// Of two locations with one position, a vehicle is at the one that it was sent to.
#[test]
fn a_drive_to_another_name_of_the_same_place_leads_there() {
    let source = "location A (0, 0); location HERE (0, 0); location C (1, 0); vehicle R : ATRV at A;
         primitive Go(to)[0,60] moves R; scenario S[0,200] = { Go(HERE); Go(C) }";
    let execution = Mission::read(source).executed(0, &[]);
    assert_eq!(execution.ending, executive::Ending::Finished, "{:?}", execution.log);
}

/// A drive starts where its vehicle stands, beside its location, and no bound of its leg says that it takes longer.
#[test]
fn bounds_hold_wherever_a_vehicle_stands() {
    let planned = plan(
        "objective minimize end; location SOUTH (30, -20); group Two = R1, R2;
         scenario S[0,2000] = { any rover in Two { Drive(rover, SOUTH) } }",
    );
    let plan = &planned.planning.outcome.plans[0];
    // R2 stands south of R1.
    let occurrence = &planned.network.occurrences[planned.traverses[0].occurrence.index()];
    assert_eq!(occurrence.arguments[0], "R2");
    assert!(planned.traverses[0].length_m < 49.0, "{} m", planned.traverses[0].length_m);
    assert!(plan.quality.end.to_f64() < 98.0, "{:?}", plan.quality);
    assert_eq!(plan.quality.is_optimal, Some(true));
}

/// Which place of a location a vehicle has depends on when others leave it, so that an earlier end is possible.
#[test]
fn a_plan_is_optimal_only_for_all_places_where_vehicles_may_stand() {
    let is_optimal = |first: &str| {
        let source = format!(
            "objective minimize end; location P (30, 200); location Q (80, 200);
             scenario S[0,9000] = {{
               {{ Drive(R1, {first}); delay[0,3000]; Drive(R1, Q) }}, {{ delay[2000,2000]; Drive(R4, P) }}
             }}"
        );
        let planned = plan(&source);
        let (optimal, bound) =
            (planned.planning.outcome.plans[0].quality.is_optimal, planned.planning.outcome.bound);
        (optimal, bound.map(exact::Rational::to_f64), planned.planning.outcome.plans[0].quality.end.to_f64())
    };
    // If R1 is still at P, R4 stops before it.
    let (optimal, bound, end) = is_optimal("P");
    assert_eq!(optimal, Some(false));
    let bound = bound.expect("it is known how much earlier the end may be");
    assert!(bound < end - 5.0 && bound > end - 20.0, "{bound} and {end}");
    assert_eq!(is_optimal("EAST").0, Some(true));
}

/// Without a terrain, the ground reaches as far as vehicles may stand.
#[test]
fn vehicles_beside_a_location_at_the_edge_are_on_the_map() {
    let source = "location A (0, 0); location B (20, 0); vehicle F[1..5] : ATRV at A;
         primitive Convoy(a, b, c, d, to)[1,90] moves a, b, c, d; primitive Drive(r, to)[1,90] moves r;
         scenario S[0,200] = { Drive(F[2], B); Drive(F[4], B); Drive(F[5], B) }";
    let planned = Mission::read(source).with_plan((kirk::Options::default(), 0), |_, planned, _, _| planned);
    assert!(planned.planning.undrivable.is_empty(), "{:?}", planned.planning.undrivable);
    assert_eq!(planned.traverses.len(), 3);
}

/// A drive of no length takes no time, also where acceleration counts, and takes nothing from the times of others.
#[test]
fn a_kinodynamic_drive_to_where_the_vehicle_is_takes_no_time_and_the_one_before_its_own() {
    let mission = Mission::read(
        "location A (0, 0); location B (60, 0); vehicle R : ATRV at A;
primitive Drive(to)[0,200] moves R speed (0.01, 0.4) kinodynamic;
scenario S[0,99] = { Drive(B); Drive(B) }",
    );
    mission.with_plan((Options::default(), 0), |_, planned, _, _| {
        let least: Vec<f64> = planned
            .traverses
            .iter()
            .map(|it| it.leg_figures.iter().map(|leg| leg.min_duration.to_f64()).sum())
            .collect();
        assert!(least[0] > 60.0 / 0.4 / 60.0 && least[1] == 0.0, "{least:?}");
        let plan = &planned.planning.outcome.plans[0];
        let end = plan.windows[planned.network.end.index()].expect("it is selected").earliest;
        assert!(end.to_f64() > 2.5, "{end:?}");
    });
}
