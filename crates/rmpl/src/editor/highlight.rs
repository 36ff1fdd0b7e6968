//! Semantic highlighting.

use crate::control;
use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::SyntaxKind;

use super::name::{NameKind, names_in};

/// How a piece of text is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HighlightKind {
    Comment,
    /// A word of the language, also one that is reserved only in its place.
    Keyword,
    /// An activity or a primitive.
    Activity,
    Scenario,
    /// A state variable, an atom or a resource.
    Variable,
    /// A value of a variable.
    Value,
    Parameter,
    /// A name of the header's bounds.
    BoundName,
    /// A location or an obstacle.
    Location,
    /// A vehicle, its model, or a group.
    Vehicle,
    /// An option or its value.
    Option,
    /// A symbol handed to an activity, or the name of an occurrence.
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
            if token.kind == SyntaxKind::ControlText {
                found.extend(control_block(token.text, token.span.start));
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

/// A control block: the word, the braces, and between them what prefix notation shows.
fn control_block(text: &str, start: u32) -> Vec<Highlight> {
    let piece = |from: usize, to: usize, kind: HighlightKind| {
        let span = Span::new(start + from as u32, start + to as u32);
        Highlight { span, kind, is_definition: false }
    };
    let open = text.find('{').unwrap_or(text.len());
    let word = text.len() - text.trim_start_matches(|letter: char| letter.is_ascii_lowercase()).len();
    let mut found = vec![piece(0, word, HighlightKind::Keyword)];
    let Some(inner) = text.get(open + 1..) else { return found };
    found.push(piece(open, open + 1, HighlightKind::Punctuation));
    let inner = inner.strip_suffix('}').unwrap_or(inner);
    for highlight in control::highlight(inner, &control::parse(inner)) {
        let (from, to) = (highlight.span.start as usize, highlight.span.end as usize);
        found.push(piece(open + 1 + from, open + 1 + to, of_control(highlight.kind)));
    }
    if open + 1 + inner.len() < text.len() {
        found.push(piece(text.len() - 1, text.len(), HighlightKind::Punctuation));
    }
    found
}

const fn of_control(kind: control::HighlightKind) -> HighlightKind {
    match kind {
        control::HighlightKind::Keyword => HighlightKind::Keyword,
        control::HighlightKind::Definition => HighlightKind::Activity,
        control::HighlightKind::Variable => HighlightKind::Variable,
        control::HighlightKind::Value => HighlightKind::Value,
        control::HighlightKind::Bar => HighlightKind::Operator,
        control::HighlightKind::Punctuation => HighlightKind::Punctuation,
        control::HighlightKind::Comment => HighlightKind::Comment,
    }
}

const fn of_name(kind: &NameKind) -> HighlightKind {
    match kind {
        NameKind::Activity | NameKind::ControlProgram => HighlightKind::Activity,
        NameKind::Variable | NameKind::Resource | NameKind::Equipment => HighlightKind::Variable,
        NameKind::Value(_) => HighlightKind::Value,
        NameKind::Parameter => HighlightKind::Parameter,
        NameKind::BoundName | NameKind::Constant => HighlightKind::BoundName,
        NameKind::Scenario => HighlightKind::Scenario,
        NameKind::Location | NameKind::Obstacle => HighlightKind::Location,
        NameKind::Vehicle | NameKind::Model | NameKind::Group => HighlightKind::Vehicle,
        NameKind::Option | NameKind::OptionValue => HighlightKind::Option,
        NameKind::Symbol | NameKind::Occurrence => HighlightKind::Symbol,
    }
}

fn of_token(kind: SyntaxKind) -> HighlightKind {
    match kind {
        SyntaxKind::LineComment | SyntaxKind::BlockComment => HighlightKind::Comment,
        SyntaxKind::Unknown => HighlightKind::Unknown,
        SyntaxKind::Number | SyntaxKind::Infinity => HighlightKind::Number,
        SyntaxKind::String => HighlightKind::String,
        // A name that represents nothing is a word of the language in its place: `moves`, `at`, `circle`.
        SyntaxKind::Name => HighlightKind::Keyword,
        SyntaxKind::Equals
        | SyntaxKind::NotEquals
        | SyntaxKind::Bang
        | SyntaxKind::Percent
        | SyntaxKind::Plus
        | SyntaxKind::Minus
        | SyntaxKind::Star
        | SyntaxKind::Slash
        | SyntaxKind::DotDot => HighlightKind::Operator,
        kind if kind.is_keyword() => HighlightKind::Keyword,
        _ => HighlightKind::Punctuation,
    }
}
