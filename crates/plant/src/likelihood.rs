//! How likely an observation is in a state: one over the number of observations that the state admits (SPEC 9.1).

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_traits::{One as _, Zero as _};

use crate::consistency::{Assumed, Domains, Island, Places};
use crate::diagnosis::shrink;
use crate::model::{Model, Observation};
use crate::observe::values;

/// How many observations of the observed variables the modes admit; zero if they cannot hold.
///
/// `observed` are the island's observed variables; `free` has all values for all symbols, and is left so. Counting is
/// over the parts that the modes leave undetermined; exponential in the largest of them at worst.
fn admitted(assumed: &Assumed<'_>, observed: &[u32], free: &mut Domains) -> BigUint {
    let mark = free.mark();
    let count = match assumed.propagate(free) {
        Err(_) => BigUint::zero(),
        Ok(true) => product_of_values(observed, free),
        Ok(false) => product_over_parts(assumed, free, observed.to_vec()),
    };
    free.undo(mark);
    count
}

/// In how many ways variables that nothing ties together can be observed.
fn product_of_values(observed: &[u32], domains: &Domains) -> BigUint {
    let mut product = BigUint::one();
    for symbol in observed {
        let values = domains.sets.get(*symbol as usize).map_or(0, |set| set.count_ones());
        if values != 1 {
            product *= values;
        }
    }
    product
}

fn product_over_parts(assumed: &Assumed<'_>, domains: &Domains, mut observed: Vec<u32>) -> BigUint {
    let mut product = BigUint::one();
    for part in parts(assumed, domains) {
        let (inside, outside): (Vec<u32>, Vec<u32>) =
            observed.into_iter().partition(|symbol| part.contains(symbol));
        observed = outside;
        product *= count(assumed, domains, &inside);
        if product.is_zero() {
            return product;
        }
    }
    product * product_of_values(&observed, domains)
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
    /// What modes may be, given what is observed.
    observed: Domains,
    /// What they may be without that.
    free: Domains,
    /// By island, its observed variables.
    symbols: Vec<Vec<u32>>,
    /// By island and the modes of its components.
    known: Vec<BTreeMap<Vec<u8>, BigUint>>,
    /// The modes that were asked for last.
    modes: Vec<u8>,
}

impl<'model> Likelihoods<'model> {
    pub(crate) fn new(model: &'model Model, observation: &Observation) -> Self {
        let observed_of = |island: &Island| {
            let variables = island.variables.iter().filter(|variable| observation.0.contains_key(variable));
            variables.map(|variable| model.variable_symbol(*variable)).collect()
        };
        Self {
            model,
            observed: Domains::observed(model, observation),
            free: Domains::observed(model, &Observation::default()),
            symbols: model.islands.iter().map(observed_of).collect(),
            known: vec![BTreeMap::new(); model.islands.len()],
            modes: Vec::new(),
        }
    }

    /// The number of observations that the island's modes admit, or zero if they do not admit this one.
    pub(crate) fn divisor(&mut self, at: usize, state: &[u8]) -> BigUint {
        let Some(island) = self.model.islands.get(at) else { return BigUint::one() };
        self.modes.clear();
        let modes = island.components.iter().filter_map(|component| state.get(component.0 as usize));
        self.modes.extend(modes);
        if let Some(known) = self.known[at].get(&self.modes) {
            return known.clone();
        }
        let assumed = Assumed::all(self.model, island, state);
        let divisor = self.judge(at, &assumed).unwrap_or_default();
        self.known[at].insert(self.modes.clone(), divisor.clone());
        divisor
    }

    /// How many observations the assumed modes of an island admit; the error names components that cannot be in theirs.
    ///
    /// Where the modes leave no constraint open, what they say without the observation tells whether they admit it.
    fn judge(&mut self, at: usize, assumed: &Assumed<'_>) -> Result<BigUint, Places> {
        let observed = &self.symbols[at];
        let mark = self.free.mark();
        let result = match assumed.propagate(&mut self.free) {
            Err(places) => Err(places),
            Ok(true) => {
                let contradicts = |symbol: &&u32| {
                    let sets =
                        self.free.sets.get(**symbol as usize).zip(self.observed.sets.get(**symbol as usize));
                    sets.is_some_and(|(left, right)| left & right == 0)
                };
                match observed.iter().find(contradicts) {
                    Some(contradicted) => Err(self.free.blame_of(*contradicted)),
                    None => Ok(product_of_values(observed, &self.free)),
                }
            }
            Ok(false) => {
                self.free.undo(mark);
                assumed.check(&mut self.observed)?;
                return Ok(admitted(assumed, observed, &mut self.free));
            }
        };
        self.free.undo(mark);
        result
    }

    /// Why the modes of an island do not admit the observation, if they do not: modes of which none can be left out.
    pub(crate) fn conflict(&mut self, at: usize, state: &[u8]) -> Option<Assumed<'model>> {
        let island = self.model.islands.get(at)?;
        let mut assumed = Assumed::all(self.model, island, state);
        match self.judge(at, &assumed) {
            Ok(divisor) => {
                self.modes.clear();
                let modes = island.components.iter().filter_map(|component| state.get(component.0 as usize));
                self.modes.extend(modes);
                self.known[at].entry(self.modes.clone()).or_insert(divisor);
                None
            }
            Err(places) => {
                shrink(&mut assumed, &mut self.observed, places);
                Some(assumed)
            }
        }
    }
}
