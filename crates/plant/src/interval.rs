//! Probabilities that are known between two limits, and how they are written (SPEC3 17.2).

use std::fmt;

use num_bigint::BigInt;
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, ToPrimitive as _, Zero as _};
use serde::{Deserialize, Serialize};

use crate::probability::Probability;

/// A width is written with two significant digits, in at most this many decimals.
const MAX_DECIMALS: u32 = 60;

/// A probability between two limits; an exact one where they are equal.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Interval {
    /// The probability is at least this.
    pub low: Probability,
    /// The probability is at most this.
    pub high: Probability,
}

impl Interval {
    /// A probability that is known.
    pub fn certain(probability: Probability) -> Self {
        Self { low: probability.clone(), high: probability }
    }

    /// The probability, where it is known.
    pub fn exact(&self) -> Option<&Probability> {
        (self.low == self.high).then_some(&self.low)
    }

    /// Returns whether a probability lies between the limits.
    pub fn contains(&self, probability: &Probability) -> bool {
        (&self.low..=&self.high).contains(&probability)
    }

    /// The distance between the limits.
    pub fn width(&self) -> Probability {
        &self.high - &self.low
    }

    /// Both limits as machine numbers, for drawing.
    pub fn to_f64(&self) -> (f64, f64) {
        let number = |limit: &Probability| limit.to_f64().unwrap_or(0.0);
        (number(&self.low), number(&self.high))
    }

    /// Both limits as decimals, rounded away from each other, with as many digits as two digits of the width need.
    pub fn decimals(&self) -> (String, String) {
        self.written(1, MAX_DECIMALS)
    }

    /// The same in percent, with at most this many decimals.
    pub fn percents(&self, most_decimals: u32) -> (String, String) {
        self.written(100, most_decimals)
    }

    fn written(&self, whole: u32, most_decimals: u32) -> (String, String) {
        let width = self.width() * BigInt::from(whole);
        let (mut decimals, mut scale) = (0, BigInt::one());
        while decimals < most_decimals && &width * &scale < BigRational::from_integer(10.into()) {
            decimals += 1;
            scale *= 10;
        }
        let in_units = |limit: &Probability| limit * (&scale * whole);
        let low = in_units(&self.low).floor().to_integer();
        let high = in_units(&self.high).ceil().to_integer();
        (decimal(&low, &scale, decimals), decimal(&high, &scale, decimals))
    }
}

fn decimal(number: &BigInt, scale: &BigInt, decimals: u32) -> String {
    let (whole, part) = number.div_rem(scale);
    let part = format!("{part:0>width$}", width = decimals as usize);
    let part = part.trim_end_matches('0');
    if decimals == 0 || part.is_empty() { whole.to_string() } else { format!("{whole}.{part}") }
}

impl fmt::Display for Interval {
    /// `96059601/96668224`, or `0.6381 to 0.6385` where the probability is not known exactly.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(probability) = self.exact() {
            return probability.fmt(formatter);
        }
        let (low, high) = self.decimals();
        write!(formatter, "{low} to {high}")
    }
}

/// The probability that several independent things hold, in the measure that is the product of theirs.
///
/// Each is given by the low limit of its probability and by the part of its measure that was kept. What was dropped of
/// the product is what is left of one beside the product of the kept parts.
pub(crate) fn product<'each>(
    each: impl Iterator<Item = (&'each Probability, &'each Probability)>,
) -> Interval {
    let (low, kept) = each.fold((Probability::one(), Probability::one()), |(low, all), (one, kept)| {
        (if one.is_one() { low } else { low * one }, if kept.is_one() { all } else { all * kept })
    });
    let dropped = Probability::one() - kept;
    let high = if dropped.is_zero() { low.clone() } else { (&low + dropped).min(Probability::one()) };
    Interval { low, high }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ratio(numerator: i64, denominator: i64) -> Probability {
        Probability::new(numerator.into(), denominator.into())
    }

    #[test]
    fn an_interval_has_no_more_digits_than_its_width() {
        let interval = Interval { low: ratio(638_123, 1_000_000), high: ratio(638_456, 1_000_000) };
        assert_eq!(interval.to_string(), "0.63812 to 0.63846");
        assert!(interval.contains(&ratio(6383, 10_000)) && !interval.contains(&ratio(639, 1000)));
        let wide = Interval { low: ratio(1, 3), high: Probability::one() };
        assert_eq!(wide.decimals(), ("0.33".to_owned(), "1".to_owned()));
        assert_eq!(wide.percents(1), ("33".to_owned(), "100".to_owned()));
        assert_eq!(interval.percents(2), ("63.81".to_owned(), "63.85".to_owned()));
        assert_eq!(Interval::certain(ratio(2, 4)).to_string(), "1/2");
    }

    #[test]
    fn what_is_dropped_of_a_product_is_what_its_parts_do_not_keep() {
        let (low, kept) = (ratio(1, 2), ratio(9, 10));
        let both = product([(&low, &kept), (&low, &kept)].into_iter());
        assert_eq!(both, Interval { low: ratio(1, 4), high: ratio(1, 4) + ratio(19, 100) });
    }
}
