//! Dispatch of a plan some of whose durations nature chooses (SPEC 13.2): through its dispatchable form with waits. Events
//! of nature's are observed, never chosen, and what is tied to them comes with them.

use std::sync::Arc;

use controllability::plan_network;
use stn::PointId;
use stnu::{DispatchError, Dispatchable, LinkId, Status, Undecided};
use tpn::{ArcId, Network, Plan};

use crate::dispatch::{NEVER, SettleError};
use crate::plan_network::{PlanError, PlanNetwork};

/// The state of a dispatch. Events that `[0,0]` ties to one instant are one component.
#[derive(Clone, Debug)]
pub struct UncertainDispatch {
    dispatcher: stnu::Dispatcher<Arc<Dispatchable>>,
    /// The component of each event.
    components: Arc<[stnu::PointId]>,
    /// Durations that end where another one ends, and so have an end of their own: the event's component.
    own_ends: Arc<[(stnu::PointId, LinkId)]>,
    /// The arc whose duration each link is.
    arcs: Arc<[ArcId]>,
}

/// What a point waits for, and until when at most, in ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Awaited {
    pub(crate) natures: ArcId,
    pub(crate) until: i64,
}

impl From<Undecided> for PlanError {
    fn from(_: Undecided) -> Self {
        // Nobody stops it.
        Self::Overflow
    }
}

impl UncertainDispatch {
    /// Prepares a plan for dispatch, in the ticks of `made`; `None` if it is not controllable.
    pub fn new(network: &Network, plan: &Plan, made: &PlanNetwork) -> Result<Option<Self>, PlanError> {
        let read = plan_network(network, &plan.selected_arcs, &plan.precedences(network), made.scale())?;
        let Some(form) = Dispatchable::new(&read.network, &mut || false)? else { return Ok(None) };
        let component = |point| read.point(made.node(point)).ok_or(PlanError::Inconsistent);
        let components: Result<Arc<[_]>, PlanError> = made.all_points().map(component).collect();
        let links = (0..read.network.links().len() as u32).map(LinkId);
        let own_ends = links.clone().zip(read.network.links()).filter_map(|(id, link)| {
            let is_own = read.nodes(link.end).is_empty();
            read.point(network.arcs[read.arc(id).index()].to).filter(|_| is_own).map(|at| (at, id))
        });
        Ok(Some(Self {
            own_ends: own_ends.collect(),
            arcs: links.map(|id| read.arc(id)).collect(),
            dispatcher: stnu::Dispatcher::new(Arc::new(form), 0),
            components: components?,
        }))
    }

    fn status(&self, point: PointId) -> Status {
        self.dispatcher.status(self.components[point.index()])
    }

    /// When a point may happen next: as early as its waits let it if nature ends nothing before. Meaningless for one
    /// that is not enabled.
    pub fn window(&self, point: PointId) -> (i64, i64) {
        match self.status(point) {
            Status::Executed(time) => (time, time),
            Status::Enabled { from, until, .. } => (from.max(0), until.unwrap_or(NEVER)),
            Status::Contingent { from, until } => (from, until),
            Status::Blocked(_) | Status::Inactive => (self.dispatcher.now(), NEVER),
        }
    }

    /// The present, in ticks.
    pub(crate) const fn now(&self) -> i64 {
        self.dispatcher.now()
    }

    /// Lets time pass, up to the first event that must come.
    pub(crate) fn advance(&mut self, ticks: i64) {
        let deadline = self.dispatcher.deadline().unwrap_or(NEVER);
        // Never beyond what is due, and never back: it cannot be refused.
        let _ = self.dispatcher.advance(ticks.min(deadline).max(self.dispatcher.now()));
    }

    /// The duration of nature's that ends at a point, if one does and it has begun; when it began.
    pub(crate) fn under_way(&self, point: PointId) -> Option<(ArcId, i64)> {
        let Status::Contingent { .. } = self.status(point) else { return None };
        let form = self.dispatcher.form();
        let link = form.network.link_ending_at(self.components[point.index()])?;
        let began = self.dispatcher.times()[form.network.link(link).activation.index()]?;
        Some((self.arcs[link.index()], began))
    }

    /// The ends of nature's that a point waits for, though all that must come before it has.
    pub(crate) fn awaited(&self, point: PointId) -> Vec<Awaited> {
        let Status::Enabled { waits, .. } = self.status(point) else { return Vec::new() };
        let form = self.dispatcher.form();
        let own = self.components[point.index()];
        let until = |link: LinkId| {
            let began = self.dispatcher.times()[form.network.link(link).activation.index()]?;
            let wait = form.waits.iter().find(|wait| wait.point == own && wait.link == link)?;
            Some(Awaited { natures: self.arcs[link.index()], until: began.saturating_add(wait.until) })
        };
        waits.into_iter().filter_map(until).collect()
    }

    /// When each of `points` may still happen: at the earliest if nature ends early what it waits for.
    pub(crate) fn windows(
        &self,
        points: impl Iterator<Item = PointId>,
    ) -> Result<Vec<(i64, Option<i64>)>, PlanError> {
        let windows = self.dispatcher.windows().map_err(|_| PlanError::Overflow)?;
        let window = |point: PointId| windows[self.components[point.index()].index()];
        Ok(points.map(window).map(|window| (window.earliest, window.latest)).collect())
    }

    /// The component of a point, by number.
    pub fn component(&self, point: PointId) -> usize {
        self.components[point.index()].index()
    }

    /// Whether the time of a point is settled.
    pub fn is_settled(&self, point: PointId) -> bool {
        matches!(self.status(point), Status::Executed(_))
    }

    /// Whether everything that must come before a point has been settled.
    pub fn is_enabled(&self, point: PointId) -> bool {
        matches!(self.status(point), Status::Enabled { .. } | Status::Contingent { .. })
    }

    /// Settles the time of a point: the executive's happens, or nature's is seen.
    pub fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        let (earliest, latest) = self.window(point);
        let refused = |error| match error {
            DispatchError::Overflow => SettleError::Overflow(point),
            _ => SettleError::OutOfWindow { earliest, latest },
        };
        let component = self.components[point.index()];
        if self.is_settled(point) {
            return if ticks == earliest { Ok(()) } else { Err(refused(DispatchError::Executed)) };
        }
        self.dispatcher.advance(ticks).map_err(refused)?;
        match self.dispatcher.form().network.link_ending_at(component) {
            Some(link) => self.dispatcher.observe(link),
            None => self.dispatcher.execute(component),
        }
        .map_err(refused)?;
        for &(_, link) in self.own_ends.iter().filter(|(at, _)| *at == component) {
            self.dispatcher.observe(link).map_err(refused)?;
        }
        Ok(())
    }
}
