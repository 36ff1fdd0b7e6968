//! The simple temporal network of a plan, for executing it: distances, dispatchable form, windows after observations
//! (SPEC 6).

use rmpl::{Bound, Rational};
use stn::{Dispatchable, DistanceMatrix, Execution, ExecutionWindows, Overflow, PointId, Stn, Tag};
use tpn::{ArcId, Network, NodeId, Plan, Window};

use crate::model::{INFINITE, Model, greatest_common_divisor};
use crate::trace::Constraint;

/// The tag of what was observed.
const OBSERVED: Tag = Tag::MAX;

/// The constraints of a plan: its selected arcs, causal links and added orderings.
#[derive(Clone, Debug)]
pub struct PlanNetwork {
    model: Model,
    stn: Stn,
    /// By tag.
    constraints: Vec<Constraint>,
    selected: Vec<PointId>,
}

/// What remains possible after observations.
#[derive(Clone, Debug, PartialEq)]
pub enum Remaining {
    /// The windows of the selected nodes; indexed by node.
    Windows(Vec<Option<Window>>),
    /// The plan is violated: the constraints that contradict what was observed.
    Violated(Vec<Constraint>),
}

impl PlanNetwork {
    /// The network of `plan`. `threat_gap` must be what it was planned with; the network's own if `None`.
    ///
    /// Fails if a time does not fit into 64 bits, or if the plan is inconsistent, which no plan of [`crate::plan`] is.
    pub fn new(network: &Network, plan: &Plan, threat_gap: Option<Rational>) -> Result<Self, Overflow> {
        let model = Model::new(network, threat_gap)?;
        let mut stn = Stn::new(model.num_nodes);
        let mut constraints = Vec::new();
        for (id, arc) in model.arcs.iter().enumerate() {
            if !plan.selected_arcs.get(id).copied().unwrap_or(false) {
                continue;
            }
            let (from, to) = (PointId(arc.from), PointId(arc.to));
            stn.push(to, from, -arc.lower, constraints.len() as Tag);
            constraints.push(Constraint::Lower(ArcId::from_index(id)));
            if arc.upper != INFINITE {
                stn.push(from, to, arc.upper, constraints.len() as Tag);
                constraints.push(Constraint::Upper(ArcId::from_index(id)));
            }
        }
        for link in &plan.causal_links {
            let (ask_start, ask_end) = model.interval(link.ask.0);
            let (tell_start, tell_end) = model.interval(link.tell.0);
            stn.push(ask_start, tell_start, 0, constraints.len() as Tag);
            stn.push(tell_end, ask_end, 0, constraints.len() as Tag);
            constraints.push(Constraint::Link(*link));
        }
        for order in &plan.orderings_added {
            let (first_end, then_start) = (model.interval(order.first.0).1, model.interval(order.then.0).0);
            stn.push(then_start, first_end, -model.gap, constraints.len() as Tag);
            constraints.push(Constraint::Order(*order));
        }
        let is_selected = |point: &PointId| plan.selected_nodes.get(point.index()).copied().unwrap_or(false);
        let selected: Vec<PointId> = model.order.iter().copied().filter(is_selected).collect();
        stn.settle(&selected).map_err(|_| Overflow)?;
        Ok(Self { model, stn, constraints, selected })
    }

    /// How many integer units one time unit of the mission has.
    pub fn units_per_time_unit(&self) -> i64 {
        self.model.scale
    }

    /// Exact time from integer units.
    pub fn time(&self, units: i64) -> Rational {
        self.model.time(units)
    }

    /// The constraint network itself; points are nodes, times integer units.
    pub fn stn(&mut self) -> &mut Stn {
        &mut self.stn
    }

    /// The selected nodes as points, in nesting order.
    pub fn points(&self) -> &[PointId] {
        &self.selected
    }

    /// All distances, quadratic in the size of the network.
    pub fn distances(&mut self) -> Result<DistanceMatrix, Overflow> {
        self.stn.all_pairs()
    }

    /// The rigid components and the edges to propagate during execution (SPEC 6.1).
    pub fn dispatchable(&mut self) -> Result<Dispatchable, Overflow> {
        let distances = self.stn.all_pairs()?;
        Ok(stn::dispatchable(&distances, &self.selected))
    }

    /// What remains possible once `executed` has happened, `pending` has not, and it is `now` (SPEC 6.2).
    pub fn after(
        &mut self,
        executed: &[(NodeId, Rational)],
        pending: &[NodeId],
        now: Rational,
    ) -> Result<Remaining, Overflow> {
        let mut times = executed.iter().map(|(_, time)| *time).chain([now]);
        let scale = times.try_fold(1_i64, |scale, time| {
            let unit = self.model.scale.checked_mul(scale).ok_or(Overflow)?;
            scale.checked_mul(*time.denom() / greatest_common_divisor(unit, *time.denom())).ok_or(Overflow)
        })?;
        if scale != 1 {
            return self.refined(scale)?.after(executed, pending, now);
        }
        let observed = executed.iter().map(|&(node, time)| Ok((PointId(node.0), self.model.units(time)?)));
        let observed: Vec<(PointId, i64)> = observed.collect::<Result<_, Overflow>>()?;
        let waiting: Vec<PointId> = pending.iter().map(|node| PointId(node.0)).collect();
        let execution = Execution {
            origin: PointId(self.model.start),
            executed: &observed,
            pending: &waiting,
            now: self.model.units(now)?,
        };
        Ok(match stn::execution_windows(&mut self.stn, execution, OBSERVED)? {
            ExecutionWindows::Violated(tags) => {
                let known = tags.iter().filter_map(|&tag| self.constraints.get(tag as usize).copied());
                Remaining::Violated(known.collect())
            }
            ExecutionWindows::Consistent(windows) => {
                let mut selected = vec![None; self.model.num_nodes];
                for point in &self.selected {
                    let window = windows[point.index()];
                    selected[point.index()] = Some(Window {
                        earliest: window.earliest.map_or(self.model.time(0), |time| self.model.time(time)),
                        latest: window
                            .latest
                            .map_or(Bound::Infinite, |time| Bound::Finite(self.model.time(time))),
                    });
                }
                Remaining::Windows(selected)
            }
        })
    }

    /// The same network with a unit `factor` times smaller.
    fn refined(&self, factor: i64) -> Result<Self, Overflow> {
        let mut refined = self.clone();
        refined.model.scale = self.model.scale.checked_mul(factor).ok_or(Overflow)?;
        refined.stn.clear();
        for position in 0..self.stn.num_edges() {
            let Some(edge) = self.stn.edge(position) else { break };
            refined.stn.push(edge.from, edge.to, edge.weight.checked_mul(factor).ok_or(Overflow)?, edge.tag);
        }
        refined.stn.settle(&self.selected).map_err(|_| Overflow)?;
        Ok(refined)
    }
}
