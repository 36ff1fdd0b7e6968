//! The bounds of all variables, and the record of how they came about, by which they are taken back and explained.

use typed_index_collections::TiVec;

use super::literal::{Literal, Side, Variable};
use super::premise::Premise;
use crate::ids::{ClauseId, CommonBoundId, DifferenceId, EventId, NoteId};

/// Why a bound holds. What else it rests on is found out only if someone asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// It was decided, or holds whatever is decided.
    Decision,
    /// All other literals of a clause are false.
    Clause(ClauseId),
    /// The difference constraint carried the bound of its source on.
    Difference(DifferenceId),
    /// The difference constraint would have contradicted the bounds of both its ends.
    Refuted(DifferenceId),
    /// The variable had no value left, so that it does not exist.
    Empty(Variable),
    /// This side of a Boolean was decided.
    Implied(Side),
    /// All alternatives that are left of a choice have it.
    Alternatives(CommonBoundId),
    /// Noted when it was found.
    Noted(NoteId),
}

/// A bound that became tighter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Event {
    pub(crate) side: Side,
    pub(crate) level: u32,
    pub(crate) most: i64,
    pub(crate) before: i64,
    /// The event of the bound before; `None` for the one that holds from the start.
    pub(crate) previous: Option<EventId>,
    pub(crate) cause: Cause,
}

/// Literals that hold and cannot hold together.
pub(crate) type Conflict = Vec<Literal>;

#[derive(Clone, Debug, Default)]
pub(crate) struct Trail {
    bounds: TiVec<Side, i64>,
    last: TiVec<Side, Option<EventId>>,
    /// What makes each variable exist.
    presence: TiVec<Variable, Literal>,
    pub(crate) events: TiVec<EventId, Event>,
    /// The number of events, and of noted reasons, where each level begins.
    levels: Vec<(u32, u32)>,
    noted: TiVec<NoteId, Note>,
    /// What the theory that propagates at the moment goes by.
    pub(super) premise: Premise,
}

#[derive(Clone, Debug)]
struct Note {
    reason: Box<[Literal]>,
    is_of_goal: bool,
    premise: Premise,
}

impl Trail {
    pub(crate) fn new() -> Self {
        let mut trail = Self::default();
        trail.add(1, 1, Literal::TRUE);
        trail
    }

    /// Adds a variable between two values, which exists where `presence` holds.
    pub(crate) fn add(&mut self, least: i64, most: i64, presence: Literal) -> Variable {
        self.bounds.extend([most, -least]);
        self.last.extend([None; 2]);
        self.presence.push_and_get_key(presence)
    }

    pub(crate) fn num_variables(&self) -> usize {
        self.presence.len()
    }

    pub(crate) fn bound(&self, side: Side) -> i64 {
        self.bounds[side]
    }

    pub(crate) fn least(&self, variable: Variable) -> i64 {
        -self.bounds[variable.lower()]
    }

    pub(crate) fn most(&self, variable: Variable) -> i64 {
        self.bounds[variable.upper()]
    }

    pub(crate) fn presence(&self, variable: Variable) -> Literal {
        self.presence[variable]
    }

    pub(crate) fn holds(&self, literal: Literal) -> bool {
        self.bounds[literal.side] <= literal.most
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

    /// Returns what was decided last, where a level begins with a decision.
    pub(crate) fn last_decision(&self) -> Option<Literal> {
        let &(first, _) = self.levels.last()?;
        let event = self.events.get(EventId::from(first as usize))?;
        Some(Literal::new(event.side, event.most))
    }

    /// Returns what was decided, level by level.
    pub(crate) fn decisions(&self) -> Vec<Literal> {
        let first = |&(first, _): &(u32, u32)| {
            let event = self.events.get(EventId::from(first as usize));
            event.map_or(Literal::TRUE, |event| Literal::new(event.side, event.most))
        };
        self.levels.iter().map(first).collect()
    }

    /// Keeps a reason for [`Cause::Noted`] until the present level is left.
    pub(crate) fn note(&mut self, reason: Vec<Literal>) -> Cause {
        let note = Note { reason: reason.into_boxed_slice(), is_of_goal: false, premise: self.premise };
        Cause::Noted(self.noted.push_and_get_key(note))
    }

    /// The same for what follows from a limit on a goal.
    pub(crate) fn note_of_goal(&mut self, reason: Vec<Literal>) -> Cause {
        let note = Note { reason: reason.into_boxed_slice(), is_of_goal: true, premise: self.premise };
        Cause::Noted(self.noted.push_and_get_key(note))
    }

    pub(crate) fn noted(&self, note: NoteId) -> &[Literal] {
        &self.noted[note].reason
    }

    /// Returns what a reason goes by, beside its literals.
    pub(super) fn premise_of(&self, note: NoteId) -> Premise {
        self.noted[note].premise
    }

    /// Returns whether a reason is a limit on a goal.
    pub(crate) fn is_of_goal(&self, note: NoteId) -> bool {
        self.noted[note].is_of_goal
    }

    /// Makes a literal hold. A variable without values left does not exist; if it must, that is a conflict.
    pub(crate) fn set(&mut self, literal: Literal, cause: Cause) -> Result<(), Conflict> {
        let Literal { side, most } = literal;
        let before = self.bounds[side];
        if before <= most {
            return Ok(());
        }
        let presence = self.presence[side.variable()];
        if self.fails(presence) {
            return Ok(());
        }
        let previous = self.last[side];
        let event = Event { side, level: self.level(), most, before, previous, cause };
        self.bounds[side] = most;
        self.last[side] = Some(self.events.push_and_get_key(event));
        if self.bounds[side.opposite()] >= -most {
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
        self.bounds[event.side] = event.before;
        self.last[event.side] = event.previous;
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

    /// The event by which a literal that holds came to hold; `None` if it holds from the start.
    pub(crate) fn implying_event(&self, literal: Literal) -> Option<EventId> {
        let mut last = self.last[literal.side];
        while let Some(event) = last
            && self.events[event].before <= literal.most
        {
            last = self.events[event].previous;
        }
        last
    }

    /// The bound that a side had before event `at`.
    pub(crate) fn bound_before(&self, side: Side, at: EventId) -> i64 {
        let mut bound = self.bounds[side];
        let mut last = self.last[side];
        while let Some(event) = last.filter(|&event| event >= at) {
            bound = self.events[event].before;
            last = self.events[event].previous;
        }
        bound
    }
}
