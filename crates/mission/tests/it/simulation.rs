//! Vehicles that drive their traverses in simulation: past what the map does not show, late where that costs time, and
//! with consequences for the plan.

use exact::Time;
use executive::{Disturbance, Ending, Happening};
use nalgebra::{Point2, distance};
use snapshot::Execution;
use snapshot::SimulatedDrive;

use crate::support::Mission;

const ENROUTE: &str = include_str!("../../../../assets/missions/enroute.rmpl");
const DETOUR: &str = include_str!("../../../../assets/missions/detour.rmpl");

/// Executes a mission's plan.
fn run(source: &str, disturbances: &[Disturbance]) -> Execution {
    Mission::read(source).executed(1, disturbances)
}

fn minutes(time: Time) -> f64 {
    time.to_f64()
}

fn duration(drive: &SimulatedDrive) -> f64 {
    minutes(drive.duration.expect("it arrived"))
}

fn obstacle(at: i64, place: Point2<f64>, radius: f64) -> Disturbance {
    Disturbance::Obstacle { at: at.into(), x: place.x, y: place.y, radius, low: false }
}

fn stand(vehicle: &str, from: i64, until: i64) -> Disturbance {
    Disturbance::VehicleSlow {
        vehicle: vehicle.into(),
        factor: exact::Rational::ZERO,
        from: from.into(),
        until: until.into(),
    }
}

fn violations(execution: &Execution) -> Vec<&str> {
    execution
        .log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Violation { reason, .. } => Some(reason.as_str()),
            _ => None,
        })
        .collect()
}

fn progress(execution: &Execution) -> Vec<&str> {
    execution
        .log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Progress { text, .. } => Some(text.as_str()),
            _ => None,
        })
        .collect()
}

/// The radius of an ATRV in meters.
const ATRV_M: f64 = 0.661;

#[test]
fn an_undisturbed_rover_drives_its_path_in_about_the_planned_time_and_touches_nothing() {
    let execution = run(DETOUR, &[]);
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
    assert!(violations(&execution).is_empty());
    let [drive] = execution.drives.as_slice() else { panic!("one traverse is driven") };
    assert!(drive.min_clearance_m > 0.0, "{}", drive.min_clearance_m);
    let frames = &drive.vehicles[0].frames;
    assert!(distance(&frames[0].position_m, &Point2::new(116.0, 72.0)) < 0.01);
    let last = frames.last().expect("there are frames");
    assert!(distance(&last.position_m, &Point2::new(288.0, 72.0)) <= 0.2 + 1e-9, "{last:?}");
    // 173 m at 0.2 m/s are 14.4 minutes.
    assert!((14.3..16.5).contains(&duration(drive)), "{}", duration(drive));
    for pair in frames.windows(2) {
        let seconds = (pair[1].time - pair[0].time) * 60.0;
        let way = distance(&pair[0].position_m, &pair[1].position_m);
        assert!(way <= 0.2 * seconds + 0.01, "{way} m in {seconds} s");
    }
    let motion = &execution.plans[0].motions[0];
    let middle = &frames[frames.len() / 2];
    assert!(distance(&motion.at(middle.time).expect("it moves").0, &middle.position_m) < 0.05);
}

/// When an event happened.
fn time_of(execution: &Execution, event: &str) -> Option<f64> {
    execution.log.iter().find_map(|entry| match &entry.happening {
        Happening::Executed { name } if name == event => Some(minutes(entry.time)),
        _ => None,
    })
}

#[test]
fn vertices_guide_a_drive_and_only_what_the_mission_bounds_can_be_violated() {
    // The traverse begins at 10 and has [405,486] in a path that is open until 460: its end is within [415,460].
    let takes = |units: i64| {
        let activity = "Group-Traverse-Path#1".into();
        run(ENROUTE, &[Disturbance::Duration { activity, duration: units.into() }])
    };
    for units in [405, 406, 415, 430, 450] {
        let execution = takes(units);
        assert_eq!(violations(&execution), Vec::<&str>::new(), "{units}");
        assert_eq!(execution.ending, Ending::Finished, "{units}");
        let end = time_of(&execution, "Group-Traverse-Path#1.end").expect("it arrives");
        assert!((end - (10.0 + units as f64)).abs() < 1e-9, "{units}: {end}");
        let vertices = execution.log.iter().filter(
            |entry| matches!(&entry.happening, Happening::Executed { name } if name.contains(".vertex")),
        );
        assert!(vertices.clone().count() > 3, "they are passed all the same");
        assert!(vertices.into_iter().all(|entry| minutes(entry.time) <= end));
    }
    let late = takes(451);
    let [first, ..] = violations(&late)[..] else { panic!("the path is closed by then") };
    assert!(!first.contains("vertex"), "{first}");
    assert!(!violations(&takes(404)).is_empty(), "faster than the mission says");
}

#[test]
fn a_rock_that_appears_on_the_path_is_seen_and_passed() {
    let free = run(DETOUR, &[]);
    let rock = Point2::new(150.0, 70.4);
    let execution = run(DETOUR, &[obstacle(1, rock, 0.8)]);
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
    let drive = &execution.drives[0];
    let frames = &drive.vehicles[0].frames;
    let nearest = frames.iter().map(|frame| distance(&frame.position_m, &rock)).fold(f64::INFINITY, f64::min);
    assert!(nearest >= 0.8 + ATRV_M, "it touches the rock: {nearest}");
    assert!(nearest < 4.0, "the rock is beside the way: {nearest}");
    assert!(drive.min_clearance_m >= 0.0);
    assert!(duration(drive) >= duration(&free.drives[0]) - 0.1);
    let seen = frames.iter().flat_map(|frame| &frame.rays_m);
    let on_rock = seen.filter(|point| (distance(&point.cast::<f64>(), &rock) - 0.8).abs() < 0.1);
    assert!(on_rock.count() > 20, "the laser sees it");
}

#[test]
fn a_closed_gap_is_reported_and_another_way_taken_which_takes_longer() {
    let execution = run(DETOUR, &[obstacle(3, Point2::new(200.0, 68.0), 5.5)]);
    assert_eq!(execution.ending, Ending::Stopped, "GAP itself is covered: {:?}", execution.log.last());
    assert!(violations(&execution)[0].contains("Scout finds no path"), "{:?}", violations(&execution));
    // Beside the waypoint the same rock leaves it reachable, but only from one side.
    let behind = run(DETOUR, &[obstacle(3, Point2::new(214.0, 68.0), 6.0)]);
    assert_eq!(behind.ending, Ending::Finished, "{:?}", behind.log.last());
    assert!(
        progress(&behind).iter().any(|text| text.contains("takes another path")),
        "{:?}",
        behind.log.last()
    );
    assert!(behind.drives[0].reroutes >= 1 && behind.drives[0].min_clearance_m >= 0.0);
}

#[test]
fn what_a_rover_loses_by_standing_reaches_the_plan() {
    let free = run(DETOUR, &[]);
    let late = run(DETOUR, &[stand("Scout", 5, 15)]);
    let lost = duration(&late.drives[0]) - duration(&free.drives[0]);
    assert!((9.5..11.0).contains(&lost), "{lost} minutes");
    assert_eq!(late.ending, Ending::Finished);
    let end = late.log.last().expect("it ends").time;
    assert!(minutes(end) - minutes(free.log.last().expect("it ends").time) > 9.0);
    let tight = DETOUR.replace("Carry(GAP, LANDER)[10,60]", "Carry(GAP, LANDER)[10,20]");
    assert_ne!(tight, DETOUR);
    let violated = run(&tight, &[stand("Scout", 5, 15)]);
    assert!(violations(&violated)[0].contains("did not happen by"), "{:?}", violations(&violated));
    let is_replanned = |entry: &executive::Entry| matches!(entry.happening, Happening::Replanned { .. });
    assert!(
        violated.log.iter().any(is_replanned),
        "the plan is made anew with the time that it really takes"
    );
    assert_eq!(violated.ending, Ending::Finished);
    assert_eq!(duration(&violated.drives[0]), duration(&late.drives[0]));
}

#[test]
fn a_convoy_makes_good_what_it_lost_where_the_plan_leaves_time_and_fails_where_it_does_not() {
    let execution = run(ENROUTE, &[stand("Rover2", 100, 120)]);
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
    assert!(violations(&execution).is_empty());
    let drive = &execution.drives[0];
    assert!(drive.min_clearance_m >= 0.0, "{}", drive.min_clearance_m);
    // The traverse takes 405 minutes at least by its bounds, and about 253 at full speed.
    assert!(duration(drive) <= 406.0, "{}", duration(drive));
    let motions = &execution.plans[0].motions;
    for step in 0..4000 {
        let time = 10.0 + f64::from(step) * 0.1;
        let [leader, follower] = [0, 1].map(|index: usize| motions[index].at(time).expect("it moves").0);
        let apart = distance(&leader, &follower);
        assert!(apart > 0.661 + 0.515, "{apart} m apart at {time}");
        assert!(apart < 15.0, "{apart} m apart at {time}");
    }
    let lost = run(ENROUTE, &[stand("Rover1", 100, 320)]);
    assert_eq!(lost.ending, Ending::Stopped);
    assert!(!violations(&lost).is_empty());
}

#[test]
fn the_same_run_is_driven_the_same_way() {
    let disturbances = [obstacle(2, Point2::new(150.0, 70.4), 0.8), stand("Scout", 6, 7)];
    assert_eq!(run(DETOUR, &disturbances), run(DETOUR, &disturbances));
}

#[test]
fn a_blimp_flies_over_what_stands_on_the_ground() {
    let execution = run(
        "terrain \"tai-plain\" cell 0.6 origin (0, 0);
         location BASE (24, 52);
         location TAI (256, 238);
         obstacle Wall circle (140, 145, 20);
         vehicle Flyer : Blimp at BASE;
         primitive Fly(to)[1,60] moves Flyer speed (0.1, 4);
         scenario S[0,240] = { Fly(TAI) }",
        &[obstacle(0, Point2::new(80.0, 97.0), 5.0)],
    );
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
    assert!(violations(&execution).is_empty());
    let [drive] = execution.drives.as_slice() else { panic!("one flight") };
    assert_eq!(drive.reroutes, 0);
    assert!(
        drive.vehicles[0].frames.iter().all(|frame| frame.rays_m.is_empty()),
        "nothing is seen in the air"
    );
}

#[test]
fn a_rover_that_is_stopped_goes_on_by_the_other_path_from_where_it_is() {
    let execution = run(
        "terrain \"tai-plain\" cell 0.6 origin (0, 0);
         location BASE (24, 52);
         location RIM (120, 70);
         vehicle Scout : ATRV at BASE;
         primitive Drive(to)[5,40] moves Scout speed (0.02, 0.8) aborts [0.1,0.3];
         var PATH1 : {OK, GONE};
         var PATH2 : {OK, GONE};
         scenario S[0,800] = {
           { choose { do { Drive(RIM) } maintaining PATH1=OK, do { Drive(RIM) } maintaining PATH2=OK } },
           { PATH1=OK [300,300] },
           { delay [200,200]; PATH2=OK [300,300] }
         }",
        &[Disturbance::Withdrawn { condition: "Tell(PATH1=OK)#1".into(), at: 2.into() }],
    );
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
    let [first, second] = execution.drives.as_slice() else { panic!("two drives") };
    assert_eq!(first.duration, None);
    let stopped = first.vehicles[0].frames.last().expect("it set out").position_m;
    let start = second.vehicles[0].frames.first().expect("it set out").position_m;
    assert!(distance(&stopped, &Point2::new(24.0, 52.0)) > 10.0, "{stopped}");
    assert!(distance(&stopped, &start) < 0.01, "{stopped} and {start}");
    assert!(minutes(second.start) >= 200.0);
}

/// The rock lies where the driver passes the area, so that it would rather cross the area's edge.
#[test]
fn drivers_stay_out_of_areas_that_are_closed_to_them_and_cross_others() {
    let mission = |closed_to: &str| {
        format!(
            "location A (0, 0); location SITE (60, 0);
             vehicle R1 : ATRV at A;
             keepout Area circle (30, 0, 10){closed_to};
             primitive Drive(to)[0,100] moves R1 speed (0, 0.5);
             scenario S[0,100] = {{ Drive(SITE) }}"
        )
    };
    let nearest_m = |execution: &Execution| {
        assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log.last());
        let frames = execution.drives.iter().flat_map(|drive| &drive.vehicles).flat_map(|it| &it.frames);
        let away_m = frames.map(|frame| distance(&frame.position_m, &Point2::new(30.0, 0.0)) - 10.0);
        away_m.fold(f64::INFINITY, f64::min)
    };
    let planned = run(&mission(" for R1"), &[]);
    assert!(nearest_m(&planned) > ATRV_M, "{}", nearest_m(&planned));
    let frames = &planned.drives[0].vehicles[0].frames;
    let beside =
        frames.iter().min_by(|a, b| (a.position_m.x - 30.0).abs().total_cmp(&(b.position_m.x - 30.0).abs()));
    let rock = obstacle(0, beside.expect("it drove").position_m, 0.6);
    let around = run(&mission(" for Drive"), &[rock]);
    assert!(nearest_m(&around) > ATRV_M, "{}", nearest_m(&around));
    assert!(nearest_m(&run(&mission(" for Blimp"), &[])) < -9.0, "nothing stands there");
}

/// Two rovers that drive to one place over ground with rocks that their map does not show.
const TO_ONE_PLACE: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
location P0 (17, 27); location P1 (62, 26); location P2 (30, 67); location P4 (40, 49);
vehicle V0 : ATRV-Jr at P0; vehicle V1 : ATRV-Jr at P1;
primitive Drive(r, to)[0,200] moves r speed (0.005, 0.3);
scenario S[0,600] = { Drive(V0, P2), Drive(V1, P2) }";

/// Each is driven when it starts, without what the other one will do: one that leaves its path for a rock must not come to where
/// the other one has parked meanwhile.
#[test]
fn vehicles_that_leave_their_paths_do_not_touch_what_has_parked_meanwhile() {
    let mission = Mission::read(TO_ONE_PLACE);
    for seed in 0..12 {
        let execution = mission.executed(seed, &[]);
        assert!(violations(&execution).is_empty(), "seed {seed}: {:?}", violations(&execution));
    }
}

/// A blimp that follows a rover flies above the rocks, and neither is in the other's way.
#[test]
fn a_formation_of_a_rover_and_a_blimp_arrives_whoever_leads() {
    for [leader, follower] in [["ATRV", "Blimp"], ["Blimp", "ATRV"]] {
        let mission = Mission::read(&format!(
            "terrain \"tai-plain\" cell 0.6 origin (0, 0); location P0 (19, 23); location P1 (62, 35);
vehicle V0 : {leader} at P0; vehicle V1 : {follower} at P0;
primitive Duo(a, b, to)[0,200] moves a, b; scenario S[0,200] = {{ Duo(V0, V1, P1) }}"
        ));
        for seed in 0..6 {
            let execution = mission.executed(seed, &[]);
            let found = violations(&execution);
            assert!(found.is_empty(), "{leader} leads, seed {seed}: {found:?} {:?}", progress(&execution));
        }
    }
}
