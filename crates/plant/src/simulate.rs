//! A plant that really has a state: it obeys commands, fails by chance or on demand, and shows observations.

use std::collections::BTreeMap;
use std::sync::Arc;

use num_bigint::BigUint;
use num_integer::Integer as _;
use num_traits::{ToPrimitive as _, Zero as _};

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::island::Island;
use crate::likelihood::combinations;
use crate::model::{Commands, ComponentId, Model, Observation, VariableId};
use crate::successor::{EstimateError, distribution, nominal};
use crate::value_set::ValueSet;

/// Random numbers from a seed, the same on every machine (`SplitMix64`, Steele, Lea and Flood 2014).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Random {
    state: u64,
}

/// By how much the state of [`Random`] grows with each draw.
const INCREMENT: u64 = 0x9e37_79b9_7f4a_7c15;

impl Random {
    /// Starts from a seed.
    pub const fn new(seed: u64) -> Self {
        Self { state: seed }
    }

    /// Starts from a seed, `count` draws later.
    pub const fn skipped(seed: u64, count: u64) -> Self {
        Self { state: seed.wrapping_add(INCREMENT.wrapping_mul(count)) }
    }

    /// The next 64 random bits.
    pub const fn next_bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(INCREMENT);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// A number below `bound`, all equally likely; 0 if `bound` is 0.
    pub const fn below(&mut self, bound: u64) -> u64 {
        if bound == 0 {
            return 0;
        }
        // Numbers from the incomplete last range of `bound` numbers are thrown away.
        let last = u64::MAX - u64::MAX % bound;
        loop {
            let bits = self.next_bits();
            if bits < last {
                return bits % bound;
            }
        }
    }

    /// Draws one of some values by their weights, which may have any number of digits. A single possible value takes no draw.
    fn weighted_exactly(&mut self, weights: &[(u8, BigUint)]) -> u8 {
        let divisor = weights.iter().fold(BigUint::zero(), |divisor, (_, weight)| divisor.gcd(weight));
        let possible = weights.iter().filter(|(_, weight)| !weight.is_zero());
        let possible: Vec<(u8, BigUint)> =
            possible.map(|(value, weight)| (*value, weight / &divisor)).collect();
        let total: BigUint = possible.iter().map(|(_, weight)| weight).sum();
        let mut left = if possible.len() > 1 { self.below_exactly(&total) } else { BigUint::zero() };
        for (value, weight) in &possible {
            if left < *weight {
                return *value;
            }
            left -= weight;
        }
        possible.first().map_or(0, |(value, _)| *value)
    }

    /// A number below `bound`, all equally likely; both may have any number of digits.
    fn below_exactly(&mut self, bound: &BigUint) -> BigUint {
        if let Some(bound) = bound.to_u64() {
            return self.below(bound).into();
        }
        let bits = bound.bits();
        loop {
            let words = bits.div_ceil(64);
            let drawn = (0..words).fold(BigUint::zero(), |drawn, _| (drawn << 64) + self.next_bits());
            let drawn = drawn >> (64 * words - bits);
            if drawn < *bound {
                return drawn;
            }
        }
    }

    /// One of some modes, each with its weight of `total`. A mode that is alone takes no draw.
    pub(crate) fn weighted(&mut self, weights: &[(u8, u64)], total: u64) -> u8 {
        let mut left = if weights.len() > 1 { self.below(total) } else { 0 };
        for &(mode, weight) in weights {
            if left < weight {
                return mode;
            }
            left -= weight;
        }
        weights.first().map_or(0, |(mode, _)| *mode)
    }
}

/// The simulated plant.
#[derive(Clone, Debug)]
pub struct SimulatedPlant {
    model: Arc<Model>,
    state: State,
}

impl SimulatedPlant {
    /// Starts in a state, or in the model's initial one.
    pub fn new(model: &Arc<Model>, state: Option<State>) -> Self {
        Self { model: Arc::clone(model), state: state.unwrap_or_else(|| model.initial_state()) }
    }

    /// The true state.
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Takes a step without chance: components go to their nominal targets, those in `injected` to the given modes.
    pub fn step(
        &mut self,
        commands: &Commands,
        injected: &BTreeMap<ComponentId, u8>,
    ) -> Result<(), EstimateError> {
        let next = nominal(&self.model, &self.state, commands)?;
        self.enter(next, injected)
    }

    /// Takes a step in which every component may fail with its probability.
    ///
    /// States whose mode constraints contradict each other cannot occur; the draw is repeated until it gives another.
    pub fn step_with_chance(
        &mut self,
        commands: &Commands,
        injected: &BTreeMap<ComponentId, u8>,
        random: &mut Random,
    ) -> Result<(), EstimateError> {
        let choices = self
            .model
            .component_ids()
            .map(|component| distribution(&self.model, component, &self.state, commands))
            .collect::<Result<Vec<_>, _>>()?;
        for _ in 0..100 {
            let drawn =
                choices.iter().map(|(weights, denominator)| random.weighted(weights, *denominator)).collect();
            if self.enter(State(drawn), injected).is_ok() {
                return Ok(());
            }
        }
        self.step(commands, injected)
    }

    /// Enters a state, whatever the commands are.
    pub fn enter_state(&mut self, state: State) -> Result<(), EstimateError> {
        self.enter(state, &BTreeMap::new())
    }

    fn enter(&mut self, mut next: State, injected: &BTreeMap<ComponentId, u8>) -> Result<(), EstimateError> {
        for (&component, &mode) in injected {
            next.set_mode(component, mode);
        }
        let mut free = Domains::observed(&self.model, &Observation::default());
        for island in &self.model.islands {
            if let Err(places) = Assumed::all(&self.model, island, &next.0).check(&mut free) {
                let responsible = island
                    .components
                    .iter()
                    .enumerate()
                    .filter(|(place, _)| places >> (place % 128) & 1 == 1);
                let names: Vec<String> = responsible
                    .filter_map(|(_, id)| {
                        Some(format!(
                            "{}={}",
                            self.model.component(*id)?.name,
                            self.model.mode_name(*id, next.mode(*id))
                        ))
                    })
                    .collect();
                return Err(EstimateError::Impossible(names.join(", ")));
            }
        }
        self.state = next;
        Ok(())
    }

    /// Returns what the plant shows without chance: where the modes leave a variable open, its `SHOWS` value if that is
    /// possible.
    pub fn observation(&self) -> Observation {
        observation_of(&self.model, &self.state)
    }

    /// Draws what the plant shows: the values that its modes and `SHOWS` leave open, and then errors.
    pub fn observation_with_chance(&self, random: &mut Random) -> Observation {
        let mut observation = Observation::default();
        for island in &self.model.islands {
            observation.0.extend(true_values(&self.model, island, &self.state, random));
        }
        for (id, value) in &mut observation.0 {
            let Some(data) = self.model.variables.get(id.0 as usize) else { continue };
            if let Some((part, whole)) = data.error
                && random.below(whole) < part
            {
                let other = random.below(data.values.len() as u64 - 1) as u8;
                *value = other + u8::from(other >= *value);
            }
        }
        observation
    }
}

/// Returns whether some values satisfy what is open; all consequences were drawn.
fn is_completable(assumed: &Assumed<'_>, domains: &mut Domains) -> bool {
    let point = domains.point();
    let result = assumed.search(domains);
    domains.return_to(&point);
    result.is_ok()
}

/// The observable variables of an island.
fn observed_of<'model>(
    model: &'model Model,
    island: &'model Island,
) -> impl Iterator<Item = VariableId> + use<'model> {
    let is_observable =
        |id: &VariableId| model.variables.get(id.0 as usize).is_some_and(|data| data.observable);
    island.variables.iter().copied().filter(is_observable)
}

/// Gives the variables of an island that have a `SHOWS` value this value, in the order of the text, where that is possible.
/// The consequences of the modes were drawn already.
fn show(model: &Model, island: &Island, assumed: &Assumed<'_>, domains: &mut Domains) {
    for id in observed_of(model, island) {
        let Some(shows) = model.variables.get(id.0 as usize).and_then(|data| data.shows) else { continue };
        let point = domains.point();
        let restricted = assumed.restrict([(model.variable_symbol(id), ValueSet::one(shows))], domains);
        if !restricted.is_ok_and(|is_true| is_true || is_completable(assumed, domains)) {
            domains.return_to(&point);
        }
    }
}

/// The combinations of values of an island's observable variables that are possible in a state, in the order of the values:
/// what `SHOWS` decides is the same in all of them. `None` if there are more than `most`.
pub(crate) fn shown_values(
    model: &Model,
    island: &Island,
    state: &State,
    most: usize,
) -> Option<Vec<Vec<(VariableId, u8)>>> {
    let assumed = Assumed::all(model, island, &state.0);
    let mut domains = Domains::observed(model, &Observation::default());
    if assumed.propagate(&mut domains).is_err() {
        return Some(vec![Vec::new()]);
    }
    show(model, island, &assumed, &mut domains);
    let mut found = vec![(Vec::new(), domains)];
    for variable in observed_of(model, island) {
        let symbol = model.variable_symbol(variable) as usize;
        let mut next = Vec::new();
        for (chosen, domains) in &found {
            for value in domains.sets.get(symbol).copied().unwrap_or_default().values() {
                let mut trial = domains.clone();
                trial.sets[symbol] = ValueSet::one(value);
                if assumed.settle_all(&mut trial).is_ok() && assumed.check(&mut trial).is_ok() {
                    let mut chosen: Vec<(VariableId, u8)> = chosen.clone();
                    chosen.push((variable, value));
                    next.push((chosen, trial));
                }
            }
            if next.len() > most {
                return None;
            }
        }
        found = next;
    }
    Some(found.into_iter().map(|(chosen, _)| chosen).collect())
}

/// True values of the observable variables of an island: all combinations that the modes allow are equally likely.
fn true_values(model: &Model, island: &Island, state: &State, random: &mut Random) -> Vec<(VariableId, u8)> {
    let mut domains = Domains::observed(model, &Observation::default());
    let assumed = Assumed::all(model, island, &state.0);
    if assumed.propagate(&mut domains).is_err() {
        return Vec::new();
    }
    show(model, island, &assumed, &mut domains);
    let observed: Vec<VariableId> = observed_of(model, island).collect();
    let symbols: Vec<u32> = observed.iter().map(|id| model.variable_symbol(*id)).collect();
    let mut values_drawn = Vec::with_capacity(observed.len());
    for (at, (id, &symbol)) in observed.iter().zip(&symbols).enumerate() {
        let set = domains.sets.get(symbol as usize).copied().unwrap_or_default();
        let value = if let Some(value) = set.only() {
            value
        } else {
            let each = set.values().map(|value| {
                let point = domains.point();
                let is_possible = assumed.restrict([(symbol, ValueSet::one(value))], &mut domains).is_ok();
                let weight = if is_possible {
                    combinations(&assumed, &mut domains, &symbols[at + 1..])
                } else {
                    BigUint::zero()
                };
                domains.return_to(&point);
                (value, weight)
            });
            let each: Vec<(u8, BigUint)> = each.collect();
            random.weighted_exactly(&each)
        };
        if assumed.restrict([(symbol, ValueSet::one(value))], &mut domains).is_err() {
            return values_drawn;
        }
        values_drawn.push((*id, value));
    }
    values_drawn
}

/// Returns what a plant in `state` shows.
pub fn observation_of(model: &Model, state: &State) -> Observation {
    let mut domains = Domains::observed(model, &Observation::default());
    let mut observation = Observation::default();
    for island in &model.islands {
        let assumed = Assumed::all(model, island, &state.0);
        if assumed.propagate(&mut domains).is_err() {
            continue;
        }
        show(model, island, &assumed, &mut domains);
        for variable in observed_of(model, island) {
            let symbol = model.variable_symbol(variable) as usize;
            for value in domains.sets.get(symbol).copied().unwrap_or_default().values() {
                let mut trial = domains.clone();
                trial.sets[symbol] = ValueSet::one(value);
                let settled = assumed.settle_all(&mut trial);
                if settled.is_ok() && assumed.check(&mut trial).is_ok() {
                    domains = trial;
                    observation.0.insert(variable, value);
                    break;
                }
            }
        }
    }
    observation
}
