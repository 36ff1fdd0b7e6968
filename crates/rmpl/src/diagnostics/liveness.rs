//! `W-LIVENESS`: control programs that wait forever after faults. Only runs can find it.

use crate::diagnostic::{Code, Severity};
use crate::explanation::Explanation;

pub const CODE: Code = Code("W-LIVENESS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "control program waits forever after faults",
    meaning: "The program ends if no component fails. After one or two faults that no command can repair, the
program waits for a goal or a condition that never becomes true.",
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
