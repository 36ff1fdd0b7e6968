//! How likely an observation is in a state: one over the number of observations that the state admits (SPEC 9.1).

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_traits::{One as _, Zero as _};

use crate::consistency::{Assumed, Domains, Island, Places};
use crate::model::{Model, Observation};
use crate::observe::values;

/// Whether the island's modes in `state` admit the observation; the error names components to blame.
pub(crate) fn admits(model: &Model, island: &Island, state: &[u8], observed: &Domains) -> Result<(), Places> {
    Assumed::all(model, island, state).satisfy(&mut observed.clone())
}

/// How many observations of the observed variables the island's modes in `state` admit; zero if they cannot hold.
///
/// Counting is over the parts that the modes leave undetermined; exponential in the largest of them at worst.
pub(crate) fn admitted(model: &Model, island: &Island, state: &[u8], observation: &Observation) -> BigUint {
    let assumed = Assumed::all(model, island, state);
    let mut domains = Domains::observed(model, &Observation::default());
    if assumed.propagate(&mut domains).is_err() {
        return BigUint::zero();
    }
    let mut observed: Vec<u32> = island
        .variables
        .iter()
        .filter(|variable| observation.0.contains_key(variable))
        .map(|variable| model.variable_symbol(*variable))
        .collect();
    let mut product = BigUint::one();
    for part in parts(&assumed, &domains) {
        let (inside, outside): (Vec<u32>, Vec<u32>) =
            observed.into_iter().partition(|symbol| part.contains(symbol));
        observed = outside;
        product *= count(&assumed, &domains, &inside);
        if product.is_zero() {
            return product;
        }
    }
    for symbol in observed {
        product *= domains.sets.get(symbol as usize).map_or(0, |set| set.count_ones());
    }
    product
}

/// The undetermined symbols of constraints that are still open, joined where they share one.
fn parts(assumed: &Assumed<'_>, domains: &Domains) -> Vec<Vec<u32>> {
    let mut parts: Vec<Vec<u32>> = Vec::new();
    for (_, formula) in assumed.open_places(domains) {
        let mut mine = Vec::new();
        formula.symbols(&mut |symbol| {
            if domains.sets.get(symbol as usize).is_some_and(|set| set.count_ones() > 1) {
                mine.push(symbol);
            }
        });
        let (touching, apart): (Vec<Vec<u32>>, Vec<Vec<u32>>) =
            parts.into_iter().partition(|part| part.iter().any(|symbol| mine.contains(symbol)));
        parts = apart;
        for part in touching {
            mine.extend(part);
        }
        mine.sort_unstable();
        mine.dedup();
        parts.push(mine);
    }
    parts
}

fn count(assumed: &Assumed<'_>, domains: &Domains, observed: &[u32]) -> BigUint {
    let open = observed
        .iter()
        .find(|&&symbol| domains.sets.get(symbol as usize).is_some_and(|set| set.count_ones() > 1));
    let Some(&symbol) = open else {
        return if assumed.satisfy(&mut domains.clone()).is_ok() { BigUint::one() } else { BigUint::zero() };
    };
    let mut sum = BigUint::zero();
    for value in values(domains.sets.get(symbol as usize).copied().unwrap_or(0)) {
        let mut branch = domains.clone();
        branch.sets[symbol as usize] = 1 << value;
        if assumed.settle_all(&mut branch).is_ok() {
            sum += count(assumed, &branch, observed);
        }
    }
    sum
}

/// Likelihoods computed once per island and modes.
pub(crate) struct Likelihoods<'model> {
    model: &'model Model,
    observation: &'model Observation,
    observed: Domains,
    known: BTreeMap<(usize, Vec<u8>), BigUint>,
}

impl<'model> Likelihoods<'model> {
    pub(crate) fn new(model: &'model Model, observation: &'model Observation) -> Self {
        Self { model, observation, observed: Domains::observed(model, observation), known: BTreeMap::new() }
    }

    pub(crate) const fn observed(&self) -> &Domains {
        &self.observed
    }

    /// The number of observations that the island's modes admit, or zero if they do not admit this one.
    pub(crate) fn divisor(&mut self, at: usize, state: &[u8]) -> BigUint {
        let Some(island) = self.model.islands.get(at) else { return BigUint::one() };
        let modes: Vec<u8> = island
            .components
            .iter()
            .filter_map(|component| state.get(component.0 as usize).copied())
            .collect();
        if let Some(known) = self.known.get(&(at, modes.clone())) {
            return known.clone();
        }
        let divisor = if admits(self.model, island, state, &self.observed).is_ok() {
            admitted(self.model, island, state, self.observation)
        } else {
            BigUint::zero()
        };
        self.known.insert((at, modes), divisor.clone());
        divisor
    }
}
