//! Clauses, learned ones among them, watched by two of their literals.

use typed_index_collections::TiVec;

use super::literal::{Literal, Side};
use super::trail::{Cause, Conflict, Trail};
use crate::ids::{ClauseId, EventId};

#[derive(Clone, Debug)]
pub(crate) struct Clause {
    pub(crate) literals: Box<[Literal]>,
    is_learned: bool,
    /// How many levels its literals came from when it was learned.
    num_levels: u32,
    activity: f64,
}

/// A clause is looked at when the watched literal becomes false: when this side is at most `most`.
#[derive(Clone, Copy, Debug)]
struct Watch {
    most: i64,
    clause: ClauseId,
    /// Another literal of the clause; while it holds, there is nothing to do.
    other: Literal,
}

#[derive(Clone, Debug)]
pub(crate) struct Clauses {
    all: TiVec<ClauseId, Clause>,
    free: Vec<ClauseId>,
    watches: TiVec<Side, Vec<Watch>>,
    num_learned: usize,
    increment: f64,
}

impl Clauses {
    pub(crate) fn new() -> Self {
        Self { all: TiVec::new(), free: Vec::new(), watches: TiVec::new(), num_learned: 0, increment: 1.0 }
    }

    pub(crate) fn resize(&mut self, num_variables: usize) {
        self.watches.resize(num_variables * 2, Vec::new());
    }

    pub(crate) fn num_learned(&self) -> usize {
        self.num_learned
    }

    pub(crate) fn literals(&self, clause: ClauseId) -> &[Literal] {
        &self.all[clause].literals
    }

    /// Adds a clause of at least two literals. The first two are watched: they must be the last ones to become false.
    pub(crate) fn add(&mut self, literals: Vec<Literal>, num_levels: Option<u32>) -> ClauseId {
        let watched = [literals[0], literals[1]];
        let clause = Clause {
            literals: literals.into_boxed_slice(),
            is_learned: num_levels.is_some(),
            num_levels: num_levels.unwrap_or(0),
            activity: self.increment,
        };
        self.num_learned += usize::from(num_levels.is_some());
        let id = if let Some(id) = self.free.pop() {
            self.all[id] = clause;
            id
        } else {
            self.all.push_and_get_key(clause)
        };
        for (literal, other) in [(watched[0], watched[1]), (watched[1], watched[0])] {
            let falsified = !literal;
            self.watches[falsified.side].push(Watch { most: falsified.most, clause: id, other });
        }
        id
    }

    /// Makes a clause outlive others.
    pub(crate) fn bump(&mut self, clause: ClauseId) {
        let activity = &mut self.all[clause].activity;
        *activity += self.increment;
        if *activity > 1e100 {
            for clause in &mut self.all {
                clause.activity *= 1e-100;
            }
            self.increment *= 1e-100;
        }
    }

    pub(crate) fn decay(&mut self) {
        self.increment /= 0.999;
    }

    /// Propagates all clauses that a side's new bound concerns.
    pub(crate) fn propagate(&mut self, trail: &mut Trail, event: EventId) -> Result<(), Conflict> {
        let event = trail.events[event];
        let side = event.side;
        if self.watches[side].is_empty() {
            return Ok(());
        }
        let mut watches = std::mem::take(&mut self.watches[side]);
        let mut result = Ok(());
        let (mut kept, mut at) = (0, 0);
        while at < watches.len() {
            let watch = watches[at];
            at += 1;
            if watch.most < event.most || trail.holds(watch.other) {
                watches[kept] = watch;
                kept += 1;
                continue;
            }
            let falsified = !Literal::new(event.side, watch.most);
            let literals = &mut self.all[watch.clause].literals;
            if literals[0] == falsified {
                literals.swap(0, 1);
            }
            let other = literals[0];
            let replacement = if trail.holds(other) {
                None
            } else {
                (2..literals.len()).find(|&position| !trail.fails(literals[position]))
            };
            if let Some(position) = replacement {
                literals.swap(1, position);
                let next = !literals[1];
                self.watches[next.side].push(Watch { most: next.most, clause: watch.clause, other });
                continue;
            }
            watches[kept] = Watch { other, ..watch };
            kept += 1;
            if let Err(conflict) = trail.set(other, Cause::Clause(watch.clause)) {
                result = Err(conflict);
                break;
            }
        }
        watches.copy_within(at.., kept);
        watches.truncate(kept + watches.len() - at);
        // Replacements never watch the side that is being looked through.
        let moved = std::mem::replace(&mut self.watches[side], watches);
        self.watches[side].extend(moved);
        result
    }

    /// Forgets the worse half of what was learned. Only where no clause is the reason of anything: at the root.
    pub(crate) fn forget_half(&mut self) {
        let mut learned: Vec<ClauseId> = self
            .all
            .keys()
            .filter(|&id| {
                let clause = &self.all[id];
                clause.is_learned && clause.num_levels > 2 && !clause.literals.is_empty()
            })
            .collect();
        learned.sort_by(|&left, &right| {
            let (left, right) = (&self.all[left], &self.all[right]);
            (left.num_levels.min(8).cmp(&right.num_levels.min(8)))
                .then(right.activity.total_cmp(&left.activity))
        });
        for id in learned.split_off(learned.len() / 2) {
            self.all[id].literals = Box::default();
            self.free.push(id);
            self.num_learned -= 1;
        }
        let clauses = &self.all;
        for watches in &mut self.watches {
            watches.retain(|watch| !clauses[watch.clause].literals.is_empty());
        }
    }
}
