//! A recorded search, replayed to any step: what was selected, added and possible there.
//!
//! Nothing but the trace is kept: the state before each step is computed from the events up to it, and windows are
//! propagated again. A step costs time linear in the events before it.

use rmpl::{Bound, Rational};
use serde::{Deserialize, Serialize};
use stn::{Overflow, PointId, Stn};
use tpn::{ArcId, CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering, Window};

use crate::model::{INFINITE, Model};
use crate::trace::{Constraint, CycleMember, Event, Trace, TreeNodeId};

/// Replays a [`Trace`] on the network it was recorded on.
#[derive(Clone, Debug)]
pub struct Replay<'a> {
    trace: &'a Trace,
    model: Model,
}

/// The search just after one of its events.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ReplayStep {
    /// The event, by position in [`Trace::events`].
    pub step: usize,
    /// The state of the search.
    pub tree_node: TreeNodeId,
    /// Selected nodes, in the order of selection.
    pub nodes: Vec<NodeId>,
    /// Selected arcs, in the order of selection.
    pub arcs: Vec<ArcId>,
    /// Alternatives taken.
    pub choices: Vec<Choice>,
    /// Links in force.
    pub links: Vec<CausalLink>,
    /// Orders in force.
    pub orders: Vec<Ordering>,
    /// The decision being made, if one is.
    pub decision: Option<DecisionId>,
    /// The requirement being closed, if one is.
    pub ask: Option<LabelId>,
    /// The conflicting intervals being ordered, if some are.
    pub threat: Option<(LabelId, LabelId)>,
    /// The contradiction, if the step failed on one.
    pub cycle: Vec<CycleMember>,
    /// The window of each node, `None` for those not selected. Without the constraint that contradicts the others, if
    /// one does. Indexed by node.
    pub windows: Vec<Option<Window>>,
}

/// What one state of the search added to its parent's.
#[derive(Clone, Debug, Default)]
struct Frame {
    tree_node: TreeNodeId,
    arcs: Vec<ArcId>,
    choice: Option<Choice>,
    link: Option<CausalLink>,
    order: Option<Ordering>,
}

impl<'a> Replay<'a> {
    /// `None` if the network's times do not fit, which the search would have reported.
    pub fn new(network: &Network, threat_gap: Option<Rational>, trace: &'a Trace) -> Option<Self> {
        Some(Self { trace, model: Model::new(network, threat_gap).ok()? })
    }

    /// How many steps there are.
    pub fn num_steps(&self) -> usize {
        self.trace.events.len()
    }

    /// The state after event `step`; of the last one if there are fewer.
    pub fn at(&self, step: usize) -> ReplayStep {
        let mut frames = vec![Frame::default()];
        let mut result =
            ReplayStep { step: step.min(self.num_steps().saturating_sub(1)), ..ReplayStep::default() };
        for entry in self.trace.events.iter().take(step.saturating_add(1)) {
            self.enter(&mut frames, entry.tree_node);
            let Some(frame) = frames.last_mut() else { break };
            result.cycle.clear();
            match &entry.event {
                Event::Decide { decision, alternative } => {
                    frame.choice = Some(Choice { decision: *decision, alternative: *alternative });
                    (result.decision, result.ask, result.threat) = (Some(*decision), None, None);
                }
                Event::AddArc { arc } => frame.arcs.push(*arc),
                Event::TryLink { link } => {
                    frame.link = Some(*link);
                    (result.decision, result.ask, result.threat) = (None, Some(link.ask), None);
                }
                Event::Threat { left, right } => {
                    (result.decision, result.ask, result.threat) = (None, None, Some((*left, *right)));
                }
                Event::TryOrder { order } => {
                    frame.order = Some(*order);
                    (result.decision, result.ask, result.threat) =
                        (None, None, Some((order.first, order.then)));
                }
                Event::Inconsistent { cycle } => result.cycle.clone_from(cycle),
                Event::Unclosable { ask } => (result.ask, result.threat) = (Some(*ask), None),
                Event::Unresolvable { left, right } => {
                    (result.ask, result.threat) = (None, Some((*left, *right)));
                }
                Event::Backtrack { .. }
                | Event::Backjump { .. }
                | Event::Solution { .. }
                | Event::Exhausted => {
                    (result.decision, result.ask, result.threat) = (None, None, None);
                }
                Event::Expand { .. } | Event::Propagate { .. } | Event::Known => {}
            }
        }
        self.collect(&frames, &mut result);
        result
    }

    /// Makes the frames those on the path from the root to `tree_node`.
    fn enter(&self, frames: &mut Vec<Frame>, tree_node: TreeNodeId) {
        if frames.last().is_some_and(|frame| frame.tree_node == tree_node) {
            return;
        }
        let mut path = Vec::new();
        let mut at = Some(tree_node);
        while let Some(node) = at {
            path.push(node);
            at = self.trace.tree.get(node as usize).and_then(|node| node.parent);
        }
        path.reverse();
        let common =
            path.iter().zip(frames.iter()).take_while(|(node, frame)| **node == frame.tree_node).count();
        frames.truncate(common);
        frames.extend(path[common..].iter().map(|&tree_node| Frame { tree_node, ..Frame::default() }));
    }

    fn collect(&self, frames: &[Frame], result: &mut ReplayStep) {
        let model = &self.model;
        let mut is_selected = vec![false; model.num_nodes];
        let mut select = |node: u32, nodes: &mut Vec<NodeId>| {
            if !is_selected[node as usize] {
                is_selected[node as usize] = true;
                nodes.push(NodeId(node));
            }
        };
        select(model.start, &mut result.nodes);
        result.tree_node = frames.last().map_or(0, |frame| frame.tree_node);
        for frame in frames {
            for &arc in &frame.arcs {
                result.arcs.push(arc);
                select(model.arcs[arc.index()].to, &mut result.nodes);
            }
            result.choices.extend(frame.choice);
            result.links.extend(frame.link);
            result.orders.extend(frame.order);
        }
        let windows = self.windows(result).unwrap_or_else(|Overflow| vec![None; model.num_nodes]);
        result.windows = windows;
    }

    /// Propagates the constraints of a step again.
    fn windows(&self, step: &ReplayStep) -> Result<Vec<Option<Window>>, Overflow> {
        let model = &self.model;
        let mut stn = Stn::new(model.num_nodes);
        let failed = step.cycle.iter().map(|member| member.constraint);
        let failed: Vec<Constraint> = failed.collect();
        for arc in &step.arcs {
            let bounds = &model.arcs[arc.index()];
            let (from, to) = (PointId(bounds.from), PointId(bounds.to));
            // The arc just added is the one that may contradict the others: those are consistent by themselves.
            let _ = stn.insert(to, from, -bounds.lower, arc.0);
            if bounds.upper != INFINITE {
                let _ = stn.insert(from, to, bounds.upper, arc.0);
            }
        }
        for link in &step.links {
            if failed.contains(&Constraint::Link(*link)) {
                continue;
            }
            let (ask_start, ask_end) = model.interval(link.ask.0);
            let (tell_start, tell_end) = model.interval(link.tell.0);
            let _ = stn.insert(ask_start, tell_start, 0, 0);
            let _ = stn.insert(tell_end, ask_end, 0, 0);
        }
        for order in &step.orders {
            if !failed.contains(&Constraint::Order(*order)) {
                let _ = stn.insert(
                    model.interval(order.then.0).0,
                    model.interval(order.first.0).1,
                    -model.gap,
                    0,
                );
            }
        }
        let all = stn.windows(PointId(model.start))?;
        let mut windows = vec![None; model.num_nodes];
        for node in &step.nodes {
            let window = all[node.index()];
            windows[node.index()] = Some(Window {
                earliest: window.earliest.map_or(model.time(0), |earliest| model.time(earliest)),
                latest: window.latest.map_or(Bound::Infinite, |latest| Bound::Finite(model.time(latest))),
            });
        }
        Ok(windows)
    }
}
