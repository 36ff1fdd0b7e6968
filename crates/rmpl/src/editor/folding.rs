//! What an editor can fold.

use crate::parse::Parse;
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxToken};

/// What is folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FoldKind {
    /// Between the braces of a block, a choice or a domain.
    Braces,
    /// A comment of several lines, or several line comments.
    Comment,
    /// Several world declarations of one kind in a row.
    Declarations,
}

/// A foldable piece of text over several lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// What disappears: for braces, what is between them.
    pub span: Span,
    pub kind: FoldKind,
}

/// All of them, ordered by where they start.
pub fn folds(parse: &Parse) -> Vec<Fold> {
    let mut found = Vec::new();
    for root in parse.declarations() {
        for node in root.descendants() {
            if let Some(token) = node.own_tokens().find(|token| token.kind == SyntaxKind::ControlText) {
                push(parse, &mut found, token.span, FoldKind::Braces);
            }
            if matches!(node.kind(), SyntaxKind::Block | SyntaxKind::Choose | SyntaxKind::Domain)
                && let (Some(open), Some(close)) =
                    (node.token(SyntaxKind::LeftBrace), node.token(SyntaxKind::RightBrace))
            {
                push(parse, &mut found, Span::new(open.span.end, close.span.start), FoldKind::Braces);
            }
        }
        comments(parse, &root.tokens().collect::<Vec<_>>(), &mut found);
    }
    found.extend(runs_of_declarations(parse));
    found.sort_by_key(|fold| fold.span);
    found
}

fn push(parse: &Parse, found: &mut Vec<Fold>, span: Span, kind: FoldKind) {
    if parse.text().get(span.range()).is_some_and(|text| text.contains('\n')) {
        found.push(Fold { span, kind });
    }
}

/// Comments with nothing but single line ends between them fold together.
fn comments(parse: &Parse, tokens: &[SyntaxToken<'_>], found: &mut Vec<Fold>) {
    let mut group: Option<Span> = None;
    for token in tokens {
        if token.kind.is_comment() {
            group = Some(group.map_or(token.span, |group| group.cover(token.span)));
            continue;
        }
        let separates = token.kind != SyntaxKind::Whitespace || token.text.matches('\n').count() > 1;
        if let Some(group) = group.take_if(|_| separates) {
            push(parse, found, group, FoldKind::Comment);
        }
    }
    if let Some(group) = group {
        push(parse, found, group, FoldKind::Comment);
    }
}

fn runs_of_declarations(parse: &Parse) -> Vec<Fold> {
    let mut found = Vec::new();
    let mut run: Option<(SyntaxKind, Span)> = None;
    for root in parse.declarations() {
        let declaration = root.children().next().filter(|child| {
            matches!(
                child.kind(),
                SyntaxKind::ConstantDecl
                    | SyntaxKind::StateDecl
                    | SyntaxKind::ResourceDecl
                    | SyntaxKind::LocationDecl
                    | SyntaxKind::ObstacleDecl
                    | SyntaxKind::VehicleDecl
                    | SyntaxKind::GroupDecl
                    | SyntaxKind::PrimitiveDecl
            )
        });
        run = match (run, declaration) {
            (Some((kind, span)), Some(next)) if kind == next.kind() => Some((kind, span.cover(next.span()))),
            (finished, next) => {
                if let Some((_, span)) = finished {
                    push(parse, &mut found, span, FoldKind::Declarations);
                }
                next.map(|next| (next.kind(), next.span()))
            }
        };
    }
    if let Some((_, span)) = run {
        push(parse, &mut found, span, FoldKind::Declarations);
    }
    found
}
