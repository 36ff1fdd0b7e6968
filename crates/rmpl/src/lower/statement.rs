//! Statements and conditions.

use exact::Rational;
use smol_str::SmolStr;

use super::bounds::bounds_in;
use super::{Lowering, name_of};
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

    fn statement(&mut self, node: SyntaxNode<'_>) -> Option<Statement> {
        let core = node.children().next()?;
        let bounds = bounds_in(node);
        let span = node.span();
        let kind = match core.kind() {
            SyntaxKind::Block => {
                let inner = self.block(core);
                // Without bounds of its own, a block around one statement is that statement.
                return Some(if bounds.is_some() { Statement { bounds, span, ..inner } } else { inner });
            }
            SyntaxKind::Choose => self.choose(core)?,
            SyntaxKind::Do => self.do_statement(core)?,
            SyntaxKind::If => {
                let condition = condition(core.child(SyntaxKind::Condition)?)?;
                let body = self.statement(core.child(SyntaxKind::Statement)?)?;
                StatementKind::IfThennext(condition, Box::new(body))
            }
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
                StatementKind::Condition(mode, condition(core.child(SyntaxKind::Condition)?)?)
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
            Condition { variable: name, value: None, negated: false, span },
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
        let body = Box::new(self.statement(node.child(SyntaxKind::Statement)?)?);
        let condition = condition(node.child(SyntaxKind::Condition)?)?;
        Some(if node.token(SyntaxKind::WatchingKeyword).is_some() {
            StatementKind::Watching(body, condition)
        } else {
            StatementKind::Maintaining(body, condition)
        })
    }
}

/// One statement stands for itself unless it has bounds, which must not meet those of the block.
fn collapse(steps: Vec<Statement>, span: Span) -> Statement {
    match <[Statement; 1]>::try_from(steps) {
        Ok([only]) if only.bounds.is_none() => only,
        Ok(only) => Statement { kind: StatementKind::Sequence(only.into()), bounds: None, span },
        Err(steps) => Statement { kind: StatementKind::Sequence(steps), bounds: None, span },
    }
}

fn argument(node: SyntaxNode<'_>) -> Option<Argument> {
    let negative = node.token(SyntaxKind::Minus).is_some();
    let token = node.own_tokens().find(|token| token.kind != SyntaxKind::Minus)?;
    let value = if token.kind == SyntaxKind::Number {
        let magnitude: Rational = token.text.parse().ok()?;
        ArgumentValue::Number(if negative { magnitude.checked_neg()? } else { magnitude })
    } else {
        ArgumentValue::Name(SmolStr::new(token.text))
    };
    Some(Argument { value, span: node.span() })
}

/// A literal, with its negations folded.
fn condition(node: SyntaxNode<'_>) -> Option<Condition> {
    let mut negated = false;
    let mut compared = false;
    let mut variable = None;
    let mut value = None;
    for token in node.own_tokens() {
        match token.kind {
            SyntaxKind::NotKeyword | SyntaxKind::Bang => negated = !negated,
            SyntaxKind::NotEquals => {
                negated = !negated;
                compared = true;
            }
            SyntaxKind::Equals => compared = true,
            SyntaxKind::Name if variable.is_none() => variable = Some(name_of(token)),
            SyntaxKind::Name | SyntaxKind::Number => value = Some(name_of(token)),
            _ => {}
        }
    }
    (compared == value.is_some()).then_some(Condition {
        variable: variable?,
        value,
        negated,
        span: node.span(),
    })
}

/// A number with its sign, in metres.
pub(super) fn signed(negative: bool, magnitude: Rational) -> f64 {
    let magnitude = magnitude.to_f64();
    if negative { -magnitude } else { magnitude }
}
