//! Pins in a plan in which nature chooses nothing.
//!
//! A pin of event `e` at `t` adds `e − origin = t`. With the distances of the other constraints, the windows that
//! remain are a minimum each (a shortest path from the origin uses the new constraint at most once):
//! `latest(x) = min(latest(x), t + d(e, x))` and `earliest(x) = max(earliest(x), t − d(x, e))`. So one pair of rows,
//! computed when an event is grabbed, answers every later move in time linear in the events.

use std::collections::BTreeMap;

use exact::Time;
use stn::{Checkpoint, INFINITE, Window};
use tpn::{Network, NodeId, Plan};

use crate::plan_network::{ADDED, PlanError, PlanNetwork};

/// The pins, and the plan's constraints under them.
#[derive(Clone, Debug)]
pub(super) struct Pins {
    constraints: PlanNetwork,
    /// The plan's own constraints; pins come after them.
    plan_only: Checkpoint,
    /// In ticks from the start.
    pinned: BTreeMap<NodeId, i64>,
    /// Under all pins, by point.
    windows: Vec<Window>,
    grabbed: Option<Grabbed>,
}

/// The event that is being moved.
#[derive(Clone, Debug)]
struct Grabbed {
    node: NodeId,
    /// Where it was pinned before, if it was.
    before: Option<i64>,
    /// Its window under the other pins.
    window: Window,
    /// All windows under the other pins, by point.
    others: Vec<Window>,
    /// Distances from the event to every point, and back.
    from: Vec<i64>,
    to: Vec<i64>,
}

impl Pins {
    pub(super) fn new(network: &Network, plan: &Plan, step: Time) -> Result<Self, PlanError> {
        let mut constraints = PlanNetwork::new(network, plan)?;
        let mut finer = constraints.clone();
        if finer.refine_for(network, plan, &[step]).is_ok() {
            constraints = finer;
        }
        let plan_only = constraints.stn.checkpoint();
        let windows = constraints.stn.windows(constraints.origin())?;
        Ok(Self { constraints, plan_only, pinned: BTreeMap::new(), windows, grabbed: None })
    }

    pub(super) fn grab(&mut self, node: NodeId) -> Option<tpn::Window> {
        self.drop_grabbed();
        let point = self.constraints.point(node)?;
        let before = self.pinned.remove(&node);
        let grabbed = self.insert_pins().and_then(|()| {
            let others = self.constraints.stn.windows(self.constraints.origin())?;
            let (mut from, mut to) = (Vec::new(), Vec::new());
            self.constraints.stn.distances_from(point, &mut from)?;
            self.constraints.stn.distances_to(point, &mut to)?;
            Ok(Grabbed { node, before, window: others[point.index()], others, from, to })
        });
        if let Some(time) = before {
            self.pinned.insert(node, time);
        }
        let grabbed = grabbed.ok()?;
        let window = self.constraints.window(grabbed.window);
        self.grabbed = Some(grabbed);
        Some(window)
    }

    pub(super) fn move_to(&mut self, time: Time) -> Option<Time> {
        let grabbed = self.grabbed.as_ref()?;
        let wanted = self.constraints.scale().nearest_tick(time);
        let latest = grabbed.window.latest.unwrap_or(i64::MAX / 4);
        let ticks = wanted.min(latest).max(grabbed.window.earliest.unwrap_or(0));
        let rows = grabbed.others.iter().zip(&grabbed.from).zip(&grabbed.to);
        let narrowed = rows.map(|((&other, &from), &to)| Window {
            earliest: later(other.earliest, finite(to).and_then(|to| ticks.checked_sub(to))),
            latest: sooner(other.latest, finite(from).and_then(|from| ticks.checked_add(from))),
        });
        self.windows.clear();
        self.windows.extend(narrowed);
        self.pinned.insert(grabbed.node, ticks);
        Some(self.constraints.time(ticks))
    }

    pub(super) fn drop_grabbed(&mut self) {
        self.grabbed = None;
    }

    pub(super) fn put_back(&mut self) -> bool {
        let Some(grabbed) = self.grabbed.take() else { return false };
        match grabbed.before {
            Some(time) => self.pinned.insert(grabbed.node, time),
            None => self.pinned.remove(&grabbed.node),
        };
        self.propagate();
        true
    }

    pub(super) fn release(&mut self, node: NodeId) {
        self.drop_grabbed();
        self.pinned.remove(&node);
        self.propagate();
    }

    pub(super) fn release_all(&mut self) {
        self.drop_grabbed();
        self.pinned.clear();
        self.propagate();
    }

    pub(super) fn all(&self) -> Vec<(NodeId, Time)> {
        self.pinned.iter().map(|(&node, &ticks)| (node, self.constraints.time(ticks))).collect()
    }

    pub(super) fn grabbed(&self) -> Option<(NodeId, tpn::Window)> {
        self.grabbed.as_ref().map(|grabbed| (grabbed.node, self.constraints.window(grabbed.window)))
    }

    pub(super) fn windows(&self, num_nodes: usize) -> Vec<Option<tpn::Window>> {
        let window = |node: NodeId| {
            let point = self.constraints.point(node)?;
            self.windows.get(point.index()).map(|&window| self.constraints.window(window))
        };
        (0..num_nodes).map(|index| window(NodeId::from_index(index))).collect()
    }

    /// Makes the constraint network hold exactly the plan and the pins.
    fn insert_pins(&mut self) -> Result<(), PlanError> {
        self.constraints.stn.rollback(self.plan_only);
        let origin = self.constraints.origin();
        for (&node, &ticks) in &self.pinned {
            let point = self.constraints.point(node).ok_or(PlanError::Inconsistent)?;
            self.constraints.stn.constrain(origin, point, ticks, Some(ticks), ADDED)?;
        }
        Ok(())
    }

    fn propagate(&mut self) {
        let windows = self.insert_pins().and_then(|()| {
            let origin = self.constraints.origin();
            Ok(self.constraints.stn.windows(origin)?)
        });
        // Pins lie inside the windows that the others left them: they cannot contradict.
        if let Ok(windows) = windows {
            self.windows = windows;
        }
    }
}

fn finite(distance: i64) -> Option<i64> {
    (distance != INFINITE).then_some(distance)
}

fn later(one: Option<i64>, other: Option<i64>) -> Option<i64> {
    one.max(other)
}

fn sooner(one: Option<i64>, other: Option<i64>) -> Option<i64> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.min(other)),
        (one, other) => one.or(other),
    }
}
