//! `E-SIZE`: a class whose behavior has too many modes or transitions. Only plants find it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-SIZE");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "behavior too large",
    meaning: "A class with a `BEHAVIOR` has a mode for each marking of its program, together with the time left of its clocks. Waiting for
many steps, or several waits in parallel, make more modes than a class can have.",
    example: "(DEFCLASS Heater () (VAR heat {cold warm}) (BEHAVIOR (SEQUENCE (WAIT 1000) (heat = warm))))
(DEFINSTANCE H Heater)",
    fix: "Use longer steps (`DEFSTEP`), shorter durations, or a transition with a probability instead of a wait.",
    mended: "(DEFCLASS Heater () (VAR heat {cold warm}) (BEHAVIOR (SEQUENCE (WAIT 10) (heat = warm))))
(DEFINSTANCE H Heater)",
};

/// More modes than a class can have.
pub fn modes(most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("this behavior has more than {most} modes"))
        .with_hint("use longer steps, or shorter durations: each step of a wait is a mode")
}

/// More transitions than are written out.
pub fn transitions(most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("this behavior has more than {most} transitions"))
        .with_hint("let each step depend on fewer conditions")
}

/// More combinations of answers to conditions than are followed.
pub fn answers(most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(
        CODE,
        span,
        format!("the steps of this behavior depend on more than {most} combinations of conditions"),
    )
    .with_hint("let each step depend on fewer conditions")
}

/// Probabilities that cannot be calculated with exactly.
pub fn digits(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "the probabilities of this behavior have too many digits")
        .with_hint("write fewer digits, or fractions with equal denominators")
}
