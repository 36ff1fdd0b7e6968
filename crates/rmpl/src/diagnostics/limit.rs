//! `E-LIMIT`: a mission that expands to more than can be planned. Compilation reports it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-LIMIT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "a mission that expands to too much",
    meaning: "Every call is written out in full, and so is every copy of a `repeat`. Activities that each call another one twice double the
network with every level: thirty levels are a thousand million copies. A mission of more than 500,000 events, or nested
deeper than 200 levels, is refused before it fills the memory; so is an activity in which `or` copies more than 10,000
statements.",
    example: "primitive Step()[1,2];
Twice() = { Step(); Step() }
Four() = { Twice(); Twice() }
scenario Day[0,60] = { Four() }",
    fix: "Call the activities of the lowest levels fewer times, or plan one activity at a time.",
    mended: "primitive Step()[1,2];
Twice() = { Step(); Step() }
scenario Day[0,60] = { Twice() }",
};

/// Calls and `repeat`, written out, have more than `most` events; `what` has them.
pub fn events(what: &str, most: usize, span: Span) -> Diagnostic {
    let message = format!("with calls and `repeat` written out, {what} more than {most} events");
    Diagnostic::error(CODE, span, message).with_hint(
        "make fewer copies, call the lowest activities fewer times, or plan one activity at a time",
    )
}

/// A bound relates more than `most` pairs; `what` make them.
pub fn pairs(what: &str, most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(
        CODE,
        span,
        format!("with calls and `repeat` written out, {what} more than {most} pairs"),
    )
}

/// Statements and the calls in them are nested deeper than `most` levels.
pub fn nested(most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("statements and calls are nested deeper than {most} levels"))
}

/// `or` copies more than `most` statements.
pub(crate) fn copied(most: usize, span: Span) -> Diagnostic {
    let message = format!("written out, the choices of `or` take more than {most} statements here");
    Diagnostic::error(CODE, span, message)
        .with_hint("`or` writes what stands beside it once for each condition")
}
