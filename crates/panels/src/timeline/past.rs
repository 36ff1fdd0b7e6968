//! What a run had started under an earlier plan, and the plan that it follows now no longer has.

use std::collections::BTreeMap;

use executive::Happening;
use layout::timeline::Past;
use snapshot::Execution;
use tpn::{OccurrenceId, OccurrenceKind};

/// Returns what of `run` had started before it replanned, and is not in the plan that is followed at `time`.
pub(super) fn of_run(run: &Execution, time: f64) -> Vec<Past> {
    let Some((number, now)) = run.plan_at(time) else { return Vec::new() };
    let ids: BTreeMap<&str, OccurrenceId> = (0..now.network.occurrences.len())
        .map(OccurrenceId::from_index)
        .map(|id| (now.network.occurrences[id.index()].name.as_str(), id))
        .collect();
    let is_followed = |id: OccurrenceId| {
        let start = now.network.occurrences[id.index()].start;
        now.plan.selected_nodes.get(start.index()) == Some(&true)
    };
    let mut found: BTreeMap<OccurrenceId, Past> = BTreeMap::new();
    for pair in run.plans[..=number].windows(2) {
        let (plan, next) = (&pair[0], &pair[1]);
        let at = |node: tpn::NodeId| plan.times.get(node.index()).copied().flatten();
        for occurrence in &plan.network.occurrences {
            let is_selected = plan.plan.selected_nodes.get(occurrence.start.index()) == Some(&true);
            let id = ids.get(occurrence.name.as_str()).copied().filter(|&id| !is_followed(id));
            let (Some(id), Some(start)) = (id, at(occurrence.start)) else { continue };
            if occurrence.kind != OccurrenceKind::Primitive || !is_selected {
                continue;
            }
            // Ending it early may take a while.
            let is_its_end = |entry: &&executive::Entry| {
                let is_its =
                    matches!(&entry.happening, Happening::Progress { name, .. } if *name == occurrence.name);
                is_its && entry.time >= next.from
            };
            let stopped =
                || run.log.iter().filter(is_its_end).map(|entry| entry.time).max().unwrap_or(next.from);
            let end = at(occurrence.end);
            let times = [start, end.unwrap_or_else(stopped)].map(exact::Time::to_f64);
            found.insert(id, Past { occurrence: id, times, is_aborted: end.is_none() });
        }
    }
    found.into_values().collect()
}
