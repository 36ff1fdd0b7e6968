//! `W-UNREACHABLE`: modes of a plant model that nothing leads to, and parts of a program that no run comes to. Only plants and
//! runs find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-UNREACHABLE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unreachable mode or part",
    meaning: "No component starts in this mode, and no transition or fault leads to it from where components start. Only a fault that is
injected by hand can bring a component there. While you type, Enroute also warns of parts of a control program that no run
reaches.",
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

/// A part of a control program that no run comes to.
pub fn part(span: Span) -> Diagnostic {
    Diagnostic::warning(CODE, span, "no run reaches this part of the program, with or without faults")
        .with_hint("remove it, or correct what comes before it")
}
