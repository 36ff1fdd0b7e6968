//! States and levels in simulation (SPEC 10, 11, 15): meters that are really driven count, and what the world changes is
//! followed from the text of a mission to the record of its run.

use exact::{Rational, Time};
use executive::{Disturbance, Ending, Happening, Script};
use mission::execution;
use mission::programs::Programs;
use nalgebra::distance;
use snapshot::Execution;
use snapshot::Goal;

use crate::support::Mission;

/// Executes a mission's plan.
fn run(source: &str, disturbances: &[Disturbance]) -> Execution {
    Mission::read(source).executed(1, disturbances)
}

fn record(execution: &Execution) -> Vec<(f64, String)> {
    let words = |entry: &executive::Entry| Some((entry.time.to_f64(), entry.happening.state_words()?));
    execution.log.iter().filter_map(words).collect()
}

fn reasons(execution: &Execution) -> Vec<&str> {
    execution
        .log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Violation { reason, .. } => Some(reason.as_str()),
            _ => None,
        })
        .collect()
}

fn changes(execution: &Execution) -> Vec<String> {
    let change = |entry: &executive::Entry| match &entry.happening {
        Happening::Replanned { changes } => Some(changes.join(", ")),
        _ => None,
    };
    execution.log.iter().filter_map(change).collect()
}

/// The last level that was written down.
fn last_level(execution: &Execution) -> f64 {
    let level = |entry: &executive::Entry| match &entry.happening {
        Happening::Level { level, .. } => Some(level.to_f64()),
        _ => None,
    };
    execution.log.iter().rev().find_map(level).expect("a level was written down")
}

fn driven_m(execution: &Execution) -> f64 {
    let tracks = execution.drives.iter().filter_map(|drive| drive.vehicles.first());
    let lengths = tracks.map(|vehicle| -> f64 {
        vehicle.frames.windows(2).map(|pair| distance(&pair[0].position_m, &pair[1].position_m)).sum()
    });
    lengths.sum()
}

/// Two drives of 58 and 45 m, for which a plan counts 110 m with what a driver needs, on a battery that is enough for 111 m,
/// with a charge where it is needed.
const ROVER: &str = "location BASE (10, 10); location A (60, 40); location B (100, 60);
    vehicle R1 : ATRV-Jr at BASE;
    resource Battery 0..200 = 111;
    primitive Drive(to) moves R1 speed (0.02, 0.5) consumes Battery 1 per metre;
    primitive Nap()[1,1];
    primitive Charge()[5,5] produces Battery 50;
    scenario Day[0,100] = { Drive(A); choose { Nap(), Charge() }; Drive(B) }";

fn boulder() -> Disturbance {
    Disturbance::Obstacle { at: Time::ZERO, x: 35.0, y: 25.0, radius: 14.0, low: false }
}

#[test]
fn meters_that_are_driven_are_taken_from_the_battery() {
    let execution = run(ROVER, &[]);
    assert_eq!((execution.ending, reasons(&execution)), (Ending::Finished, Vec::new()));
    let taken = 111.0 - last_level(&execution);
    let driven_m = driven_m(&execution);
    assert!((taken - driven_m).abs() < 0.01 * driven_m, "{taken} taken for {driven_m} m");
    let words: Vec<String> = record(&execution).into_iter().map(|(_, words)| words).collect();
    let places: Vec<&str> = words.iter().filter(|it| it.contains("R1.at")).map(String::as_str).collect();
    assert_eq!(
        places,
        ["Drive#1 changes R1.at", "R1.at=A by Drive#1", "Drive#2 changes R1.at", "R1.at=B by Drive#2"]
    );
}

#[test]
fn what_a_drive_gives_for_each_meter_is_there_when_it_ends() {
    let source = ROVER
        .replace("resource Battery 0..200 = 111", "resource Data 0..200 = 0")
        .replace("consumes Battery 1 per metre", "produces Data 1 per metre")
        .replace("primitive Charge()[5,5] produces Battery 50;", "")
        .replace("choose { Nap(), Charge() }", "Nap()");
    let execution = run(&source, &[]);
    assert_eq!((execution.ending, reasons(&execution)), (Ending::Finished, Vec::new()));
    let (given, driven_m) = (last_level(&execution), driven_m(&execution));
    assert!((given - driven_m).abs() < 0.01 * driven_m, "{given} given for {driven_m} m");
    let ends: Vec<Time> = execution
        .log
        .iter()
        .filter(|entry| matches!(&entry.happening, Happening::Executed { name } if name.starts_with("Drive#") && name.ends_with(".end")))
        .map(|entry| entry.time)
        .collect();
    let is_level = |entry: &&executive::Entry| matches!(entry.happening, Happening::Level { .. });
    let mut levels = execution.log.iter().filter(is_level);
    assert!(levels.clone().count() >= 2 && levels.all(|entry| ends.contains(&entry.time)), "{ends:?}");
}

#[test]
fn a_detour_that_takes_too_much_of_the_battery_makes_the_rover_charge() {
    let execution = run(ROVER, &[boulder()]);
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log);
    let [reason] = reasons(&execution).try_into().expect("the plan is broken once");
    assert!(reason.starts_with("Drive#2 needs 41.775 to 48.011 of Battery"), "{reason}");
    assert!(
        reason.contains(", below 0: Battery is at ") && reason.contains("for Drive#1 has driven "),
        "{reason}"
    );
    assert_eq!(changes(&execution), ["D1 takes Charge#1 instead of Nap#1"]);
    let taken = 111.0 + 50.0 - last_level(&execution);
    let driven_m = driven_m(&execution);
    assert!((taken - driven_m).abs() < 0.01 * driven_m, "{taken} taken for {driven_m} m");
}

#[test]
fn a_detour_that_leaves_too_little_stops_a_rover_that_cannot_charge() {
    let source = ROVER.replace("choose { Nap(), Charge() }", "Nap()");
    let execution = run(&source, &[boulder()]);
    assert_eq!(execution.ending, Ending::Stopped);
    let stop = execution.log.last().expect("it stopped");
    let Happening::Stopped { reason } = &stop.happening else { panic!("{stop:?}") };
    assert!(reason.starts_with("no plan from here: ") && reason.contains("Battery"), "{reason}");
    let drives = execution.drives.len();
    assert_eq!(drives, 1, "it does not set out on what it cannot finish");
}

#[test]
fn what_the_world_changes_is_in_the_record_and_not_in_the_networks_that_are_shown() {
    let source =
        ROVER.replace("choose { Nap(), Charge() }", "Deploy(); delay[5,50]; choose { Dig(), Nap() }");
    let source = format!(
        "state ARM : {{IN, OUT}} = IN; primitive Deploy()[2,2] sets ARM=OUT; primitive Dig()[4,4] requires ARM=OUT; {source}"
    );
    let state = Disturbance::State { variable: "ARM".into(), value: "IN".into(), at: 6.into() };
    let level = Disturbance::Level { resource: "Battery".into(), level: Rational::from(150), at: 7.into() };
    let execution = run(&source, &[level, state]);
    assert_eq!(execution.ending, Ending::Finished, "{:?}", execution.log);
    assert_eq!(changes(&execution), ["D1 takes Nap#1 instead of Dig#1"]);
    let words: Vec<(f64, String)> = record(&execution);
    assert!(words.contains(&(6.0, "ARM=IN by the world".to_owned())), "{words:?}");
    assert!(words.contains(&(7.0, "Battery=150 by the world".to_owned())), "{words:?}");
    assert_eq!(execution.plans.len(), 2);
    for executed in &execution.plans {
        let (network, plan) = (&executed.network, &executed.plan);
        let names: Vec<&str> = network.occurrences.iter().map(|it| it.name.as_str()).collect();
        assert!(names.iter().all(|name| !name.starts_with("the-world")), "{names:?}");
        assert_eq!(network.nodes.len(), plan.selected_nodes.len());
        assert_eq!(network.nodes.len(), executed.times.len());
        assert_eq!(network.arcs.len(), plan.selected_arcs.len());
        assert!(network.arcs.iter().all(|arc| arc.to != network.start));
    }
}

#[test]
fn disturbances_of_what_the_mission_does_not_have_are_refused() {
    let source = "state ARM : {IN, OUT} = IN; var LIGHT : {ON}; resource Battery 0..100 = 50; resource Power capacity 2;
        location BASE (0, 0); location A (5, 5); vehicle R1 : ATRV-Jr at BASE;
        primitive Drive(to)[1,90] moves R1 consumes Battery 10 uses Power;
        primitive Dig()[5,5] sets ARM=OUT requires LIGHT=ON;
        scenario Day[0,200] = { { Drive(A); Dig() }, LIGHT=ON [200,200] }";
    let parse = rmpl::parse(source);
    let program = parse.program();
    let mut diagnostics = parse.diagnostics();
    let network = mission::compile(&program, &Goal::Default, &mut diagnostics).expect("it compiles");
    let (programs, _) = Programs::compile(&program, Some(&network));
    let answer = |json: &str| {
        let script: Script = serde_json::from_str(&format!("{{\"disturbances\": [{json}]}}"))
            .map_err(|error| error.to_string())?;
        execution::check_script(&network, &program, &programs, &script)
    };
    let state = |variable: &str, value: &str, at: &str| {
        answer(&format!(
            "{{\"kind\": \"state\", \"variable\": \"{variable}\", \"value\": \"{value}\", \"at\": {at}}}"
        ))
    };
    let level = |resource: &str, level: &str| {
        answer(&format!(
            "{{\"kind\": \"level\", \"resource\": \"{resource}\", \"level\": {level}, \"at\": 3}}"
        ))
    };
    assert_eq!(state("ARM", "OUT", "2.5"), Ok(()));
    assert_eq!(level("Battery", "100"), Ok(()));
    let refused = [
        (state("ARM", "SIDEWAYS", "2"), "ARM cannot be SIDEWAYS: use one of IN, OUT"),
        (state("LEG", "IN", "2"), "the mission does not use the variable LEG"),
        (
            state("LIGHT", "ON", "2"),
            "LIGHT has a value only while it is asserted: withdraw an assertion instead",
        ),
        (state("R1.at", "A", "2"), "R1.at is the place of a vehicle, so only driving changes it"),
        (level("Battery", "100.5"), "the level of Battery must be from 0 to 100"),
        (level("Battery", "-1"), "the level of Battery must be from 0 to 100"),
        (level("Power", "1"), "Power has a capacity, not a level"),
        (level("Fuel", "1"), "the mission does not use the resource Fuel"),
    ];
    for (answer, expected) in refused {
        assert_eq!(answer, Err(expected.to_owned()));
    }
    let early = state("ARM", "OUT", "-1").expect_err("nothing happens before the start");
    assert!(
        early.contains("disturbance 1: a disturbance cannot happen before the mission starts, at 0"),
        "{early}"
    );
}
#[test]
fn what_a_path_takes_makes_room_for_a_charge() {
    let source =
        ROVER.replace("0..200 = 111", "0..200 = 200").replace("choose { Nap(), Charge() }", "Charge()");
    let execution = run(&source, &[]);
    assert_eq!((execution.ending, reasons(&execution)), (Ending::Finished, Vec::new()));
    // Without a drive before it there is none.
    let source = ROVER
        .replace("0..200 = 111", "0..200 = 200")
        .replace("Drive(A); choose { Nap(), Charge() }; Drive(B)", "Charge(); delay[1,1]; Drive(A)");
    assert!(std::panic::catch_unwind(|| run(&source, &[])).is_err(), "it charges a battery that is full");
}
