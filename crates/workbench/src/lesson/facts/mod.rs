//! What lessons can know of the live state, by name.
//!
//! Each fact says what it means in a sentence; `docs/lessons.md` lists them, which a test holds it to.

mod path;
mod plan;
mod program;
mod search;

use exact::{Rational, Time};

use super::expression::Value;
use crate::state::AppState;

/// Something that is known of the state.
pub struct Fact {
    pub name: &'static str,
    pub of: Of,
    /// What it is, in a sentence without its full stop.
    pub meaning: &'static str,
    /// What it is now, of what stands in its parentheses; nothing while that is not known or does not exist.
    pub value: fn(&AppState, &str) -> Option<Value>,
}

/// What a fact is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The state as a whole.
    Nothing,
    /// Something that stands in parentheses.
    Something(&'static str),
    /// The state as a whole, or something in parentheses.
    Maybe(&'static str),
}

impl std::fmt::Debug for Fact {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str(self.name)
    }
}

impl PartialEq for Fact {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

/// Every fact that a question can ask for.
pub fn all() -> impl Iterator<Item = &'static Fact> {
    [plan::FACTS, search::FACTS, path::FACTS, program::FACTS].into_iter().flatten()
}

/// The fact of this name.
pub fn by_name(name: &str) -> Option<&'static Fact> {
    all().find(|fact| fact.name == name)
}

const fn fact(
    name: &'static str,
    of: Of,
    meaning: &'static str,
    value: fn(&AppState, &str) -> Option<Value>,
) -> Fact {
    Fact { name, of, meaning, value }
}

fn count(count: usize) -> Option<Value> {
    Some(Value::Number(Rational::from_integer(i64::try_from(count).ok()?)))
}

#[expect(clippy::unnecessary_wraps, reason = "it ends a fact, which may not be known")]
fn time(time: Time) -> Option<Value> {
    Some(Value::Number(time.units()))
}

/// A measured number, to a tenth.
fn measured(number: f64) -> Option<Value> {
    Rational::from_f64_nearest(number, 10).map(Value::Number)
}

#[expect(clippy::unnecessary_wraps, reason = "it ends a fact, which may not be known")]
fn truth(truth: bool) -> Option<Value> {
    Some(Value::Truth(truth))
}

#[expect(clippy::unnecessary_wraps, reason = "it ends a fact, which may not be known")]
fn words(words: impl Into<String>) -> Option<Value> {
    Some(Value::Text(words.into()))
}
