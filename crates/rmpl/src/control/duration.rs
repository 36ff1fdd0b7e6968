//! Durations of the forms in time: a number with a unit, or a plain number of steps (SPEC 8.5).

use std::fmt;

use exact::Rational;
use smol_str::{SmolStr, format_smolstr};

use super::lexer::is_hyphen;
use crate::program::{DurationUnit, TimeUnit};

/// How long something takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Duration {
    amount: Rational,
    /// The unit's word with its seconds; without one the amount counts steps.
    unit: Option<(&'static str, Rational)>,
}

/// Why a text cannot be read as a duration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DurationError {
    /// It is none at all.
    Form,
    /// The unit is none of those that there are.
    Unit,
    /// It is infinite, negative or zero.
    Bounds,
    /// It has more digits than can be calculated with.
    TooLarge,
}

/// The words of units, the shortest first.
pub(super) fn units() -> Vec<&'static str> {
    std::iter::once("ms").chain(DurationUnit::ALL.map(|(name, _)| name)).collect()
}

fn unit_named(word: &str) -> Option<(&'static str, Rational)> {
    if word == "ms" {
        return Some(("ms", Rational::new(1, 1000)?));
    }
    let (name, unit) = DurationUnit::ALL.into_iter().find(|(name, _)| *name == word)?;
    Some((name, unit.in_units(TimeUnit::Second)?))
}

/// Returns whether a word can only be a number or a duration, and no name.
pub(super) fn is_numeral(word: &str) -> bool {
    let first = |c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '/') || is_hyphen(c);
    word.starts_with(first) || word.parse::<exact::Bound>() == Ok(exact::Bound::Infinite)
}

impl Duration {
    /// Reads `5s`, `0.1 min`, `100ms` or `3`.
    pub fn read(text: &str) -> Result<Self, DurationError> {
        let text: String = text.chars().map(|c| if is_hyphen(c) { '-' } else { c }).collect();
        let end = text.find(char::is_alphabetic).unwrap_or(text.len());
        let (number, unit) = (text[..end].trim(), text[end..].trim());
        if text.trim().parse() == Ok(exact::Bound::Infinite) {
            return Err(DurationError::Bounds);
        }
        if number.is_empty() {
            let is_infinite =
                unit.split_whitespace().next().is_some_and(|word| word.parse() == Ok(exact::Bound::Infinite));
            return Err(if is_infinite { DurationError::Bounds } else { DurationError::Form });
        }
        let amount: Rational = number.parse().map_err(|error| match error {
            exact::ReadError::Form(_) => DurationError::Form,
            exact::ReadError::Overflow(_) => DurationError::TooLarge,
        })?;
        let unit = match unit {
            "" => None,
            word => Some(unit_named(word).ok_or(DurationError::Unit)?),
        };
        if amount <= Rational::ZERO {
            return Err(DurationError::Bounds);
        }
        Ok(Self { amount, unit })
    }

    /// As texts write it: `3`, `5 s`.
    pub fn written(self) -> SmolStr {
        let unit = self.unit.map_or(String::new(), |(unit, _)| format!(" {unit}"));
        format_smolstr!("{}{unit}", self.amount)
    }

    /// The seconds that it takes, if it has a unit.
    pub fn seconds(self) -> Option<Rational> {
        let (_, seconds) = self.unit?;
        self.amount.checked_mul(seconds)
    }

    /// The duration that is `factor` times as short; `None` if it cannot be calculated exactly.
    pub fn shortened(self, factor: Rational) -> Option<Self> {
        let amount = self.amount.checked_div(factor)?;
        (amount > Rational::ZERO).then_some(Self { amount, ..self })
    }

    /// Its length in steps, exactly.
    pub fn in_steps(self, step_secs: Rational) -> Option<Rational> {
        match self.unit {
            None => Some(self.amount),
            Some(_) => self.seconds()?.checked_div(step_secs),
        }
    }

    /// The number of steps that it takes: at least 1, since steps that are started count.
    pub fn steps(self, step_secs: Rational) -> Option<u64> {
        let steps = self.in_steps(step_secs)?;
        let (numerator, denominator) = (i128::from(steps.numerator()), i128::from(steps.denominator()));
        u64::try_from((numerator + denominator - 1).div_euclid(denominator)).ok()
    }
}

impl fmt::Display for Duration {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let written = self.written();
        match self.unit {
            Some(_) => f.write_str(&written),
            None if self.amount == Rational::ONE => f.write_str("1 step"),
            None => write!(f, "{written} steps"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_takes_the_steps_that_are_begun_in_it() {
        let tenth = Rational::new(1, 10).expect("a fraction");
        for (text, steps, shown) in [
            ("3", 3, "3 steps"),
            ("2.5", 3, "2.5 steps"),
            ("1", 1, "1 step"),
            ("1s", 10, "1 s"),
            ("250ms", 3, "250 ms"),
            ("0.5min", 300, "0.5 min"),
            ("1/3s", 4, "1/3 s"),
            ("1sol", 887_753, "1 sol"),
        ] {
            let duration = Duration::read(text).expect("a duration");
            assert_eq!(
                (duration.steps(tenth), duration.to_string().as_str()),
                (Some(steps), shown),
                "{text}"
            );
        }
        let half = Duration::read("3").expect("a duration").shortened(Rational::from(2_i64));
        assert_eq!(half.and_then(|half| half.steps(tenth)), Some(2));
    }

    #[test]
    fn what_is_no_duration_says_why() {
        for (text, error) in [
            ("0", DurationError::Bounds),
            ("0s", DurationError::Bounds),
            ("-3", DurationError::Bounds),
            ("\u{2212}3s", DurationError::Bounds),
            ("inf", DurationError::Bounds),
            ("\u{221e}", DurationError::Bounds),
            ("3x", DurationError::Unit),
            ("3 sec", DurationError::Unit),
            ("soon", DurationError::Form),
            ("1..2", DurationError::Form),
            ("99999999999999999999s", DurationError::TooLarge),
        ] {
            assert_eq!(Duration::read(text), Err(error), "{text}");
        }
    }
}
