//! `E-BOUNDS`: invalid bounds (SPEC 1.5).

use exact::{Bound, Time};

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-BOUNDS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "invalid bounds",
    meaning: "The minimum must be a finite time of at least 0, and the maximum must not be smaller. Only the maximum may be
`inf`. Only the bounds of `constrain` may be negative. The bounds of a call must overlap the declared bounds, because both apply. `contingent` bounds must be finite, and
those of a call must lie within the declared ones. Bounds that contain names are checked with the values that the names have
in the scenario. In a control program, durations and the length of a step are finite and above 0, and the minimum of `WITHIN`
is at most its maximum. The option `horizon` is a whole number of steps.",
    example: "primitive Drive()[30,20];
scenario Day[0,60] = { Drive() }",
    fix: "Swap the two bounds, or correct one of them.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

pub(crate) fn negative(value: Time, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("a bound cannot be negative, but this one is {value}"))
}

pub(crate) fn undefined(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "this bound has no value: it divides by zero or subtracts infinity")
}

pub(crate) fn too_large(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "this bound is too large to represent exactly")
}

pub(crate) fn endless(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "the minimum must be finite").with_hint("only the maximum may be `inf`")
}

pub(crate) fn reversed(lower: (Bound, Span), upper: (Bound, Span), span: Span) -> Diagnostic {
    let message = format!("the minimum {} is greater than the maximum {}", lower.0, upper.0);
    let swap = Fix {
        label: "Swap the bounds".to_owned(),
        edits: vec![
            Edit { span: lower.1, text: upper.0.to_string() },
            Edit { span: upper.1, text: lower.0.to_string() },
        ],
    };
    Diagnostic::error(CODE, span, message).with_fix(swap)
}

/// A duration of a control program that no clock can count.
pub(crate) fn duration(text: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("a duration must be finite and above 0, but this one is `{text}`"))
}

/// A duration of a control program with too many digits.
pub fn too_long(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "this duration is too long or too precise to count exactly")
}

/// WARP divides durations.
pub(crate) fn factor(text: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("WARP needs a finite factor above 0, but this one is `{text}`"))
}

/// A horizon of a control program that is no number of steps.
pub(crate) fn horizon(text: &str, most: u32, span: Span) -> Diagnostic {
    let message = format!("the horizon must be a whole number of steps from 1 to {most}, not `{text}`");
    Diagnostic::error(CODE, span, message)
}

/// WITHIN with a minimum above its maximum.
pub fn within(least: &str, most: &str, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("the minimum {least} is greater than the maximum {most}"))
        .with_hint("WITHIN takes the minimum duration first, then the maximum")
}

/// The environment chooses from finite times.
pub fn unlimited(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "a contingent duration needs a finite maximum, but this one is infinite")
        .with_hint("give the longest time it can take")
}

/// Stopping takes a finite time.
pub fn endless_abort(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "aborting an activity needs a finite maximum, but this one is infinite")
        .with_hint("give the longest time that stopping can take")
}

/// The contingent bounds of a call leave those of the declaration.
pub fn outside(name: &str, written: (Time, Bound), declared: (Time, Bound), span: Span) -> Diagnostic {
    let show = |(lower, upper): (Time, Bound)| format!("[{lower},{upper}]");
    let message = format!(
        "`{name}` is declared with {}, but the contingent bounds {} of this call are not within it",
        show(declared),
        show(written)
    );
    Diagnostic::error(CODE, span, message)
        .with_hint("narrow the bounds of the call, or widen the declared ones")
}

/// The bounds of a call exclude those of the declaration.
pub(crate) fn disjoint(
    name: &str,
    written: (Time, Bound),
    declared: (Time, Bound),
    span: Span,
) -> Diagnostic {
    let show = |(lower, upper): (Time, Bound)| format!("[{lower},{upper}]");
    let message =
        format!("`{name}` is declared with {}, which does not overlap {}", show(declared), show(written));
    Diagnostic::error(CODE, span, message).with_hint("both bounds apply to the call: make them overlap")
}
