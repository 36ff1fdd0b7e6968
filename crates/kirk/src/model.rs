//! A network prepared for planning: times as integers, flat adjacency, contexts of arcs, and conditions by variable.

use exact::{Bound, Time};
use rmpl::program::LabelMode;
use stn::{Overflow, PointId};
use tpn::{BlockKind, Network};

use crate::conditions::Conditions;
use crate::structure::Structure;
use crate::wording;

/// No decision, arc or level.
pub(crate) const NONE: u32 = u32::MAX;

/// No upper bound.
pub(crate) const INFINITE: i64 = stn::INFINITE;

/// What planning reads; made once per network.
#[derive(Clone, Debug)]
pub(crate) struct Model {
    /// How many integer units one time unit has.
    pub(crate) scale: i64,
    pub(crate) gap: i64,
    pub(crate) start: u32,
    pub(crate) num_nodes: usize,
    pub(crate) arcs: Vec<ModelArc>,
    /// The out-arcs of node `n` are `out_arcs[out_start[n]..out_start[n + 1]]`.
    pub(crate) out_start: Vec<u32>,
    pub(crate) out_arcs: Vec<u32>,
    /// The decision of each node.
    pub(crate) decision_of: Vec<u32>,
    pub(crate) decisions: Vec<ModelDecision>,
    /// Nodes in nesting order: each before those that its arcs lead to.
    pub(crate) order: Vec<PointId>,
    pub(crate) conditions: Conditions,
    /// How far the end of each labelled interval must be from the start of another to count as before it (SPEC 5.3):
    /// the threat gap for instants, otherwise nothing.
    pub(crate) gap_after: Vec<i64>,
    /// For each node one that the rules of the language keep at the same time, in the same context.
    pub(crate) twin: Vec<u32>,
    /// Whether the contexts of arcs and decisions are known; otherwise they depend on the order of the search.
    pub(crate) has_contexts: bool,
    /// Present if the network has a program's structure that fits its arcs.
    pub(crate) structure: Option<Structure>,
}

/// An arc with integer bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModelArc {
    pub(crate) lower: i64,
    /// [`INFINITE`] if there is none.
    pub(crate) upper: i64,
    pub(crate) from: u32,
    pub(crate) to: u32,
    /// Where the program's structure says so: what must be chosen for the arc to be selected.
    pub(crate) context: Context,
}

/// The innermost alternative that something is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Context {
    /// [`NONE`] for what every plan has.
    pub(crate) decision: u32,
    pub(crate) alternative: u32,
}

impl Context {
    pub(crate) const ALWAYS: Self = Self { decision: NONE, alternative: 0 };
}

#[derive(Clone, Debug)]
pub(crate) struct ModelDecision {
    pub(crate) alternatives: Vec<u32>,
    /// Where its alternatives end, if contexts are known.
    pub(crate) merge: u32,
    pub(crate) context: Context,
}

impl Model {
    /// Prepares `network`, with `threat_gap` instead of its own if given.
    pub(crate) fn new(network: &Network, threat_gap: Option<Time>) -> Result<Self, Overflow> {
        let gap = threat_gap.unwrap_or(network.threat_gap);
        let scale = common_denominator(network, gap)?;
        let mut arcs = Vec::with_capacity(network.arcs.len());
        for arc in &network.arcs {
            arcs.push(ModelArc {
                lower: scaled(arc.lower, scale)?,
                upper: scaled_bound(arc.upper, scale)?,
                from: arc.from.0,
                to: arc.to.0,
                context: Context::ALWAYS,
            });
        }
        let mut out_start = Vec::with_capacity(network.nodes.len() + 1);
        let mut out_arcs = Vec::with_capacity(network.arcs.len());
        let mut decision_of = Vec::with_capacity(network.nodes.len());
        for node in &network.nodes {
            out_start.push(out_arcs.len() as u32);
            out_arcs.extend(node.out_arcs.iter().map(|arc| arc.0));
            decision_of.push(node.decision.map_or(NONE, |decision| decision.0));
        }
        out_start.push(out_arcs.len() as u32);
        let decisions = network.decisions.iter().map(|decision| ModelDecision {
            alternatives: decision.alternatives.iter().map(|arc| arc.0).collect(),
            merge: NONE,
            context: Context::ALWAYS,
        });
        let mut model = Self {
            scale,
            gap: scaled(gap, scale)?,
            start: network.start.0,
            num_nodes: network.nodes.len(),
            decisions: decisions.collect(),
            arcs,
            out_start,
            out_arcs,
            decision_of,
            order: Vec::new(),
            conditions: Conditions::new(network),
            gap_after: Vec::new(),
            twin: (0..network.nodes.len() as u32).collect(),
            has_contexts: false,
            structure: None,
        };
        model.order = model.nesting_order();
        model.gap_after = (0..network.labels.len()).map(|label| model.least_gap_after(label)).collect();
        model.has_contexts = model.find_contexts(network);
        if model.has_contexts {
            model.structure = Structure::new(network, &model)?;
        }
        Ok(model)
    }

    /// Changes the bounds of one arc, in the model's units. The structure must be refreshed afterwards.
    pub(crate) fn set_bounds(&mut self, network: &Network, arc: u32, lower: i64, upper: i64) {
        (self.arcs[arc as usize].lower, self.arcs[arc as usize].upper) = (lower, upper);
        for label in &network.arcs[arc as usize].labels {
            self.gap_after[label.index()] = self.least_gap_after(label.index());
        }
    }

    /// Brings the structure up to date with all bounds.
    pub(crate) fn refresh_structure(&mut self) -> Result<(), Overflow> {
        if let Some(mut structure) = self.structure.take() {
            structure.refresh(self)?;
            self.structure = Some(structure);
        }
        Ok(())
    }

    /// A time in the model's units, if it is a whole number of them.
    pub(crate) fn units(&self, time: Time) -> Result<i64, Overflow> {
        scaled(time, self.scale)
    }

    /// A bound in the model's units, if it is a whole number of them.
    pub(crate) fn bound_units(&self, bound: Bound) -> Result<i64, Overflow> {
        scaled_bound(bound, self.scale)
    }

    pub(crate) fn out_arcs(&self, node: u32) -> &[u32] {
        let node = node as usize;
        &self.out_arcs[self.out_start[node] as usize..self.out_start[node + 1] as usize]
    }

    /// Exact time from integer units.
    pub(crate) fn time(&self, units: i64) -> Time {
        if self.scale == 1 { Time::from(units) } else { Time::new(units, self.scale).unwrap_or_default() }
    }

    /// The start and end node of a labelled interval.
    pub(crate) fn interval(&self, label: u32) -> (PointId, PointId) {
        let arc = &self.arcs[self.conditions.labels[label as usize].arc as usize];
        (PointId(arc.from), PointId(arc.to))
    }

    fn least_gap_after(&self, label: usize) -> i64 {
        let arc = &self.arcs[self.conditions.labels[label].arc as usize];
        if arc.lower == 0 && arc.upper == 0 { self.gap } else { 0 }
    }

    /// Reverse postorder of a depth-first search along the arcs.
    fn nesting_order(&self) -> Vec<PointId> {
        let mut order = Vec::with_capacity(self.num_nodes);
        let mut is_seen = vec![false; self.num_nodes];
        let mut stack: Vec<(u32, u32)> = Vec::new();
        if self.num_nodes == 0 {
            return order;
        }
        is_seen[self.start as usize] = true;
        stack.push((self.start, self.out_start[self.start as usize + 1]));
        while let Some((node, next)) = stack.last_mut() {
            if *next == self.out_start[*node as usize] {
                order.push(PointId(*node));
                stack.pop();
                continue;
            }
            *next -= 1;
            let target = self.arcs[self.out_arcs[*next as usize] as usize].to;
            if !is_seen[target as usize] {
                is_seen[target as usize] = true;
                stack.push((target, self.out_start[target as usize + 1]));
            }
        }
        order.reverse();
        order
    }

    /// Finds the context of every arc and decision; `false` if the network is not nested as its blocks say.
    fn find_contexts(&mut self, network: &Network) -> bool {
        if network.root.is_none() || self.arcs.iter().any(|arc| arc.lower < 0) {
            return false;
        }
        let mut merges = vec![NONE; self.decisions.len()];
        for block in &network.blocks {
            if let BlockKind::Choose { decision, .. } = block.kind {
                merges[decision.index()] = block.end.0;
            }
        }
        if merges.contains(&NONE) {
            return false;
        }
        for (decision, &merge) in self.decisions.iter_mut().zip(&merges) {
            decision.merge = merge;
        }
        let mut contexts: Vec<Option<Context>> = vec![None; self.num_nodes];
        contexts[self.start as usize] = Some(Context::ALWAYS);
        let mut stack = vec![self.start];
        while let Some(node) = stack.pop() {
            let Some(context) = contexts[node as usize] else { return false };
            let mut reach =
                |target: u32, context: Context, stack: &mut Vec<u32>| match contexts[target as usize] {
                    None => {
                        contexts[target as usize] = Some(context);
                        stack.push(target);
                        true
                    }
                    Some(known) => known == context,
                };
            let decision = self.decision_of[node as usize];
            if decision == NONE {
                for position in self.out_start[node as usize]..self.out_start[node as usize + 1] {
                    let id = self.out_arcs[position as usize];
                    let arc = &mut self.arcs[id as usize];
                    arc.context = context;
                    let leaves_alternative =
                        context.decision != NONE && arc.to == merges[context.decision as usize];
                    if leaves_alternative {
                        continue;
                    }
                    let is_rigid = wording::is_structural(network.arcs[id as usize].kind)
                        && (arc.lower, arc.upper) == (0, 0);
                    let to = arc.to;
                    if !reach(to, context, &mut stack) {
                        return false;
                    }
                    if is_rigid {
                        join(&mut self.twin, node, to);
                    }
                }
            } else {
                self.decisions[decision as usize].context = context;
                let is_nested_after = context.decision == NONE || context.decision < decision;
                let merge = merges[decision as usize];
                // A merge that is also the end of the surrounding alternative already has that one's context.
                let ends_outer = context.decision != NONE && merge == merges[context.decision as usize];
                if !is_nested_after || (!ends_outer && !reach(merge, context, &mut stack)) {
                    return false;
                }
                for (alternative, &arc) in (0..).zip(&self.decisions[decision as usize].alternatives) {
                    let inner = Context { decision, alternative };
                    let arc = &mut self.arcs[arc as usize];
                    arc.context = inner;
                    if arc.to != merge && !reach(arc.to, inner, &mut stack) {
                        return false;
                    }
                }
            }
        }
        for node in 0..self.num_nodes as u32 {
            self.twin[node as usize] = representative(&self.twin, node);
        }
        true
    }
}

fn representative(twin: &[u32], node: u32) -> u32 {
    let mut at = node;
    while twin[at as usize] != at {
        at = twin[at as usize];
    }
    at
}

/// Makes two nodes twins; the earlier one stands for both.
fn join(twin: &mut [u32], earlier: u32, later: u32) {
    let (earlier, later) = (representative(twin, earlier), representative(twin, later));
    twin[later as usize] = earlier;
    // Chains stay short.
    twin[later as usize] = representative(twin, later);
}

fn common_denominator(network: &Network, gap: Time) -> Result<i64, Overflow> {
    let uppers = network.arcs.iter().filter_map(|arc| arc.upper.finite());
    let mut times = network.arcs.iter().map(|arc| arc.lower).chain(uppers).chain([gap]);
    times.try_fold(1_i64, |common, time| {
        let denominator = time.denominator();
        if denominator == 1 || common % denominator == 0 {
            return Ok(common);
        }
        common.checked_mul(denominator / greatest_common_divisor(common, denominator)).ok_or(Overflow)
    })
}

pub(crate) fn greatest_common_divisor(mut left: i64, mut right: i64) -> i64 {
    while right != 0 {
        (left, right) = (right, left % right);
    }
    left
}

fn scaled(time: Time, scale: i64) -> Result<i64, Overflow> {
    if scale == 1 && time.denominator() == 1 {
        return Ok(time.numerator());
    }
    if scale % time.denominator() != 0 {
        return Err(Overflow);
    }
    time.numerator().checked_mul(scale / time.denominator()).ok_or(Overflow)
}

fn scaled_bound(bound: Bound, scale: i64) -> Result<i64, Overflow> {
    match bound {
        Bound::Infinite => Ok(INFINITE),
        Bound::Finite(time) => {
            scaled(time, scale).and_then(|units| if units == INFINITE { Err(Overflow) } else { Ok(units) })
        }
    }
}

/// Whether a label is a requirement.
pub(crate) fn is_ask(mode: LabelMode) -> bool {
    mode == LabelMode::Ask
}
