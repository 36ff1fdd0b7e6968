//! Quick fixes at a place.

use super::outline::{OutlineKind, outline};
use crate::diagnostic::{Diagnostic, Edit, Fix};
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

/// Gives an option a value: where it is set, or else in a line of its own before the first declaration with a name.
pub fn set_option(parse: &Parse, name: &str, value: &str) -> Edit {
    let declarations = outline(parse);
    let text = format!("option {name} = {value};");
    match declarations.iter().find(|item| item.kind == OutlineKind::Option && item.name == name) {
        Some(set) => Edit { span: set.span, text },
        None => add_declaration(parse, &text),
    }
}

/// Adds a declaration, in a line of its own before the first one.
pub fn add_declaration(parse: &Parse, text: &str) -> Edit {
    let start = outline(parse).first().map_or(0, |first| first.span.start);
    Edit { span: Span::new(start, start), text: format!("{text}\n") }
}
