//! Programs in time, with locks and choices, by known answers.

use hca::{Automaton, Stepper, TraceStep, Vocabulary, compile_text};
use smol_str::SmolStr;

fn vocabulary() -> Vocabulary {
    let domain = |name: &str, values: &[&str]| {
        (SmolStr::new(name), values.iter().map(|value| SmolStr::new(*value)).collect::<Vec<_>>())
    };
    let domains = [domain("x", &["a", "b"]), domain("y", &["a", "b"]), domain("s", &["on", "off"])];
    Vocabulary { domains: domains.into(), ..Vocabulary::default() }
}

fn automaton(text: &str) -> std::sync::Arc<Automaton> {
    let compilation = compile_text(text, &vocabulary());
    assert_eq!(compilation.diagnostics, [], "{text}");
    compilation.automaton.expect("compiles")
}

fn codes(text: &str) -> Vec<&'static str> {
    compile_text(text, &vocabulary()).diagnostics.iter().map(|found| found.code.0).collect()
}

/// The goals of each step under these estimates, each `name=value` pairs, and what is marked at the end.
fn goals(text: &str, estimates: &[&str]) -> (Vec<String>, Vec<SmolStr>) {
    let automaton = automaton(text);
    let mut stepper = Stepper::new(&automaton);
    let mut goals = Vec::new();
    for estimate in estimates {
        goals.push(stepper.goals().join(" "));
        stepper.step(&automaton.estimate(estimate.split_whitespace().filter_map(|one| one.split_once('='))));
    }
    (goals, automaton.labels(stepper.marking()))
}

#[test]
fn a_wait_of_an_hour_is_one_location_and_every_start_of_it_ends() {
    let automaton = automaton("(DEFSTEP 10ms) (SEQUENCE (WAIT 1h) (x = a))");
    assert_eq!(automaton.locations.len(), 2);
    let mut stepper = Stepper::new(&automaton);
    let unknown = automaton.estimate([]);
    for _ in 0..360_000 {
        assert_eq!(automaton.labels(stepper.marking()), ["wait 1 h"]);
        stepper.step(&unknown);
    }
    assert_eq!(automaton.labels(stepper.marking()), ["assert x=a"]);
}

#[test]
fn a_trace_names_the_clocks_that_run_and_those_that_were_up() {
    let automaton = automaton("(TIMEOUT 2s (x = a) (EVERY 3 (y = a)))");
    let mut stepper = Stepper::new(&automaton);
    let name = |id: hca::ClockId| automaton.clock(id).expect("its own").label.to_string();
    let mut seen = Vec::new();
    for step in 1..=5 {
        let mut trace = TraceStep::at(&stepper, step);
        stepper.step_observed(&[automaton.estimate([("y", "a")])], &mut trace);
        let clocks: Vec<String> =
            trace.clocks.iter().map(|(id, left)| format!("{} {left}", name(*id))).collect();
        let elapsed: Vec<String> = trace.elapsed.iter().map(|id| name(*id)).collect();
        seen.push(format!("{}; {}", clocks.join(", "), elapsed.join(", ")));
    }
    let expected = [
        "TIMEOUT 2 s 2; ",
        "TIMEOUT 2 s 1; TIMEOUT 2 s",
        "EVERY 3 steps 3; ",
        "EVERY 3 steps 2; ",
        "EVERY 3 steps 1; EVERY 3 steps",
    ];
    assert_eq!(seen, expected);
}

#[test]
fn a_stepper_returns_to_where_its_clocks_stood() {
    let automaton = automaton("(SEQUENCE (WAIT 3) (x = a))");
    let mut stepper = Stepper::new(&automaton);
    let unknown = automaton.estimate([]);
    stepper.step(&unknown);
    let after_one = stepper.standing();
    stepper.step(&unknown);
    stepper.return_to(&after_one);
    stepper.step(&unknown);
    assert_eq!(automaton.labels(stepper.marking()), ["wait 3 steps"]);
    stepper.step(&unknown);
    assert_eq!(automaton.labels(stepper.marking()), ["assert x=a"]);
}

#[test]
fn warp_divides_every_duration_and_rounds_once() {
    let labels = |text: &str| automaton(text).clocks.iter().map(|clock| clock.steps).collect::<Vec<_>>();
    assert_eq!(labels("(WARP 2 (WARP 2 (WAIT 5)))"), [2]);
    assert_eq!(labels("P (d):: (AT d (x = a)) (WARP 3 (PARALLEL (P 7) (EVERY 10s (y = a))))"), [3, 4]);
    let held = automaton("(WARP 2 (WHEN-DONEXT (HELD 5 (x = a)) (y = a)))");
    assert_eq!((held.held.len(), held.held[0].steps), (1, 3));
}

#[test]
fn wrong_durations_locks_and_choices_are_found() {
    for (text, expected) in [
        ("(WAIT 0)", "E-BOUNDS"),
        ("(WAIT inf)", "E-BOUNDS"),
        ("(TIMEOUT -1s (x = a))", "E-BOUNDS"),
        ("(DEFSTEP 0s) (x = a)", "E-BOUNDS"),
        ("(WITHIN 5 3 (x = a))", "E-BOUNDS"),
        ("(WITHIN 3s 2 (x = a))", "E-BOUNDS"),
        ("(WARP 0 (WAIT 3))", "E-BOUNDS"),
        ("(DEFSTEP 1s) (DEFSTEP 2s) (x = a)", "E-DUP"),
        ("(DEFSTEP 3) (x = a)", "E-SYNTAX"),
        ("(WAIT 3x)", "E-SYNTAX"),
        ("(WAIT soon)", "E-SYNTAX"),
        ("(WAIT)", "E-ARITY"),
        ("(WHEN-DONEXT ((HELD 3 (x = a)) AND (y = a)) (x = b))", "E-CONSTRAINT"),
        ("(WHEN-DONEXT (NOT (HELD 3 (x = a))) (x = b))", "E-CONSTRAINT"),
        ("(WHEN-DONEXT (HELD 2 (HELD 3 (x = a))) (x = b))", "E-CONSTRAINT"),
        ("(HELD 3 (x = a))", "E-CONSTRAINT"),
        ("(LOCK (x = a) (PARALLEL (y = a) (LOCK (x = b) (y = b))))", "E-CONSTRAINT"),
        ("(LOCK ~(x = a) (y = a))", "E-CONSTRAINT"),
        ("(CHOOSE-PROB (0.5 (x = a)) (0.4 (x = b)))", "E-PROBABILITY"),
        ("(CHOOSE-PROB (0 (x = a)) (1 (x = b)))", "E-PROBABILITY"),
        ("(CHOOSE-REWARD (much (x = a)) (2 (x = b)))", "E-SYNTAX"),
        ("(CHOOSE-REWARD)", "E-ARITY"),
        ("(DEFOPTION horizon 0) (x = a)", "E-BOUNDS"),
        ("(DEFOPTION horizon 2.5) (x = a)", "E-BOUNDS"),
        ("(DEFOPTION horizon 10001) (x = a)", "E-BOUNDS"),
        ("(DEFOPTION horizon 5) (DEFOPTION horizon 6) (x = a)", "E-DUP"),
        ("(DEFOPTION horizn 5) (x = a)", "W-OPTION"),
    ] {
        assert_eq!(codes(text), [expected], "{text}");
    }
    assert_eq!(codes("Wait (v):: (v = a) (SEQUENCE (Wait x) (WAIT 2))"), Vec::<&str>::new(), "its own name");
}

#[test]
fn a_lock_is_granted_at_the_end_of_a_step_and_sets_aside_what_contradicts_it() {
    let text = "(PARALLEL (LOCK (x = a) (SEQUENCE (WAIT 2) (y = a))) (x = b))";
    // x=b is asserted until x=a is locked, and again when the lock is released.
    let (seen, left) = goals(text, &["", "x=b", "x=a", "x=a y=a", "x=b"]);
    assert_eq!(seen, ["x=b", "x=a", "x=a", "y=a", "x=b"].map(String::from).to_vec());
    assert_eq!(left, Vec::<SmolStr>::new());
}

#[test]
fn what_is_done_under_a_lock_is_dropped_when_its_constraint_is_lost() {
    let text = "(SEQUENCE (LOCK (x = a) (y = a)) (s = on))";
    let (seen, _) = goals(text, &["", "x=b", "x=a", "x=a", "x=b", ""]);
    assert_eq!(seen, ["", "x=a y=a", "x=a y=a", "y=a", "y=a", "s=on"].map(String::from).to_vec());
}

#[test]
fn locks_that_exclude_each_other_are_granted_in_the_order_of_the_text() {
    let text = "(PARALLEL (LOCK (x = a) (WAIT 2)) (LOCK (x = b) (WAIT 1)) (LOCK (y = a) (WAIT 1)))";
    let (seen, _) = goals(text, &["", "x=a y=a", "x=a", "", "x=b", ""]);
    // The third does not wait after the second; the second begins when the first has ended.
    assert_eq!(seen, ["", "x=a y=a", "", "x=b", "x=b", ""].map(String::from).to_vec());
}

#[test]
fn locks_that_wait_for_each_other_for_ever_are_a_deadlock() {
    let ring = "(PARALLEL (LOCK (x = a) (LOCK (y = a) (s = on))) (LOCK (y = b) (LOCK (x = b) (s = off))))";
    for (text, expected) in [
        (ring.to_owned(), Some("LOCK x=a, LOCK y=a, LOCK y=b, LOCK x=b")),
        (format!("(TIMEOUT 9 {ring})"), None),
        // The inner lock waits for one step only.
        ("(LOCK (x = a) (LOCK (y = a) (LOCK (z = a) (s = on))))".to_owned(), None),
    ] {
        let automaton = automaton(&text);
        let mut stepper = Stepper::new(&automaton);
        stepper.step(&automaton.estimate([]));
        stepper.step(&automaton.estimate([]));
        let found = hca::locks::deadlock(&[&mut stepper]);
        assert_eq!(found.map(|names| names.join(", ")).as_deref(), expected, "{text}");
    }
}

#[test]
fn a_choice_takes_no_step_and_without_chance_the_likeliest() {
    let (seen, left) =
        goals("(SEQUENCE (x = a) (CHOOSE-PROB (0.2 (x = b)) (0.5 (y = a)) (0.3 (y = b))))", &["x=a", "y=a"]);
    assert_eq!((seen, left), (vec!["x=a".to_owned(), "y=a".to_owned()], Vec::new()));
    // What is chosen later is left inside the join until then.
    let (seen, _) = goals(
        "(SEQUENCE (PARALLEL (SEQUENCE (WAIT 1) (CHOOSE-PROB (1 (x = b)))) (WAIT 1)) (y = a))",
        &["", "x=a", "x=b", ""],
    );
    assert_eq!(seen, ["", "x=b", "x=b", "y=a"].map(String::from).to_vec());
}

#[test]
fn a_choice_by_rewards_counts_when_its_alternative_completes() {
    let rewards = |text: &str, estimates: &[&str]| {
        let automaton = automaton(text);
        let estimates: Vec<_> =
            estimates.iter().map(|known| automaton.estimate(known.split_once('='))).collect();
        let run = hca::trace(&automaton, &estimates);
        let rewards: Vec<String> = run.steps.iter().map(|step| step.reward.to_string()).collect();
        rewards.join(" ")
    };
    // Without a plant, the largest reward is chosen.
    let choice = "(CHOOSE-REWARD (3 (SEQUENCE (x = a) (REWARD 1))) (2.5 (y = a)))";
    assert_eq!(rewards(choice, &["", "x=a", ""]), "0 0 4 0");
    // An alternative that is dropped from outside does not complete, and one that ends by its own watch does.
    assert_eq!(rewards(&format!("(DO-WATCHING (z = a) {choice})"), &["x=a", "z=a"]), "0 1 0");
    assert_eq!(rewards("(CHOOSE-REWARD (-1 (DO-WATCHING (z = a) (ALWAYS true))))", &["", "z=a"]), "0 -1 0");
    assert_eq!(rewards("(CHOOSE-REWARD (7 (ALWAYS true)))", &["", ""]), "0 0 0");
    // Every completion counts.
    let again = "(EVERY 2 (CHOOSE-REWARD (5 (WAIT 1))))";
    assert_eq!(rewards(again, &["", "", "", ""]), "5 0 5 0 0");
}

#[test]
fn a_reward_counts_in_the_step_in_which_it_is_marked() {
    let automaton = automaton("(SEQUENCE (REWARD 2.5) (PARALLEL (REWARD 1) (REWARD 1)))");
    let run = hca::trace(&automaton, &[automaton.estimate([]), automaton.estimate([])]);
    let rewards: Vec<String> = run.steps.iter().map(|step| step.reward.to_string()).collect();
    assert_eq!((rewards.join(" ").as_str(), run.terminated), ("2.5 2 0", true));
}

#[test]
fn drawings_name_the_clock_of_a_composite() {
    let dot = hca::dot::dot(&automaton("(TIMEOUT 5s (x = a) (AT 1min (y = a)))"));
    assert!(dot.contains("label=\"TIMEOUT 5 s\""), "{dot}");
    assert!(dot.contains("at 1 min") && dot.contains("label=\"time is up\""), "{dot}");
}
