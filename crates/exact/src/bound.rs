//! Bounds: times that may be infinite, and the arithmetic of SPEC 1.5 on them.

use std::fmt;
use std::str::FromStr;

use crate::read::is_infinity;
use crate::{ReadError, Time};

/// An upper bound: a finite time or infinity. Finite bounds order below infinity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Bound {
    Finite(Time),
    Infinite,
}

/// Why an expression of bounds has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BoundError {
    /// The exact result does not fit.
    #[error("the value of this expression is too large to represent exactly")]
    Overflow,
    #[error("division by zero")]
    DivisionByZero,
    /// ∞ · x for x < 0.
    #[error("infinity cannot be multiplied by a negative number")]
    NegativeInfinity,
    /// ∞ / x for x ≤ 0.
    #[error("infinity can only be divided by a positive number")]
    InfinityDivided,
    /// ∞ / ∞.
    #[error("infinity cannot be divided by infinity")]
    InfinityByInfinity,
    /// x − ∞.
    #[error("infinity cannot be subtracted")]
    InfinitySubtracted,
}

impl Bound {
    /// The bound at zero.
    pub const ZERO: Self = Self::Finite(Time::ZERO);

    /// The finite time, if there is one.
    pub const fn finite(self) -> Option<Time> {
        match self {
            Self::Finite(time) => Some(time),
            Self::Infinite => None,
        }
    }

    /// The sum; `None` when the exact result does not fit.
    pub fn checked_add(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Finite(left), Self::Finite(right)) => left.checked_add(right).map(Self::Finite),
            _ => Some(Self::Infinite),
        }
    }

    /// Returns what is left of the bound after `time`: ∞ − x = ∞. `None` when the exact result does not fit.
    pub fn checked_sub(self, time: Time) -> Option<Self> {
        match self {
            Self::Finite(bound) => bound.checked_sub(time).map(Self::Finite),
            Self::Infinite => Some(Self::Infinite),
        }
    }

    /// `self + other` in an expression of a program.
    pub fn plus(self, other: Self) -> Result<Self, BoundError> {
        self.checked_add(other).ok_or(BoundError::Overflow)
    }

    /// `self - other` in an expression of a program: ∞ − x = ∞.
    pub fn minus(self, other: Self) -> Result<Self, BoundError> {
        let other = other.finite().ok_or(BoundError::InfinitySubtracted)?;
        self.checked_sub(other).ok_or(BoundError::Overflow)
    }

    /// `self * other` in an expression of a program, where one of the two is a number: ∞ · 0 = 0, ∞ · x = ∞.
    pub fn times(self, other: Self) -> Result<Self, BoundError> {
        match (self, other) {
            (Self::Finite(left), Self::Finite(right)) => {
                left.checked_mul(right.units()).map(Self::Finite).ok_or(BoundError::Overflow)
            }
            (Self::Infinite, Self::Finite(factor)) | (Self::Finite(factor), Self::Infinite) => {
                if factor.is_negative() {
                    Err(BoundError::NegativeInfinity)
                } else if factor.is_zero() {
                    Ok(Self::ZERO)
                } else {
                    Ok(Self::Infinite)
                }
            }
            (Self::Infinite, Self::Infinite) => Ok(Self::Infinite),
        }
    }

    /// `self / other` in an expression of a program, where `other` is a number: x / ∞ = 0, ∞ / x = ∞.
    pub fn over(self, other: Self) -> Result<Self, BoundError> {
        match (self, other) {
            (Self::Finite(_), Self::Finite(divisor)) if divisor.is_zero() => Err(BoundError::DivisionByZero),
            (Self::Finite(left), Self::Finite(right)) => {
                left.checked_div(right.units()).map(Self::Finite).ok_or(BoundError::Overflow)
            }
            (Self::Infinite, Self::Finite(divisor)) if divisor.is_positive() => Ok(Self::Infinite),
            (Self::Infinite, Self::Finite(_)) => Err(BoundError::InfinityDivided),
            (Self::Infinite, Self::Infinite) => Err(BoundError::InfinityByInfinity),
            (Self::Finite(_), Self::Infinite) => Ok(Self::ZERO),
        }
    }

    /// As a float: as [`Time::to_f64`] rounds, or infinity.
    pub fn to_f64(self) -> f64 {
        self.finite().map_or(f64::INFINITY, Time::to_f64)
    }

    /// For people, as [`Time::readable`]; infinity is `inf`.
    pub fn readable(self) -> String {
        self.finite().map_or_else(|| self.to_string(), Time::readable)
    }

    /// For programs that know no fractions, as [`Time::nearest_decimal`]; infinity is `inf`.
    pub fn nearest_decimal(self) -> String {
        self.finite().map_or_else(|| self.to_string(), Time::nearest_decimal)
    }
}

impl From<Time> for Bound {
    fn from(time: Time) -> Self {
        Self::Finite(time)
    }
}

impl FromStr for Bound {
    type Err = ReadError;

    fn from_str(text: &str) -> Result<Self, ReadError> {
        if is_infinity(text) { Ok(Self::Infinite) } else { text.parse().map(Self::Finite) }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite(time) => time.fmt(f),
            Self::Infinite => f.pad("inf"),
        }
    }
}
