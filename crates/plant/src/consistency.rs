//! Whether modes, and what is observed, can hold together: propagation over value sets, then search.

use serde::{Deserialize, Serialize};

use crate::formula::{Formula, Truth};
use crate::model::{ComponentId, Model, Observation, VariableId};

/// Components whose mode constraints speak of each other, directly or through others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Island {
    /// Its components in their order.
    pub(crate) components: Vec<ComponentId>,
    /// Its variables in their order.
    pub(crate) variables: Vec<VariableId>,
    /// Per component (by place in `components`) the places of components to look at again when its symbols change.
    pub(crate) neighbours: Vec<Vec<u32>>,
}

/// A set of components of an island, of which bit `b` stands for all places that are `b` modulo 128.
///
/// In islands of more than 128 components it may therefore name more components than are meant, never fewer.
pub(crate) type Places = u128;

pub(crate) const fn place_bit(place: usize) -> Places {
    1 << (place % 128)
}

/// The values that symbols may still have, and which components' modes are to blame.
#[derive(Clone, Debug)]
pub(crate) struct Domains {
    /// Per symbol.
    pub(crate) sets: Vec<u64>,
    reasons: Vec<Places>,
}

impl Domains {
    /// All values for all symbols, except that `observation` is as it is.
    pub(crate) fn observed(model: &Model, observation: &Observation) -> Self {
        let mut domains = Self { sets: model.full.clone(), reasons: vec![0; model.full.len()] };
        for (&variable, &value) in &observation.0 {
            if let Some(set) = domains.sets.get_mut(model.variable_symbol(variable) as usize) {
                *set &= 1_u64.checked_shl(u32::from(value)).unwrap_or(0);
            }
        }
        domains
    }

    fn blame(&self, formula: &Formula, place: usize) -> Places {
        let mut blame = place_bit(place);
        formula.symbols(&mut |symbol| blame |= self.reasons.get(symbol as usize).copied().unwrap_or(0));
        blame
    }
}

/// The assumption that some components of an island are in some modes: `None` where nothing is assumed.
pub(crate) struct Assumed<'model> {
    pub(crate) model: &'model Model,
    pub(crate) island: &'model Island,
    /// By place in the island.
    pub(crate) modes: Vec<Option<u8>>,
}

impl<'model> Assumed<'model> {
    /// All components of the island in the modes of a state.
    pub(crate) fn all(model: &'model Model, island: &'model Island, state: &[u8]) -> Self {
        let modes =
            island.components.iter().map(|component| state.get(component.0 as usize).copied()).collect();
        Self { model, island, modes }
    }

    fn formula(&self, place: usize) -> Option<&'model Formula> {
        let mode = (*self.modes.get(place)?)?;
        Some(&self.model.component(*self.island.components.get(place)?)?.modes.get(mode as usize)?.constraint)
    }

    /// Narrows `domains` to what the assumed modes leave; the error names components that cannot hold together.
    pub(crate) fn propagate(&self, domains: &mut Domains) -> Result<(), Places> {
        for (place, mode) in self.modes.iter().enumerate() {
            let (Some(mode), Some(component)) = (mode, self.island.components.get(place)) else { continue };
            let symbol = Model::mode_symbol(*component) as usize;
            let Some(set) = domains.sets.get_mut(symbol) else { continue };
            *set &= 1_u64.checked_shl(u32::from(*mode)).unwrap_or(0);
            domains.reasons[symbol] |= place_bit(place);
            if *set == 0 {
                return Err(domains.reasons[symbol]);
            }
        }
        self.settle(domains, (0..self.modes.len()).rev().collect())
    }

    fn settle(&self, domains: &mut Domains, mut waiting: Vec<usize>) -> Result<(), Places> {
        let mut queued = vec![false; self.modes.len()];
        for &place in &waiting {
            queued[place] = true;
        }
        while let Some(place) = waiting.pop() {
            queued[place] = false;
            let Some(formula) = self.formula(place) else { continue };
            let blame = domains.blame(formula, place);
            let mut changed = false;
            if !enforce(formula, domains, blame, &mut changed) {
                return Err(blame);
            }
            if changed {
                for &neighbour in self.island.neighbours.get(place).into_iter().flatten() {
                    let neighbour = neighbour as usize;
                    if !queued[neighbour] && self.modes[neighbour].is_some() {
                        queued[neighbour] = true;
                        waiting.push(neighbour);
                    }
                }
            }
        }
        Ok(())
    }

    /// Whether some completion of `domains` satisfies all assumed modes; the error as in [`Self::propagate`].
    ///
    /// Exponential at worst; models whose constraints determine outputs from inputs need no search.
    pub(crate) fn satisfy(&self, domains: &mut Domains) -> Result<(), Places> {
        self.propagate(domains)?;
        self.search(domains)
    }

    fn search(&self, domains: &mut Domains) -> Result<(), Places> {
        let Some((symbol, place)) = self.open_symbol(domains) else { return Ok(()) };
        let set = domains.sets.get(symbol as usize).copied().unwrap_or(0);
        let mut blame = place_bit(place);
        for value in crate::observe::values(set) {
            let mut branch = domains.clone();
            branch.sets[symbol as usize] = 1 << value;
            let waiting = (0..self.modes.len()).rev().collect();
            match self.settle(&mut branch, waiting).and_then(|()| self.search(&mut branch)) {
                Ok(()) => {
                    *domains = branch;
                    return Ok(());
                }
                Err(places) => blame |= places,
            }
        }
        blame |= domains.reasons.get(symbol as usize).copied().unwrap_or(0);
        Err(blame)
    }

    /// A symbol with several values in a constraint that is not yet true whatever happens.
    fn open_symbol(&self, domains: &Domains) -> Option<(u32, usize)> {
        (0..self.modes.len()).find_map(|place| {
            let formula = self.formula(place)?;
            if formula.truth(&domains.sets) != Truth::Open {
                return None;
            }
            let mut found = None;
            formula.symbols(&mut |symbol| {
                let open = domains.sets.get(symbol as usize).is_some_and(|set| set.count_ones() > 1);
                if open && found.is_none() {
                    found = Some(symbol);
                }
            });
            found.map(|symbol| (symbol, place))
        })
    }

    /// Constraints not yet true whatever happens, by place.
    pub(crate) fn open_places(&self, domains: &Domains) -> Vec<(usize, &'model Formula)> {
        (0..self.modes.len())
            .filter_map(|place| Some((place, self.formula(place)?)))
            .filter(|(_, formula)| formula.truth(&domains.sets) == Truth::Open)
            .collect()
    }

    /// Narrows after one symbol was fixed from outside.
    pub(crate) fn settle_all(&self, domains: &mut Domains) -> Result<(), Places> {
        self.settle(domains, (0..self.modes.len()).rev().collect())
    }
}

/// Removes values that `formula` rules out; false when none are left.
fn enforce(formula: &Formula, domains: &mut Domains, blame: Places, changed: &mut bool) -> bool {
    match formula {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => {
            let at = *symbol as usize;
            let Some(domain) = domains.sets.get_mut(at) else { return false };
            let narrowed = *domain & set;
            if narrowed != *domain {
                *domain = narrowed;
                domains.reasons[at] |= blame;
                *changed = true;
            }
            narrowed != 0
        }
        Formula::All(parts) => parts.iter().all(|part| enforce(part, domains, blame, changed)),
        Formula::Any(parts) => {
            let mut possible = None;
            for part in parts {
                match part.truth(&domains.sets) {
                    Truth::True => return true,
                    Truth::False => {}
                    Truth::Open if possible.is_some() => return true,
                    Truth::Open => possible = Some(part),
                }
            }
            possible.is_some_and(|part| enforce(part, domains, blame, changed))
        }
    }
}

/// Cuts the model into islands; called once, when it is compiled.
pub(crate) fn islands(model: &Model) -> Vec<Island> {
    let symbols = model.components.len() + model.variables.len();
    let mut parents: Vec<usize> = (0..symbols).collect();
    let mut touched: Vec<Vec<u32>> = Vec::with_capacity(model.components.len());
    for (at, component) in model.components.iter().enumerate() {
        let mut mine = vec![at as u32];
        for mode in &component.modes {
            mode.constraint.symbols(&mut |symbol| mine.push(symbol));
        }
        mine.sort_unstable();
        mine.dedup();
        mine.retain(|&symbol| (symbol as usize) < symbols);
        for &symbol in &mine {
            let (left, right) = (root(&mut parents, at), root(&mut parents, symbol as usize));
            parents[left.max(right)] = left.min(right);
        }
        touched.push(mine);
    }
    // A variable that no mode speaks of stays with its component.
    for (at, variable) in model.variables.iter().enumerate() {
        let symbol = model.components.len() + at;
        if root(&mut parents, symbol) == symbol {
            let owner = root(&mut parents, variable.component.0 as usize);
            parents[symbol] = owner;
        }
    }
    let mut islands: std::collections::BTreeMap<usize, Island> = std::collections::BTreeMap::new();
    let empty = || Island { components: Vec::new(), variables: Vec::new(), neighbours: Vec::new() };
    for component in model.component_ids() {
        let root = root(&mut parents, component.0 as usize);
        islands.entry(root).or_insert_with(empty).components.push(component);
    }
    for at in 0..model.variables.len() {
        let root = root(&mut parents, model.components.len() + at);
        islands.entry(root).or_insert_with(empty).variables.push(VariableId(at as u32));
    }
    let mut islands: Vec<Island> = islands.into_values().collect();
    for island in &mut islands {
        let shares = |left: &ComponentId, right: &ComponentId| {
            let right = &touched[right.0 as usize];
            touched[left.0 as usize].iter().any(|symbol| right.binary_search(symbol).is_ok())
        };
        island.neighbours = island
            .components
            .iter()
            .map(|component| {
                let others = island.components.iter().enumerate();
                others.filter(|(_, other)| shares(component, other)).map(|(place, _)| place as u32).collect()
            })
            .collect();
    }
    islands
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
