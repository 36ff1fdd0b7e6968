//! Exact numbers as data. In documents (DESIGN 4.2): a number where a decimal is exact, otherwise `"p/q"`; infinity is
//! `"inf"`. In binary encodings: numerator and denominator.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};
use serde::ser::{Serialize, Serializer};

use crate::{Bound, Rational, Time};

impl Serialize for Rational {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if !serializer.is_human_readable() {
            return (self.numerator(), self.denominator()).serialize(serializer);
        }
        if self.is_integer() {
            return serializer.serialize_i64(self.numerator());
        }
        // A float is written by the fewest digits that tell it from others: they must be the decimal's.
        let float = self.decimal().and_then(|decimal| {
            let float = decimal.parse::<f64>().ok()?;
            (float.to_string() == decimal).then_some(float)
        });
        match float {
            Some(float) => serializer.serialize_f64(float),
            None => serializer.collect_str(&format_args!("{}/{}", self.numerator(), self.denominator())),
        }
    }
}

impl<'de> Deserialize<'de> for Rational {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if !deserializer.is_human_readable() {
            let (numerator, denominator) = <(i64, i64)>::deserialize(deserializer)?;
            return Self::new(numerator, denominator)
                .filter(|it| it.denominator() == denominator)
                .ok_or_else(|| D::Error::custom("a fraction that is not in lowest terms"));
        }
        match deserializer.deserialize_any(Exact)? {
            Bound::Finite(time) => Ok(time.units()),
            Bound::Infinite => Err(D::Error::custom("expected a finite number")),
        }
    }
}

impl Serialize for Bound {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            _ if !serializer.is_human_readable() => self.finite().serialize(serializer),
            Self::Finite(time) => time.serialize(serializer),
            Self::Infinite => serializer.serialize_str("inf"),
        }
    }
}

impl<'de> Deserialize<'de> for Bound {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(Exact)
        } else {
            Option::<Time>::deserialize(deserializer).map(|time| time.map_or(Self::Infinite, Self::Finite))
        }
    }
}

/// Reads numbers and strings by the rules of [`std::str::FromStr`].
struct Exact;

impl Visitor<'_> for Exact {
    type Value = Bound;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an exact number: 12.5, \"25/2\" or \"inf\"")
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Bound, E> {
        Ok(Bound::Finite(value.into()))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Bound, E> {
        match i64::try_from(value) {
            Ok(value) => self.visit_i64(value),
            Err(_) => self.visit_str(&value.to_string()),
        }
    }

    /// Returns what was written in the document is the shortest decimal that gives this float.
    fn visit_f64<E: Error>(self, value: f64) -> Result<Bound, E> {
        self.visit_str(&value.to_string())
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Bound, E> {
        text.parse().map_err(E::custom)
    }
}
