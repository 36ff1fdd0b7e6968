//! The one printer: exact decimals and fractions, and what people read.

use std::fmt;

use crate::Rational;

impl Rational {
    /// As an exact decimal, if it is one: when its denominator has no prime factors but 2 and 5.
    pub fn decimal(self) -> Option<String> {
        let (numerator, denominator) = self.wide();
        let mut digits = 0;
        let mut scale: i128 = 1;
        while scale % denominator != 0 {
            digits += 1;
            scale = scale.checked_mul(10).filter(|_| digits <= MAX_DECIMALS)?;
        }
        let scaled = numerator.checked_mul(scale / denominator)?;
        Some(fixed_point(scaled, digits))
    }

    /// For people: exact where three decimals are enough, otherwise rounded to the thousandth and marked by `≈`.
    pub fn readable(self) -> String {
        let exact = self.decimal();
        let is_short = |exact: &String| exact.split('.').nth(1).is_none_or(|part| part.len() <= 3);
        if let Some(exact) = exact.filter(is_short) {
            return exact;
        }
        format!("≈ {}", self.nearest(3))
    }

    /// For programs that know no fractions: exact where nine decimals are enough, otherwise the nearest number that has so many.
    pub fn nearest_decimal(self) -> String {
        self.nearest(9)
    }

    /// The nearest number with so many decimals, without zeros at its end.
    fn nearest(self, digits: u8) -> String {
        let (numerator, denominator) = self.wide();
        let scale = 2 * 10_i128.pow(u32::from(digits));
        // To the nearest: half of the last place is added before rounding down.
        let scaled = (scale * numerator + denominator).div_euclid(2 * denominator);
        let text = fixed_point(scaled, usize::from(digits));
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

/// More decimals than this are written as a fraction.
const MAX_DECIMALS: usize = 19;

/// `scaled` divided by 10 to the power of `digits`, with exactly that many decimals.
fn fixed_point(scaled: i128, digits: usize) -> String {
    let sign = if scaled < 0 { "-" } else { "" };
    // At least one digit stands before the point.
    let mut text = format!("{:0width$}", scaled.unsigned_abs(), width = digits + 1);
    if digits > 0 {
        text.insert(text.len() - digits, '.');
    }
    format!("{sign}{text}")
}

impl fmt::Display for Rational {
    /// As a decimal where that is exact, otherwise as `p/q`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.decimal().unwrap_or_else(|| format!("{}/{}", self.numerator(), self.denominator()));
        f.pad(&text)
    }
}

impl fmt::Debug for Rational {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use crate::Time;

    fn readable(numerator: i64, denominator: i64) -> Option<String> {
        Some(Time::new(numerator, denominator)?.readable())
    }

    fn shown(numerator: i64, denominator: i64) -> Option<String> {
        Some(Time::new(numerator, denominator)?.to_string())
    }

    #[test]
    fn people_read_at_most_three_decimals() {
        assert_eq!(readable(819, 2).as_deref(), Some("409.5"));
        assert_eq!(readable(108_289, 7500).as_deref(), Some("≈ 14.439"));
        assert_eq!(readable(-1, 3).as_deref(), Some("≈ -0.333"));
        assert_eq!(readable(13_895_905, 100_000).as_deref(), Some("≈ 138.959"));
        assert_eq!(readable(29_999_999, 10_000_000).as_deref(), Some("≈ 3"));
        assert_eq!(readable(7, 1).as_deref(), Some("7"));
    }

    #[test]
    fn programs_without_fractions_read_the_nearest_decimal() {
        let nearest = |numerator, denominator| Some(Time::new(numerator, denominator)?.nearest_decimal());
        assert_eq!(nearest(1, 3).as_deref(), Some("0.333333333"));
        assert_eq!(nearest(-2, 3).as_deref(), Some("-0.666666667"));
        assert_eq!(nearest(1000, 1).as_deref(), Some("1000"));
        assert_eq!(nearest(1, 1_000_000_000).as_deref(), Some("0.000000001"));
        assert_eq!(nearest(1, 1 << 40).as_deref(), Some("0"));
        assert_eq!(nearest(-1, i64::MAX).as_deref(), Some("0"));
        assert_eq!(nearest(i64::MIN, 1).as_deref(), Some("-9223372036854775808"));
    }

    #[test]
    fn a_time_is_shown_as_an_exact_decimal_or_as_a_fraction() {
        assert_eq!(shown(819, 2).as_deref(), Some("409.5"));
        assert_eq!(shown(-1, 8).as_deref(), Some("-0.125"));
        assert_eq!(shown(405, 1).as_deref(), Some("405"));
        assert_eq!(shown(1000, 3).as_deref(), Some("1000/3"));
        assert_eq!(shown(i64::MIN, 1).as_deref(), Some("-9223372036854775808"));
        assert_eq!(shown(1, 1 << 40).as_deref(), Some("1/1099511627776"));
    }
}
