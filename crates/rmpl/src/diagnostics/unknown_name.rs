//! `E-NAME`: a bound names nothing (SPEC 1.4).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::program::Name;
use crate::span::Span;

/// The code.
pub const CODE: Code = Code("E-NAME");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "a bound names nothing",
    meaning: "A name in a bound is one of the names in the header bounds of the same activity: in `Survey()[l,u] = { … }` they are `l`
and `u`, and stand for the bounds of the call. Primitives and scenarios have no such names, and parameters in round
parentheses stand for arguments, not for times.",
    example: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, v] }
scenario Day[0,60] = { Survey()[20,30] }",
    fix: "Use a name of the header, or add the name to it.",
    mended: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, u] }
scenario Day[0,60] = { Survey()[20,30] }",
};

/// A name in a bound that the header does not bind.
pub(crate) fn unknown(name: &str, span: Span, known: &[Name]) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no bound is called `{name}` here"));
    if known.is_empty() {
        return diagnostic
            .with_hint("names in bounds come from the header of the activity: `Name()[l,u] = { … }`");
    }
    let names: Vec<String> = known.iter().map(|name| format!("`{}`", name.text)).collect();
    let diagnostic = diagnostic.with_hint(format!("the header binds {}", names.join(" and ")));
    known.iter().fold(diagnostic, |diagnostic, name| {
        let label = format!("Change to `{}`", name.text);
        diagnostic.with_fix(replacement(label, span, name.text.as_str()))
    })
}
