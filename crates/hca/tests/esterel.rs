//! The rows of the correspondence table with Esterel (SPEC 8.2), each run.

use std::collections::BTreeSet;

use hca::{Vocabulary, compile_text, trace};
use smol_str::SmolStr;

/// The labels of the marked locations per step under estimates written `name=value name=value`.
fn run(text: &str, estimates: &[&str]) -> Vec<String> {
    let vocabulary =
        Vocabulary { program_variables: BTreeSet::from([SmolStr::new("exit")]), ..Vocabulary::default() };
    let compilation = compile_text(text, &vocabulary);
    assert_eq!(compilation.diagnostics, []);
    let automaton = compilation.automaton.expect("compiles");
    let estimates: Vec<_> = estimates
        .iter()
        .map(|known| automaton.estimate(known.split_whitespace().filter_map(|pair| pair.split_once('='))))
        .collect();
    trace(&automaton, &estimates).steps.iter().map(|step| step.labels.join(", ")).collect()
}

#[test]
fn pause_lasts_one_step() {
    assert_eq!(run("(SEQUENCE true (x = a))", &["", "x=a"]), ["assert true", "assert x=a", ""]);
}

#[test]
fn halt_never_ends() {
    assert_eq!(run("(ALWAYS true)", &["", ""]), ["always, assert true"; 3]);
}

#[test]
fn await_ends_with_its_signal() {
    let text = "(SEQUENCE (DO-WATCHING (s = on) (ALWAYS true)) (x = a))";
    assert_eq!(
        run(text, &["s=off", "s=on", "x=a"]),
        ["always, assert true", "always, assert true", "assert x=a", ""]
    );
}

#[test]
fn await_immediately_followed_by_its_body_is_when() {
    assert_eq!(
        run("(WHEN-DONEXT (s = on) (x = a))", &["", "s=on", "x=a"]),
        ["when s=on", "when s=on", "assert x=a", ""]
    );
}

#[test]
fn a_trap_ends_its_body_in_the_step_that_exits() {
    let text = "(SEQUENCE (DO-WATCHING (exit = true) (PARALLEL (ALWAYS (y = b)) (SEQUENCE (x = a) (exit = true)))) (z = c))";
    assert_eq!(
        run(text, &["", "x=a", "", "z=c"]),
        [
            "always, assert x=a, assert y=b",
            "always, assert x=a, assert y=b",
            "always, assert exit=true, assert y=b",
            "assert z=c",
            ""
        ]
    );
}

#[test]
fn an_exit_is_forgotten_after_its_step() {
    // The second trap opens one step after the exit: the exit must not end it.
    let text = "(SEQUENCE (exit = true) (DO-WATCHING (exit = true) (x = a)) (y = b))";
    assert_eq!(
        run(text, &["", "", "x=a", "y=b"]),
        ["assert exit=true", "assert x=a", "assert x=a", "assert y=b", ""]
    );
}

#[test]
fn a_weak_abort_lets_the_body_have_the_step_of_the_signal() {
    let text = "(DO-WATCHING (exit = true) (PARALLEL (ALWAYS (y = b)) (WHEN-DONEXT (s = on) (exit = true))))";
    assert_eq!(
        run(text, &["s=on", "s=off"]),
        ["always, assert y=b, when s=on", "always, assert exit=true, assert y=b", ""]
    );
}

#[test]
fn an_abort_with_a_handler_runs_the_handler_instead_of_the_body() {
    let text = "(PARALLEL (DO-WATCHING (s = on) (x = a)) (WHEN-DONEXT (s = on) (y = b)))";
    assert_eq!(
        run(text, &["", "s=on", "y=b"]),
        ["assert x=a, when s=on", "assert x=a, when s=on", "assert y=b", ""]
    );
}

#[test]
fn every_restarts_its_body_at_each_signal() {
    let text = "(WHENEVER-DONEXT (s = on) (DO-WATCHING (s = on) (SEQUENCE (x = a) (y = b))))";
    assert_eq!(
        run(text, &["s=on", "x=a", "s=on", "s=on"]),
        [
            "whenever s=on",
            "assert x=a, whenever s=on",
            "assert y=b, whenever s=on",
            "assert x=a, whenever s=on",
            "assert x=a, whenever s=on"
        ]
    );
}

#[test]
fn a_watched_bar_maintains_its_condition() {
    let text = "(SEQUENCE (DO-WATCHING ~(c = on) (ALWAYS (x = a))) (y = b))";
    assert_eq!(
        run(text, &["c=on", "", "y=b"]),
        ["always, assert x=a", "always, assert x=a", "assert y=b", ""]
    );
}
