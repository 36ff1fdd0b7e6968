//! The declaration that is being written at the cursor.

use crate::parse::Parse;
use crate::syntax::SyntaxNode;

/// The declaration that typing at `offset` continues with: the one around it, or, where only blanks and comments of the
/// next one come before the cursor, the one before.
pub(super) fn declaration_at_cursor(parse: &Parse, offset: u32) -> Option<SyntaxNode<'_>> {
    let here = parse.declaration_at(offset.checked_sub(1)?)?;
    // A word that ends at the cursor is being typed: it does not make a declaration of its own yet.
    let has_begun = here.tokens().any(|token| !token.kind.is_trivia() && token.span.end < offset);
    if has_begun {
        return Some(here);
    }
    let before = here.span().start.checked_sub(1).and_then(|before| parse.declaration_at(before));
    Some(before.unwrap_or(here))
}
