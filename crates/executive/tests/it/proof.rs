//! Proofs about all runs of a program: against runs taken one by one, and against probabilities worked out by hand.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::Arc;

use executive::model_based::proof::{
    Counterexample, DEFAULTS, End, Proof, Property, Scope, Verdict, chance_to_end, idle_parts,
    idle_parts_alone, prove,
};
use executive::model_based::{Knowledge, Options, Run, RunStatus, StepInput, System};
use plant::{ComponentId, Interval, Probability};
use tpn::generate::Rng;

const PLANT: &str = "(DEFCLASS Switch ()
    (VAR light {dark lit} OBSERVABLE)
    (COMMAND cmd {none on off})
    (MODE Off (light = dark)) (MODE On (light = lit)) (MODE Broken (light = dark))
    (TRANSITION Off On (cmd = on)) (TRANSITION On Off (cmd = off))
    (FAULT Off Broken 0.01) (FAULT On Broken 0.02))
  (DEFINSTANCE A Switch INIT Off)
  (DEFINSTANCE B Switch INIT Off)";

fn system(program: &str, plant: &str) -> Arc<System> {
    let compilation = System::compile(&format!("P ():: {program}\n{plant}"), None);
    assert_eq!(compilation.program_diagnostics, [], "{program}");
    compilation.system.expect("it compiles")
}

fn proven(system: &Arc<System>, properties: &[&str], scope: Scope) -> Proof {
    let read = |text: &&str| Property::read(text, system).expect("it is a property");
    let properties: Vec<Property> = properties.iter().map(read).collect();
    prove(system, &properties, scope, &mut |_| true).expect("it can be explored")
}

fn verdict(system: &Arc<System>, property: &str, faults: u32) -> Verdict {
    let proof = proven(system, &[property], Scope { faults, ..Scope::default() });
    proof.verdicts.into_iter().next().expect("there is one").1
}

/// The run that breaks a property, as components and modes by step.
fn broken(system: &Arc<System>, property: &str, faults: u32) -> (Vec<String>, Counterexample) {
    let Verdict::Broken(run) = verdict(system, property, faults) else { panic!("{property} is not broken") };
    let mut shown = Vec::new();
    for (number, by) in (1..).zip(&run.moves) {
        for (id, mode) in &by.modes {
            let name = &system.model.component(*id).expect("it is one").name;
            shown.push(format!("{number}:{name}={}", system.model.mode_name(*id, *mode)));
        }
    }
    (shown, *run)
}

fn replayed(system: &Arc<System>, counterexample: &Counterexample, knowledge: Knowledge) -> Run {
    let mut run = Run::new(system, Options { knowledge, ..Options::default() });
    for by in &counterexample.moves {
        if run.status() == RunStatus::Running {
            let injected = by.modes.iter().copied().collect();
            run.step(&StepInput { injected, ..StepInput::default() }).expect("it is possible");
        }
    }
    run
}

#[test]
fn a_program_that_waits_for_what_a_fault_prevents_is_shown_to_wait_forever() {
    let one = system("(SEQUENCE (A = On) (A = Off))", PLANT);
    assert_eq!(verdict(&one, "ends", 0), Verdict::Holds);
    let (faults, run) = broken(&one, "ends", 1);
    assert_eq!(faults, ["1:A=Broken"]);
    assert_eq!(run.moves.len() - run.repeats_after.expect("it goes on forever"), 1);
    // What has nothing to do with it, B, is left out: a wait of any length is one state.
    let proof = proven(&one, &["ends"], Scope::default());
    assert!(proof.states < 20, "{}", proof.states);
    let either = system("(DO-WATCHING (A = Broken) (SEQUENCE (A = On) (A = Off)))", PLANT);
    assert_eq!(verdict(&either, "ends", 2), Verdict::Holds);
}

#[test]
fn properties_say_what_holds_at_all_times_and_by_when() {
    let system = system("(SEQUENCE (A = On) (B = On) (A = Off))", PLANT);
    for (property, holds) in [
        ("always (A = On) OR (B = Off)", false),
        ("never A = Broken", true),
        ("eventually A = On AND B = On", true),
        ("eventually A = On AND B = On within 2 steps", true),
        ("eventually A = On AND B = On within 1", false),
        ("A = On leads to A = Off", true),
        ("A = On leads to A = Off within 2 steps", true),
        ("A = On leads to A = Off within 1 step", false),
        ("ends within 3 steps", true),
        ("ends within 2 steps", false),
        ("always A.light = dark", false),
        ("B.light = lit leads to A.light = dark", true),
    ] {
        assert_eq!(verdict(&system, property, 0) == Verdict::Holds, holds, "{property}");
    }
    assert_eq!(broken(&system, "never A = Broken", 1).0, ["1:A=Broken"]);
}

#[test]
fn a_property_that_cannot_be_read_says_why() {
    let system = system("(A = On)", PLANT);
    for (text, part) in [
        ("soon", "expected `always C`"),
        ("always C = On", "no component or variable `C`"),
        ("never A = Lit", "no mode `Lit`"),
        ("never A.light = Lit", "has no value `Lit`: its values are dark, lit"),
        ("always A = On within 3", "remove `within`"),
        ("ends within 0 steps", "needs a time"),
        ("ends within soon", "needs a time"),
        ("eventually (A = ", "not a condition"),
        ("never ~(A = On)", "not a condition"),
        ("never (HELD 3 (A = On))", "not a condition"),
    ] {
        let error = Property::read(text, &system).expect_err(text);
        assert!(error.contains(part), "{text}: {error}");
    }
}

#[test]
fn time_that_passes_again_and_again_is_a_finite_number_of_states() {
    let program = "(PARALLEL (ALWAYS (IF-THENNEXT (HELD 3 (A = On)) (B = On))) \
                   (DO-WATCHING (B = On) (SEQUENCE (WAIT 50) (A = On) (WAIT 50))))";
    let system = system(program, PLANT);
    let proof = proven(&system, &["eventually B = On", "ends"], Scope { faults: 0, ..Scope::default() });
    assert_eq!(proof.stopped, None);
    assert!(proof.states < 200, "{}", proof.states);
    assert_eq!(proof.verdicts[0].1, Verdict::Holds);
    // ALWAYS continues after everything else.
    assert!(matches!(proof.verdicts[1].1, Verdict::Broken(_)));
}

#[test]
fn times_of_a_program_come() {
    let at = system("(SEQUENCE (A = On) (AT 5 (B = On)))", PLANT);
    for (property, holds) in [
        ("ends", true),
        ("ends within 6 steps", true),
        ("ends within 5 steps", false),
        ("never B = On", false),
        ("eventually B = On", true),
    ] {
        assert_eq!(verdict(&at, property, 0) == Verdict::Holds, holds, "{property}");
    }
    // What is over makes no more states.
    let after =
        system("(PARALLEL (AT 5 (B = On)) (ALWAYS (IF-THENNEXT (HELD 2 (A = On)) (A = Off))))", PLANT);
    let scope = Scope { faults: 0, knowledge: Knowledge::Perfect, ..Scope::default() };
    let proof = proven(&after, &["eventually B = On"], scope);
    assert_eq!((proof.stopped, &proof.verdicts[0].1), (None, &Verdict::Holds));
}

#[test]
fn what_chance_decides_again_and_again_comes_at_some_time() {
    let retry =
        "(DO-WATCHING (A = On) (WHENEVER-DONEXT (A = Off) (CHOOSE-PROB (0.5 (A = On)) (0.5 (B = On)))))";
    let again = system(retry, PLANT);
    let scope = Scope { faults: 0, knowledge: Knowledge::Perfect, ..Scope::default() };
    let proof = proven(&again, &["ends", "eventually A = On", "ends within 30 steps"], scope);
    assert_eq!((&proof.verdicts[0].1, &proof.verdicts[1].1), (&Verdict::Holds, &Verdict::Holds));
    // No number of steps is enough.
    assert!(matches!(proof.verdicts[2].1, Verdict::Broken(_)));
    let once = system("(CHOOSE-PROB (0.9 (A = On)) (0.1 (WHEN-DONEXT (B = Broken) (B = On))))", PLANT);
    let Verdict::Broken(run) = verdict(&once, "ends", 0) else { panic!("one alternative waits forever") };
    assert_eq!(run.start.choices, [1]);
}

#[test]
fn the_five_checks_find_what_each_is_for() {
    let checks = |program: &str, faults: u32| -> Vec<bool> {
        let system = system(program, PLANT);
        let scope = Scope { faults, ..Scope::default() };
        let proof = prove(&system, &DEFAULTS, scope, &mut |_| true).expect("it can be explored");
        proof.verdicts.iter().map(|(_, verdict)| *verdict == Verdict::Holds).collect()
    };
    let ok = [true; 5];
    let but = |wrong: &[usize]| {
        let mut expected = ok;
        for at in wrong {
            expected[*at] = false;
        }
        expected
    };
    assert_eq!(checks("(SEQUENCE (A = On) (B = On))", 0), ok);
    assert_eq!(checks("(PARALLEL (A = On) (A = Off))", 0), but(&[1]));
    assert_eq!(
        checks("(DO-WATCHING (A = On) (PARALLEL (A = On) (WHEN-DONEXT (B = On) (B = Off))))", 0),
        but(&[2, 3])
    );
    let ring =
        "(PARALLEL (LOCK (A = On) (LOCK (B = On) (WAIT 1))) (LOCK (B = Off) (LOCK (A = Off) (WAIT 1))))";
    assert!(!checks(ring, 0)[4]);
}

#[test]
fn a_limit_leaves_open_what_was_not_looked_at() {
    let system = system("(SEQUENCE (A = On) (B = On) (A = Off))", PLANT);
    let few = Scope { faults: 2, states: 3, ..Scope::default() };
    let proof = proven(&system, &["never B = On", "ends", "never A = On"], few);
    assert!(proof.stopped.is_some());
    assert_eq!(proof.verdicts[0].1, Verdict::Open);
    assert_eq!(proof.verdicts[1].1, Verdict::Open);
    // What is broken among the first states stays so.
    assert!(matches!(proof.verdicts[2].1, Verdict::Broken(_)));
    let short = Scope { faults: 0, steps: 1, ..Scope::default() };
    assert_eq!(proven(&system, &["never B = On"], short).verdicts[0].1, Verdict::Open);
    let mut asked = 0;
    let stopped = prove(&system, &DEFAULTS, Scope::default(), &mut |_| {
        asked += 1;
        asked < 3
    });
    assert!(stopped.expect("it can be explored").stopped.is_some());
}

#[test]
fn what_a_program_cannot_observe_makes_a_difference() {
    // Nothing shows whether the valve is stuck.
    let plant =
        "(DEFCLASS Valve () (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true) (MODE Stuck true)
        (TRANSITION Closed Open (cmd = open)) (FAULT Closed Stuck 0.01) (FAULT Open Stuck 0.01))
      (DEFINSTANCE V Valve INIT Closed)";
    let system = system("(V = Open)", plant);
    let at = |knowledge| {
        let proof = proven(&system, &["ends"], Scope { faults: 1, knowledge, ..Scope::default() });
        proof.verdicts[0].1.clone()
    };
    // It takes the valve for open, and ends; who sees it waits forever.
    assert_eq!(at(Knowledge::Estimated), Verdict::Holds);
    let Verdict::Broken(run) = at(Knowledge::Perfect) else { panic!("a stuck valve never opens") };
    assert_eq!(run.moves[0].modes.len(), 1);
    assert_eq!(replayed(&system, &run, Knowledge::Perfect).status(), RunStatus::Running);
    assert_eq!(replayed(&system, &run, Knowledge::Estimated).status(), RunStatus::Ended);
}

#[test]
fn the_chance_to_end_is_what_is_worked_out_by_hand() {
    let system = system("(SEQUENCE (A = On) (A = Off))", PLANT);
    let chance = |steps| chance_to_end(&system, Knowledge::Perfect, steps, 1000).expect("it can be computed");
    let fraction = |numerator: u64, denominator: u64| {
        Interval::certain(Probability::new(numerator.into(), denominator.into()))
    };
    assert_eq!(chance(1), fraction(0, 1));
    // A does not break while off, 0.99, nor while on, 0.98.
    assert_eq!(chance(2), fraction(99 * 98, 10_000));
    assert_eq!(chance(9), chance(2));
    // A switch that breaks while it is on looks as if it were off.
    let estimated = chance_to_end(&system, Knowledge::Estimated, 2, 1000).expect("it can be computed");
    assert_eq!(estimated, fraction(99, 100));
    let choice = self::system("(CHOOSE-PROB (0.25 (A = On)) (0.75 (SEQUENCE (B = On) (B = Off))))", PLANT);
    let chance = chance_to_end(&choice, Knowledge::Estimated, 1, 1000).expect("it can be computed");
    assert_eq!(chance, fraction(99, 400));
    let cut = chance_to_end(&choice, Knowledge::Estimated, 2, 1).expect("it can be computed");
    assert!(cut.low < cut.high, "{cut:?}");
}

/// A random program over two switches.
fn program(rng: &mut Rng, depth: u32) -> String {
    let condition = |rng: &mut Rng| {
        let mode = ["Off", "On", "Broken"][rng.below(3) as usize];
        format!("({} = {mode})", ["A", "B"][rng.below(2) as usize])
    };
    let goal = |rng: &mut Rng| {
        format!("({} = {})", ["A", "B"][rng.below(2) as usize], ["Off", "On"][rng.below(2) as usize])
    };
    if depth == 0 {
        return if rng.below(5) == 0 { format!("(WAIT {})", 1 + rng.below(3)) } else { goal(rng) };
    }
    let part = |rng: &mut Rng| program(rng, depth - 1);
    match rng.below(8) {
        0 => format!("(SEQUENCE {} {})", part(rng), part(rng)),
        1 => format!("(PARALLEL {} {})", part(rng), part(rng)),
        2 => format!("(DO-WATCHING {} {})", condition(rng), part(rng)),
        3 => format!("(WHEN-DONEXT {} {})", condition(rng), part(rng)),
        4 => format!("(IF-THENNEXT {} {})", condition(rng), part(rng)),
        6 => format!("(AT {} {})", 1 + rng.below(6), part(rng)),
        5 => format!("(TIMEOUT {} {} {})", 1 + rng.below(4), part(rng), part(rng)),
        _ => goal(rng),
    }
}

/// All runs with at most one fault, which comes in one of the first steps; each as what is injected by step.
fn all_runs(system: &System, steps: u32) -> Vec<BTreeMap<u32, (ComponentId, u8)>> {
    let mut runs = vec![BTreeMap::new()];
    for id in system.model.component_ids() {
        let broken = system.model.mode_named(id, "Broken").expect("switches break");
        runs.extend((1..=steps).map(|step| BTreeMap::from([(step, (id, broken))])));
    }
    runs
}

#[test]
fn random_programs_are_judged_as_their_runs_one_by_one_are() {
    const FIRST: u32 = 12;
    const LAST: u32 = 60;
    let mut seen = [[0; 2]; 3];
    for seed in 0..300 {
        let rng = &mut Rng::new(seed);
        let text = program(rng, 3);
        let system = system(&text, PLANT);
        let proof = proven(
            &system,
            &["never A = On AND B = On", "ends within 6 steps", "ends"],
            Scope { faults: 1, knowledge: Knowledge::Perfect, ..Scope::default() },
        );
        assert_eq!(proof.stopped, None, "{text}");
        let options = Options { knowledge: Knowledge::Perfect, ..Options::default() };
        let mut holds = [true; 3];
        for injected in all_runs(&system, FIRST) {
            let mut run = Run::new(&system, options);
            let both_on = |run: &Run| run.true_state().0.iter().all(|mode| *mode == 1);
            let mut is_wrong = both_on(&run);
            for step in 1..=LAST {
                if run.status() != RunStatus::Running {
                    break;
                }
                let now = injected.get(&step).map(|(id, mode)| (*id, *mode));
                run.step(&StepInput { injected: now.into_iter().collect(), ..StepInput::default() })
                    .expect("it is possible");
                is_wrong |= both_on(&run);
            }
            holds[0] &= !is_wrong;
            holds[1] &= run.is_done() && run.records().len() <= 6;
            holds[2] &= run.is_done();
        }
        for (at, (property, verdict)) in proof.verdicts.iter().enumerate() {
            assert_eq!(*verdict == Verdict::Holds, holds[at], "seed {seed}, {property}: {text}");
            seen[at][usize::from(holds[at])] += 1;
            if let Verdict::Broken(counterexample) = verdict {
                let run = replayed(&system, counterexample, Knowledge::Perfect);
                let is_shown = match at {
                    0 => run.true_state().0.iter().all(|mode| *mode == 1),
                    1 => !run.is_done() && run.records().len() == 6 || counterexample.end.is_some(),
                    _ => !run.is_done() && (counterexample.end != Some(End::Ended)),
                };
                assert!(is_shown, "seed {seed}, {property}: {text}\n{counterexample:?}");
            }
        }
    }
    let mut table = String::new();
    for [broken, held] in seen {
        let _ = write!(table, "{broken} broken, {held} hold; ");
        assert!(broken > 10 && held > 10, "{table}");
    }
}

/// Of what is estimated the probabilities change with every step, so that a program which waits comes to ever new beliefs.
#[test]
fn a_wait_under_a_belief_that_drifts_is_followed_for_long() {
    let system = system("(WHEN-DONEXT (B = On) (A = On))", PLANT);
    let proof = proven(&system, &["ends", "never A = On"], Scope { faults: 0, ..Scope::default() });
    assert!(proof.stopped.is_some_and(|why| why.contains("probabilities")));
    let Verdict::Broken(run) = &proof.verdicts[0].1 else { panic!("B is never switched on") };
    assert!(run.goes_on_for.is_some_and(|steps| steps >= 1000), "{run:?}");
    assert_eq!(proof.verdicts[1].1, Verdict::Open);
}

const DOUBTFUL: &str = "(DEFCLASS Lamp ()
    (VAR seen {dark lit} OBSERVABLE ERROR 0.1)
    (COMMAND cmd {none on})
    (MODE Off (seen = dark)) (MODE On (seen = lit))
    (TRANSITION Off On (cmd = on) 0.5))
  (DEFINSTANCE L Lamp INIT Off)";

#[test]
fn outcomes_fall_in_any_way_and_a_sensor_s_error_counts_as_a_fault() {
    let lamp = system("(L = On)", DOUBTFUL);
    // Each attempt succeeds with one half.
    let scope = Scope { faults: 0, knowledge: Knowledge::Perfect, ..Scope::default() };
    let proof = proven(&lamp, &["ends", "ends within 1", "L.seen = lit leads to L = On"], scope);
    assert_eq!(proof.verdicts[0].1, Verdict::Holds);
    let Verdict::Broken(run) = &proof.verdicts[1].1 else { panic!("it may fail at first") };
    assert_eq!(run.unusual(&lamp.model), ["1: L=Off"]);
    let chance = |steps| chance_to_end(&lamp, Knowledge::Perfect, steps, 100).expect("it can be computed");
    assert_eq!(chance(1), Interval::certain(Probability::new(1.into(), 2.into())));
    assert_eq!(chance(3), Interval::certain(Probability::new(7.into(), 8.into())));
    // What seems lit is taken for lit, though nothing but the sensor failed.
    let plant = "(DEFCLASS Lamp () (VAR seen {dark lit} OBSERVABLE ERROR 0.1)
        (MODE Off (seen = dark)) (MODE On (seen = lit)) (FAULT Off On 0.3))
      (DEFCLASS Door () (COMMAND cmd {none open}) (MODE Shut true) (MODE Open true)
        (TRANSITION Shut Open (cmd = open)))
      (DEFINSTANCE L Lamp INIT Off) (DEFINSTANCE D Door INIT Shut)";
    let door = system("(WHEN-DONEXT (L = On) (D = Open))", plant);
    let Verdict::Broken(run) = verdict(&door, "D = Open leads to L = On within 1", 1) else {
        panic!("an error opens the door")
    };
    assert_eq!(run.unusual(&door.model), ["1: L.seen=lit observed"]);
    assert!(!matches!(verdict(&door, "never D = Open", 0), Verdict::Broken(_)));
}

#[test]
fn what_modes_leave_open_is_observed_in_every_way() {
    let plant = "(DEFCLASS Gauge () (VAR level {low high} OBSERVABLE) (COMMAND cmd {none go})
        (MODE Idle true) (MODE Busy (level = high)) (TRANSITION Idle Busy (cmd = go)))
      (DEFINSTANCE G Gauge INIT Idle)";
    let gauge = system("(WHEN-DONEXT (G.level = high) (G = Busy))", plant);
    // The level of an idle gauge is either, again and again; it is not high for ever.
    assert_eq!(verdict(&gauge, "ends", 0), Verdict::Holds);
    let Verdict::Broken(run) = verdict(&gauge, "ends within 3", 0) else { panic!("it may stay low") };
    assert!(run.unusual(&gauge.model).is_empty());
    // What is left open may be either: never has to exclude it, and always has to be sure of it.
    for (property, holds) in [
        ("never G.level = high", false),
        ("always G.level = low", false),
        ("always (G.level = low) OR (G.level = high)", true),
        ("never (G.level = low) AND (G.level = high)", true),
        ("eventually G.level = high", true),
        ("G = Busy leads to G.level = high within 1", true),
        ("G.level = low leads to G = Busy within 3", false),
    ] {
        assert_eq!(verdict(&gauge, property, 0) == Verdict::Holds, holds, "{property}");
    }
    let Verdict::Broken(run) = verdict(&gauge, "never G = Busy", 0) else { panic!("it may be high") };
    assert_eq!(run.unusual(&gauge.model), ["1: G.level=high observed"]);
}

#[test]
fn more_conditions_than_bits_in_a_word_are_all_judged() {
    let system = system("(SEQUENCE (A = On) (B = On))", PLANT);
    let mut properties: Vec<String> =
        (0..70).map(|more| format!("never A = Broken{}", " ".repeat(more))).collect();
    properties.extend((0..70).map(|more| format!("always {}A = Off{}", "(".repeat(more), ")".repeat(more))));
    properties.push("never B = On".to_owned());
    let properties: Vec<&str> = properties.iter().map(String::as_str).collect();
    let proof = proven(&system, &properties, Scope { faults: 0, ..Scope::default() });
    let is_broken = |(_, verdict): &(Property, Verdict)| matches!(verdict, Verdict::Broken(_));
    assert!(!proof.verdicts[..70].iter().any(is_broken));
    assert!(proof.verdicts[70..].iter().all(is_broken));
}

#[test]
fn where_not_every_observation_was_explored_nothing_is_proven() {
    let lamps: String = (0..9).map(|at| format!(" (VAR l{at} {{dark lit}} OBSERVABLE)")).collect();
    let plant = format!(
        "(DEFCLASS Board (){lamps} (COMMAND cmd {{none go}}) (MODE Idle true) (MODE Busy true) \
         (TRANSITION Idle Busy (cmd = go))) (DEFINSTANCE G Board INIT Idle)"
    );
    // One of 512 combinations is all that would start it.
    let lit: Vec<String> = (0..9).map(|at| format!("(G.l{at} = lit)")).collect();
    let board = system(&format!("(WHEN-DONEXT ({}) (G = Busy))", lit.join(" AND ")), &plant);
    assert_eq!(verdict(&board, "never G = Busy", 0), Verdict::Open);
    assert_eq!(verdict(&board, "G.l0 = lit leads to G = Idle within 1", 0), Verdict::Open);
    let chance = chance_to_end(&board, Knowledge::Estimated, 2, 100).expect("it can be computed");
    assert!(chance.low < chance.high, "{chance:?}");
}

#[test]
fn at_least_one_state_is_explored() {
    let system = system("(A = On)", PLANT);
    let none = Scope { faults: 0, states: 0, ..Scope::default() };
    assert_eq!(proven(&system, &["never A = On"], none).verdicts[0].1, Verdict::Open);
}

#[test]
fn parts_that_do_nothing_in_any_run_are_warned_of_once_and_where_they_are() {
    const LAMPS: &str =
        "(DEFCLASS Lamp () (COMMAND cmd {none on}) (MODE Off true) (MODE On true) (MODE Dead true)
      (TRANSITION Off On (cmd = on)))
      (DEFINSTANCE A Lamp) (DEFINSTANCE B Lamp)";
    let (live, gone) = ("W-LIVENESS", "W-UNREACHABLE");
    for (program, plant, expected) in [
        ("(SEQUENCE (A = On) (B = On))", PLANT, vec![]),
        ("(SEQUENCE (ALWAYS (A = On)) (B = On))", PLANT, vec![(gone, "(B = On)")]),
        (
            "(SEQUENCE (ALWAYS true) (PARALLEL (A = On) (B = On)))",
            PLANT,
            vec![(gone, "(PARALLEL (A = On) (B = On))")],
        ),
        ("(IF-THENNEXT-ELSENEXT (B = On) (A = On) (A = Off))", LAMPS, vec![(gone, "(A = On)")]),
        ("(WHEN-DONEXT (B = On) (A = On))", LAMPS, vec![(live, "(WHEN-DONEXT (B = On) (A = On))")]),
        ("(WHENEVER-DONEXT (B = On) (A = On))", LAMPS, vec![(live, "(WHENEVER-DONEXT (B = On) (A = On))")]),
        ("(SEQUENCE (A = Dead) (B = On))", LAMPS, vec![(live, "(A = Dead)")]),
        ("(TIMEOUT 3 (A = Dead) (B = On))", LAMPS, vec![]),
        // What is known of the lamp is taken apart from the time: that it is on in time is not seen.
        ("(TIMEOUT 3 (A = On) (B = On))", LAMPS, vec![]),
        // Only a fault leads to what the handler waits for.
        ("(DO-WATCHING (A = On) (PARALLEL (A = On) (WHEN-DONEXT (A = Broken) (B = On))))", PLANT, vec![]),
        ("(CHOOSE-PROB (0.5 (A = On)) (0.5 (B = On)))", LAMPS, vec![]),
        ("(CHOOSE-REWARD (2 (A = On)) (1 (B = On)))", LAMPS, vec![]),
        (
            "(PARALLEL (LOCK (A = Off) (ALWAYS true)) (LOCK (A = On) (WAIT 1)))",
            LAMPS,
            vec![(live, "(LOCK (A = On) (WAIT 1))")],
        ),
    ] {
        let text = format!("P ():: {program}\n{plant}");
        // That nothing leads to a mode is a warning of the plant's own.
        let system = System::compile(&text, None).system.expect("it compiles");
        let found = idle_parts(&system, &mut || true).expect("all is looked at");
        let mut found: Vec<(&str, &str)> =
            found.iter().map(|it| (it.code.0, text.get(it.span.range()).expect("a place"))).collect();
        found.sort_by_key(|(code, _)| std::cmp::Reverse(*code));
        assert_eq!(found, expected, "{program}");
        assert_eq!(idle_parts(&system, &mut || false), None, "{program}: nothing is said without time");
    }
    // With very many outcomes of a step nothing is said.
    let many: String = (0..9).map(|at| format!("(DEFINSTANCE L{at} Switch) ")).collect();
    let goals: String = (0..9).map(|at| format!("(L{at} = On)")).collect();
    let system = system(&format!("(SEQUENCE (ALWAYS true) {goals})"), &format!("{PLANT} {many}"));
    assert_eq!(idle_parts(&system, &mut || true), None);
}

#[test]
fn parts_of_a_program_without_a_plant_are_idle_only_if_nothing_that_is_known_could_start_them() {
    for (program, expected) in [
        ("(SEQUENCE (ALWAYS (x = a)) (y = b))", vec!["(y = b)"]),
        ("(IF-THENNEXT-ELSENEXT (x = a) (y = a) (y = b))", vec![]),
        ("(WHEN-DONEXT false (y = b))", vec!["(WHEN-DONEXT false (y = b))"]),
        ("(SEQUENCE (CHOOSE-PROB (0.5 (ALWAYS true)) (0.5 (ALWAYS true))) (y = b))", vec!["(y = b)"]),
        ("(DO-WATCHING (x = a) (SEQUENCE (ALWAYS true) (y = b)))", vec!["(y = b)"]),
        ("(SEQUENCE (TIMEOUT 2 (ALWAYS true)) (y = b))", vec![]),
        ("(PARALLEL (LOCK (x = a) (WAIT 2)) (LOCK (x = b) (WAIT 2)))", vec![]),
    ] {
        let text = format!("P ():: {program}");
        let automaton = hca::compile_text(&text, &hca::Vocabulary::default()).automaton.expect("it compiles");
        let found = idle_parts_alone(&automaton, &mut || true).expect("all is looked at");
        let found: Vec<&str> = found.iter().map(|it| text.get(it.span.range()).expect("a place")).collect();
        assert_eq!(found, expected, "{program}");
        assert_eq!(idle_parts_alone(&automaton, &mut || false), None);
    }
}
