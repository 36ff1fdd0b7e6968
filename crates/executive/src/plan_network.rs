//! The simple temporal network of a plan: the arcs it selects and what planning added, in exact integers.

use num_traits::ToPrimitive as _;
use rmpl::{Bound, Rational};
use stn::{Inconsistency, Overflow, PointId, Stn, Window};
use tpn::{ArcId, Network, NodeId, Plan};

/// A plan's events as time points, with their constraints.
#[derive(Clone, Debug)]
pub struct PlanNetwork {
    /// The constraints; the tag of an arc's constraint is its id.
    pub stn: Stn,
    /// The point of each node, if the plan selects it.
    points: Vec<Option<PointId>>,
    /// The node of each point.
    nodes: Vec<NodeId>,
    /// Integer ticks in one unit of the mission.
    ticks_per_unit: i64,
    origin: PointId,
}

/// The tag of what planning added and of what was observed.
pub const ADDED: u32 = u32::MAX;

/// Why a plan cannot be executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlanError {
    /// Its constraints contradict each other: it is no plan.
    #[error("the plan's constraints contradict each other")]
    Inconsistent,
    /// Its times do not fit.
    #[error("a time does not fit into 64 bits")]
    Overflow,
}

impl From<Overflow> for PlanError {
    fn from(_: Overflow) -> Self {
        Self::Overflow
    }
}

impl From<Inconsistency> for PlanError {
    fn from(inconsistency: Inconsistency) -> Self {
        match inconsistency {
            Inconsistency::NegativeCycle => Self::Inconsistent,
            Inconsistency::Overflow => Self::Overflow,
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
        let ticks_per_unit = common_denominator(network).ok_or(PlanError::Overflow)?;
        let stn = Stn::new(nodes.len());
        let origin = points[network.start.index()].ok_or(PlanError::Inconsistent)?;
        let mut made = Self { stn, points, nodes, ticks_per_unit, origin };
        made.add_arcs(network, plan)?;
        made.add_decisions(network, plan)?;
        Ok(made)
    }

    fn add_arcs(&mut self, network: &Network, plan: &Plan) -> Result<(), PlanError> {
        for (index, arc) in network.arcs.iter().enumerate().filter(|&(index, _)| plan.selected_arcs[index]) {
            let lower = self.ticks(arc.lower).ok_or(PlanError::Overflow)?;
            let upper = match arc.upper {
                Bound::Finite(upper) => Some(self.ticks(upper).ok_or(PlanError::Overflow)?),
                Bound::Infinite => None,
            };
            let (Some(from), Some(to)) = (self.point(arc.from), self.point(arc.to)) else {
                return Err(PlanError::Inconsistent);
            };
            self.stn.constrain(from, to, lower, upper, ArcId::from_index(index).0)?;
        }
        Ok(())
    }

    /// Causal links and orderings: the constraints that planning added (SPEC 5.2, 5.3).
    fn add_decisions(&mut self, network: &Network, plan: &Plan) -> Result<(), PlanError> {
        let ends = |label: tpn::LabelId| {
            let arc = &network.arcs[network.labels[label.index()].arc.index()];
            (arc.from, arc.to)
        };
        let mut before = |first: NodeId, then: NodeId, gap: Rational| {
            let gap = self.ticks(gap).ok_or(PlanError::Overflow)?;
            let (Some(first), Some(then)) = (self.point(first), self.point(then)) else {
                return Err(PlanError::Inconsistent);
            };
            Ok(self.stn.constrain(first, then, gap, None, ADDED)?)
        };
        for link in &plan.causal_links {
            let ((tell_start, tell_end), (ask_start, ask_end)) = (ends(link.tell), ends(link.ask));
            before(tell_start, ask_start, Rational::default())?;
            before(ask_end, tell_end, Rational::default())?;
        }
        for ordering in &plan.orderings_added {
            before(ends(ordering.first).1, ends(ordering.then).0, network.threat_gap)?;
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

    /// What all times are relative to.
    pub const fn origin(&self) -> PointId {
        self.origin
    }

    /// A time in ticks; times between two ticks are not representable, and give `None`, as do those that are too large.
    pub fn ticks(&self, time: Rational) -> Option<i64> {
        let scaled = i128::from(*time.numer()) * i128::from(self.ticks_per_unit);
        let denominator = i128::from(*time.denom());
        (scaled % denominator == 0).then(|| (scaled / denominator).to_i64()).flatten()
    }

    /// A number of ticks as a time.
    pub fn time(&self, ticks: i64) -> Rational {
        Rational::new(ticks, self.ticks_per_unit)
    }

    /// Makes ticks so fine that `time` is a whole number of them.
    pub fn refine_for(
        &mut self,
        network: &Network,
        plan: &Plan,
        times: &[Rational],
    ) -> Result<(), PlanError> {
        let mut ticks_per_unit = self.ticks_per_unit;
        for time in times {
            ticks_per_unit =
                least_common_multiple(ticks_per_unit, *time.denom()).ok_or(PlanError::Overflow)?;
        }
        if ticks_per_unit != self.ticks_per_unit {
            self.ticks_per_unit = ticks_per_unit;
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

fn common_denominator(network: &Network) -> Option<i64> {
    let mut common = *network.threat_gap.denom();
    for arc in &network.arcs {
        common = least_common_multiple(common, *arc.lower.denom())?;
        if let Bound::Finite(upper) = arc.upper {
            common = least_common_multiple(common, *upper.denom())?;
        }
    }
    Some(common)
}

fn least_common_multiple(left: i64, right: i64) -> Option<i64> {
    let (mut a, mut b) = (left, right);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    (left / a).checked_mul(right)
}
