//! A value with the digest of what it was written as.
//!
//! The digest is that of the JSON as it was read, not of what this version of the program makes of it: members that a later
//! version adds are part of it, and what is written again is what was read.

use std::ops::Deref;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::hash::sha256;

/// A value that is not changed any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Sealed<T> {
    value: T,
    raw: Value,
    digest: String,
}

impl<T: Serialize + DeserializeOwned> Sealed<T> {
    /// Seals a value.
    pub fn new(value: T) -> Self {
        let raw = serde_json::to_value(&value).unwrap_or_default();
        let digest = digest(&raw);
        Self { value, raw, digest }
    }

    /// Reads what was sealed. The digest is that of what is there now.
    pub fn read(raw: Value) -> Result<Self, serde_json::Error> {
        let value = T::deserialize(&raw)?;
        let digest = digest(&raw);
        Ok(Self { value, raw, digest })
    }

    /// Returns what is written of it.
    pub fn raw(&self) -> &Value {
        &self.raw
    }

    /// The SHA-256 of what is written of it, in hexadecimal.
    pub fn digest(&self) -> &str {
        &self.digest
    }
}

impl<T> Deref for Sealed<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

/// Changes when the meaning of the hashed bytes does.
const DOMAIN: &str = "enroute-history/1\n";

/// The SHA-256 of a JSON value in one spelling: members in order of their names, no space, whole numbers without a point.
fn digest(value: &Value) -> String {
    let mut text = String::from(DOMAIN);
    spell(value, &mut text);
    sha256(text.as_bytes())
}

/// Whole numbers up to this are the same in all programs that read JSON.
const MAX_WHOLE: f64 = 9_007_199_254_740_992.0;

fn spell(value: &Value, out: &mut String) {
    match value {
        Value::Object(members) => {
            let mut names: Vec<&String> = members.keys().collect();
            names.sort();
            out.push('{');
            for (index, name) in names.into_iter().enumerate() {
                if index > 0 {
                    out.push(',');
                }
                out.push_str(&Value::from(name.as_str()).to_string());
                out.push(':');
                spell(&members[name], out);
            }
            out.push('}');
        }
        Value::Array(items) => {
            out.push('[');
            for (index, item) in items.iter().enumerate() {
                if index > 0 {
                    out.push(',');
                }
                spell(item, out);
            }
            out.push(']');
        }
        Value::Number(number) => match number.as_f64() {
            Some(whole) if number.is_f64() && whole.fract() == 0.0 && whole.abs() <= MAX_WHOLE => {
                out.push_str(&(whole as i64).to_string());
            }
            _ => out.push_str(&number.to_string()),
        },
        Value::Null | Value::Bool(_) | Value::String(_) => out.push_str(&value.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn the_digest_does_not_depend_on_how_the_json_was_spelled() {
        let one: Value =
            serde_json::from_str("{\"b\": [1.0, 0.25, \"\\u00e4\"], \"a\": null}").expect("JSON");
        let other: Value = serde_json::from_str("{\"a\":null,\"b\":[1,2.5e-1,\"ä\"]}").expect("JSON");
        assert_eq!(digest(&one), digest(&other));
        assert_eq!(digest(&one).len(), 64);
        for different in [json!({ "a": 0, "b": [1, 0.25, "ä"] }), json!({ "b": [0.25, 1, "ä"], "a": null })]
        {
            assert_ne!(digest(&one), digest(&different), "{different}");
        }
    }

    #[derive(Serialize, serde::Deserialize)]
    struct Part {
        margin: u32,
    }

    #[test]
    fn what_is_not_understood_is_part_of_the_digest_and_is_written_again() {
        let raw = json!({ "margin": 0, "least": 3 });
        let sealed = Sealed::<Part>::read(raw.clone()).expect("it has what is asked for");
        assert_eq!((sealed.margin, sealed.raw()), (0, &raw));
        assert_ne!(sealed.digest(), Sealed::new(Part { margin: 0 }).digest());
    }
}
