//! `E-NAME`: a bound names nothing (SPEC 1.4).

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::program::Name;
use crate::span::Span;

pub const CODE: Code = Code("E-NAME");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "a bound names nothing",
    meaning: "A name in a bound is one of the names in the header bounds of the same activity (in `Survey()[l,u] = { … }` they are `l`
and `u`, and stand for the bounds of the call), a parameter that stands for a number, or a constant: `const DAY = 24*60;`.",
    example: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, v] }
scenario Day[0,60] = { Survey()[20,30] }",
    fix: "Use a name of the header, or add the name to it.",
    mended: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, u] }
scenario Day[0,60] = { Survey()[20,30] }",
};

/// A name in an expression that neither the header nor a constant explains. `known` are the declaration's own names,
/// `constant` one that looks like it.
pub(crate) fn unknown(name: &str, span: Span, known: &[Name], constant: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("no number is called `{name}` here"));
    if let Some(constant) = constant {
        return diagnostic.with_fix(replacement(format!("Change to `{constant}`"), span, constant));
    }
    if name.contains('-') {
        return diagnostic
            .with_hint("outside square brackets a hyphen belongs to the name: write blanks around a minus");
    }
    if known.is_empty() {
        return diagnostic.with_hint(
            "names in bounds come from the header of the activity, `Name()[l,u] = { … }`, or from `const NAME = …;`",
        );
    }
    let names: Vec<String> = known.iter().map(|name| format!("`{}`", name.text)).collect();
    let diagnostic = diagnostic.with_hint(format!("the header binds {}", names.join(" and ")));
    known.iter().fold(diagnostic, |diagnostic, name| {
        let label = format!("Change to `{}`", name.text);
        diagnostic.with_fix(replacement(label, span, name.text.as_str()))
    })
}
