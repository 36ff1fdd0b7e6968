//! What of a run has happened at a time: windows of what is to come, what is under way, what is waited for.

use std::sync::Arc;

use exact::{Bound, Time};
use executive::{Observations, Progress};
use kirk::{Outcome, Stats, Status};
use snapshot::{Executed, PartKeys, Planning, Snapshot};
use tpn::{EventEnd, EventRef, Network, NodeId, OccurrenceId, OccurrenceKind, Plan, Window};

use super::has_come;

/// What has happened, what is going on, and what is to come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment {
    /// Whether each node has happened, by node.
    pub happened: Vec<bool>,
    /// Activities that have been started and are not over.
    pub under_way: Vec<Pending>,
    /// Conditions that hold.
    pub holding: Vec<Pending>,
    /// Activities and conditions that have not started, those that may begin first in front.
    pub to_come: Vec<Pending>,
    /// The event that must happen first, and by when.
    pub deadline: Option<(EventRef, Time)>,
}

/// Something that is to begin or to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pending {
    pub occurrence: OccurrenceId,
    /// When it began, if it has.
    pub since: Option<Time>,
    /// When it can begin, or end if it has started.
    pub window: Window,
}

/// The run at `time`: a snapshot for the panels that draw plans, and what is going on.
pub(super) fn at(base: &Snapshot, executed: &Executed, time: f64) -> (Snapshot, Moment) {
    let network = &executed.network;
    let windows = windows(executed, time);
    let moment = moment(network, executed, &windows, time);
    let plan = Plan { windows, ..executed.plan.clone() };
    let outcome = Outcome {
        status: Status::Plan,
        plans: vec![plan],
        bound: None,
        failure: None,
        stats: base.planning.as_ref().map_or_else(Stats::default, |planning| planning.outcome.stats),
        trace: None,
        unplannable: None,
    };
    let planning = Planning {
        outcome,
        verdict: None,
        undrivable: Vec::new(),
        left_out: Vec::new(),
        repairs: Vec::new(),
    };
    let snapshot = Snapshot {
        revision: base.revision,
        stage: base.stage,
        source: Arc::clone(&base.source),
        problems: base.problems.clone(),
        program: Arc::clone(&base.program),
        network: Some(Arc::clone(network)),
        planning: Some(Arc::new(planning)),
        map: base.map.clone(),
        traverses: executed.traverses.clone().into(),
        motions: executed.motions.clone().into(),
        separation_violations: Arc::default(),
        // It belongs to a moment, and to no core.
        keys: PartKeys::default(),
        timings: base.timings,
    };
    (snapshot, moment)
}

/// When everything happened, or can happen, given what has.
fn windows(executed: &Executed, time: f64) -> Vec<Option<Window>> {
    let mut now = executed.from;
    let mut happened = Vec::new();
    for (index, at) in executed.times.iter().enumerate() {
        let is_selected = executed.plan.selected_nodes.get(index).copied().unwrap_or(false);
        if let Some(at) = at.filter(|&at| is_selected && has_come(at, time)) {
            now = now.max(at);
            happened.push((NodeId::from_index(index), at));
        }
    }
    let observed = Observations { executed: happened, now };
    let mut windows = match executive::progress(&executed.network, &executed.plan, &observed) {
        Ok(Progress::Consistent(windows, _)) => windows,
        // The plan is about to be given up: what it promised is still the best that is known.
        Ok(Progress::Violated(_)) | Err(_) => executed.plan.windows.clone(),
    };
    for (node, at) in observed.executed {
        windows[node.index()] = Some(Window { earliest: at, latest: Bound::Finite(at) });
    }
    windows
}

fn moment(network: &Network, executed: &Executed, windows: &[Option<Window>], time: f64) -> Moment {
    let happened: Vec<bool> =
        executed.times.iter().map(|at| at.is_some_and(|at| has_come(at, time))).collect();
    let came = |node: NodeId| happened.get(node.index()).copied().unwrap_or(false);
    let window = |node: NodeId| windows.get(node.index()).copied().flatten();
    let mut moment = Moment::default();
    let mut events = Vec::new();
    for (index, occurrence) in network.occurrences.iter().enumerate() {
        let is_activity = occurrence.kind == OccurrenceKind::Primitive;
        if !is_activity && occurrence.kind != OccurrenceKind::Assertion {
            continue;
        }
        // A condition that was withdrawn before it came is over as soon as it would have started: no one waits for it.
        let is_gone = |arc: &tpn::Arc| arc.upper == Bound::Finite(Time::ZERO);
        let arc = occurrence.arc.and_then(|arc| network.arcs.get(arc.index()));
        if !is_activity && arc.is_some_and(is_gone) {
            continue;
        }
        let id = OccurrenceId::from_index(index);
        let (Some(start), Some(end)) = (window(occurrence.start), window(occurrence.end)) else { continue };
        let since = executed.times.get(occurrence.start.index()).copied().flatten();
        match (came(occurrence.start), came(occurrence.end)) {
            (false, _) => {
                moment.to_come.push(Pending { occurrence: id, since: None, window: start });
                events.push((EventRef { occurrence: id, end: EventEnd::Start }, start));
            }
            (true, false) => {
                let pending = Pending { occurrence: id, since, window: end };
                if is_activity {
                    moment.under_way.push(pending);
                } else {
                    moment.holding.push(pending);
                }
                events.push((EventRef { occurrence: id, end: EventEnd::End }, end));
            }
            (true, true) => {}
        }
    }
    moment.to_come.sort_by_key(|pending| (pending.window.earliest, pending.occurrence));
    let finite = events.into_iter().filter_map(|(event, window)| Some((event, window.latest.finite()?)));
    moment.deadline = finite.min_by_key(|&(_, latest)| latest);
    moment.happened = happened;
    moment
}
