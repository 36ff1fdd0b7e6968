//! Times as whole ticks of a common part of a unit, for networks over integers.

use num_integer::Integer as _;

use crate::{Bound, Overflow, Rational, Time};

/// How many ticks are one unit: at least 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    ticks_per_unit: i64,
}

impl Default for Scale {
    fn default() -> Self {
        Self::UNITS
    }
}

impl Scale {
    /// One tick is one unit.
    pub const UNITS: Self = Self { ticks_per_unit: 1 };

    /// So many ticks are one unit; at least 1.
    pub const fn of(ticks_per_unit: u32) -> Self {
        Self { ticks_per_unit: if ticks_per_unit == 0 { 1 } else { ticks_per_unit as i64 } }
    }

    /// Returns how many ticks are one unit.
    pub const fn ticks_per_unit(self) -> i64 {
        self.ticks_per_unit
    }

    /// The coarsest scale that also counts `time` in whole ticks.
    pub fn refined(self, time: Time) -> Result<Self, Overflow> {
        let denominator = time.denominator();
        if self.ticks_per_unit % denominator == 0 {
            return Ok(self);
        }
        let common = i128::from(self.ticks_per_unit).lcm(&i128::from(denominator));
        i64::try_from(common).map(|ticks_per_unit| Self { ticks_per_unit }).map_err(|_| Overflow)
    }

    /// The coarsest scale that counts all of `times` in whole ticks.
    pub fn common(times: impl IntoIterator<Item = Time>) -> Result<Self, Overflow> {
        times.into_iter().try_fold(Self::UNITS, Self::refined)
    }

    /// A time in ticks; an error if it lies between two ticks or does not fit.
    pub fn ticks(self, time: Time) -> Result<i64, Overflow> {
        // In lowest terms only a multiple of the denominator makes a whole number of the time.
        if self.ticks_per_unit % time.denominator() != 0 {
            return Err(Overflow);
        }
        time.numerator().checked_mul(self.ticks_per_unit / time.denominator()).ok_or(Overflow)
    }

    /// A bound in ticks; `None` for infinity.
    pub fn bound_ticks(self, bound: Bound) -> Result<Option<i64>, Overflow> {
        bound.finite().map(|time| self.ticks(time)).transpose()
    }

    /// The tick nearest to a time, the later of two; the last one if the time lies beyond.
    pub fn nearest_tick(self, time: Time) -> i64 {
        let (numerator, denominator) = time.units().wide();
        // The product is below 2¹²⁶, or is -2¹²⁶ at least: its double and a half of the divisor still fit.
        let doubled = 2 * numerator * i128::from(self.ticks_per_unit) + denominator;
        let nearest = doubled.div_euclid(2 * denominator);
        i64::try_from(nearest).unwrap_or(if nearest < 0 { i64::MIN } else { i64::MAX })
    }

    /// The last tick that is not after a time; `None` if it does not fit.
    pub fn floor_tick(self, time: Time) -> Option<i64> {
        let (numerator, denominator) = time.units().wide();
        i64::try_from((numerator * i128::from(self.ticks_per_unit)).div_euclid(denominator)).ok()
    }

    /// The first tick that is not before a time; `None` if it does not fit.
    pub fn ceiling_tick(self, time: Time) -> Option<i64> {
        let (numerator, denominator) = time.units().wide();
        // Denominators are positive.
        i64::try_from(-(-numerator * i128::from(self.ticks_per_unit)).div_euclid(denominator)).ok()
    }

    /// The time of a tick.
    pub fn time(self, ticks: i64) -> Time {
        if self == Self::UNITS {
            return Time::from(ticks);
        }
        // A fraction over a positive denominator always fits.
        Time::from_units(Rational::new(ticks, self.ticks_per_unit).unwrap_or_default())
    }
}
