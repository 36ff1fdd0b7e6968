//! Pins in a plan in which the environment chooses nothing.
//!
//! A pin of event `e` at `t` adds `e − origin = t`. With the distances of the other constraints, the windows that
//! remain are a minimum each (a shortest path from the origin uses the new constraint at most once):
//! `latest(x) = min(latest(x), t + d(e, x))` and `earliest(x) = max(earliest(x), t − d(x, e))`. So one pair of rows,
//! computed when an event is grabbed, answers every later move in time linear in the events.

use exact::{Scale, Time};
use stn::{Checkpoint, INFINITE, Window};
use tpn::{Network, NodeId, Plan};

use super::Pins;
use crate::dispatch::NEVER;
use crate::plan_network::{ADDED, PlanError, PlanNetwork};

/// The plan's constraints under pins.
#[derive(Clone, Debug)]
pub(super) struct Constrained {
    constraints: PlanNetwork,
    /// The plan's own constraints; pins come after them.
    plan_only: Checkpoint,
    /// Under all pins, by point.
    windows: Vec<Window>,
    held: Held,
}

/// What moving the event that was grabbed last needs.
#[derive(Clone, Debug, Default)]
struct Held {
    /// All windows under the other pins, by point.
    others: Vec<Window>,
    /// Distances from the event to every point, and back.
    from: Vec<i64>,
    to: Vec<i64>,
}

impl Constrained {
    pub(super) fn new(network: &Network, plan: &Plan, step: Time) -> Result<Self, PlanError> {
        let mut constraints = PlanNetwork::new(network, plan)?;
        let mut finer = constraints.clone();
        if finer.refine_for(network, plan, &[step]).is_ok() {
            constraints = finer;
        }
        let plan_only = constraints.stn.checkpoint();
        let windows = constraints.stn.windows(constraints.origin())?;
        Ok(Self { constraints, plan_only, windows, held: Held::default() })
    }

    pub(super) const fn scale(&self) -> Scale {
        self.constraints.scale()
    }

    /// Takes hold of an event under the pins of others; its window.
    pub(super) fn hold(&mut self, node: NodeId, others: &Pins) -> Option<(i64, i64)> {
        let point = self.constraints.point(node)?;
        let others = self.constrain(others).ok()?;
        let (mut from, mut to) = (Vec::new(), Vec::new());
        self.constraints.stn.distances_from(point, &mut from).ok()?;
        self.constraints.stn.distances_to(point, &mut to).ok()?;
        let Window { earliest, latest } = others[point.index()];
        self.held = Held { others, from, to };
        Some((earliest.unwrap_or(0), latest.unwrap_or(NEVER)))
    }

    /// The held event is pinned to another time of its window.
    pub(super) fn move_held(&mut self, ticks: i64, _: &Pins) {
        let finite = |distance: i64| (distance != INFINITE).then_some(distance);
        let rows = self.held.others.iter().zip(&self.held.from).zip(&self.held.to);
        let narrowed = rows.map(|((other, &from), &to)| {
            let latest = finite(from).and_then(|from| ticks.checked_add(from));
            Window {
                earliest: other.earliest.max(finite(to).and_then(|to| ticks.checked_sub(to))),
                latest: other.latest.into_iter().chain(latest).min(),
            }
        });
        self.windows.clear();
        self.windows.extend(narrowed);
    }

    /// All windows follow the pins.
    pub(super) fn follow(&mut self, pins: &Pins) {
        // Pins lie inside the windows that the others left them: they cannot contradict.
        if let Ok(windows) = self.constrain(pins) {
            self.windows = windows;
        }
    }

    pub(super) fn windows(&self, num_nodes: usize) -> Vec<Option<tpn::Window>> {
        let window = |node: NodeId| {
            let point = self.constraints.point(node)?;
            self.windows.get(point.index()).map(|&window| self.constraints.window(window))
        };
        (0..num_nodes).map(|index| window(NodeId::from_index(index))).collect()
    }

    /// Makes the constraint network hold exactly the plan and the pins; all windows.
    fn constrain(&mut self, pins: &Pins) -> Result<Vec<Window>, PlanError> {
        self.constraints.stn.rollback(self.plan_only);
        let origin = self.constraints.origin();
        for (&node, &ticks) in pins {
            let point = self.constraints.point(node).ok_or(PlanError::Inconsistent)?;
            self.constraints.stn.constrain(origin, point, ticks, Some(ticks), ADDED)?;
        }
        Ok(self.constraints.stn.windows(origin)?)
    }
}
