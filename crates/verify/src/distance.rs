//! Exact shortest distances of a distance graph: a feasible potential or a negative cycle, and single rows.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// An edge `to − from ≤ weight`, with the index of what put it there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) weight: i128,
    pub(crate) reason: u32,
}

/// A distance graph without negative cycles, ready for rows of distances.
#[derive(Debug)]
pub(crate) struct Distances {
    edges: Vec<Edge>,
    /// For each node the range of `edges` that leave it; the edges are sorted by `from`.
    out_starts: Vec<u32>,
    /// Indices of `edges` sorted by `to`, and their ranges.
    incoming: Vec<u32>,
    in_starts: Vec<u32>,
    potential: Vec<i128>,
}

impl Distances {
    /// Finds a feasible potential by Bellman–Ford with alternating sweeps (Yen 1970), O(nodes × edges) at worst; or
    /// returns the edges of a negative cycle, in its order.
    pub(crate) fn new(node_count: usize, mut edges: Vec<Edge>) -> Result<Self, Vec<Edge>> {
        edges.sort_by_key(|edge| (edge.from, edge.to));
        let out_starts = starts(node_count, edges.iter().map(|edge| edge.from));
        let mut incoming: Vec<u32> = (0..edges.len() as u32).collect();
        incoming.sort_by_key(|&edge| (edges[edge as usize].to, edge));
        let in_starts = starts(node_count, incoming.iter().map(|&edge| edges[edge as usize].to));
        let potential = potential(node_count, &edges, &out_starts)?;
        Ok(Self { edges, out_starts, incoming, in_starts, potential })
    }

    /// The edges that leave a node.
    pub(crate) fn edges_from(&self, node: u32) -> &[Edge] {
        &self.edges[self.out_starts[node as usize] as usize..self.out_starts[node as usize + 1] as usize]
    }

    /// Numbers such that no edge is shorter than the difference between that of its end and that of its start.
    pub(crate) fn potential(&self) -> &[i128] {
        &self.potential
    }

    /// For each node a number that it shares with the nodes at one time with it in every schedule. Nodes whose distance is
    /// fixed are those that edges without slack join both ways. O(nodes + edges).
    pub(crate) fn instants(&self) -> Vec<u32> {
        let count = self.potential.len();
        let is_tight = |edge: &Edge| {
            self.potential[edge.from as usize] + edge.weight == self.potential[edge.to as usize]
        };
        // Kosaraju and Sharir 1981: backwards through the components in the order in which a search forwards leaves them.
        let mut left = Vec::with_capacity(count);
        let mut is_seen = vec![false; count];
        for root in 0..count as u32 {
            if std::mem::replace(&mut is_seen[root as usize], true) {
                continue;
            }
            let mut path = vec![(root, 0)];
            while let Some((node, next)) = path.last_mut() {
                let Some(edge) = self.edges_from(*node).get(*next) else {
                    left.push(*node);
                    path.pop();
                    continue;
                };
                *next += 1;
                if is_tight(edge) && !std::mem::replace(&mut is_seen[edge.to as usize], true) {
                    path.push((edge.to, 0));
                }
            }
        }
        let mut component = vec![u32::MAX; count];
        for &root in left.iter().rev() {
            let mut open = vec![root];
            while let Some(node) = open.pop() {
                if component[node as usize] != u32::MAX {
                    continue;
                }
                component[node as usize] = root;
                let range =
                    self.in_starts[node as usize] as usize..self.in_starts[node as usize + 1] as usize;
                let edges = self.incoming[range].iter().map(|&edge| &self.edges[edge as usize]);
                let beyond = edges.filter(|edge| is_tight(edge)).map(|edge| edge.from);
                open.extend(beyond.filter(|&node| component[node as usize] == u32::MAX));
            }
        }
        let mut numbers = BTreeMap::new();
        let mut number = |node: usize| {
            let next = numbers.len() as u32;
            *numbers.entry((component[node], self.potential[node])).or_insert(next)
        };
        (0..count).map(&mut number).collect()
    }

    /// Distances from `source` to every node; `None` where there is no path. O(edges · log nodes).
    pub(crate) fn row(&self, source: u32) -> Vec<Option<i128>> {
        self.dijkstra(source, None, |distances, node, visit| {
            let range = self.out_starts[node as usize] as usize..self.out_starts[node as usize + 1] as usize;
            for edge in &distances.edges[range] {
                let reduced =
                    edge.weight + self.potential[edge.from as usize] - self.potential[edge.to as usize];
                visit(edge.to, reduced);
            }
        })
        .into_iter()
        .enumerate()
        .map(|(node, reduced)| Some(reduced? - self.potential[source as usize] + self.potential[node]))
        .collect()
    }

    /// The distance from `source` to `target`, if there is a path.
    pub(crate) fn between(&self, source: u32, target: u32) -> Option<i128> {
        let reduced = self.dijkstra(source, Some(target), |distances, node, visit| {
            let range = self.out_starts[node as usize] as usize..self.out_starts[node as usize + 1] as usize;
            for edge in &distances.edges[range] {
                let reduced =
                    edge.weight + self.potential[edge.from as usize] - self.potential[edge.to as usize];
                visit(edge.to, reduced);
            }
        });
        let reduced = reduced[target as usize]?;
        Some(reduced - self.potential[source as usize] + self.potential[target as usize])
    }

    /// Distances from every node to `target`.
    pub(crate) fn column(&self, target: u32) -> Vec<Option<i128>> {
        self.dijkstra(target, None, |distances, node, visit| {
            let range = self.in_starts[node as usize] as usize..self.in_starts[node as usize + 1] as usize;
            for &edge in &self.incoming[range] {
                let edge = &distances.edges[edge as usize];
                let reduced =
                    edge.weight + self.potential[edge.from as usize] - self.potential[edge.to as usize];
                visit(edge.from, reduced);
            }
        })
        .into_iter()
        .enumerate()
        .map(|(node, reduced)| Some(reduced? - self.potential[node] + self.potential[target as usize]))
        .collect()
    }

    /// Reduced distances from `source`, until `target` is settled if there is one.
    fn dijkstra(
        &self,
        source: u32,
        target: Option<u32>,
        neighbors: impl Fn(&Self, u32, &mut dyn FnMut(u32, i128)),
    ) -> Vec<Option<i128>> {
        let mut best: Vec<Option<i128>> = vec![None; self.potential.len()];
        let mut queue = BinaryHeap::new();
        best[source as usize] = Some(0);
        queue.push(Reverse((0_i128, source)));
        while let Some(Reverse((distance, node))) = queue.pop() {
            if best[node as usize] != Some(distance) {
                continue;
            }
            if Some(node) == target {
                break;
            }
            neighbors(self, node, &mut |next, reduced| {
                let through = distance + reduced;
                if best[next as usize].is_none_or(|known| through < known) {
                    best[next as usize] = Some(through);
                    queue.push(Reverse((through, next)));
                }
            });
        }
        best
    }
}

fn starts(node_count: usize, sorted: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut starts = vec![0; node_count + 1];
    for node in sorted {
        starts[node as usize + 1] += 1;
    }
    for index in 1..starts.len() {
        starts[index] += starts[index - 1];
    }
    starts
}

fn potential(node_count: usize, edges: &[Edge], out_starts: &[u32]) -> Result<Vec<i128>, Vec<Edge>> {
    let mut potential = vec![0_i128; node_count];
    let mut parent: Vec<Option<u32>> = vec![None; node_count];
    let mut sweep = 0_usize;
    loop {
        let mut has_changed = false;
        let mut relax = |node: usize| {
            for index in out_starts[node]..out_starts[node + 1] {
                let edge = &edges[index as usize];
                let through = potential[node] + edge.weight;
                if through < potential[edge.to as usize] {
                    potential[edge.to as usize] = through;
                    parent[edge.to as usize] = Some(index);
                    has_changed = true;
                }
            }
        };
        if sweep.is_multiple_of(2) {
            (0..node_count).for_each(&mut relax);
        } else {
            (0..node_count).rev().for_each(&mut relax);
        }
        if !has_changed {
            return Ok(potential);
        }
        sweep += 1;
        // A cycle among the parents is a negative cycle; one must appear within as many sweeps as there are nodes.
        if (sweep.is_power_of_two() || sweep > node_count)
            && let Some(cycle) = parent_cycle(edges, &parent)
        {
            return Err(cycle);
        }
    }
}

fn parent_cycle(edges: &[Edge], parent: &[Option<u32>]) -> Option<Vec<Edge>> {
    let mut seen_from = vec![u32::MAX; parent.len()];
    for start in 0..parent.len() {
        let mut node = start;
        while seen_from[node] == u32::MAX {
            seen_from[node] = start as u32;
            let Some(edge) = parent[node] else { break };
            node = edges[edge as usize].from as usize;
        }
        if seen_from[node] == start as u32
            && let Some(first) = parent[node]
        {
            let mut cycle = vec![edges[first as usize]];
            let mut at = edges[first as usize].from as usize;
            while at != node {
                let edge = edges[parent[at]? as usize];
                cycle.push(edge);
                at = edge.from as usize;
            }
            cycle.reverse();
            return Some(cycle);
        }
    }
    None
}
