//! What remains possible of a plan once some of its events have happened (SPEC 6.2). Where the environment chooses
//! durations, the network of what is left is dispatched from the present on (SPEC 13.2).

use std::sync::Arc;

use controllability::{PlanNetwork as Uncertain, Source, plan_network};
use exact::{Bound, Time};
use stn::{Execution, ExecutionWindows, PointId};
use stnu::adversary::residual;
use stnu::{Dispatchable, Dispatcher, Part, Status, Verdict};
use tpn::{ArcId, Network, NodeId, Plan, Window};

use crate::plan_network::{ADDED, PlanError, PlanNetwork};

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
    /// The windows of all selected events, by node, and what waits for the environment, in the order of nodes.
    Consistent(Vec<Option<Window>>, Vec<Waiting>),
    /// The plan is violated; why, naming events and times.
    Violated(Vec<String>),
}

/// An event that could happen earlier if the environment ended something earlier (SPEC 13.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Waiting {
    pub event: NodeId,
    /// For the end of which duration.
    pub natures: ArcId,
    /// Or until this time.
    pub until: Time,
}

/// The windows of `plan` after `observed`. Where the environment chooses durations they are those of its dispatch: at
/// the earliest as if the environment ended early what is waited for.
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
            return Ok(Progress::Violated(vec![format!("{name} is not an event of this plan")]));
        };
        executed.push((point, made.scale().ticks(time)?));
    }
    let now = made.scale().ticks(observed.now)?;
    let origin = made.origin();
    let known = Execution { origin, executed: &executed, pending: &[], now };
    let windows = match stn::execution_windows(&mut made.stn, known, ADDED)? {
        ExecutionWindows::Consistent(windows) => windows,
        ExecutionWindows::Violated(tags) => {
            return Ok(Progress::Violated(explain(network, observed, arcs(network, &tags))));
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
            let scale = made.scale();
            let read = plan_network(network, &plan.selected_arcs, &plan.precedences(network), scale)?;
            if read.is_certain() {
                return Ok(Progress::Consistent(by_node, Vec::new()));
            }
            uncertain(network, &made, &read, &by_node, observed)?
        }
        ExecutionWindows::Violated(tags) => {
            let mut reasons = explain(network, observed, arcs(network, &tags));
            for point in pending {
                let window = windows[point.index()];
                let node = made.node(point);
                if let Some(latest) = window.latest.filter(|&latest| latest < now)
                    && !network.nodes[node.index()].events.is_empty()
                {
                    let name = tpn::plan_json::node_name(network, node);
                    let latest = made.time(latest).readable();
                    let now = observed.now.readable();
                    reasons.insert(0, format!("{name} had to happen by {latest}, but it is already {now}"));
                }
            }
            Progress::Violated(reasons)
        }
    })
}

/// The arcs among the tags of constraints.
fn arcs(network: &Network, tags: &[u32]) -> impl Iterator<Item = (ArcId, &'static str)> {
    tags.iter().map(|&tag| ArcId(tag)).filter(|arc| arc.index() < network.arcs.len()).map(|arc| (arc, ""))
}

/// Returns what happened, and the bounds of arcs that contradict it, each with what is added to it.
fn explain<'a>(
    network: &Network,
    observed: &Observations,
    arcs: impl Iterator<Item = (ArcId, &'a str)>,
) -> Vec<String> {
    let name = |node| tpn::plan_json::node_name(network, node);
    let happened = |&(node, time): &(NodeId, Time)| format!("{} happened at {}", name(node), time.readable());
    let mut reasons: Vec<String> = observed.executed.iter().map(happened).collect();
    for (arc, who) in arcs {
        let arc = &network.arcs[arc.index()];
        let (from, to, lower) = (name(arc.from), name(arc.to), arc.lower.readable());
        let reason = format!("{to} must come [{lower}, {}] after {from}{who}", arc.upper.readable());
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}

/// The progress of a plan, `read` with the durations that the environment chooses. `windows` are those under which it
/// chooses nothing.
fn uncertain(
    network: &Network,
    made: &PlanNetwork,
    read: &Uncertain,
    windows: &[Option<Window>],
    observed: &Observations,
) -> Result<Progress, PlanError> {
    let scale = made.scale();
    let now = scale.ticks(observed.now)?;
    let reported = observed.executed.iter().map(|&(_, time)| scale.ticks(time));
    let last = reported.collect::<Result<Vec<i64>, _>>()?.into_iter().max().unwrap_or(0);
    let mut times: Vec<Option<i64>> = vec![None; read.network.num_points()];
    for (index, window) in windows.iter().enumerate() {
        let Some(point) = read.point(NodeId::from_index(index)) else { continue };
        let Some(Window { earliest, latest: Bound::Finite(latest) }) = *window else { continue };
        let (earliest, latest) = (scale.ticks(earliest)?, scale.ticks(latest)?);
        let is_told = observed.executed.iter().any(|(node, _)| node.index() == index);
        let natures = read.network.link_ending_at(point).map(|link| read.network.link(link));
        let is_seen = is_told || natures.is_none_or(|link| link.spread() == 0);
        // What must have come before something reported has come; no one knows when, and so as early as it may have.
        if latest <= last || (earliest == latest && latest <= now && is_seen) {
            times[point.index()] = Some(earliest);
        }
    }
    for (id, link) in (0..).map(stnu::LinkId).zip(read.network.links()) {
        if read.nodes(link.end).is_empty() {
            let end = network.arcs[read.arc(id).index()].to;
            times[link.end.index()] = read.point(end).and_then(|point| times[point.index()]);
        }
    }
    let left = residual(&read.network, &times, now)?;
    if let Verdict::Uncontrollable(conflict) = stnu::check(&left, &mut || false)? {
        let arcs = conflict.members.iter().filter_map(|member| broken(network, read, &left, member.part));
        let mut reasons = explain(network, observed, arcs);
        reasons.insert(0, "the rest of the plan is not controllable".to_owned());
        return Ok(Progress::Violated(reasons));
    }
    let Some(form) = Dispatchable::new(&left, &mut || false)? else {
        return Ok(Progress::Violated(vec!["the plan is not controllable".to_owned()]));
    };
    let origin = PointId(left.num_points() as u32 - 1);
    let mut dispatcher = Dispatcher::new(Arc::new(form), 0);
    let mut past: Vec<(i64, PointId)> = vec![(0, origin)];
    past.extend((0..).map(PointId).zip(&times).filter_map(|(point, time)| Some(((*time)?, point))));
    past.sort_by_key(|&(time, point)| (time, point != origin, point));
    enter(&mut dispatcher, &past).map_err(|()| PlanError::Inconsistent)?;
    dispatcher.advance(now).map_err(|_| PlanError::Inconsistent)?;
    let found = dispatcher.windows().map_err(|_| PlanError::Overflow)?;
    let mut by_node = vec![None; network.nodes.len()];
    let mut waits = Vec::new();
    for point in made.all_points() {
        let node = made.node(point);
        let Some(own) = read.point(node) else { continue };
        let window = found[own.index()];
        let latest = window.latest.map_or(Bound::Infinite, |latest| Bound::Finite(scale.time(latest)));
        by_node[node.index()] = Some(Window { earliest: scale.time(window.earliest), latest });
        let Status::Enabled { waits: awaited, .. } = dispatcher.status(own) else { continue };
        if network.nodes[node.index()].events.is_empty() {
            continue;
        }
        // What is left has the plan's links that have not ended, in their order.
        let natures = |link| natures_arc(read, left.link(link).end);
        waits.extend(awaited.into_iter().filter_map(|(link, until)| {
            Some(Waiting { event: node, natures: natures(link)?, until: scale.time(until) })
        }));
    }
    waits.sort_by_key(|wait| (wait.event, wait.natures));
    Ok(Progress::Consistent(by_node, waits))
}

/// The arc whose duration ends at a point of the plan's network.
fn natures_arc(read: &Uncertain, end: PointId) -> Option<ArcId> {
    read.network.link_ending_at(end).map(|link| read.arc(link))
}

/// Enters what has happened, in order of time; of what came at one instant some may have to be entered before others.
fn enter(dispatcher: &mut Dispatcher<Arc<Dispatchable>>, past: &[(i64, PointId)]) -> Result<(), ()> {
    let mut left = past.to_vec();
    while let Some(&(time, _)) = left.first() {
        dispatcher.advance(time).map_err(|_| ())?;
        let before = left.len();
        left.retain(|&(at, point)| at > time || dispatcher.execute(point).is_err());
        if left.len() == before {
            return Err(());
        }
    }
    Ok(())
}

/// The arc of the plan that a part of a conflict in what is left of it represents, with who chooses its duration.
fn broken(
    network: &Network,
    read: &Uncertain,
    left: &stnu::Network,
    part: Part,
) -> Option<(ArcId, &'static str)> {
    let arc = match part {
        // The first edges of what is left are the plan's.
        Part::Edge(id) if id.index() < read.network.edges().len() => match read.source(part) {
            Source::Arc(arc, _) | Source::Tie(arc) => arc,
            Source::Precedence(_) => return None,
        },
        Part::Edge(_) => return None,
        Part::Lower(id) | Part::Upper(id) => natures_arc(read, left.link(id).end)?,
    };
    Some((arc, if network.is_uncertain(arc) { " (uncontrolled)" } else { "" }))
}
