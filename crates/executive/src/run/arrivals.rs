//! When vehicles under way arrive: what would leave them no time for that waits, as long as the plan lets it.

use exact::{Overflow, Time};
use stn::{INFINITE, PointId};

use super::Run;
use crate::activity_execution::Ends;
use crate::plan_network::PlanError;

/// When an activity under way can end, as its driver tells.
pub(super) struct Arrival {
    end: PointId,
    /// In ticks.
    at: i64,
    /// How long after each point it ends at the latest, in ticks.
    after: Vec<i64>,
}

impl Run<'_> {
    /// Asks those under way when they arrive.
    pub(super) fn note_arrivals(&mut self) -> Result<(), PlanError> {
        self.arrivals.clear();
        for (occurrence, ends) in &self.executions {
            let Ends::NotBefore(duration) = ends else { continue };
            let described = &self.stage.network.occurrences[occurrence.index()];
            let [started, ended] =
                [described.start, described.end].map(|node| self.stage.times[node.index()]);
            let (Some(started), None) = (started, ended) else { continue };
            let Some(end) = self.stage.made.point(described.end) else { continue };
            let too_late = |_: Overflow| PlanError::TooLate { event: format!("{}.end", described.name) };
            let at = started.checked_add(*duration).ok_or(Overflow).map_err(too_late)?;
            let at = self.stage.made.scale().ticks(at).map_err(too_late)?;
            let mut after = Vec::new();
            self.stage.made.stn.distances_to(end, &mut after)?;
            self.arrivals.push(Arrival { end, at, after });
        }
        Ok(())
    }

    /// The earliest time at which a point leaves all those under way the time to arrive.
    pub(super) fn leaving_time(&self, point: PointId) -> Option<Time> {
        let others = self.arrivals.iter().filter(|arrival| arrival.end != point);
        let times = others.filter_map(|arrival| {
            let after = arrival.after.get(point.index()).copied().filter(|&after| after != INFINITE)?;
            arrival.at.checked_sub(after)
        });
        times.max().map(|ticks| self.stage.made.time(ticks))
    }
}
