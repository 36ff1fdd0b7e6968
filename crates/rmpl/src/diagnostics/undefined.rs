//! `E-UNDEF` and `W-UNDEF`: a name that is used but not declared (SPEC 1.4).

use crate::analysis::Call;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::replacement;
use crate::span::Span;

/// The code under `option strict = 1;`.
pub const CODE: Code = Code("E-UNDEF");

/// The code otherwise.
pub const WARNING: Code = Code("W-UNDEF");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Error,
    title: "an undeclared name, where the mission asks for strictness",
    meaning: "Under `option strict = 1;` every activity that is called must be declared as a primitive or defined, and every vehicle
and location that the world mentions must be declared.",
    example: "option strict = 1;
scenario Day[0,60] = { Drive() }",
    fix: "Declare the name, correct it, or leave out the option.",
    mended: "option strict = 1;
primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// What it means, with an example.
pub const WARNING_EXPLANATION: Explanation = Explanation {
    code: WARNING,
    severity: Severity::Warning,
    title: "an undeclared name",
    meaning: "An undeclared activity is taken for a primitive that may last any time, `[0,inf]`. That is what the paper's own listing
needs, but it is also what a misspelled name gets.",
    example: "scenario Day[0,60] = { Drive() }",
    fix: "Declare the primitive with its duration, or correct the name.",
    mended: "primitive Drive()[20,30];
scenario Day[0,60] = { Drive() }",
};

/// A call of something that the file does not declare.
pub(crate) fn call(name: &str, call: &Call, nearest: Option<&str>, is_strict: bool) -> Diagnostic {
    let message = format!("no activity or primitive `{name}` is declared");
    let mut diagnostic = severity(call.span, message, is_strict);
    if let Some(nearest) = nearest {
        return diagnostic.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
            format!("Change to `{nearest}`"),
            call.span,
            nearest,
        ));
    }
    if !is_strict {
        diagnostic = diagnostic.with_hint("it is taken for a primitive that may last any time, [0,inf]");
    }
    diagnostic
}

/// A vehicle or a location that the world mentions but does not declare.
pub(crate) fn world(
    what: &str,
    name: &str,
    span: Span,
    nearest: Option<&str>,
    is_strict: bool,
) -> Diagnostic {
    let diagnostic = severity(span, format!("no {what} `{name}` is declared"), is_strict);
    match nearest {
        Some(nearest) => diagnostic.with_hint(format!("did you mean `{nearest}`?")).with_fix(replacement(
            format!("Change to `{nearest}`"),
            span,
            nearest,
        )),
        None => diagnostic,
    }
}

fn severity(span: Span, message: String, is_strict: bool) -> Diagnostic {
    if is_strict {
        Diagnostic::error(CODE, span, message)
    } else {
        Diagnostic::warning(WARNING, span, message)
    }
}
