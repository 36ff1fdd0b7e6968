//! Completion that knows the place: what can stand at the cursor, and nothing else.

mod declaration;
mod items;
mod place;

use crate::parse::Parse;
use crate::parser::CONTINGENT;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

use super::cursor::declaration_at_cursor;
use super::outline::{OutlineKind, outline};

use items::items;
use place::place;

/// What can be written at the cursor.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// What an item replaces: the word that is being typed.
    pub replaces: Span,
    /// The items that begin with what is typed (or contain it), best first.
    pub items: Vec<CompletionItem>,
    /// What else fits, which the text itself does not know.
    pub wants: Option<Wanted>,
}

/// What a string names, outside of the mission text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wanted {
    /// A map: `terrain "…"`.
    Map,
    /// A file of the mission: `import "…"`.
    File,
}

/// One thing that can be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompletionItem {
    /// What the list shows.
    pub label: String,
    pub kind: CompletionKind,
    /// More about it, in a few words.
    pub detail: String,
    /// What is written. `$1`, `$2` and so on mark where the cursor goes one after the other, `$0` where it goes at last,
    /// if not after everything.
    pub insert: String,
}

/// What an item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CompletionKind {
    /// A word of the language, or a piece of its grammar.
    Keyword,
    /// An activity with a definition.
    Activity,
    Primitive,
    /// A state variable, an atom or a resource.
    Variable,
    /// A value of a variable.
    Value,
    Parameter,
    /// A name of the header's bounds.
    BoundName,
    Constant,
    Location,
    /// A vehicle or a model.
    Vehicle,
    /// An option or its value.
    Option,
}

/// Returns what can be written at `offset`.
pub fn complete(parse: &Parse, offset: u32) -> Completion {
    let around = parse.declaration_at(offset.saturating_sub(1));
    let written =
        declaration_at_cursor(parse, offset).filter(|root| Some(root.span()) != around.map(SyntaxNode::span));
    let before: Vec<SyntaxToken<'_>> = written
        .into_iter()
        .chain(around)
        .flat_map(SyntaxNode::tokens)
        .filter(|token| token.span.start < offset)
        .collect();
    if let Some(quoted) = in_quotes(&before, offset) {
        return quoted;
    }
    if before.last().is_some_and(|token| is_opaque(*token, offset)) {
        return Completion { replaces: Span::new(offset, offset), ..Completion::default() };
    }
    let typed = before.last().filter(|token| token.span.end >= offset && is_word(token.kind));
    let replaces = typed.map_or(Span::new(offset, offset), |token| token.span);
    let prefix =
        typed.map_or("", |token| token.text.get(..(offset - token.span.start) as usize).unwrap_or(""));
    let context: Vec<SyntaxToken<'_>> = before
        .iter()
        .filter(|token| !token.kind.is_trivia() && token.span.start < replaces.start)
        .copied()
        .collect();
    let mut items = items(parse, offset, &place(&context));
    if callee(&context).is_some_and(|name| is_definition(parse, name)) {
        // How long a definition takes follows from its parts.
        items.retain(|item| item.label != CONTINGENT);
    }
    let rank = |item: &CompletionItem| rank(&item.label, prefix);
    items.retain(|item| rank(item).is_some());
    items.sort_by(|one, other| {
        (rank(one), one.kind as u8 == CompletionKind::Keyword as u8, &one.label).cmp(&(
            rank(other),
            other.kind as u8 == CompletionKind::Keyword as u8,
            &other.label,
        ))
    });
    items.dedup_by(|one, other| one.label == other.label);
    Completion { replaces, items, wants: None }
}

/// Returns what a string around the cursor may be, if something is known of it; what is between the quotes is
/// replaced.
fn in_quotes(before: &[SyntaxToken<'_>], offset: u32) -> Option<Completion> {
    let (last, context) = before.split_last()?;
    let is_inside = last.kind == SyntaxKind::String && last.span.start < offset && offset < last.span.end;
    let word = context.iter().rev().find(|token| !token.kind.is_trivia()).filter(|_| is_inside)?;
    let wants = match word.text {
        "terrain" => Wanted::Map,
        "import" => Wanted::File,
        _ => return None,
    };
    let end = last.span.end - u32::from(last.text.len() > 1 && last.text.ends_with('"'));
    Some(Completion { replaces: Span::new(last.span.start + 1, end), items: Vec::new(), wants: Some(wants) })
}

/// Returns what is called by the call that the tokens end with, if they do.
fn callee<'parse>(context: &[SyntaxToken<'parse>]) -> Option<&'parse str> {
    let (last, before) = context.split_last()?;
    if last.kind == SyntaxKind::Name {
        return Some(last.text);
    }
    let mut open = usize::from(last.kind == SyntaxKind::RightParen);
    let mut tokens = before.iter().rev();
    while open > 0 {
        match tokens.next()?.kind {
            SyntaxKind::RightParen => open += 1,
            SyntaxKind::LeftParen => open -= 1,
            _ => {}
        }
    }
    tokens
        .next()
        .filter(|token| last.kind == SyntaxKind::RightParen && token.kind == SyntaxKind::Name)
        .map(|it| it.text)
}

/// Returns whether an activity has a definition, and is not a primitive.
fn is_definition(parse: &Parse, name: &str) -> bool {
    outline(parse).iter().any(|item| item.kind == OutlineKind::Activity && item.name == name)
}

/// Returns whether the cursor is in a comment, a string or a number, where nothing is completed.
fn is_opaque(token: SyntaxToken<'_>, offset: u32) -> bool {
    match token.kind {
        SyntaxKind::LineComment | SyntaxKind::String | SyntaxKind::Number => token.span.end >= offset,
        SyntaxKind::BlockComment => token.span.end > offset || !token.text.ends_with("*/"),
        _ => false,
    }
}

const fn is_word(kind: SyntaxKind) -> bool {
    matches!(kind, SyntaxKind::Name | SyntaxKind::Infinity) || kind.is_keyword()
}

/// 0 for a beginning, 1 for a beginning in other case, 2 for a part; none if `label` does not fit what is typed.
fn rank(label: &str, prefix: &str) -> Option<u8> {
    let (lower_label, lower_prefix) = (label.to_ascii_lowercase(), prefix.to_ascii_lowercase());
    if label.starts_with(prefix) {
        Some(0)
    } else if lower_label.starts_with(&lower_prefix) {
        Some(1)
    } else {
        lower_label.contains(&lower_prefix).then_some(2)
    }
}
