//! `E-AMBIGUOUS`: transitions of a plant model that say two things about one step. Only plants find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-AMBIGUOUS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "ambiguous transitions",
    meaning: "In one mode, two transitions to different modes are enabled by the same commands and conditions, so that the plant
would have to enter both. The message shows such an assignment. Transitions with equal guards may share the step as outcomes with
probabilities; at most one outcome of a guard has none.",
    example: "(DEFCLASS Valve () (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true) (MODE Stuck true)
  (TRANSITION Closed Open (cmd = open)) (TRANSITION Closed Stuck (cmd = open)))
(DEFINSTANCE V Valve)",
    fix: "Make the guards exclude each other, or give outcomes of one guard their probabilities.",
    mended: "(DEFCLASS Valve () (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true) (MODE Stuck true)
  (TRANSITION Closed Open (cmd = open)) (TRANSITION Closed Stuck (cmd = open) 0.01))
(DEFINSTANCE V Valve)",
};

/// Two guards of a mode that can hold together; `place` says where, such as `where V.cmd=open`.
pub fn guards(from: &str, first: &str, second: &str, place: &str, span: Span) -> Diagnostic {
    let message =
        format!("from `{from}`, the transitions to `{first}` and to `{second}` are both enabled {place}");
    Diagnostic::error(CODE, span, message)
        .with_hint("make the guards exclude each other, or write one guard with probabilities")
}

/// Two outcomes of one guard of which none has a probability; `place` says where the guard holds.
pub fn outcomes(from: &str, first: &str, second: &str, place: &str, span: Span) -> Diagnostic {
    let message = format!(
        "from `{from}`, one guard leads to `{first}` and to `{second}`, both without a probability, {place}"
    );
    Diagnostic::error(CODE, span, message).with_hint(
        "give all outcomes of a guard but one a probability, as in `(TRANSITION from to guard 0.1)`",
    )
}
