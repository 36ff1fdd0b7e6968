//! Keywords of the prefix notation, also as typesetting has torn them: `do -watching`, `when- donext`.

use crate::span::Span;

use super::lexer::{TokenKind, is_hyphen};
use super::tree::Node;

/// The heads of expressions.
pub const EXPRESSION_KEYWORDS: [&str; 19] = [
    "PARALLEL",
    "SEQUENCE",
    "ALWAYS",
    "IF-THENNEXT-ELSENEXT",
    "IF-THENNEXT",
    "UNLESS-THENNEXT",
    "WHEN-DONEXT",
    "WHENEVER-DONEXT",
    "DO-WATCHING",
    "WAIT",
    "TIMEOUT",
    "WITHIN",
    "AT",
    "EVERY",
    "WARP",
    "LOCK",
    "CHOOSE-PROB",
    "CHOOSE-REWARD",
    "REWARD",
];

/// Those of them that speak of time, locks and choices: a definition of the text may have their names.
pub(super) const TIMED_KEYWORDS: &[&str] = EXPRESSION_KEYWORDS.split_at(9).1;

/// The heads of options and of the model part, and the words inside its fields.
pub const MODEL_KEYWORDS: [&str; 17] = [
    "DEFSTEP",
    "DEFOPTION",
    "DEFCLASS",
    "DEFINSTANCE",
    "VAR",
    "COMMAND",
    "PORT",
    "PART",
    "METHOD",
    "BEHAVIOR",
    "MODE",
    "TRANSITION",
    "FAULT",
    "OBSERVABLE",
    "SHOWS",
    "ERROR",
    "INIT",
];

/// A list's first word, with torn hyphens fixed.
pub(super) struct Head {
    /// The word in upper case with plain hyphens, to compare with keywords.
    pub(super) upper: String,
    /// Where it is written.
    pub(super) span: Span,
    /// How many items of the list it takes.
    pub(super) length: usize,
}

/// The head of a list, if it starts with a word.
pub(super) fn head(text: &str, items: &[Node]) -> Option<Head> {
    let (word, mut span) = word(text, items.first()?)?;
    let mut upper = normalize(word);
    let mut length = 1;
    while EXPRESSION_KEYWORDS.iter().any(|keyword| keyword.starts_with(upper.as_str())) {
        let Some((next, next_span)) = items.get(length).and_then(|node| self::word(text, node)) else {
            break;
        };
        let next = normalize(next);
        let joined = format!("{upper}{next}");
        let torn = upper.ends_with('-') || next.starts_with('-');
        if !torn || !EXPRESSION_KEYWORDS.iter().any(|keyword| keyword.starts_with(joined.as_str())) {
            break;
        }
        upper = joined;
        span = span.cover(next_span);
        length += 1;
    }
    Some(Head { upper, span, length })
}

/// The text of a node that is a word.
pub(super) fn word<'text>(text: &'text str, node: &Node) -> Option<(&'text str, Span)> {
    match node {
        Node::Leaf(token) if token.kind == TokenKind::Word => {
            Some((text.get(token.span.range()).unwrap_or(""), token.span))
        }
        _ => None,
    }
}

fn normalize(word: &str) -> String {
    word.chars().map(|c| if is_hyphen(c) { '-' } else { c.to_ascii_uppercase() }).collect()
}
