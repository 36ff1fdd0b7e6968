//! Semantic highlighting.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::SyntaxKind;

use super::name::{NameKind, names_in};

/// How a piece of text is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HighlightKind {
    /// A comment.
    Comment,
    /// A word of the language, also one that is reserved only in its place.
    Keyword,
    /// An activity or a primitive.
    Activity,
    /// A scenario.
    Scenario,
    /// A state variable or an atom.
    Variable,
    /// A value of a variable.
    Value,
    /// A parameter.
    Parameter,
    /// A name of the header's bounds.
    BoundName,
    /// A location or an obstacle.
    Location,
    /// A vehicle or its model.
    Vehicle,
    /// An option or its value.
    Option,
    /// A symbol handed to an activity.
    Symbol,
    /// A number or `inf`.
    Number,
    /// A text in quotes.
    String,
    /// An operator: `=`, `!=`, `!`, `%`, `+`, `-`, `*`, `/`.
    Operator,
    /// Brackets and separators.
    Punctuation,
    /// Characters without meaning.
    Unknown,
}

/// A piece of text and how it is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Highlight {
    /// The piece.
    pub span: Span,
    /// How it is shown.
    pub kind: HighlightKind,
    /// Whether it is a name that is declared here.
    pub is_definition: bool,
}

/// Everything in `range` that is shown in a way of its own, in textual order, without overlaps. Looks only at the
/// declarations that `range` touches.
pub fn highlight(parse: &Parse, range: Span) -> Vec<Highlight> {
    let mut found = Vec::new();
    for root in parse.declarations_in(range) {
        let names = names_in(parse, root);
        let mut next_name = names.iter().peekable();
        for token in root.tokens().filter(|token| token.kind != SyntaxKind::Whitespace) {
            if token.span.end < range.start || token.span.start > range.end {
                continue;
            }
            while next_name.next_if(|name| name.span.end <= token.span.start).is_some() {}
            let mut is_name = false;
            while let Some(name) = next_name.next_if(|name| name.span.end <= token.span.end) {
                is_name = true;
                let kind = of_name(&name.kind);
                found.push(Highlight { span: name.span, kind, is_definition: name.is_definition });
            }
            if !is_name {
                found.push(Highlight { span: token.span, kind: of_token(token.kind), is_definition: false });
            }
        }
    }
    found
}

const fn of_name(kind: &NameKind) -> HighlightKind {
    match kind {
        NameKind::Activity | NameKind::ControlProgram => HighlightKind::Activity,
        NameKind::Variable => HighlightKind::Variable,
        NameKind::Value(_) => HighlightKind::Value,
        NameKind::Parameter => HighlightKind::Parameter,
        NameKind::BoundName => HighlightKind::BoundName,
        NameKind::Scenario => HighlightKind::Scenario,
        NameKind::Location | NameKind::Obstacle => HighlightKind::Location,
        NameKind::Vehicle | NameKind::Model => HighlightKind::Vehicle,
        NameKind::Option | NameKind::OptionValue => HighlightKind::Option,
        NameKind::Symbol => HighlightKind::Symbol,
    }
}

fn of_token(kind: SyntaxKind) -> HighlightKind {
    match kind {
        SyntaxKind::LineComment | SyntaxKind::BlockComment => HighlightKind::Comment,
        SyntaxKind::Unknown => HighlightKind::Unknown,
        SyntaxKind::Number | SyntaxKind::Infinity => HighlightKind::Number,
        SyntaxKind::String => HighlightKind::String,
        // A name that stands for nothing is a word of the language in its place: `moves`, `at`, `circle`.
        SyntaxKind::Name => HighlightKind::Keyword,
        SyntaxKind::Equals
        | SyntaxKind::NotEquals
        | SyntaxKind::Bang
        | SyntaxKind::Percent
        | SyntaxKind::Plus
        | SyntaxKind::Minus
        | SyntaxKind::Star
        | SyntaxKind::Slash => HighlightKind::Operator,
        kind if kind.is_keyword() => HighlightKind::Keyword,
        _ => HighlightKind::Punctuation,
    }
}
