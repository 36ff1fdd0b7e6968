//! `E-LIMIT`: a mission that expands to more than can be planned. Compilation reports it.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-LIMIT");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "mission too large",
    meaning: "The planner expands every call, and every copy of a `repeat`. If each activity calls another one twice, every
level doubles the network: 30 levels are a billion copies. The limits are 500,000 events, 200 levels of nesting, and 10,000
statements that `or` copies in one activity.",
    example: "primitive Step()[1,2];
Twice() = { Step(); Step() }
Four() = { Twice(); Twice() }
scenario Day[0,60] = { Four() }",
    fix: "Call the lowest-level activities fewer times, or plan one activity at a time.",
    mended: "primitive Step()[1,2];
Twice() = { Step(); Step() }
scenario Day[0,60] = { Twice() }",
};

/// Calls and `repeat`, written out, have more than `most` events; `what` has them.
pub fn events(what: &str, most: usize, span: Span) -> Diagnostic {
    let message = format!("after expanding calls and `repeat`, {what} more than {most} events");
    Diagnostic::error(CODE, span, message).with_hint(
        "make fewer copies, call the lowest-level activities fewer times, or plan one activity at a time",
    )
}

/// A bound relates more than `most` pairs; `what` make them.
pub fn pairs(what: &str, most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(
        CODE,
        span,
        format!("after expanding calls and `repeat`, {what} more than {most} pairs"),
    )
}

/// Statements and the calls in them are nested deeper than `most` levels.
pub fn nested(most: usize, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("statements and calls are nested deeper than {most} levels"))
}

/// `or` copies more than `most` statements.
pub(crate) fn copied(most: usize, span: Span) -> Diagnostic {
    let message = format!("after expanding `or`, this needs more than {most} statements");
    Diagnostic::error(CODE, span, message)
        .with_hint("`or` copies the statements next to it once for each condition")
}
