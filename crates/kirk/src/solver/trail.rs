//! The bounds of all variables, and the record of how they came about, by which they are taken back and explained.

use super::literal::{Literal, Side, Variable};

/// No event: the bound holds from the start.
pub(crate) const INITIAL: u32 = u32::MAX;

/// Why a bound holds. What else it rests on is found out only if somebody asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// It was decided, or holds whatever is decided.
    Decision,
    /// All other literals of a clause are false.
    Clause(u32),
    /// The difference constraint carried the bound of its source on.
    Difference(u32),
    /// The difference constraint would have contradicted the bounds of both its ends.
    Refuted(u32),
    /// The variable had no value left, so that it does not exist.
    Empty(Variable),
    /// This side of a Boolean was decided.
    Implied(Side),
    /// All alternatives that are left of a choice have it.
    Alternatives(u32),
    /// Noted when it was found: a range of [`Trail::noted`].
    Noted(u32),
}

/// A bound that became tighter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) side: Side,
    pub(crate) level: u32,
    pub(crate) most: i64,
    pub(crate) before: i64,
    /// The event of the bound before, or [`INITIAL`].
    pub(crate) previous: u32,
    pub(crate) cause: Cause,
}

/// Literals that hold and cannot hold together.
pub(crate) type Conflict = Vec<Literal>;

#[derive(Clone, Debug, Default)]
pub(crate) struct Trail {
    bounds: Vec<i64>,
    last: Vec<u32>,
    /// By variable: what makes it exist.
    presence: Vec<Literal>,
    pub(crate) events: Vec<Event>,
    /// The number of events, and of noted reasons, where each level begins.
    levels: Vec<(u32, u32)>,
    noted: Vec<Box<[Literal]>>,
}

impl Trail {
    pub(crate) fn new() -> Self {
        let mut trail = Self::default();
        trail.add(1, 1, Literal::TRUE);
        trail
    }

    /// Adds a variable between two values, which exists where `presence` holds.
    pub(crate) fn add(&mut self, least: i64, most: i64, presence: Literal) -> Variable {
        let variable = Variable(self.presence.len() as u32);
        self.bounds.extend([most, -least]);
        self.last.extend([INITIAL; 2]);
        self.presence.push(presence);
        variable
    }

    pub(crate) fn num_variables(&self) -> usize {
        self.presence.len()
    }

    pub(crate) fn bound(&self, side: Side) -> i64 {
        self.bounds[side.index()]
    }

    pub(crate) fn least(&self, variable: Variable) -> i64 {
        -self.bounds[variable.lower().index()]
    }

    pub(crate) fn most(&self, variable: Variable) -> i64 {
        self.bounds[variable.upper().index()]
    }

    pub(crate) fn presence(&self, variable: Variable) -> Literal {
        self.presence[variable.index()]
    }

    pub(crate) fn holds(&self, literal: Literal) -> bool {
        self.bounds[literal.side.index()] <= literal.most
    }

    pub(crate) fn fails(&self, literal: Literal) -> bool {
        self.holds(!literal)
    }

    pub(crate) fn is_open(&self, literal: Literal) -> bool {
        !self.holds(literal) && !self.fails(literal)
    }

    pub(crate) fn level(&self) -> u32 {
        self.levels.len() as u32
    }

    pub(crate) fn open_level(&mut self) {
        self.levels.push((self.events.len() as u32, self.noted.len() as u32));
    }

    /// Keeps a reason for [`Cause::Noted`] until the present level is left.
    pub(crate) fn note(&mut self, reason: Vec<Literal>) -> Cause {
        self.noted.push(reason.into_boxed_slice());
        Cause::Noted(self.noted.len() as u32 - 1)
    }

    pub(crate) fn noted(&self, position: u32) -> &[Literal] {
        &self.noted[position as usize]
    }

    /// Makes a literal hold. A variable without values left does not exist; if it must, that is a conflict.
    pub(crate) fn set(&mut self, literal: Literal, cause: Cause) -> Result<(), Conflict> {
        let Literal { side, most } = literal;
        let before = self.bounds[side.index()];
        if before <= most {
            return Ok(());
        }
        let presence = self.presence[side.variable().index()];
        if self.fails(presence) {
            return Ok(());
        }
        let event = self.events.len() as u32;
        let previous = self.last[side.index()];
        self.events.push(Event { side, level: self.level(), most, before, previous, cause });
        self.bounds[side.index()] = most;
        self.last[side.index()] = event;
        if self.bounds[side.opposite().index()] >= -most {
            return Ok(());
        }
        if self.holds(presence) {
            return Err(vec![literal, !literal, presence]);
        }
        self.set(!presence, Cause::Empty(side.variable()))
    }

    /// Takes back the last event.
    pub(crate) fn undo_last(&mut self) -> Option<Event> {
        let event = self.events.pop()?;
        self.bounds[event.side.index()] = event.before;
        self.last[event.side.index()] = event.previous;
        Some(event)
    }

    /// Takes back all events of levels above `level`, the last one first.
    pub(crate) fn retract(&mut self, level: u32, mut retracted: impl FnMut(&Event)) {
        let Some(&(first, num_noted)) = self.levels.get(level as usize) else { return };
        while self.events.len() > first as usize {
            let Some(event) = self.undo_last() else { break };
            retracted(&event);
        }
        self.noted.truncate(num_noted as usize);
        self.levels.truncate(level as usize);
    }

    /// The event by which a literal that holds came to hold, or [`INITIAL`].
    pub(crate) fn implying_event(&self, literal: Literal) -> u32 {
        let mut event = self.last[literal.side.index()];
        while event != INITIAL && self.events[event as usize].before <= literal.most {
            event = self.events[event as usize].previous;
        }
        event
    }

    /// The bound that a side had before event `at`.
    pub(crate) fn bound_before(&self, side: Side, at: u32) -> i64 {
        let mut bound = self.bounds[side.index()];
        let mut event = self.last[side.index()];
        while event != INITIAL && event >= at {
            bound = self.events[event as usize].before;
            event = self.events[event as usize].previous;
        }
        bound
    }
}
