//! What is believed of the plant: states with exact probabilities.

use num_bigint::{BigInt, BigUint};
use num_integer::Integer as _;
use num_rational::BigRational;
use num_traits::{One as _, ToPrimitive as _, Zero as _};
use serde::{Deserialize, Serialize};

use crate::model::{ComponentId, Model};
use crate::probability::Probability;

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

/// States with their probabilities, most likely first; equally likely ones in the order of their modes.
///
/// Probabilities are weights over one common total, so that a step needs no fractions.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Belief {
    entries: Vec<(State, BigUint)>,
    total: BigUint,
}

impl Belief {
    /// Certainty of one state.
    pub fn certain(state: State) -> Self {
        Self { entries: vec![(state, BigUint::one())], total: BigUint::one() }
    }

    /// The belief with these relative weights; `None` when all are zero. States must not repeat.
    pub fn from_weights(entries: Vec<(State, BigUint)>) -> Option<Self> {
        Self::heaviest(entries, usize::MAX)
    }

    /// The same with only the `most` most likely states, at least one.
    pub(crate) fn heaviest(mut entries: Vec<(State, BigUint)>, most: usize) -> Option<Self> {
        entries.retain(|(_, weight)| !weight.is_zero());
        entries.sort_by(|left, right| right.1.cmp(&left.1).then_with(|| left.0.cmp(&right.0)));
        entries.truncate(most.max(1));
        // From the lightest up: the divisor is small at once, and long divisions are few.
        let divisor = entries.iter().rev().fold(BigUint::zero(), |divisor, (_, weight)| {
            if divisor.is_one() { divisor } else { common_divisor(divisor, weight) }
        });
        if !divisor.is_one() && !divisor.is_zero() {
            for (_, weight) in &mut entries {
                *weight = &*weight / &divisor;
            }
        }
        let total: BigUint = entries.iter().map(|(_, weight)| weight).sum();
        (!entries.is_empty()).then_some(Self { entries, total })
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

    /// How many states are believed possible.
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
    pub fn states(&self) -> impl Iterator<Item = (&State, Probability)> {
        self.entries.iter().map(|(state, weight)| (state, self.fraction(weight)))
    }

    /// The probability of the most likely state.
    pub fn highest_probability(&self) -> Probability {
        self.fraction(&self.entries[0].1)
    }

    /// The probabilities of a component's modes, by mode.
    pub fn marginal(&self, model: &Model, component: ComponentId) -> Vec<Probability> {
        let modes = model.component(component).map_or(0, |component| component.modes.len());
        let mut weights = vec![BigUint::zero(); modes];
        for (state, weight) in &self.entries {
            if let Some(sum) = weights.get_mut(state.mode(component) as usize) {
                *sum += weight;
            }
        }
        weights.iter().map(|weight| self.fraction(weight)).collect()
    }

    /// The same with only the `most` most likely states.
    pub fn truncated(self, most: usize) -> Self {
        if self.entries.len() <= most {
            return self;
        }
        Self::heaviest(self.entries.clone(), most).unwrap_or(self)
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

    fn fraction(&self, weight: &BigUint) -> Probability {
        BigRational::new(BigInt::from(weight.clone()), BigInt::from(self.total.clone()))
    }
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
