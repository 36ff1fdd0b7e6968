//! What remains possible of a plan whose durations nature chooses, once some of its events have happened (SPEC 13.2): the
//! network of what is left, dispatched from the present on.

use std::sync::Arc;

use controllability::{PlanNetwork as Uncertain, Side, Source, plan_network};
use exact::{Bound, Time};
use stnu::adversary::residual;
use stnu::{Dispatchable, Dispatcher, PointId, Status, Verdict};
use tpn::{ArcId, Network, NodeId, Plan, Window};

use crate::plan_network::{PlanError, PlanNetwork};
use crate::progress::{Observations, Progress, Waiting};

/// The progress of a plan some of whose durations nature chooses; `None` if it chooses none. `windows` are those under
/// which it chooses nothing.
pub(crate) fn uncertain_progress(
    network: &Network,
    plan: &Plan,
    made: &PlanNetwork,
    windows: &[Option<Window>],
    observed: &Observations,
) -> Result<Option<Progress>, PlanError> {
    let scale = made.scale();
    let read = plan_network(network, &plan.selected_arcs, &plan.precedences(network), scale)?;
    if read.is_certain() {
        return Ok(None);
    }
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
        // What must have come before something reported has come; nobody knows when, and so as early as it may have.
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
        let parts = conflict.members.iter().map(|member| member.part);
        return Ok(Some(Progress::Violated(explain(network, &read, &left, parts, observed))));
    }
    let Some(form) = Dispatchable::new(&left, &mut || false)? else {
        return Ok(Some(Progress::Violated(vec!["nature may break the plan".to_owned()])));
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
        for link in awaited {
            // What is left has the plan's links that have not ended, in their order.
            let activation = left.link(link).activation;
            let Some(natures) = natures_arc(&read, left.link(link).end) else { continue };
            let began = dispatcher.times()[activation.index()];
            let until = dispatcher.form().waits.iter().find(|wait| wait.point == own && wait.link == link);
            if let (Some(began), Some(wait)) = (began, until) {
                let until = began.checked_add(wait.until).ok_or(PlanError::Overflow)?;
                let is_named = !network.nodes[node.index()].events.is_empty();
                if is_named {
                    waits.push(Waiting { event: node, natures, until: scale.time(until) });
                }
            }
        }
    }
    waits.sort_by_key(|wait| (wait.event, wait.natures));
    Ok(Some(Progress::Consistent(by_node, waits)))
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

/// Why nature may break what is left, in terms of the plan.
fn explain(
    network: &Network,
    read: &Uncertain,
    left: &stnu::Network,
    parts: impl Iterator<Item = stnu::Part>,
    observed: &Observations,
) -> Vec<String> {
    let name = |node| tpn::plan_json::node_name(network, node);
    let mut reasons = Vec::new();
    let mut add = |reason: String| {
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    };
    for part in parts {
        let source = match part {
            // The first edges of what is left are the plan's.
            stnu::Part::Edge(id) if id.index() < read.network.edges().len() => read.source(part),
            stnu::Part::Edge(_) => continue,
            stnu::Part::Lower(id) | stnu::Part::Upper(id) => match natures_arc(read, left.link(id).end) {
                Some(arc) => Source::Arc(arc, Side::Lower),
                None => continue,
            },
        };
        match source {
            Source::Arc(arc, _) | Source::Tie(arc) => {
                let is_natures = network.is_uncertain(arc);
                let arc = &network.arcs[arc.index()];
                let (from, to) = (name(arc.from), name(arc.to));
                let (lower, upper) = (Bound::Finite(arc.lower), arc.upper);
                let who = if is_natures { ", as nature chooses" } else { "" };
                add(format!("{to} comes [{lower}, {upper}] after {from}{who}"));
            }
            Source::Precedence(_) => {}
        }
    }
    let happened = observed
        .executed
        .iter()
        .map(|&(node, time): &(NodeId, Time)| format!("{} happened at {}", name(node), Bound::Finite(time)));
    std::iter::once("nature may break what is left of the plan".to_owned())
        .chain(happened)
        .chain(reasons)
        .collect()
}
