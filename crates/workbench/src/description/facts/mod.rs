//! What the facts of lessons come to: a field of the description, or a function over it.

mod path;
mod plan;
mod program;
mod review;
mod search;

use exact::{Rational, Time};

use super::Description;
use crate::lesson::Value;
use crate::lesson::facts::Known;

/// A fact by its name, and where the description has it.
type Row = (&'static str, fn(&Description<'_>, &str) -> Option<Value>);

impl Known for Description<'_> {
    fn value_of(&self, fact: &str, of: &str) -> Option<Value> {
        let (_, value) = rows().find(|(name, _)| *name == fact)?;
        value(self, of)
    }
}

fn rows() -> impl Iterator<Item = &'static Row> {
    [plan::VALUES, search::VALUES, path::VALUES, program::VALUES, review::VALUES].into_iter().flatten()
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    #[test]
    fn every_fact_comes_to_something_and_nothing_else_does() {
        let known: BTreeSet<&str> = crate::lesson::facts::all().map(|fact| fact.name).collect();
        let computed: BTreeSet<&str> = super::rows().map(|(name, _)| *name).collect();
        assert_eq!((&known, computed.len()), (&computed, super::rows().count()));
    }
}
