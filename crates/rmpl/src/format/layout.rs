//! Where lines break: before each step of a block that does not stand on one line, and before its closing brace.

use std::collections::BTreeMap;

use crate::syntax::{SyntaxKind, SyntaxNode, SyntaxToken};

use super::spacing::{Place, has_space_between};
use super::{INDENT, LINE_WIDTH};

/// The layout of one declaration, by index of token.
pub(super) struct Layout {
    breaks: BTreeMap<usize, usize>,
    places: Vec<Place>,
    /// The width of everything before each token, were it all on one line.
    widths: Vec<usize>,
}

impl Layout {
    /// The indentation of the line that begins with this token, if one does.
    pub(super) fn break_before(&self, token: usize) -> Option<usize> {
        self.breaks.get(&token).copied()
    }

    /// Returns what the token belongs to.
    pub(super) fn place(&self, token: usize) -> Place {
        self.places.get(token).copied().unwrap_or_default()
    }
}

/// Lays out a declaration without mistakes.
pub(super) fn layout(root: SyntaxNode<'_>) -> Layout {
    let tokens: Vec<SyntaxToken<'_>> = root.tokens().collect();
    let mut layout =
        Layout { breaks: BTreeMap::new(), places: vec![Place::Plain; tokens.len()], widths: Vec::new() };
    for node in root.descendants() {
        layout.note_places(node);
    }
    layout.measure(&tokens);
    let Some(declaration) = root.children().next() else { return layout };
    layout.break_at(declaration, 0);
    layout.break_clauses(declaration);
    if declaration.kind() == SyntaxKind::ModelDecl
        && (declaration.text().contains('\n') || layout.width(declaration) > LINE_WIDTH)
    {
        layout.break_model(declaration);
    }
    if let Some(block) = declaration.child(SyntaxKind::Block)
        && (block.text().contains('\n') || layout.width(declaration) > LINE_WIDTH)
    {
        layout.break_block(block, 0);
    }
    layout
}

impl Layout {
    fn note_places(&mut self, node: SyntaxNode<'_>) {
        let place = match node.kind() {
            SyntaxKind::Bounds => Place::Bounds,
            SyntaxKind::Sum
            | SyntaxKind::Product
            | SyntaxKind::PercentOf
            | SyntaxKind::Grouped
            | SyntaxKind::Negation
            | SyntaxKind::Operand => {
                let first = first_token(node).map(|first| self.place(first));
                if matches!(first, Some(Place::Bounds | Place::Expression)) {
                    return;
                }
                Place::Expression
            }
            SyntaxKind::Condition
            | SyntaxKind::AllOf
            | SyntaxKind::AnyOf
            | SyntaxKind::NotOf
            | SyntaxKind::ConditionGroup
            | SyntaxKind::Effect => Place::Condition,
            SyntaxKind::Visible => Place::Sight,
            SyntaxKind::Goal => Place::Expression,
            SyntaxKind::Coordinates | SyntaxKind::Property => Place::Coordinates,
            SyntaxKind::Domain => Place::Domain,
            SyntaxKind::Argument => Place::Argument,
            SyntaxKind::ConstrainDecl | SyntaxKind::Aborts => {
                if let Some(bracket) = node.child(SyntaxKind::Bounds).and_then(first_token) {
                    self.set(bracket, Place::SpacedBounds);
                }
                return;
            }
            SyntaxKind::Statement => {
                let core = node.children().next();
                let is_tight =
                    core.is_some_and(|core| matches!(core.kind(), SyntaxKind::Call | SyntaxKind::Delay));
                if let Some(bracket) =
                    node.child(SyntaxKind::Bounds).and_then(first_token).filter(|_| !is_tight)
                {
                    self.set(bracket, Place::SpacedBounds);
                }
                return;
            }
            _ => return,
        };
        for token in node.tokens() {
            let is_apart = self.place(token.index as usize) == Place::SpacedBounds;
            if !is_apart {
                self.set(token.index as usize, place);
            }
        }
        if node.kind() == SyntaxKind::Goal {
            self.note_sign(node);
        }
        if node.kind() == SyntaxKind::Bounds && node.token(SyntaxKind::Name).is_some() {
            // A word before brackets stands apart from both sides.
            for token in node.own_tokens().take(2) {
                self.set(token.index as usize, Place::SpacedBounds);
            }
        }
    }

    /// What follows the sign of a goal's first term is tight: `minimize -cost`.
    fn note_sign(&mut self, goal: SyntaxNode<'_>) {
        let mut tokens = goal.own_tokens().skip(1);
        let sign = tokens.next().filter(|token| matches!(token.kind, SyntaxKind::Plus | SyntaxKind::Minus));
        if let (Some(_), Some(term)) = (sign, tokens.next()) {
            self.set(term.index as usize, Place::Bounds);
        }
    }

    fn set(&mut self, token: usize, place: Place) {
        if let Some(slot) = self.places.get_mut(token) {
            *slot = place;
        }
    }

    fn measure(&mut self, tokens: &[SyntaxToken<'_>]) {
        let mut width = 0;
        let mut previous: Option<SyntaxToken<'_>> = None;
        for (index, token) in tokens.iter().enumerate() {
            self.widths.push(width);
            if token.kind == SyntaxKind::Whitespace {
                continue;
            }
            let has_space = match previous {
                Some(previous) if token.kind.is_comment() || previous.kind.is_comment() => true,
                Some(previous) => has_space_between(previous, *token, self.place(index)),
                None => false,
            };
            width += token.text.chars().count() + usize::from(has_space);
            previous = Some(*token);
        }
        self.widths.push(width);
    }

    /// The width of a node and the separator after it on one line.
    fn width(&self, node: SyntaxNode<'_>) -> usize {
        let mut tokens = node.tokens();
        let Some(first) = tokens.next() else { return 0 };
        let last = tokens.next_back().map_or(first.index, |last| last.index) as usize;
        let before = self.widths.get(first.index as usize).copied().unwrap_or(0);
        self.widths.get(last + 1).copied().unwrap_or(before).saturating_sub(before) + 1
    }

    fn break_at(&mut self, node: SyntaxNode<'_>, indent: usize) {
        if let Some(first) = first_token(node) {
            self.breaks.insert(first, indent);
        }
    }

    /// Gives each clause of a primitive a line of its own, unless all fit on one and are written so. Traverses that
    /// require, change and cost nothing always stand on one line.
    fn break_clauses(&mut self, declaration: SyntaxNode<'_>) {
        let is_plain = |kind| matches!(kind, SyntaxKind::Moves | SyntaxKind::Runs);
        let clauses: Vec<SyntaxNode<'_>> =
            declaration.children().filter(|child| is_clause(child.kind())).collect();
        if clauses.iter().all(|clause| is_plain(clause.kind())) {
            return;
        }
        if declaration.text().contains('\n') || self.width(declaration) > LINE_WIDTH {
            for clause in clauses {
                self.break_at(clause, INDENT);
            }
        }
    }

    /// Gives each property, resource and state of a model a line of its own.
    fn break_model(&mut self, model: SyntaxNode<'_>) {
        for part in model.children().filter(|part| part.kind() != SyntaxKind::Extends) {
            self.break_at(part, INDENT);
        }
        if let Some(close) = model.token(SyntaxKind::RightBrace) {
            self.breaks.insert(close.index as usize, 0);
        }
    }

    /// Gives each step of a block or choice a line of its own.
    fn break_block(&mut self, block: SyntaxNode<'_>, indent: usize) {
        let inner = indent + INDENT;
        let steps: Vec<SyntaxNode<'_>> = block.children().collect();
        if is_empty(block) {
            return;
        }
        match steps.as_slice() {
            [only] if only.kind() == SyntaxKind::Parallel => {
                only.children().for_each(|branch| self.line(branch, inner));
            }
            _ => steps.iter().for_each(|step| self.line(*step, inner)),
        }
        if let Some(close) = block.tokens().rfind(|token| token.kind == SyntaxKind::RightBrace) {
            self.breaks.insert(close.index as usize, indent);
        }
    }

    /// Begins a line with `step` and breaks what does not fit on it.
    fn line(&mut self, step: SyntaxNode<'_>, indent: usize) {
        self.break_at(step, indent);
        let is_wide = indent + self.width(step) > LINE_WIDTH;
        let is_group = matches!(step.kind(), SyntaxKind::Parallel | SyntaxKind::Alternative);
        let is_tall = outer_blocks(step).iter().any(|block| block.text().contains('\n'));
        if !is_wide && !is_tall {
            return;
        }
        if is_group && step.children().count() > 1 {
            step.children().for_each(|part| self.line(part, indent));
            return;
        }
        for block in outer_blocks(step) {
            self.break_block(block, indent);
        }
    }
}

const fn is_clause(kind: SyntaxKind) -> bool {
    matches!(
        kind,
        SyntaxKind::Moves
            | SyntaxKind::Runs
            | SyntaxKind::Requires
            | SyntaxKind::Sets
            | SyntaxKind::Uses
            | SyntaxKind::Costs
            | SyntaxKind::Rewards
            | SyntaxKind::Aborts
    )
}

fn first_token(node: SyntaxNode<'_>) -> Option<usize> {
    node.tokens().find(|token| !token.kind.is_trivia()).map(|token| token.index as usize)
}

/// Returns whether nothing is between the braces: such a block is always written `{}`.
fn is_empty(block: SyntaxNode<'_>) -> bool {
    block.children().next().is_none() && !block.tokens().any(|token| token.kind.is_comment())
}

/// The blocks and choices of a statement that are in no other of its blocks; empty ones left out.
fn outer_blocks(node: SyntaxNode<'_>) -> Vec<SyntaxNode<'_>> {
    let mut found = Vec::new();
    let mut open: Vec<SyntaxNode<'_>> = vec![node];
    while let Some(here) = open.pop() {
        if matches!(here.kind(), SyntaxKind::Block | SyntaxKind::Choose) {
            if !is_empty(here) {
                found.push(here);
            }
        } else {
            open.extend(here.children());
        }
    }
    found
}
