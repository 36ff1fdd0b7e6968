//! Conditions joined by `and` and `or`, and the statements that they represent (SPEC 14).
//!
//! The language below knows single literals only. What is required of several is required of each, nested; a choice
//! represents "one of several". Of what is asserted there is no choice.

use crate::diagnostics::{limit, syntax};
use crate::program::{Bounds, Condition, LabelMode, Level, Name, Order, Statement, StatementKind};
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode};

use super::bounds::expression;
use super::{Lowering, name_of, names, variable_in};

/// A declaration grows by no more statements than this where `or` copies what it is beside.
const MAX_COPIED: usize = 10_000;
/// What is required of something nests no deeper than compilation allows, so that no text can exhaust the stack.
const MAX_NESTED: usize = 200;

/// A condition with its negations pushed down to the literals.
#[derive(Clone, Debug)]
pub(super) enum Formula {
    Literal(Condition),
    All(Vec<Formula>),
    Any(Vec<Formula>, Span),
}

/// Returns whether a node of this kind is a condition.
pub(crate) const fn is_condition(kind: SyntaxKind) -> bool {
    matches!(
        kind,
        SyntaxKind::Condition
            | SyntaxKind::AllOf
            | SyntaxKind::AnyOf
            | SyntaxKind::NotOf
            | SyntaxKind::ConditionGroup
    )
}

/// The condition of a node, if it is whole.
pub(super) fn formula(node: SyntaxNode<'_>) -> Option<Formula> {
    let parts = || node.children().filter(|child| is_condition(child.kind())).map(formula);
    match node.kind() {
        SyntaxKind::Condition => literal(node).map(Formula::Literal),
        SyntaxKind::AllOf => Some(Formula::All(parts().collect::<Option<_>>()?)),
        SyntaxKind::AnyOf => Some(Formula::Any(parts().collect::<Option<_>>()?, node.span())),
        SyntaxKind::NotOf => Some(parts().next()??.negation(node.span())),
        SyntaxKind::ConditionGroup => parts().next()?,
        _ => None,
    }
}

impl Formula {
    /// Returns what holds exactly when this does not; `span` is where the negation is written.
    fn negation(self, span: Span) -> Self {
        match self {
            Self::Literal(literal) => Self::Literal(Condition { negated: !literal.negated, ..literal }),
            Self::All(parts) => Self::Any(parts.into_iter().map(|part| part.negation(span)).collect(), span),
            Self::Any(parts, _) => Self::All(parts.into_iter().map(|part| part.negation(span)).collect()),
        }
    }

    /// Returns how deep what it is required of nests: several joined by `and` are nested, those joined by `or` are
    /// alternatives.
    fn height(&self, is_negated: bool) -> usize {
        match self {
            Self::Literal(_) => 1,
            Self::All(parts) | Self::Any(parts, _) => {
                let heights = parts.iter().map(|part| part.height(is_negated));
                if matches!(self, Self::All(_)) == is_negated {
                    1 + heights.max().unwrap_or(0)
                } else {
                    heights.sum()
                }
            }
        }
    }

    /// Returns where it is written.
    fn span(&self) -> Span {
        match self {
            Self::Literal(literal) => literal.span,
            Self::All(parts) => parts.iter().map(Self::span).reduce(Span::cover).unwrap_or_default(),
            Self::Any(_, span) => *span,
        }
    }
}

/// A literal, with its negations folded.
pub(crate) fn literal(node: SyntaxNode<'_>) -> Option<Condition> {
    let mut negated = false;
    let mut compared = false;
    let mut variable = node.child(SyntaxKind::Dotted).and_then(|_| variable_in(node));
    let mut values: Vec<Name> = Vec::new();
    for token in node.own_tokens() {
        match token.kind {
            SyntaxKind::NotKeyword | SyntaxKind::Bang => negated = !negated,
            SyntaxKind::NotEquals => {
                negated = !negated;
                compared = true;
            }
            SyntaxKind::Equals => compared = true,
            SyntaxKind::Name if variable.is_none() => variable = Some(name_of(token)),
            SyntaxKind::Name | SyntaxKind::Number if compared => values.push(name_of(token)),
            _ => {}
        }
    }
    if let Some(domain) = node.child(SyntaxKind::Domain) {
        compared = true;
        values = names(domain).collect();
    }
    let visible = node.child(SyntaxKind::Visible);
    // The first name is the word `visible` itself.
    let sees = visible.filter(|visible| visible.token(SyntaxKind::Dot).is_none());
    let sees = sees.and_then(|visible| names(visible).nth(1));
    if visible.is_some() {
        compared = sees.is_none();
        values.clear();
    }
    let order = node.token(SyntaxKind::Order);
    let level = match order {
        None => None,
        Some(order) => Some(Level {
            order: Order::by_symbol(order.text),
            bound: node.children().find_map(expression)?,
            is_at_start: names(node).any(|word| word.text == "start" && word.span.start > order.span.end),
        }),
    };
    (compared != values.is_empty()).then_some(Condition {
        variable: variable?,
        values,
        sees,
        level,
        negated,
        span: node.span(),
    })
}

/// How `body` is written where one literal is required of it.
type Require = fn(Condition, Box<Statement>) -> StatementKind;

impl Lowering<'_> {
    /// The condition of a node, which is required of `body` or denied, as `is_denied` says; none if it is broken, or
    /// nests too deeply.
    pub(super) fn formula(
        &mut self,
        node: SyntaxNode<'_>,
        body: Option<&Statement>,
        is_denied: &[bool],
    ) -> Option<Formula> {
        let formula = formula(node)?;
        let height = is_denied.iter().map(|&is_denied| formula.height(is_denied)).max().unwrap_or(0);
        if height > 1 && height + body.map_or(0, depth) > MAX_NESTED {
            self.diagnostics.push(limit::nested(MAX_NESTED, node.span()));
            return None;
        }
        Some(formula)
    }

    /// `do body maintaining formula`.
    pub(super) fn maintaining(
        &mut self,
        formula: &Formula,
        body: Statement,
        span: Span,
    ) -> Option<Statement> {
        self.asked(formula, body, span, |literal, body| StatementKind::Maintaining(body, literal))
    }

    /// `body` where `formula` is required; the first literal is the innermost.
    fn asked(
        &mut self,
        formula: &Formula,
        body: Statement,
        span: Span,
        require: Require,
    ) -> Option<Statement> {
        match formula {
            Formula::Literal(literal) => {
                Some(Statement { kind: require(literal.clone(), Box::new(body)), bounds: None, span })
            }
            Formula::All(parts) => {
                parts.iter().try_fold(body, |body, part| self.asked(part, body, span, require))
            }
            Formula::Any(parts, place) => {
                let mut alternatives = Vec::with_capacity(parts.len());
                for part in parts {
                    let body = self.copy(&body, *place)?;
                    alternatives.push(self.asked(part, body, span, require)?);
                }
                Some(Statement { kind: StatementKind::Choose(alternatives), bounds: None, span })
            }
        }
    }

    /// One more of `body`, unless the declaration has grown too large already.
    fn copy(&mut self, body: &Statement, span: Span) -> Option<Statement> {
        let had_room = self.copied <= MAX_COPIED;
        self.copied = self.copied.saturating_add(size(body));
        if self.copied > MAX_COPIED {
            if had_room {
                self.diagnostics.push(limit::copied(MAX_COPIED, span));
            }
            return None;
        }
        Some(body.clone())
    }

    /// `if formula thennext body else otherwise`.
    pub(super) fn if_statement(
        &mut self,
        formula: Formula,
        body: Statement,
        otherwise: Option<Statement>,
        span: Span,
    ) -> Option<StatementKind> {
        let mut guarded =
            |formula: &Formula, body: Statement| self.asked(formula, body, span, StatementKind::IfThennext);
        let Some(otherwise) = otherwise else { return Some(guarded(&formula, body)?.kind) };
        let place = formula.span();
        let then = guarded(&formula, body)?;
        let otherwise = guarded(&formula.negation(place), otherwise)?;
        Some(StatementKind::Choose(vec![then, otherwise]))
    }

    /// `do body watching formula`, which asserts that the formula does not hold.
    pub(super) fn watching(&mut self, formula: Formula, body: Statement, span: Span) -> Statement {
        let place = formula.span();
        // Without the condition, the activities are still known.
        let denied = self.told(formula.negation(place)).unwrap_or_default();
        let around = |body, literal: Condition| {
            let watched = Condition { negated: !literal.negated, ..literal };
            Statement { kind: StatementKind::Watching(Box::new(body), watched), bounds: None, span }
        };
        denied.into_iter().fold(body, around)
    }

    /// `formula`, `tell formula` or `ask formula`, for as long as `bounds` say.
    pub(super) fn assertion(
        &mut self,
        mode: LabelMode,
        formula: Formula,
        bounds: Option<Bounds>,
        span: Span,
    ) -> Option<Statement> {
        let single = |literal: Condition, bounds: Option<Bounds>| Statement {
            kind: StatementKind::Condition(mode, literal),
            bounds,
            span,
        };
        match (mode, formula) {
            (_, Formula::Literal(literal)) => Some(single(literal, bounds)),
            (LabelMode::Ask, Formula::Any(parts, _)) => {
                let alternatives =
                    parts.into_iter().map(|part| self.assertion(mode, part, bounds.clone(), span));
                let alternatives = alternatives.collect::<Option<Vec<_>>>()?;
                Some(Statement { kind: StatementKind::Choose(alternatives), bounds: None, span })
            }
            (LabelMode::Ask, Formula::All(parts)) => {
                let mut parts = parts.into_iter();
                let first = self.assertion(mode, parts.next()?, bounds, span)?;
                parts.try_fold(first, |body, part| self.maintaining(&part, body, span))
            }
            (LabelMode::Tell, formula) => {
                let mut literals = self.told(formula)?.into_iter();
                let first = single(literals.next()?, bounds);
                Some(literals.fold(first, |body, literal| {
                    let kind = StatementKind::Telling(Box::new(body), literal);
                    Statement { kind, bounds: None, span }
                }))
            }
        }
    }

    /// The literals of a condition that is asserted; a choice between several is a mistake.
    fn told(&mut self, formula: Formula) -> Option<Vec<Condition>> {
        match formula {
            Formula::Literal(literal) => Some(vec![literal]),
            Formula::All(parts) => {
                let told = parts.into_iter().map(|part| self.told(part));
                Some(told.collect::<Option<Vec<_>>>()?.into_iter().flatten().collect())
            }
            Formula::Any(_, span) => {
                self.diagnostics.push(syntax::choice_asserted(span));
                None
            }
        }
    }
}

/// Returns how many statements there are in `statement`, itself included.
fn size(statement: &Statement) -> usize {
    1 + statement.parts().iter().map(size).sum::<usize>()
}

/// Returns how deep `statement` is nested, itself included.
pub(super) fn depth(statement: &Statement) -> usize {
    1 + statement.parts().iter().map(depth).max().unwrap_or(0)
}
