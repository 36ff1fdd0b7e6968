//! `E-BOUNDS`: bounds that no duration satisfies (SPEC 1.5).

use exact::{Bound, Time};

use crate::diagnostic::{Code, Diagnostic, Edit, Fix, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("E-BOUNDS");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "bounds that no duration satisfies",
    meaning: "A lower bound is a finite time of at least 0, and an upper bound is no smaller; `inf` may only be an upper bound. The
bounds of a call must leave something of those that the primitive or the activity declares: both hold. Bounds within
which nature chooses are finite, and those of a call lie within the declared ones. Bounds that depend on names are
checked with the values that they have in the scenario.",
    example: "primitive Drive()[30,20];
scenario Day[0,60] = { Drive() }",
    fix: "Swap the two sides, or correct one of them.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

pub(crate) fn negative(value: Time, span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, format!("a bound cannot be negative, and this is {value}"))
}

pub(crate) fn undefined(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "this bound has no value: it divides by zero or takes infinity away")
}

pub(crate) fn too_large(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "this bound is too large to be kept exactly")
}

pub(crate) fn endless(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "a lower bound must be finite")
        .with_hint("`inf` may only be an upper bound")
}

pub(crate) fn reversed(lower: (Bound, Span), upper: (Bound, Span), span: Span) -> Diagnostic {
    let message = format!("the lower bound {} is greater than the upper bound {}", lower.0, upper.0);
    let swap = Fix {
        label: "Swap the bounds".to_owned(),
        edits: vec![
            Edit { span: lower.1, text: upper.0.to_string() },
            Edit { span: upper.1, text: lower.0.to_string() },
        ],
    };
    Diagnostic::error(CODE, span, message).with_fix(swap)
}

/// Nature chooses from finite times.
pub fn unlimited(span: Span) -> Diagnostic {
    Diagnostic::error(CODE, span, "nature chooses from a finite range, and this upper bound is infinite")
        .with_hint("write the longest that it can take")
}

/// Stopping takes a finite time.
pub fn endless_abort(span: Span) -> Diagnostic {
    Diagnostic::error(
        CODE,
        span,
        "an activity that is aborted is over at some time, and this upper bound is infinite",
    )
    .with_hint("write the longest that stopping can take")
}

/// The contingent bounds of a call leave those of the declaration.
pub fn outside(name: &str, written: (Time, Bound), declared: (Time, Bound), span: Span) -> Diagnostic {
    let show = |(lower, upper): (Time, Bound)| format!("[{lower},{upper}]");
    let message = format!(
        "`{name}` is declared to last {}, and nature cannot choose from {} for this call",
        show(declared),
        show(written)
    );
    Diagnostic::error(CODE, span, message).with_hint(
        "contingent bounds of a call lie within the declared ones: make these narrower, or those wider",
    )
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
        format!("`{name}` is declared to last {}, which {} excludes", show(declared), show(written));
    Diagnostic::error(CODE, span, message).with_hint("both hold for the call: make them overlap")
}
