//! Consistency of many edges at once, by sweeps in an order that the caller knows to fit the network.
//!
//! Missions are nested: in the order of their nesting most constraints run forwards (upper bounds) or backwards (lower
//! bounds) along it, so that sweeping to and fro settles the network in a handful of passes.

use crate::network::{Inconsistency, NONE, Overflow, PointId, Stn};

impl Stn {
    /// Restores consistency after any number of [`Stn::push`]es. `order` lists the points that have edges, once each,
    /// in an order that suits the network (any order is correct). On failure [`Stn::cycle`] has a negative cycle and
    /// the caller must [`Stn::rollback`] to a state that was consistent and settle again.
    ///
    /// Takes `O(edges)` per sweep; the number of sweeps is at most the number of points.
    pub fn settle(&mut self, order: &[PointId]) -> Result<(), Inconsistency> {
        for &point in order {
            self.dirty[point.index()] = true;
            self.reach[point.index()].parent = NONE;
        }
        let mut sweeps = 0_usize;
        let mut next_check = 3;
        loop {
            let moved = if sweeps.is_multiple_of(2) {
                self.sweep(order.iter())
            } else {
                self.sweep(order.iter().rev())
            };
            match moved {
                Ok(true) => {}
                Ok(false) => return Ok(()),
                Err(overflow) => {
                    self.clear_dirty(order);
                    return Err(overflow);
                }
            }
            sweeps += 1;
            if sweeps >= next_check {
                next_check = sweeps + 1 + sweeps / 2;
                if self.find_parent_cycle(order) {
                    self.clear_dirty(order);
                    return Err(Inconsistency::NegativeCycle);
                }
            }
        }
    }

    /// Forgets all edges and starts the potential again.
    pub fn clear(&mut self) {
        self.edges.clear();
        self.first_out.fill(NONE);
        self.first_in.fill(NONE);
        self.potential.fill(0);
    }

    /// Proposes a time for each point, so that [`Stn::settle`] moves little. Answers do not depend on it.
    pub fn propose(&mut self, schedule: impl IntoIterator<Item = i64>) {
        for (time, proposed) in self.potential.iter_mut().zip(schedule) {
            *time = proposed;
        }
    }

    /// Returns whether any point is left to relax.
    fn sweep<'a>(&mut self, order: impl Iterator<Item = &'a PointId>) -> Result<bool, Inconsistency> {
        let mut moved = false;
        for &point in order {
            let point = point.index();
            if !self.dirty[point] {
                continue;
            }
            self.dirty[point] = false;
            let time = self.potential[point];
            let mut next = self.first_in[point];
            while next != NONE {
                let edge = self.edges[next as usize];
                let source = edge.from as usize;
                let reached = time.checked_sub(edge.weight).ok_or(Overflow::at(source))?;
                if reached > self.potential[source] {
                    self.potential[source] = reached;
                    self.reach[source].parent = next;
                    self.dirty[source] = true;
                    moved = true;
                }
                next = edge.next_in;
            }
        }
        Ok(moved)
    }

    fn clear_dirty(&mut self, order: &[PointId]) {
        for &point in order {
            self.dirty[point.index()] = false;
        }
    }

    /// Looks for a cycle among the parents: there is one, sooner or later, exactly if the network is inconsistent.
    fn find_parent_cycle(&mut self, order: &[PointId]) -> bool {
        // `scratch` holds the walk that reached a point.
        self.scratch.clear();
        self.scratch.resize(self.num_points(), 0);
        for (walk, &start) in (1_i64..).zip(order) {
            let mut point = start.index();
            while self.scratch[point] == 0 {
                self.scratch[point] = walk;
                let parent = self.reach[point].parent;
                if parent == NONE {
                    break;
                }
                point = self.edges[parent as usize].to as usize;
            }
            if self.scratch[point] == walk && self.reach[point].parent != NONE {
                self.walk.clear();
                self.collect_cycle(point as u32, point as u32);
                return true;
            }
        }
        false
    }
}
