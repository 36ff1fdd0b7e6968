//! Exact times in JSON: a number where a decimal is exact, otherwise a string `"p/q"`. Both are read.

use rmpl::Rational;
use serde::{Deserialize as _, Deserializer, Serializer, de::Error as _};

/// Writes a time.
pub fn serialize<S: Serializer>(time: &Rational, serializer: S) -> Result<S::Ok, S::Error> {
    let value = tpn::number::time_to_json(*time);
    serde::Serialize::serialize(&value, serializer)
}

/// Reads a time.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Rational, D::Error> {
    let value = serde_json::Value::deserialize(deserializer)?;
    tpn::number::time_from_json(&value).ok_or_else(|| D::Error::custom(format!("{value} is no exact time")))
}
