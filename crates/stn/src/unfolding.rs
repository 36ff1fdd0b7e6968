//! Windows of time points while they happen one after the other: exact, and each event in time logarithmic in their number
//! where the network's tree width is bounded.
//!
//! A point that happened tells those above it in the elimination tree what it leaves them, and the window of any point
//! follows from those above it. In the core, whose points have many neighbors, what an event changes is propagated.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::sync::Arc;

use crate::elimination::{EliminationTree, FREE, sum};
use crate::network::{Overflow, PointId, Stn};

/// Why a point cannot happen at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// This point, which has not happened, must come before.
    NotYet(PointId),
    /// This point could only come at a time that does not fit.
    Overflow(PointId),
}

/// A network of which some points have happened.
///
/// ```
/// use stn::{PointId, Stn, Unfolding};
///
/// let [start, drive, end] = [PointId(0), PointId(1), PointId(2)];
/// let mut network = Stn::new(3);
/// network.constrain(start, drive, 0, Some(10), 0).unwrap();
/// network.constrain(drive, end, 20, Some(30), 0).unwrap();
/// let mut unfolding = Unfolding::new(&network, start).unwrap();
/// assert_eq!(unfolding.window(end), (20, Some(40)));
/// unfolding.happen(start, 0).unwrap();
/// unfolding.happen(drive, 5).unwrap();
/// assert_eq!(unfolding.window(end), (25, Some(35)));
/// ```
#[derive(Clone, Debug)]
pub struct Unfolding {
    tree: Arc<EliminationTree>,
    /// What the points that have happened at or below each point leave it: its earliest and latest time. Of points of the
    /// core, what all do.
    known: Vec<(i64, i64)>,
    has_happened: Vec<bool>,
    /// For each point those below it by how long after it they come at the latest, the least first; too small where some
    /// have happened since.
    below: Vec<BinaryHeap<Reverse<(i64, u32)>>>,
    /// When points are expected to happen, and how often that has been said or was told of.
    expected: Vec<(Option<i64>, u32)>,
    /// For each point those at or below it that are late when its latest time comes before a limit, the greatest limit
    /// first, with which saying of it that is: out of date where there is a later one.
    limits: Vec<BinaryHeap<(i64, u32, u32)>>,
    late: Vec<PointId>,
    /// What the event under way has changed, with what was known before, the earliest change first.
    trail: Vec<(u32, (i64, i64))>,
    open: VecDeque<u32>,
    is_open: Vec<bool>,
}

/// Earlier than every time.
const EVER: i64 = i64::MIN;

impl Unfolding {
    /// Of a consistent network, before anything has happened but for `origin`, whose time is 0.
    pub fn new(stn: &Stn, origin: PointId) -> Result<Self, Overflow> {
        let tree = EliminationTree::new(stn)?;
        let count = stn.num_points();
        let mut unfolding = Self {
            tree: Arc::new(tree),
            known: vec![(EVER, FREE); count],
            has_happened: vec![false; count],
            below: vec![BinaryHeap::new(); count],
            expected: vec![(None, 0); count],
            limits: vec![BinaryHeap::new(); count],
            late: Vec::new(),
            trail: Vec::new(),
            open: VecDeque::new(),
            is_open: vec![false; count],
        };
        let tree = Arc::clone(&unfolding.tree);
        for &point in &tree.order {
            let Some((least, _)) = unfolding.first_below(point) else { continue };
            for edge in tree.edges[point as usize].iter().filter(|edge| edge.down != FREE) {
                let by = sum(edge.down, least, point)?;
                unfolding.below[edge.to as usize].push(Reverse((by, point)));
            }
        }
        unfolding.tell(origin.0, 0).map_err(|point| Overflow { point: PointId(point) })?;
        Ok(unfolding)
    }

    /// When a point may still happen: its earliest and its latest time, if there is one; when it happened, if it has.
    pub fn window(&self, point: PointId) -> (i64, Option<i64>) {
        let (earliest, latest) = self.bounds(point.0);
        (if earliest == EVER { 0 } else { earliest }, (latest != FREE).then_some(latest))
    }

    fn bounds(&self, point: u32) -> (i64, i64) {
        if self.has_happened[point as usize] || self.tree.is_core[point as usize] {
            return self.known[point as usize];
        }
        let depth = self.tree.depth[point as usize] as usize;
        // By depth, the root first.
        let mut bounds: Vec<(i64, i64)> = vec![(EVER, FREE); depth + 1];
        let chain: Vec<u32> = self.tree.chain(point).collect();
        for &here in chain.iter().rev() {
            let (mut earliest, mut latest) = self.known[here as usize];
            for edge in &self.tree.edges[here as usize] {
                let above = if self.tree.is_core[edge.to as usize] {
                    self.known[edge.to as usize]
                } else {
                    bounds[self.tree.depth[edge.to as usize] as usize]
                };
                if above.0 != EVER && edge.up != FREE {
                    earliest = earliest.max(above.0.saturating_sub(edge.up));
                }
                if above.1 != FREE && edge.down != FREE {
                    latest = latest.min(above.1.saturating_add(edge.down));
                }
            }
            bounds[self.tree.depth[here as usize] as usize] = (earliest, latest);
        }
        bounds[depth]
    }

    /// Returns whether a point has happened.
    pub fn has_happened(&self, point: PointId) -> bool {
        self.has_happened[point.index()]
    }

    /// A point happens, within its window. Refused, with everything as before, where another one must come first.
    pub fn happen(&mut self, point: PointId, time: i64) -> Result<(), Refusal> {
        if std::mem::replace(&mut self.has_happened[point.index()], true) {
            return Ok(());
        }
        self.trail.clear();
        let done = self.tell(point.0, time).map_err(|point| Refusal::Overflow(PointId(point)));
        let done = done.and_then(|()| match self.overdue(time) {
            Some(point) => Err(Refusal::NotYet(point)),
            None => self.find_late(time, self.expected[point.index()].0.is_some()),
        });
        if done.is_err() {
            self.has_happened[point.index()] = false;
            for (point, known) in self.trail.drain(..).rev() {
                self.known[point as usize] = known;
            }
            for point in self.open.drain(..) {
                self.is_open[point as usize] = false;
            }
            return done;
        }
        Ok(())
    }

    /// What a point that happens leaves those above it. Fails with a point whose time would not fit.
    fn tell(&mut self, point: u32, time: i64) -> Result<(), u32> {
        let tree = Arc::clone(&self.tree);
        self.narrow(point, (time, time));
        for here in tree.chain(point) {
            if tree.is_core[here as usize] {
                break;
            }
            let (earliest, latest) = self.known[here as usize];
            for edge in &tree.edges[here as usize] {
                self.carry((earliest, latest), edge.up, edge.down, edge.to)?;
            }
        }
        while let Some(here) = self.open.pop_front() {
            self.is_open[here as usize] = false;
            let known = self.known[here as usize];
            for edge in &tree.edges[here as usize] {
                self.carry(known, edge.up, edge.down, edge.to)?;
            }
        }
        Ok(())
    }

    /// What one point's bounds say of another, along the constraint to it and back.
    fn carry(&mut self, (earliest, latest): (i64, i64), there: i64, back: i64, to: u32) -> Result<(), u32> {
        if self.has_happened[to as usize] {
            return Ok(());
        }
        let mut bounds = self.known[to as usize];
        if earliest != EVER && back != FREE {
            bounds.0 = bounds.0.max(earliest.checked_sub(back).ok_or(to)?);
        }
        if latest != FREE && there != FREE {
            bounds.1 = bounds.1.min(latest.saturating_add(there));
        }
        self.narrow(to, bounds);
        Ok(())
    }

    fn narrow(&mut self, point: u32, bounds: (i64, i64)) {
        let known = &mut self.known[point as usize];
        if *known == bounds {
            return;
        }
        self.trail.push((point, *known));
        *known = bounds;
        if self.tree.is_core[point as usize] && !std::mem::replace(&mut self.is_open[point as usize], true) {
            self.open.push_back(point);
        }
    }

    /// A point that would have had to happen before `now`, by what the event under way has changed.
    fn overdue(&mut self, now: i64) -> Option<PointId> {
        for place in 0..self.trail.len() {
            let (point, before) = self.trail[place];
            let latest = self.known[point as usize].1;
            if latest == before.1 || latest == FREE {
                continue;
            }
            let Some((least, _)) = self.first_below(point) else { continue };
            if latest.saturating_add(least) < now {
                return Some(self.first_point_below(point));
            }
        }
        None
    }

    /// Finds who is late by what the event under way, at `now`, has changed. Fails with one that would have had to happen
    /// by now and is expected later, unless this event was expected as well.
    fn find_late(&mut self, now: i64, is_expected: bool) -> Result<(), Refusal> {
        let num_late = self.late.len();
        for place in 0..self.trail.len() {
            let (here, _) = self.trail[place];
            let latest = self.known[here as usize].1;
            while let Some(&(_, point, saying)) =
                self.limits[here as usize].peek().filter(|(limit, ..)| *limit > latest)
            {
                let (time, said) = self.expected[point as usize];
                if !self.has_happened[point as usize] && saying == said {
                    if time > Some(now) && !is_expected && self.bounds(point).1 <= now {
                        // Whom that made late it has not made late now.
                        for late in self.late.split_off(num_late) {
                            self.expect(late, self.expected[late.index()].0.unwrap_or(now));
                        }
                        return Err(Refusal::NotYet(PointId(point)));
                    }
                    self.expected[point as usize].1 += 1;
                    self.late.push(PointId(point));
                }
                self.limits[here as usize].pop();
            }
        }
        Ok(())
    }

    /// Of the points at or below one that have not happened, how long after it the one comes that comes first by its
    /// latest time, and through which next point that is known.
    fn first_below(&mut self, point: u32) -> Option<(i64, u32)> {
        let own = (!self.has_happened[point as usize]).then_some((0, point));
        loop {
            let Some(&Reverse((by, next))) = self.below[point as usize].peek() else { return own };
            if own.is_some() && by >= 0 {
                // It only gets greater.
                return own;
            }
            let down = self.tree.edges[next as usize].iter().find(|edge| edge.to == point);
            let down = down.map_or(FREE, |edge| edge.down);
            let really = self.first_below(next).map(|(least, _)| down.saturating_add(least));
            if really == Some(by) {
                return Some((by, next));
            }
            self.below[point as usize].pop();
            self.below[point as usize].extend(really.map(|by| Reverse((by, next))));
        }
    }

    fn first_point_below(&mut self, mut point: u32) -> PointId {
        while let Some((_, next)) = self.first_below(point).filter(|&(_, next)| next != point) {
            point = next;
        }
        PointId(point)
    }

    /// A point is expected to happen at a time, whatever its window is then: it is late when its latest time comes before,
    /// and no other one happens that would have it happen by then, but for those that are expected themselves.
    pub fn expect(&mut self, point: PointId, time: i64) {
        let saying = self.expected[point.index()].1 + 1;
        self.expected[point.index()] = (Some(time), saying);
        let tree = Arc::clone(&self.tree);
        if tree.is_core[point.index()] {
            self.limits[point.index()].push((time, point.0, saying));
            return;
        }
        let depth = tree.depth[point.index()] as usize;
        // How long after each point above it comes at the latest, by depth.
        let mut after = vec![FREE; depth + 1];
        after[depth] = 0;
        for here in tree.chain(point.0) {
            let own = after[tree.depth[here as usize] as usize];
            if own == FREE {
                continue;
            }
            self.limits[here as usize].push((time.saturating_sub(own), point.0, saying));
            for edge in tree.edges[here as usize].iter().filter(|edge| edge.down != FREE) {
                let by = own.saturating_add(edge.down);
                if tree.is_core[edge.to as usize] {
                    self.limits[edge.to as usize].push((time.saturating_sub(by), point.0, saying));
                } else {
                    let known = &mut after[tree.depth[edge.to as usize] as usize];
                    *known = by.min(*known);
                }
            }
        }
    }

    /// The expected points that have become late since this was asked. Each is told of once, until it is expected again.
    pub fn take_late(&mut self) -> Vec<PointId> {
        std::mem::take(&mut self.late)
    }
}
