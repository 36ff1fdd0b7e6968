//! What remains possible of a plan once some of its events have happened (SPEC 6.2).

use exact::{Bound, Time};
use stn::{Execution, ExecutionWindows};
use tpn::{ArcId, Network, NodeId, Plan, Window};

use crate::plan_network::{ADDED, PlanError, PlanNetwork};
use crate::uncertain_progress::uncertain_progress;

/// What is known at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// Events that happened, and when.
    pub executed: Vec<(NodeId, Time)>,
    pub now: Time,
}

/// What remains possible.
#[derive(Clone, Debug, PartialEq)]
pub enum Progress {
    /// The windows of all selected events, by node, and what waits for nature, in the order of nodes.
    Consistent(Vec<Option<Window>>, Vec<Waiting>),
    /// The plan is violated; why, naming events and times.
    Violated(Vec<String>),
}

/// An event that could happen earlier if nature ended something earlier (SPEC 13.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    pub event: NodeId,
    /// For the end of which duration.
    pub natures: ArcId,
    /// Or until this time.
    pub until: Time,
}

/// The windows of `plan` after `observed`. Where nature chooses durations they are those of its dispatch: at the earliest
/// as if nature ended early what is waited for.
///
/// Events that are not reported have not happened, with two exceptions: an event whose time follows from what was
/// reported (its window is a single moment that has come), and one that must have come before something reported.
pub fn progress(network: &Network, plan: &Plan, observed: &Observations) -> Result<Progress, PlanError> {
    let mut made = PlanNetwork::new(network, plan)?;
    let mut times: Vec<Time> = observed.executed.iter().map(|&(_, time)| time).collect();
    times.push(observed.now);
    made.refine_for(network, plan, &times)?;
    let mut executed = Vec::new();
    for &(node, time) in &observed.executed {
        let Some(point) = made.point(node) else {
            let name = tpn::plan_json::node_name(network, node);
            return Ok(Progress::Violated(vec![format!("{name} is no event of this plan")]));
        };
        executed.push((point, made.scale().ticks(time)?));
    }
    let now = made.scale().ticks(observed.now)?;
    let origin = made.origin();
    let known = Execution { origin, executed: &executed, pending: &[], now };
    let windows = match stn::execution_windows(&mut made.stn, known, ADDED)? {
        ExecutionWindows::Consistent(windows) => windows,
        ExecutionWindows::Violated(tags) => {
            return Ok(Progress::Violated(explain(network, &made, observed, &tags)));
        }
    };
    let last = executed.iter().map(|&(_, time)| time).max().unwrap_or(0);
    let pending: Vec<_> = made
        .all_points()
        .filter(|point| !executed.iter().any(|(done, _)| done == point))
        .filter(|point| {
            let window = windows[point.index()];
            let (earliest, latest) = (window.earliest.unwrap_or(0), window.latest.unwrap_or(i64::MAX));
            let has_followed = earliest == latest && latest <= now;
            let came_before = latest <= last;
            !has_followed && !came_before
        })
        .collect();
    let known = Execution { origin, executed: &executed, pending: &pending, now };
    Ok(match stn::execution_windows(&mut made.stn, known, ADDED)? {
        ExecutionWindows::Consistent(windows) => {
            let mut by_node = vec![None; network.nodes.len()];
            for point in made.all_points() {
                by_node[made.node(point).index()] = Some(made.window(windows[point.index()]));
            }
            match uncertain_progress(network, plan, &made, &by_node, observed)? {
                Some(progress) => progress,
                None => Progress::Consistent(by_node, Vec::new()),
            }
        }
        ExecutionWindows::Violated(tags) => {
            let mut reasons = explain(network, &made, observed, &tags);
            for point in pending {
                let window = windows[point.index()];
                let node = made.node(point);
                if let Some(latest) = window.latest.filter(|&latest| latest < now)
                    && !network.nodes[node.index()].events.is_empty()
                {
                    let name = tpn::plan_json::node_name(network, node);
                    let latest = Bound::Finite(made.time(latest));
                    let now = Bound::Finite(observed.now);
                    reasons.insert(0, format!("{name} had to happen by {latest}, and it is {now}"));
                }
            }
            Progress::Violated(reasons)
        }
    })
}

fn explain(network: &Network, made: &PlanNetwork, observed: &Observations, tags: &[u32]) -> Vec<String> {
    let mut reasons: Vec<String> = Vec::new();
    for &(node, time) in &observed.executed {
        if made.point(node).is_some() {
            let name = tpn::plan_json::node_name(network, node);
            reasons.push(format!("{name} happened at {}", Bound::Finite(time)));
        }
    }
    for &tag in tags {
        let Some(arc) = network.arcs.get(tag as usize) else { continue };
        let (from, to) =
            (tpn::plan_json::node_name(network, arc.from), tpn::plan_json::node_name(network, arc.to));
        let lower = Bound::Finite(arc.lower);
        let reason = format!("{to} comes [{lower}, {}] after {from}", arc.upper);
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}
