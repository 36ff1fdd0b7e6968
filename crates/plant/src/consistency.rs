//! Whether modes, and what is observed, can hold together: propagation over value sets, then search.

use crate::domains::{Domains, Settled, Standing};
use crate::formula::{Formula, Truth};
use crate::island::{Island, Places, Saying, place_bit};
use crate::model::Model;
use crate::table::Clause;
use crate::value_set::ValueSet;

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
    /// Whether the constraints of all assumed modes now hold whatever values are chosen.
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

    /// Prepares domains that nothing is assumed of yet for [`Self::add`].
    pub(crate) fn begin(&self, domains: &mut Domains) {
        domains.standing.clear();
        domains.standing.resize(self.modes.len(), Standing::Done);
    }

    /// Assumes a mode more, and draws the consequences for `domains` of which all were drawn before.
    ///
    /// The caller takes both back: the mode, and the domains by a point from before.
    pub(crate) fn add(&mut self, place: usize, mode: u8, domains: &mut Domains) -> Result<(), Places> {
        let mark = domains.mark();
        self.modes[place] = Some(mode);
        domains.standing[place] = Standing::Waiting;
        self.assume(place_bit(place), domains)?;
        self.wake(mark, domains);
        self.drain(domains).map(|_| ())
    }

    /// Where constraints ask for modes, says which ones are assumed at `places`.
    fn assume(&self, places: Places, domains: &mut Domains) -> Result<(), Places> {
        let modes = if self.island.speaks_of_modes { self.modes.as_slice() } else { &[] };
        for (place, mode) in modes.iter().enumerate().filter(|(place, _)| places & place_bit(*place) != 0) {
            let (Some(mode), Some(component)) = (mode, self.island.components.get(place)) else { continue };
            let symbol = Model::mode_symbol(*component);
            let set = ValueSet::one(*mode);
            if !domains.narrow(symbol, set, place_bit(place)) {
                return Err(domains.reason_for(&[symbol], place));
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

    /// Looks at all places that are waiting, and at those that this concerns; returns whether none is left open.
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

    /// Enforces the constraint at a place; returns whether it now holds whatever is chosen.
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
                    Clause::False => return Err(domains.reason_for(&saying.symbols, place)),
                    Clause::Needs(members) => {
                        let reason = domains.reason_for(&saying.symbols, place);
                        for member in members {
                            domains.narrow(member.symbol, member.set, reason);
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
        let reason = domains.reason_for(&saying.symbols, place);
        if enforce(formula, domains, reason) { Ok(false) } else { Err(reason) }
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
        let set = domains.sets.get(symbol as usize).copied().unwrap_or_default();
        let mut reason = place_bit(place) | domains.reason_of(symbol);
        let point = domains.point();
        for value in set.values() {
            match self.restrict([(symbol, ValueSet::one(value))], domains) {
                Ok(true) => return Ok(()),
                Ok(false) => match self.search(domains) {
                    Ok(()) => return Ok(()),
                    Err(places) => reason |= places,
                },
                Err(places) => reason |= places,
            }
            domains.return_to(&point);
        }
        Err(reason)
    }

    /// Leaves symbols only some values, and draws the consequences for `domains` of which all were drawn before.
    ///
    /// Answers and errors are those of [`Self::propagate`].
    pub(crate) fn restrict(
        &self,
        given: impl IntoIterator<Item = (u32, ValueSet)>,
        domains: &mut Domains,
    ) -> Result<bool, Places> {
        let mark = domains.mark();
        for (symbol, set) in given {
            if !domains.narrow(symbol, set, 0) {
                return Err(domains.reason_of(symbol));
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
                let open = domains.sets.get(symbol as usize).is_some_and(|set| set.len() > 1);
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
fn enforce(formula: &Formula, domains: &mut Domains, reason: Places) -> bool {
    match formula {
        Formula::Constant(value) => *value,
        Formula::Member { symbol, set } => domains.narrow(*symbol, *set, reason),
        Formula::All(parts) => parts.iter().all(|part| enforce(part, domains, reason)),
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
            possible.is_some_and(|part| enforce(part, domains, reason))
        }
    }
}
