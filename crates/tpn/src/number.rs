//! Exact times in JSON (DESIGN 4.2): a JSON number where that is exact in decimal, otherwise `"p/q"`; `"inf"`.

use num_traits::{CheckedAdd as _, CheckedMul as _};
use rmpl::{Bound, Rational, rational};
use serde_json::{Number, Value};

/// `time` as a JSON number if reading the number back gives exactly it, otherwise as the string `"p/q"`.
pub fn time_to_json(time: Rational) -> Value {
    if time.is_integer() {
        return Value::from(*time.numer());
    }
    let as_number = rational::decimal(time).and_then(|decimal| {
        let number = Number::from_f64(decimal.parse().ok()?)?;
        (number.to_string() == decimal).then_some(number)
    });
    as_number.map_or_else(|| Value::from(format!("{}/{}", time.numer(), time.denom())), Value::Number)
}

/// A bound; infinity is `"inf"`.
pub fn bound_to_json(bound: Bound) -> Value {
    bound.finite().map_or_else(|| Value::from("inf"), time_to_json)
}

/// Reads what [`bound_to_json`] writes, and the spellings of infinity that other tools use. `None` if it is no exact
/// time that fits.
pub fn bound_from_json(value: &Value) -> Option<Bound> {
    match value {
        Value::Number(number) => time_from_text(&number.to_string()).map(Bound::Finite),
        Value::String(text) => match text.as_str() {
            "inf" | "Infinity" | "infinity" | "+Infinity" | "∞" => Some(Bound::Infinite),
            text => time_from_text(text).map(Bound::Finite),
        },
        _ => None,
    }
}

/// Reads a finite time.
pub fn time_from_json(value: &Value) -> Option<Rational> {
    bound_from_json(value)?.finite()
}

/// Reads `12`, `-0.5`, `1.5e3` or `2/3`, exactly.
pub fn time_from_text(text: &str) -> Option<Rational> {
    if let Some((numerator, denominator)) = text.split_once('/') {
        let denominator: i64 = denominator.trim().parse().ok().filter(|&denominator| denominator > 0)?;
        return Some(Rational::new(numerator.trim().parse().ok()?, denominator));
    }
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let (is_negative, whole) = match whole.strip_prefix('-') {
        Some(whole) => (true, whole),
        None => (false, whole.strip_prefix('+').unwrap_or(whole)),
    };
    let all_digits = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    if whole.is_empty() && fraction.is_empty() || !all_digits(whole) || !all_digits(fraction) {
        return None;
    }
    let mut value = Rational::from_integer(0);
    let ten = Rational::from_integer(10);
    for digit in whole.bytes().chain(fraction.bytes()) {
        value = value.checked_mul(&ten)?.checked_add(&Rational::from_integer(i64::from(digit - b'0')))?;
    }
    let shift = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    if value != Rational::from_integer(0) {
        let power = Rational::from_integer(10_i64.checked_pow(shift.unsigned_abs())?);
        value = value.checked_mul(&if shift < 0 { power.recip() } else { power })?;
    }
    Some(if is_negative { -value } else { value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_a_number_only_where_that_is_exact() {
        assert_eq!(time_to_json(Rational::new(819, 2)).to_string(), "409.5");
        assert_eq!(time_to_json(Rational::new(1000, 3)).to_string(), "\"1000/3\"");
        assert_eq!(time_to_json(Rational::new(1, 10)).to_string(), "0.1");
        assert_eq!(bound_to_json(Bound::Infinite).to_string(), "\"inf\"");
        // More digits than a double holds: as a fraction, not rounded.
        let long = Rational::new(12_345_678_901_234_567, 10);
        assert_eq!(time_to_json(long).to_string(), "\"12345678901234567/10\"");
    }

    #[test]
    fn what_is_written_is_read_back_exactly() {
        for (numerator, denominator) in
            [(0, 1), (-7, 2), (819, 2), (1, 3), (i64::MAX, 1), (1, 60_000), (12_345, 8)]
        {
            let time = Rational::new(numerator, denominator);
            assert_eq!(time_from_json(&time_to_json(time)), Some(time));
        }
        assert_eq!(bound_from_json(&Value::from("Infinity")), Some(Bound::Infinite));
        assert_eq!(time_from_text("1.50e2"), Some(Rational::from_integer(150)));
        assert_eq!(time_from_text("5e-1"), Some(Rational::new(1, 2)));
    }

    #[test]
    fn what_is_no_exact_time_is_refused() {
        for text in ["", "x", "1/0", "1/-2", "--1", "1e40", ".", "99999999999999999999", "1.2.3", "0x1"] {
            assert_eq!(time_from_text(text), None, "{text}");
        }
    }
}
