//! Dispatch of plans with many events, without the dispatchable form and its cubic time: windows are kept exact by
//! propagation along the plan's own constraints (SPEC 6.2). An event takes time linear in the windows that it changes.

use std::collections::VecDeque;
use std::sync::Arc;

use stn::PointId;

use crate::dispatch::{NEVER, SettleError};
use crate::plan_network::{PlanError, PlanNetwork};

/// The state of a dispatch.
#[derive(Clone, Debug)]
pub(crate) struct SparseDispatch {
    edges: Arc<Edges>,
    /// Of each point.
    windows: Vec<(i64, i64)>,
    is_settled: Vec<bool>,
    /// Points whose windows the last event changed.
    changed: Vec<PointId>,
    /// Windows before the event that is being settled, the earliest change first.
    trail: Vec<(u32, (i64, i64))>,
    open: VecDeque<u32>,
    is_open: Vec<bool>,
}

/// `to − from ≤ weight`, by either end.
#[derive(Debug, Default)]
struct Edges {
    out: Vec<Vec<(u32, i64)>>,
    into: Vec<Vec<(u32, i64)>>,
}

impl SparseDispatch {
    /// Prepares a plan for dispatch.
    pub(crate) fn new(plan: &mut PlanNetwork) -> Result<Self, PlanError> {
        let count = plan.stn.num_points();
        let mut edges = Edges { out: vec![Vec::new(); count], into: vec![Vec::new(); count] };
        for edge in (0..plan.stn.num_edges()).filter_map(|position| plan.stn.edge(position)) {
            edges.out[edge.from.index()].push((edge.to.0, edge.weight));
            edges.into[edge.to.index()].push((edge.from.0, edge.weight));
        }
        let origin = plan.origin();
        let windows = plan.stn.windows(origin)?;
        let windows = windows.iter().map(|it| (it.earliest.unwrap_or(0), it.latest.unwrap_or(NEVER)));
        Ok(Self {
            edges: Arc::new(edges),
            windows: windows.collect(),
            is_settled: vec![false; count],
            changed: Vec::new(),
            trail: Vec::new(),
            open: VecDeque::new(),
            is_open: vec![false; count],
        })
    }

    /// When a point may still happen.
    pub(crate) fn window(&self, point: PointId) -> (i64, i64) {
        self.windows[point.index()]
    }

    /// Whether the time of a point is settled.
    pub(crate) fn is_settled(&self, point: PointId) -> bool {
        self.is_settled[point.index()]
    }

    /// Whether everything that must come before a point has been settled, as far as one constraint says so.
    pub(crate) fn is_enabled(&self, point: PointId) -> bool {
        let mut out = self.edges.out[point.index()].iter();
        out.all(|&(to, weight)| weight >= 0 || self.is_settled[to as usize])
    }

    /// The points whose windows have changed since this was asked.
    pub(crate) fn take_changed(&mut self) -> Vec<PointId> {
        std::mem::take(&mut self.changed)
    }

    /// Settles the time of a point. Refused, with everything as before, where another point must come first that has not.
    pub(crate) fn settle(&mut self, point: PointId, ticks: i64) -> Result<(), SettleError> {
        let (earliest, latest) = self.window(point);
        if ticks < earliest || ticks > latest {
            return Err(SettleError::OutOfWindow { earliest, latest });
        }
        if std::mem::replace(&mut self.is_settled[point.index()], true) {
            return Ok(());
        }
        self.trail.clear();
        self.narrow(point.0, (ticks, ticks));
        let refused = self.propagate(ticks);
        if let Err(error) = refused {
            self.is_settled[point.index()] = false;
            for (point, window) in self.trail.drain(..).rev() {
                self.windows[point as usize] = window;
            }
            for point in self.open.drain(..) {
                self.is_open[point as usize] = false;
            }
            return Err(error);
        }
        self.changed.extend(self.trail.iter().map(|&(point, _)| PointId(point)));
        Ok(())
    }

    fn narrow(&mut self, point: u32, window: (i64, i64)) {
        let known = &mut self.windows[point as usize];
        if *known != window {
            self.trail.push((point, *known));
            *known = window;
        }
        if !std::mem::replace(&mut self.is_open[point as usize], true) {
            self.open.push_back(point);
        }
    }

    /// Carries changes of windows on to what they matter for. At `now`, nothing that is open may have had to come earlier.
    fn propagate(&mut self, now: i64) -> Result<(), SettleError> {
        let edges = Arc::clone(&self.edges);
        while let Some(point) = self.open.pop_front() {
            self.is_open[point as usize] = false;
            let (earliest, latest) = self.windows[point as usize];
            if latest != NEVER {
                for &(to, weight) in &edges.out[point as usize] {
                    let window = self.windows[to as usize];
                    let reached = latest.saturating_add(weight);
                    if reached < window.1 && !self.is_settled[to as usize] {
                        if reached < now {
                            return Err(SettleError::NotYet(PointId(to)));
                        }
                        self.narrow(to, (window.0, reached));
                    }
                }
            }
            for &(from, weight) in &edges.into[point as usize] {
                let window = self.windows[from as usize];
                let reached = earliest.checked_sub(weight).ok_or(SettleError::Overflow(PointId(from)))?;
                if reached > window.0 && !self.is_settled[from as usize] {
                    self.narrow(from, (reached, window.1));
                }
            }
        }
        Ok(())
    }
}
