//! A recorded search, replayed to any step: what was selected, added and possible there.
//!
//! Nothing but the trace is kept: the state after each step is computed from the events of the states that lead to it,
//! and windows are propagated again. A step costs time linear in those events, not in the length of the search.
//!
//! A conflict-driven search adds no arcs one by one: whatever the choices at a step do not exclude counts as soon as they
//! select it.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use exact::{Bound, Time};
use serde::{Deserialize, Serialize};
use stn::{Overflow, Stn};
use tpn::{
    ArcId, CausalLink, Choice, DecisionId, LabelId, Network, NodeId, Ordering, UseId, UseOrdering, Window,
};
use typed_index_collections::TiVec;

use crate::model::UNBOUNDED_BELOW;
use crate::model::{Context, INFINITE, Model, point};
use crate::precedence;
use crate::trace::{Constraint, CycleMember, Departing, Event, Trace, TreeChoice, TreeNodeId};

/// Replays a [`Trace`] on the network it was recorded on.
#[derive(Clone, Debug)]
pub struct Replay {
    model: Model,
    /// The events of state `n` are `events[event_start[n]..event_start[n + 1]]`, in order.
    event_start: Vec<u32>,
    events: Vec<u32>,
    /// Of a conflict-driven search: the steps in which one starts, and the end of all; empty otherwise.
    rounds: Vec<u32>,
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
    /// Orders of resource uses in force.
    pub uses: Vec<UseOrdering>,
    /// Latest starts of uses in force.
    pub starts: Vec<(UseId, Time)>,
    /// From where movements set out, as far as that is known.
    pub departures: Vec<Departing>,
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
    choices: Vec<TreeChoice>,
    /// What the plan keeps of all orders, if that is known.
    kept: Option<(Vec<Ordering>, Vec<UseOrdering>)>,
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
        let mut rounds: Vec<u32> = Vec::new();
        if trace.is_conflict_driven() {
            let starts = (0_u32..).zip(&trace.events);
            let starts = starts.filter(|(_, entry)| matches!(entry.event, Event::Begin(_)));
            rounds.extend(starts.map(|(step, _)| step).chain([trace.events.len() as u32]));
        }
        Some(Self { model, event_start, events, rounds })
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

    /// Returns what the states from the root to `tree_node` had added until `step`.
    fn frames(&self, trace: &Trace, tree_node: TreeNodeId, step: usize) -> Vec<Frame> {
        let mut path = Vec::new();
        let mut at = Some(tree_node);
        while let Some(node) = at {
            path.push(node);
            at = trace.tree.get(node as usize).and_then(|node| node.parent);
        }
        path.reverse();
        let (from, until) = self.round(tree_node, step);
        path.into_iter().map(|node| self.frame(trace, node, from..=step.min(until))).collect()
    }

    /// The first and the last step of the search that a state belongs to: what another one found at the root does not count.
    fn round(&self, tree_node: TreeNodeId, step: usize) -> (usize, usize) {
        let own = self.event_start.get(tree_node as usize).and_then(|&first| self.events.get(first as usize));
        let at = if tree_node == 0 { step } else { own.map_or(step, |&first| first as usize) };
        let next = self.rounds.partition_point(|&start| start as usize <= at);
        let from = next.checked_sub(1).map_or(0, |round| self.rounds[round] as usize);
        let until = self.rounds.get(next).map_or(usize::MAX, |&next| (next as usize).saturating_sub(1));
        (from, until)
    }

    fn frame(&self, trace: &Trace, tree_node: TreeNodeId, steps: RangeInclusive<usize>) -> Frame {
        let mut frame = Frame { tree_node, ..Frame::default() };
        let bounds =
            self.event_start.get(tree_node as usize).zip(self.event_start.get(tree_node as usize + 1));
        let own = bounds.and_then(|(&from, &to)| self.events.get(from as usize..to as usize));
        let own = own.unwrap_or_default().iter().map(|&event| event as usize);
        for step in own.skip_while(|step| step < steps.start()).take_while(|step| step <= steps.end()) {
            match trace.events.get(step).map(|entry| &entry.event) {
                Some(Event::Decide { decision, alternative }) => frame
                    .choices
                    .push(TreeChoice::Decision { decision: *decision, alternative: *alternative }),
                Some(Event::AddArc { arc }) => frame.arcs.push(*arc),
                Some(Event::TryLink { link }) => frame.choices.push(TreeChoice::Link(*link)),
                Some(Event::TryOrder { order }) => frame.choices.push(TreeChoice::Order(*order)),
                Some(Event::TryUseOrder { order }) => frame.choices.push(TreeChoice::UseOrder(*order)),
                Some(Event::TryStart { used, by }) => {
                    frame.choices.push(TreeChoice::Start { used: *used, by: *by });
                }
                Some(Event::Imply { choice, holds: true, .. }) => frame.choices.push(*choice),
                Some(Event::Keep { orders, uses }) => frame.kept = Some((orders.clone(), uses.clone())),
                _ => {}
            }
        }
        frame
    }

    fn collect(&self, frames: &[Frame], result: &mut ReplayStep) {
        result.tree_node = frames.last().map_or(0, |frame| frame.tree_node);
        // What was learned later may say in a state what was chosen below it.
        let mut known = BTreeSet::new();
        let choices = frames.iter().flat_map(|frame| &frame.choices);
        for choice in choices.filter(|&&choice| known.insert(choice)) {
            match *choice {
                TreeChoice::Decision { decision, alternative } => {
                    result.choices.push(Choice { decision, alternative });
                }
                TreeChoice::Link(link) => result.links.push(link),
                TreeChoice::Order(order) => result.orders.push(order),
                TreeChoice::UseOrder(order) => result.uses.push(order),
                TreeChoice::Start { used, by } => result.starts.push((used, by)),
                TreeChoice::Departure(departing) => result.departures.push(departing),
                TreeChoice::NoLink { .. } | TreeChoice::Later { .. } | TreeChoice::Apart => {}
            }
        }
        if self.rounds.is_empty() {
            self.select(frames, result);
        } else {
            self.select_by_context(result);
            result.choices.sort_unstable();
            result.links.sort_unstable();
            if let Some((orders, uses)) = frames.last().and_then(|frame| frame.kept.as_ref()) {
                result.orders.clone_from(orders);
                result.uses.clone_from(uses);
                // A plan keeps the orders of uses, but not when they start.
                result.starts.clear();
            }
        }
        let windows = self.windows(result);
        result.windows = windows.unwrap_or_else(|Overflow { .. }| vec![None; self.model.num_nodes]);
    }

    /// What was added arc by arc.
    fn select(&self, frames: &[Frame], result: &mut ReplayStep) {
        let model = &self.model;
        let mut is_selected: TiVec<NodeId, bool> = vec![false; model.num_nodes].into();
        let mut select = |node: NodeId, nodes: &mut Vec<NodeId>| {
            if !is_selected[node] {
                is_selected[node] = true;
                nodes.push(node);
            }
        };
        select(model.start, &mut result.nodes);
        for arc in frames.iter().flat_map(|frame| &frame.arcs).copied() {
            result.arcs.push(arc);
            select(model.arcs[arc].to, &mut result.nodes);
        }
    }

    /// All that is part of every plan with the choices of a step.
    fn select_by_context(&self, result: &mut ReplayStep) {
        let model = &self.model;
        let mut is_selected: TiVec<NodeId, bool> = vec![false; model.num_nodes].into();
        is_selected[model.start] = true;
        for (id, arc) in model.arcs.iter_enumerated() {
            let is_chosen = |context: Context| context.is_none_or(|choice| result.choices.contains(&choice));
            if is_chosen(arc.context) && is_chosen(arc.other_context) {
                result.arcs.push(id);
                (is_selected[arc.from], is_selected[arc.to]) = (true, true);
            }
        }
        result.nodes.extend(is_selected.iter_enumerated().filter(|&(_, &it)| it).map(|(node, _)| node));
    }

    /// Propagates the constraints of a step again.
    fn windows(&self, step: &ReplayStep) -> Result<Vec<Option<Window>>, Overflow> {
        let model = &self.model;
        let mut stn = Stn::new(model.num_nodes);
        let failed: Vec<Constraint> = step.cycle.iter().map(|member| member.constraint).collect();
        for &arc in &step.arcs {
            let bounds = &model.arcs[arc];
            let (from, to) = (point(bounds.from), point(bounds.to));
            // The arc just added is the one that may contradict the others: those are consistent by themselves.
            if bounds.lower != UNBOUNDED_BELOW {
                let _ = stn.insert(to, from, -bounds.lower, arc.0);
            }
            if bounds.upper != INFINITE {
                let _ = stn.insert(from, to, bounds.upper, arc.0);
            }
        }
        if !self.rounds.is_empty() {
            self.relax_open_decisions(step, &mut stn);
        }
        let links = step.links.iter().map(|&link| (TreeChoice::Link(link), Constraint::Link(link)));
        let orders = step.orders.iter().map(|&order| (TreeChoice::Order(order), Constraint::Order(order)));
        let uses = step.uses.iter().map(|&order| (TreeChoice::UseOrder(order), Constraint::UseOrder(order)));
        let departures = step.departures.iter();
        let departures = departures.map(|&it| (TreeChoice::Departure(it), Constraint::Departure(it)));
        for (choice, constraint) in departures.chain(links).chain(orders).chain(uses) {
            if failed.contains(&constraint) {
                continue;
            }
            for (from, to, weight) in precedence::edges(model, choice) {
                let _ = stn.insert(from, to, weight, 0);
            }
        }
        for &(used, by) in &step.starts {
            for (from, to, weight) in precedence::edges(model, TreeChoice::Start { used, by }) {
                let _ = stn.insert(from, to, weight, 0);
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

    /// A decision that is still open takes as long as some alternative of it may.
    fn relax_open_decisions(&self, step: &ReplayStep, stn: &mut Stn) {
        let Some(structure) = &self.model.structure else { return };
        for (id, decision) in self.model.decisions.iter_enumerated() {
            let is_open = step.choices.iter().all(|choice| choice.decision != id)
                && decision.context.is_none_or(|choice| step.choices.contains(&choice));
            let (from, to, lower, upper) = structure.initial_bounds(id);
            if is_open && lower <= upper {
                let _ = stn.constrain(point(from), point(to), lower, (upper != INFINITE).then_some(upper), 0);
            }
        }
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
            Event::Backtrack { .. }
            | Event::Backjump { .. }
            | Event::Restart
            | Event::Begin(_)
            | Event::Keep { .. }
            | Event::TryUseOrder { .. }
            | Event::TryStart { .. }
            | Event::Solution { .. }
            | Event::Exhausted => (None, None, None),
            _ => continue,
        };
        result.decision = decision;
        if !is_ask_known {
            (result.ask, result.threat) = (ask, threat);
        }
        return;
    }
}
