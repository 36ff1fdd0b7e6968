//! `W-UNUSED`: unused declaration.

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::span::Span;

pub const CODE: Code = Code("W-UNUSED");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "unused declaration",
    meaning: "No scenario or activity of the file uses this declaration. The usual reason is a misspelled name.",
    example: "primitive Drive()[20,30];
primitive Drill()[20,30];
scenario Day[0,60] = { Drive() }",
    fix: "Use the declaration, or remove it.",
    mended: "primitive Drive()[20,30];
primitive Drill()[20,30];
scenario Day[0,60] = { Drive(); Drill() }",
};

/// A declaration that nothing uses.
pub(crate) fn unused(what: &str, name: &str, span: Span) -> Diagnostic {
    Diagnostic::warning(CODE, span, format!("the {what} `{name}` is never used"))
}
