//! A network prepared for planning: times as integers, flat adjacency, contexts of arcs, and conditions by variable.

use std::collections::BTreeSet;

use exact::{Bound, Overflow, Scale, Time};
use rmpl::program::Controllability;
use stn::PointId;
use tpn::{ArcId, BlockKind, Choice, DecisionId, LabelId, Network, NodeId};
use typed_index_collections::{TiSlice, TiVec};

use crate::conditions::Conditions;
use crate::demands::Demands;
use crate::nesting::Nesting;
use crate::structure::{Relation, Structure};
use crate::unplannable::Unplannable;
use crate::wording;

/// No upper bound.
pub(crate) const INFINITE: i64 = stn::INFINITE;

/// The lower bound of an arc that has none; only parts of a mission have such.
pub(crate) const UNBOUNDED_BELOW: i64 = i64::MIN;

/// The alternative of each decision, where one is taken.
pub(crate) type Alternatives = TiSlice<DecisionId, Option<u32>>;

/// The innermost alternative that something is part of; `None` for what every plan has.
pub(crate) type Context = Option<Choice>;

/// What planning reads; made once per network.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    scale: Scale,
    pub(crate) gap: i64,
    pub(crate) start: NodeId,
    pub(crate) num_nodes: usize,
    pub(crate) arcs: TiVec<ArcId, ModelArc>,
    /// The out-arcs of node `n` are `out_arcs[out_start[n]..out_start[n + 1]]`.
    out_start: Vec<u32>,
    out_arcs: Vec<ArcId>,
    /// The decision that each node is, if it is one.
    pub(crate) decision_of: TiVec<NodeId, Option<DecisionId>>,
    pub(crate) decisions: TiVec<DecisionId, ModelDecision>,
    /// Nodes in nesting order: each before those that its arcs lead to.
    pub(crate) order: Vec<PointId>,
    pub(crate) conditions: Conditions,
    pub(crate) demands: Demands,
    /// Present if the network has a program's structure.
    pub(crate) nesting: Option<Nesting>,
    /// How far the end of each labeled interval must be from the start of another to count as before it (SPEC 5.3):
    /// the threat gap for instants, otherwise nothing.
    pub(crate) gap_after: TiVec<LabelId, i64>,
    /// Whether the environment chooses the duration of some arc (SPEC 13.1).
    pub(crate) has_uncertainty: bool,
    /// Whether plans have to withstand the environment without looking (SPEC 13.1).
    pub(crate) is_strong: bool,
    /// Which events the environment executes in some plan.
    pub(crate) natures_events: TiVec<NodeId, bool>,
    /// For each node one that the rules of the language keep at the same time, in the same context.
    pub(crate) representatives: TiVec<NodeId, NodeId>,
    /// Whether the contexts of arcs and decisions are known; otherwise they depend on the order of the search.
    pub(crate) has_contexts: bool,
    /// The bounds between threads, which only the solver knows.
    pub(crate) constraints: Vec<ArcId>,
    /// Present if the network has a program's structure that fits its arcs.
    pub(crate) structure: Option<Structure>,
}

/// An arc with integer bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelArc {
    pub(crate) lower: i64,
    /// [`INFINITE`] if there is none.
    pub(crate) upper: i64,
    pub(crate) from: NodeId,
    pub(crate) to: NodeId,
    /// Where the program's structure says so: what must be chosen for the arc to be selected.
    pub(crate) context: Context,
    /// Of a bound between threads: what must be chosen for its other event, besides.
    pub(crate) other_context: Context,
    /// Whether the environment chooses the duration.
    pub(crate) is_uncertain: bool,
    /// Whether it keeps both events at one time, and what is nature's at one is nature's at the other (SPEC 13.1).
    pub(crate) is_tie: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct ModelDecision {
    pub(crate) alternatives: Vec<ArcId>,
    /// Where its alternatives end, if contexts are known.
    pub(crate) merge: Option<NodeId>,
    pub(crate) context: Context,
}

impl Model {
    /// Prepares `network`, with `threat_gap` instead of its own if given.
    pub(crate) fn new(network: &Network, threat_gap: Option<Time>) -> Result<Self, Unplannable> {
        let gap = threat_gap.unwrap_or(network.threat_gap);
        let scale = common_scale(network, gap)?;
        let mut arcs = TiVec::with_capacity(network.arcs.len());
        for (id, arc) in network.arcs.iter().enumerate() {
            let overflow = |Overflow| Unplannable::at(arc.to);
            let is_uncertain = network.is_uncertain(ArcId::from_index(id));
            arcs.push(ModelArc {
                lower: scale.ticks(arc.lower).map_err(overflow)?,
                upper: bound_ticks(scale, arc.upper).map_err(overflow)?,
                from: arc.from,
                to: arc.to,
                context: None,
                other_context: None,
                is_uncertain,
                is_tie: arc.is_tie(),
            });
        }
        let mut natures_events = network.natures_events(&vec![true; network.arcs.len()]);
        let has_uncertainty = !natures_events.is_empty();
        natures_events.resize(network.nodes.len(), false);
        let mut out_start = Vec::with_capacity(network.nodes.len() + 1);
        let mut out_arcs = Vec::with_capacity(network.arcs.len());
        let mut decision_of = TiVec::with_capacity(network.nodes.len());
        for node in &network.nodes {
            out_start.push(out_arcs.len() as u32);
            out_arcs.extend_from_slice(&node.out_arcs);
            decision_of.push(node.decision);
        }
        out_start.push(out_arcs.len() as u32);
        let decisions = network.decisions.iter().map(|decision| ModelDecision {
            alternatives: decision.alternatives.clone(),
            merge: None,
            context: None,
        });
        let mut model = Self {
            scale,
            gap: scale.ticks(gap).map_err(|Overflow| Unplannable::at(network.start))?,
            start: network.start,
            num_nodes: network.nodes.len(),
            decisions: decisions.collect(),
            arcs,
            out_start,
            out_arcs,
            decision_of,
            order: Vec::new(),
            conditions: Conditions::new(network),
            demands: Demands::new(network, scale)?,
            nesting: Nesting::new(network),
            gap_after: TiVec::new(),
            has_uncertainty,
            is_strong: network.controllability == Controllability::Strong,
            natures_events: natures_events.into(),
            representatives: (0..network.nodes.len()).map(NodeId::from_index).collect(),
            has_contexts: false,
            constraints: network.constraints().collect(),
            structure: None,
        };
        model.order = model.nesting_order();
        model.gap_after = model.conditions.labels.keys().map(|label| model.min_gap_after(label)).collect();
        model.has_contexts = model.find_contexts(network);
        if model.has_contexts && model.arcs.iter().all(|arc| arc.to != model.start) {
            model.structure = Structure::new(network, &model)?;
        }
        Ok(model)
    }

    /// Changes the bounds of one arc, in the model's units. The structure must be refreshed afterwards.
    pub(crate) fn set_bounds(&mut self, network: &Network, arc: ArcId, lower: i64, upper: i64) {
        let changed = &mut self.arcs[arc];
        (changed.lower, changed.upper) = (lower, upper);
        changed.is_tie = !changed.is_uncertain && (lower, upper) == (0, 0);
        for &label in &network.arcs[arc.index()].labels {
            self.gap_after[label] = self.min_gap_after(label);
        }
    }

    /// Brings the structure up to date with all bounds.
    pub(crate) fn refresh_structure(&mut self) -> Result<(), Unplannable> {
        if let Some(mut structure) = self.structure.take() {
            structure.refresh(self)?;
            self.structure = Some(structure);
        }
        Ok(())
    }

    /// A time in the model's units, if it is a whole number of them.
    pub(crate) fn units(&self, time: Time) -> Result<i64, Overflow> {
        self.scale.ticks(time)
    }

    /// A bound in the model's units, if it is a whole number of them.
    pub(crate) fn bound_units(&self, bound: Bound) -> Result<i64, Overflow> {
        bound_ticks(self.scale, bound)
    }

    pub(crate) fn out_arcs(&self, node: NodeId) -> &[ArcId] {
        &self.out_arcs[self.out_range(node)]
    }

    fn out_range(&self, node: NodeId) -> std::ops::Range<usize> {
        self.out_start[node.index()] as usize..self.out_start[node.index() + 1] as usize
    }

    /// Exact time from integer units.
    pub(crate) fn time(&self, units: i64) -> Time {
        self.scale.time(units)
    }

    /// The start and end node of a labeled interval.
    pub(crate) fn interval(&self, label: LabelId) -> (PointId, PointId) {
        let label = &self.conditions.labels[label];
        let arc = &self.arcs[label.arc];
        (point(arc.from), point(if label.is_at_start { arc.from } else { arc.to }))
    }

    /// Returns whether two contexts can be in one plan.
    pub(crate) fn are_compatible(&self, mut left: Context, mut right: Context) -> bool {
        while let (Some(one), Some(other)) = (left, right) {
            if one.decision == other.decision {
                return one.alternative == other.alternative;
            }
            // The inner one of two nested decisions is the later one.
            if one.decision > other.decision {
                left = self.decisions[one.decision].context;
            } else {
                right = self.decisions[other.decision].context;
            }
        }
        true
    }

    /// Returns whether whatever has a context is in no plan without what has another one around it.
    pub(crate) fn is_within(&self, mut inner: Context, outer: Context) -> bool {
        while inner != outer {
            let Some(choice) = inner else { return false };
            inner = self.decisions[choice.decision].context;
        }
        true
    }

    /// Returns whether an arc is a bound between threads.
    pub(crate) fn is_constraint(&self, arc: ArcId) -> bool {
        self.constraints.binary_search(&arc).is_ok()
    }

    /// Returns whether a bound between threads begins or ends at an event.
    pub(crate) fn is_constrained(&self, node: NodeId) -> bool {
        self.constraints.iter().any(|&arc| self.arcs[arc].from == node || self.arcs[arc].to == node)
    }

    /// Returns whether two labels can be in one plan.
    pub(crate) fn can_be_together(&self, left: LabelId, right: LabelId) -> bool {
        let context = |label: LabelId| self.arcs[self.conditions.labels[label].arc].context;
        self.are_compatible(context(left), context(right))
    }

    /// Returns whether the solver's own solutions become plans, so that all of them count.
    pub(crate) fn tells_plans_apart(&self) -> bool {
        self.has_uncertainty || self.demands.tells_alternatives_apart()
    }

    /// Returns how the program's structure orders the arcs of two labels, if one of them takes time, so that they
    /// cannot be in the other order as well.
    pub(crate) fn nested_order(&self, left: LabelId, right: LabelId) -> Relation {
        let arc = |label: LabelId| self.conditions.labels[label].arc;
        let takes_time = self.arcs[arc(left)].lower > 0 || self.arcs[arc(right)].lower > 0;
        match &self.nesting {
            Some(nesting) if takes_time => nesting.relation(arc(left), arc(right)),
            _ => Relation::Open,
        }
    }

    /// Returns what a node is in networks that have one point for all nodes with one representative.
    pub(crate) fn representative(&self, node: NodeId) -> PointId {
        point(self.representatives[node])
    }

    /// The gap that the rules ask for between the end of an interval and the start of another, which is `gap` unless the environment
    /// executes that start (SPEC 13.1).
    pub(crate) fn gap_before(&self, then: LabelId, gap: i64) -> i64 {
        let start = self.arcs[self.conditions.labels[then].arc].from;
        if self.natures_events[start] { 0 } else { gap }
    }

    fn min_gap_after(&self, label: LabelId) -> i64 {
        let label = &self.conditions.labels[label];
        let arc = &self.arcs[label.arc];
        if label.is_at_start || (arc.lower == 0 && arc.upper == 0) { self.gap } else { 0 }
    }

    /// Reverse postorder of a depth-first search along the arcs.
    fn nesting_order(&self) -> Vec<PointId> {
        let mut order = Vec::with_capacity(self.num_nodes);
        let mut is_seen: TiVec<NodeId, bool> = vec![false; self.num_nodes].into();
        let mut stack: Vec<(NodeId, std::ops::Range<usize>)> = Vec::new();
        if self.num_nodes == 0 {
            return order;
        }
        is_seen[self.start] = true;
        stack.push((self.start, self.out_range(self.start)));
        while let Some((node, left)) = stack.last_mut() {
            let Some(next) = left.next_back() else {
                order.push(point(*node));
                stack.pop();
                continue;
            };
            let target = self.arcs[self.out_arcs[next]].to;
            if !is_seen[target] {
                is_seen[target] = true;
                stack.push((target, self.out_range(target)));
            }
        }
        order.reverse();
        order
    }

    /// Returns where the alternatives of each decision come together again, in a network that has no blocks. `None` if
    /// some of them do so before all do.
    fn found_merges(&self) -> Option<TiVec<DecisionId, NodeId>> {
        let mut waiting: TiVec<NodeId, u32> = vec![0; self.num_nodes].into();
        let leads_on = |arc: ArcId| self.arcs[arc].to != self.start;
        for &arc in self.out_arcs.iter().filter(|&&arc| leads_on(arc)) {
            waiting[self.arcs[arc].to] += 1;
        }
        let mut merges: TiVec<DecisionId, Option<NodeId>> = vec![None; self.decisions.len()].into();
        let mut incoming: TiVec<NodeId, BTreeSet<Vec<Choice>>> = vec![BTreeSet::new(); self.num_nodes].into();
        incoming[self.start].insert(Vec::new());
        let mut open = vec![self.start];
        while let Some(node) = open.pop() {
            let mut paths = std::mem::take(&mut incoming[node]);
            // The innermost alternatives come together first.
            while paths.len() > 1 {
                let inner = paths.iter().max_by_key(|path| path.len())?.clone();
                let (&Choice { decision, .. }, before) = inner.split_last()?;
                for alternative in 0..self.decisions[decision].alternatives.len() as u32 {
                    let path = [before, &[Choice { decision, alternative }]].concat();
                    if !paths.remove(&path) {
                        return None;
                    }
                }
                paths.insert(before.to_vec());
                merges[decision] = Some(node);
            }
            let path = paths.pop_first()?;
            for position in self.out_range(node) {
                let arc = self.out_arcs[position];
                if !leads_on(arc) {
                    continue;
                }
                let mut path = path.clone();
                path.extend(self.choice_at(node, arc));
                let to = self.arcs[arc].to;
                incoming[to].insert(path);
                waiting[to] -= 1;
                if waiting[to] == 0 {
                    open.push(to);
                }
            }
        }
        merges.into_iter().collect()
    }

    /// The choice that takes an arc which leaves a node, where that is an alternative.
    fn choice_at(&self, node: NodeId, arc: ArcId) -> Context {
        let decision = self.decision_of[node]?;
        let position = self.decisions[decision].alternatives.iter().position(|&other| other == arc)?;
        Some(Choice { decision, alternative: position as u32 })
    }

    /// Finds the context of every arc and decision; `false` if its choices are not nested as its blocks say.
    fn find_contexts(&mut self, network: &Network) -> bool {
        // Arcs back to the start hold what has happened already, and of the events of two threads either may come first.
        let is_free = |id: ArcId| self.arcs[id].to == network.start || self.is_constraint(id);
        if self.arcs.iter_enumerated().any(|(id, arc)| arc.lower < 0 && !is_free(id)) {
            return false;
        }
        let merges = if network.root.is_some() { merges_of_blocks(network) } else { self.found_merges() };
        let Some(merges) = merges else { return false };
        for (decision, &merge) in self.decisions.iter_mut().zip(&merges) {
            decision.merge = Some(merge);
        }
        let mut contexts: TiVec<NodeId, Option<Context>> = vec![None; self.num_nodes].into();
        contexts[self.start] = Some(None);
        let mut stack = vec![self.start];
        while let Some(node) = stack.pop() {
            let Some(context) = contexts[node] else { return false };
            let mut reach = |target: NodeId, context: Context, stack: &mut Vec<NodeId>| match contexts[target]
            {
                None => {
                    contexts[target] = Some(context);
                    stack.push(target);
                    true
                }
                Some(known) => known == context,
            };
            if let Some(decision) = self.decision_of[node] {
                self.decisions[decision].context = context;
                let is_nested_after = context.is_none_or(|outer| outer.decision < decision);
                let merge = merges[decision];
                // A merge that is also the end of the surrounding alternative already has that one's context.
                let ends_outer = context.is_some_and(|outer| merge == merges[outer.decision]);
                if !is_nested_after || (!ends_outer && !reach(merge, context, &mut stack)) {
                    return false;
                }
                for (alternative, &arc) in (0..).zip(&self.decisions[decision].alternatives) {
                    let inner = Some(Choice { decision, alternative });
                    let arc = &mut self.arcs[arc];
                    arc.context = inner;
                    if arc.to != merge && !reach(arc.to, inner, &mut stack) {
                        return false;
                    }
                }
            } else {
                for position in self.out_range(node) {
                    let id = self.out_arcs[position];
                    let arc = &mut self.arcs[id];
                    arc.context = context;
                    if arc.to == self.start {
                        continue;
                    }
                    let leaves_alternative = context.is_some_and(|outer| arc.to == merges[outer.decision]);
                    if leaves_alternative {
                        continue;
                    }
                    let is_rigid = wording::is_structural(network.arcs[id.index()].kind)
                        && (arc.lower, arc.upper) == (0, 0);
                    let to = arc.to;
                    if !reach(to, context, &mut stack) {
                        return false;
                    }
                    if is_rigid {
                        join(&mut self.representatives, node, to);
                    }
                }
            }
        }
        for &id in &self.constraints {
            let arc = &mut self.arcs[id];
            let context = |node: NodeId| contexts[node].unwrap_or(None);
            (arc.context, arc.other_context) = (context(arc.from), context(arc.to));
        }
        for node in (0..self.num_nodes).map(NodeId::from_index) {
            self.representatives[node] = find(&self.representatives, node);
        }
        true
    }
}

/// Returns what a node is in networks that have one point for each node.
pub(crate) const fn point(node: NodeId) -> PointId {
    PointId(node.0)
}

/// The node that a point represents.
pub(crate) const fn node(point: PointId) -> NodeId {
    NodeId(point.0)
}

/// Returns where the choices of a network that was compiled from a program end.
fn merges_of_blocks(network: &Network) -> Option<TiVec<DecisionId, NodeId>> {
    let mut merges: TiVec<DecisionId, Option<NodeId>> = vec![None; network.decisions.len()].into();
    for block in &network.blocks {
        if let BlockKind::Choose { decision, .. } = block.kind {
            merges[decision] = Some(block.end);
        }
    }
    merges.into_iter().collect()
}

fn find(representatives: &TiSlice<NodeId, NodeId>, node: NodeId) -> NodeId {
    let mut at = node;
    while representatives[at] != at {
        at = representatives[at];
    }
    at
}

/// Lets the earlier of two nodes represent both.
fn join(representatives: &mut TiSlice<NodeId, NodeId>, earlier: NodeId, later: NodeId) {
    let (earlier, later) = (find(representatives, earlier), find(representatives, later));
    representatives[later] = earlier;
    // Chains stay short.
    representatives[later] = find(representatives, later);
}

fn common_scale(network: &Network, gap: Time) -> Result<Scale, Unplannable> {
    let with_gap = Scale::UNITS.refined(gap).map_err(|Overflow| Unplannable::at(network.start))?;
    let departures = network.departures.iter().filter_map(|departure| departure.least);
    let with_departures = departures
        .into_iter()
        .try_fold(with_gap, Scale::refined)
        .map_err(|Overflow| Unplannable::at(network.start))?;
    network.arcs.iter().try_fold(with_departures, |scale, arc| {
        let scale = scale.refined(arc.lower);
        let upper = arc.upper.finite().unwrap_or_default();
        scale.and_then(|scale| scale.refined(upper)).map_err(|Overflow| Unplannable::at(arc.to))
    })
}

/// [`INFINITE`] for no bound.
fn bound_ticks(scale: Scale, bound: Bound) -> Result<i64, Overflow> {
    match scale.bound_ticks(bound)? {
        None => Ok(INFINITE),
        Some(INFINITE) => Err(Overflow),
        Some(ticks) => Ok(ticks),
    }
}
