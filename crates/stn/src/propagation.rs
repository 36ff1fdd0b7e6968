//! Propagation of new edges, and the negative cycle that they close if they contradict.
//!
//! The algorithm is Cotton and Maler's (Fast and flexible difference constraint propagation for DPLL(T), 2006): a
//! feasible potential is repaired by a Dijkstra search that visits only the points whose potential must rise.

use crate::network::{Edge, Inconsistency, NONE, Overflow, Stn};

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
    /// Raises points of the schedule until the edges from `first` on hold, which all end at one point, or finds a cycle
    /// that they close. On failure the schedule is as before; the edges stay, to be taken back.
    ///
    /// Raising what comes later is cheap where lowering is not: a plan's start has constraints with everything, so
    /// that lowering one thread of it drags along all others.
    pub(crate) fn repair(&mut self, first: u32) -> Result<(), Inconsistency> {
        self.changed.clear();
        self.heap.clear();
        self.level.clear();
        self.next_stamp();
        let Some(&Edge { to: target, .. }) = self.edges.get(first as usize) else { return Ok(()) };
        let is_one = first as usize + 1 == self.edges.len();
        let mut present = 0;
        for position in first..self.edges.len() as u32 {
            let Edge { from, to, weight, .. } = self.edges[position as usize];
            let rise = self.rise(from, to, weight)?;
            if rise < 0 {
                present = if is_one { rise } else { 0 };
                self.pull((from, position), rise, present, target)?;
            }
        }
        let result = self.raise(target, present);
        if result.is_err() {
            self.restore();
        }
        result
    }

    /// By how much the start of a constraint must rise for it to hold. Negative, so that the heap has the point that must
    /// rise furthest first; not negative if it holds.
    #[inline]
    pub(crate) fn rise(&self, from: u32, to: u32, weight: i64) -> Result<i64, Overflow> {
        let time = self.potential[to as usize].checked_sub(weight);
        let rise = time.and_then(|time| self.potential[from as usize].checked_sub(time));
        rise.ok_or(Overflow::at(from as usize))
    }

    /// Raises what must rise, what must rise furthest first: what `level` has must rise by `present`.
    fn raise(&mut self, target: u32, mut present: i64) -> Result<(), Inconsistency> {
        let now = self.now;
        while let Some((rise, point)) =
            self.level.pop().map(|point| (present, point)).or_else(|| self.heap.pop())
        {
            present = rise;
            let reach = &mut self.reach[point as usize];
            if reach.done == now || reach.rise != rise {
                continue;
            }
            reach.done = now;
            let old = self.potential[point as usize];
            self.potential[point as usize] = old.checked_sub(rise).ok_or(Overflow::at(point as usize))?;
            self.changed.push((point, old));
            let mut next = self.first_in[point as usize];
            while next != NONE {
                let Edge { from, to, weight, next_in, .. } = self.edges[next as usize];
                let rise = self.rise(from, to, weight)?;
                let position = std::mem::replace(&mut next, next_in);
                if rise < 0 {
                    self.pull((from, position), rise, present, target)?;
                }
            }
        }
        Ok(())
    }

    /// Notes that an edge makes its start rise while what must rise by `present` does; the new edges end at `target`.
    #[inline]
    fn pull(
        &mut self,
        (source, position): (u32, u32),
        rise: i64,
        present: i64,
        target: u32,
    ) -> Result<(), Inconsistency> {
        let now = self.now;
        let reach = &mut self.reach[source as usize];
        if reach.done == now || (reach.stamp == now && reach.rise <= rise) {
            return Ok(());
        }
        (reach.rise, reach.stamp, reach.parent) = (rise, now, position);
        if (source == target || self.origin == Some(source)) && self.closes_cycle(source, target) {
            return Err(Inconsistency::NegativeCycle);
        }
        // What is tightly bound rises as one piece: most points take this way past the heap.
        if rise == present {
            self.level.push(source);
        } else {
            self.heap.push(rise, source);
        }
        Ok(())
    }

    /// Returns whether the new edges, which end at `target`, close a negative cycle if `point` rises: then `cycle` has
    /// it.
    #[cold]
    fn closes_cycle(&mut self, point: u32, target: u32) -> bool {
        self.walk.clear();
        let closes = point == target || self.hangs_on(target, point);
        if closes {
            self.collect_cycle(point, target);
            // The new edge first.
            self.cycle.rotate_right(1);
        }
        closes
    }

    /// The walk to `point` and the parents from there to `target`.
    pub(crate) fn collect_cycle(&mut self, mut point: u32, target: u32) {
        self.cycle.clear();
        self.cycle.extend(self.walk.iter().map(|&position| self.edges[position as usize].describe()));
        loop {
            let edge = self.edges[self.reach[point as usize].parent as usize];
            self.cycle.push(edge.describe());
            point = edge.to;
            if point == target {
                break;
            }
        }
    }

    /// Returns whether constraints without slack keep `point` from being earlier unless `origin` is. Then `walk` has
    /// them, the one at the origin last, and `point` cannot stay where it is if the origin rises.
    fn hangs_on(&mut self, point: u32, origin: u32) -> bool {
        // Points that have risen already have left their constraints behind.
        if self.reach[point as usize].done == self.now {
            return false;
        }
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
