//! The distance graph as data (SPEC 4): what is selected as vertices, and every bound as an edge with its weight.
//!
//! Events that the language keeps at the same time are one vertex, and chains of path points are one edge, so that the
//! graph stays readable.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use kirk::{Constraint, CycleMember};
use tpn::{ArcId, EventEnd, Network, NodeId, Plan, Precedence};
use workbench::state::selection::node_name;

/// What the graph is made of.
#[derive(Clone, Copy)]
pub struct Selected<'a> {
    pub network: &'a Network,
    /// Selected events.
    pub nodes: &'a [NodeId],
    /// Selected constraints.
    pub arcs: &'a [ArcId],
    /// With the links and orders in force.
    pub plan: &'a Plan,
    /// The contradiction, if there is one.
    pub cycle: &'a [CycleMember],
}

/// The distance graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DistanceGraph {
    /// Its vertices, those that can happen first before the others.
    pub vertices: Vec<Vertex>,
    pub edges: Vec<Edge>,
}

/// Events at the same time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertex {
    pub nodes: Vec<NodeId>,
    /// What they are called, in at most two lines; none for forks and merges.
    pub names: Vec<String>,
}

/// `to` happens at most `weight` after `from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Position in the list of nodes.
    pub from: usize,
    /// Position in the list of nodes.
    pub to: usize,
    /// In time units.
    pub weight: Time,
    pub constraint: Constraint,
    /// Whether it is part of the contradiction.
    pub is_in_cycle: bool,
}

impl DistanceGraph {
    /// The graph of what is selected. Linear in it, but for sorting.
    pub fn new(selected: &Selected<'_>) -> Self {
        let network = selected.network;
        let arcs = selected.arcs.iter().filter_map(|arc| network.arcs.get(arc.index()));
        let first = network.instants(arcs.filter(|arc| arc.lower == Time::ZERO && arc.upper == Bound::ZERO));
        let mut graph = Self::default();
        let mut vertex_of: BTreeMap<NodeId, usize> = BTreeMap::new();
        for &node in selected.nodes {
            let vertex = *vertex_of.entry(first[node.index()]).or_insert_with(|| {
                graph.vertices.push(Vertex::default());
                graph.vertices.len() - 1
            });
            graph.vertices[vertex].nodes.push(node);
        }
        for vertex in &mut graph.vertices {
            vertex.nodes.sort_unstable();
            vertex.names = names(network, &vertex.nodes);
        }
        let place = |node: NodeId| vertex_of.get(&first[node.index()]).copied();
        for edge in bounds(selected) {
            if let (Some(from), Some(to)) = (place(edge.from), place(edge.to))
                && from != to
            {
                let is_in_cycle = selected.cycle.iter().any(|member| member.constraint == edge.constraint);
                graph.edges.push(Edge {
                    from,
                    to,
                    weight: edge.weight,
                    constraint: edge.constraint,
                    is_in_cycle,
                });
            }
        }
        graph.keep_tightest();
        graph.join_chains();
        graph
    }

    /// Of edges between the same two vertices, the tightest says all.
    fn keep_tightest(&mut self) {
        self.edges.sort_by_key(|edge| (edge.from, edge.to, edge.weight, !edge.is_in_cycle));
        self.edges.dedup_by_key(|edge| (edge.from, edge.to));
    }

    /// A nameless vertex with one neighbor before and one after it is passed over.
    fn join_chains(&mut self) {
        for vertex in 0..self.vertices.len() {
            if !self.vertices[vertex].names.is_empty() {
                continue;
            }
            let incoming: Vec<Edge> = self.edges.iter().filter(|edge| edge.to == vertex).copied().collect();
            let outgoing: Vec<Edge> = self.edges.iter().filter(|edge| edge.from == vertex).copied().collect();
            let mut neighbors: Vec<usize> =
                incoming.iter().map(|edge| edge.from).chain(outgoing.iter().map(|edge| edge.to)).collect();
            neighbors.sort_unstable();
            neighbors.dedup();
            if neighbors.len() != 2 {
                continue;
            }
            self.edges.retain(|edge| edge.from != vertex && edge.to != vertex);
            for before in &incoming {
                for after in outgoing.iter().filter(|after| after.to != before.from) {
                    let is_in_cycle = before.is_in_cycle && after.is_in_cycle;
                    let Some(weight) = before.weight.checked_add(after.weight) else { continue };
                    self.edges.push(Edge { from: before.from, to: after.to, weight, is_in_cycle, ..*before });
                }
            }
        }
        self.keep_tightest();
        let is_used = |vertex: usize| self.edges.iter().any(|edge| edge.from == vertex || edge.to == vertex);
        let kept: Vec<usize> = (0..self.vertices.len())
            .filter(|&vertex| !self.vertices[vertex].names.is_empty() || is_used(vertex))
            .collect();
        let mut position = vec![0; self.vertices.len()];
        for (new, &old) in kept.iter().enumerate() {
            position[old] = new;
        }
        self.vertices = kept.iter().map(|&old| std::mem::take(&mut self.vertices[old])).collect();
        for edge in &mut self.edges {
            (edge.from, edge.to) = (position[edge.from], position[edge.to]);
        }
    }
}

/// A bound of the network.
pub(super) struct Between {
    pub(super) from: NodeId,
    pub(super) to: NodeId,
    pub(super) weight: Time,
    pub(super) constraint: Constraint,
}

/// Every bound of what is selected: `to − from ≤ weight`.
pub(super) fn bounds(selected: &Selected<'_>) -> Vec<Between> {
    let network = selected.network;
    let mut all = Vec::new();
    for &id in selected.arcs {
        let Some(arc) = network.arcs.get(id.index()) else { continue };
        if let Bound::Finite(weight) = arc.upper {
            all.push(Between { from: arc.from, to: arc.to, weight, constraint: Constraint::Upper(id) });
        }
        let constraint = Constraint::Lower(id);
        if let Some(weight) = arc.lower.checked_neg() {
            all.push(Between { from: arc.to, to: arc.from, weight, constraint });
        }
    }
    let mut add = |precedence: Precedence, constraint: Constraint| {
        let Precedence { earlier, later, least } = precedence;
        if let Some(weight) = least.checked_neg() {
            all.push(Between { from: later, to: earlier, weight, constraint });
        }
    };
    let plan = selected.plan;
    for &link in &plan.causal_links {
        for precedence in link.precedences(network) {
            add(precedence, Constraint::Link(link));
        }
    }
    let natures = network.natures_events(&plan.selected_arcs);
    for &order in &plan.orderings_added {
        add(plan.ordering_precedence(network, &order, &natures), Constraint::Order(order));
    }
    for &order in &plan.uses_ordered {
        add(order.precedence(network), Constraint::UseOrder(order));
    }
    all
}

/// The names of events at the same time: those of the two outermost, and how many others there are.
fn names(network: &Network, nodes: &[NodeId]) -> Vec<String> {
    let is_event = |node: &&NodeId| {
        network.nodes.get(node.index()).is_some_and(|node| {
            let is_point = |event: &tpn::EventRef| matches!(event.end, EventEnd::PathVertex { .. });
            node.decision.is_some() || node.events.iter().any(|event| !is_point(event))
        })
    };
    let named: Vec<&NodeId> = nodes.iter().filter(is_event).collect();
    let mut names: Vec<String> = named.iter().take(2).map(|&&node| node_name(network, node)).collect();
    if let Some(last) = names.last_mut().filter(|_| named.len() > 2) {
        last.push_str(&format!(" and {} more", named.len() - 2));
    }
    names
}
