//! Statements.

use exact::Rational;
use smol_str::SmolStr;

use super::bounds::expression;
use super::condition::{depth, is_condition, literal};
use super::{Lowering, dotted, name_of, names};
use crate::program::{Argument, ArgumentValue, Condition, LabelMode, Name, Statement, StatementKind};
use crate::span::Span;
use crate::syntax::{SyntaxKind, SyntaxNode};

impl Lowering<'_> {
    /// A `{ … }`: the sequence or the parallel it contains.
    pub(super) fn block(&mut self, node: SyntaxNode<'_>) -> Statement {
        collapse(self.steps(node), node.span())
    }

    fn steps(&mut self, node: SyntaxNode<'_>) -> Vec<Statement> {
        let mut steps = Vec::new();
        for child in node.children() {
            match child.kind() {
                SyntaxKind::Statement => steps.extend(self.statement(child)),
                SyntaxKind::Parallel => {
                    let mut branches = self.steps(child);
                    match branches.len() {
                        0 => {}
                        1 => steps.append(&mut branches),
                        _ => steps.push(Statement {
                            kind: StatementKind::Parallel(branches),
                            bounds: None,
                            span: child.span(),
                        }),
                    }
                }
                _ => {}
            }
        }
        steps
    }

    /// A statement, with its name around it if it has one.
    pub(super) fn statement(&mut self, node: SyntaxNode<'_>) -> Option<Statement> {
        let body = self.unnamed(node)?;
        let name = node.child(SyntaxKind::Naming).and_then(|naming| names(naming).nth(1));
        let Some(name) = name else { return Some(body) };
        Some(Statement { kind: StatementKind::Named(Box::new(body), name), bounds: None, span: node.span() })
    }

    fn unnamed(&mut self, node: SyntaxNode<'_>) -> Option<Statement> {
        let core = node.children().next()?;
        let bounds = self.chosen_by_plans(core, node);
        let span = match node.child(SyntaxKind::Naming) {
            Some(_) => {
                node.child(SyntaxKind::Bounds).map_or(core.span(), |bounds| core.span().cover(bounds.span()))
            }
            None => node.span(),
        };
        let kind = match core.kind() {
            SyntaxKind::Block => {
                let inner = self.block(core);
                // Without bounds of its own, a block around one statement is that statement.
                return Some(if bounds.is_some() { Statement { bounds, span, ..inner } } else { inner });
            }
            SyntaxKind::Choose => self.choose(core)?,
            SyntaxKind::Do => self.do_statement(core)?,
            SyntaxKind::If => {
                let mut branches = core.children().filter(|child| child.kind() == SyntaxKind::Statement);
                let body = self.statement(branches.next()?)?;
                let otherwise = branches.next().and_then(|branch| self.statement(branch));
                let deeper =
                    [Some(&body), otherwise.as_ref()].into_iter().flatten().max_by_key(|it| depth(it));
                let ways: &[bool] = if otherwise.is_some() { &[false, true] } else { &[false] };
                let formula = self.formula(core.children().next()?, deeper, ways)?;
                self.if_statement(formula, body, otherwise, core.span())?
            }
            SyntaxKind::Repeat => {
                let count = core.children().find(|child| child.kind() != SyntaxKind::Skipped)?;
                let body = self.block(core.child(SyntaxKind::Block)?);
                StatementKind::Repeat(expression(count)?, Box::new(body))
            }
            SyntaxKind::Free => {
                let word = core.token(SyntaxKind::Name)?;
                let delay = Statement { kind: StatementKind::Delay, bounds: None, span: word.span };
                let body = self.statement(core.child(SyntaxKind::Statement)?)?;
                StatementKind::Sequence(vec![delay, body])
            }
            SyntaxKind::Optional => {
                let word = core.token(SyntaxKind::Name)?;
                let body = self.statement(core.child(SyntaxKind::Statement)?)?;
                let nothing =
                    Statement { kind: StatementKind::Sequence(Vec::new()), bounds: None, span: word.span };
                StatementKind::Choose(vec![body, nothing])
            }
            SyntaxKind::Members => self.members(core)?,
            SyntaxKind::Unordered => StatementKind::Unordered(self.steps(core.child(SyntaxKind::Block)?)),
            SyntaxKind::Call => {
                let name = name_of(core.token(SyntaxKind::Name)?);
                let arguments = core.child(SyntaxKind::Arguments);
                StatementKind::Call(
                    name,
                    arguments.into_iter().flat_map(SyntaxNode::children).filter_map(argument).collect(),
                )
            }
            SyntaxKind::BareName => self.bare_name(name_of(core.token(SyntaxKind::Name)?)),
            SyntaxKind::Assertion => {
                let mode = if core.token(SyntaxKind::AskKeyword).is_some() {
                    LabelMode::Ask
                } else {
                    LabelMode::Tell
                };
                let condition = core.children().find(|child| is_condition(child.kind()))?;
                let formula = self.formula(condition, None, &[false])?;
                return self.assertion(mode, formula, bounds, span);
            }
            SyntaxKind::Delay => StatementKind::Delay,
            _ => return None,
        };
        Some(Statement { kind, bounds, span })
    }

    fn bare_name(&mut self, name: Name) -> StatementKind {
        self.bare_names.push(name.span.start);
        if (self.is_callable)(&name.text) {
            return StatementKind::Call(name, Vec::new());
        }
        let span = name.span;
        StatementKind::Condition(
            LabelMode::Tell,
            Condition { variable: name, values: Vec::new(), sees: None, level: None, negated: false, span },
        )
    }

    fn choose(&mut self, node: SyntaxNode<'_>) -> Option<StatementKind> {
        let mut alternatives = Vec::new();
        for child in node.children().filter(|child| child.kind() == SyntaxKind::Alternative) {
            let steps = self.steps(child);
            if !steps.is_empty() {
                alternatives.push(match <[Statement; 1]>::try_from(steps) {
                    Ok([only]) => only,
                    Err(steps) => {
                        Statement { kind: StatementKind::Sequence(steps), bounds: None, span: child.span() }
                    }
                });
            }
        }
        (!alternatives.is_empty()).then_some(StatementKind::Choose(alternatives))
    }

    fn do_statement(&mut self, node: SyntaxNode<'_>) -> Option<StatementKind> {
        let body = self.statement(node.child(SyntaxKind::Statement)?)?;
        // The words between the statement and the amount: `using` and the resource.
        let mut words = names(node);
        if words.next().is_some() {
            let amount = node.children().skip(1).find_map(expression);
            let resource = match node.child(SyntaxKind::Dotted) {
                Some(parts) => dotted(parts)?,
                None => words.next()?,
            };
            return Some(StatementKind::Using(Box::new(body), resource, amount));
        }
        let is_watching = node.token(SyntaxKind::WatchingKeyword).is_some();
        let condition = node.children().find(|child| is_condition(child.kind()))?;
        let formula = self.formula(condition, Some(&body), &[is_watching])?;
        let statement = if is_watching {
            self.watching(formula, body, node.span())
        } else {
            self.maintaining(&formula, body, node.span())?
        };
        Some(statement.kind)
    }
}

/// One statement represents itself unless it has bounds, which must not meet those of the block.
fn collapse(steps: Vec<Statement>, span: Span) -> Statement {
    match <[Statement; 1]>::try_from(steps) {
        Ok([only]) if only.bounds.is_none() => only,
        Ok(only) => Statement { kind: StatementKind::Sequence(only.into()), bounds: None, span },
        Err(steps) => Statement { kind: StatementKind::Sequence(steps), bounds: None, span },
    }
}

fn argument(node: SyntaxNode<'_>) -> Option<Argument> {
    let span = node.span();
    if let Some(parts) = node.child(SyntaxKind::Dotted) {
        return Some(Argument { value: ArgumentValue::Name(dotted(parts)?.text), span });
    }
    if let Some(inner) = node.children().find(|child| child.kind() != SyntaxKind::Skipped) {
        let value = if inner.kind() == SyntaxKind::Condition {
            ArgumentValue::Condition(literal(inner)?)
        } else {
            ArgumentValue::Expression(expression(inner)?)
        };
        return Some(Argument { value, span });
    }
    let negative = node.token(SyntaxKind::Minus).is_some();
    let token = node.own_tokens().find(|token| token.kind != SyntaxKind::Minus)?;
    let value = if token.kind == SyntaxKind::Number {
        let magnitude: Rational = token.text.parse().ok()?;
        ArgumentValue::Number(if negative { magnitude.checked_neg()? } else { magnitude })
    } else {
        ArgumentValue::Name(SmolStr::new(token.text))
    };
    Some(Argument { value, span })
}

/// A number with its sign, in meters.
pub(super) fn signed(negative: bool, magnitude: Rational) -> f64 {
    let magnitude = magnitude.to_f64();
    if negative { -magnitude } else { magnitude }
}
