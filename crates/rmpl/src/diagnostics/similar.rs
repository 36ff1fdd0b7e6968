//! `W-SIMILAR`: undeclared name that is similar to a declared one.

use crate::diagnostic::{Code, Diagnostic, Severity, some_of};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

pub const CODE: Code = Code("W-SIMILAR");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "undeclared name that is similar to a declared one",
    meaning: "This name is not declared, but it is one or two letters away from a declared name. As written, they are
unrelated.",
    example: "var PATH : {OPEN, SHUT};
scenario Day[0,60] = { PATH=OPEN [10,20]; PAHT=SHUT [10,20] }",
    fix: "Correct the name, or declare it.",
    mended: "var PATH : {OPEN, SHUT};
scenario Day[0,60] = { PATH=OPEN [10,20]; PATH=SHUT [10,20] }",
};

pub(crate) fn variable(written: &str, nearest: &str, span: Span) -> Diagnostic {
    alike(format!("`{written}` is not declared, but looks like `{nearest}`"), nearest, span)
}

pub(crate) fn callable(written: &str, nearest: &str, span: Span) -> Diagnostic {
    let message = format!("this asserts the condition `{written}`, but there is an activity `{nearest}`");
    alike(message, nearest, span)
}

pub(crate) fn location(written: &str, nearest: &str, span: Span) -> Diagnostic {
    alike(format!("unknown location `{written}`"), nearest, span)
}

fn alike(message: String, nearest: &str, span: Span) -> Diagnostic {
    Diagnostic::warning(CODE, span, message)
        .with_hint(format!("did you mean `{nearest}`?"))
        .with_fix(replacement(format!("Change to `{nearest}`"), span, nearest))
}

/// `X_V` where `X` is declared without a value `V`.
pub(crate) fn value(written: &str, variable: &str, domain: &[&str], span: Span) -> Diagnostic {
    let message = format!("`{written}` is an unrelated condition: `{variable}` has no such value");
    Diagnostic::warning(CODE, span, message).with_hint(format!("`{variable}` is one of {}", some_of(domain)))
}
