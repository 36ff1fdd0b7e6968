//! Recovering structure from a bare graph: series and parallel reduction after Valdes, Tarjan and Lawler (1982).
//!
//! Networks from other tools come without blocks. Whatever is in series or side by side is found in linear time; what
//! is left over goes to [`crate::layered`]. Bounds between far nodes that stand in the way are drawn across.

use std::collections::{HashMap, VecDeque};

use tpn::{Arc, ArcId, ArcKind, Network, NodeId, Role};

use crate::tree::{Branch, Core, PartId, PartKind, Tree};

/// What an edge of the shrinking graph represents. Items are made after the items they are made of.
#[derive(Clone, Copy, Debug)]
struct Item {
    from: u32,
    to: u32,
    what: What,
    /// The first arc in it, which decides its place among its neighbors.
    first_arc: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    Arc(ArcId),
    /// Nothing: ties a loose node to the start or the end.
    Gap,
    Series(u32, u32),
    Parallel(u32, u32),
}

/// The tree of a network without blocks.
pub(crate) fn tree_from_graph(network: &Network) -> Tree {
    let mut tree = Tree::default();
    let (start, end) = (network.start, network.end);
    if network.nodes.is_empty() || start == end {
        tree.across = (0..network.arcs.len()).map(ArcId::from_index).collect();
        return tree;
    }
    let order = acyclic_order(network, &mut tree.across);
    let mut graph = Graph::new(network, &order, &tree.across);
    graph.reduce(&order.nodes);
    graph.drop_bounds_in_the_way(network, &mut tree.across);
    graph.reduce(&order.nodes);
    let live: Vec<u32> = (0..graph.items.len() as u32).filter(|&item| graph.live[item as usize]).collect();
    let parts = graph.into_parts(network, &live, &mut tree);
    let whole = |part: &PartId| tree.part(*part).start == start && tree.part(*part).end == end;
    tree.root = match parts.as_slice() {
        [] => None,
        [part] if whole(part) => Some(*part),
        _ => Some(push_core(network, &order, &parts, &mut tree)),
    };
    tree
}

/// The nodes in an order in which no kept arc goes back.
struct Order {
    nodes: Vec<u32>,
    positions: Vec<u32>,
}

/// Orders the nodes; arcs that go back, into the start or out of the end are put into `across`.
fn acyclic_order(network: &Network, across: &mut Vec<ArcId>) -> Order {
    let mut is_across = vec![false; network.arcs.len()];
    let mut waiting = vec![0_u32; network.nodes.len()];
    for (at, arc) in network.arcs.iter().enumerate() {
        is_across[at] = arc.from == arc.to || arc.to == network.start || arc.from == network.end;
        waiting[arc.to.index()] += u32::from(!is_across[at]);
    }
    let mut order = Order { nodes: Vec::new(), positions: vec![u32::MAX; network.nodes.len()] };
    let mut ready: VecDeque<u32> =
        (0..network.nodes.len() as u32).filter(|&node| waiting[node as usize] == 0).collect();
    let mut next_stuck = 0;
    while order.nodes.len() < network.nodes.len() {
        let Some(node) = ready.pop_front() else {
            // Every node left is on a cycle or behind one: open it at the first.
            while order.positions[next_stuck] != u32::MAX {
                next_stuck += 1;
            }
            for arc in &network.nodes[next_stuck].in_arcs {
                let from = network.arcs[arc.index()].from.index();
                is_across[arc.index()] |= order.positions[from] == u32::MAX;
            }
            waiting[next_stuck] = 0;
            ready.push_back(next_stuck as u32);
            continue;
        };
        order.positions[node as usize] = order.nodes.len() as u32;
        order.nodes.push(node);
        for arc in &network.nodes[node as usize].out_arcs {
            let to = network.arcs[arc.index()].to.index();
            if !is_across[arc.index()] && waiting[to] > 0 {
                waiting[to] -= 1;
                if waiting[to] == 0 {
                    ready.push_back(to as u32);
                }
            }
        }
    }
    across.extend((0..network.arcs.len()).filter(|&at| is_across[at]).map(ArcId::from_index));
    order
}

struct Graph {
    items: Vec<Item>,
    live: Vec<bool>,
    /// How many live items leave and enter each node, and the exclusive-or of their numbers: with one item left, that
    /// is the item.
    leaving: Vec<(u32, u32)>,
    entering: Vec<(u32, u32)>,
    /// The live item between two nodes. Only looked up, never walked.
    between: HashMap<(u32, u32), u32>,
    terminals: (u32, u32),
}

impl Graph {
    fn new(network: &Network, order: &Order, across: &[ArcId]) -> Self {
        let count = network.nodes.len();
        let mut graph = Self {
            items: Vec::with_capacity(network.arcs.len() * 2),
            live: Vec::new(),
            leaving: vec![(0, 0); count],
            entering: vec![(0, 0); count],
            between: HashMap::with_capacity(network.arcs.len()),
            terminals: (network.start.0, network.end.0),
        };
        let mut is_across = vec![false; network.arcs.len()];
        for arc in across {
            is_across[arc.index()] = true;
        }
        for (at, arc) in network.arcs.iter().enumerate().filter(|&(at, _)| !is_across[at]) {
            let what = What::Arc(ArcId::from_index(at));
            graph.add(Item { from: arc.from.0, to: arc.to.0, what, first_arc: at as u32 });
        }
        let (start, end) = graph.terminals;
        for &node in &order.nodes {
            let (leaves, enters) = (graph.leaving[node as usize].0 > 0, graph.entering[node as usize].0 > 0);
            let gap = |from, to| Item { from, to, what: What::Gap, first_arc: u32::MAX };
            if !enters && leaves && node != start {
                graph.add(gap(start, node));
            }
            if enters && !leaves && node != end {
                graph.add(gap(node, end));
            }
        }
        graph
    }

    /// Adds an item, together with the one that is already between its nodes.
    fn add(&mut self, item: Item) {
        let id = self.push(item);
        if let Some(&other) = self.between.get(&(item.from, item.to))
            && self.live[other as usize]
        {
            let first_arc = item.first_arc.min(self.items[other as usize].first_arc);
            self.remove(id);
            self.remove(other);
            let both = self.push(Item { what: What::Parallel(other, id), first_arc, ..item });
            self.between.insert((item.from, item.to), both);
        } else {
            self.between.insert((item.from, item.to), id);
        }
    }

    fn push(&mut self, item: Item) -> u32 {
        let id = self.items.len() as u32;
        self.items.push(item);
        self.live.push(true);
        self.toggle(id, true);
        id
    }

    fn remove(&mut self, id: u32) {
        self.live[id as usize] = false;
        self.toggle(id, false);
    }

    fn toggle(&mut self, id: u32, comes: bool) {
        let item = self.items[id as usize];
        let ends = [&mut self.leaving[item.from as usize], &mut self.entering[item.to as usize]];
        for (count, numbers) in ends {
            *count = if comes { *count + 1 } else { *count - 1 };
            *numbers ^= id;
        }
    }

    /// Replaces every node with one item in and one out by a series, until there is none.
    fn reduce(&mut self, order: &[u32]) {
        let mut work: VecDeque<u32> = order.iter().copied().collect();
        while let Some(node) = work.pop_front() {
            let is_terminal = node == self.terminals.0 || node == self.terminals.1;
            let ((1, enters), (1, leaves)) = (self.entering[node as usize], self.leaving[node as usize])
            else {
                continue;
            };
            if is_terminal {
                continue;
            }
            let (first, second) = (self.items[enters as usize], self.items[leaves as usize]);
            self.remove(enters);
            self.remove(leaves);
            let what = What::Series(enters, leaves);
            let first_arc = first.first_arc.min(second.first_arc);
            self.add(Item { from: first.from, to: second.to, what, first_arc });
            // Joining with a parallel item may leave these with one item on a side.
            work.extend([first.from, second.to]);
        }
    }

    /// Takes bounds without labels out of a graph that could not be reduced to one item.
    fn drop_bounds_in_the_way(&mut self, network: &Network, across: &mut Vec<ArcId>) {
        let count = self.live.iter().filter(|&&live| live).count();
        if count <= 1 {
            return;
        }
        for id in 0..self.items.len() as u32 {
            let item = self.items[id as usize];
            let What::Arc(arc) = item.what else { continue };
            let can_go = self.leaving[item.from as usize].0 > 1 && self.entering[item.to as usize].0 > 1;
            let is_bound = network.arcs[arc.index()].kind == ArcKind::Span
                && network.arcs[arc.index()].labels.is_empty();
            if self.live[id as usize] && can_go && is_bound {
                self.remove(id);
                across.push(arc);
            }
        }
    }

    /// The parts for the `wanted` items, made from the inside out without recursion.
    fn into_parts(self, network: &Network, wanted: &[u32], tree: &mut Tree) -> Vec<PartId> {
        let mut members: Vec<Option<Vec<u32>>> = vec![None; self.items.len()];
        for &item in wanted {
            members[item as usize] = Some(Vec::new());
        }
        for id in (0..self.items.len()).rev() {
            if members[id].is_none() {
                continue;
            }
            let list = self.flattened(id as u32);
            for &member in &list {
                members[member as usize] = Some(Vec::new());
            }
            members[id] = Some(list);
        }
        let mut parts: Vec<Option<PartId>> = vec![None; self.items.len()];
        for (id, list) in members.into_iter().enumerate() {
            let Some(list) = list else { continue };
            let item = self.items[id];
            let (from, to) = (NodeId(item.from), NodeId(item.to));
            parts[id] = match item.what {
                What::Arc(arc) => Some(tree.push_arc(network, arc)),
                What::Gap => Some(tree.push(PartKind::Nothing, from, to, None)),
                What::Series(..) => {
                    let children: Vec<PartId> =
                        list.iter().filter_map(|&member| parts[member as usize]).collect();
                    tree.push_series(&children, None)
                }
                What::Parallel(..) => {
                    let children: Vec<PartId> =
                        list.iter().filter_map(|&member| parts[member as usize]).collect();
                    Some(push_parallel(network, &children, from, to, tree))
                }
            };
        }
        wanted.iter().filter_map(|&item| parts[item as usize]).collect()
    }

    /// The members of a series in order, or of a parallel by their first arc; empty for an arc.
    fn flattened(&self, id: u32) -> Vec<u32> {
        let is_series = matches!(self.items[id as usize].what, What::Series(..));
        let mut list = Vec::new();
        let mut stack = vec![id];
        while let Some(at) = stack.pop() {
            match self.items[at as usize].what {
                What::Series(left, right) if is_series => stack.extend([right, left]),
                What::Parallel(left, right) if !is_series => stack.extend([right, left]),
                _ if at == id => {}
                _ => list.push(at),
            }
        }
        if !is_series {
            list.sort_by_key(|&member| self.items[member as usize].first_arc);
        }
        list
    }
}

/// Returns whether an arc is drawn over what lies beside it.
fn is_spanning(arc: &Arc) -> bool {
    matches!(arc.kind, ArcKind::Span | ArcKind::Composite)
}

fn push_parallel(
    network: &Network,
    children: &[PartId],
    from: NodeId,
    to: NodeId,
    tree: &mut Tree,
) -> PartId {
    let single = |tree: &Tree, part: PartId| match tree.part(part).kind {
        PartKind::Arc(arc) => Some(arc),
        _ => None,
    };
    let mut spans = Vec::new();
    let mut branches = Vec::new();
    for &child in children {
        match single(tree, child) {
            Some(arc) if is_spanning(&network.arcs[arc.index()]) => spans.push(arc),
            _ if tree.part(child).kind == PartKind::Nothing => {}
            _ => branches.push(child),
        }
    }
    let is_choice = network.nodes[from.index()].role == Role::Decision;
    let child = match branches.as_slice() {
        [] => match spans.pop() {
            Some(arc) => tree.push_arc(network, arc),
            None => tree.push(PartKind::Nothing, from, to, None),
        },
        [only] => *only,
        _ => {
            let branches: Vec<Branch> =
                branches.iter().map(|&part| tree.peeled(part, Branch::default())).collect();
            let begin = tree.branches.len() as u32;
            tree.branches.extend(branches);
            let branches = begin..tree.branches.len() as u32;
            tree.push(PartKind::Fan { branches, is_choice }, from, to, None)
        }
    };
    if spans.is_empty() {
        return child;
    }
    let begin = tree.spanning.len() as u32;
    tree.spanning.extend(spans);
    let arcs = begin..tree.spanning.len() as u32;
    tree.push(PartKind::Span { child, arcs, occurrence: None }, from, to, None)
}

/// Returns what could not be reduced, as a graph.
fn push_core(network: &Network, order: &Order, parts: &[PartId], tree: &mut Tree) -> PartId {
    let (start, end) = (network.start, network.end);
    let mut nodes: Vec<NodeId> = parts
        .iter()
        .flat_map(|&part| [tree.part(part).start, tree.part(part).end])
        .chain([start, end])
        .collect();
    nodes.sort_by_key(|&node| {
        let side = if node == start {
            0
        } else if node == end {
            2
        } else {
            1
        };
        (side, order.positions[node.index()])
    });
    nodes.dedup();
    let mut slots = vec![u32::MAX; network.nodes.len()];
    for (slot, node) in nodes.iter().enumerate() {
        slots[node.index()] = slot as u32;
    }
    let edges = parts.iter().map(|&part| {
        let ends = tree.part(part);
        (slots[ends.start.index()], slots[ends.end.index()], part)
    });
    let edges = edges.collect();
    let core = tree.cores.len() as u32;
    tree.cores.push(Core { nodes, edges });
    tree.push(PartKind::Core(core), start, end, None)
}
