//! The network itself: flat storage, insertion with incremental consistency, and undo.
//!
//! Removing edges keeps a potential feasible, so undo only takes edges back: the edge list is the trail.

use crate::heap::Heap;
use crate::propagation::Reach;

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
    Overflow(Overflow),
}

/// A distance does not fit into 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overflow {
    /// The time point whose distance or time it is.
    pub point: PointId,
}

impl Overflow {
    pub(crate) const fn at(point: usize) -> Self {
        Self { point: PointId(point as u32) }
    }
}

impl From<Overflow> for Inconsistency {
    fn from(overflow: Overflow) -> Self {
        Self::Overflow(overflow)
    }
}

impl std::fmt::Display for Overflow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a time is too large to represent exactly")
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

/// A simple temporal network that is consistent at all times, except between [`Stn::push`] and [`Stn::settle`].
///
/// ```
/// use stn::{Inconsistency, PointId, Stn};
///
/// let (start, end) = (PointId(0), PointId(1));
/// let mut network = Stn::new(2);
/// // It takes from 20 to 30; the last argument says where a constraint comes from.
/// assert_eq!(network.insert(start, end, 30, 0), Ok(()));
/// assert_eq!(network.insert(end, start, -20, 0), Ok(()));
/// // It cannot take at most 10 as well, and the network stays as it was.
/// assert_eq!(network.insert(start, end, 10, 1), Err(Inconsistency::NegativeCycle));
/// let reasons: Vec<u32> = network.cycle().iter().map(|edge| edge.tag).collect();
/// assert!(reasons.contains(&0) && reasons.contains(&1));
/// ```
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
    pub(crate) level: Vec<u32>,
    pub(crate) reach: Vec<Reach>,
    pub(crate) now: u32,
    pub(crate) changed: Vec<(u32, i64)>,
    /// Room for what several insertions moved.
    moved: Vec<(u32, i64)>,
    pub(crate) origin: Option<u32>,
    pub(crate) walk: Vec<u32>,
    pub(crate) visits: u32,
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

    /// Adds time points until there are `points`, or takes away the last ones, which must have no edges.
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

    /// Returns how many time points there are.
    pub fn num_points(&self) -> usize {
        self.potential.len()
    }

    /// Returns how many edges there are, with those withdrawn.
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

    /// Returns how many points moved in the last insertion; twice what two of its edges moved.
    pub fn num_changed(&self) -> usize {
        self.changed.len()
    }

    /// An edge, by position; `None` if it has been withdrawn.
    pub fn edge(&self, position: usize) -> Option<CycleEdge> {
        self.edges.get(position).filter(|edge| !edge.is_withdrawn).map(Edge::describe)
    }

    /// The edges that end at a point, the one inserted last first.
    pub fn edges_into(&self, point: PointId) -> impl Iterator<Item = CycleEdge> {
        let mut next = self.first_in[point.index()];
        std::iter::from_fn(move || {
            let edge = self.edges.get(next as usize)?;
            next = edge.next_in;
            Some(edge.describe())
        })
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

    /// Takes back one edge wherever it is in the order of insertion, in time linear in the edges at its ends.
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
        let result = lower.checked_neg().ok_or(Inconsistency::Overflow(Overflow { point: to }));
        let result = result.and_then(|weight| self.insert(to, from, weight, tag));
        if result.is_err() {
            self.rollback(checkpoint);
        }
        result
    }

    /// Adds `to − from ≤ weight` and restores consistency. On failure nothing has changed.
    ///
    /// Takes `O(k log k + edges at k points)` time for the `k` points that must move.
    pub fn insert(&mut self, from: PointId, to: PointId, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        if self.rise(from.0, to.0, weight)? < 0 {
            return self.insert_into(to, [(from, weight, tag)]);
        }
        self.changed.clear();
        self.push(from, to, weight, tag);
        Ok(())
    }

    /// Adds `to − from ≤ weight` for several starts, each with its weight and tag, in one propagation. On failure nothing
    /// has changed.
    pub fn insert_into(
        &mut self,
        to: PointId,
        edges: impl IntoIterator<Item = (PointId, i64, Tag)>,
    ) -> Result<(), Inconsistency> {
        let checkpoint = self.checkpoint();
        for (from, weight, tag) in edges {
            self.push(from, to, weight, tag);
        }
        let result = self.repair(checkpoint.0);
        if result.is_err() {
            self.rollback(checkpoint);
        }
        result
    }

    /// Whether `to − from ≤ weight` could be added. The network stays as it is; if not, [`Stn::cycle`] says why.
    pub fn admits(&mut self, from: PointId, to: PointId, weight: i64, tag: Tag) -> Result<(), Inconsistency> {
        let checkpoint = self.checkpoint();
        self.insert(from, to, weight, tag)?;
        self.rollback(checkpoint);
        // The repaired potential is feasible for the edges that are there, too, but is undone: a query that moved the
        // schedule would make later answers cost differently for no reason.
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
    #[inline]
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
}

impl Edge {
    pub(crate) fn describe(&self) -> CycleEdge {
        CycleEdge { from: PointId(self.from), to: PointId(self.to), weight: self.weight, tag: self.tag }
    }
}
