//! The simple temporal network of a plan: the arcs it selects and what planning added, in exact integers.

use exact::{Bound, Scale, Time};
use stn::{Inconsistency, PointId, Stn, Window};
use stnu::Undecided;
use tpn::{ArcId, Network, NodeId, Plan, Precedence};

/// A plan's events as time points, with their constraints.
#[derive(Clone, Debug)]
pub struct PlanNetwork {
    /// The constraints; the tag of an arc's constraint is its id.
    pub stn: Stn,
    /// The point of each node, if the plan selects it.
    points: Vec<Option<PointId>>,
    /// The node of each point.
    nodes: Vec<NodeId>,
    scale: Scale,
    origin: PointId,
}

/// The tag of what planning added and of what was observed.
pub const ADDED: u32 = u32::MAX;

/// Why a plan cannot be executed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// Its constraints contradict each other: it is not a plan.
    #[error("the constraints of the plan are inconsistent")]
    Inconsistent,
    /// Its times do not fit.
    #[error("a time of the plan is too large to represent exactly")]
    Overflow,
    /// What the world makes of it does not fit.
    #[error("the time of {event} is too large to represent exactly")]
    TooLate { event: String },
}

impl From<stn::Overflow> for PlanError {
    fn from(_: stn::Overflow) -> Self {
        Self::Overflow
    }
}

impl From<exact::Overflow> for PlanError {
    fn from(_: exact::Overflow) -> Self {
        Self::Overflow
    }
}

impl From<Undecided> for PlanError {
    fn from(_: Undecided) -> Self {
        // No one stops it.
        Self::Overflow
    }
}

impl From<Inconsistency> for PlanError {
    fn from(inconsistency: Inconsistency) -> Self {
        match inconsistency {
            Inconsistency::NegativeCycle => Self::Inconsistent,
            Inconsistency::Overflow(_) => Self::Overflow,
        }
    }
}

impl PlanNetwork {
    /// The network of `plan`. Fails for a plan whose constraints contradict each other.
    pub fn new(network: &Network, plan: &Plan) -> Result<Self, PlanError> {
        let mut points = vec![None; network.nodes.len()];
        let mut nodes = Vec::new();
        for (index, &selected) in plan.selected_nodes.iter().enumerate() {
            if selected {
                points[index] = Some(PointId(nodes.len() as u32));
                nodes.push(NodeId::from_index(index));
            }
        }
        let scale = controllability::scale(network)?;
        let stn = Stn::new(nodes.len());
        let origin = points[network.start.index()].ok_or(PlanError::Inconsistent)?;
        let mut made = Self { stn, points, nodes, scale, origin };
        made.add_arcs(network, plan)?;
        made.add_decisions(network, plan)?;
        Ok(made)
    }

    fn add_arcs(&mut self, network: &Network, plan: &Plan) -> Result<(), PlanError> {
        for (index, arc) in network.arcs.iter().enumerate().filter(|&(index, _)| plan.selected_arcs[index]) {
            let lower = self.scale.ticks(arc.lower)?;
            let upper = self.scale.bound_ticks(arc.upper)?;
            let (Some(from), Some(to)) = (self.point(arc.from), self.point(arc.to)) else {
                return Err(PlanError::Inconsistent);
            };
            self.stn.constrain(from, to, lower, upper, ArcId::from_index(index).0)?;
        }
        Ok(())
    }

    /// Causal links and orderings: the constraints that planning added (SPEC 5.2, 5.3, 10.2, 11).
    fn add_decisions(&mut self, network: &Network, plan: &Plan) -> Result<(), PlanError> {
        for Precedence { earlier, later, least } in plan.precedences(network) {
            let gap = self.scale.ticks(least)?;
            let (Some(first), Some(then)) = (self.point(earlier), self.point(later)) else {
                return Err(PlanError::Inconsistent);
            };
            self.stn.constrain(first, then, gap, None, ADDED)?;
        }
        Ok(())
    }

    /// The point of a node, if the plan selects it.
    pub fn point(&self, node: NodeId) -> Option<PointId> {
        self.points.get(node.index()).copied().flatten()
    }

    /// The node of a point.
    pub fn node(&self, point: PointId) -> NodeId {
        self.nodes[point.index()]
    }

    /// All points.
    pub fn all_points(&self) -> impl Iterator<Item = PointId> + use<> {
        (0..self.nodes.len() as u32).map(PointId)
    }

    /// Returns what all times are relative to.
    pub const fn origin(&self) -> PointId {
        self.origin
    }

    /// The ticks of its times.
    pub const fn scale(&self) -> Scale {
        self.scale
    }

    /// A number of ticks as a time.
    pub fn time(&self, ticks: i64) -> Time {
        self.scale.time(ticks)
    }

    /// Makes ticks so fine that `time` is a whole number of them.
    pub fn refine_for(&mut self, network: &Network, plan: &Plan, times: &[Time]) -> Result<(), PlanError> {
        let scale = times.iter().try_fold(self.scale, |scale, &time| scale.refined(time))?;
        if scale != self.scale {
            self.scale = scale;
            self.stn = Stn::new(self.nodes.len());
            self.add_arcs(network, plan)?;
            self.add_decisions(network, plan)?;
        }
        Ok(())
    }

    /// A window in mission units.
    pub fn window(&self, window: Window) -> tpn::Window {
        tpn::Window {
            earliest: self.time(window.earliest.unwrap_or(0)),
            latest: window.latest.map_or(Bound::Infinite, |latest| Bound::Finite(self.time(latest))),
        }
    }
}
