//! The statement that a drawing shows, and what contains it.

use rmpl::syntax::{SyntaxKind, SyntaxNode};
use rmpl::{Parse, Span};

/// A statement, or an alternative of several, with what it is in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site<'a> {
    pub(super) node: SyntaxNode<'a>,
    pub(super) holder: Holder<'a>,
}

/// What a statement is in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Holder<'a> {
    /// One after the other: `{ … }`, or an alternative.
    Row(SyntaxNode<'a>),
    /// At the same time.
    Parallel(SyntaxNode<'a>),
    /// One of several.
    Choose(SyntaxNode<'a>),
    /// Alone after a word, such as `optional`: the statement that begins with the word.
    Alone(SyntaxNode<'a>),
}

impl<'a> Site<'a> {
    /// The smallest statement around a span.
    pub(super) fn of(parse: &'a Parse, span: Span) -> Result<Self, String> {
        let path = path(parse, span);
        let is_site = |node: &SyntaxNode<'_>| is_step(node.kind()) || node.kind() == SyntaxKind::Alternative;
        let at = path.iter().rposition(is_site).ok_or("Select an activity inside the scenario")?;
        Self::at(&path, at).ok_or_else(|| "Select an activity inside the scenario".to_owned())
    }

    fn at(path: &[SyntaxNode<'a>], at: usize) -> Option<Self> {
        // An alternative of one statement is that alternative.
        let above = at.checked_sub(1).and_then(|above| path.get(above));
        let is_complete =
            |it: &&SyntaxNode<'a>| it.kind() == SyntaxKind::Alternative && it.children().count() == 1;
        let at = if above.as_ref().is_some_and(is_complete) { at - 1 } else { at };
        let node = *path.get(at)?;
        let parent = *path.get(at.checked_sub(1)?)?;
        let holder = match parent.kind() {
            SyntaxKind::Block | SyntaxKind::Alternative => Holder::Row(parent),
            SyntaxKind::Parallel => Holder::Parallel(parent),
            SyntaxKind::Choose => Holder::Choose(parent),
            // `optional A` is a core of a statement.
            _ => Holder::Alone(*path.get(at.checked_sub(2)?)?),
        };
        Some(Self { node, holder })
    }

    /// Its place in the text.
    pub(super) fn span(&self) -> Span {
        self.node.span()
    }

    /// The site of what it is in, where that is a statement.
    pub(super) fn outer(&self, parse: &'a Parse) -> Option<Self> {
        let holder = match self.holder {
            Holder::Row(node) | Holder::Parallel(node) | Holder::Choose(node) | Holder::Alone(node) => node,
        };
        let path = path(parse, self.span());
        let here = path.iter().position(|node| node.index() == holder.index())?;
        let at = path[..=here].iter().rposition(|node| is_step(node.kind()))?;
        Self::at(&path, at)
    }

    /// The statement before or after it in the same holder.
    pub(super) fn neighbor(&self, forwards: bool) -> Option<SyntaxNode<'a>> {
        let (Holder::Row(holder) | Holder::Parallel(holder) | Holder::Choose(holder)) = self.holder else {
            return None;
        };
        let all: Vec<SyntaxNode<'a>> = steps(holder).collect();
        let at = all.iter().position(|node| node.index() == self.node.index())?;
        let next = if forwards { at + 1 } else { at.checked_sub(1)? };
        all.get(next).copied()
    }
}

/// The statements of a node that are in a row, at the same time, or alternatives.
pub(super) fn steps(holder: SyntaxNode<'_>) -> impl Iterator<Item = SyntaxNode<'_>> {
    holder.children().filter(|node| {
        is_step(node.kind()) || matches!(node.kind(), SyntaxKind::Parallel | SyntaxKind::Alternative)
    })
}

/// The statement around a span that no choice, repetition or other construct is around: what comes after it comes after
/// whatever is chosen or repeated there.
pub(super) fn unconditional(parse: &Parse, span: Span) -> Option<Site<'_>> {
    let path = path(parse, span);
    let is_construct = |kind| {
        matches!(
            kind,
            SyntaxKind::Choose
                | SyntaxKind::Do
                | SyntaxKind::If
                | SyntaxKind::Repeat
                | SyntaxKind::Free
                | SyntaxKind::Optional
                | SyntaxKind::Unordered
                | SyntaxKind::Members
        )
    };
    let outermost = path.iter().position(|node| is_construct(node.kind())).unwrap_or(path.len());
    let at = path[..outermost].iter().rposition(|node| is_step(node.kind()))?;
    Site::at(&path, at)
}

/// The block of the first scenario.
pub(super) fn scenario_block(parse: &Parse) -> Result<SyntaxNode<'_>, String> {
    let scenario = parse.declarations().find_map(|root| root.child(SyntaxKind::ScenarioDecl));
    let block = scenario.and_then(|scenario| scenario.child(SyntaxKind::Block));
    block.ok_or_else(|| "Add a scenario first".to_owned())
}

fn is_step(kind: SyntaxKind) -> bool {
    kind == SyntaxKind::Statement
}

/// The nodes around a span, from the declaration down.
fn path(parse: &Parse, span: Span) -> Vec<SyntaxNode<'_>> {
    let mut path = Vec::new();
    let contains = |node: &SyntaxNode<'_>| node.span().contains(span);
    let mut here = parse.declaration_at(span.start).filter(contains);
    while let Some(node) = here {
        path.push(node);
        here = node.children().find(contains);
    }
    path
}
