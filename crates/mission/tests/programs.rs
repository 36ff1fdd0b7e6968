//! Activities that run control programs, from text to the end of the run.

use std::sync::Arc;

use exact::Time;
use executive::{Disturbance, Ending, Happening, Script};
use mission::execution::{self, Ran};
use mission::planning::{self, Problem};
use mission::{Goal, Grounds, Paths};
use tpn::Network;

const ORBIT: &str = include_str!("../../../assets/missions/orbit.rmpl");

fn diagnostics(source: &str) -> Vec<String> {
    let parse = rmpl::parse(source);
    let mut found = parse.diagnostics();
    mission::compile(&parse.program(), &Goal::Default, &mut found);
    found.iter().map(|found| format!("{} {}", found.code.0, found.message)).collect()
}

fn execute(source: &str, disturbances: &[Disturbance]) -> (Arc<Network>, Ran) {
    let parse = rmpl::parse(source);
    let program = parse.program();
    let mut found = parse.diagnostics();
    let network = Arc::new(mission::compile(&program, &Goal::Default, &mut found).expect("it compiles"));
    let problem = Problem {
        network: &network,
        program: &program,
        ground: None,
        options: kirk::Options::default(),
        seed: 0,
        facts: None,
    };
    let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || false);
    let script = Script { disturbances: disturbances.to_vec(), ..Script::default() };
    let ran = execution::execute(&problem, &planned, &script, &mut grounds, &mut paths);
    (Arc::clone(&network), ran.expect("there is a plan").expect("its times fit"))
}

/// When an event happened in the last plan.
fn time(ran: &Ran, event: &str) -> Option<Time> {
    ran.outcome.log.iter().find_map(|entry| match &entry.happening {
        Happening::Executed { name } if name == event => Some(entry.time),
        _ => None,
    })
}

fn fault() -> Disturbance {
    Disturbance::Fault {
        activity: "Insert#1".into(),
        step: 3,
        component: "EngineA".into(),
        mode: "Failed".into(),
    }
}

/// SPEC 9.3: four nominal steps, which take two minutes each here.
#[test]
fn the_program_s_end_ends_its_activity() {
    let (_, ran) = execute(ORBIT, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log.last());
    let (start, end) = (time(&ran, "Insert#1.start"), time(&ran, "Insert#1.end"));
    assert_eq!(end.zip(start).and_then(|(end, start)| end.checked_sub(start)), Some(Time::from(8)));
    let commands: Vec<&str> = ran
        .outcome
        .log
        .iter()
        .filter_map(|entry| match &entry.happening {
            Happening::Progress { text, .. } => Some(text.as_str()),
            _ => None,
        })
        .collect();
    assert_eq!(
        commands,
        [
            "step 1: Camera.turn-off, DriverA.on, DriverB.on",
            "step 2: EngineA.standby, EngineB.standby",
            "step 3: ValveA.open",
            "step 4: EngineA.fire"
        ]
    );
}

/// SPEC 9.3: a failure at step 3 stays hidden until step 4; the backup engine needs two more steps.
#[test]
fn a_fault_brings_the_backup_engine_and_the_activity_takes_longer() {
    let (_, ran) = execute(ORBIT, &[fault()]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log.last());
    let (start, end) = (time(&ran, "Insert#1.start"), time(&ran, "Insert#1.end"));
    assert_eq!(end.zip(start).and_then(|(end, start)| end.checked_sub(start)), Some(Time::from(12)));
    let fires = |entry: &executive::Entry| matches!(&entry.happening, Happening::Progress { text, .. } if text.contains("EngineB.fire"));
    assert!(ran.outcome.log.iter().any(fires));
}

#[test]
fn a_program_that_outlasts_its_activity_breaks_the_plan() {
    let tight = ORBIT.replace("primitive Insert()[6,16]", "primitive Insert()[6,10]");
    let (_, ran) = execute(&tight, &[fault()]);
    let violation = ran.outcome.log.iter().find_map(|entry| match &entry.happening {
        Happening::Violation { name, .. } => Some((name.to_string(), entry.time)),
        _ => None,
    });
    let start = time(&ran, "Insert#1.start").expect("it was started");
    assert_eq!(
        violation,
        Some(("Insert#1.end".to_owned(), start.checked_add(10.into()).expect("a small time")))
    );
}

#[test]
fn a_program_that_never_ends_stops_the_mission_when_its_time_is_over() {
    let both = [
        fault(),
        Disturbance::Fault {
            activity: "Insert#1".into(),
            step: 3,
            component: "EngineB".into(),
            mode: "Failed".into(),
        },
    ];
    let (_, ran) = execute(ORBIT, &both);
    assert_eq!(ran.outcome.ending, Ending::Stopped);
    let start = time(&ran, "Insert#1.start").expect("it was started");
    let said = ran.outcome.log.iter().any(|entry| match &entry.happening {
        Happening::Violation { reason, .. } => {
            start.checked_add(16.into()) == Some(entry.time) && reason.contains("did not reach its end")
        }
        _ => false,
    });
    assert!(said, "{:?}", ran.outcome.log);
}

#[test]
fn a_later_program_finds_the_plant_as_the_earlier_one_left_it() {
    let twice = ORBIT
        .replace("delay[0,60];", "Insert2(); delay[0,60];")
        .replace("primitive Downlink", "primitive Insert2()[0,10] runs OrbitInsert;\nprimitive Downlink");
    let (_, ran) = execute(&twice, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    let (start, end) = (time(&ran, "Insert2#1.start"), time(&ran, "Insert2#1.end"));
    // Drivers and valves are as the first program left them, so two steps are enough: standby, and fire again.
    assert_eq!(end.zip(start).and_then(|(end, start)| end.checked_sub(start)), Some(Time::from(4)));
}

#[test]
fn the_example_has_nothing_wrong_with_it() {
    assert_eq!(diagnostics(ORBIT), Vec::<String>::new());
}

#[test]
fn an_unknown_program_and_a_missing_plant_are_told() {
    let misspelled = ORBIT.replace("runs OrbitInsert", "runs OrbitInsret");
    assert_eq!(diagnostics(&misspelled), ["E-UNDEF no control program `OrbitInsret` is defined"]);
    let (mission, _) = ORBIT.split_once("control {").expect("it has a control block");
    assert_eq!(diagnostics(mission), ["E-UNDEF no control program `OrbitInsert` is defined"]);
    let program = "control {\n  OrbitInsert ():: (EngineA = Firing)\n}\n";
    assert_eq!(
        diagnostics(&format!("{mission}{program}")),
        ["E-UNDEF there is no plant for `OrbitInsert` to control"]
    );
}

#[test]
fn what_is_wrong_in_a_control_block_is_told_in_its_place() {
    let source = ORBIT.replacen("(EngineB = Standby)", "(EngnieB = Standby)", 1);
    let parse = rmpl::parse(&source);
    let mut found = parse.diagnostics();
    mission::compile(&parse.program(), &Goal::Default, &mut found);
    let places: Vec<&str> = found.iter().filter_map(|found| source.get(found.span.range())).collect();
    assert_eq!(places, ["EngnieB"], "{found:?}");
    let broken = ORBIT.replace("(PARALLEL", "(PARALELL");
    let found = rmpl::parse(&broken).diagnostics();
    assert!(found.iter().any(|found| broken.get(found.span.range()) == Some("PARALELL")), "{found:?}");
}

/// A second primitive that runs the same program, beside the first one or after it.
fn two_programs(arrive: &str) -> String {
    let source = ORBIT.replacen(
        "primitive Insert()[6,16] runs OrbitInsert;",
        "primitive Insert()[6,16] runs OrbitInsert;\nprimitive Survey()[4,30] runs OrbitInsert;",
        1,
    );
    let (before, rest) = source.split_once("Arrive() = {").expect("it arrives");
    let (_, after) = rest.split_once("scenario Encounter").expect("it has a scenario");
    format!("{before}Arrive() = {{ {arrive} }}\nscenario Encounter{after}")
}

fn plan_warnings(source: &str) -> Vec<String> {
    let program = rmpl::parse(source).program();
    let network = mission::compile(&program, &Goal::Default, &mut Vec::new()).expect("it compiles");
    let problem = Problem {
        network: &Arc::new(network),
        program: &program,
        ground: None,
        options: kirk::Options::default(),
        seed: 0,
        facts: None,
    };
    let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || false);
    planned.warnings.iter().map(|it| format!("{} {}", it.code.0, it.message)).collect()
}

#[test]
fn programs_that_may_run_at_once_are_warned_of_and_the_second_one_stops_the_mission() {
    let beside = two_programs("{ Insert(), Survey() }");
    let [warning] = &plan_warnings(&beside)[..] else { panic!("{:?}", plan_warnings(&beside)) };
    assert!(warning.starts_with("W-PLANT Insert#1 and Survey#1 may run at the same time"), "{warning}");
    let (_, ran) = execute(&beside, &[]);
    assert_eq!(ran.outcome.ending, Ending::Stopped);
    let reason = ran.outcome.log.iter().find_map(|entry| match &entry.happening {
        Happening::Violation { reason, .. } => Some(reason.as_str()),
        _ => None,
    });
    assert!(
        reason.is_some_and(|it| it.contains("the program of Insert#1 commands the plant until 8")),
        "{reason:?}"
    );
}

#[test]
fn programs_one_after_the_other_are_not_warned_of() {
    assert_eq!(plan_warnings(&two_programs("Insert(); Survey()")), Vec::<String>::new());
    assert_eq!(plan_warnings(ORBIT), Vec::<String>::new());
}
