//! Points in time and durations, in the units of a mission.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::{Rational, ReadError};

/// An exact time in the mission's units: since its start, or between two events. Differences may be negative.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Time(Rational);

impl Time {
    /// The start, and no time at all.
    pub const ZERO: Self = Self(Rational::ZERO);
    /// One unit of time.
    pub const ONE: Self = Self(Rational::ONE);

    /// So many units.
    pub const fn from_units(units: Rational) -> Self {
        Self(units)
    }

    /// Returns how many units it is.
    pub const fn units(self) -> Rational {
        self.0
    }

    /// `numerator / denominator` units; `None` if the denominator is zero or the reduced fraction does not fit.
    pub fn new(numerator: i64, denominator: i64) -> Option<Self> {
        Rational::new(numerator, denominator).map(Self)
    }

    /// As [`Time::new`], of parts that need not fit by themselves.
    pub fn from_wide(numerator: i128, denominator: i128) -> Option<Self> {
        Rational::from_wide(numerator, denominator).map(Self)
    }

    /// The numerator of its units in lowest terms, with the sign.
    pub const fn numerator(self) -> i64 {
        self.0.numerator()
    }

    /// The denominator of its units in lowest terms: at least 1.
    pub const fn denominator(self) -> i64 {
        self.0.denominator()
    }

    /// Returns whether it is zero.
    pub const fn is_zero(self) -> bool {
        self.0.is_zero()
    }

    /// Returns whether it lies before nought.
    pub const fn is_negative(self) -> bool {
        self.0.is_negative()
    }

    /// Returns whether it lies after nought.
    pub const fn is_positive(self) -> bool {
        self.0.is_positive()
    }

    /// Returns whether it is a whole number of units.
    pub const fn is_integer(self) -> bool {
        self.0.is_integer()
    }

    /// The sum, or `None` if it overflows.
    pub fn checked_add(self, other: Self) -> Option<Self> {
        self.0.checked_add(other.0).map(Self)
    }

    /// The difference.
    pub fn checked_sub(self, other: Self) -> Option<Self> {
        self.0.checked_sub(other.0).map(Self)
    }

    /// The same in the other direction.
    pub fn checked_neg(self) -> Option<Self> {
        self.0.checked_neg().map(Self)
    }

    /// So many times as long.
    pub fn checked_mul(self, factor: impl Into<Rational>) -> Option<Self> {
        self.0.checked_mul(factor.into()).map(Self)
    }

    /// The part of it that fits so many times; `None` also if `divisor` is nought.
    pub fn checked_div(self, divisor: impl Into<Rational>) -> Option<Self> {
        self.0.checked_div(divisor.into()).map(Self)
    }

    /// Returns how many times `other` fits into it; `None` also if `other` is zero.
    pub fn checked_ratio(self, other: Self) -> Option<Rational> {
        self.0.checked_div(other.0)
    }

    /// Returns how many `1 / parts` of a unit it has, rounded down; `None` if that many do not fit.
    pub fn integer_parts(self, parts: u32) -> Option<i64> {
        self.0.integer_parts(parts)
    }

    /// The greatest time of which both are multiples; `None` if it does not fit.
    pub fn common_part(self, other: Self) -> Option<Self> {
        self.0.common_part(other.0).map(Self)
    }

    /// The sum of all.
    pub fn checked_sum(times: impl IntoIterator<Item = Self>) -> Option<Self> {
        times.into_iter().try_fold(Self::ZERO, Self::checked_add)
    }

    /// Its units as a float, as [`Rational::to_f64`] rounds.
    pub fn to_f64(self) -> f64 {
        self.0.to_f64()
    }

    /// A float that must become exact, rounded up to a multiple of `1 / parts` of a unit (SPEC 7.3: `parts` of a second
    /// are 1000). `None` as for [`Rational::from_f64_up`].
    pub fn from_f64_up(units: f64, parts: u32) -> Option<Self> {
        Rational::from_f64_up(units, parts).map(Self)
    }

    /// A float that must become exact, rounded to the nearest multiple of `1 / parts` of a unit. `None` as for
    /// [`Rational::from_f64_up`].
    pub fn from_f64_nearest(units: f64, parts: u32) -> Option<Self> {
        Rational::from_f64_nearest(units, parts).map(Self)
    }

    /// For people: exact where three decimals are enough, otherwise rounded to the thousandth and marked by `≈`.
    pub fn readable(self) -> String {
        self.0.readable()
    }

    /// For programs that know no fractions: exact where nine decimals are enough, otherwise the nearest such number.
    pub fn nearest_decimal(self) -> String {
        self.0.nearest_decimal()
    }

    /// As an exact decimal, if it is one.
    pub fn decimal(self) -> Option<String> {
        self.0.decimal()
    }
}

impl From<i64> for Time {
    fn from(units: i64) -> Self {
        Self(units.into())
    }
}

impl From<i32> for Time {
    fn from(units: i32) -> Self {
        Self(units.into())
    }
}

impl FromStr for Time {
    type Err = ReadError;

    fn from_str(text: &str) -> Result<Self, ReadError> {
        text.parse().map(Self)
    }
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Debug for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
