//! Growing a selection by the structure of the text.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::SyntaxKind;

/// The smallest piece of structure that properly contains `selection`: a word, a condition, a statement, a block, a
/// declaration, the file. `None` when everything is selected.
pub fn wider_selection(parse: &Parse, selection: Span) -> Option<Span> {
    let contains =
        |span: Span| span.start <= selection.start && selection.end <= span.end && span != selection;
    let whole = Span::new(0, parse.text().len() as u32);
    let inside =
        parse.declarations_in(selection).filter(|root| contains(root.span()) || root.span() == selection);
    let mut candidates: Vec<(Span, bool)> = Vec::new();
    for root in inside {
        let words = root.tokens().filter(|token| token.kind != SyntaxKind::Whitespace);
        candidates.extend(words.map(|token| (token.span, !is_word(token.kind))));
        candidates.extend(root.descendants().map(|node| (node.span(), false)));
    }
    candidates.push((whole, false));
    // Between a bracket and a word, the word is meant.
    let wider = candidates.into_iter().filter(|(span, _)| contains(*span));
    wider.min_by_key(|(span, is_sign)| (span.end - span.start, *is_sign)).map(|(span, _)| span)
}

fn is_word(kind: SyntaxKind) -> bool {
    kind.is_keyword()
        || kind.is_comment()
        || matches!(kind, SyntaxKind::Name | SyntaxKind::Number | SyntaxKind::String)
}
