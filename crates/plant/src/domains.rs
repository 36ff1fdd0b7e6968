//! The values that symbols may still have, with the reason for that and how to take it back.

use crate::island::{Places, place_bit};
use crate::model::{Model, Observation};
use crate::value_set::ValueSet;

/// The values that symbols may still have, and which components' modes are the reason.
///
/// Every narrowing is written down, so that a trial is undone in time proportional to what it did.
#[derive(Clone, Debug)]
pub(crate) struct Domains {
    /// Indexed by symbol.
    pub(crate) sets: Vec<ValueSet>,
    pub(crate) reasons: Vec<Places>,
    /// What was narrowed: the symbol, and its set and reasons before.
    pub(crate) trail: Vec<(u32, ValueSet, Places)>,
    /// Places whose constraints have to be looked at again.
    pub(crate) waiting: Vec<u32>,
    /// Per place of the island under work.
    pub(crate) standing: Vec<Standing>,
}

/// Where a place stands while constraints are enforced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    /// It was looked at; what it says may still matter.
    Idle,
    /// It has to be looked at.
    Waiting,
    /// Its constraint holds whatever else happens, or nothing is assumed of it.
    Done,
}

impl Standing {
    /// Returns where a place stands that was not looked at yet.
    pub(crate) const fn of(mode: Option<u8>) -> Self {
        if mode.is_some() { Self::Waiting } else { Self::Done }
    }
}

/// Which modes of an island the domains are the consequences of; at first of none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Settled {
    /// By place; empty where no consequences can be built on.
    pub(crate) modes: Vec<Option<u8>>,
    pub(crate) standing: Vec<Standing>,
}

/// What domains were like, and where places stood.
pub(crate) struct Point {
    mark: usize,
    standing: Vec<Standing>,
}

impl Domains {
    /// All values for all symbols, except that variables observed without errors have their observed values.
    pub(crate) fn observed(model: &Model, observation: &Observation) -> Self {
        let mut domains = Self {
            sets: model.full.clone(),
            reasons: vec![0; model.full.len()],
            trail: Vec::with_capacity(32),
            waiting: Vec::with_capacity(16),
            standing: Vec::new(),
        };
        for (&variable, &value) in &observation.0 {
            if model.variables.get(variable.0 as usize).is_some_and(|data| data.error.is_some()) {
                continue;
            }
            if let Some(set) = domains.sets.get_mut(model.variable_symbol(variable) as usize) {
                *set &= ValueSet::one(value);
            }
        }
        domains
    }

    /// Returns where domains that were `settled` stand, to continue from there.
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
    #[inline]
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

    /// Leaves a symbol only values of `set`, because of `reason`; false when none are left.
    #[inline]
    pub(crate) fn narrow(&mut self, symbol: u32, set: ValueSet, reason: Places) -> bool {
        let at = symbol as usize;
        let Some(&before) = self.sets.get(at) else { return false };
        let narrowed = before & set;
        if narrowed != before {
            self.trail.push((symbol, before, self.reasons[at]));
            self.sets[at] = narrowed;
            self.reasons[at] |= reason;
        }
        !narrowed.is_empty()
    }

    /// The reason for a symbol's values.
    #[inline]
    pub(crate) fn reason_of(&self, symbol: u32) -> Places {
        self.reasons.get(symbol as usize).copied().unwrap_or(0)
    }

    /// The reason for what a constraint at a place makes of its symbols.
    #[inline]
    pub(crate) fn reason_for(&self, symbols: &[u32], place: usize) -> Places {
        let reasons = symbols.iter().filter_map(|symbol| self.reasons.get(*symbol as usize));
        reasons.fold(place_bit(place), |all, reason| all | reason)
    }
}
