//! What a plan promises of its drives is what undisturbed runs do: pace, places, meters, and room between vehicles.

use exact::{Rational, Time};
use executive::{Disturbance, Ending, Happening, Script};
use kirk::Options;
use mission::execution;
use mission::planning::Planned;
use nalgebra::distance;
use snapshot::Execution;

use crate::support::Mission;

const SLOW: &str = "location BASE (0, 0); location ROCK (18, 0); vehicle Rover : ATRV at BASE;
    primitive Drive(to)[20,25] moves Rover; scenario Sol[0,60] = { Drive(ROCK) }";

const CROSSING: &str = "terrain \"tai-plain\" cell 0.6 origin (0, 0);
    location A (24, 52); location B (60, 56); location C (44, 40); location D (44, 70);
    vehicle Alpha : ATRV at A; vehicle Delta : ATRV at C;
    primitive Drive(r, to) contingent [2,30] moves r speed (0.01, 0.5);
    scenario S[0,100] = { { Drive(Alpha, B) }, { delay[1.3,1.3]; Drive(Delta, D) } }";

fn planned(source: &str, seed: u64) -> Planned {
    Mission::read(source).with_plan((Options::default(), seed), |_, planned, _, _| planned)
}

fn executed(source: &str, seed: u64) -> Execution {
    Mission::read(source).executed(seed, &[])
}

fn violations(execution: &Execution) -> Vec<&str> {
    let found = execution.log.iter().filter_map(|entry| match &entry.happening {
        Happening::Violation { reason, .. } => Some(reason.as_str()),
        _ => None,
    });
    found.collect()
}

#[test]
fn a_drive_with_much_time_is_not_given_up() {
    for seed in 0..10 {
        let execution = executed(SLOW, seed);
        assert_eq!((execution.ending, violations(&execution)), (Ending::Finished, Vec::new()), "seed {seed}");
        assert_eq!(execution.drives[0].reroutes, 0, "seed {seed}: nothing stands in its way");
    }
    // So much slower that a vehicle that decided as often as at its greatest speed would never be there.
    let slower = SLOW.replace("[20,25]", "[900,960]").replace("[0,60]", "[0,1000]");
    assert_eq!(executed(&slower, 1).ending, Ending::Finished);
}

#[test]
fn who_is_there_already_takes_no_time() {
    for base in ["(0, 0)", "(30, -12)"] {
        let source = format!(
            "location BASE {base}; location ROCK (18, 0); vehicle Rover : ATRV at BASE;
            primitive Drive(to)[0,60] moves Rover;
            scenario Sol[0,60] = {{ Drive(BASE), Drive(BASE); Drive(ROCK); Drive(ROCK) }}"
        );
        for seed in 0..3 {
            let execution = executed(&source, seed);
            assert_eq!(
                (execution.ending, violations(&execution)),
                (Ending::Finished, Vec::new()),
                "BASE {base}, seed {seed}"
            );
            assert_eq!(execution.drives.len(), 1, "only one of them goes anywhere");
        }
    }
}

#[test]
fn a_vehicle_that_stops_beside_its_goal_says_so() {
    let source = "location A (0, 0); location B (40, 0); vehicle Alpha : ATRV at A; vehicle Beta : ATRV at B;
        primitive Drive(r, to)[1,30] moves r speed (0.01, 0.5); scenario S[0,100] = { Drive(Alpha, B) }";
    let execution = executed(source, 0);
    let short = execution.log.iter().find_map(|entry| match &entry.happening {
        Happening::Progress { text, .. } if text.contains("short of B, where Beta is parked") => Some(text),
        _ => None,
    });
    assert!(short.is_some(), "{:?}", execution.log);
    let alone = executed(&source.replace("vehicle Beta : ATRV at B;", ""), 0);
    let is_short = |entry: &executive::Entry| matches!(&entry.happening, Happening::Progress { text, .. } if text.contains("short of"));
    assert!(!alone.log.iter().any(is_short), "{:?}", alone.log);
}

#[test]
fn paths_that_cross_are_reported_with_a_schedule_in_which_their_vehicles_meet() {
    let found = planned(CROSSING, 0);
    let [violation] = found.separation_violations.as_slice() else {
        panic!("{:?}", found.separation_violations)
    };
    assert_eq!(violation.vehicles, [0, 1]);
    assert!(violation.distance_m < violation.min_m);
    let crossing = nalgebra::Point2::new(44.0, 54.0);
    assert!(distance(&violation.position_m, &crossing) < 5.0, "{}", violation.position_m);
    // The other one sets out when the first is long past, whatever nature chooses: 2 to 30 min, and 31 min later.
    let late = planned(&CROSSING.replace("delay[1.3,1.3]", "delay[31,31]"), 0);
    assert_eq!(late.separation_violations, []);
    // In the earliest schedule they do not meet; where the first one takes longer, they do.
    let possible = planned(&CROSSING.replace("delay[1.3,1.3]", "delay[8,8]"), 0);
    let [violation] = possible.separation_violations.as_slice() else {
        panic!("{:?}", possible.separation_violations)
    };
    assert_eq!(violation.schedule.len(), 2, "{violation:?}");
    for times in &violation.schedule {
        let lasts = times.end - times.start;
        assert!((2.0 - 1e-6..=30.0 + 1e-6).contains(&lasts), "{violation:?}");
    }
}

#[test]
fn paths_that_cross_are_put_in_an_order_where_there_is_time() {
    let source = CROSSING.replace("delay[1.3,1.3]", "delay");
    let found = planned(&source, 0);
    assert_eq!(found.separation_violations, []);
    for seed in 0..10 {
        assert_eq!(executed(&source, seed).ending, Ending::Finished, "seed {seed}");
    }
}

/// Alpha passes where Delta stands, and Delta then drives before it along the same line.
const OVERTAKING: &str = "
terrain \"tai-plain\" cell 0.6 origin (0, 0);
location A (24, 52); location B (75, 52); location C (40, 52); location D (72, 52);
vehicle Alpha : ATRV at A; vehicle Delta : ATRV at C;
primitive Drive(r, to) contingent [2,30] moves r speed (0.01, 0.5);
scenario S[0,100] = { { Drive(Alpha, B) }, { delay[0.6,0.6]; Drive(Delta, D) } }";

#[test]
fn a_vehicle_lets_pass_the_one_that_set_out_first() {
    for seed in 0..10 {
        let execution = executed(CROSSING, seed);
        assert_eq!(execution.ending, Ending::Finished, "seed {seed}: {:?}", violations(&execution));
    }
}

/// Alpha and Delta stand too near each other from the beginning.
const TOO_NEAR: &str = "
terrain \"tai-plain\" cell 0.6 origin (0, 0);
location A (24, 52); location B (75, 52); location C (24.8, 52); location D (72, 52);
vehicle Alpha : ATRV at A; vehicle Delta : ATRV at C;
primitive Drive(r, to)[2,30] moves r speed (0.01, 0.5);
scenario S[0,100] = { { Drive(Alpha, B) }, { delay[0.6,0.6]; Drive(Delta, D) } }";

#[test]
fn vehicles_that_touch_end_the_run() {
    let mut touched = 0;
    for (source, seed) in [(OVERTAKING, 0..10), (TOO_NEAR, 0..2)]
        .into_iter()
        .flat_map(|(source, seeds)| seeds.map(move |seed| (source, seed)))
    {
        let execution = executed(source, seed);
        let place = |vehicle: u32, time: f64| {
            let drives = execution.drives.iter().flat_map(|drive| &drive.vehicles);
            drives.filter(|it| it.vehicle == vehicle).find_map(|it| Some(it.at(time)?.position_m))
        };
        let end = execution.end().to_f64();
        let nearest = (0..=2000)
            .filter_map(|step| {
                let time = end * f64::from(step) / 2000.0;
                Some(distance(&place(0, time)?, &place(1, time)?))
            })
            .fold(f64::INFINITY, f64::min);
        let tells = execution.log.iter().any(|entry| {
            matches!(&entry.happening, Happening::Violation { reason, is_contact: true, .. }
                if reason.contains("Alpha and Delta touch"))
        });
        assert_eq!(tells, execution.ending == Ending::Stopped, "seed {seed}: {:?}", violations(&execution));
        // Frames are up to a meter apart.
        assert!(tells || nearest > 1.3, "seed {seed}: {nearest} m apart");
        touched += usize::from(tells);
    }
    assert!(touched > 0, "none of these runs tells anything");
}

#[test]
fn a_battery_that_is_just_enough_for_the_path_is_not_enough_for_a_driver() {
    let source = |level: f64| {
        format!(
            "location CAMP (0, 0); location LEDGE (36, 4); location OUTCROP (60, 12);
            vehicle Rover : ATRV at CAMP; resource Battery 0..100 = {level:.3};
            primitive Drive(to)[5,60] moves Rover speed (0.01, 0.3) consumes Battery 1 per metre;
            scenario S[0,400] = {{ Drive(LEDGE); delay; Drive(OUTCROP) }}"
        )
    };
    let ample = planned(&source(100.0), 0);
    assert!(ample.warnings.is_empty(), "meters count on flat ground, too: {:?}", ample.warnings);
    let length_m = ample.planning.outcome.plans[0].quality.length_m;
    assert!(planned(&source(length_m + 0.05), 0).planning.outcome.plans.is_empty());
    for level in [length_m + 6.0, length_m + 8.0] {
        for seed in 0..5 {
            let execution = executed(&source(level), seed);
            assert_eq!(execution.ending, Ending::Finished, "seed {seed}: {:?}", violations(&execution));
        }
    }
}

#[test]
fn clearance_is_that_of_all_vehicles_of_a_formation() {
    let source = |vehicles: &str| {
        format!(
            "location A (0, 0); location B (60, 0); obstacle ROCK circle (30, 4, 1.5); obstacle LOW circle (30, -4, 1.5);
            vehicle R1 : ATRV at A; vehicle R2 : ATRV at A; vehicle R3 : ATRV at A;
            primitive Drive(to)[1,60] moves {vehicles} speed (0.01, 0.5); scenario S[0,100] = {{ Drive(B) }}"
        )
    };
    let clearance_m = |vehicles: &str| planned(&source(vehicles), 0).traverses[0].clearance_m;
    let (alone_m, together_m) = (clearance_m("R1"), clearance_m("R1, R2, R3"));
    assert!(together_m < alone_m - 0.2, "{together_m} m with followers beside the path, {alone_m} m without");
    let run = |vehicles: &str| {
        Mission::read(&source(vehicles)).with_plan(
            (Options::default(), 0),
            |problem, planned, grounds, paths| {
                let ran = execution::execute(problem, &planned, &Script::default(), grounds, paths);
                ran.expect("there is a plan").expect("its times fit").drives
            },
        )
    };
    let drives = run("R1, R2, R3");
    assert!(drives[0].min_clearance_m > together_m - 0.5, "{} m", drives[0].min_clearance_m);
}

#[test]
fn who_is_there_early_waits_for_what_its_next_step_follows() {
    let source = "location A (0, 0); location B (60, 0); location C (0, 40); location D (30, 40);
        vehicle V0 : ATRV at A; vehicle V1 : ATRV at C; state Arm : {IN, OUT} = IN;
        primitive Drive(r, to)[0,200] moves r speed (0.02, 0.5) requires Arm=IN;
        primitive Stretch()[1,3] sets Arm=OUT; primitive Look() contingent [2,6];
        scenario S[0,300] = { Drive(V0, B), { Drive(V1, D); Stretch() }, LOOK }";
    // With and without a duration that the environment chooses, plans are dispatched in different ways.
    for look in ["delay", "{ Look(); delay }"] {
        for seed in 0..4 {
            let execution = executed(&source.replace("LOOK", look), seed);
            let outcome = (execution.ending, violations(&execution));
            assert_eq!(outcome, (Ending::Finished, Vec::new()), "{look}, seed {seed}");
        }
    }
}

/// The last scout digs while the others visit a place in sequence, and has to be back for its own turn.
const TURNS: &str = "
location P0 (17, 25);
location P3 (69, 62);
location P4 (41, 43);
model Scout { resource battery 0..100 = 78; resource arm; state drill : {STOWED, OUT} = STOWED; }
vehicle S[1..4] : Scout at P0;
primitive Drive(r : vehicle, to : location)[0,200] moves r  requires r.drill = STOWED consumes r.battery 0.1 per metre;
primitive Drill(r : Scout, at : location)[2,6] requires r.at = at sets r.drill = OUT uses r.arm consumes r.battery 6 rewards 5;
primitive Stow(r : Scout)[1,2] sets r.drill = STOWED;
primitive Shoot(r : Scout, at : location)[1,3] requires r.at = at, r.drill = STOWED uses r.arm rewards 3;
primitive Sun(r : vehicle)[3,20] produces r.battery 1.5 per minute;
objective minimize end;
Visit(r, site) = { Drive(r, site); Shoot(r, site) }
Dig(r, site) = { Drive(r, site); Drill(r, site); Stow(r) }
scenario M[0,200] = { each r in S in sequence { Visit(r, P4) }, { delay; delay; Sun(S[4]); delay; Dig(S[4], P3) } }";

/// Events that would leave a vehicle under way no time to arrive wait for it, as long as they can.
#[test]
fn a_vehicle_that_needs_longer_than_its_path_is_waited_for() {
    for seed in 0..5 {
        let execution = executed(TURNS, seed);
        assert_eq!(execution.ending, Ending::Finished, "seed {seed}: {:?}", violations(&execution));
    }
}

/// What the environment ends as soon as it may is no longer a way to wait for a vehicle.
#[test]
fn what_ends_when_it_will_starts_so_late_that_who_is_under_way_arrives() {
    let source = "location P0 (20, 26); location P1 (60, 28); location P3 (72, 66); location P4 (41, 52);
        vehicle V0 : ATRV-Jr at P0; vehicle V1 : ATRV-Jr at P1;
        primitive Drive(r, to)[0,200] moves r speed (0.05, 0.3); primitive Walk() contingent [1,6];
        scenario S[0,60] = { Drive(V0, P3), { delay; Walk(); Drive(V1, P4) } }";
    let nature = [("Walk#1".into(), Time::from(1))].into_iter().collect();
    let script = Script { nature, ..Script::default() };
    for seed in 0..4 {
        let execution = Mission::read(source).with_plan(
            (Options::default(), seed),
            |problem, planned, grounds, paths| {
                execution::execute(problem, &planned, &script, grounds, paths)
                    .expect("a plan")
                    .expect("times fit")
            },
        );
        let log = &execution.outcome.log;
        let is_late = log.iter().any(|entry| matches!(entry.happening, Happening::Violation { .. }));
        assert!(!is_late && execution.outcome.ending == Ending::Finished, "seed {seed}: {log:?}");
    }
}

/// The least speed of a vehicle that may not stop says how long it takes at most, so it sets out only when that is in time.
#[test]
fn a_vehicle_that_may_not_stop_sets_out_no_sooner_than_it_has_to() {
    let source = "location A (0, 0); location B (30, 0); vehicle Rover : ATRV at A; resource Link;
        primitive Drive(to)[0,200] moves Rover speed (0.1, 0.5); primitive Walk() contingent [2,6];
        primitive Hold()[10,10] uses Link; primitive Look()[1,2] uses Link;
        scenario S[0,300] = { { delay; Drive(B); Look() }, Hold(), WALK }";
    for walk in ["delay", "{ Walk(); delay }"] {
        let source = source.replace("WALK", walk);
        let execution = executed(&source, 0);
        assert_eq!((execution.ending, violations(&execution)), (Ending::Finished, Vec::new()), "{walk}");
        let time = |event: &str| {
            let is_it =
                |happening: &Happening| matches!(happening, Happening::Executed { name } if name == event);
            execution.log.iter().find(|entry| is_it(&entry.happening)).expect(event).time.to_f64()
        };
        assert!(time("Drive#1.end") - time("Drive#1.start") <= 5.0, "30 m at 0.1 m/s: {:?}", execution.log);
        // What slows it down is not its plan's fault, and no other bound is at stake.
        let slow = Disturbance::VehicleSlow {
            vehicle: "Rover".into(),
            factor: Rational::new(3, 16).expect("a share"),
            from: Time::ZERO,
            until: Time::from(100),
        };
        let execution = Mission::read(&source).executed(0, &[slow]);
        assert_eq!((execution.ending, violations(&execution)), (Ending::Finished, Vec::new()), "{walk}");
        assert!(execution.drives[0].duration.is_some_and(|duration| duration > Time::from(5)));
    }
}

/// Both go around a rock that they saw before. On the same side of it they would meet.
#[test]
fn who_takes_another_path_keeps_out_of_the_way_of_others() {
    let source = "terrain \"tai-plain\" cell 0.6 origin (0, 0); location P0 (20, 22); location P1 (58, 34);
        location P5 (60, 81); vehicle V0 : ATRV at P0; vehicle V1 : ATRV at P1; resource Link;
        primitive Drive(r, to)[0,200] moves r speed (0.1, 0.4) kinodynamic;
        primitive Slow(r, to) contingent [4,24] moves r speed (0.1, 0.4) kinodynamic;
        primitive Look(r, at) contingent [2,9] requires r.at=at uses Link;
        scenario S[0,200] = { { delay[1,4]; Drive(V0, P5); delay[0,5]; Slow(V0, P0); delay[0,5]; delay; Drive(V0, P0);
          delay[0,2]; Look(V0, P0) }, { delay; Drive(V1, P0); delay; Look(V1, P0); delay[0,5]; Drive(V1, P5); delay;
          Look(V1, P5) } }";
    let nature = [("Slow#1", 4), ("Look#1", 2), ("Look#2", 2), ("Look#3", 2)];
    let nature = nature.map(|(name, time)| (name.into(), Time::from(time))).into_iter().collect();
    let script = Script { nature, ..Script::default() };
    let ran = Mission::read(source).with_plan((Options::default(), 0), |problem, planned, grounds, paths| {
        execution::execute(problem, &planned, &script, grounds, paths).expect("a plan").expect("times fit")
    });
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
}
