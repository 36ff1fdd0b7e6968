//! Bounds that are constants, evaluated exactly (SPEC 1.5).

use exact::{Bound, BoundError, Time};

use crate::program::{BinaryOp, Bounds, Expr, ExprKind};

/// Why an expression has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ConstantError {
    /// It depends on a bound parameter.
    NotConstant,
    /// The arithmetic has no result: a division by zero, or infinity taken away.
    Undefined,
    /// The result is too large to be exact.
    TooLarge,
}

/// The bounds of a statement when both are constants and make sense together.
pub(crate) fn interval(bounds: &Bounds) -> Option<(Time, Bound)> {
    let lower = evaluate(&bounds.lower).ok()?.finite()?;
    let upper = evaluate(&bounds.upper).ok()?;
    (!lower.is_negative() && Bound::Finite(lower) <= upper).then_some((lower, upper))
}

/// The value of an expression without names.
pub(crate) fn evaluate(expr: &Expr) -> Result<Bound, ConstantError> {
    evaluate_with(expr, &|_| None)
}

/// The value of an expression where `lookup` gives the values of names.
pub(crate) fn evaluate_with(
    expr: &Expr,
    lookup: &dyn Fn(&str) -> Option<Bound>,
) -> Result<Bound, ConstantError> {
    match &expr.kind {
        ExprKind::Number(number) => Ok(Bound::Finite(Time::from_units(*number))),
        ExprKind::Infinity => Ok(Bound::Infinite),
        ExprKind::Name(name) => lookup(name).ok_or(ConstantError::NotConstant),
        ExprKind::Percent(inner) => {
            combine(BinaryOp::Divide, evaluate_with(inner, lookup)?, Bound::Finite(Time::from(100)))
        }
        ExprKind::Binary(operator, left, right) => {
            combine(*operator, evaluate_with(left, lookup)?, evaluate_with(right, lookup)?)
        }
    }
}

fn combine(operator: BinaryOp, left: Bound, right: Bound) -> Result<Bound, ConstantError> {
    let value = match operator {
        BinaryOp::Add => left.plus(right),
        BinaryOp::Subtract => left.minus(right),
        BinaryOp::Multiply => left.times(right),
        // Where infinity is written as a divisor, something else was meant.
        BinaryOp::Divide if right == Bound::Infinite => return Err(ConstantError::Undefined),
        BinaryOp::Divide => left.over(right),
    };
    value.map_err(|error| match error {
        BoundError::Overflow => ConstantError::TooLarge,
        _ => ConstantError::Undefined,
    })
}
