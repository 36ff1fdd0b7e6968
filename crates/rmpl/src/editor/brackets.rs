//! Brackets that belong together.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxToken};

/// The bracket at `offset` (after the cursor first, then before it) and its partner. Works on broken programs: brackets
/// are matched by kind within the declaration.
pub fn matching_bracket(parse: &Parse, offset: u32) -> Option<(Span, Span)> {
    let at = |start: u32| {
        parse.declaration_at(start).and_then(|root| {
            let tokens: Vec<SyntaxToken<'_>> = root.tokens().collect();
            let index =
                tokens.iter().position(|token| token.span.start == start && role(token.kind).is_some())?;
            partner(&tokens, index)
        })
    };
    at(offset).or_else(|| at(offset.checked_sub(1)?))
}

/// Returns which pair of brackets a token is of, and whether it opens.
const fn role(kind: SyntaxKind) -> Option<(u8, bool)> {
    Some(match kind {
        SyntaxKind::LeftBrace => (0, true),
        SyntaxKind::RightBrace => (0, false),
        SyntaxKind::LeftBracket => (1, true),
        SyntaxKind::RightBracket => (1, false),
        SyntaxKind::LeftParen => (2, true),
        SyntaxKind::RightParen => (2, false),
        _ => return None,
    })
}

fn partner(tokens: &[SyntaxToken<'_>], index: usize) -> Option<(Span, Span)> {
    let own = tokens.get(index)?;
    let (pair, opens) = role(own.kind)?;
    let mut depth = 0_i32;
    let mut visit = |token: &SyntaxToken<'_>| match role(token.kind) {
        Some((other, other_opens)) if other == pair => {
            depth += if other_opens == opens { 1 } else { -1 };
            depth == 0
        }
        _ => false,
    };
    let found = if opens {
        tokens.iter().skip(index).find(|token| visit(token))
    } else {
        tokens.iter().take(index + 1).rev().find(|token| visit(token))
    };
    found.map(|found| (own.span, found.span))
}
