//! Dispatch of plans in which all durations are the executive's to choose, or which do not withstand nature (SPEC 6.2):
//! windows are kept exact on the elimination tree of the plan's network, each event in time logarithmic in their number where
//! that is narrow.

use std::sync::Arc;

use stn::{PointId, Refusal, Unfolding};

use crate::dispatch::{NEVER, SettleError};
use crate::plan_network::{PlanError, PlanNetwork};

/// The state of a dispatch.
#[derive(Clone, Debug)]
pub(crate) struct CertainDispatch {
    unfolding: Unfolding,
    /// The points that must come after each, as far as one constraint says so.
    later: Arc<[Vec<PointId>]>,
    /// How many of those that must come before each have not been settled.
    earlier: Vec<u32>,
}

impl CertainDispatch {
    /// Prepares a plan for dispatch.
    pub(crate) fn new(plan: &PlanNetwork) -> Result<Self, PlanError> {
        let unfolding = Unfolding::new(&plan.stn, plan.origin())?;
        let mut later = vec![Vec::new(); plan.stn.num_points()];
        let mut earlier = vec![0; later.len()];
        for edge in (0..plan.stn.num_edges()).filter_map(|position| plan.stn.edge(position)) {
            if edge.weight < 0 {
                later[edge.to.index()].push(edge.from);
                earlier[edge.from.index()] += 1;
            }
        }
        Ok(Self { unfolding, later: later.into(), earlier })
    }

    /// When a point may still happen.
    pub(crate) fn window(&self, point: PointId) -> (i64, i64) {
        let (earliest, latest) = self.unfolding.window(point);
        (earliest, latest.unwrap_or(NEVER))
    }

    /// Whether the time of a point is settled.
    pub(crate) fn is_settled(&self, point: PointId) -> bool {
        self.unfolding.has_happened(point)
    }

    /// Whether everything that must come before a point has been settled, as far as one constraint says so.
    pub(crate) fn is_enabled(&self, point: PointId) -> bool {
        self.earlier[point.index()] == 0
    }

    /// The world lets a point come at a time: what comes with it or after it waits.
    pub(crate) fn expect(&mut self, point: PointId, ticks: i64) {
        self.unfolding.expect(point, ticks);
    }

    /// The expected points that have to come earlier since this was asked.
    pub(crate) fn take_late(&mut self) -> Vec<PointId> {
        self.unfolding.take_late()
    }

    /// Settles the time of a point. Refused, with everything as before, where another point must come first that has not.
    pub(crate) fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        let (earliest, latest) = self.window(point);
        if ticks < earliest || ticks > latest {
            return Err(SettleError::OutOfWindow { earliest, latest });
        }
        if self.is_settled(point) {
            return Ok(());
        }
        self.unfolding.happen(point, ticks).map_err(|refusal| match refusal {
            Refusal::NotYet(other) => SettleError::NotYet(other),
            Refusal::Overflow(other) => SettleError::Overflow(other),
        })?;
        for later in &Arc::clone(&self.later)[point.index()] {
            self.earlier[later.index()] -= 1;
        }
        Ok(())
    }
}
