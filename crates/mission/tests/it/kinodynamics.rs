//! Traverses that keep what their vehicles can do (SPEC 15): as planned, as reviewed, and as driven.

use crate::support::Mission;
use exact::Time;
use executive::{Ending, Script};
use mission::execution;
use mission::planning::Planned;
use motion::{DriveLimits, heading_difference, vehicle_model};

/// Around an obstacle, so that the way has corners.
fn source(clause: &str, bounds: &str) -> String {
    format!(
        "option time_unit = second;
        location WEST (10, 40); location EAST (60, 40); location NORTH (60, 80);
        terrain \"tai-plain\" cell 0.6 origin (0, 0);
        obstacle Wall circle (35, 40, 8);
        vehicle Rover : ATRV at WEST;
        primitive Drive(a, b){bounds} moves Rover speed (0, 0.6) {clause};
        scenario S[0,4000] = {{ Drive(EAST, NORTH) }}"
    )
}

fn plan(clause: &str, bounds: &str) -> Planned {
    let mission = Mission::read(&source(clause, bounds));
    mission.with_plan((kirk::Options::default(), 1), |_, planned, _, _| planned)
}

/// The least duration of the drive in seconds.
fn min_s(planned: &Planned) -> f64 {
    let plan = planned.planning.outcome.plans.first().expect("there is a plan");
    let drive = planned.network.occurrences.iter().find(|it| it.name == "Drive#1").expect("it drives");
    let earliest = |node: tpn::NodeId| plan.windows[node.index()].expect("selected").earliest;
    earliest(drive.end).checked_sub(earliest(drive.start)).map_or(0.0, Time::to_f64)
}

#[test]
fn a_kinodynamic_way_takes_as_long_as_turning_and_stopping_within_the_limits() {
    let (free, limited) = (plan("", ""), plan("kinodynamic", ""));
    assert_eq!(free.traverses[0].legs, limited.traverses[0].legs, "the way is the same");
    let path = snapshot::joined(&limited.traverses[0].legs);
    assert!(path.points_m.len() > 3, "it leads around the obstacle");
    let limits = DriveLimits::of(vehicle_model("ATRV").expect("it is known"));
    let slower = DriveLimits { speed_mps: 0.6, half_track_m: 0.0, ..limits };
    let first = path.points_m[1] - path.points_m[0];
    // Driven state by state, and facing the wrong way at first.
    let driven = motion::drive_path(&path, libm::atan2(first.y, first.x) + std::f64::consts::PI, &slower);
    let (planned_s, driven_s) = (min_s(&limited), driven.duration_s());
    assert!((driven_s - 0.001..driven_s + 2.0).contains(&planned_s), "{planned_s} s and {driven_s} s");
    let straight_s = path.length_m() / 0.6;
    assert!(planned_s > straight_s + 10.0, "{planned_s} s, and {straight_s} s without turning");
    assert!(min_s(&free) < straight_s + 2.0, "{} s", min_s(&free));
}

#[test]
fn a_way_that_has_no_time_for_its_turns_cannot_be_driven() {
    let between = f64::midpoint(min_s(&plan("", "")), min_s(&plan("kinodynamic", "")));
    let bounds = format!("[0,{}]", between.round());
    assert_eq!(plan("", &bounds).planning.outcome.plans.len(), 1);
    let none = plan("kinodynamic", &bounds);
    assert!(none.planning.outcome.plans.is_empty());
    assert_eq!(none.planning.undrivable.len(), 1, "{:?}", none.planning.outcome.failure);
}

#[test]
fn what_is_driven_keeps_the_limits_and_the_planned_time() {
    let mission = Mission::read(&source("kinodynamic", ""));
    mission.with_plan((kirk::Options::default(), 1), |problem, planned, grounds, paths| {
        let ran = execution::execute(problem, &planned, &Script::default(), grounds, paths);
        let ran = ran.expect("there is a plan").expect("its times fit");
        assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log.last());
        let frames = &ran.drives[0].vehicles[0].frames;
        let limits = DriveLimits::of(vehicle_model("ATRV").expect("it is known"));
        for pair in frames.windows(2) {
            let seconds = pair[1].time - pair[0].time;
            let turn = heading_difference(pair[0].heading_rad, pair[1].heading_rad).abs();
            assert!(turn <= limits.turn_rate_rps * seconds + 1e-6, "{turn} rad in {seconds} s");
            let change = (pair[1].speed_mps - pair[0].speed_mps).abs();
            assert!(change <= limits.acceleration_mps2 * seconds + 1e-6, "{change} m/s in {seconds} s");
            assert!(pair[1].speed_mps <= 0.6 + 1e-9, "{} m/s", pair[1].speed_mps);
        }
        let end = ran.outcome.log.iter().find_map(|entry| match &entry.happening {
            executive::Happening::Executed { name } if name == "Drive#1.end" => Some(entry.time.to_f64()),
            _ => None,
        });
        let planned_s = min_s(&planned);
        assert!(end.is_some_and(|end| end < 1.05 * planned_s), "{end:?} and {planned_s} s planned");
    });
}
