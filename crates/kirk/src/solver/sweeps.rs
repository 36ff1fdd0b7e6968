//! Carrying many bounds on at once: along the network's order, to and fro. Where bounds move in many places, each of them
//! then moves few times; carried on one by one, those further on move once for each of the others.

use std::ops::Range;

use typed_index_collections::TiVec;

use super::difference::Differences;
use super::literal::{Side, Variable};
use super::trail::{Conflict, Trail};
use crate::ids::EventId;

/// Bounds that move more often along the whole network are left to propagation one by one.
const MAX_SWEEPS: usize = 32;

/// The times in the network's order, and which of their bounds have to be carried on.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweeps {
    points: Vec<Variable>,
    positions: TiVec<Variable, Option<u32>>,
    waits: TiVec<Side, bool>,
    num_waiting: usize,
    /// Where those are that wait: between these positions.
    reach: (usize, usize),
    /// The events whose bounds need not be carried on, for all bounds are settled that they move: those that hold whatever
    /// is decided, and those of the last decisions that were made at once.
    settled: [Range<usize>; 2],
}

impl Sweeps {
    /// Times in an order in which most constraints lead forward.
    pub(super) fn set_points(&mut self, points: Vec<Variable>, num_variables: usize) {
        self.positions = vec![None; num_variables].into();
        self.waits = vec![false; 2 * num_variables].into();
        for (position, &point) in points.iter().enumerate() {
            self.positions[point] = Some(position as u32);
        }
        self.points = points;
    }

    /// Returns whether the bound of an event need not be carried on.
    pub(super) fn is_settled(&self, event: usize) -> bool {
        self.settled.iter().any(|settled| settled.contains(&event))
    }

    /// Events are taken back.
    pub(super) fn forget(&mut self) {
        self.settled[1] = 0..0;
    }

    /// Looks at what an event puts in force, and lets its bound wait. `false` if its variable has no place in the order.
    fn look_at(
        &mut self,
        differences: &Differences,
        trail: &mut Trail,
        event: EventId,
    ) -> Result<bool, Conflict> {
        let side = trail.events[event].side;
        differences.put_in_force(trail, side)?;
        if !differences.leads_on(side) {
            return Ok(true);
        }
        let position = self.positions.get(side.variable()).copied().flatten();
        let Some(position) = position else { return Ok(false) };
        self.wait(side, position as usize);
        Ok(true)
    }

    fn wait(&mut self, side: Side, position: usize) {
        if !std::mem::replace(&mut self.waits[side], true) {
            self.num_waiting += 1;
            self.reach = (self.reach.0.min(position), self.reach.1.max(position));
        }
    }

    /// Lets nothing wait any more.
    fn clear(&mut self) {
        if std::mem::take(&mut self.num_waiting) > 0 {
            self.waits.iter_mut().for_each(|waits| *waits = false);
        }
        self.reach = (usize::MAX, 0);
    }

    /// Carries on what waits and the events since `next`. Whether all bounds are settled.
    fn run(
        &mut self,
        differences: &Differences,
        trail: &mut Trail,
        mut next: usize,
    ) -> Result<bool, Conflict> {
        let mut catch_up = |sweeps: &mut Self, trail: &mut Trail| -> Result<bool, Conflict> {
            while next < trail.events.len() {
                if !sweeps.look_at(differences, trail, EventId::from(next))? {
                    return Ok(false);
                }
                next += 1;
            }
            Ok(true)
        };
        if !catch_up(self, trail)? {
            return Ok(false);
        }
        for sweep in 0..MAX_SWEEPS {
            if self.num_waiting == 0 {
                return Ok(true);
            }
            let is_forward = sweep % 2 == 0;
            let (mut first, mut last) = std::mem::replace(&mut self.reach, (usize::MAX, 0));
            while first <= last {
                let position = if is_forward { first } else { last };
                let point = self.points[position];
                for side in [point.lower(), point.upper()] {
                    if std::mem::take(&mut self.waits[side]) {
                        self.num_waiting -= 1;
                        differences.carry_on(trail, side)?;
                        if !catch_up(self, trail)? {
                            return Ok(false);
                        }
                    }
                }
                // What was moved further on is on the way.
                if is_forward {
                    (first, last) = (position + 1, last.max(self.reach.1));
                } else if position == 0 {
                    break;
                } else {
                    (first, last) = (first.min(self.reach.0), position - 1);
                }
            }
        }
        Ok(self.num_waiting == 0)
    }

    /// Carries on all bounds. At the root.
    pub(super) fn sweep_all(&mut self, differences: &Differences, trail: &mut Trail) -> Result<(), Conflict> {
        let first = trail.events.len();
        self.clear();
        for position in 0..self.points.len() {
            let point = self.points[position];
            for side in [point.lower(), point.upper()] {
                self.wait(side, position);
            }
        }
        let settled = self.run(differences, trail, first);
        self.clear();
        if settled? {
            self.settled[0] = first..trail.events.len();
        }
        Ok(())
    }

    /// Carries on the bounds of the events from `first` on, which have not been propagated to the theories yet.
    pub(super) fn sweep_new(
        &mut self,
        differences: &Differences,
        trail: &mut Trail,
        first: usize,
    ) -> Result<(), Conflict> {
        self.waits.resize(2 * trail.num_variables(), false);
        self.clear();
        let settled = self.run(differences, trail, first);
        self.clear();
        if settled? {
            self.settled[1] = first..trail.events.len();
        }
        Ok(())
    }
}
