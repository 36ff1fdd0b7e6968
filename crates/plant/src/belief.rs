//! What is believed of a plant, or of a group of its components: states with their measures, and a bound of what was dropped.

use num_bigint::{BigInt, BigUint};
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, ToPrimitive as _, Zero as _};
use serde::{Deserialize, Serialize};

use crate::interval::Interval;
use crate::model::{ComponentId, Model};
use crate::probability::Probability;

/// Weights longer than [`MAX_BITS`] are cut to this length; what that loses counts as dropped.
const KEPT_BITS: u64 = 2048;
/// How long the total of a belief's weights may be, in bits.
const MAX_BITS: u64 = 8192;

/// The mode of every component.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct State(pub Vec<u8>);

impl State {
    /// The mode of a component.
    pub fn mode(&self, component: ComponentId) -> u8 {
        self.0.get(component.0 as usize).copied().unwrap_or(0)
    }

    /// Sets the mode of a component.
    pub fn set_mode(&mut self, component: ComponentId, mode: u8) {
        if let Some(slot) = self.0.get_mut(component.0 as usize) {
            *slot = mode;
        }
    }
}

/// States with their measures, most likely first; equally likely ones in the order of their modes.
///
/// A state's measure α(x) is the probability that the plant is in it and all observations so far were made, up to a factor
/// that all measures have in common. What was dropped of the measure is known by an upper bound ε (SPEC3 17.1): the
/// probability of states that measure α together lies between α / (total + ε) and (α + ε) / (total + ε).
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Belief {
    entries: Vec<(State, BigUint)>,
    total: BigUint,
    /// An upper bound of the measure that was dropped, ε.
    dropped: BigUint,
}

impl Belief {
    /// Certainty of one state.
    pub fn certain(state: State) -> Self {
        Self { entries: vec![(state, BigUint::one())], total: BigUint::one(), dropped: BigUint::zero() }
    }

    /// Returns whether it is certain of this state.
    pub(crate) fn is_certain_of(&self, state: &State) -> bool {
        self.dropped.is_zero() && matches!(self.entries.as_slice(), [(only, _)] if only == state)
    }

    /// The belief with these relative weights; `None` when all are zero. States must not repeat.
    pub fn from_weights(entries: Vec<(State, BigUint)>) -> Option<Self> {
        Self::measured(entries, BigUint::zero(), usize::MAX)
    }

    /// The belief that keeps the `most` heaviest of these states; the others are dropped, as `dropped` was before.
    ///
    /// `None` if no state has a weight.
    pub(crate) fn measured(
        mut entries: Vec<(State, BigUint)>,
        mut dropped: BigUint,
        most: usize,
    ) -> Option<Self> {
        order(&mut entries);
        let most = most.max(1).min(entries.len());
        for (_, weight) in entries.drain(most..) {
            dropped += weight;
        }
        Self::reduced(entries, dropped)
    }

    /// Takes out what ordered weights have in common.
    fn reduced(mut entries: Vec<(State, BigUint)>, mut dropped: BigUint) -> Option<Self> {
        // From the lightest up: the divisor is small at once, and long divisions are few. What was dropped is divided, too,
        // and must not become more by that.
        let divisor = entries.iter().rev().fold(dropped.clone(), |divisor, (_, weight)| {
            if divisor.is_one() { divisor } else { common_divisor(divisor, weight) }
        });
        if !divisor.is_one() && !divisor.is_zero() {
            for (_, weight) in &mut entries {
                *weight = &*weight / &divisor;
            }
            dropped /= &divisor;
        }
        let mut total: BigUint = entries.iter().map(|(_, weight)| weight).sum();
        let excess = total.bits().saturating_sub(KEPT_BITS);
        if total.bits() > MAX_BITS {
            // Each weight loses less than one.
            dropped = (dropped >> excess) + 1_u32 + entries.len();
            for (_, weight) in &mut entries {
                *weight >>= excess;
            }
            entries.retain(|(_, weight)| !weight.is_zero());
            order(&mut entries);
            total = entries.iter().map(|(_, weight)| weight).sum();
        }
        (!entries.is_empty()).then_some(Self { entries, total, dropped })
    }

    /// The belief with these probabilities, made to sum to one; states that occur twice are joined.
    pub fn from_probabilities(given: impl IntoIterator<Item = (State, Probability)>) -> Option<Self> {
        let mut joined: std::collections::BTreeMap<State, BigRational> = std::collections::BTreeMap::new();
        for (state, probability) in given {
            *joined.entry(state).or_insert_with(BigRational::zero) += probability;
        }
        let denominator = joined.values().fold(BigInt::one(), |common, value| common.lcm(value.denom()));
        let weights = joined.into_iter().map(|(state, value)| {
            let weight = (value * &denominator).to_integer();
            (state, weight.to_biguint().unwrap_or_default())
        });
        Self::from_weights(weights.collect())
    }

    /// Returns how many states are believed possible.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Never: a belief holds at least one state.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The most likely state.
    pub fn most_likely(&self) -> &State {
        &self.entries[0].0
    }

    /// The states with their probabilities, most likely first.
    pub fn states(&self) -> impl Iterator<Item = (&State, Interval)> {
        self.entries.iter().map(|(state, weight)| (state, self.interval(weight)))
    }

    /// The probability of the most likely state.
    pub fn highest_probability(&self) -> Interval {
        self.interval(&self.entries[0].1)
    }

    /// Returns whether nothing was dropped, so that all probabilities are exact.
    pub fn is_exact(&self) -> bool {
        self.dropped.is_zero()
    }

    /// The probabilities of a component's modes, by mode.
    pub fn marginal(&self, model: &Model, component: ComponentId) -> Vec<Interval> {
        self.marginal_of(model.component(component).map_or(0, |component| component.modes.len()), component)
    }

    /// The probabilities of the `modes` modes of a component.
    pub(crate) fn marginal_of(&self, modes: usize, component: ComponentId) -> Vec<Interval> {
        let mut weights = vec![BigUint::zero(); modes];
        for (state, weight) in &self.entries {
            if let Some(sum) = weights.get_mut(state.mode(component) as usize) {
                *sum += weight;
            }
        }
        weights.iter().map(|weight| self.interval(weight)).collect()
    }

    /// The state of a rank, from 0.
    pub(crate) fn state(&self, rank: usize) -> &State {
        &self.entries[rank].0
    }

    /// The weight of the state of a rank, from 0.
    pub(crate) fn weight(&self, rank: usize) -> &BigUint {
        &self.entries[rank].1
    }

    /// Returns whether so little was dropped that more states are not needed: less than a thousandth of the measure,
    /// and less than the most likely state leads the second by.
    pub(crate) fn is_settled(&self) -> bool {
        if self.dropped.is_zero() {
            return true;
        }
        let first = &self.entries[0].1;
        let second = self.entries.get(1).map_or_else(BigUint::zero, |(_, weight)| weight.clone());
        &self.dropped * 1000_u32 < &self.total + &self.dropped && second + &self.dropped < *first
    }

    /// The same states with their measures multiplied, in the same order.
    pub(crate) fn rescaled(&self, factors: &[BigUint]) -> Self {
        let each = self.entries.iter().zip(factors);
        let entries: Vec<(State, BigUint)> =
            each.map(|((state, weight), factor)| (state.clone(), weight * factor)).collect();
        let total = entries.iter().map(|(_, weight)| weight).sum();
        Self { entries, total, dropped: self.dropped.clone() }
    }

    pub(crate) fn entries(&self) -> &[(State, BigUint)] {
        &self.entries
    }

    /// Probabilities as machine numbers, for ordering a search; what is reported is exact.
    pub(crate) fn approximate(&self) -> Vec<f64> {
        let excess = self.total.bits().saturating_sub(1000);
        let total = (&self.total >> excess).to_f64().unwrap_or(1.0);
        self.entries.iter().map(|(_, weight)| (weight >> excess).to_f64().unwrap_or(0.0) / total).collect()
    }

    /// ε, in the unit of the weights.
    pub(crate) const fn dropped(&self) -> &BigUint {
        &self.dropped
    }

    /// The sum of the weights.
    pub(crate) const fn total(&self) -> &BigUint {
        &self.total
    }

    /// Returns what part of the measure was kept, at least.
    pub(crate) fn kept(&self) -> Probability {
        if self.is_exact() { Probability::one() } else { self.fraction(&self.total) }
    }

    /// The probability of states of this weight, at least.
    pub(crate) fn fraction(&self, weight: &BigUint) -> Probability {
        BigRational::new(BigInt::from(weight.clone()), BigInt::from(&self.total + &self.dropped))
    }

    fn interval(&self, weight: &BigUint) -> Interval {
        if self.is_exact() {
            return Interval::certain(self.fraction(weight));
        }
        Interval { low: self.fraction(weight), high: self.fraction(&(weight + &self.dropped)) }
    }
}

/// Most likely first, equally likely ones in the order of their modes, without those that weigh nothing.
fn order(entries: &mut Vec<(State, BigUint)>) {
    entries.retain(|(_, weight)| !weight.is_zero());
    entries.sort_by(|left, right| right.1.cmp(&left.1).then_with(|| left.0.cmp(&right.0)));
}

/// The greatest common divisor. Divides first where one number is much longer than the other.
fn common_divisor(divisor: BigUint, weight: &BigUint) -> BigUint {
    if divisor.is_zero() {
        return weight.clone();
    }
    let rest = weight % &divisor;
    match (divisor.to_u64(), rest.to_u64()) {
        _ if rest.is_zero() => divisor,
        (Some(divisor), Some(rest)) => BigUint::from(divisor.gcd(&rest)),
        _ => divisor.gcd(&rest),
    }
}
