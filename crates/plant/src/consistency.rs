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
    /// The symbols of its variables and, where a constraint asks for modes, of its components.
    own_symbols: Vec<u32>,
    /// By place (in `components`) and mode, what the mode says.
    pub(crate) sayings: Vec<Vec<Saying>>,
    /// Whether some constraint asks for the mode of a component.
    pub(crate) speaks_of_modes: bool,
}

/// What a mode says, prepared for propagation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Saying {
    /// The symbols of the mode's constraint.
    symbols: Vec<u32>,
    /// The constraint as a table, where it can be one.
    table: Option<Table>,
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
    /// Places whose constraints have to be looked at again.
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

impl Standing {
    /// Where a place stands that was not looked at yet.
    const fn of(mode: Option<u8>) -> Self {
        if mode.is_some() { Self::Waiting } else { Self::Done }
    }
}

/// Which modes of an island the domains are the consequences of; at first of none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settled {
    /// By place; empty where no consequences can be built on.
    modes: Vec<Option<u8>>,
    standing: Vec<Standing>,
}

/// What domains were like, and where places stood.
pub(crate) struct Point {
    mark: usize,
    standing: Vec<Standing>,
}

impl Domains {
    /// All values for all symbols, except that `observation` is as it is.
    pub(crate) fn observed(model: &Model, observation: &Observation) -> Self {
        let mut domains = Self {
            sets: model.full.clone(),
            reasons: vec![0; model.full.len()],
            trail: Vec::with_capacity(32),
            waiting: Vec::with_capacity(16),
            standing: Vec::new(),
        };
        for (&variable, &value) in &observation.0 {
            if let Some(set) = domains.sets.get_mut(model.variable_symbol(variable) as usize) {
                *set &= 1_u64.checked_shl(u32::from(value)).unwrap_or(0);
            }
        }
        domains
    }

    /// Where domains that were `settled` stand, to go on from there.
    pub(crate) fn resume(&mut self, settled: &Settled) -> Point {
        self.standing.clone_from(&settled.standing);
        self.point()
    }

    /// A point to come back to when consequences have been tried.
    pub(crate) fn point(&self) -> Point {
        Point { mark: self.mark(), standing: self.standing.clone() }
    }

    /// Takes back everything since a point.
    pub(crate) fn return_to(&mut self, point: &Point) {
        self.undo(point.mark);
        self.standing.clone_from(&point.standing);
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
    pub(crate) fn narrow(&mut self, symbol: u32, set: u64, blame: Places) -> bool {
        let at = symbol as usize;
        let Some(&before) = self.sets.get(at) else { return false };
        let narrowed = before & set;
        if narrowed != before {
            self.trail.push((symbol, before, self.reasons[at]));
            self.sets[at] = narrowed;
            self.reasons[at] |= blame;
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

    /// Narrows `domains` to what the assumed modes leave; the error names components that cannot hold together.
    ///
    /// Answers whether the constraints of all assumed modes now hold whatever values are chosen.
    pub(crate) fn propagate(&self, domains: &mut Domains) -> Result<bool, Places> {
        self.assume(Places::MAX, domains)?;
        self.settle(domains)
    }

    /// The same as [`Self::propagate`] where `domains` are what `settled` tells, and stay so: nothing is to be undone.
    ///
    /// Takes back only what rests on modes that differ from the settled ones, and looks at those places again that this
    /// concerns (as de Kleer's assumption-based truth maintenance does, 1986, with one label per symbol).
    pub(crate) fn propagate_from(
        &self,
        settled: &mut Settled,
        domains: &mut Domains,
    ) -> Result<bool, Places> {
        domains.trail.clear();
        std::mem::swap(&mut domains.standing, &mut settled.standing);
        let result = self.change(&settled.modes, domains).and_then(|()| self.drain(domains));
        std::mem::swap(&mut domains.standing, &mut settled.standing);
        if result.is_ok() {
            settled.modes.clone_from(&self.modes);
        } else {
            // Not all consequences were drawn, so that there is nothing to build on.
            settled.modes.clear();
        }
        result
    }

    /// Takes back what rests on other modes than these, and marks the places to look at again.
    fn change(&self, before: &[Option<u8>], domains: &mut Domains) -> Result<(), Places> {
        let mut differing = 0;
        if before.len() == self.modes.len() {
            let places = self.modes.iter().zip(before).zip(&mut domains.standing).enumerate();
            for (place, ((mode, _), standing)) in places.filter(|(_, ((mode, before), _))| mode != before) {
                differing |= place_bit(place);
                *standing = Standing::of(*mode);
            }
            if differing == 0 {
                return Ok(());
            }
        } else {
            differing = Places::MAX;
            domains.standing.clear();
            domains.standing.extend(self.modes.iter().map(|mode| Standing::of(*mode)));
        }
        for &symbol in &self.island.own_symbols {
            if domains.reasons[symbol as usize] & differing == 0 {
                continue;
            }
            domains.reasons[symbol as usize] = 0;
            domains.sets[symbol as usize] = self.model.full[symbol as usize];
            for &place in &self.model.watchers[symbol as usize] {
                domains.standing[place as usize] = Standing::of(self.modes[place as usize]);
            }
        }
        self.assume(differing, domains)?;
        for (symbol, ..) in &domains.trail {
            for &place in &self.model.watchers[*symbol as usize] {
                domains.standing[place as usize] = Standing::of(self.modes[place as usize]);
            }
        }
        Ok(())
    }

    /// Where constraints ask for modes, says which ones are assumed at `places`.
    fn assume(&self, places: Places, domains: &mut Domains) -> Result<(), Places> {
        let modes = if self.island.speaks_of_modes { self.modes.as_slice() } else { &[] };
        for (place, mode) in modes.iter().enumerate().filter(|(place, _)| places & place_bit(*place) != 0) {
            let (Some(mode), Some(component)) = (mode, self.island.components.get(place)) else { continue };
            let symbol = Model::mode_symbol(*component);
            let set = 1_u64.checked_shl(u32::from(*mode)).unwrap_or(0);
            if !domains.narrow(symbol, set, place_bit(place)) {
                return Err(domains.blame(&[symbol], place));
            }
        }
        Ok(())
    }

    /// Enforces all assumed constraints until nothing changes any more.
    fn settle(&self, domains: &mut Domains) -> Result<bool, Places> {
        domains.standing.clear();
        domains.standing.extend(self.modes.iter().map(|mode| Standing::of(*mode)));
        self.drain(domains)
    }

    /// Looks at all places that are waiting, and at those that this concerns; answers whether none is left open.
    ///
    /// Places are looked at in their order, and again when a symbol they speak of was narrowed: where causes are declared
    /// before effects, once each.
    fn drain(&self, domains: &mut Domains) -> Result<bool, Places> {
        domains.waiting.clear();
        for first in 0..self.modes.len() {
            if domains.standing[first] != Standing::Waiting {
                continue;
            }
            let mut next = Some(first);
            while let Some(place) = next {
                let mark = domains.mark();
                let holds = self.enforce(place, domains)?;
                domains.standing[place] = if holds { Standing::Done } else { Standing::Idle };
                self.wake(mark, domains);
                next = domains.waiting.pop().map(|place| place as usize);
            }
        }
        Ok(!domains.standing.contains(&Standing::Idle))
    }

    /// Has those places looked at again that speak of what was narrowed since `mark`.
    fn wake(&self, mark: usize, domains: &mut Domains) {
        for (symbol, ..) in &domains.trail[mark..] {
            for &place in self.model.watchers.get(*symbol as usize).into_iter().flatten() {
                if let Some(standing @ Standing::Idle) = domains.standing.get_mut(place as usize) {
                    *standing = Standing::Waiting;
                    domains.waiting.push(place);
                }
            }
        }
    }

    /// Enforces the constraint at a place; answers whether it now holds whatever is chosen.
    fn enforce(&self, place: usize, domains: &mut Domains) -> Result<bool, Places> {
        let Some(mode) = self.modes[place] else { return Ok(true) };
        let Some(saying) = self.island.sayings[place].get(usize::from(mode)) else { return Ok(true) };
        let Some(table) = &saying.table else { return self.enforce_formula(place, saying, domains) };
        loop {
            let mark = domains.mark();
            let (mut is_true, mut start) = (true, 0);
            while let Some((clause, next)) = table.clause(start, &domains.sets) {
                start = next;
                match clause {
                    Clause::True => {}
                    Clause::Open => is_true = false,
                    Clause::False => return Err(domains.blame(&saying.symbols, place)),
                    Clause::Needs(members) => {
                        let blame = domains.blame(&saying.symbols, place);
                        for member in members {
                            domains.narrow(member.symbol, member.set, blame);
                        }
                    }
                }
            }
            // What one clause left may decide another.
            if table.is_single() || domains.mark() == mark {
                return Ok(is_true);
            }
        }
    }

    /// The same for constraints that are nested deeply.
    fn enforce_formula(&self, place: usize, saying: &Saying, domains: &mut Domains) -> Result<bool, Places> {
        let Some(formula) = self.formula(place) else { return Ok(true) };
        if formula.truth(&domains.sets) == Truth::True {
            return Ok(true);
        }
        let blame = domains.blame(&saying.symbols, place);
        if enforce(formula, domains, blame) { Ok(false) } else { Err(blame) }
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

    /// The same where all consequences of the assumed modes were drawn already.
    pub(crate) fn search(&self, domains: &mut Domains) -> Result<(), Places> {
        let Some((symbol, place)) = self.open_symbol(domains) else { return Ok(()) };
        let set = domains.sets.get(symbol as usize).copied().unwrap_or(0);
        let mut blame = place_bit(place) | domains.blame_of(symbol);
        let point = domains.point();
        for value in crate::observe::values(set) {
            match self.restrict([(symbol, 1 << value)], domains) {
                Ok(true) => return Ok(()),
                Ok(false) => match self.search(domains) {
                    Ok(()) => return Ok(()),
                    Err(places) => blame |= places,
                },
                Err(places) => blame |= places,
            }
            domains.return_to(&point);
        }
        Err(blame)
    }

    /// Leaves symbols only some values, and draws the consequences for `domains` of which all were drawn before.
    ///
    /// Answers and errors are those of [`Self::propagate`].
    pub(crate) fn restrict(
        &self,
        given: impl IntoIterator<Item = (u32, u64)>,
        domains: &mut Domains,
    ) -> Result<bool, Places> {
        let mark = domains.mark();
        for (symbol, set) in given {
            if !domains.narrow(symbol, set, 0) {
                return Err(domains.blame_of(symbol));
            }
        }
        self.wake(mark, domains);
        self.drain(domains)
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

    /// The symbols of the constraints that are not yet true whatever happens.
    pub(crate) fn open_symbols(&self, settled: &Settled) -> impl Iterator<Item = &'model [u32]> {
        let open = settled.standing.iter().enumerate().filter(|(_, standing)| **standing == Standing::Idle);
        open.filter_map(|(place, _)| Some(self.saying(place)?.symbols.as_slice()))
    }

    fn saying(&self, place: usize) -> Option<&'model Saying> {
        let mode = self.modes.get(place).copied().flatten()?;
        self.island.sayings.get(place)?.get(usize::from(mode))
    }

    /// Narrows after one symbol was fixed from outside.
    pub(crate) fn settle_all(&self, domains: &mut Domains) -> Result<(), Places> {
        self.settle(domains).map(|_| ())
    }
}

/// Removes values that `formula` rules out; false when none are left.
fn enforce(formula: &Formula, domains: &mut Domains, blame: Places) -> bool {
    match formula {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => domains.narrow(*symbol, *set, blame),
        Formula::All(parts) => parts.iter().all(|part| enforce(part, domains, blame)),
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
            possible.is_some_and(|part| enforce(part, domains, blame))
        }
    }
}

/// Cuts the model into islands; called once, when it is compiled.
pub(crate) fn islands(model: &Model) -> Vec<Island> {
    let symbols = model.components.len() + model.variables.len();
    let mut parents: Vec<usize> = (0..symbols).collect();
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
        own_symbols: Vec::new(),
        sayings: Vec::new(),
        speaks_of_modes: false,
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
        island.sayings = modes.map(|component| component.modes.iter().map(said).collect()).collect();
        let mut asked = island.sayings.iter().flatten().flat_map(|saying| &saying.symbols);
        island.speaks_of_modes = asked.any(|&symbol| (symbol as usize) < model.components.len());
        let variables = island.variables.iter().map(|variable| model.variable_symbol(*variable));
        let components = island.components.iter().map(|component| Model::mode_symbol(*component));
        island.own_symbols = variables.chain(components.filter(|_| island.speaks_of_modes)).collect();
    }
    islands
}

/// By symbol, the places (in the island that the symbol belongs to) of the components whose modes speak of it.
pub(crate) fn watchers(model: &Model) -> Vec<Vec<u32>> {
    let mut watchers: Vec<Vec<u32>> = vec![Vec::new(); model.full.len()];
    for island in &model.islands {
        for (place, sayings) in (0..).zip(&island.sayings) {
            for &symbol in sayings.iter().flat_map(|saying| &saying.symbols) {
                let Some(watchers) = watchers.get_mut(symbol as usize) else { continue };
                if watchers.last() != Some(&place) {
                    watchers.push(place);
                }
            }
        }
    }
    watchers
}

fn said(mode: &Mode) -> Saying {
    let mut symbols = Vec::new();
    mode.constraint.symbols(&mut |symbol| symbols.push(symbol));
    symbols.sort_unstable();
    symbols.dedup();
    Saying { symbols, table: Table::new(&mode.constraint) }
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}
