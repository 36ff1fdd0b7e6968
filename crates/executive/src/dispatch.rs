//! Dispatch of a plan through its dispatchable form (SPEC 6.1, 6.2): which events may happen now, and what an event
//! that happened leaves possible.

use stn::{Dispatchable, PointId};

use crate::plan_network::{PlanError, PlanNetwork};

/// The greatest number of events whose dispatchable form is computed: it takes time cubic in it. Larger plans are dispatched
/// by propagation, in which an event takes time linear in what it changes.
pub const MAX_EVENTS: usize = 400;

/// The state of a dispatch. Components are the rigid components of the plan; an event is a point and its time follows
/// its component's.
#[derive(Clone, Debug)]
pub struct Dispatcher {
    form: Dispatchable,
    /// The component of each point, and its time after the component's leader.
    place: Vec<(usize, i64)>,
    /// The component of each leader, by point; meaningless for other points.
    component_of_leader: Vec<usize>,
    /// Of the leaders.
    windows: Vec<(i64, i64)>,
    /// How long after its leader the last member of each component comes.
    lengths: Vec<i64>,
    time: Vec<Option<i64>>,
    /// Edges by their ends: positions in the form's list.
    out: Vec<Vec<usize>>,
    into: Vec<Vec<usize>>,
}

/// No upper bound.
pub const NEVER: i64 = i64::MAX;

/// Why an event cannot have come at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettleError {
    /// It came outside its window.
    OutOfWindow {
        /// The window's beginning, in ticks.
        earliest: i64,
        /// Its end, or [`NEVER`].
        latest: i64,
    },
    /// This event, of which nothing is known yet, must come first.
    NotYet(PointId),
    /// This event, which follows, could only come at a time that does not fit.
    Overflow(PointId),
}

impl Dispatcher {
    /// Prepares a plan for dispatch.
    pub fn new(plan: &mut PlanNetwork) -> Result<Self, PlanError> {
        let points: Vec<PointId> = plan.all_points().collect();
        let distances = plan.stn.all_pairs()?;
        let form = stn::dispatchable(&distances, &points);
        let mut place = vec![(0, 0); points.len()];
        let mut component_of_leader = vec![0; points.len()];
        let mut windows = Vec::with_capacity(form.components.len());
        let mut lengths = Vec::with_capacity(form.components.len());
        for (index, component) in form.components.iter().enumerate() {
            component_of_leader[component.leader.index()] = index;
            for &(point, offset) in &component.members {
                place[point.index()] = (index, offset);
            }
            lengths.push(component.members.iter().map(|&(_, offset)| offset).max().unwrap_or(0));
            let origin = plan.origin();
            windows.push((-distances.get(component.leader, origin), distances.get(origin, component.leader)));
        }
        let mut out = vec![Vec::new(); form.components.len()];
        let mut into = vec![Vec::new(); form.components.len()];
        for (position, edge) in form.edges.iter().enumerate() {
            out[component_of_leader[edge.from.index()]].push(position);
            into[component_of_leader[edge.to.index()]].push(position);
        }
        let time = vec![None; form.components.len()];
        Ok(Self { form, place, component_of_leader, windows, lengths, time, out, into })
    }

    /// The form that is dispatched.
    pub const fn form(&self) -> &Dispatchable {
        &self.form
    }

    /// When a point may still happen: its earliest and latest tick, [`NEVER`] if there is no latest.
    pub fn window(&self, point: PointId) -> (i64, i64) {
        let (component, offset) = self.place[point.index()];
        if let Some(time) = self.time[component] {
            (time + offset, time + offset)
        } else {
            let (earliest, latest) = self.windows[component];
            (earliest + offset, if latest == NEVER { NEVER } else { latest.saturating_add(offset) })
        }
    }

    /// The rigid component of a point, and its time after the component's leader in ticks.
    pub fn component(&self, point: PointId) -> (usize, i64) {
        self.place[point.index()]
    }

    /// Whether the time of a point is settled.
    pub fn is_settled(&self, point: PointId) -> bool {
        self.time[self.place[point.index()].0].is_some()
    }

    /// Whether two points come at the same instant whenever that is.
    pub fn are_simultaneous(&self, a: PointId, b: PointId) -> bool {
        self.place[a.index()] == self.place[b.index()]
    }

    /// Whether everything that must come before a point has been settled: no negative edge leads from its component to
    /// one that has not (SPEC 6.2).
    pub fn is_enabled(&self, point: PointId) -> bool {
        let component = self.place[point.index()].0;
        self.out[component].iter().all(|&position| {
            let edge = self.form.edges[position];
            edge.weight >= 0 || self.time[self.component_of_leader[edge.to.index()]].is_some()
        })
    }

    /// Settles the time of a point, and tells the neighbours.
    pub fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        let (earliest, latest) = self.window(point);
        if ticks < earliest || ticks > latest {
            return Err(SettleError::OutOfWindow { earliest, latest });
        }
        let (component, offset) = self.place[point.index()];
        let time =
            ticks.checked_sub(offset).filter(|time| time.checked_add(self.lengths[component]).is_some());
        let time = time.ok_or(SettleError::Overflow(point))?;
        if self.time[component].replace(time).is_some() {
            return Ok(());
        }
        for &position in &self.out[component] {
            let edge = self.form.edges[position];
            let window = &mut self.windows[self.component_of_leader[edge.to.index()]];
            window.1 = window.1.min(time.saturating_add(edge.weight));
        }
        for &position in &self.into[component] {
            let edge = self.form.edges[position];
            let other = self.component_of_leader[edge.from.index()];
            let earliest = time.checked_sub(edge.weight);
            let fits = |earliest: &i64| earliest.checked_add(self.lengths[other]).is_some();
            let earliest = earliest.filter(fits).ok_or(SettleError::Overflow(edge.from))?;
            let window = &mut self.windows[other];
            window.0 = window.0.max(earliest);
        }
        Ok(())
    }
}
