//! The graph of ordinary and lower-case edges, with a feasible potential that is kept while edges come and go.
//!
//! A potential is feasible if `potential[from] + weight ≥ potential[to]` for every arc. It exists exactly if there is no
//! negative cycle; it makes Dijkstra searches possible in spite of negative weights (Johnson, 1977); and an arc that
//! breaks it is repaired by raising what must rise (Cotton and Maler, 2006). Taking arcs back keeps it feasible.

use crate::heap::Heap;

pub(crate) const NONE: u32 = u32::MAX;

/// What an arc stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// An ordinary constraint of the network.
    Edge(u32),
    /// The lower case of a contingent link.
    Lower(u32),
    /// A path to the link's end, followed by its upper case; `node` is where the path starts.
    Bypass { link: u32, node: u32 },
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub(crate) weight: i64,
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) next_in: u32,
    pub(crate) origin: Origin,
}

/// Why a potential cannot be repaired.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Contradiction {
    /// [`Graph::cycle`] has the arcs of a negative cycle.
    NegativeCycle,
    Overflow,
}

#[derive(Clone, Copy, Debug)]
struct Reach {
    /// By how much the point must rise, negative, valid where `stamp` is the current one.
    rise: i64,
    /// The arc that makes it rise.
    parent: u32,
    stamp: u32,
    done: u32,
}

const NEVER: Reach = Reach { rise: 0, parent: NONE, stamp: 0, done: 0 };

#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    pub(crate) arcs: Vec<Arc>,
    pub(crate) first_in: Vec<u32>,
    pub(crate) potential: Vec<i64>,
    /// The arcs of the last negative cycle, in order.
    pub(crate) cycle: Vec<u32>,
    reach: Vec<Reach>,
    now: u32,
    heap: Heap,
    changed: Vec<(u32, i64)>,
}

impl Graph {
    pub(crate) fn resize(&mut self, points: usize) {
        self.first_in.resize(points, NONE);
        self.potential.resize(points, 0);
        self.reach.resize(points, NEVER);
    }

    /// Adds an arc without repairing the potential.
    pub(crate) fn push(&mut self, from: u32, to: u32, weight: i64, origin: Origin) {
        let first = &mut self.first_in[to as usize];
        self.arcs.push(Arc { weight, from, to, next_in: *first, origin });
        *first = self.arcs.len() as u32 - 1;
    }

    /// Takes back all arcs but the first `arcs`.
    pub(crate) fn truncate(&mut self, arcs: usize) {
        while self.arcs.len() > arcs {
            if let Some(arc) = self.arcs.pop() {
                self.first_in[arc.to as usize] = arc.next_in;
            }
        }
    }

    /// The arcs that end at a point.
    pub(crate) fn arcs_into(&self, point: u32) -> impl Iterator<Item = (u32, &Arc)> {
        let mut next = self.first_in[point as usize];
        std::iter::from_fn(move || {
            let arc = self.arcs.get(next as usize)?;
            let id = std::mem::replace(&mut next, arc.next_in);
            Some((id, arc))
        })
    }

    /// Makes the potential feasible again after the arcs from `first` on were pushed, which all end at one point.
    /// On failure the potential is as before; the arcs stay, to be taken back.
    pub(crate) fn repair(&mut self, first: usize) -> Result<(), Contradiction> {
        let Some(target) = self.arcs.get(first).map(|arc| arc.to) else { return Ok(()) };
        self.changed.clear();
        self.heap.clear();
        self.next_stamp();
        let now = self.now;
        let result = (|| {
            for id in first..self.arcs.len() {
                let arc = self.arcs[id];
                self.pull(id as u32, arc, target)?;
            }
            while let Some((rise, point)) = self.heap.pop() {
                let reach = &mut self.reach[point as usize];
                if reach.done == now || reach.rise != rise {
                    continue;
                }
                reach.done = now;
                let old = self.potential[point as usize];
                let new = old.checked_sub(rise).ok_or(Contradiction::Overflow)?;
                self.potential[point as usize] = new;
                self.changed.push((point, old));
                let mut next = self.first_in[point as usize];
                while next != NONE {
                    let arc = self.arcs[next as usize];
                    self.pull(next, arc, target)?;
                    next = arc.next_in;
                }
            }
            Ok(())
        })();
        if result.is_err() {
            while let Some((point, potential)) = self.changed.pop() {
                self.potential[point as usize] = potential;
            }
        }
        result
    }

    /// Notes by how much an arc makes its start rise.
    fn pull(&mut self, id: u32, arc: Arc, target: u32) -> Result<(), Contradiction> {
        let time = self.potential[arc.to as usize].checked_sub(arc.weight);
        let rise = time.and_then(|time| self.potential[arc.from as usize].checked_sub(time));
        let rise = rise.ok_or(Contradiction::Overflow)?;
        if rise >= 0 {
            return Ok(());
        }
        let reach = &mut self.reach[arc.from as usize];
        if reach.done == self.now || (reach.stamp == self.now && reach.rise <= rise) {
            return Ok(());
        }
        (reach.rise, reach.stamp, reach.parent) = (rise, self.now, id);
        if arc.from == target {
            self.collect_cycle(target);
            return Err(Contradiction::NegativeCycle);
        }
        self.heap.push(rise, arc.from);
        Ok(())
    }

    fn collect_cycle(&mut self, start: u32) {
        self.cycle.clear();
        let mut point = start;
        loop {
            let parent = self.reach[point as usize].parent;
            self.cycle.push(parent);
            point = self.arcs[parent as usize].to;
            if point == start {
                break;
            }
        }
    }

    /// Makes the potential feasible after any number of arcs were pushed: sweeps to and fro over the points, whose
    /// order mostly follows time. `O(points · arcs)` at worst, a handful of sweeps as a rule.
    pub(crate) fn repair_all(&mut self) -> Result<(), Contradiction> {
        let points = self.potential.len() as u32;
        let mut is_open = vec![true; points as usize];
        self.reach.iter_mut().for_each(|reach| reach.parent = NONE);
        let (mut sweeps, mut next_check) = (0_u32, 3);
        loop {
            let mut moved = false;
            for index in 0..points {
                let point = if sweeps.is_multiple_of(2) { index } else { points - 1 - index };
                if !std::mem::take(&mut is_open[point as usize]) {
                    continue;
                }
                let mut next = self.first_in[point as usize];
                while next != NONE {
                    let arc = self.arcs[next as usize];
                    let time = self.potential[point as usize].checked_sub(arc.weight);
                    let time = time.ok_or(Contradiction::Overflow)?;
                    if time > self.potential[arc.from as usize] {
                        self.potential[arc.from as usize] = time;
                        self.reach[arc.from as usize].parent = next;
                        is_open[arc.from as usize] = true;
                        moved = true;
                    }
                    next = arc.next_in;
                }
            }
            if !moved {
                return Ok(());
            }
            sweeps += 1;
            if sweeps >= next_check {
                next_check = sweeps + 1 + sweeps / 2;
                if let Some(point) = self.find_parent_cycle() {
                    self.collect_cycle(point);
                    return Err(Contradiction::NegativeCycle);
                }
            }
        }
    }

    /// A point on a cycle of parents: there is one, sooner or later, exactly if there is a negative cycle.
    fn find_parent_cycle(&self) -> Option<u32> {
        let mut walk_of = vec![NONE; self.potential.len()];
        for start in 0..self.potential.len() as u32 {
            let mut point = start;
            while walk_of[point as usize] == NONE {
                walk_of[point as usize] = start;
                let parent = self.reach[point as usize].parent;
                if parent == NONE {
                    break;
                }
                point = self.arcs[parent as usize].to;
            }
            if walk_of[point as usize] == start && self.reach[point as usize].parent != NONE {
                return Some(point);
            }
        }
        None
    }

    fn next_stamp(&mut self) {
        if self.now == u32::MAX {
            self.reach.fill(NEVER);
            self.now = 0;
        }
        self.now += 1;
    }
}
