//! The dispatcher: what may happen when, what must, and what waits for what. A pure state machine, without a clock.
//!
//! The caller advances time ([`Dispatcher::advance`]), executes enabled events ([`Dispatcher::execute`]) and
//! reports the events that the environment ended ([`Dispatcher::observe`]). As long as the environment keeps to its ranges, every
//! choice that it allows can be followed to the end.

use std::fmt;
use std::ops::Deref;

use crate::dispatchable::{Dispatchable, Wait};
use crate::network::{LinkId, PointId};

/// What can be said about a time point at a moment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Status {
    /// Executed at this time.
    Executed(i64),
    /// All that must come before has.
    Enabled {
        /// It may be executed from then on, which may be in the past.
        from: i64,
        /// And no later than this; `None` is not bounded.
        until: Option<i64>,
        /// The links whose ends it waits for, and until when at most: without these waits it could be executed earlier.
        waits: Vec<(LinkId, i64)>,
    },
    /// These must come first.
    Blocked(Vec<PointId>),
    /// The environment executes it, and does so between these times.
    Contingent {
        /// At the earliest.
        from: i64,
        /// At the latest.
        until: i64,
    },
    /// The environment will execute it, but its link's activation has not happened.
    Inactive,
}

/// When a time point may still happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// At the earliest, if the environment ends early what it waits for.
    pub earliest: i64,
    /// At the latest; `None` if not bounded.
    pub latest: Option<i64>,
}

/// Why something cannot happen now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DispatchError {
    /// It has happened.
    Executed,
    /// It is the environment's, or not the environment's.
    Owner,
    /// Something else must come first.
    Blocked,
    /// Not before this time.
    Early(i64),
    /// It had to happen by this time.
    Late(i64),
    /// Time does not run backwards.
    Past,
    /// A time does not fit into 64 bits.
    Overflow,
}

impl fmt::Display for DispatchError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Executed => f.write_str("it has already happened"),
            Self::Owner => f.write_str("the executive can only execute its own points, and the environment only the ends of contingent links"),
            Self::Blocked => f.write_str("another event must come first"),
            Self::Early(time) => write!(f, "not before {time}"),
            Self::Late(time) => write!(f, "no later than {time}"),
            Self::Past => f.write_str("time cannot run backwards"),
            Self::Overflow => f.write_str("a time is too large to represent exactly"),
        }
    }
}

impl std::error::Error for DispatchError {}

/// A run of a dispatchable network, which it holds in whatever way its caller likes.
#[derive(Clone, Debug)]
pub struct Dispatcher<F> {
    form: F,
    /// By point, the edges that start there and that end there, as positions.
    out: Vec<Vec<u32>>,
    into: Vec<Vec<u32>>,
    waits: Vec<Vec<Wait>>,
    times: Vec<Option<i64>>,
    lower: Vec<Option<i64>>,
    upper: Vec<Option<i64>>,
    now: i64,
}

impl<F: Deref<Target = Dispatchable>> Dispatcher<F> {
    /// A run that begins at `now`, before anything has happened.
    pub fn new(form: F, now: i64) -> Self {
        let points = form.network.num_points();
        let (mut out, mut into, mut waits) =
            (vec![Vec::new(); points], vec![Vec::new(); points], vec![Vec::new(); points]);
        for (position, edge) in (0..).zip(&form.edges) {
            out[edge.from.index()].push(position);
            into[edge.to.index()].push(position);
        }
        for wait in &form.waits {
            waits[wait.point.index()].push(*wait);
        }
        Self {
            form,
            out,
            into,
            waits,
            times: vec![None; points],
            lower: vec![None; points],
            upper: vec![None; points],
            now,
        }
    }

    /// The network that is dispatched.
    pub fn form(&self) -> &Dispatchable {
        &self.form
    }

    /// The present time, in ticks.
    pub const fn now(&self) -> i64 {
        self.now
    }

    /// When each point happened.
    pub fn times(&self) -> &[Option<i64>] {
        &self.times
    }

    /// Returns whether everything has happened.
    pub fn is_done(&self) -> bool {
        self.times.iter().all(Option::is_some)
    }

    fn points(&self) -> impl Iterator<Item = PointId> + use<F> {
        (0..self.times.len() as u32).map(PointId)
    }

    /// Returns what can be said about a point now.
    pub fn status(&self, point: PointId) -> Status {
        let at = point.index();
        if let Some(time) = self.times[at] {
            return Status::Executed(time);
        }
        if let Some(link) = self.form.network.link_ending_at(point) {
            let link = self.form.network.link(link);
            return match self.times[link.activation.index()] {
                Some(start) => Status::Contingent {
                    from: start.saturating_add(link.lower),
                    until: start.saturating_add(link.upper),
                },
                None => Status::Inactive,
            };
        }
        let first = self.out[at].iter().map(|&edge| &self.form.edges[edge as usize]);
        let mut blocked: Vec<PointId> = first
            .filter(|edge| edge.weight < 0 && self.times[edge.to.index()].is_none())
            .map(|edge| edge.to)
            .collect();
        let mut from = self.lower[at].unwrap_or(i64::MIN);
        let mut waits = Vec::new();
        for wait in &self.waits[at] {
            let link = self.form.network.link(wait.link);
            if self.times[link.end.index()].is_some() {
                continue;
            }
            match self.times[link.activation.index()] {
                None => blocked.push(link.activation),
                Some(start) => {
                    let until = start.saturating_add(wait.until);
                    if until > self.lower[at].unwrap_or(i64::MIN) {
                        waits.push((wait.link, until));
                    }
                    from = from.max(until);
                }
            }
        }
        if blocked.is_empty() {
            return Status::Enabled { from, until: self.upper[at], waits };
        }
        blocked.sort_unstable();
        blocked.dedup();
        Status::Blocked(blocked)
    }

    /// The points that may be executed now, by id. Executing one may change what others may.
    pub fn executable(&self) -> Vec<PointId> {
        self.points()
            .filter(|&point| matches!(self.status(point), Status::Enabled { from, .. } if from <= self.now))
            .collect()
    }

    /// The next time at which something may be executed if the environment does nothing before.
    pub fn next_time(&self) -> Option<i64> {
        let times = self.points().filter_map(|point| match self.status(point) {
            Status::Enabled { from, .. } => Some(from.max(self.now)),
            _ => None,
        });
        times.min()
    }

    /// The time by which something must have happened: the executive's or the environment's.
    pub fn deadline(&self) -> Option<i64> {
        let times = self.points().filter_map(|point| match self.status(point) {
            Status::Contingent { until, .. } => Some(until),
            Status::Executed(_) => None,
            _ => self.upper[point.index()],
        });
        times.min()
    }

    /// Lets time pass. Not beyond [`Dispatcher::deadline`]: what is due then must happen first.
    pub fn advance(&mut self, to: i64) -> Result<(), DispatchError> {
        if to < self.now {
            return Err(DispatchError::Past);
        }
        match self.deadline() {
            Some(deadline) if deadline < to => Err(DispatchError::Late(deadline)),
            _ => {
                self.now = to;
                Ok(())
            }
        }
    }

    /// Executes a point of the executive's now.
    pub fn execute(&mut self, point: PointId) -> Result<(), DispatchError> {
        match self.status(point) {
            Status::Executed(_) => Err(DispatchError::Executed),
            Status::Contingent { .. } | Status::Inactive => Err(DispatchError::Owner),
            Status::Blocked(_) => Err(DispatchError::Blocked),
            Status::Enabled { from, .. } if from > self.now => Err(DispatchError::Early(from)),
            Status::Enabled { until: Some(until), .. } if until < self.now => Err(DispatchError::Late(until)),
            Status::Enabled { .. } => self.happen(point),
        }
    }

    /// The environment ends a link now.
    pub fn observe(&mut self, link: LinkId) -> Result<(), DispatchError> {
        let end = self.form.network.link(link).end;
        match self.status(end) {
            Status::Executed(_) => Err(DispatchError::Executed),
            Status::Contingent { from, .. } if self.now < from => Err(DispatchError::Early(from)),
            Status::Contingent { until, .. } if self.now > until => Err(DispatchError::Late(until)),
            Status::Contingent { .. } => self.happen(end),
            Status::Inactive | Status::Blocked(_) | Status::Enabled { .. } => Err(DispatchError::Blocked),
        }
    }

    /// A point happens now: its neighbors' bounds follow.
    fn happen(&mut self, point: PointId) -> Result<(), DispatchError> {
        let edges = &self.form.edges;
        for &edge in &self.into[point.index()] {
            let edge = &edges[edge as usize];
            let time = self.now.checked_sub(edge.weight).ok_or(DispatchError::Overflow)?;
            let lower = &mut self.lower[edge.from.index()];
            *lower = Some(lower.map_or(time, |known| known.max(time)));
        }
        for &edge in &self.out[point.index()] {
            let edge = &edges[edge as usize];
            let time = self.now.checked_add(edge.weight).ok_or(DispatchError::Overflow)?;
            let upper = &mut self.upper[edge.to.index()];
            *upper = Some(upper.map_or(time, |known| known.min(time)));
        }
        self.times[point.index()] = Some(self.now);
        Ok(())
    }

    /// When each point may still happen. A wait counts for its earliest end: that of the link or its own.
    pub fn windows(&self) -> Result<Vec<Window>, DispatchError> {
        let mut windows: Vec<Window> = self
            .times
            .iter()
            .map(|time| match *time {
                Some(time) => Window { earliest: time, latest: Some(time) },
                None => Window { earliest: self.now, latest: None },
            })
            .collect();
        let network = &self.form.network;
        // Every sweep settles one more point at least.
        for _ in 0..=windows.len() {
            let mut changed = false;
            let mut later = |windows: &mut Vec<Window>, point: PointId, time: i64| {
                let window = &mut windows[point.index()];
                if self.times[point.index()].is_none() && window.earliest < time {
                    window.earliest = time;
                    changed = true;
                }
            };
            for edge in &self.form.edges {
                let time = windows[edge.to.index()].earliest.checked_sub(edge.weight);
                later(&mut windows, edge.from, time.ok_or(DispatchError::Overflow)?);
            }
            for link in network.links() {
                let time = windows[link.activation.index()].earliest.checked_add(link.lower);
                later(&mut windows, link.end, time.ok_or(DispatchError::Overflow)?);
            }
            for wait in &self.form.waits {
                let link = network.link(wait.link);
                let until = windows[link.activation.index()].earliest.checked_add(wait.until);
                let until = until.ok_or(DispatchError::Overflow)?.min(windows[link.end.index()].earliest);
                later(&mut windows, wait.point, until);
            }
            let mut sooner = |windows: &mut Vec<Window>, from: PointId, to: PointId, weight: i64| {
                let Some(latest) = windows[from.index()].latest else { return Ok(()) };
                let time = latest.checked_add(weight).ok_or(DispatchError::Overflow)?;
                let window = &mut windows[to.index()];
                if self.times[to.index()].is_none() && window.latest.is_none_or(|known| time < known) {
                    window.latest = Some(time);
                    changed = true;
                }
                Ok(())
            };
            for edge in &self.form.edges {
                sooner(&mut windows, edge.from, edge.to, edge.weight)?;
            }
            for link in network.links() {
                sooner(&mut windows, link.activation, link.end, link.upper)?;
            }
            if !changed {
                break;
            }
        }
        Ok(windows)
    }
}
