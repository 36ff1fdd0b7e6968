//! `W-WINDOW`: bounds that the parts cannot meet, because a sequence never idles (SPEC 3.3).

use exact::{Bound, Time};

use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::explanation::Explanation;
use crate::parser::insertion;
use crate::program::{Statement, StatementKind};
use crate::span::Span;

pub const CODE: Code = Code("W-WINDOW");

/// What it means, with an example.
pub const EXPLANATION: Explanation = Explanation {
    code: CODE,
    severity: Severity::Warning,
    title: "bounds that the parts cannot meet",
    meaning: "The parts of a sequence follow each other without a pause: a sequence never idles. If all parts together can take at most
8, the sequence cannot last 10; and if they take at least 8, it cannot be over after 6. Every plan with this part fails.",
    example: "primitive Drive()[2,3];
primitive Drill()[4,5];
scenario Day[10,20] = { Drive(); Drill() }",
    fix: "Put a `delay` where the sequence may wait, or correct the bounds.",
    mended: "primitive Drive()[2,3];
primitive Drill()[4,5];
scenario Day[10,20] = { Drive(); delay[0,inf]; Drill() }",
};

/// The parts of `statement` can take at most `most`, and `least` is asked for.
pub(crate) fn too_short(most: Bound, least: Time, statement: &Statement, span: Span) -> Diagnostic {
    let is_sequence = matches!(&statement.kind, StatementKind::Sequence(parts) if parts.len() > 1);
    let message = if is_sequence {
        format!(
            "this sequence is over after {most} at the latest, and is to last at least {least}: it never idles"
        )
    } else {
        format!("this is over after {most} at the latest, and is to last at least {least}")
    };
    let mut diagnostic = Diagnostic::warning(CODE, span, message)
        .with_hint("put a `delay` where it may wait, or correct the bounds");
    if let StatementKind::Sequence(parts) = &statement.kind
        && let Some(last) = parts.last()
    {
        let place = last.span.end;
        diagnostic =
            diagnostic.with_fix(insertion("Wait at the end with `delay[0,inf]`", place, "; delay[0,inf]"));
    }
    diagnostic
}

/// The parts take at least `least`, and `most` is allowed.
pub(crate) fn too_long(least: Time, most: Bound, span: Span) -> Diagnostic {
    let message = format!("this takes at least {least}, and is to be over after {most}");
    Diagnostic::warning(CODE, span, message)
}
