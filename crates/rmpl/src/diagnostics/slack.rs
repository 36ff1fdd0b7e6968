//! `W-SLACK`: bounds without effect.

use exact::{Bound, Time};

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

pub const CODE: Code = Code("W-SLACK");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "bounds without effect",
    meaning: "The activities already stay within these bounds, so the bounds have no effect. Common causes are bounds on the
wrong part, or a time in the wrong unit.",
    example: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive()[10,40] }",
    fix: "Remove the bounds, or correct them.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive()[25,40] }",
};

/// Bounds at `span` around something that lasts `own` anyway.
pub(crate) fn never_binds(own: (Time, Bound), span: Span) -> Diagnostic {
    let message = format!("these bounds have no effect: this takes [{},{}] anyway", own.0, own.1);
    Diagnostic::warning(CODE, span, message).with_fix(replacement("Remove the bounds", span, ""))
}
