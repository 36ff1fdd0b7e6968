//! A plan's activities with their times, as schedules for people and other tools list them.

use exact::Bound;
use tpn::{Network, OccurrenceId, OccurrenceKind, Plan, Window};

/// An activity, assertion or delay that a plan selects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scheduled {
    pub occurrence: OccurrenceId,
    /// When it may begin. Under the earliest schedule it begins at the earliest time.
    pub start: Window,
    /// When it may be over.
    pub end: Window,
}

/// Returns what a plan selects, by earliest start; at the same time what lasts longer comes first.
pub fn scheduled(network: &Network, plan: &Plan) -> Vec<Scheduled> {
    let window = |node: tpn::NodeId| plan.windows.get(node.index()).copied().flatten();
    let mut found: Vec<Scheduled> = network
        .occurrences
        .iter()
        .enumerate()
        .filter(|(_, it)| it.kind != OccurrenceKind::Scope)
        .filter_map(|(index, it)| {
            let occurrence = OccurrenceId::from_index(index);
            Some(Scheduled { occurrence, start: window(it.start)?, end: window(it.end)? })
        })
        .collect();
    found.sort_by_key(|it| (it.start.earliest, std::cmp::Reverse(it.end.earliest), it.occurrence));
    found
}

/// Returns how much later than its earliest time an event with this window may happen.
pub fn slack(window: Window) -> Bound {
    window.latest.checked_sub(window.earliest).unwrap_or(Bound::Infinite)
}
