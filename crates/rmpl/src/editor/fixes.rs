//! Quick fixes at a place.

use crate::diagnostic::{Diagnostic, Fix};
use crate::parse::Parse;
use crate::span::Span;

/// The fixes of all diagnostics that touch `range`, with the diagnostic that each mends, in textual order.
pub fn fixes_at(parse: &Parse, range: Span) -> Vec<(Diagnostic, Fix)> {
    let touches = |span: Span| span.start <= range.end && range.start <= span.end;
    let concerned = parse.diagnostics().into_iter().filter(|found| touches(found.span));
    concerned
        .flat_map(|found| {
            let fixes = found.fixes.clone();
            fixes.into_iter().map(move |fix| (found.clone(), fix))
        })
        .collect()
}
