//! Bounds that are constants, evaluated exactly (SPEC 1.5).

use num_traits::{
    CheckedAdd as _, CheckedDiv as _, CheckedMul as _, CheckedSub as _, Signed as _, Zero as _,
};

use crate::program::{BinaryOp, Bounds, Expr, ExprKind};
use crate::rational::{Bound, Rational};

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
pub(crate) fn interval(bounds: &Bounds) -> Option<(Rational, Bound)> {
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
        ExprKind::Number(number) => Ok(Bound::Finite(*number)),
        ExprKind::Infinity => Ok(Bound::Infinite),
        ExprKind::Name(name) => lookup(name).ok_or(ConstantError::NotConstant),
        ExprKind::Percent(inner) => match evaluate_with(inner, lookup)? {
            Bound::Infinite => Ok(Bound::Infinite),
            Bound::Finite(whole) => {
                let hundredth = whole.checked_div(&Rational::from_integer(100));
                hundredth.map(Bound::Finite).ok_or(ConstantError::TooLarge)
            }
        },
        ExprKind::Binary(operator, left, right) => {
            combine(*operator, evaluate_with(left, lookup)?, evaluate_with(right, lookup)?)
        }
    }
}

fn combine(operator: BinaryOp, left: Bound, right: Bound) -> Result<Bound, ConstantError> {
    use Bound::{Finite, Infinite};
    let exact = |value: Option<Rational>| value.map(Finite).ok_or(ConstantError::TooLarge);
    match (operator, left, right) {
        (BinaryOp::Add, Finite(left), Finite(right)) => exact(left.checked_add(&right)),
        (BinaryOp::Add, ..)
        | (BinaryOp::Subtract, Infinite, Finite(_))
        | (BinaryOp::Multiply, Infinite, Infinite) => Ok(Infinite),
        (BinaryOp::Subtract, Finite(left), Finite(right)) => exact(left.checked_sub(&right)),
        (BinaryOp::Multiply, Finite(left), Finite(right)) => exact(left.checked_mul(&right)),
        (BinaryOp::Multiply, Infinite, Finite(factor)) | (BinaryOp::Multiply, Finite(factor), Infinite) => {
            if factor.is_zero() {
                Ok(Bound::ZERO)
            } else if factor.is_negative() {
                Err(ConstantError::Undefined)
            } else {
                Ok(Infinite)
            }
        }
        (BinaryOp::Divide, _, Finite(divisor)) if divisor.is_zero() => Err(ConstantError::Undefined),
        (BinaryOp::Divide, Finite(left), Finite(right)) => exact(left.checked_div(&right)),
        (BinaryOp::Divide, Infinite, Finite(divisor)) if !divisor.is_negative() => Ok(Infinite),
        (BinaryOp::Subtract | BinaryOp::Divide, ..) => Err(ConstantError::Undefined),
    }
}
