//! Instants of executions: which events have come, and when that can be.
//!
//! Whatever bounds an instant bounds it from one event at a time, so an instant fits between some events if it fits
//! between each two of them: no cycle of constraints passes it twice.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use executive::PlanNetwork;
use executive::plan_network::ADDED;
use stn::INFINITE;
use tpn::{Network, NodeId, Plan};

use super::Stretch;

/// An instant that must not touch an event is at least one of so many parts of a tick away from it. Everything else is whole
/// ticks apart, and a cycle of constraints has such a distance at most twice: before the instant and after it.
pub(super) const PARTS: i64 = 4;

/// On which side of an instant an event lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) node: NodeId,
    /// So many ticks after the event.
    pub(super) offset: i64,
    /// Whether it has come; otherwise it is to come.
    pub(super) is_past: bool,
    /// Whether it may be at the very instant.
    pub(super) may_touch: bool,
}

impl Edge {
    /// The event has come.
    pub(super) const fn past(node: NodeId, may_touch: bool) -> Self {
        Self { node, offset: 0, is_past: true, may_touch }
    }

    /// The event is to come.
    pub(super) const fn future(node: NodeId, may_touch: bool) -> Self {
        Self { node, offset: 0, is_past: false, may_touch }
    }

    /// So many ticks after the event.
    pub(super) const fn after(self, offset: i64) -> Self {
        Self { offset, ..self }
    }

    /// Returns what is so exactly where this is not.
    pub(super) const fn negated(self) -> Self {
        Self { is_past: !self.is_past, may_touch: !self.may_touch, ..self }
    }
}

/// When the events of a plan can be, in ticks.
pub(super) struct Times {
    network: PlanNetwork,
    start: NodeId,
    /// The distances from an event, once they have been asked for.
    rows: BTreeMap<NodeId, Vec<i64>>,
}

impl Times {
    /// `None` where times do not fit. `named` are the times that a rule names.
    pub(super) fn new(network: &Network, plan: &Plan, named: &[Time]) -> Option<Self> {
        let start = network.start;
        // Drivers may need longer than at the least speed, so that only the mission bounds their drives.
        let network = executive::without_vertex_deadlines(network);
        let mut times = PlanNetwork::new(&network, plan).ok()?;
        times.refine_for(&network, plan, named).ok()?;
        Some(Self { network: times, start, rows: BTreeMap::new() })
    }

    /// The start of the mission.
    pub(super) const fn start(&self) -> NodeId {
        self.start
    }

    /// A time in ticks.
    pub(super) fn ticks(&self, time: Time) -> Option<i64> {
        self.network.scale().ticks(time).ok()
    }

    /// Returns how much later than `from` the event `to` can be at most; `None` for any time.
    fn most(&mut self, from: NodeId, to: NodeId) -> Option<i64> {
        let point = self.network.point(to)?;
        if !self.rows.contains_key(&from) {
            let mut row = Vec::new();
            let source = self.network.point(from)?;
            // Times that do not fit are kept as any time, which only ever lets a rule be broken.
            if self.network.stn.distances_from(source, &mut row).is_err() {
                row = vec![INFINITE; row.len()];
            }
            self.rows.insert(from, row);
        }
        let distance = self.rows.get(&from)?.get(point.index()).copied().unwrap_or(INFINITE);
        (distance != INFINITE).then_some(distance)
    }

    /// Returns whether an instant can lie between an event that has come and one that is to come.
    pub(super) fn fits(&mut self, past: Edge, future: Edge) -> bool {
        match self.most(past.node, future.node) {
            None => true,
            Some(most) => {
                let room = i128::from(most) + i128::from(future.offset) - i128::from(past.offset);
                room > 0 || (room == 0 && past.may_touch && future.may_touch)
            }
        }
    }

    /// The earliest tick at which the event can be.
    pub(super) fn earliest(&mut self, node: NodeId) -> i64 {
        // An event that nothing bounds from below cannot come before the start.
        self.most(node, self.start).map_or(0, |distance| -distance)
    }

    /// The latest tick at which the event can be, if it cannot be at any.
    pub(super) fn latest(&mut self, node: NodeId) -> Option<i64> {
        self.most(self.start, node)
    }

    /// The times of an instant between these events, in ticks: whatever lies between can be.
    pub(super) fn range(&mut self, past: &[Edge], future: &[Edge]) -> (i64, Option<i64>) {
        let mut from = 0;
        for edge in past {
            from = from.max(self.earliest(edge.node).saturating_add(edge.offset));
        }
        let mut to: Option<i64> = None;
        for edge in future {
            let latest = self.latest(edge.node).map(|latest| latest.saturating_add(edge.offset));
            to = match (to, latest) {
                (Some(to), Some(latest)) => Some(to.min(latest)),
                (to, latest) => to.or(latest),
            };
        }
        (from, to)
    }

    /// The earliest times of an execution that has an instant between these events, by node; `None` if there is none, or if
    /// times do not fit. If that can be, a path is driven as fast as its segments say.
    pub(super) fn execution(
        &self,
        network: &Network,
        plan: &Plan,
        edges: &[Edge],
    ) -> Option<Vec<Option<Time>>> {
        let strict = PlanNetwork::new(network, plan).ok();
        let strict = strict.and_then(|points| self.execution_of(points, network, plan, edges));
        strict.or_else(|| self.execution_of(self.network.clone(), network, plan, edges))
    }

    fn execution_of(
        &self,
        mut fine: PlanNetwork,
        network: &Network,
        plan: &Plan,
        edges: &[Edge],
    ) -> Option<Vec<Option<Time>>> {
        let part = Time::new(1, self.network.scale().ticks_per_unit().checked_mul(PARTS)?)?;
        fine.refine_for(network, plan, &[part]).ok()?;
        for past in edges.iter().filter(|edge| edge.is_past) {
            for future in edges.iter().filter(|edge| !edge.is_past) {
                let least = past.offset.checked_sub(future.offset)?.checked_mul(PARTS)?;
                let least = least.checked_add(i64::from(!(past.may_touch && future.may_touch)))?;
                if past.node != future.node {
                    let (from, to) = (fine.point(past.node)?, fine.point(future.node)?);
                    fine.stn.constrain(from, to, least, None, ADDED).ok()?;
                } else if least > 0 {
                    return None;
                }
            }
        }
        let mut distances = Vec::new();
        fine.stn.distances_to(fine.origin(), &mut distances).ok()?;
        let mut times = vec![None; network.nodes.len()];
        for point in fine.all_points() {
            let distance = distances.get(point.index()).copied().filter(|&distance| distance != INFINITE);
            times[fine.node(point).index()] = Some(fine.time(-distance.unwrap_or(0)));
        }
        Some(times)
    }

    /// A range of ticks as a stretch of time.
    pub(super) fn stretch(&self, (from, to): (i64, Option<i64>)) -> Stretch {
        let to = to.map_or(Bound::Infinite, |to| Bound::Finite(self.network.time(to)));
        Stretch { from: self.network.time(from), to }
    }
}

/// Stretches in order, those that touch made one.
pub(super) fn joined(mut stretches: Vec<Stretch>) -> Vec<Stretch> {
    stretches.sort_by_key(|it| (it.from, it.to));
    let mut joined: Vec<Stretch> = Vec::new();
    for stretch in stretches {
        match joined.last_mut() {
            Some(last) if Bound::Finite(stretch.from) <= last.to => last.to = last.to.max(stretch.to),
            _ => joined.push(stretch),
        }
    }
    joined
}
