//! When vehicles under way arrive: what would leave them no time for that waits, as long as the plan lets it. This is for
//! plans in which the environment chooses nothing. In other plans, [`Stage::expect`] dispatches again.

use std::collections::BTreeMap;

use exact::{Overflow, Time};
use stn::{INFINITE, PointId};
use tpn::OccurrenceId;

use crate::activity_execution::Ends;
use crate::plan_network::PlanError;
use crate::stage::Stage;

/// The arrivals of those under way, in one stage.
#[derive(Default)]
pub(crate) struct Arrivals(Vec<Arrival>);

/// When an activity under way can end, as its driver tells.
struct Arrival {
    end: PointId,
    /// The earliest tick at which it can.
    at: i64,
    /// For each point how many ticks after it the activity ends at the latest.
    after: Vec<i64>,
}

impl Arrivals {
    /// Of all those under way.
    pub(crate) fn all(
        stage: &mut Stage,
        executions: &BTreeMap<OccurrenceId, Ends>,
    ) -> Result<Self, PlanError> {
        let mut arrivals = Self::default();
        for (&occurrence, ends) in executions {
            arrivals.expect(stage, occurrence, ends)?;
        }
        Ok(arrivals)
    }

    /// Notes when one that has set out arrives, if it drives.
    pub(crate) fn expect(
        &mut self,
        stage: &mut Stage,
        occurrence: OccurrenceId,
        ends: &Ends,
    ) -> Result<(), PlanError> {
        let Ends::NotBefore(duration) = ends else { return Ok(()) };
        if stage.dispatch.withstands_nature() {
            return Ok(());
        }
        let described = &stage.network.occurrences[occurrence.index()];
        let [started, ended] = [described.start, described.end].map(|node| stage.times[node.index()]);
        let (Some(started), None) = (started, ended) else { return Ok(()) };
        let Some(end) = stage.made.point(described.end) else { return Ok(()) };
        let too_late = |_: Overflow| PlanError::TooLate { event: format!("{}.end", described.name) };
        let at = started.checked_add(*duration).ok_or(Overflow).map_err(too_late)?;
        let at = stage.made.scale().ticks(at).map_err(too_late)?;
        self.0.retain(|arrival| stage.times[stage.made.node(arrival.end).index()].is_none());
        let mut after = Vec::new();
        stage.made.stn.distances_to(end, &mut after)?;
        self.0.push(Arrival { end, at, after });
        Ok(())
    }

    /// The earliest time at which a point leaves all those under way the time to arrive.
    pub(crate) fn leaving_time(&self, stage: &Stage, point: PointId) -> Option<Time> {
        let others = self.0.iter().filter(|arrival| arrival.end != point);
        let times = others.filter_map(|arrival| {
            let after = arrival.after.get(point.index()).copied().filter(|&after| after != INFINITE)?;
            arrival.at.checked_sub(after)
        });
        times.max().map(|ticks| stage.made.time(ticks))
    }
}
