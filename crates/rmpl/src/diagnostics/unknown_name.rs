//! `E-NAME`: unknown name in a bound (SPEC 1.4).

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
    title: "unknown name in a bound",
    meaning: "A bound may contain constants (`const DAY = 24*60;`), numeric parameters of the activity, and the names of its
header bounds. In `Survey()[l,u] = { … }`, the names `l` and `u` are the bounds of the call.",
    example: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, v] }
scenario Day[0,60] = { Survey()[20,30] }",
    fix: "Use a name from the header, or add the name to the header.",
    mended: "primitive Drive()[20,30];
Survey()[l,u] = { Drive()[l, u] }
scenario Day[0,60] = { Survey()[20,30] }",
};

/// A name in an expression that neither the header nor a constant explains. `known` are the declaration's own names,
/// `constant` one that looks like it.
pub(crate) fn unknown(name: &str, span: Span, known: &[Name], constant: Option<&str>) -> Diagnostic {
    let diagnostic = Diagnostic::error(CODE, span, format!("unknown name `{name}` in a bound"));
    if let Some(constant) = constant {
        return diagnostic.with_fix(replacement(format!("Change to `{constant}`"), span, constant));
    }
    if name.contains('-') {
        return diagnostic
            .with_hint("outside square brackets, a hyphen is part of a name: put spaces around a minus");
    }
    if known.is_empty() {
        return diagnostic.with_hint(
            "use a name from the header of the activity, `Name()[l,u] = { … }`, or from `const NAME = …;`",
        );
    }
    let names: Vec<String> = known.iter().map(|name| format!("`{}`", name.text)).collect();
    let diagnostic = diagnostic.with_hint(format!("the header declares {}", names.join(" and ")));
    known.iter().fold(diagnostic, |diagnostic, name| {
        let label = format!("Change to `{}`", name.text);
        diagnostic.with_fix(replacement(label, span, name.text.as_str()))
    })
}
