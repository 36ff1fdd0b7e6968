//! Exact numbers of 64 bits over 64 bits: their invariant, order and checked arithmetic.

use std::cmp::Ordering;

use num_integer::Integer as _;
use num_rational::Ratio;

/// An exact number without a unit: a fraction in lowest terms whose denominator is positive.
///
/// Operations are exact or give `None`; no order of evaluation and no intermediate result makes a difference.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Rational {
    numerator: i64,
    denominator: i64,
}

impl Rational {
    pub const ZERO: Self = Self::from_integer(0);
    pub const ONE: Self = Self::from_integer(1);

    /// A whole number.
    pub const fn from_integer(integer: i64) -> Self {
        Self { numerator: integer, denominator: 1 }
    }

    /// `numerator / denominator`; `None` if the denominator is zero or the reduced fraction does not fit.
    pub fn new(numerator: i64, denominator: i64) -> Option<Self> {
        Self::from_wide(i128::from(numerator), i128::from(denominator))
    }

    /// As [`Rational::new`], of parts that need not fit by themselves.
    pub fn from_wide(numerator: i128, denominator: i128) -> Option<Self> {
        // The sign moves to the numerator, and the least integer has no opposite.
        if denominator == 0 || numerator == i128::MIN || denominator == i128::MIN {
            return None;
        }
        // Few fractions are large, and divisions of 64 bits are faster.
        if let (Ok(numerator), Ok(denominator @ 1..)) = (i64::try_from(numerator), i64::try_from(denominator))
        {
            let (numerator, denominator) = Ratio::new(numerator, denominator).into_raw();
            return Some(Self { numerator, denominator });
        }
        let (numerator, denominator) = Ratio::new(numerator, denominator).into_raw();
        Some(Self {
            numerator: i64::try_from(numerator).ok()?,
            denominator: i64::try_from(denominator).ok()?,
        })
    }

    /// The numerator in lowest terms, with the sign.
    pub const fn numerator(self) -> i64 {
        self.numerator
    }

    /// The denominator in lowest terms: at least 1.
    pub const fn denominator(self) -> i64 {
        self.denominator
    }

    /// Numerator and denominator with room for products and sums of products.
    pub(crate) fn wide(self) -> (i128, i128) {
        (i128::from(self.numerator), i128::from(self.denominator))
    }

    /// Returns whether it is nought.
    pub const fn is_zero(self) -> bool {
        self.numerator == 0
    }

    /// Returns whether it is below nought.
    pub const fn is_negative(self) -> bool {
        self.numerator < 0
    }

    /// Returns whether it is above nought.
    pub const fn is_positive(self) -> bool {
        self.numerator > 0
    }

    /// Returns whether it is a whole number.
    pub const fn is_integer(self) -> bool {
        self.denominator == 1
    }

    /// The greatest whole number that is not above it.
    pub const fn floor(self) -> i64 {
        self.numerator.div_euclid(self.denominator)
    }

    /// Returns how many `1 / parts` it has, rounded down; `None` if that many do not fit.
    pub fn integer_parts(self, parts: u32) -> Option<i64> {
        let (numerator, denominator) = self.wide();
        i64::try_from((numerator * i128::from(parts)).div_euclid(denominator)).ok()
    }

    /// The sum, or `None` if it overflows.
    pub fn checked_add(self, other: Self) -> Option<Self> {
        if self.denominator == 1 && other.denominator == 1 {
            return self.numerator.checked_add(other.numerator).map(Self::from_integer);
        }
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        Self::from_wide(a * d + c * b, b * d)
    }

    /// The difference.
    pub fn checked_sub(self, other: Self) -> Option<Self> {
        if self.denominator == 1 && other.denominator == 1 {
            return self.numerator.checked_sub(other.numerator).map(Self::from_integer);
        }
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        Self::from_wide(a * d - c * b, b * d)
    }

    /// The product, or `None` if it overflows.
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        Self::from_wide(a * c, b * d)
    }

    /// The quotient; `None` also if `other` is nought.
    pub fn checked_div(self, other: Self) -> Option<Self> {
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        Self::from_wide(a * d, b * c)
    }

    /// The same with the other sign.
    pub fn checked_neg(self) -> Option<Self> {
        Some(Self { numerator: self.numerator.checked_neg()?, denominator: self.denominator })
    }

    /// The greatest number of which both are whole multiples; `None` if it does not fit.
    pub fn common_part(self, other: Self) -> Option<Self> {
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        Self::from_wide((a * d).gcd(&(c * b)), b * d)
    }

    /// The nearest float if numerator and denominator have at most 53 bits, otherwise one within two units in the last
    /// place: each of the two is rounded to nearest, and so is their quotient. The same on every machine.
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// The least multiple of `1 / parts` that is not below `value · parts` in floats; `None` if that is not finite or
    /// beyond 2⁵³ parts, where floats no longer count, or if `parts` is zero.
    pub fn from_f64_up(value: f64, parts: u32) -> Option<Self> {
        Self::from_parts((value * f64::from(parts)).ceil(), parts)
    }

    /// The multiple of `1 / parts` nearest to `value · parts` in floats, halves away from nought; `None` as for
    /// [`Rational::from_f64_up`].
    pub fn from_f64_nearest(value: f64, parts: u32) -> Option<Self> {
        Self::from_parts((value * f64::from(parts)).round(), parts)
    }

    fn from_parts(count: f64, parts: u32) -> Option<Self> {
        const MAX_COUNTED: f64 = 9_007_199_254_740_992.0;
        if count.abs() <= MAX_COUNTED { Self::new(count as i64, i64::from(parts)) } else { None }
    }
}

impl Default for Rational {
    fn default() -> Self {
        Self::ZERO
    }
}

impl From<i64> for Rational {
    fn from(integer: i64) -> Self {
        Self::from_integer(integer)
    }
}

impl From<u32> for Rational {
    fn from(integer: u32) -> Self {
        Self::from_integer(i64::from(integer))
    }
}

impl From<i32> for Rational {
    fn from(integer: i32) -> Self {
        Self::from_integer(i64::from(integer))
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.denominator == other.denominator {
            return self.numerator.cmp(&other.numerator);
        }
        let ((a, b), (c, d)) = (self.wide(), other.wide());
        (a * d).cmp(&(c * b))
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
