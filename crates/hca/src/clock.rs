//! Time in an automaton: the clocks of composites and locations, and conditions that have to have lasted (SPEC 8.5).
//!
//! A clock holds the steps at whose ends it is up, not a count: a step in which nothing is up costs nothing, however long
//! the clock runs.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::automaton::{Automaton, CompositeId, Element, TestId};
use crate::locks::LockState;

/// Index of a clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ClockId(pub u32);

/// What a clock is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockKind {
    /// Counts from the latest start of a composite; when it is up, what is left of the first child is dropped.
    Timeout,
    /// Each start of a location completes when its own time is up.
    Wait,
    /// Is up once, at a time of the program.
    At,
    /// Is up again and again, counted from the latest start of a location.
    Every,
}

/// A clock of an automaton.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    pub kind: ClockKind,
    /// How traces and drawings call it, such as `TIMEOUT 5 s`.
    pub label: SmolStr,
    /// How long it takes: at least one step.
    pub steps: u64,
    /// The location or composite that it belongs to.
    pub owner: Element,
}

/// A condition that has to have lasted: a guard `(HELD d c)` refers to it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeldCondition {
    /// What has to be entailed.
    pub test: TestId,
    /// Whether it is non-entailment that has to have lasted.
    pub non_entailed: bool,
    /// For how many steps.
    pub steps: u64,
}

/// The steps at whose ends a clock is up, as ranges, the earliest first.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Ends {
    ranges: VecDeque<(u64, u64)>,
}

impl Ends {
    /// The first step at whose end something is up.
    pub(crate) fn first(&self) -> Option<u64> {
        self.ranges.front().map(|(first, _)| *first)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Adds an end; none that was added before is later.
    pub(crate) fn add(&mut self, end: u64) {
        match self.ranges.back_mut() {
            Some((_, last)) if *last >= end => {}
            Some((_, last)) if *last + 1 == end => *last = end,
            _ => self.ranges.push_back((end, end)),
        }
    }

    /// Forgets all ends but this.
    pub(crate) fn set(&mut self, end: u64) {
        self.ranges.clear();
        self.ranges.push_back((end, end));
    }

    /// Renumbers the steps: the step `before` becomes the step `after`.
    fn shift(&mut self, before: u64, after: u64) {
        let shifted = |end: u64| end.saturating_sub(before).saturating_add(after);
        for (first, last) in &mut self.ranges {
            (*first, *last) = (shifted(*first), shifted(*last));
        }
    }

    /// In how many steps something is up, as ranges.
    pub(crate) fn left(&self, now: u64) -> Vec<(u64, u64)> {
        let left = |&(first, last): &(u64, u64)| (first.saturating_sub(now), last.saturating_sub(now));
        self.ranges.iter().map(left).collect()
    }

    /// Takes the end out that is now, and returns whether there was one.
    pub(crate) fn take(&mut self, now: u64) -> bool {
        let Some((first, last)) = self.ranges.front_mut().filter(|(first, _)| *first == now) else {
            return false;
        };
        if first < last {
            *first += 1;
        } else {
            self.ranges.pop_front();
        }
        true
    }

    pub(crate) fn clear(&mut self) {
        self.ranges.clear();
    }
}

/// How the time of a run stands.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct Times {
    /// How many steps have been taken; during a step, its number.
    pub(crate) step: u64,
    /// Of each clock.
    pub(crate) ends: Vec<Ends>,
    /// For each condition that has to have lasted, the last step that did not satisfy it.
    pub(crate) unsatisfied: Vec<u64>,
    /// What each lock of the program does, by its number.
    pub(crate) locks: Vec<LockState>,
    /// The choices that are still to be made, in textual order.
    pub(crate) open: Vec<CompositeId>,
}

impl Times {
    pub(crate) fn new(automaton: &Automaton) -> Self {
        Self {
            step: 0,
            ends: vec![Ends::default(); automaton.clocks.len()],
            unsatisfied: vec![0; automaton.held.len()],
            locks: vec![LockState::default(); automaton.locks.len()],
            open: Vec::new(),
        }
    }

    /// A choice is to be made; several starts in one step are one.
    pub(crate) fn leave_open(&mut self, choice: CompositeId) {
        if let Err(place) = self.open.binary_search(&choice) {
            self.open.insert(place, choice);
        }
    }

    /// Forgets how many steps have been taken, but not their effect on later steps.
    ///
    /// The step becomes the smallest number that leaves room for all past steps that matter: a condition counts as lasting
    /// at most as long as it has to, and for waiting programs only their order matters. Until the last time of an AT, the
    /// steps since the program's start matter.
    pub(crate) fn count_from_now(&mut self, automaton: &Automaton) {
        let at = automaton.clocks.iter().filter(|clock| clock.kind == ClockKind::At);
        let last_time = at.map(|clock| clock.steps).max().unwrap_or(0);
        let lasting = automaton.held.iter().map(|held| held.steps).max().unwrap_or(0);
        let now = if self.step < last_time {
            self.step
        } else {
            lasting.max(self.locks.len() as u64).max(last_time)
        };
        for ends in &mut self.ends {
            ends.shift(self.step, now);
        }
        for (held, unsatisfied) in automaton.held.iter().zip(&mut self.unsatisfied) {
            *unsatisfied = now - (self.step - *unsatisfied).min(held.steps);
        }
        let mut since: Vec<u64> = self.locks.iter().filter_map(LockState::waiting_since).collect();
        since.sort_unstable();
        since.dedup();
        for lock in &mut self.locks {
            if let LockState::Waiting(from) = lock {
                *from = since.partition_point(|earlier| earlier < from) as u64;
            }
        }
        self.step = now;
    }

    pub(crate) fn ends_mut(&mut self, clock: ClockId) -> Option<&mut Ends> {
        self.ends.get_mut(clock.0 as usize)
    }

    /// Returns whether a clock is up at the end of this step.
    pub(crate) fn is_up(&self, clock: ClockId) -> bool {
        self.ends.get(clock.0 as usize).and_then(Ends::first) == Some(self.step)
    }

    /// A start in this step, for the next one.
    pub(crate) fn start(&mut self, id: ClockId, clock: &Clock) {
        let end = self.step.saturating_add(clock.steps);
        let Some(ends) = self.ends_mut(id) else { return };
        match clock.kind {
            ClockKind::Wait => ends.add(end),
            ClockKind::Timeout | ClockKind::Every => ends.set(end),
            ClockKind::At => {}
        }
    }
}
