//! Bounds and the expressions in them.

use exact::Rational;
use smol_str::SmolStr;

use crate::parser::CONTINGENT;
use crate::program::{BinaryOp, Bounds, DurationUnit, Expr, ExprKind, HeaderBound, HeaderBounds};
use crate::syntax::{Element, SyntaxKind, SyntaxNode, SyntaxToken};

/// The bounds after a construct, if they stand directly in `node` and are whole.
pub(super) fn bounds_in(node: SyntaxNode<'_>) -> Option<Bounds> {
    let bounds = node.child(SyntaxKind::Bounds)?;
    let (lower, upper) = sides(bounds)?;
    Some(Bounds { lower, upper, is_contingent: contingent_in(bounds).is_some(), span: bounds.span() })
}

/// The word before bounds within which the environment chooses (SPEC 13.1).
pub(crate) fn contingent_in(bounds: SyntaxNode<'_>) -> Option<SyntaxToken<'_>> {
    bounds.own_tokens().next().filter(|token| token.kind == SyntaxKind::Name && token.text == CONTINGENT)
}

/// The bounds in the header of an activity: a plain name declares a bound parameter.
pub(super) fn header_bounds_in(node: SyntaxNode<'_>) -> HeaderBounds {
    let Some(bounds) = node.child(SyntaxKind::Bounds) else { return HeaderBounds::None };
    let Some((lower, upper)) = sides(bounds) else { return HeaderBounds::None };
    HeaderBounds::Sides { lower: header_bound(lower), upper: header_bound(upper), span: bounds.span() }
}

fn header_bound(side: Expr) -> HeaderBound {
    match side.kind {
        ExprKind::Name(text) => HeaderBound::Parameter(crate::program::Name { text, span: side.span }),
        _ => HeaderBound::Limit(side),
    }
}

fn sides(bounds: SyntaxNode<'_>) -> Option<(Expr, Expr)> {
    let mut sides = bounds.children().filter(|child| child.kind() != SyntaxKind::Skipped);
    let (lower, upper) = (sides.next()?, sides.next()?);
    Some((expression(lower)?, expression(upper)?))
}

/// The expression of a node in a bound, if it is whole.
pub(crate) fn expression(node: SyntaxNode<'_>) -> Option<Expr> {
    let span = node.span();
    let kind = match node.kind() {
        SyntaxKind::Operand => {
            let token = node.own_tokens().next()?;
            match token.kind {
                SyntaxKind::Number => {
                    let number = token.text.parse().ok()?;
                    match node.token(SyntaxKind::Name) {
                        Some(unit) => ExprKind::Duration(number, DurationUnit::by_name(unit.text)?),
                        None => ExprKind::Number(number),
                    }
                }
                SyntaxKind::Infinity => ExprKind::Infinity,
                _ => ExprKind::Name(SmolStr::new(token.text)),
            }
        }
        SyntaxKind::Grouped => {
            let inner = expression(node.children().next()?)?;
            return Some(Expr { span, ..inner });
        }
        SyntaxKind::Negation => {
            let zero = Expr { kind: ExprKind::Number(Rational::ZERO), span };
            let inner = expression(node.children().next()?)?;
            ExprKind::Binary(BinaryOp::Subtract, Box::new(zero), Box::new(inner))
        }
        SyntaxKind::PercentOf => ExprKind::Percent(Box::new(expression(node.children().next()?)?)),
        SyntaxKind::Sum | SyntaxKind::Product => return chain(node),
        _ => return None,
    };
    Some(Expr { kind, span })
}

/// Operands joined from left to right.
fn chain(node: SyntaxNode<'_>) -> Option<Expr> {
    let mut result: Option<Expr> = None;
    let mut operator = BinaryOp::Add;
    for element in node.elements() {
        match element {
            Element::Token(token) => match token.kind {
                SyntaxKind::Plus => operator = BinaryOp::Add,
                SyntaxKind::Minus => operator = BinaryOp::Subtract,
                SyntaxKind::Star => operator = BinaryOp::Multiply,
                SyntaxKind::Slash => operator = BinaryOp::Divide,
                _ => {}
            },
            Element::Node(operand) => {
                let operand = expression(operand)?;
                result = Some(match result {
                    None => operand,
                    Some(left) => Expr {
                        span: left.span.cover(operand.span),
                        kind: ExprKind::Binary(operator, Box::new(left), Box::new(operand)),
                    },
                });
            }
        }
    }
    result
}
