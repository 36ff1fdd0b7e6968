//! Exact evaluation of the bounds of a program (SPEC 1.5); every overflow is an error, nothing is rounded.

use num_traits::{CheckedAdd as _, CheckedDiv as _, CheckedMul as _, CheckedSub as _, Zero as _};
use rmpl::program::{BinaryOp, Bounds, Expr, ExprKind};
use rmpl::{Bound, Code, Diagnostic, Rational, Span};

/// Bounds are not as SPEC 1.5 requires.
pub(super) const E_BOUNDS: Code = Code("E-BOUNDS");
/// An expression names no bound parameter.
pub(super) const E_NAME: Code = Code("E-NAME");

/// A least and a greatest duration: `0 ≤ lower ≤ upper`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Interval {
    pub(super) lower: Rational,
    pub(super) upper: Bound,
}

impl Interval {
    /// No constraint but the order of the events.
    pub(super) const ANY: Self = Self { lower: Rational::new_raw(0, 1), upper: Bound::Infinite };
    /// At the same time.
    pub(super) const ZERO: Self = Self { lower: Rational::new_raw(0, 1), upper: Bound::ZERO };

    /// What both allow, if there is anything.
    pub(super) fn intersect(self, other: Self) -> Option<Self> {
        let both = Self { lower: self.lower.max(other.lower), upper: self.upper.min(other.upper) };
        (Bound::Finite(both.lower) <= both.upper).then_some(both)
    }
}

impl std::fmt::Display for Interval {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{},{}]", Bound::Finite(self.lower), self.upper)
    }
}

/// Evaluates `bounds`; `lookup` gives the value of a name.
pub(super) fn interval(
    bounds: &Bounds,
    lookup: &dyn Fn(&str) -> Option<Bound>,
) -> Result<Interval, Diagnostic> {
    let lower = value(&bounds.lower, lookup)?;
    let upper = value(&bounds.upper, lookup)?;
    checked_interval(lower, upper, bounds.span)
}

/// The interval of two evaluated sides, or what is wrong with it.
pub(super) fn checked_interval(lower: Bound, upper: Bound, span: Span) -> Result<Interval, Diagnostic> {
    let Bound::Finite(least) = lower else {
        return Err(Diagnostic::error(E_BOUNDS, span, "the lower bound is infinite: nothing could ever end")
            .with_hint("only the upper bound may be `inf`"));
    };
    if least < Rational::zero() {
        let message = format!("the lower bound {lower} is negative: an end cannot come before its start");
        return Err(Diagnostic::error(E_BOUNDS, span, message));
    }
    if lower > upper {
        let message = format!("the lower bound {lower} is greater than the upper bound {upper}");
        return Err(Diagnostic::error(E_BOUNDS, span, message).with_hint("write the smaller bound first"));
    }
    Ok(Interval { lower: least, upper })
}

/// Whether the value of `bounds` depends on no name.
pub(super) fn is_constant(bounds: &Bounds) -> bool {
    fn constant(expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Infinity => true,
            ExprKind::Name(_) => false,
            ExprKind::Percent(inner) => constant(inner),
            ExprKind::Binary(_, left, right) => constant(left) && constant(right),
        }
    }
    constant(&bounds.lower) && constant(&bounds.upper)
}

/// The value of `expr`.
pub(super) fn value(expr: &Expr, lookup: &dyn Fn(&str) -> Option<Bound>) -> Result<Bound, Diagnostic> {
    match &expr.kind {
        ExprKind::Number(number) => Ok(Bound::Finite(*number)),
        ExprKind::Infinity => Ok(Bound::Infinite),
        ExprKind::Name(name) => lookup(name).ok_or_else(|| {
            Diagnostic::error(E_NAME, expr.span, format!("`{name}` names no bound here")).with_hint(
                "bounds may name the bound parameters of the surrounding activity's header, such as `l` and `u` in \
                 `Name()[l,u] = { … }`",
            )
        }),
        ExprKind::Percent(inner) => {
            let hundredth = Bound::Finite(Rational::new_raw(1, 100));
            arithmetic(BinaryOp::Multiply, value(inner, lookup)?, hundredth, expr.span)
        }
        ExprKind::Binary(op, left, right) => {
            arithmetic(*op, value(left, lookup)?, value(right, lookup)?, expr.span)
        }
    }
}

fn arithmetic(op: BinaryOp, left: Bound, right: Bound, span: Span) -> Result<Bound, Diagnostic> {
    let error = |message: &str| Err(Diagnostic::error(E_BOUNDS, span, message));
    let zero = Rational::zero();
    match (left, right) {
        (Bound::Finite(left), Bound::Finite(right)) => {
            if op == BinaryOp::Divide && right.is_zero() {
                return error("division by zero");
            }
            let exact = match op {
                BinaryOp::Add => left.checked_add(&right),
                BinaryOp::Subtract => left.checked_sub(&right),
                BinaryOp::Multiply => left.checked_mul(&right),
                BinaryOp::Divide => left.checked_div(&right),
            };
            exact.map_or_else(
                || error("the exact value of this expression does not fit into 64 bits"),
                |exact| Ok(Bound::Finite(exact)),
            )
        }
        (Bound::Infinite, Bound::Finite(finite)) | (Bound::Finite(finite), Bound::Infinite)
            if op == BinaryOp::Multiply =>
        {
            match finite.cmp(&zero) {
                std::cmp::Ordering::Less => error("infinity times a negative number is no bound"),
                std::cmp::Ordering::Equal => Ok(Bound::ZERO),
                std::cmp::Ordering::Greater => Ok(Bound::Infinite),
            }
        }
        (Bound::Infinite, Bound::Finite(finite)) if op == BinaryOp::Divide => {
            if finite > zero {
                Ok(Bound::Infinite)
            } else {
                error("infinity can only be divided by a positive number")
            }
        }
        (Bound::Finite(_), Bound::Infinite) if op == BinaryOp::Divide => Ok(Bound::ZERO),
        (Bound::Infinite, Bound::Infinite) if op == BinaryOp::Divide => {
            error("infinity divided by infinity is no bound")
        }
        (_, Bound::Infinite) if op == BinaryOp::Subtract => error("subtracting infinity leaves no bound"),
        _ => Ok(Bound::Infinite),
    }
}
