//! Dispatch of a plan some of whose durations nature chooses (SPEC 13.2): through its dispatchable form with waits. Events
//! of nature's are observed, never chosen, and what is tied to them comes with them.

use std::sync::Arc;

use controllability::plan_network;
use stn::PointId;
use stnu::{DispatchError, Dispatchable, LinkId, Status, Undecided};
use tpn::{Network, Plan};

use crate::dispatch::{MAX_EVENTS, NEVER, SettleError};
use crate::plan_network::{PlanError, PlanNetwork};

/// The state of a dispatch. Events that `[0,0]` ties to one instant are one component.
#[derive(Clone, Debug)]
pub struct UncertainDispatch {
    dispatcher: stnu::Dispatcher<Arc<Dispatchable>>,
    /// The component of each event.
    components: Arc<[stnu::PointId]>,
    /// Durations that end where another one ends, and so have an end of their own: the event's component.
    own_ends: Arc<[(stnu::PointId, LinkId)]>,
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
        if read.network.num_points() > MAX_EVENTS {
            return Err(PlanError::Overflow);
        }
        let Some(form) = Dispatchable::new(&read.network, &mut || false)? else { return Ok(None) };
        let component = |point| read.point(made.node(point)).ok_or(PlanError::Inconsistent);
        let components: Result<Arc<[_]>, PlanError> = made.all_points().map(component).collect();
        let own_ends = (0..).map(LinkId).zip(read.network.links()).filter_map(|(id, link)| {
            let is_own = read.nodes(link.end).is_empty();
            read.point(network.arcs[read.arc(id).index()].to).filter(|_| is_own).map(|at| (at, id))
        });
        Ok(Some(Self {
            own_ends: own_ends.collect(),
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
