//! The network itself: flat storage, insertion with incremental consistency, undo, and negative cycles.
//!
//! The algorithm is Cotton and Maler's (Fast and flexible difference constraint propagation for DPLL(T), 2006): a
//! feasible potential is repaired by a Dijkstra search that visits only the points whose potential must rise.
//! Removing edges keeps a potential feasible, so undo only takes edges back: the edge list is the trail.

use crate::heap::Heap;

/// A time point of the network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PointId(pub u32);

impl PointId {
    /// The position in vectors indexed by time point.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// What the caller calls a constraint; negative cycles are told in tags.
pub type Tag = u32;

/// How many edges there were at some moment; see [`Stn::rollback`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Checkpoint(u32);

/// Why a constraint could not be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inconsistency {
    /// It closes a cycle of negative weight: [`Stn::cycle`] has it.
    NegativeCycle,
    /// A distance does not fit into 64 bits.
    Overflow,
}

/// A distance does not fit into 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow;

impl std::fmt::Display for Overflow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a time does not fit into 64 bits")
    }
}

impl std::error::Error for Overflow {}

/// One edge of a negative cycle: `to − from ≤ weight`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CycleEdge {
    /// The earlier end of the edge.
    pub from: PointId,
    /// The later end of the edge.
    pub to: PointId,
    /// Its weight.
    pub weight: i64,
    /// The tag it was inserted with.
    pub tag: Tag,
}

/// When a time point may happen, relative to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// At the earliest; `None` if not bounded.
    pub earliest: Option<i64>,
    /// At the latest; `None` if not bounded.
    pub latest: Option<i64>,
}

pub(crate) const NONE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) weight: i64,
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) next_out: u32,
    pub(crate) next_in: u32,
    pub(crate) tag: Tag,
    /// Whether it was taken back out of turn: then its place in the order of insertion is empty.
    is_withdrawn: bool,
}

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
    const NEVER: Self = Self { rise: 0, parent: NONE, stamp: 0, done: 0, visit: 0 };
}

/// A simple temporal network that is consistent at all times, except between [`Stn::push`] and [`Stn::settle`].
#[derive(Clone, Debug, Default)]
pub struct Stn {
    pub(crate) edges: Vec<Edge>,
    pub(crate) first_out: Vec<u32>,
    pub(crate) first_in: Vec<u32>,
    /// Feasible: `potential[from] + weight ≥ potential[to]` for every edge. It is also a schedule.
    pub(crate) potential: Vec<i64>,
    pub(crate) cycle: Vec<CycleEdge>,
    pub(crate) heap: Heap,
    /// Points that must rise exactly as far as the one that is being raised, and so come before all in `heap`.
    level: Vec<u32>,
    pub(crate) reach: Vec<Reach>,
    now: u32,
    changed: Vec<(u32, i64)>,
    /// Room for what several insertions moved.
    moved: Vec<(u32, i64)>,
    origin: Option<u32>,
    walk: Vec<u32>,
    visits: u32,
    pub(crate) scratch: Vec<i64>,
    pub(crate) dirty: Vec<bool>,
}

impl Stn {
    /// A network of `points` time points without constraints.
    pub fn new(points: usize) -> Self {
        let mut stn = Self::default();
        stn.resize(points);
        stn
    }

    /// Adds time points until there are `points`.
    pub fn resize(&mut self, points: usize) {
        self.first_out.resize(points, NONE);
        self.first_in.resize(points, NONE);
        self.potential.resize(points, 0);
        self.reach.resize(points, Reach::NEVER);
        self.dirty.resize(points, false);
    }

    /// Makes room for `edges` more edges, so that inserting them does not allocate.
    pub fn reserve(&mut self, edges: usize) {
        self.edges.reserve(edges);
        // More than this rarely moves at once.
        let points = self.num_points().min(64);
        self.level.reserve(points);
        self.changed.reserve(points);
    }

    /// Becomes a copy of another network and of its schedule, in which everything has one tag.
    pub fn copy_as(&mut self, other: &Self, tag: Tag) {
        self.clone_from(other);
        for edge in &mut self.edges {
            edge.tag = tag;
        }
    }

    /// How many time points there are.
    pub fn num_points(&self) -> usize {
        self.potential.len()
    }

    /// How many edges there are, with those withdrawn.
    pub fn num_edges(&self) -> usize {
        self.edges.len()
    }

    /// A schedule that keeps every constraint: one consistent time per point, of no particular origin.
    pub fn schedule(&self) -> &[i64] {
        &self.potential
    }

    /// Names the point that everything else hangs on, so that contradictions that drag it along are recognized at once
    /// where the other side is bound to it. Answers do not depend on it.
    pub fn set_origin(&mut self, origin: PointId) {
        self.origin = Some(origin.0);
    }

    /// Gives a point without constraints a place in the schedule, so that inserting its constraints moves little.
    /// Does nothing for a point that has constraints.
    pub fn set_free_time(&mut self, point: PointId, time: i64) {
        if self.first_out[point.index()] == NONE && self.first_in[point.index()] == NONE {
            self.potential[point.index()] = time;
        }
    }

    /// How many points moved in the last insertion; twice what two of its edges moved.
    pub fn num_changed(&self) -> usize {
        self.changed.len()
    }

    /// An edge, by position; `None` if it has been withdrawn.
    pub fn edge(&self, position: usize) -> Option<CycleEdge> {
        self.edges.get(position).filter(|edge| !edge.is_withdrawn).map(Edge::describe)
    }

    /// The negative cycle of the last failed insertion, in order; each edge's `to` is the next one's `from`.
    pub fn cycle(&self) -> &[CycleEdge] {
        &self.cycle
    }

    /// A place to come back to with [`Stn::rollback`].
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint(self.edges.len() as u32)
    }

    /// Takes back every edge inserted since `checkpoint`, in time linear in their number.
    pub fn rollback(&mut self, checkpoint: Checkpoint) {
        while self.edges.len() > checkpoint.0 as usize {
            let Some(edge) = self.edges.pop() else { return };
            if !edge.is_withdrawn {
                self.first_out[edge.from as usize] = edge.next_out;
                self.first_in[edge.to as usize] = edge.next_in;
            }
        }
    }

    /// Takes back one edge wherever it stands in the order of insertion, in time linear in the edges at its ends.
    /// Positions are those of [`Stn::num_edges`] before the insertion; they stay what they are, also for rolling back.
    pub fn withdraw(&mut self, position: usize) {
        let Some(&edge) = self.edges.get(position).filter(|edge| !edge.is_withdrawn) else { return };
        self.edges[position].is_withdrawn = true;
        let position = position as u32;
        let mut before = NONE;
        let mut at = self.first_out[edge.from as usize];
        while at != position {
            (before, at) = (at, self.edges[at as usize].next_out);
        }
        if before == NONE {
            self.first_out[edge.from as usize] = edge.next_out;
        } else {
            self.edges[before as usize].next_out = edge.next_out;
        }
        (before, at) = (NONE, self.first_in[edge.to as usize]);
        while at != position {
            (before, at) = (at, self.edges[at as usize].next_in);
        }
        if before == NONE {
            self.first_in[edge.to as usize] = edge.next_in;
        } else {
            self.edges[before as usize].next_in = edge.next_in;
        }
    }

    /// Adds `lower ≤ to − from ≤ upper`; `None` is no upper bound. On failure nothing has changed.
    pub fn constrain(
        &mut self,
        from: PointId,
        to: PointId,
        lower: i64,
        upper: Option<i64>,
        tag: Tag,
    ) -> Result<(), Inconsistency> {
        let checkpoint = self.checkpoint();
        if let Some(upper) = upper {
            self.insert(from, to, upper, tag)?;
        }
        let result = lower.checked_neg().ok_or(Inconsistency::Overflow);
        let result = result.and_then(|weight| self.insert(to, from, weight, tag));
        if result.is_err() {
            self.rollback(checkpoint);
        }
        result
    }

    /// Adds `to − from ≤ weight` and restores consistency. On failure the edge is not inserted.
    ///
    /// Takes `O(k log k + edges at k points)` time for the `k` points that must move.
    pub fn insert(&mut self, from: PointId, to: PointId, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        self.repair(from.0, to.0, weight, tag)?;
        self.push(from, to, weight, tag);
        Ok(())
    }

    /// Whether `to − from ≤ weight` could be added. The network stays as it is; if not, [`Stn::cycle`] says why.
    pub fn admits(&mut self, from: PointId, to: PointId, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        // The repaired potential is feasible for the edges that are there, too, but is undone: a query that moved the
        // schedule would make later answers cost differently for no reason.
        self.repair(from.0, to.0, weight, tag)?;
        self.restore();
        Ok(())
    }

    /// Adds `to − from ≤ weight` for all `edges` or, if they contradict, for none; then the schedule stays as it is, too.
    pub fn insert_all(&mut self, edges: &[(PointId, PointId, i64)], tag: Tag) -> Result<(), Inconsistency> {
        let checkpoint = self.checkpoint();
        let mut moved = std::mem::take(&mut self.moved);
        moved.clear();
        for &(from, to, weight) in edges {
            if let Err(reason) = self.insert(from, to, weight, tag) {
                self.rollback(checkpoint);
                self.moved = std::mem::replace(&mut self.changed, moved);
                self.restore();
                return Err(reason);
            }
            moved.append(&mut self.changed);
        }
        self.moved = std::mem::replace(&mut self.changed, moved);
        Ok(())
    }

    /// Whether [`Stn::insert_all`] could add `edges`. If so, the schedule is one that keeps them.
    pub fn admits_all(&mut self, edges: &[(PointId, PointId, i64)], tag: Tag) -> Result<(), Inconsistency> {
        let checkpoint = self.checkpoint();
        self.insert_all(edges, tag)?;
        self.rollback(checkpoint);
        Ok(())
    }

    /// Adds an edge without restoring consistency: [`Stn::settle`] must follow before anything else is asked.
    pub fn push(&mut self, from: PointId, to: PointId, weight: i64, tag: Tag) {
        let position = self.edges.len() as u32;
        let (first_out, first_in) = (&mut self.first_out[from.index()], &mut self.first_in[to.index()]);
        self.edges.push(Edge {
            weight,
            from: from.0,
            to: to.0,
            next_out: *first_out,
            next_in: *first_in,
            tag,
            is_withdrawn: false,
        });
        *first_out = position;
        *first_in = position;
    }

    /// Raises points of the schedule until the edge that is about to be inserted holds, or finds the cycle it closes.
    ///
    /// Raising what comes later is cheap where lowering is not: a plan's start has constraints with everything, so
    /// that lowering one thread of it drags along all others.
    fn repair(&mut self, from: u32, to: u32, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        self.changed.clear();
        let reached = self.potential[to as usize].checked_sub(weight).ok_or(Inconsistency::Overflow)?;
        // Kept negative, so that the heap has the point that must rise furthest first.
        let rise = self.potential[from as usize].checked_sub(reached).ok_or(Inconsistency::Overflow)?;
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
                return Err(Inconsistency::Overflow);
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
                    return Err(Inconsistency::Overflow);
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

    fn restore(&mut self) {
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

impl Edge {
    pub(crate) fn describe(&self) -> CycleEdge {
        CycleEdge { from: PointId(self.from), to: PointId(self.to), weight: self.weight, tag: self.tag }
    }
}
