//! Exact evaluation of the bounds of a program (SPEC 1.5); every overflow is an error, nothing is rounded.

use exact::{Bound, BoundError, Rational, Time};
use rmpl::diagnostics::bounds::unlimited;
use rmpl::program::{BinaryOp, Bounds, DurationUnit, Expr, ExprKind};
use rmpl::{Code, Diagnostic, Span};

/// Bounds are not as SPEC 1.5 requires.
pub(super) const E_BOUNDS: Code = Code("E-BOUNDS");
/// An expression names no bound parameter.
pub(super) const E_NAME: Code = Code("E-NAME");

/// What the names and units of an expression represent.
pub(super) trait Values {
    /// The value of a name.
    fn number(&self, name: &str) -> Option<Bound>;

    /// Returns how many of the mission's units of time one `unit` is, if that can be said exactly.
    fn in_mission_units(&self, unit: DurationUnit) -> Option<Rational>;
}

/// A minimum and a maximum time: `lower ≤ upper`, of durations `0 ≤ lower`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Interval {
    pub(super) lower: Time,
    pub(super) upper: Bound,
}

impl Interval {
    /// No constraint but the order of the events.
    pub(super) const ANY: Self = Self { lower: Time::ZERO, upper: Bound::Infinite };
    /// At the same time.
    pub(super) const ZERO: Self = Self { lower: Time::ZERO, upper: Bound::ZERO };

    /// Returns whether it allows all that `other` does.
    pub(super) fn contains(self, other: Self) -> bool {
        self.lower <= other.lower && self.upper >= other.upper
    }

    /// Returns whether it allows no time at all.
    pub(super) fn allows_zero(self) -> bool {
        self.lower <= Time::ZERO && self.upper >= Bound::ZERO
    }

    /// The bounds from the second event back to the first, if the second never comes after the first.
    pub(super) fn reversed(self) -> Option<Self> {
        let (lower, upper) = (self.upper.finite()?.checked_neg()?, self.lower.checked_neg()?);
        (upper.is_positive() && !lower.is_negative()).then_some(Self { lower, upper: Bound::Finite(upper) })
    }

    /// Returns what both allow, if there is anything.
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

/// Evaluates the bounds of a duration.
pub(super) fn interval(bounds: &Bounds, values: &dyn Values) -> Result<Interval, Diagnostic> {
    let lower = value(&bounds.lower, values)?;
    let upper = value(&bounds.upper, values)?;
    let interval = checked_interval(lower, upper, bounds.span)?;
    if bounds.is_contingent && upper == Bound::Infinite {
        return Err(unlimited(bounds.upper.span));
    }
    Ok(interval)
}

/// Evaluates the bounds of the time between two events, which may come in either order.
pub(super) fn interval_between_events(bounds: &Bounds, values: &dyn Values) -> Result<Interval, Diagnostic> {
    ordered_interval(value(&bounds.lower, values)?, value(&bounds.upper, values)?, bounds.span)
}

/// The interval of the two evaluated sides of a duration, or what is wrong with it.
pub(super) fn checked_interval(lower: Bound, upper: Bound, span: Span) -> Result<Interval, Diagnostic> {
    let interval = ordered_interval(lower, upper, span)?;
    if interval.lower.is_negative() {
        let message = format!("the minimum {lower} is negative: an end cannot come before its start");
        return Err(Diagnostic::error(E_BOUNDS, span, message));
    }
    Ok(interval)
}

fn ordered_interval(lower: Bound, upper: Bound, span: Span) -> Result<Interval, Diagnostic> {
    let Bound::Finite(least) = lower else {
        return Err(Diagnostic::error(E_BOUNDS, span, "the minimum must be finite")
            .with_hint("only the maximum may be `inf`"));
    };
    if lower > upper {
        let message = format!("the minimum {lower} is greater than the maximum {upper}");
        return Err(Diagnostic::error(E_BOUNDS, span, message).with_hint("write the smaller bound first"));
    }
    Ok(Interval { lower: least, upper })
}

/// Returns whether the value of `bounds` depends on no name.
pub(super) fn is_constant(bounds: &Bounds) -> bool {
    fn constant(expr: &Expr) -> bool {
        match &expr.kind {
            ExprKind::Number(_) | ExprKind::Duration(..) | ExprKind::Infinity => true,
            ExprKind::Name(_) => false,
            ExprKind::Percent(inner) => constant(inner),
            ExprKind::Binary(_, left, right) => constant(left) && constant(right),
        }
    }
    constant(&bounds.lower) && constant(&bounds.upper)
}

/// The value of `expr`.
pub(super) fn value(expr: &Expr, values: &dyn Values) -> Result<Bound, Diagnostic> {
    match &expr.kind {
        ExprKind::Number(number) => Ok(Bound::Finite(Time::from_units(*number))),
        ExprKind::Duration(number, unit) => values
            .in_mission_units(*unit)
            .and_then(|one| one.checked_mul(*number))
            .map(|duration| Bound::Finite(Time::from_units(duration)))
            .ok_or_else(|| Diagnostic::error(E_BOUNDS, expr.span, BoundError::Overflow.to_string())),
        ExprKind::Infinity => Ok(Bound::Infinite),
        ExprKind::Name(name) => values.number(name).ok_or_else(|| {
            Diagnostic::error(E_NAME, expr.span, format!("`{name}` is not a number here")).with_hint(
                "use constants, numeric parameters, or the bounds in the activity's header, such as `l` and `u` in \
                 `Name()[l,u] = { … }`",
            )
        }),
        ExprKind::Percent(inner) => {
            let hundred = Bound::Finite(Time::from(100));
            arithmetic(BinaryOp::Divide, value(inner, values)?, hundred, expr.span)
        }
        ExprKind::Binary(op, left, right) => {
            arithmetic(*op, value(left, values)?, value(right, values)?, expr.span)
        }
    }
}

fn arithmetic(op: BinaryOp, left: Bound, right: Bound, span: Span) -> Result<Bound, Diagnostic> {
    let value = match op {
        BinaryOp::Add => left.plus(right),
        BinaryOp::Subtract => left.minus(right),
        BinaryOp::Multiply => left.times(right),
        BinaryOp::Divide => left.over(right),
    };
    value.map_err(|error| Diagnostic::error(E_BOUNDS, span, error.to_string()))
}
