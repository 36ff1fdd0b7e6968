//! `W-WINDOW`: unreachable bounds, because a sequence never idles (SPEC 3.3).

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
    title: "unreachable bounds",
    meaning: "A sequence never waits between its parts. If the parts take at most 8, the sequence cannot take 10. If the
parts take at least 8, the sequence cannot end after 6. No plan can contain this part.",
    example: "primitive Drive()[2,3];
primitive Drill()[4,5];
scenario Day[10,20] = { Drive(); Drill() }",
    fix: "Add a `delay` where the sequence may wait, or correct the bounds.",
    mended: "primitive Drive()[2,3];
primitive Drill()[4,5];
scenario Day[10,20] = { Drive(); delay[0,inf]; Drill() }",
};

/// The parts of `statement` can take at most `most`, and `least` is asked for.
pub(crate) fn too_short(most: Bound, least: Time, statement: &Statement, span: Span) -> Diagnostic {
    let is_sequence = matches!(&statement.kind, StatementKind::Sequence(parts) if parts.len() > 1);
    let message = if is_sequence {
        format!("this sequence takes at most {most}, but must take at least {least}, and it never waits")
    } else {
        format!("this takes at most {most}, but must take at least {least}")
    };
    let mut diagnostic = Diagnostic::warning(CODE, span, message)
        .with_hint("add a `delay` where it may wait, or correct the bounds");
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
    let message = format!("this takes at least {least}, but must end within {most}");
    Diagnostic::warning(CODE, span, message)
}
