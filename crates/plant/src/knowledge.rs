//! What is known of a plant: whether conditions hold in its states, and how probable they are (SPEC3 17.4).

use std::collections::{BTreeMap, BTreeSet};

use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::factored::FactoredBelief;
use crate::formula::{Formula, Truth};
use crate::group::Group;
use crate::interval::Interval;
use crate::model::{ComponentId, Model, Observation, VariableId};
use crate::probability::Probability;
use crate::value_set::ValueSet;

/// The opposite of a condition is looked at in at most so many alternatives; a condition with more is not entailed.
const MAX_ALTERNATIVES: usize = 4096;
/// Of so many combinations of values it is looked at which are possible; of more all are taken to be.
const MAX_COMBINATIONS: usize = 4096;
/// So much of a condition may be left open by the states of some groups; beyond that, the lightest stay undecided.
const MAX_RESTS: usize = 10_000;

impl Model {
    /// The condition that a component is in a mode.
    pub const fn mode_is(component: ComponentId, mode: u8) -> Formula {
        Formula::Member { symbol: Self::mode_symbol(component), set: ValueSet::one(mode) }
    }

    /// The condition that a variable has a value, by its number.
    pub fn value_is(&self, variable: VariableId, value: u8) -> Formula {
        Formula::Member { symbol: self.variable_symbol(variable), set: ValueSet::one(value) }
    }

    /// The condition that another one does not hold.
    pub fn opposite(&self, condition: Formula) -> Formula {
        condition.negated(&|symbol| self.full.get(symbol as usize).copied().unwrap_or_default())
    }
}

/// A plant in a state, with what it shows.
pub struct Situation<'model> {
    model: &'model Model,
    state: &'model State,
    domains: Domains,
    /// Whether `domains` are narrowed by what the modes say.
    is_propagated: bool,
}

impl<'model> Situation<'model> {
    /// In this state, showing this.
    pub fn new(model: &'model Model, state: &'model State, observation: &Observation) -> Self {
        let mut domains = Domains::observed(model, observation);
        for component in model.component_ids() {
            if let Some(set) = domains.sets.get_mut(component.0 as usize) {
                *set = ValueSet::one(state.mode(component));
            }
        }
        Self { model, state, domains, is_propagated: false }
    }

    /// Returns whether the modes and the observation entail a condition.
    pub fn entails(&mut self, condition: &Formula) -> bool {
        if condition.truth(&self.domains.sets) == Truth::Open {
            self.propagate();
        }
        match condition.truth(&self.domains.sets) {
            Truth::True => true,
            Truth::False => false,
            Truth::Open => is_entailed_by_search(self.model, condition, self.state, &self.domains),
        }
    }

    /// The combinations of values that some symbols may have.
    fn combinations(&mut self, symbols: &[u32]) -> Vec<Vec<u8>> {
        let set =
            |domains: &Domains, symbol: &u32| domains.sets.get(*symbol as usize).copied().unwrap_or_default();
        if symbols.iter().any(|symbol| set(&self.domains, symbol).len() > 1) {
            self.propagate();
        }
        let mut found: Vec<Vec<u8>> = vec![Vec::with_capacity(symbols.len())];
        for symbol in symbols {
            let set = set(&self.domains, symbol);
            found = found
                .iter()
                .flat_map(|before| {
                    set.values().map(move |value| before.iter().copied().chain([value]).collect())
                })
                .collect();
        }
        if (2..=MAX_COMBINATIONS).contains(&found.len()) {
            found.retain(|values| {
                let given: Vec<(u32, ValueSet)> = symbols
                    .iter()
                    .zip(values)
                    .map(|(symbol, value)| (*symbol, ValueSet::one(*value)))
                    .collect();
                is_possible(self.model, self.state, &self.domains, &given)
            });
        }
        found
    }

    fn propagate(&mut self) {
        if !self.is_propagated {
            self.is_propagated = true;
            for island in &self.model.islands {
                // What is believed does not contradict what is observed.
                let _ = Assumed::all(self.model, island, &self.state.0).propagate(&mut self.domains);
            }
        }
    }
}

/// Returns whether there is no way to hold the modes of a state, within some domains, without a condition.
pub(crate) fn is_entailed_by_search(
    model: &Model,
    condition: &Formula,
    state: &State,
    start: &Domains,
) -> bool {
    let Some(alternatives) = model.opposite(condition.clone()).alternatives(MAX_ALTERNATIVES) else {
        return false;
    };
    !alternatives.iter().any(|alternative| is_possible(model, state, start, alternative))
}

/// Returns whether the modes of a state can hold together, within some domains, where symbols have values of these
/// sets.
fn is_possible(model: &Model, state: &State, start: &Domains, given: &[(u32, ValueSet)]) -> bool {
    let mut domains = start.clone();
    for (symbol, set) in given {
        if let Some(domain) = domains.sets.get_mut(*symbol as usize) {
            *domain &= *set;
            if domain.is_empty() {
                return false;
            }
        }
    }
    model.islands.iter().all(|island| Assumed::all(model, island, &state.0).satisfy(&mut domains).is_ok())
}

/// What is believed of a plant, with the observation that was made last.
#[derive(Clone, Copy)]
pub struct Known<'belief> {
    pub groups: &'belief [Group],
    pub belief: &'belief FactoredBelief,
    pub observation: &'belief Observation,
}

impl Known<'_> {
    /// The numbers of the groups that a condition speaks of.
    pub fn groups_of(&self, condition: &Formula) -> Vec<usize> {
        self.symbols_by_group(condition).into_keys().collect()
    }

    /// Returns how probable a condition is: it holds in the states whose modes entail it with the observation.
    ///
    /// Groups that the condition does not speak of make no difference. Linear in the states of the groups it speaks of,
    /// and in what of the condition these states leave open.
    pub fn probability(&self, condition: &Formula) -> Interval {
        let mut rests = BTreeMap::from([(condition.given(&|_| None), BigUint::one())]);
        let (mut kept, mut all) = (BigUint::one(), BigUint::one());
        let mut undecided = BigUint::zero();
        for (at, symbols) in self.symbols_by_group(condition) {
            let Some((group, belief)) = self.groups.get(at).zip(self.belief.beliefs().nth(at)) else {
                continue;
            };
            let combinations = self.combinations(group, belief, &symbols);
            let mut next: BTreeMap<Formula, BigUint> = BTreeMap::new();
            for (rest, weight) in &rests {
                for (combinations, part) in &combinations {
                    let left = rest_of(rest, &symbols, combinations);
                    if left != Formula::Constant(false) {
                        *next.entry(left).or_insert_with(BigUint::zero) += weight * part;
                    }
                }
            }
            rests = next;
            undecided = undecided * belief.total() + lightest(&mut rests);
            kept *= belief.total();
            all *= belief.total() + belief.dropped();
        }
        let holding = rests.remove(&Formula::Constant(true)).unwrap_or_default();
        let most = &holding + undecided + (&all - kept);
        let ratio = |part: BigUint| BigRational::new(BigInt::from(part), BigInt::from(all.clone()));
        let (low, high) = (ratio(holding), ratio(most));
        Interval { low, high: high.min(Probability::one()) }
    }

    /// The most likely state in which some of these conditions do not all hold; `None` if none is kept, or found among the
    /// most likely ones.
    ///
    /// Only the groups that one of the conditions speaks of differ from the most likely state.
    pub fn likeliest_without(&self, model: &Model, conditions: &[Formula]) -> Option<State> {
        let of_one = |condition: &Formula| {
            let mut states = self.belief.states_of(&self.groups_of(condition)).take(MAX_SEARCHED);
            states.find(|(state, _)| !Situation::new(model, state, self.observation).entails(condition))
        };
        let found = conditions.iter().filter_map(of_one);
        found
            .max_by(|left, right| left.1.cmp(&right.1).then_with(|| right.0.cmp(&left.0)))
            .map(|(state, _)| state)
    }

    /// By group, the symbols of a condition in the whole plant and in the group.
    fn symbols_by_group(&self, condition: &Formula) -> BTreeMap<usize, Vec<(u32, u32)>> {
        let mut symbols = BTreeSet::new();
        condition.symbols(&mut |symbol| {
            symbols.insert(symbol);
        });
        let components: usize = self.groups.iter().map(|group| group.components.len()).sum();
        let mut found: BTreeMap<usize, Vec<(u32, u32)>> = BTreeMap::new();
        for symbol in symbols {
            let own = |group: &Group| match (symbol as usize).checked_sub(components) {
                None => group.components.binary_search(&ComponentId(symbol)).ok().map(|at| at as u32),
                Some(variable) => {
                    let at = group.variables.binary_search(&VariableId(variable as u32)).ok()?;
                    Some(group.model.variable_symbol(VariableId(at as u32)))
                }
            };
            let place = self.groups.iter().enumerate().find_map(|(at, group)| Some((at, own(group)?)));
            if let Some((at, own)) = place {
                found.entry(at).or_default().push((symbol, own));
            }
        }
        found
    }

    /// The combinations of values that the states of a group leave some of its symbols, each with the weight of these states.
    fn combinations(
        &self,
        group: &Group,
        belief: &Belief,
        symbols: &[(u32, u32)],
    ) -> BTreeMap<Vec<Vec<u8>>, BigUint> {
        let observation = group.observation(self.observation);
        let own: Vec<u32> = symbols.iter().map(|(_, own)| *own).collect();
        let components = group.components.len();
        let are_modes = own.iter().all(|symbol| (*symbol as usize) < components);
        let mut found: BTreeMap<Vec<Vec<u8>>, BigUint> = BTreeMap::new();
        for (state, weight) in belief.entries() {
            let combinations = if are_modes {
                vec![own.iter().map(|symbol| state.mode(ComponentId(*symbol))).collect()]
            } else {
                Situation::new(&group.model, state, &observation).combinations(&own)
            };
            *found.entry(combinations).or_insert_with(BigUint::zero) += weight;
        }
        found
    }
}

/// A state in which a condition does not hold is searched among at most so many of the most likely ones.
const MAX_SEARCHED: usize = 100_000;

/// Returns what is left of a condition that has to hold with each of some combinations of values.
fn rest_of(condition: &Formula, symbols: &[(u32, u32)], combinations: &[Vec<u8>]) -> Formula {
    let given = |values: &Vec<u8>| {
        condition.given(&|symbol| {
            let at = symbols.iter().position(|(whole, _)| *whole == symbol)?;
            values.get(at).copied()
        })
    };
    match combinations {
        [only] => given(only),
        several => Formula::All(several.iter().map(given).collect()).given(&|_| None),
    }
}

/// Takes out the lightest where there are too many; returns their weight.
fn lightest(rests: &mut BTreeMap<Formula, BigUint>) -> BigUint {
    let excess = rests.len().saturating_sub(MAX_RESTS);
    if excess == 0 {
        return BigUint::zero();
    }
    let mut by_weight: Vec<(BigUint, Formula)> =
        rests.iter().map(|(rest, weight)| (weight.clone(), rest.clone())).collect();
    by_weight.sort_unstable();
    let mut sum = BigUint::zero();
    for (weight, rest) in by_weight.into_iter().take(excess) {
        sum += weight;
        rests.remove(&rest);
    }
    sum
}
