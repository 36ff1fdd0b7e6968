//! What an editor colors, token by token.

use serde::{Deserialize, Serialize};

use crate::span::Span;

use super::ParsedControl;
use super::keyword::{self, EXPRESSION_KEYWORDS, MODEL_KEYWORDS};
use super::lexer::TokenKind;
use super::tree::Node;

/// The role of a piece of text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HighlightKind {
    /// A construct, a connective, or a word of the model part.
    Keyword,
    /// What is defined or called.
    Definition,
    /// A variable or component.
    Variable,
    /// A value, mode or number.
    Value,
    /// The bar of non-entailment.
    Bar,
    /// Parentheses and signs.
    Punctuation,
    Comment,
}

/// A piece of text and its role.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Highlight {
    pub span: Span,
    pub kind: HighlightKind,
}

/// The pieces of `text` that are not blank, in textual order; `parsed` is what parsing `text` gave.
pub fn highlight(text: &str, parsed: &ParsedControl) -> Vec<Highlight> {
    let mut found: Vec<Highlight> = parsed
        .tokens
        .iter()
        .filter_map(|token| {
            let kind = match token.kind {
                TokenKind::Comment => HighlightKind::Comment,
                TokenKind::Tilde => HighlightKind::Bar,
                TokenKind::Whitespace | TokenKind::Word | TokenKind::Unknown => return None,
                _ => HighlightKind::Punctuation,
            };
            Some(Highlight { span: token.span, kind })
        })
        .collect();
    words(text, &parsed.tree.items, &mut found);
    found.sort_by_key(|highlight| highlight.span);
    found
}

fn words(text: &str, items: &[Node], into: &mut Vec<Highlight>) {
    let head = keyword::head(text, items).filter(|head| {
        EXPRESSION_KEYWORDS.contains(&head.upper.as_str()) || MODEL_KEYWORDS.contains(&head.upper.as_str())
    });
    let taken = head.as_ref().map_or(0, |head| {
        into.push(Highlight { span: head.span, kind: HighlightKind::Keyword });
        head.length
    });
    for (at, node) in items.iter().enumerate().skip(taken) {
        match node {
            Node::List(list) if list.braced => {
                into.extend(
                    list.items
                        .iter()
                        .map(|value| Highlight { span: value.span(), kind: HighlightKind::Value }),
                );
            }
            Node::List(list) => words(text, &list.items, into),
            Node::Leaf(_) => {
                if let Some((word, span)) = keyword::word(text, node) {
                    into.push(Highlight { span, kind: word_kind(word, at, items) });
                }
            }
        }
    }
}

fn word_kind(word: &str, at: usize, items: &[Node]) -> HighlightKind {
    let is_leaf = |at: Option<usize>, kind| {
        at.and_then(|at| items.get(at))
            .is_some_and(|node| matches!(node, Node::Leaf(token) if token.kind == kind))
    };
    let upper = word.to_ascii_uppercase();
    if is_leaf(Some(at + 1), TokenKind::Equals) {
        HighlightKind::Variable
    } else if is_leaf(at.checked_sub(1), TokenKind::Equals) || word.starts_with(|c: char| c.is_ascii_digit())
    {
        HighlightKind::Value
    } else if matches!(
        upper.as_str(),
        "AND"
            | "OR"
            | "NOT"
            | "NOT-ENTAILED"
            | "HELD"
            | "TRUE"
            | "FALSE"
            | "OBSERVABLE"
            | "SHOWS"
            | "ERROR"
            | "INIT"
    ) {
        HighlightKind::Keyword
    } else {
        HighlightKind::Definition
    }
}
