//! Bounds that all alternatives left of a choice have in common.
//!
//! The event where a choice ends is no later than the latest end of an alternative that is still possible, and no earlier
//! than the earliest; the same holds for where it begins. So an open choice counts with its relaxation.

use typed_index_collections::TiVec;

use super::literal::{Literal, Side};
use super::premise::Premise;
use super::queue::PropagationQueue;
use super::trail::{Cause, Conflict, Trail};
use crate::ids::{CommonBoundId, EventId};

/// One way in which an alternative bounds a common event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub(crate) from: Side,
    pub(crate) weight: i64,
    /// Whether the alternative is taken.
    pub(crate) when: Literal,
    /// What the bound comes from.
    pub(super) premise: Premise,
}

#[derive(Clone, Debug)]
struct Common {
    to: Side,
    ways: Vec<Way>,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Alternatives {
    commons: TiVec<CommonBoundId, Common>,
    pub(super) queue: PropagationQueue<CommonBoundId>,
    /// How often the present propagation has moved what each bounds.
    moves: TiVec<CommonBoundId, u32>,
    moved: Vec<CommonBoundId>,
}

/// After so many moves in one propagation a relaxation waits for the next one: what is contradictory only together with it
/// would let bounds creep for as long as their range allows, where a decision shows it at once.
const MAX_MOVES: u32 = 16;

impl Alternatives {
    /// Adds that `to` is bounded by at least one of `ways`, of which one is taken wherever `to` exists.
    pub(crate) fn add(&mut self, to: Side, ways: Vec<Way>) {
        self.queue.add(ways.iter().flat_map(|way| [way.from, (!way.when).side]));
        self.commons.push(Common { to, ways });
        self.moves.push(0);
    }

    /// Begins a propagation.
    pub(super) fn begin(&mut self) {
        for id in self.moved.drain(..) {
            self.moves[id] = 0;
        }
    }

    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<(), Conflict> {
        while let Some(id) = self.queue.pop() {
            let Common { to, ways } = &self.commons[id];
            let left = ways.iter().filter(|way| !trail.fails(way.when));
            let most = left.map(|way| trail.bound(way.from) + way.weight).max();
            if let Some(most) = most
                && most < trail.bound(*to)
                && self.moves[id] < MAX_MOVES
            {
                if self.moves[id] == 0 {
                    self.moved.push(id);
                }
                self.moves[id] += 1;
                trail.set(Literal::new(*to, most), Cause::Alternatives(id))?;
            }
        }
        Ok(())
    }

    /// Returns what a relaxation goes by.
    pub(super) fn premises(&self, id: CommonBoundId) -> impl Iterator<Item = Premise> + '_ {
        self.commons[id].ways.iter().map(|way| way.premise)
    }

    pub(crate) fn explain(
        &self,
        trail: &Trail,
        literal: Literal,
        id: CommonBoundId,
        at: EventId,
        reason: &mut Conflict,
    ) {
        for way in &self.commons[id].ways {
            let is_bounded = Literal::new(way.from, literal.most - way.weight);
            let holds_before = |literal: Literal| trail.bound_before(literal.side, at) <= literal.most;
            if holds_before(is_bounded) {
                if holds_before(!way.when)
                    && trail.implying_event(!way.when) < trail.implying_event(is_bounded)
                {
                    reason.push(!way.when);
                } else {
                    reason.push(is_bounded);
                }
            } else {
                reason.push(!way.when);
            }
        }
    }
}
