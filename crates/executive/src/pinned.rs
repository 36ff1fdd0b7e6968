//! What is left of a plan's windows when some of its events are pinned to times: the live answer to dragging an event.
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

/// A plan some of whose events are pinned to times. The pins never contradict the plan or each other.
#[derive(Clone, Debug)]
pub struct PinnedPlan {
    constraints: PlanNetwork,
    /// The plan's own constraints; pins come after them.
    plan_only: Checkpoint,
    /// In ticks from the start.
    pins: BTreeMap<NodeId, i64>,
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

impl PinnedPlan {
    /// A plan without pins. Times are resolved to a tenth of the mission's unit or finer, where 64 bits allow it.
    pub fn new(network: &Network, plan: &Plan) -> Result<Self, PlanError> {
        let mut constraints = PlanNetwork::new(network, plan)?;
        let mut finer = constraints.clone();
        let tenth = Time::ONE.checked_div(10).unwrap_or_default();
        if finer.refine_for(network, plan, &[tenth]).is_ok() {
            constraints = finer;
        }
        let plan_only = constraints.stn.checkpoint();
        let windows = constraints.stn.windows(constraints.origin())?;
        Ok(Self { constraints, plan_only, pins: BTreeMap::new(), windows, grabbed: None })
    }

    /// Takes hold of an event and answers the window that the other pins leave it: [`PinnedPlan::move_to`] moves it
    /// within. `None` for an event that the plan does not select or whose time is not free.
    pub fn grab(&mut self, node: NodeId) -> Option<tpn::Window> {
        self.drop_grabbed();
        let point = self.constraints.point(node)?;
        let before = self.pins.remove(&node);
        let grabbed = self.insert_pins().and_then(|()| {
            let others = self.constraints.stn.windows(self.constraints.origin())?;
            let (mut from, mut to) = (Vec::new(), Vec::new());
            self.constraints.stn.distances_from(point, &mut from)?;
            self.constraints.stn.distances_to(point, &mut to)?;
            Ok(Grabbed { node, before, window: others[point.index()], others, from, to })
        });
        if let Some(time) = before {
            self.pins.insert(node, time);
        }
        let grabbed = grabbed.ok()?;
        let window = self.constraints.window(grabbed.window);
        self.grabbed = Some(grabbed);
        Some(window)
    }

    /// Pins the grabbed event to the moment of its window that is nearest to `time`, and narrows all other windows.
    /// Answers the moment; `None` if nothing is grabbed.
    pub fn move_to(&mut self, time: Time) -> Option<Time> {
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
        self.pins.insert(grabbed.node, ticks);
        Some(self.constraints.time(ticks))
    }

    /// Lets go of the grabbed event; it stays where it is.
    pub fn drop_grabbed(&mut self) {
        self.grabbed = None;
    }

    /// Puts the grabbed event back where it was before it was grabbed. Returns whether one was grabbed.
    pub fn put_back(&mut self) -> bool {
        let Some(grabbed) = self.grabbed.take() else { return false };
        match grabbed.before {
            Some(time) => self.pins.insert(grabbed.node, time),
            None => self.pins.remove(&grabbed.node),
        };
        self.propagate();
        true
    }

    /// Takes away the pin of an event.
    pub fn release(&mut self, node: NodeId) {
        self.drop_grabbed();
        self.pins.remove(&node);
        self.propagate();
    }

    /// Takes away all pins.
    pub fn release_all(&mut self) {
        self.drop_grabbed();
        self.pins.clear();
        self.propagate();
    }

    /// The pinned events and their times, in the order of the events.
    pub fn pins(&self) -> impl Iterator<Item = (NodeId, Time)> + '_ {
        self.pins.iter().map(|(&node, &ticks)| (node, self.constraints.time(ticks)))
    }

    /// The event that is being moved, and its window under the other pins.
    pub fn grabbed(&self) -> Option<(NodeId, tpn::Window)> {
        self.grabbed.as_ref().map(|grabbed| (grabbed.node, self.constraints.window(grabbed.window)))
    }

    /// The windows under all pins, in the form of [`Plan::windows`].
    pub fn windows(&self, num_nodes: usize) -> Vec<Option<tpn::Window>> {
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
        for (&node, &ticks) in &self.pins {
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
