//! The one reader of exact numbers: program text, documents, and arguments of commands are read by the same rules.

use std::str::FromStr;

use crate::Rational;

/// Why a text is not an exact number.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// It is none at all.
    #[error("`{0}` is not a number: write a decimal such as 12.5, or a fraction such as 25/2")]
    Form(String),
    /// It is one that cannot be kept.
    #[error("`{0}` is too large or too precise to represent exactly")]
    Overflow(String),
}

impl FromStr for Rational {
    type Err = ReadError;

    /// Reads `12`, `-0.5`, `1.5e3` or `2/3`, exactly. White space around it, and around the stroke, is left out.
    fn from_str(text: &str) -> Result<Self, ReadError> {
        let form = || ReadError::Form(text.to_owned());
        let overflow = || ReadError::Overflow(text.to_owned());
        let Some((numerator, denominator)) = text.split_once('/') else {
            return decimal(Signed::split(text.trim())).map_err(|found| match found {
                Problem::Form => form(),
                Problem::Overflow => overflow(),
            });
        };
        let numerator = Signed::split(numerator.trim());
        let denominator = denominator.trim();
        if !is_digits(numerator.magnitude) || !is_digits(denominator) {
            return Err(form());
        }
        let integer = |digits: &str| digits.parse::<i128>().map_err(|_| overflow());
        let (magnitude, denominator) = (integer(numerator.magnitude)?, integer(denominator)?);
        if denominator == 0 {
            return Err(form());
        }
        Self::from_wide(numerator.apply(magnitude), denominator).ok_or_else(overflow)
    }
}

/// Returns whether a text is one of the spellings of infinity that this program and other tools use.
pub(crate) fn is_infinity(text: &str) -> bool {
    let text = text.trim();
    let name = text.strip_prefix('+').unwrap_or(text);
    name == "∞" || name.eq_ignore_ascii_case("inf") || name.eq_ignore_ascii_case("infinity")
}

enum Problem {
    Form,
    Overflow,
}

/// A number's sign and what follows it.
#[derive(Clone, Copy)]
struct Signed<'text> {
    is_negative: bool,
    magnitude: &'text str,
}

impl<'text> Signed<'text> {
    fn split(text: &'text str) -> Self {
        match text.strip_prefix('-') {
            Some(magnitude) => Self { is_negative: true, magnitude },
            None => Self { is_negative: false, magnitude: text.strip_prefix('+').unwrap_or(text) },
        }
    }

    fn apply(self, magnitude: i128) -> i128 {
        if self.is_negative { -magnitude } else { magnitude }
    }
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Digits with a point and an exponent, both of which may be missing.
fn decimal(text: Signed<'_>) -> Result<Rational, Problem> {
    let (mantissa, exponent) = match text.magnitude.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(Signed::split(exponent))),
        None => (text.magnitude, None),
    };
    if exponent.is_some_and(|exponent| !is_digits(exponent.magnitude)) {
        return Err(Problem::Form);
    }
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let is_written = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    if (whole.is_empty() && fraction.is_empty()) || !is_written(whole) || !is_written(fraction) {
        return Err(Problem::Form);
    }
    // Zeros at the end say nothing, however many there are.
    let fraction = fraction.trim_end_matches('0');
    let mut value: i128 = 0;
    for digit in whole.bytes().chain(fraction.bytes()) {
        value = value
            .checked_mul(10)
            .and_then(|value| value.checked_add(i128::from(digit - b'0')))
            .ok_or(Problem::Overflow)?;
    }
    if value == 0 {
        return Ok(Rational::ZERO);
    }
    let shift = match exponent {
        Some(exponent) => {
            let magnitude = exponent.magnitude.parse::<i64>().map_err(|_| Problem::Overflow)?;
            if exponent.is_negative { -magnitude } else { magnitude }
        }
        None => 0,
    };
    let shift = shift - fraction.len() as i64;
    let power = u32::try_from(shift.unsigned_abs()).ok().and_then(|shift| 10_i128.checked_pow(shift));
    let power = power.ok_or(Problem::Overflow)?;
    let value = text.apply(value);
    let (numerator, denominator) =
        if shift < 0 { (Some(value), power) } else { (value.checked_mul(power), 1) };
    numerator.and_then(|numerator| Rational::from_wide(numerator, denominator)).ok_or(Problem::Overflow)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bound, Time};

    #[test]
    fn decimals_fractions_and_exponents_are_read_exactly() {
        for (text, numerator, denominator) in [
            ("409.5", 819, 2),
            ("1000/3", 1000, 3),
            (" -7 / 14 ", -1, 2),
            ("-2", -2, 1),
            ("-0.5", -1, 2),
            ("+3", 3, 1),
            (".5", 1, 2),
            ("5.", 5, 1),
            ("1.50e2", 150, 1),
            ("5e-1", 1, 2),
            ("0.5000000000000000000000000000000000", 1, 2),
            ("0e999999", 0, 1),
            ("9223372036854775807", i64::MAX, 1),
            ("-9223372036854775808", i64::MIN, 1),
        ] {
            assert_eq!(text.parse::<Time>().ok(), Time::new(numerator, denominator), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_from_what_does_not_fit() {
        for text in [
            "", " ", "x", "1/0", "1/-2", "1/", "/2", "--1", ".", "-", "1.2.3", "0x1", "1e", "1e+", "inf",
            "NaN",
        ] {
            assert_eq!(text.parse::<Rational>(), Err(ReadError::Form(text.to_owned())), "{text}");
        }
        for text in [
            "1e40",
            "1e-40",
            "1e99999999999999999999",
            "99999999999999999999",
            "9223372036854775808",
            "1/9223372036854775808",
            "0.00000000000000000001",
        ] {
            assert_eq!(text.parse::<Rational>(), Err(ReadError::Overflow(text.to_owned())), "{text}");
        }
    }

    #[test]
    fn infinity_has_the_spellings_of_other_tools() {
        for text in ["inf", "∞", "Infinity", "infinity", "+Infinity", " inf "] {
            assert_eq!(text.parse::<Bound>(), Ok(Bound::Infinite), "{text}");
        }
        assert!("-inf".parse::<Bound>().is_err());
        assert_eq!("12".parse::<Bound>(), Ok(Bound::Finite(12.into())));
    }
}
