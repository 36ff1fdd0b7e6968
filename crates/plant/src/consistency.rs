//! Whether modes, and what is observed, can hold together: propagation over value sets, then search.

use serde::{Deserialize, Serialize};

use crate::formula::{Formula, Truth};
use crate::model::{ComponentId, Mode, Model, Observation, VariableId};
use crate::table::{Clause, Table};

/// Components whose mode constraints speak of each other, directly or through others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Island {
    /// Its components in their order.
    pub(crate) components: Vec<ComponentId>,
    /// Its variables in their order.
    pub(crate) variables: Vec<VariableId>,
    /// Per component (by place in `components`) the places of components to look at again when its symbols change.
    pub(crate) neighbours: Vec<Vec<u32>>,
    /// By place and mode, the symbols of the mode's constraint.
    pub(crate) symbols: Vec<Vec<Vec<u32>>>,
    /// Whether some constraint asks for the mode of a component.
    pub(crate) speaks_of_modes: bool,
    /// By place and mode, the mode's constraint as a table, where it can be one.
    pub(crate) tables: Vec<Vec<Option<Table>>>,
}

/// A set of components of an island, of which bit `b` stands for all places that are `b` modulo 128.
///
/// In islands of more than 128 components it may therefore name more components than are meant, never fewer.
pub(crate) type Places = u128;

pub(crate) const fn place_bit(place: usize) -> Places {
    1 << (place % 128)
}

/// The values that symbols may still have, and which components' modes are to blame.
///
/// Every narrowing is written down, so that a trial is undone in time proportional to what it did.
#[derive(Clone, Debug)]
pub(crate) struct Domains {
    /// Per symbol.
    pub(crate) sets: Vec<u64>,
    reasons: Vec<Places>,
    /// What was narrowed: the symbol, and its set and reasons before.
    trail: Vec<(u32, u64, Places)>,
    /// Places whose constraints have to be looked at.
    waiting: Vec<u32>,
    /// Per place of the island under work.
    standing: Vec<Standing>,
}

/// Where a place stands while constraints are enforced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    /// It was looked at; what it says may still matter.
    Idle,
    /// It has to be looked at.
    Waiting,
    /// Its constraint holds whatever else happens, or nothing is assumed of it.
    Done,
}

impl Domains {
    /// All values for all symbols, except that `observation` is as it is.
    pub(crate) fn observed(model: &Model, observation: &Observation) -> Self {
        let mut domains = Self {
            sets: model.full.clone(),
            reasons: vec![0; model.full.len()],
            trail: Vec::new(),
            waiting: Vec::new(),
            standing: Vec::new(),
        };
        for (&variable, &value) in &observation.0 {
            if let Some(set) = domains.sets.get_mut(model.variable_symbol(variable) as usize) {
                *set &= 1_u64.checked_shl(u32::from(value)).unwrap_or(0);
            }
        }
        domains
    }

    /// A point to come back to by [`Self::undo`].
    pub(crate) const fn mark(&self) -> usize {
        self.trail.len()
    }

    /// Takes back all narrowings since `mark`.
    pub(crate) fn undo(&mut self, mark: usize) {
        for (symbol, set, reasons) in self.trail.drain(mark..).rev() {
            self.sets[symbol as usize] = set;
            self.reasons[symbol as usize] = reasons;
        }
    }

    /// Leaves a symbol only values of `set`, because of `blame`; false when none are left.
    fn narrow(&mut self, symbol: u32, set: u64, blame: Places, changed: &mut bool) -> bool {
        let at = symbol as usize;
        let Some(&before) = self.sets.get(at) else { return false };
        let narrowed = before & set;
        if narrowed != before {
            self.trail.push((symbol, before, self.reasons[at]));
            self.sets[at] = narrowed;
            self.reasons[at] |= blame;
            *changed = true;
        }
        narrowed != 0
    }

    /// Who is to blame for a symbol's values.
    pub(crate) fn blame_of(&self, symbol: u32) -> Places {
        self.reasons.get(symbol as usize).copied().unwrap_or(0)
    }

    fn blame(&self, symbols: &[u32], place: usize) -> Places {
        let reasons = symbols.iter().filter_map(|symbol| self.reasons.get(*symbol as usize));
        reasons.fold(place_bit(place), |blame, reason| blame | reason)
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

    /// The symbols of the constraint at a place.
    fn symbols(&self, place: usize) -> &'model [u32] {
        let mode = self.modes.get(place).copied().flatten().unwrap_or(0);
        let modes = self.island.symbols.get(place);
        modes.and_then(|modes| modes.get(usize::from(mode))).map_or(&[], Vec::as_slice)
    }

    /// Narrows `domains` to what the assumed modes leave; the error names components that cannot hold together.
    ///
    /// Answers whether the constraints of all assumed modes now hold whatever values are chosen.
    pub(crate) fn propagate(&self, domains: &mut Domains) -> Result<bool, Places> {
        let modes = if self.island.speaks_of_modes { self.modes.as_slice() } else { &[] };
        for (place, mode) in modes.iter().enumerate() {
            let (Some(mode), Some(component)) = (mode, self.island.components.get(place)) else { continue };
            let symbol = Model::mode_symbol(*component);
            let set = 1_u64.checked_shl(u32::from(*mode)).unwrap_or(0);
            if !domains.narrow(symbol, set, place_bit(place), &mut false) {
                return Err(domains.blame(&[symbol], place));
            }
        }
        self.settle(domains)
    }

    /// Enforces all assumed constraints until nothing changes any more.
    fn settle(&self, domains: &mut Domains) -> Result<bool, Places> {
        let count = self.modes.len();
        domains.waiting.clear();
        domains.standing.clear();
        domains.standing.resize(count, Standing::Done);
        for (place, mode) in self.modes.iter().enumerate().rev() {
            if mode.is_some() {
                domains.standing[place] = Standing::Waiting;
                domains.waiting.push(place as u32);
            }
        }
        let mut open = domains.waiting.len();
        while let Some(place) = domains.waiting.pop() {
            let place = place as usize;
            let mut changed = false;
            if self.enforce(place, domains, &mut changed)? {
                domains.standing[place] = Standing::Done;
                open -= 1;
            } else {
                domains.standing[place] = Standing::Idle;
            }
            if changed {
                // Itself included: what it says may have come to hold, or may say more.
                for &neighbour in self.island.neighbours.get(place).into_iter().flatten() {
                    if domains.standing[neighbour as usize] == Standing::Idle {
                        domains.standing[neighbour as usize] = Standing::Waiting;
                        domains.waiting.push(neighbour);
                    }
                }
            }
        }
        Ok(open == 0)
    }

    /// Enforces the constraint at a place; answers whether it now holds whatever is chosen.
    fn enforce(&self, place: usize, domains: &mut Domains, changed: &mut bool) -> Result<bool, Places> {
        let Some(mode) = self.modes.get(place).copied().flatten() else { return Ok(true) };
        let tables = self.island.tables.get(place);
        let Some(Some(table)) = tables.and_then(|tables| tables.get(usize::from(mode))) else {
            return self.enforce_formula(place, domains, changed);
        };
        let mut is_true = true;
        for at in 0..table.clause_count() {
            match table.clause(at, &domains.sets) {
                Clause::True => {}
                Clause::Open => is_true = false,
                Clause::False => return Err(domains.blame(self.symbols(place), place)),
                Clause::Needs(members) => {
                    let blame = domains.blame(self.symbols(place), place);
                    for &(symbol, set) in members {
                        domains.narrow(symbol, set, blame, changed);
                    }
                }
            }
        }
        Ok(is_true)
    }

    /// The same for constraints that are nested deeply.
    fn enforce_formula(
        &self,
        place: usize,
        domains: &mut Domains,
        changed: &mut bool,
    ) -> Result<bool, Places> {
        let Some(formula) = self.formula(place) else { return Ok(true) };
        if formula.truth(&domains.sets) == Truth::True {
            return Ok(true);
        }
        let blame = domains.blame(self.symbols(place), place);
        if enforce(formula, domains, blame, changed) { Ok(false) } else { Err(blame) }
    }

    /// Whether some completion of `domains` satisfies all assumed modes; the error as in [`Self::propagate`].
    ///
    /// Exponential at worst; models whose constraints determine outputs from inputs need no search.
    pub(crate) fn satisfy(&self, domains: &mut Domains) -> Result<(), Places> {
        if self.propagate(domains)? { Ok(()) } else { self.search(domains) }
    }

    /// The same, with `domains` left as they were.
    pub(crate) fn check(&self, domains: &mut Domains) -> Result<(), Places> {
        let mark = domains.mark();
        let result = self.satisfy(domains);
        domains.undo(mark);
        result
    }

    fn search(&self, domains: &mut Domains) -> Result<(), Places> {
        let Some((symbol, place)) = self.open_symbol(domains) else { return Ok(()) };
        let set = domains.sets.get(symbol as usize).copied().unwrap_or(0);
        let mut blame = place_bit(place);
        for value in crate::observe::values(set) {
            let mark = domains.mark();
            domains.narrow(symbol, 1 << value, 0, &mut false);
            match self.settle(domains).and_then(|is_true| if is_true { Ok(()) } else { self.search(domains) })
            {
                Ok(()) => return Ok(()),
                Err(places) => blame |= places,
            }
            domains.undo(mark);
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
        self.settle(domains).map(|_| ())
    }
}

/// Removes values that `formula` rules out; false when none are left.
fn enforce(formula: &Formula, domains: &mut Domains, blame: Places, changed: &mut bool) -> bool {
    match formula {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => domains.narrow(*symbol, *set, blame, changed),
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
    let empty = || Island {
        components: Vec::new(),
        variables: Vec::new(),
        neighbours: Vec::new(),
        symbols: Vec::new(),
        speaks_of_modes: false,
        tables: Vec::new(),
    };
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
        let modes = island.components.iter().filter_map(|component| model.component(*component));
        island.tables = modes
            .clone()
            .map(|component| component.modes.iter().map(|mode| Table::new(&mode.constraint)).collect())
            .collect();
        island.symbols = modes.map(|component| component.modes.iter().map(symbols_of).collect()).collect();
        let mut asked = island.symbols.iter().flatten().flatten();
        island.speaks_of_modes = asked.any(|&symbol| (symbol as usize) < model.components.len());
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

fn symbols_of(mode: &Mode) -> Vec<u32> {
    let mut symbols = Vec::new();
    mode.constraint.symbols(&mut |symbol| symbols.push(symbol));
    symbols.sort_unstable();
    symbols.dedup();
    symbols
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
