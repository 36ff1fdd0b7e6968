//! Activities that run control programs, from text to the end of the run.

use std::sync::Arc;

use exact::Time;
use executive::{Disturbance, Ending, Happening, Script};
use mission::execution::{self, Ran};
use mission::planning::{self, Problem};
use mission::{Grounds, Paths};
use snapshot::Goal;
use tpn::Network;

const ORBIT: &str = include_str!("../../../../assets/missions/orbit.rmpl");

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
    let problem = Problem::new(&network, &program);
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
            start.checked_add(16.into()) == Some(entry.time) && reason.contains("did not end within")
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
    assert_eq!(diagnostics(&misspelled), ["E-UNDEF unknown control program `OrbitInsret`"]);
    let (mission, _) = ORBIT.split_once("control {").expect("it has a control block");
    assert_eq!(diagnostics(mission), ["E-UNDEF unknown control program `OrbitInsert`"]);
    let program = "control {\n  OrbitInsert ():: (EngineA = Firing)\n}\n";
    assert_eq!(
        diagnostics(&format!("{mission}{program}")),
        ["E-UNDEF `OrbitInsert` needs a plant to control"]
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
    let network = Arc::new(mission::compile(&program, &Goal::Default, &mut Vec::new()).expect("it compiles"));
    let problem = Problem::new(&network, &program);
    let (mut grounds, mut paths) = (Grounds::default(), Paths::default());
    let planned = planning::plan(&problem, &mut grounds, &mut paths, &mut || false);
    planned.warnings.iter().map(|it| format!("{} {}", it.code.0, it.message)).collect()
}

#[test]
fn programs_that_command_the_same_and_may_run_at_once_are_warned_of_and_the_second_one_waits() {
    let beside = two_programs("{ Insert(), Survey() }");
    let [warning] = &plan_warnings(&beside)[..] else { panic!("{:?}", plan_warnings(&beside)) };
    assert!(warning.starts_with("W-PLANT Insert#1 and Survey#1 may run at the same time"), "{warning}");
    let (_, ran) = execute(&beside, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    let (first, second) = (time(&ran, "Insert#1.end"), time(&ran, "Survey#1.end"));
    // Two steps of two minutes, for the plant is as the first one left it.
    let lasted = second.zip(first).and_then(|(second, first)| second.checked_sub(first));
    assert_eq!(lasted, Some(Time::from(4)), "{:?}", ran.outcome.log);
}

#[test]
fn programs_one_after_the_other_are_not_warned_of() {
    assert_eq!(plan_warnings(&two_programs("Insert(); Survey()")), Vec::<String>::new());
    assert_eq!(plan_warnings(ORBIT), Vec::<String>::new());
}

/// Two engines of their own, and a program that starts whichever it is handed; each takes two steps to fire.
const ENGINES: &str = "
control {
  (DEFCLASS Engine () (COMMAND cmd {none on off}) (VAR shown {off warm firing failed} OBSERVABLE)
    (MODE Off (shown = off)) (MODE Warm (shown = warm)) (MODE Firing (shown = firing)) (MODE Failed (shown = failed))
    (TRANSITION Off Warm (cmd = on)) (TRANSITION Warm Firing (cmd = on))
    (TRANSITION Firing Off (cmd = off)) (TRANSITION Warm Off (cmd = off))
    (FAULT Off Failed 0.01) (FAULT Warm Failed 0.01) (FAULT Firing Failed 0.01))
  (DEFINSTANCE EngineA Engine INIT Off)
  (DEFINSTANCE EngineB Engine INIT Off)
  Fire (e):: (DO-WATCHING (e = Firing) (e = Firing))
  Try (e):: (DO-WATCHING ((e = Firing) OR (e = Failed)) (e = Firing))
  Rest (e):: (DO-WATCHING (e = Off) (e = Off))
}";

fn engines(text: &str) -> String {
    format!("{text}{ENGINES}")
}

fn progress(ran: &Ran) -> Vec<(i64, String)> {
    let text = |entry: &executive::Entry| match &entry.happening {
        Happening::Progress { name, text } => Some((entry.time.to_f64() as i64, format!("{name} {text}"))),
        _ => None,
    };
    ran.outcome.log.iter().filter_map(text).collect()
}

fn violations(ran: &Ran) -> Vec<String> {
    let reason = |entry: &executive::Entry| match &entry.happening {
        Happening::Violation { reason, .. } => Some(reason.clone()),
        _ => None,
    };
    ran.outcome.log.iter().filter_map(reason).collect()
}

fn fails(activity: &str, step: u32, component: &str) -> Disturbance {
    let (activity, component, mode) = (activity.into(), component.into(), "Failed".into());
    Disturbance::Fault { activity, step, component, mode }
}

#[test]
fn programs_that_command_different_components_run_at_once() {
    let text = engines(
        "primitive Start(e)[1,9] runs Fire(e);\nscenario S[0,20] = { Start(EngineA), Start(EngineB) }",
    );
    assert_eq!(plan_warnings(&text), Vec::<String>::new());
    let (_, ran) = execute(&text, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    assert_eq!(
        progress(&ran),
        [
            (1, "Start#1 step 1: EngineA.on".to_owned()),
            (1, "Start#2 step 1: EngineB.on".to_owned()),
            (2, "Start#1 step 2: EngineA.on".to_owned()),
            (2, "Start#2 step 2: EngineB.on".to_owned()),
        ]
    );
    assert_eq!([time(&ran, "Start#1.end"), time(&ran, "Start#2.end")], [Some(2.into()); 2]);
}

/// The plant has one clock: whoever starts between two steps takes its first one with the next.
#[test]
fn a_program_that_starts_between_two_steps_joins_the_next() {
    let text = engines(
        "option control_step = 2;\nprimitive Start(e)[1,9] runs Fire(e);
         scenario S[0,20] = { Start(EngineA), { delay[1,1]; Start(EngineB) } }",
    );
    let (_, ran) = execute(&text, &[]);
    assert_eq!(time(&ran, "Start#1.end"), Some(4.into()), "{:?}", ran.outcome.log);
    assert_eq!(time(&ran, "Start#2.end"), Some(6.into()), "{:?}", ran.outcome.log);
}

#[test]
fn a_program_waits_for_the_one_that_commands_its_component() {
    let text = engines(
        "primitive Start(e)[1,9] runs Fire(e);\nprimitive Stop(e)[1,9] runs Rest(e);
         scenario S[0,20] = { Start(EngineA), { delay[1,1]; Stop(EngineA) } }",
    );
    let found = plan_warnings(&text);
    assert!(found.len() == 1 && found[0].contains("both programs command EngineA"), "{found:?}");
    let (_, ran) = execute(&text, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    // Two steps to fire, then one to stop, which began at 1.
    assert_eq!([time(&ran, "Start#1.end"), time(&ran, "Stop#1.end")], [Some(2.into()), Some(3.into())]);
    assert_eq!(progress(&ran).last(), Some(&(3, "Stop#1 step 1: EngineA.off".to_owned())));
}

#[test]
fn a_program_that_waits_too_long_says_for_whom() {
    let text = engines(
        "primitive Start(e)[1,9] runs Fire(e);\nprimitive Stop(e)[1,2] runs Rest(e);
         scenario S[0,20] = { Start(EngineA), { delay[1,1]; Stop(EngineA) } }",
    );
    let (_, ran) = execute(&text, &[fails("Start#1", 1, "EngineA")]);
    assert_eq!(ran.outcome.ending, Ending::Stopped);
    let found = violations(&ran);
    assert!(found[0].contains("its program waits for that of Start#1, which has not ended"), "{found:?}");
}

#[test]
fn what_programs_are_handed_is_checked_where_the_activity_is_called() {
    let of = |text: &str| diagnostics(&engines(text));
    let found = of("primitive Start()[1,9] runs Fire;\nscenario S[0,20] = { Start() }");
    assert_eq!(found, ["E-ARITY `Fire` takes one name, but is given no names"]);
    let text = engines("primitive Start(e)[1,9] runs Fire(e);\nscenario S[0,20] = { Start(EngineC) }");
    let parse = rmpl::parse(&text);
    let mut found = parse.diagnostics();
    mission::compile(&parse.program(), &Goal::Default, &mut found);
    let [found] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(found.code.0, "E-UNDEF");
    assert_eq!(&text[found.span.range()], "Start(EngineC)", "{found:?}");
}

/// The mission relies on what the program was to bring about; the estimate says that it has not.
#[test]
fn an_effect_that_the_estimate_denies_is_none_and_the_mission_plans_again() {
    let text = engines(
        "state EngineA.mode from plant;\nstate EngineB.mode from plant;
         primitive StartA()[1,9] runs Try(EngineA) sets EngineA.mode=Firing;
         primitive StartB()[1,9] runs Try(EngineB) sets EngineB.mode=Firing;
         primitive BurnA()[5,5] requires EngineA.mode=Firing;
         primitive BurnB()[5,5] requires EngineB.mode=Firing;
         scenario S[0,40] = { StartA(); choose { BurnA(), { StartB(); BurnB() } } }",
    );
    let (_, ran) = execute(&text, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    assert!(violations(&ran).is_empty(), "{:?}", ran.outcome.log);
    let (_, ran) = execute(&text, &[fails("StartA#1", 2, "EngineA")]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    assert!(
        time(&ran, "BurnB#1.end").is_some() && time(&ran, "BurnA#1.end").is_none(),
        "{:?}",
        ran.outcome.log
    );
    let found = violations(&ran);
    assert!(found[0].contains("BurnA#1 needs EngineA.mode=Firing"), "{found:?}");
    let said = progress(&ran);
    let word = "has ended, but EngineA.mode is estimated to be Failed, not EngineA.mode=Firing";
    assert!(said.iter().any(|(_, text)| text.contains(word)), "{said:?}");
}

/// An engine that fires already, though no one is sure of it.
#[test]
fn priors_and_thresholds_of_the_control_block_count_for_the_programs_of_a_mission() {
    let mission = "state EngineA.mode from plant;
        primitive Start()[1,9] runs Fire(EngineA);
        scenario S[0,20] = { Start() }";
    let text = engines(mission).replace("EngineA Engine INIT Off", "EngineA Engine INIT Warm 0.1 Firing 0.9");
    let initial = rmpl::parse(&text).program().variables[0].initial.clone();
    assert_eq!(initial.as_ref().map(|name| name.text.as_str()), Some("Firing"), "the likeliest mode");
    let strict = text.replace("control {", "control {\n  (DEFOPTION entailment 0.95)");
    for (text, step) in [(&text, "Start#1 step 1: no command"), (&strict, "Start#1 step 1: EngineA.on")] {
        assert_eq!(diagnostics(text), ["W-UNUSED the variable `EngineA.mode` is never used"]);
        let (_, ran) = execute(text, &[]);
        assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
        assert_eq!(progress(&ran), [(1, step.to_owned())]);
    }
    let wrong = strict.replace("entailment 0.95", "entailment 95");
    let found = diagnostics(&wrong);
    assert!(found.iter().any(|it| it.starts_with("E-PROBABILITY")), "{found:?}");
}

/// What a mission relies on may be lost to a program that it did not expect to.
#[test]
fn a_mode_that_a_program_changes_is_missed_by_what_needs_it() {
    let text = engines(
        "state EngineA.mode from plant;\nprimitive Start(e)[1,9] runs Fire(e);
         primitive Image()[6,6] requires EngineA.mode=Off;
         scenario S[0,20] = { Image(), { delay[2,2]; Start(EngineA) } }",
    );
    let (_, ran) = execute(&text, &[]);
    assert_eq!(ran.outcome.ending, Ending::Stopped, "{:?}", ran.outcome.log);
    let found = violations(&ran);
    assert!(
        found[0].contains("Image#1 needs EngineA.mode=Off") && found[0].contains("became Warm at 3"),
        "{found:?}"
    );
}

#[test]
fn states_of_components_are_checked_against_the_plant() {
    let of = |text: &str| diagnostics(&engines(text));
    let sound = "state EngineA.mode from plant;\nprimitive Image()[6,6] requires EngineA.mode=Off;
        scenario S[0,20] = { Image() }";
    assert_eq!(of(sound), Vec::<String>::new());
    assert_eq!(of(&sound.replace("EngineA", "EngineC")), ["E-UNDEF the plant has no component `EngineC`"]);
    let found = of(&sound.replace("mode=Off", "mode=Of"));
    assert!(found.len() == 1 && found[0].starts_with("E-VALUE"), "{found:?}");
    let undeclared = sound.replace("state EngineA.mode from plant;", "");
    assert_eq!(of(&undeclared), ["E-UNDEF unknown state variable `EngineA.mode`"]);
    // The plant is written below, and follows its own edits.
    let mut parse = rmpl::parse(&engines(sound));
    let at = parse.text().find("INIT Off").expect("the first engine") as u32 + 5;
    parse.edit(&rmpl::Edit { span: rmpl::Span::new(at, at + 3), text: "Warm".to_owned() });
    let variable = &parse.program().variables[0];
    assert_eq!(variable.initial.as_ref().map(|name| name.text.as_str()), Some("Warm"));
    assert_eq!(variable.values.len(), 4);
}

const FLYBY: &str = include_str!("../../../../assets/missions/flyby.rmpl");

#[test]
fn a_mission_that_reads_its_plant_takes_the_camera_that_comes_up() {
    assert_eq!(diagnostics(FLYBY), Vec::<String>::new());
    assert_eq!(plan_warnings(FLYBY), Vec::<String>::new());
    let (_, ran) = execute(FLYBY, &[]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    assert!(violations(&ran).is_empty() && time(&ran, "Look#1.end").is_some(), "{:?}", ran.outcome.log);
    let (_, ran) = execute(FLYBY, &[fails("Start-Up#1", 2, "CameraA")]);
    assert_eq!(ran.outcome.ending, Ending::Finished, "{:?}", ran.outcome.log);
    let found = violations(&ran);
    let word = "Calibrate#1 needs CameraA.mode=Ready at 5, but CameraA.mode became Failed at 4";
    assert_eq!(found, [word]);
    assert!(
        time(&ran, "Look#1.start").is_none() && time(&ran, "Look#2.end").is_some(),
        "{:?}",
        ran.outcome.log
    );
    // With both failed nothing can look, and the run says what it lacks.
    let (_, ran) = execute(FLYBY, &[fails("Start-Up#1", 2, "CameraA"), fails("Start-Up#2", 1, "CameraB")]);
    assert_eq!(ran.outcome.ending, Ending::Stopped);
    assert!(violations(&ran).iter().any(|text| text.contains("CameraB.mode=Ready")), "{:?}", ran.outcome.log);
}

#[test]
fn the_component_of_a_mode_may_be_a_parameter_and_is_looked_up_at_the_call() {
    let text = engines(
        "state EngineA.mode from plant;
         primitive Start(e)[1,9] runs Fire(e) sets e.mode=Firing;
         primitive Burn(e)[5,5] requires e.mode=Firing;
         scenario S[0,40] = { Start(EngineA); Burn(EngineA) }",
    );
    assert_eq!(diagnostics(&text), Vec::<String>::new());
    let (_, ran) = execute(&text, &[]);
    assert_eq!(time(&ran, "Burn#1.end"), Some(7.into()), "{:?}", ran.outcome.log);
    let undeclared = text.replace("Burn(EngineA) }", "Burn(EngineB) }");
    assert_eq!(diagnostics(&undeclared), ["E-UNDEF unknown state variable `EngineB.mode`"]);
    let wrong = text.replace("requires e.mode=Firing", "requires e.mode=Blazing");
    assert_eq!(diagnostics(&wrong), ["E-VALUE `Blazing` is not a value of `EngineA.mode`"]);
}

#[test]
fn a_refuted_belief_violates_the_activity_and_the_run_says_why() {
    // An engine that is off does not fail, so that nothing explains its power.
    let fault = Disturbance::Fault {
        activity: "Insert#1".into(),
        step: 1,
        component: "EngineA".into(),
        mode: "Failed".into(),
    };
    let (_, ran) = execute(ORBIT, &[fault]);
    assert_eq!(ran.outcome.ending, Ending::Stopped);
    let reasons = violations(&ran);
    let expected = "no tracked state of the plant explains EngineA.power_in=nominal";
    assert!(reasons.iter().any(|reason| reason.contains(expected)), "{reasons:?}");
}

#[test]
fn a_control_block_may_set_the_length_of_its_steps() {
    let program = "Cool (e):: (SEQUENCE (DO-WATCHING (e = Firing) (e = Firing)) (WAIT 90s))";
    let text = engines("primitive Start(e)[1,9] runs Cool(e);\nscenario S[0,20] = { Start(EngineA) }");
    let with = |step: &str| text.replace("control {", &format!("control {{\n{step}\n{program}"));
    for (step, end) in [("", Time::new(4, 1)), ("(DEFSTEP 30s)", Time::new(5, 2))] {
        let (_, ran) = execute(&with(step), &[]);
        assert_eq!(time(&ran, "Start#1.end"), end, "{step}: {:?}", ran.outcome.log);
    }
    let twice = format!("option control_step = 2;\n{}", with("(DEFSTEP 30s)"));
    assert_eq!(
        diagnostics(&twice),
        ["E-DUP the mission already sets the step length: `option control_step`"]
    );
}
