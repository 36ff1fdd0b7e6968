//! Exact time: rationals, and bounds that may be infinite (SPEC 1.5).

use std::fmt;

use num_traits::CheckedAdd as _;
use serde::{Deserialize, Serialize};

/// An exact number of time units.
pub type Rational = num_rational::Ratio<i64>;

/// An upper bound: a finite time or infinity. Finite bounds order below infinity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Bound {
    /// A finite time.
    Finite(Rational),
    /// No bound.
    Infinite,
}

impl Bound {
    /// The bound at zero.
    pub const ZERO: Self = Self::Finite(Rational::new_raw(0, 1));

    /// The finite time, if there is one.
    pub const fn finite(self) -> Option<Rational> {
        match self {
            Self::Finite(time) => Some(time),
            Self::Infinite => None,
        }
    }

    /// The sum; `None` when the exact result does not fit.
    pub fn checked_add(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Finite(left), Self::Finite(right)) => left.checked_add(&right).map(Self::Finite),
            _ => Some(Self::Infinite),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Finite(time) => f.write_str(&display(*time)),
            Self::Infinite => f.write_str("inf"),
        }
    }
}

/// `time` as a decimal where that is exact, otherwise as `p/q`.
pub fn display(time: Rational) -> String {
    decimal(time).unwrap_or_else(|| format!("{}/{}", time.numer(), time.denom()))
}

/// `time` for people: exact where three decimals are enough, otherwise rounded to the thousandth and marked by `≈`.
pub fn readable(time: Rational) -> String {
    if let Some(exact) =
        decimal(time).filter(|exact| exact.split('.').nth(1).is_none_or(|part| part.len() <= 3))
    {
        return exact;
    }
    let (numerator, denominator) = (i128::from(*time.numer()), i128::from(*time.denom()));
    // To the nearest: half a thousandth is added before rounding down.
    let thousandths = (2000 * numerator + denominator).div_euclid(2 * denominator);
    let sign = if thousandths < 0 { "-" } else { "" };
    let magnitude = thousandths.unsigned_abs();
    let digits = format!("{sign}{}.{:03}", magnitude / 1000, magnitude % 1000);
    format!("≈ {}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// `time` as an exact decimal, when its denominator has no prime factors but 2 and 5.
pub fn decimal(time: Rational) -> Option<String> {
    let (numerator, denominator) = (i128::from(*time.numer()), i128::from(*time.denom()));
    let mut digits = 0;
    let mut scale: i128 = 1;
    while scale % denominator != 0 {
        digits += 1;
        scale = scale.checked_mul(10).filter(|_| digits <= 19)?;
    }
    let scaled = numerator.checked_mul(scale / denominator)?;
    let sign = if scaled < 0 { "-" } else { "" };
    let magnitude = scaled.unsigned_abs();
    let scale = scale.unsigned_abs();
    if digits == 0 {
        return Some(format!("{sign}{magnitude}"));
    }
    Some(format!("{sign}{}.{:0digits$}", magnitude / scale, magnitude % scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn people_read_at_most_three_decimals() {
        assert_eq!(readable(Rational::new(819, 2)), "409.5");
        assert_eq!(readable(Rational::new(108_289, 7500)), "≈ 14.439");
        assert_eq!(readable(Rational::new(-1, 3)), "≈ -0.333");
        assert_eq!(readable(Rational::new(13_895_905, 100_000)), "≈ 138.959");
        assert_eq!(readable(Rational::new(29_999_999, 10_000_000)), "≈ 3");
        assert_eq!(readable(Rational::from(7)), "7");
    }

    #[test]
    fn a_time_is_shown_as_an_exact_decimal_or_as_a_fraction() {
        assert_eq!(display(Rational::new(819, 2)), "409.5");
        assert_eq!(display(Rational::new(-1, 8)), "-0.125");
        assert_eq!(display(Rational::new(405, 1)), "405");
        assert_eq!(display(Rational::new(1000, 3)), "1000/3");
    }
}
