//! Cooperative exploration, from the text to the end of the run: vehicles that drive, a blimp that flies, a map that they
//! share, and a path that is closed while they are on it.

use executive::{Disturbance, Ending, Happening};
use mission::sampling::Sampler;
use snapshot::Execution;
use snapshot::{RobustnessSettings, Tally, Uncertainty};

use crate::support::Mission;

const EXPLORATION: &str = include_str!("../../../../assets/missions/exploration.rmpl");

/// Executes a mission's plan, with vehicles that drive.
fn run(source: &str, disturbances: &[Disturbance]) -> Execution {
    Mission::read(source).executed(0, disturbances)
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

/// Returns what the run tells of an activity on its way.
fn told<'a>(execution: &'a Execution, activity: &str) -> Vec<&'a str> {
    let text = |entry: &'a executive::Entry| match &entry.happening {
        Happening::Progress { name, text } if name == activity => Some(text.as_str()),
        _ => None,
    };
    execution.log.iter().filter_map(text).collect()
}

/// The last value of a state.
fn value<'a>(execution: &'a Execution, state: &str) -> Option<&'a str> {
    let given = |entry: &'a executive::Entry| match &entry.happening {
        Happening::State { variable, value, .. } if variable == state => value.as_deref(),
        _ => None,
    };
    execution.log.iter().filter_map(given).next_back()
}

fn closed_at(at: i64) -> Disturbance {
    Disturbance::Withdrawn { condition: "Tell(PATH1=OK)#1".into(), at: at.into() }
}

#[test]
fn rovers_and_a_blimp_explore_from_the_base_to_the_last_report() {
    let ran = run(EXPLORATION, &[]);
    assert_eq!(ran.ending, Ending::Finished, "{:?}", ran.log.last());
    assert_eq!(violations(&ran), Vec::<&str>::new());
    assert_eq!([value(&ran, "RIDGE-IS"), value(&ran, "SHELF-IS")], [Some("ANALYZED"); 2]);
    // All five drives and three flights were simulated, to their ends.
    assert_eq!(ran.drives.len(), 8);
    assert!(ran.drives.iter().all(|drive| drive.duration.is_some()));
    let flights = ran.drives.iter().filter(|drive| drive.vehicles[0].vehicle == 3);
    let flown: Vec<f64> = flights.map(|drive| drive.min_clearance_m).collect();
    assert_eq!(flown, [f64::INFINITY; 3], "nothing stands as high as a blimp flies");
}

#[test]
fn a_path_that_is_closed_at_100_while_rovers_are_on_it_is_left_for_the_other() {
    let ran = run(EXPLORATION, &[closed_at(100)]);
    assert_eq!(ran.ending, Ending::Finished, "{:?}", ran.log.last());
    assert_eq!(violations(&ran), ["Tell(PATH1=OK)#1 was withdrawn at 100, but the plan needs it until 260"]);
    assert!(told(&ran, "Group-Traverse-Path#1").iter().any(|text| text.starts_with("is being ended early")));
    assert_eq!([value(&ran, "RIDGE-IS"), value(&ran, "SHELF-IS")], [Some("ANALYZED"); 2]);
    let named = |name: &str| {
        ran.log
            .iter()
            .any(|entry| matches!(&entry.happening, Happening::Executed { name: event } if event == name))
    };
    assert!(named("Group-Traverse-Path#2.end") && !named("Group-Traverse-Path#1.end"));
}

/// Wherever the rovers are then: they turn around without blocking each other.
#[test]
fn rovers_turn_back_wherever_they_are_when_their_path_is_closed() {
    for at in [30, 245] {
        let ran = run(EXPLORATION, &[closed_at(at)]);
        assert_eq!(ran.ending, Ending::Finished, "{at}: {:?}", ran.log.last());
    }
}

#[test]
fn exploration_reaches_its_end_in_every_run_with_chance() {
    let mission = Mission::read(EXPLORATION);
    mission.with_plan((kirk::Options::default(), 0), |problem, planned, grounds, paths| {
        let settings = RobustnessSettings { runs: 20, seed: 1, uncertainty: Uncertainty::default() };
        let sampler = Sampler::new(problem, &planned, &settings.uncertainty);
        let sampler = sampler.expect("there is a plan").expect("its times fit");
        let mut tally = Tally::default();
        for number in 0..settings.runs {
            sampler.run(problem, &settings, number, grounds, paths, &mut tally).expect("its times fit");
        }
        assert_eq!(tally.succeeded, 20, "{:?}", tally.breaks);
    });
}

/// SPEC 15: the first rover meets what the map does not show; the second comes later by the same way, and never meets it.
#[test]
fn what_one_rover_has_met_another_one_drives_around() {
    let source = "option time_unit = second;
        terrain \"tai-plain\" cell 0.6 origin (0, 0);
        location WEST (20, 40); location NORTH (20, 52); location EAST (90, 40);
        vehicle First : ATRV-Jr at WEST; vehicle Second : ATRV-Jr at NORTH;
        primitive Drive(rover, to)[100,2000] moves rover speed (0.02, 0.4);
        primitive Tell-What-Was-Seen()[1,2];
        scenario S[0,4000] = { Drive(First, EAST); Tell-What-Was-Seen(); Drive(Second, WEST); Drive(Second, EAST) }";
    let wall =
        |north: f64| Disturbance::Obstacle { at: 0.into(), x: 55.0, y: north, radius: 4.0, low: false };
    let ran = run(source, &[wall(36.0), wall(40.0), wall(44.0)]);
    assert_eq!(ran.ending, Ending::Finished, "{:?}", ran.log.last());
    // The first one is at EAST, so that the second stops beside it.
    let told = told(&ran, "Drive#3");
    let [around, beside] = told.as_slice() else { panic!("{told:?}") };
    assert!(around.contains("around an obstacle that was seen before"), "{around}");
    assert!(beside.contains("short of EAST, where First is parked"), "{beside}");
    // It is where the first one was, and not as near to it.
    let nearest_m = |drive: usize| {
        let frames = &ran.drives[drive].vehicles[0].frames;
        let away = frames.iter().map(|frame| {
            let from =
                |north: f64| nalgebra::distance(&frame.position_m, &nalgebra::Point2::new(55.0, north));
            [36.0, 40.0, 44.0].map(from).into_iter().fold(f64::INFINITY, f64::min) - 4.0
        });
        away.fold(f64::INFINITY, f64::min)
    };
    assert!(nearest_m(2) > 0.515, "it touches nothing: {} m", nearest_m(2));
    assert_eq!(ran.drives[2].reroutes, 0);
    let frames = |drive: usize| ran.drives[drive].vehicles[0].frames.len();
    assert!(frames(2) > 50, "{} frames", frames(2));
    let strayed = |drive: usize| ran.drives[drive].reroutes;
    assert!(
        strayed(0) > 0 || nearest_m(0) < nearest_m(2),
        "the first one met it: {} and {} m",
        nearest_m(0),
        nearest_m(2)
    );
}

/// What lies below the plane of range finders only sonars hear: it is driven around, and continues the shared map.
#[test]
fn what_only_sonars_hear_is_driven_around_and_shared() {
    let source = "option time_unit = second;
        terrain \"tai-plain\" cell 0.6 origin (0, 0);
        location WEST (20, 40); location NORTH (20, 52); location EAST (90, 40);
        vehicle First : ATRV-Jr at WEST; vehicle Second : ATRV-Jr at NORTH;
        primitive Drive(rover, to)[100,2000] moves rover speed (0.02, 0.4);
        scenario S[0,4000] = { Drive(First, EAST); Drive(Second, WEST); Drive(Second, EAST) }";
    let place = nalgebra::Point2::new(55.0, 40.0);
    let slab = |low: bool| Disturbance::Obstacle { at: 0.into(), x: place.x, y: place.y, radius: 1.5, low };
    let ran = run(source, &[slab(true)]);
    assert_eq!(ran.ending, Ending::Finished, "{:?}", ran.log.last());
    for drive in &ran.drives {
        assert!(
            drive.min_clearance_m > 0.0,
            "{} touches it: {} m",
            drive.occurrence.index(),
            drive.min_clearance_m
        );
    }
    let rays = ran.drives[0].vehicles[0].frames.iter().flat_map(|frame| &frame.rays_m);
    let on_slab = |ray: &&nalgebra::Point2<f32>| nalgebra::distance(&ray.cast::<f64>(), &place) < 1.7;
    assert_eq!(rays.filter(on_slab).count(), 0, "no range finder has seen it");
    let around = told(&ran, "Drive#3");
    assert!(around.iter().any(|text| text.contains("around an obstacle that was seen before")), "{around:?}");
    // One that stands higher is seen.
    let ran = run(source, &[slab(false)]);
    let rays = ran.drives[0].vehicles[0].frames.iter().flat_map(|frame| &frame.rays_m);
    assert!(rays.filter(on_slab).count() > 0);
}
