//! `E-CONSTRAINT`: malformed constraint of a control program (SPEC 2.1). The prefix notation reports it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-CONSTRAINT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "malformed constraint",
    meaning: "A constraint compares a variable with a value, as in `(EngineA = Firing)`, negates one with `NOT`, or joins several with
`AND` or `OR`. It needs both sides of the `=`. In a plant model, something must satisfy the constraint of each mode and the guard of
each transition.",
    example: "(WHEN-DONEXT (EngineA =) (Camera = Off))",
    fix: "Write the missing part, or put parentheses around each comparison.",
    mended: "(WHEN-DONEXT (EngineA = Standby) (Camera = Off))",
};

/// A mode whose constraint contradicts itself.
pub fn impossible_mode(mode: &str, span: Span) -> Diagnostic {
    let message = format!("no values of the variables satisfy the constraint of the mode `{mode}`");
    Diagnostic::error(CODE, span, message)
        .with_hint("constraints of the same mode in inherited classes hold together")
}

/// A guard that contradicts itself.
pub fn impossible_guard(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "no values of the variables and commands satisfy this guard")
}
