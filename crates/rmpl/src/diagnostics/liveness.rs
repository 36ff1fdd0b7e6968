//! `W-LIVENESS`: control programs that wait forever, after faults or in every run. Only runs can find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-LIVENESS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "control program waits forever",
    meaning: "The program ends if no component fails. After one or two faults that no command can repair, the
program waits for a goal or a condition that never becomes true. While you type, Enroute also warns of goals, conditions and locks
that are waited for, and come in no run.",
    example: "(PARALLEL (Engine = Firing))
(DEFCLASS Engine () (COMMAND cmd {none fire}) (MODE Off true) (MODE Firing true) (MODE Failed true)
  (TRANSITION Off Firing (cmd = fire)) (FAULT Off Failed 0.01))
(DEFINSTANCE Engine Engine INIT Off)",
    fix: "Enclose the part that waits in DO-WATCHING, with a condition that holds after the faults.",
    mended: "(DO-WATCHING (Engine = Failed) (PARALLEL (Engine = Firing)))
(DEFCLASS Engine () (COMMAND cmd {none fire}) (MODE Off true) (MODE Firing true) (MODE Failed true)
  (TRANSITION Off Firing (cmd = fire)) (FAULT Off Failed 0.01))
(DEFINSTANCE Engine Engine INIT Off)",
};

/// A goal, a condition or a lock that is waited for and comes in no run.
pub fn never(label: &str, span: Span) -> Diagnostic {
    let (verb, what) = match label.split_once(' ') {
        Some(("assert", goal)) => ("is achieved", format!("the goal {goal}")),
        Some(("lock", constraint)) => ("is granted", format!("the lock {constraint}")),
        Some((_, condition)) => ("holds", format!("the condition {condition}")),
        None => ("ends", label.to_owned()),
    };
    Diagnostic::warning(CODE, span, format!("{what} {verb} in no run, so this waits forever"))
        .with_hint("correct it, or enclose it in TIMEOUT or DO-WATCHING")
}
