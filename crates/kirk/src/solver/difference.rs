//! Difference constraints: `to − from ≤ weight` while a literal holds.
//!
//! Each constraint carries an upper bound of its source on to its target; its mirror does the same for lower bounds.
//! A constraint whose literal is open and whose ends can no longer satisfy it refutes the literal. Where the bounds of
//! all times are settled, the least values satisfy every constraint in force, so that bounds alone decide consistency;
//! cycles whose weights add up to less than zero are looked for where a bound keeps moving, because bounds would creep
//! along them for as long as their range allows.
//!
//! Of the bounds that wait, the one that has moved furthest since propagation began is carried on first. Where the bounds
//! before satisfied all constraints but those that are new, what a bound moves another by is at most what it has moved
//! itself, so that each is carried on once (Cotton and Maler 2006).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use typed_index_collections::TiVec;

use super::lists::Lists;
use super::literal::{Literal, Side, Variable};
use super::premise::Premise;
use super::trail::{self, Cause, Conflict, Trail};
use crate::ids::{CycleId, DifferenceId, EventId};

/// `to ≤ from + weight`, as a step from side to side. The literal implies that both ends exist, or it always holds and
/// the existence of the target implies that of the source.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Difference {
    pub(crate) from: Side,
    pub(crate) to: Side,
    pub(crate) weight: i64,
    pub(crate) when: Literal,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Differences {
    all: TiVec<DifferenceId, Difference>,
    /// What leads from each side.
    from: Lists<Side, DifferenceId>,
    /// By the side that makes their literal hold.
    waiting: Lists<Side, DifferenceId>,
    /// What the present propagation has done to each side.
    movements: TiVec<Side, Movement>,
    moved: Vec<Side>,
    /// Bounds to carry on, with how far they have moved.
    pending: BinaryHeap<(i64, Reverse<EventId>)>,
    /// Whether the constraints of each negative cycle are kept.
    pub(super) keeps_cycles: bool,
    cycles: TiVec<CycleId, Vec<DifferenceId>>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Movement {
    /// The bound before; counts where the side is among those that moved.
    before: i64,
    has_moved: bool,
    /// How often the bound was carried on.
    times: u32,
}

/// After so many moves of one bound the cycle is looked for that may cause them.
const MOVES_BEFORE_CYCLE: u32 = 6;

impl Differences {
    pub(crate) fn resize(&mut self, num_variables: usize) {
        self.from.resize(num_variables * 2);
        self.waiting.resize(num_variables * 2);
        self.movements.resize(num_variables * 2, Movement::default());
    }

    pub(crate) fn add(&mut self, difference: Difference) {
        let id = self.all.push_and_get_key(difference);
        self.from.push(difference.from, id);
        if difference.when != Literal::TRUE {
            self.waiting.push(difference.when.side, id);
        }
    }

    /// The steps added since there were `first`.
    pub(crate) fn since(&self, first: usize) -> impl Iterator<Item = DifferenceId> + use<> {
        (first..self.all.len()).map(DifferenceId::from)
    }

    pub(crate) fn len(&self) -> usize {
        self.all.len()
    }

    /// Each constraint `to − from ≤ weight` between variables, once, with the literals under which it and its mirror carry.
    pub(crate) fn constraints(&self) -> impl Iterator<Item = (Variable, Variable, i64, [Literal; 2])> + '_ {
        self.all.raw.chunks_exact(2).filter_map(|pair| match pair {
            [one, mirror] => {
                Some((one.from.variable(), one.to.variable(), one.weight, [one.when, mirror.when]))
            }
            _ => None,
        })
    }

    /// Carries on the bound of a side, as when it has just moved.
    pub(crate) fn carry_on(&self, trail: &mut Trail, side: Side) -> Result<(), Conflict> {
        let bound = trail.bound(side);
        for id in self.from.iter(side) {
            carry(trail, bound, id, &self.all[id])?;
        }
        Ok(())
    }

    /// Looks at the constraints that wait for a side, which has just moved.
    pub(super) fn put_in_force(&self, trail: &mut Trail, side: Side) -> Result<(), Conflict> {
        for id in self.waiting.iter(side) {
            self.check(trail, id)?;
        }
        Ok(())
    }

    /// Returns whether any constraint leads from a side.
    pub(super) fn leads_on(&self, side: Side) -> bool {
        !self.from.is_empty(side)
    }

    /// Returns whether the least times satisfy all constraints in force between times that exist.
    pub(crate) fn are_satisfied(&self, trail: &Trail) -> bool {
        let value = |side: Side| {
            let least = trail.least(side.variable());
            if side == side.variable().upper() { least } else { -least }
        };
        self.all.iter().all(|difference| {
            let Difference { from, to, weight, when } = *difference;
            !trail.holds(when)
                || !trail.holds(trail.presence(to.variable()))
                || value(to) <= value(from) + weight
        })
    }

    /// The constraints of a negative cycle that was kept.
    pub(super) fn cycle(&self, id: CycleId) -> &[DifferenceId] {
        &self.cycles[id]
    }

    /// Returns how much room the constraints that wait for a literal leave: the least of them all.
    pub(crate) fn slack(&self, trail: &Trail, when: Literal) -> i64 {
        let room = self.waiting.iter(when.side).map(|id| {
            let Difference { from, to, weight, .. } = self.all[id];
            trail.bound(from) + weight + trail.bound(to.opposite())
        });
        room.min().unwrap_or(i64::MAX)
    }

    /// Begins a propagation.
    pub(crate) fn begin(&mut self) {
        self.pending.clear();
        for side in self.moved.drain(..) {
            self.movements[side] = Movement::default();
        }
    }

    /// Looks at one step as if its source had just moved.
    pub(crate) fn check(&self, trail: &mut Trail, id: DifferenceId) -> Result<(), Conflict> {
        let difference = &self.all[id];
        carry(trail, trail.bound(difference.from), id, difference)
    }

    /// Looks at the constraints that an event puts in force, and lets its bound wait to be carried on.
    pub(crate) fn moved(&mut self, trail: &mut Trail, event: EventId) -> Result<(), Conflict> {
        let side = trail.events[event].side;
        self.put_in_force(trail, side)?;
        if !self.leads_on(side) {
            return Ok(());
        }
        let trail::Event { most, before, .. } = trail.events[event];
        let movement = &mut self.movements[side];
        if !std::mem::replace(&mut movement.has_moved, true) {
            movement.before = before;
            self.moved.push(side);
        }
        self.pending.push((movement.before.saturating_sub(most), Reverse(event)));
        Ok(())
    }

    /// Carries on the bound that has moved furthest. `false` if none waits.
    pub(crate) fn propagate(&mut self, trail: &mut Trail) -> Result<bool, Conflict> {
        while let Some((_, Reverse(event))) = self.pending.pop() {
            let side = trail.events[event].side;
            // A later event of the same side carries more.
            let bound = trail.bound(side);
            if bound < trail.events[event].most {
                continue;
            }
            let times = &mut self.movements[side].times;
            *times += 1;
            if times.is_multiple_of(MOVES_BEFORE_CYCLE)
                && let Some(mut reason) = self.negative_cycle(trail, event)
            {
                let presence = trail.presence(side.variable());
                if trail.holds(presence) {
                    reason.push(presence);
                    return Err(reason);
                }
                let cause = trail.note(reason);
                trail.set(!presence, cause)?;
                return Ok(true);
            }
            self.carry_on(trail, side)?;
            return Ok(true);
        }
        Ok(false)
    }

    /// Why a literal holds that a difference is the cause of, or is refuted by.
    pub(crate) fn explain(&self, trail: &Trail, literal: Literal, id: DifferenceId, reason: &mut Conflict) {
        let Difference { from, weight, when, .. } = self.all[id];
        reason.push(Literal::new(from, literal.most - weight));
        if when != Literal::TRUE {
            reason.push(when);
        }
        debug_assert!(trail.holds(Literal::new(from, literal.most - weight)), "it was carried");
    }

    pub(crate) fn explain_refuted(
        &self,
        trail: &Trail,
        id: DifferenceId,
        at: EventId,
        reason: &mut Conflict,
    ) {
        let Difference { from, to, weight, .. } = self.all[id];
        let bound = trail.bound_before(from, at);
        // The target must reach at least one more than what the source allows.
        reason.push(Literal::new(from, bound));
        reason.push(!Literal::new(to, bound + weight));
    }

    /// The literals of a cycle that the last moves of a bound went along.
    fn negative_cycle(&mut self, trail: &mut Trail, event: EventId) -> Option<Conflict> {
        let start = trail.events[event].side;
        let (mut at, mut most) = (event, trail.events[event].most);
        let (mut reason, mut cycle) = (Vec::new(), Vec::new());
        for _ in 0..self.movements.len() {
            let Cause::Difference(id) = trail.events[at].cause else { return None };
            let Difference { from, weight, when, .. } = self.all[id];
            if when != Literal::TRUE {
                reason.push(when);
            }
            cycle.extend(self.keeps_cycles.then_some(id));
            most -= weight;
            at = trail.implying_event(Literal::new(from, most))?;
            if from == start {
                if self.keeps_cycles {
                    trail.premise = Premise::Cycle(self.cycles.push_and_get_key(cycle));
                }
                return Some(reason);
            }
        }
        None
    }
}

fn carry(
    trail: &mut Trail,
    bound: i64,
    id: DifferenceId,
    &Difference { to, weight, when, .. }: &Difference,
) -> Result<(), Conflict> {
    let most = bound + weight;
    if most >= trail.bound(to) {
        return Ok(());
    }
    if when == Literal::TRUE || trail.holds(when) {
        return trail.set(Literal::new(to, most), Cause::Difference(id));
    }
    if most < -trail.bound(to.opposite()) {
        return trail.set(!when, Cause::Refuted(id));
    }
    Ok(())
}
