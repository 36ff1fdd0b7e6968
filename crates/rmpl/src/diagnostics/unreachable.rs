//! `W-UNREACHABLE`: modes of a plant model that nothing leads to. Only plants find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-UNREACHABLE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unreachable mode",
    meaning: "No component starts in this mode, and no transition or fault leads to it from where components start. Only a fault that is
injected by hand can bring a component there.",
    example: "(DEFCLASS Valve () (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true) (MODE Stuck true)
  (TRANSITION Closed Open (cmd = open)))
(DEFINSTANCE V Valve INIT Closed)",
    fix: "Add the transition or fault that leads to it, or remove the mode.",
    mended: "(DEFCLASS Valve () (COMMAND cmd {none open}) (MODE Closed true) (MODE Open true) (MODE Stuck true)
  (TRANSITION Closed Open (cmd = open)) (FAULT * Stuck 0.01))
(DEFINSTANCE V Valve INIT Closed)",
};

/// A mode that nothing leads to.
pub fn mode(class: &str, mode: &str, span: Span) -> Diagnostic {
    let message = format!("no transition or fault leads a `{class}` to the mode `{mode}`");
    Diagnostic::warning(CODE, span, message)
        .with_hint("add a transition or a fault, such as `(FAULT * Stuck 0.01)`, or remove the mode")
}
