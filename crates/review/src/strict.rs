//! JSON without ambiguity: of two members with the same name, programs take the first one or the last one, so a document
//! that has such members could say one thing to people and another thing to this program. It is refused.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

/// Reads JSON.
///
/// # Errors
/// The text is not JSON, or one of its objects has two members with the same name.
pub fn from_str(text: &str) -> Result<Value, serde_json::Error> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let value = Strict.deserialize(&mut reader)?;
    reader.end()?;
    Ok(value)
}

struct Strict;

impl<'de> DeserializeSeed<'de> for Strict {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Number::from_f64(value).map_or(Value::Null, Value::Number))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(item) = items.next_element_seed(Self)? {
            list.push(item);
        }
        Ok(Value::Array(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut object = Map::new();
        while let Some(name) = members.next_key::<String>()? {
            if object.contains_key(&name) {
                return Err(A::Error::custom(format!("duplicate member `{}`", name.escape_debug())));
            }
            let member = members.next_value_seed(Self)?;
            object.insert(name, member);
        }
        Ok(Value::Object(object))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_serde_json_reads() {
        let text = "{\"a\": [1, -2, 2.5e-1, 1e300, 18446744073709551615, true, null, \"\\u00e4\\n\"], \"b\": {\"a\": {}}}";
        let expected: Value = serde_json::from_str(text).expect("JSON");
        assert_eq!(from_str(text).expect("the same"), expected);
        for wrong in ["", "{", "{} {}", "[1,]", "{\"a\": 1, \"a\": }", "nul"] {
            assert!(from_str(wrong).is_err(), "{wrong}");
        }
        assert!(from_str(&"[".repeat(100_000)).is_err(), "as deep as serde_json goes");
    }

    #[test]
    fn two_members_of_one_name_are_refused_by_name() {
        for (text, name) in [
            ("{\"entries\": [], \"entries\": [1]}", "`entries`"),
            ("[{\"a\": {\"role\": 1, \"by\": 2, \"role\": 1}}]", "`role`"),
            ("{\"b\\u0079\": 1, \"by\": 1}", "`by`"),
        ] {
            let why = from_str(text).expect_err(text).to_string();
            assert!(why.contains(name) && why.contains("duplicate"), "{why}");
        }
    }
}
