//! A recorded search, replayed to any step: what was selected, added and possible there.
//!
//! Nothing but the trace is kept: the state after each step is computed from the events of the states that lead to it,
//! and windows are propagated again. A step costs time linear in those events, not in the length of the search.

use exact::{Bound, Time};
use serde::{Deserialize, Serialize};
use stn::{Overflow, Stn};
use tpn::{ArcId, CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering, Window};
use typed_index_collections::TiVec;

use crate::model::{INFINITE, Model, point};
use crate::trace::{Constraint, CycleMember, Event, Trace, TreeNodeId};

/// Replays a [`Trace`] on the network it was recorded on.
#[derive(Clone, Debug)]
pub struct Replay {
    model: Model,
    /// The events of state `n` are `events[event_start[n]..event_start[n + 1]]`, in order.
    event_start: Vec<u32>,
    events: Vec<u32>,
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

impl Replay {
    /// `None` if the network's times do not fit, which the search would have reported.
    pub fn new(network: &Network, threat_gap: Option<Time>, trace: &Trace) -> Option<Self> {
        let model = Model::new(network, threat_gap).ok()?;
        let states = trace.tree.len();
        let mut event_start = vec![0_u32; states + 1];
        let state_of = |tree_node: TreeNodeId| Some(tree_node as usize).filter(|&node| node < states);
        for node in trace.events.iter().filter_map(|entry| state_of(entry.tree_node)) {
            event_start[node + 1] += 1;
        }
        for node in 0..states {
            event_start[node + 1] += event_start[node];
        }
        let mut next = event_start.clone();
        let mut events = vec![0; event_start.last().map_or(0, |&count| count as usize)];
        for (step, entry) in (0_u32..).zip(&trace.events) {
            if let Some(node) = state_of(entry.tree_node) {
                events[next[node] as usize] = step;
                next[node] += 1;
            }
        }
        Some(Self { model, event_start, events })
    }

    /// The state after event `step` of `trace`, which must be the one this was made for; after the last event if there
    /// are fewer.
    pub fn at(&self, trace: &Trace, step: usize) -> ReplayStep {
        let step = step.min(trace.events.len().saturating_sub(1));
        let mut result = ReplayStep { step, ..ReplayStep::default() };
        let Some(entry) = trace.events.get(step) else { return result };
        let frames = self.frames(trace, entry.tree_node, step);
        if let Event::Inconsistent { cycle } = &entry.event {
            result.cycle.clone_from(cycle);
        }
        look_at(trace, step, &mut result);
        self.collect(&frames, &mut result);
        result
    }

    /// What the states from the root to `tree_node` had added until `step`.
    fn frames(&self, trace: &Trace, tree_node: TreeNodeId, step: usize) -> Vec<Frame> {
        let mut path = Vec::new();
        let mut at = Some(tree_node);
        while let Some(node) = at {
            path.push(node);
            at = trace.tree.get(node as usize).and_then(|node| node.parent);
        }
        path.reverse();
        path.into_iter().map(|node| self.frame(trace, node, step)).collect()
    }

    fn frame(&self, trace: &Trace, tree_node: TreeNodeId, step: usize) -> Frame {
        let mut frame = Frame { tree_node, ..Frame::default() };
        let bounds =
            self.event_start.get(tree_node as usize).zip(self.event_start.get(tree_node as usize + 1));
        let own = bounds.and_then(|(&from, &to)| self.events.get(from as usize..to as usize));
        for entry in own.unwrap_or_default().iter().map(|&event| event as usize).take_while(|&it| it <= step)
        {
            match trace.events.get(entry).map(|entry| &entry.event) {
                Some(Event::Decide { decision, alternative }) => {
                    frame.choice = Some(Choice { decision: *decision, alternative: *alternative });
                }
                Some(Event::AddArc { arc }) => frame.arcs.push(*arc),
                Some(Event::TryLink { link }) => frame.link = Some(*link),
                Some(Event::TryOrder { order }) => frame.order = Some(*order),
                _ => {}
            }
        }
        frame
    }

    fn collect(&self, frames: &[Frame], result: &mut ReplayStep) {
        let model = &self.model;
        let mut is_selected: TiVec<NodeId, bool> = vec![false; model.num_nodes].into();
        let mut select = |node: NodeId, nodes: &mut Vec<NodeId>| {
            if !is_selected[node] {
                is_selected[node] = true;
                nodes.push(node);
            }
        };
        select(model.start, &mut result.nodes);
        result.tree_node = frames.last().map_or(0, |frame| frame.tree_node);
        for frame in frames {
            for &arc in &frame.arcs {
                result.arcs.push(arc);
                select(model.arcs[arc].to, &mut result.nodes);
            }
            result.choices.extend(frame.choice);
            result.links.extend(frame.link);
            result.orders.extend(frame.order);
        }
        let windows = self.windows(result).unwrap_or_else(|Overflow { .. }| vec![None; model.num_nodes]);
        result.windows = windows;
    }

    /// Propagates the constraints of a step again.
    fn windows(&self, step: &ReplayStep) -> Result<Vec<Option<Window>>, Overflow> {
        let model = &self.model;
        let mut stn = Stn::new(model.num_nodes);
        let failed = step.cycle.iter().map(|member| member.constraint);
        let failed: Vec<Constraint> = failed.collect();
        for &arc in &step.arcs {
            let bounds = &model.arcs[arc];
            let (from, to) = (point(bounds.from), point(bounds.to));
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
            let (ask_start, ask_end) = model.interval(link.ask);
            let (tell_start, tell_end) = model.interval(link.tell);
            let _ = stn.insert(ask_start, tell_start, 0, 0);
            let _ = stn.insert(tell_end, ask_end, 0, 0);
        }
        for order in &step.orders {
            if !failed.contains(&Constraint::Order(*order)) {
                let _ =
                    stn.insert(model.interval(order.then).0, model.interval(order.first).1, -model.gap, 0);
            }
        }
        let all = stn.windows(point(model.start))?;
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

/// What is being decided, closed or ordered at `step`: what the last event said that set it.
fn look_at(trace: &Trace, step: usize, result: &mut ReplayStep) {
    let mut is_ask_known = false;
    for entry in trace.events.iter().take(step + 1).rev() {
        let (decision, ask, threat) = match &entry.event {
            Event::Unclosable { ask } if !is_ask_known => {
                (result.ask, is_ask_known) = (Some(*ask), true);
                continue;
            }
            Event::Unresolvable { left, right } if !is_ask_known => {
                (result.threat, is_ask_known) = (Some((*left, *right)), true);
                continue;
            }
            Event::Decide { decision, .. } => (Some(*decision), None, None),
            Event::TryLink { link } => (None, Some(link.ask), None),
            Event::Threat { left, right } => (None, None, Some((*left, *right))),
            Event::TryOrder { order } => (None, None, Some((order.first, order.then))),
            Event::Backtrack { .. } | Event::Backjump { .. } | Event::Solution { .. } | Event::Exhausted => {
                (None, None, None)
            }
            _ => continue,
        };
        result.decision = decision;
        if !is_ask_known {
            (result.ask, result.threat) = (ask, threat);
        }
        return;
    }
}
