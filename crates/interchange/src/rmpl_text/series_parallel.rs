//! How a network is nested: its arcs as sequences, parallel branches and choices (series-parallel reduction: Valdes,
//! Tarjan and Lawler 1982), or the event at which they do not nest.
//!
//! A node with one arc in and one arc out joins the two in a sequence; arcs between the same two nodes are one block. Arcs
//! that leave a decision are one block only all together. Near linear in the size of the network.

use std::collections::{BTreeMap, BTreeSet};

use super::Obstacle;
use tpn::network::{ArcId, ArcKind, Network, NodeId};

/// A network as nested sequences.
pub(super) struct Tree {
    /// All sequences; the first one goes from the network's start to its end.
    pub(super) sequences: Vec<Sequence>,
}

/// What follows one another: `items[i]` goes from `nodes[i]` to `nodes[i + 1]`.
#[derive(Default)]
pub(super) struct Sequence {
    pub(super) nodes: Vec<NodeId>,
    pub(super) items: Vec<Item>,
}

/// What lies between two events.
pub(super) enum Item {
    Arc(ArcId),
    /// All of these sequences, in the order of the network.
    Parallel(Vec<usize>),
    /// One of these sequences, in the order of the decision's alternatives.
    Choose(Vec<usize>),
}

/// Nests `network`.
pub(super) fn nested(network: &Network) -> Result<Tree, Obstacle> {
    let mut reduction = Reduction::new(network);
    reduction.reduce();
    match reduction.outs[network.start.index()].iter().next() {
        Some(&edge) if reduction.is_done() => Ok(reduction.tree(edge)),
        _ => Err(reduction.obstacle()),
    }
}

/// Returns whether an arc only bounds what others lead through.
pub(super) fn is_bound(kind: ArcKind) -> bool {
    matches!(kind, ArcKind::Span | ArcKind::Composite | ArcKind::Constraint)
}

enum Term {
    Arc(ArcId),
    Series(usize, usize),
    Parallel(Vec<usize>),
    Choose(Vec<usize>),
}

/// A part of the network between two nodes, with the arcs that it begins and ends with.
struct Edge {
    from: NodeId,
    to: NodeId,
    term: Term,
    first: ArcId,
    last: ArcId,
}

struct Reduction<'network> {
    network: &'network Network,
    edges: Vec<Edge>,
    outs: Vec<BTreeSet<usize>>,
    ins: Vec<BTreeSet<usize>>,
    between: BTreeMap<(NodeId, NodeId), Vec<usize>>,
    /// Decisions whose alternatives have not all met yet.
    open: Vec<bool>,
    waiting: Vec<(NodeId, NodeId)>,
}

impl<'network> Reduction<'network> {
    /// The part of the network that can be reached from its start.
    fn new(network: &'network Network) -> Self {
        let mut reduction = Self {
            network,
            edges: Vec::new(),
            outs: vec![BTreeSet::new(); network.nodes.len()],
            ins: vec![BTreeSet::new(); network.nodes.len()],
            between: BTreeMap::new(),
            open: network.nodes.iter().map(|node| node.decision.is_some()).collect(),
            waiting: Vec::new(),
        };
        let mut is_reached = vec![false; network.nodes.len()];
        let mut stack = vec![network.start];
        while let Some(node) = stack.pop() {
            if std::mem::replace(&mut is_reached[node.index()], true) {
                continue;
            }
            for &arc in &network.nodes[node.index()].out_arcs {
                let to = network.arcs[arc.index()].to;
                if !is_bound(network.arcs[arc.index()].kind) {
                    let edge = Edge { from: node, to, term: Term::Arc(arc), first: arc, last: arc };
                    reduction.insert(edge);
                }
                stack.push(to);
            }
        }
        reduction
    }

    fn insert(&mut self, edge: Edge) {
        let id = self.edges.len();
        self.outs[edge.from.index()].insert(id);
        self.ins[edge.to.index()].insert(id);
        self.between.entry((edge.from, edge.to)).or_default().push(id);
        self.waiting.push((edge.from, edge.to));
        self.edges.push(edge);
    }

    fn remove(&mut self, id: usize) {
        let (from, to) = (self.edges[id].from, self.edges[id].to);
        self.outs[from.index()].remove(&id);
        self.ins[to.index()].remove(&id);
        if let Some(beside) = self.between.get_mut(&(from, to)) {
            beside.retain(|&other| other != id);
        }
    }

    fn reduce(&mut self) {
        while let Some((from, to)) = self.waiting.pop() {
            self.join_parallel(from, to);
            self.join_series(from);
            self.join_series(to);
        }
    }

    fn join_parallel(&mut self, from: NodeId, to: NodeId) {
        let beside = self.between.get(&(from, to)).map_or(0, Vec::len);
        let is_choice = self.open[from.index()];
        let is_complete = beside == self.outs[from.index()].len();
        if beside == 0 || (is_choice && !is_complete) || (!is_choice && beside < 2) {
            return;
        }
        let mut parts = self.between.remove(&(from, to)).unwrap_or_default();
        parts.sort_by_key(|&part| {
            let first = self.edges[part].first;
            (self.network.arcs[first.index()].choice, first)
        });
        let (first, last) = (self.edges[parts[0]].first, self.edges[parts[0]].last);
        for &part in &parts {
            self.remove(part);
        }
        let term = if is_choice {
            self.open[from.index()] = false;
            Term::Choose(parts)
        } else {
            // Branches of branches between the same events are branches.
            let mut branches = Vec::new();
            for part in parts {
                match &mut self.edges[part].term {
                    Term::Parallel(inner) => branches.append(inner),
                    _ => branches.push(part),
                }
            }
            Term::Parallel(branches)
        };
        self.insert(Edge { from, to, term, first, last });
    }

    fn join_series(&mut self, node: NodeId) {
        let is_end = node == self.network.start || node == self.network.end;
        let (before, after) = (&self.ins[node.index()], &self.outs[node.index()]);
        if is_end || self.open[node.index()] || before.len() != 1 || after.len() != 1 {
            return;
        }
        let (Some(&before), Some(&after)) = (before.iter().next(), after.iter().next()) else { return };
        if before == after {
            return;
        }
        self.remove(before);
        self.remove(after);
        let (one, other) = (&self.edges[before], &self.edges[after]);
        let (first, last) = (one.first, other.last);
        let (from, to) = (one.from, other.to);
        self.insert(Edge { from, to, term: Term::Series(before, after), first, last });
    }

    fn is_done(&self) -> bool {
        let (start, end) = (self.network.start, self.network.end);
        let left: usize = self.outs.iter().map(BTreeSet::len).sum();
        start != end && left == 1 && !self.open[start.index()] && self.ins[end.index()].len() == 1
    }

    fn tree(mut self, root: usize) -> Tree {
        let mut sequences = vec![Sequence::default()];
        let mut waiting = vec![(root, 0)];
        while let Some((edge, place)) = waiting.pop() {
            let mut sequence = Sequence { nodes: vec![self.edges[edge].from], items: Vec::new() };
            let mut parts = vec![edge];
            while let Some(part) = parts.pop() {
                let to = self.edges[part].to;
                let mut placed = |parts: Vec<usize>| -> Vec<usize> {
                    let places = sequences.len()..sequences.len() + parts.len();
                    sequences.resize_with(places.end, Sequence::default);
                    waiting.extend(parts.into_iter().zip(places.clone()));
                    places.collect()
                };
                let item = match std::mem::replace(&mut self.edges[part].term, Term::Parallel(Vec::new())) {
                    Term::Series(before, after) => {
                        parts.extend([after, before]);
                        continue;
                    }
                    Term::Arc(arc) => Item::Arc(arc),
                    Term::Parallel(branches) => Item::Parallel(placed(branches)),
                    Term::Choose(alternatives) => Item::Choose(placed(alternatives)),
                };
                sequence.items.push(item);
                sequence.nodes.push(to);
            }
            sequences[place] = sequence;
        }
        Tree { sequences }
    }

    /// Returns where the network does not nest: the first event at which something stays apart.
    fn obstacle(&self) -> Obstacle {
        let (start, end) = (self.network.start, self.network.end);
        for node in (0..self.network.nodes.len()).map(NodeId::from_index) {
            let (ins, outs) = (&self.ins[node.index()], &self.outs[node.index()]);
            let arcs_in: Vec<ArcId> = ins.iter().take(2).map(|&edge| self.edges[edge].last).collect();
            let arcs_out: Vec<ArcId> = outs.iter().take(2).map(|&edge| self.edges[edge].first).collect();
            let (problem, arcs) = if node == start && !ins.is_empty() {
                ("is the network's start, and arcs lead back to it", arcs_in)
            } else if node == end && !outs.is_empty() {
                ("is the network's end, and arcs leave it", arcs_out)
            } else if outs.is_empty() && !ins.is_empty() && node != end {
                ("has no outgoing arc, but is not the end of the network", arcs_in)
            } else if node != end && ins.len() > 1 {
                ("joins arcs that did not branch at a single event", arcs_in)
            } else {
                continue;
            };
            return Obstacle { problem: problem.to_owned(), nodes: vec![node], arcs };
        }
        // Everything meets at the end only: what parts there does not part together.
        for node in (0..self.network.nodes.len()).map(NodeId::from_index) {
            let outs = &self.outs[node.index()];
            if outs.len() > 1 || (self.open[node.index()] && !outs.is_empty()) {
                return Obstacle {
                    problem: "branches into arcs that do not join at a single event".to_owned(),
                    nodes: vec![node],
                    arcs: outs.iter().take(2).map(|&edge| self.edges[edge].first).collect(),
                };
            }
        }
        Obstacle {
            problem: "leads to no end of the network".to_owned(),
            nodes: vec![self.network.start],
            arcs: Vec::new(),
        }
    }
}
