//! Options and declarations that are added to a text.

use super::outline::{OutlineKind, outline};
use crate::diagnostic::Edit;
use crate::parse::Parse;
use crate::span::Span;

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
