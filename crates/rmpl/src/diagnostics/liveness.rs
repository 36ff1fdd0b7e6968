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
that no run reaches.",
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
    let never = match label.split_once(' ') {
        Some(("assert", goal)) => format!("no run achieves {goal}"),
        Some(("lock", constraint)) => format!("no run grants the lock {constraint}"),
        Some((_, condition)) => format!("no run makes {condition} true"),
        None => format!("{label} never ends"),
    };
    Diagnostic::warning(CODE, span, format!("{never}: this waits forever"))
        .with_hint("correct it, or enclose it in TIMEOUT or DO-WATCHING")
}
