//! Propagation of one new edge, and the negative cycle that it closes if it contradicts.
//!
//! The algorithm is Cotton and Maler's (Fast and flexible difference constraint propagation for DPLL(T), 2006): a
//! feasible potential is repaired by a Dijkstra search that visits only the points whose potential must rise.

use crate::network::{CycleEdge, Inconsistency, NONE, Overflow, PointId, Stn, Tag};

/// How propagation reaches a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// By how much the point must rise, negative, valid where `stamp` is the current one.
    rise: i64,
    /// The edge that makes it rise.
    pub(crate) parent: u32,
    stamp: u32,
    /// The propagation that it has risen in last.
    done: u32,
    /// The walk that has come by last.
    visit: u32,
}

impl Reach {
    pub(crate) const NEVER: Self = Self { rise: 0, parent: NONE, stamp: 0, done: 0, visit: 0 };
}

impl Stn {
    /// Raises points of the schedule until the edge that is about to be inserted holds, or finds the cycle it closes.
    ///
    /// Raising what comes later is cheap where lowering is not: a plan's start has constraints with everything, so
    /// that lowering one thread of it drags along all others.
    pub(crate) fn repair(&mut self, from: u32, to: u32, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        self.changed.clear();
        let reached = self.potential[to as usize].checked_sub(weight).ok_or(Overflow::at(from as usize))?;
        // Kept negative, so that the heap has the point that must rise furthest first.
        let rise = self.potential[from as usize].checked_sub(reached).ok_or(Overflow::at(from as usize))?;
        if rise >= 0 {
            return Ok(());
        }
        let new_edge = CycleEdge { from: PointId(from), to: PointId(to), weight, tag };
        if from == to {
            self.cycle.clear();
            self.cycle.push(new_edge);
            return Err(Inconsistency::NegativeCycle);
        }
        self.next_stamp();
        let now = self.now;
        self.heap.clear();
        self.level.clear();
        let start = &mut self.reach[from as usize];
        (start.rise, start.stamp, start.parent) = (rise, now, NONE);
        self.level.push(from);
        let mut present = rise;
        while let Some((rise, point)) =
            self.level.pop().map(|point| (present, point)).or_else(|| self.heap.pop())
        {
            present = rise;
            let reach = &mut self.reach[point as usize];
            if reach.done == now || reach.rise != rise {
                continue;
            }
            reach.done = now;
            let potential = &mut self.potential[point as usize];
            let old = *potential;
            let Some(new) = old.checked_sub(rise) else {
                self.restore();
                return Err(Overflow::at(point as usize).into());
            };
            *potential = new;
            self.changed.push((point, old));
            let mut next = self.first_in[point as usize];
            while next != NONE {
                let edge = &self.edges[next as usize];
                let (position, source) = (next, edge.from);
                next = edge.next_in;
                let time = new.checked_sub(edge.weight);
                let rise = time.and_then(|time| self.potential[source as usize].checked_sub(time));
                let Some(rise) = rise else {
                    self.restore();
                    return Err(Overflow::at(source as usize).into());
                };
                if rise >= 0 {
                    continue;
                }
                let reach = &mut self.reach[source as usize];
                if reach.done == now || (reach.stamp == now && reach.rise <= rise) {
                    continue;
                }
                (reach.rise, reach.stamp, reach.parent) = (rise, now, position);
                if source == to {
                    self.collect_cycle(new_edge);
                    self.restore();
                    return Err(Inconsistency::NegativeCycle);
                }
                if self.origin == Some(source) && self.hangs_on(to, source) {
                    self.collect_cycle_through(source, new_edge);
                    self.restore();
                    return Err(Inconsistency::NegativeCycle);
                }
                // What is tightly bound rises as one piece: most points take this way past the heap.
                if rise == present {
                    self.level.push(source);
                } else {
                    self.heap.push(rise, source);
                }
            }
        }
        Ok(())
    }

    fn collect_cycle(&mut self, new_edge: CycleEdge) {
        self.cycle.clear();
        self.cycle.push(new_edge);
        let mut point = new_edge.to.0;
        while point != new_edge.from.0 {
            let edge = self.edges[self.reach[point as usize].parent as usize];
            self.cycle.push(edge.describe());
            point = edge.to;
        }
    }

    /// Whether constraints without slack keep `point` from being earlier unless `origin` is. Then `walk` has them, the
    /// one at the origin last, and `point` cannot stay where it is if the origin rises.
    fn hangs_on(&mut self, point: u32, origin: u32) -> bool {
        // Points that have risen already have left their constraints behind.
        if self.reach[point as usize].done == self.now {
            return false;
        }
        self.walk.clear();
        self.scratch.clear();
        self.scratch.push(i64::from(self.first_out[point as usize]));
        let mark = self.next_visit();
        self.reach[point as usize].visit = mark;
        while let Some(next) = self.scratch.last_mut() {
            let position = *next as u32;
            if position == NONE {
                self.scratch.pop();
                self.walk.pop();
                continue;
            }
            let edge = self.edges[position as usize];
            *next = i64::from(edge.next_out);
            let target = edge.to as usize;
            let is_tight =
                self.potential[edge.from as usize].checked_add(edge.weight) == Some(self.potential[target]);
            let reach = &mut self.reach[target];
            if !is_tight || reach.visit == mark || reach.done == self.now {
                continue;
            }
            self.walk.push(position);
            if edge.to == origin {
                return true;
            }
            reach.visit = mark;
            self.scratch.push(i64::from(self.first_out[target]));
        }
        false
    }

    /// The new edge, the walk from its end to the origin, and the parents from there to its start.
    fn collect_cycle_through(&mut self, origin: u32, new_edge: CycleEdge) {
        self.cycle.clear();
        self.cycle.push(new_edge);
        for &position in &self.walk {
            self.cycle.push(self.edges[position as usize].describe());
        }
        let mut point = origin;
        while point != new_edge.from.0 {
            let edge = self.edges[self.reach[point as usize].parent as usize];
            self.cycle.push(edge.describe());
            point = edge.to;
        }
    }

    fn next_visit(&mut self) -> u32 {
        if self.visits == u32::MAX {
            self.reach.iter_mut().for_each(|reach| reach.visit = 0);
            self.visits = 0;
        }
        self.visits += 1;
        self.visits
    }

    pub(crate) fn restore(&mut self) {
        while let Some((point, potential)) = self.changed.pop() {
            self.potential[point as usize] = potential;
        }
    }

    fn next_stamp(&mut self) {
        if self.now == u32::MAX {
            self.reach.iter_mut().for_each(|reach| (reach.stamp, reach.done) = (0, 0));
            self.now = 0;
        }
        self.now += 1;
    }
}
