//! Guards: which choices something is part of the plan under, in disjunctive normal form.

use std::collections::{BTreeMap, BTreeSet};

/// The most ways that a guard may name.
pub(super) const MAX_TERMS: usize = 1_000;

/// Choices that are made one way each, by decision variable: the variable's number and the value's.
pub(super) type Term = BTreeMap<u32, u32>;

/// Any of these ways; none is never, and the empty one always.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Guard(BTreeSet<Term>);

/// There are too many ways.
pub(super) struct TooManyTerms;

impl Guard {
    pub(super) fn always() -> Self {
        Self(BTreeSet::from([Term::new()]))
    }

    pub(super) fn never() -> Self {
        Self(BTreeSet::new())
    }

    pub(super) fn equals(variable: u32, value: u32) -> Self {
        Self(BTreeSet::from([Term::from([(variable, value)])]))
    }

    pub(super) fn terms(&self) -> &BTreeSet<Term> {
        &self.0
    }

    pub(super) fn is_always(&self) -> bool {
        self.0.contains(&Term::new())
    }

    pub(super) fn or(mut self, other: &Self) -> Result<Self, TooManyTerms> {
        self.0.extend(other.0.iter().cloned());
        self.checked()
    }

    pub(super) fn and(&self, other: &Self) -> Result<Self, TooManyTerms> {
        if self.0.len().saturating_mul(other.0.len()) > MAX_TERMS {
            return Err(TooManyTerms);
        }
        let pairs = self.0.iter().flat_map(|left| other.0.iter().map(move |right| (left, right)));
        let both = pairs.filter_map(|(left, right)| {
            let agree = left.iter().all(|(variable, value)| right.get(variable).is_none_or(|it| it == value));
            agree.then(|| left.iter().chain(right).map(|(&variable, &value)| (variable, value)).collect())
        });
        Ok(Self(both.collect()))
    }

    /// The same with fewer terms: without those that another one covers, and with one for all values of a variable.
    /// `value_counts` are the numbers of values of the variables.
    pub(super) fn simplified(mut self, value_counts: &[u32]) -> Self {
        while let Some(merged) = self.merged(value_counts) {
            self.0.insert(merged);
            self.absorb();
        }
        self.absorb();
        self
    }

    /// A term that several come to because they differ in all values of one variable.
    fn merged(&self, value_counts: &[u32]) -> Option<Term> {
        for term in &self.0 {
            for &variable in term.keys() {
                let mut other = term.clone();
                let count = value_counts.get(variable as usize).copied().unwrap_or(0);
                let has_all = (0..count).all(|value| {
                    other.insert(variable, value);
                    self.0.contains(&other)
                });
                if has_all {
                    other.remove(&variable);
                    return Some(other);
                }
            }
        }
        None
    }

    fn absorb(&mut self) {
        let is_part = |small: &Term, large: &Term| {
            small.len() < large.len()
                && small.iter().all(|(variable, value)| large.get(variable) == Some(value))
        };
        let all = self.0.clone();
        self.0.retain(|term| !all.iter().any(|other| is_part(other, term)));
    }

    fn checked(self) -> Result<Self, TooManyTerms> {
        if self.0.len() > MAX_TERMS { Err(TooManyTerms) } else { Ok(self) }
    }
}
