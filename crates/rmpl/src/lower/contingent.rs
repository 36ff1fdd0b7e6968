//! What the environment cannot choose: how long something composite takes (SPEC 13.1).

use super::Lowering;
use super::bounds::{bounds_in, contingent_in};
use crate::diagnostic::{Edit, Fix};
use crate::diagnostics::contingent;
use crate::program::Bounds;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode};

impl Lowering<'_> {
    /// The bounds after the statement `node`, whose parts `core` holds. Those of a composite say only what is required.
    pub(super) fn chosen_by_plans(&mut self, core: SyntaxNode<'_>, node: SyntaxNode<'_>) -> Option<Bounds> {
        let bounds = bounds_in(node)?;
        if !bounds.is_contingent || is_simple(core.kind()) {
            return Some(bounds);
        }
        let what = match core.kind() {
            SyntaxKind::Block => "a block",
            SyntaxKind::Choose => "a choice",
            SyntaxKind::Do => "a `do`",
            SyntaxKind::If => "an `if`",
            SyntaxKind::Repeat => "a `repeat`",
            _ => "a group of activities",
        };
        let written = node.child(SyntaxKind::Bounds)?;
        let moved = only_simple(core).map(|simple| {
            let (from, to) = (core.span().end, simple.span().end);
            let edits = vec![
                Edit { span: Span::new(to, to), text: format!(" {}", written.text()) },
                Edit { span: Span::new(from, written.span().end), text: String::new() },
            ];
            Fix { label: format!("Move it after `{}`", simple.text()), edits }
        });
        self.diagnostics.push(contingent::composite(what, word_and_blank(written), bounds.span, moved));
        Some(Bounds { is_contingent: false, ..bounds })
    }

    /// Reports the word in the header of `what`.
    pub(super) fn no_contingent(&mut self, node: SyntaxNode<'_>, what: &str) {
        let Some(written) = node.child(SyntaxKind::Bounds).filter(|it| contingent_in(*it).is_some()) else {
            return;
        };
        self.diagnostics.push(contingent::composite(what, word_and_blank(written), written.span(), None));
    }
}

/// Returns whether a statement of this kind is one interval. What a name alone calls is known where all names are.
const fn is_simple(kind: SyntaxKind) -> bool {
    matches!(kind, SyntaxKind::Call | SyntaxKind::BareName | SyntaxKind::Assertion | SyntaxKind::Delay)
}

/// The one call, assertion or delay in a block or a `do`, if it has no bounds of its own.
fn only_simple(core: SyntaxNode<'_>) -> Option<SyntaxNode<'_>> {
    if !matches!(core.kind(), SyntaxKind::Block | SyntaxKind::Do) {
        return None;
    }
    let mut steps =
        core.children().filter(|it| matches!(it.kind(), SyntaxKind::Statement | SyntaxKind::Parallel));
    let (Some(only), None) = (steps.next(), steps.next()) else { return None };
    let inner = only.children().next().filter(|_| only.kind() == SyntaxKind::Statement)?;
    if only.child(SyntaxKind::Bounds).is_some() {
        return None;
    }
    if is_simple(inner.kind()) { Some(inner) } else { only_simple(inner) }
}

/// The word with the blanks between it and the bracket.
fn word_and_blank(bounds: SyntaxNode<'_>) -> Span {
    let start = bounds.span().start;
    let bracket = bounds.token(SyntaxKind::LeftBracket);
    let has_comment = bounds.tokens().any(|token| token.kind.is_comment());
    let word = contingent_in(bounds).map_or(start, |word| word.span.end);
    Span::new(start, bracket.filter(|_| !has_comment).map_or(word, |bracket| bracket.span.start))
}
