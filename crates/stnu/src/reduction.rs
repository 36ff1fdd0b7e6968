//! The search back from one contingent link's end.
//!
//! A point that is `d` before the end must wait for the end or until `upper − d` after the activation. Where `d` is at
//! least the link's spread, the second comes first for certain, and the wait is an ordinary constraint: an edge to the
//! activation that bypasses the link's upper case. Where it is not, the point at least waits for the shortest duration;
//! only from there the search continues (rules *relax*, *upper* and *lower* of RUL⁻).

use stn::Heap;

use crate::checker::Row;
use crate::graph::{Graph, Origin};
use crate::network::Link;

/// No arc, and no node.
pub(crate) const NONE: u32 = u32::MAX;

/// Where a path to a link's end starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// The first arc of the path.
    pub(crate) arc: u32,
    /// Where the rest starts; [`NONE`] if the arc is the whole path.
    pub(crate) next: u32,
}

pub(crate) enum Found {
    /// The row is in [`Search::row`], what it implies in [`Search::bypasses`].
    Done,
    /// These other links must be up to date first, each with the node at which the path from its activation starts.
    Awaits(Vec<(u32, u32)>),
    /// The path that starts at the node leads from the link's activation to its end in less than its upper bound.
    Cycle(u32),
}

#[derive(Clone, Copy, Debug, Default)]
struct Reach {
    distance: i64,
    /// The greatest distance on the path to the end, once it is done.
    highest: i64,
    arc: u32,
    node: u32,
    stamp: u32,
    is_done: bool,
}

/// Room for one search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Search {
    reach: Vec<Reach>,
    stamp: u32,
    heap: Heap,
    settled: Vec<u32>,
    awaited: Vec<(u32, u32)>,
    /// Constraints to the link's activation: from which point, their weight, and where the path to the link's end
    /// starts that they represent together with the link's upper case.
    pub(crate) bypasses: Vec<(u32, i64, u32)>,
}

impl Search {
    /// `None` is overflow.
    pub(crate) fn run(
        &mut self,
        id: u32,
        link: &Link,
        graph: &Graph,
        activated: &[Vec<u32>],
        is_done: &dyn Fn(u32) -> bool,
        nodes: &mut Vec<Node>,
    ) -> Option<Found> {
        let potential = graph.potential();
        self.reach.resize(potential.len(), Reach::default());
        if self.stamp == u32::MAX {
            self.reach.fill(Reach::default());
            self.stamp = 0;
        }
        self.stamp += 1;
        self.heap.clear();
        self.settled.clear();
        self.awaited.clear();
        self.bypasses.clear();
        let first_node = nodes.len();
        let (spread, stamp) = (link.spread(), self.stamp);
        let base = potential[link.end.index()];
        self.reach[link.end.index()] = Reach { stamp, arc: NONE, node: NONE, ..Reach::default() };
        self.heap.push(0, link.end.0);
        while let Some((_, point)) = self.heap.pop() {
            let reach = &mut self.reach[point as usize];
            if std::mem::replace(&mut reach.is_done, true) {
                continue;
            }
            let distance = reach.distance;
            let arc = reach.arc;
            let highest_before = graph.end(arc).map(|end| {
                let next = self.reach[end.index()];
                nodes.push(Node { arc: self.reach[point as usize].arc, next: next.node });
                self.reach[point as usize].node = nodes.len() as u32 - 1;
                next.highest
            });
            self.reach[point as usize].highest =
                highest_before.map_or(distance, |before| before.max(distance));
            let node = self.reach[point as usize].node;
            if point == link.activation.0 && distance < link.upper {
                let mut start = node;
                keep(nodes, first_node, std::iter::once(&mut start));
                return Some(Found::Cycle(start));
            }
            self.settled.push(point);
            if distance >= spread {
                if point != link.activation.0 {
                    // At least −lower, and so nothing that overflows.
                    self.bypasses.push((point, distance - link.upper, node));
                }
                continue;
            }
            // A point further along the path that is as far from the end implies this constraint by its own.
            if highest_before.is_none_or(|before| distance > before) {
                self.bypasses.push((point, -link.lower, node));
            }
            for &other in &activated[point as usize] {
                self.awaited.push((other, node));
            }
            for arc in graph.arcs_into(point) {
                if arc.from == link.activation && graph.origin(arc.tag) == Origin::Lower(id) {
                    continue;
                }
                let reached = distance.checked_add(arc.weight)?;
                let reach = &mut self.reach[arc.from.index()];
                if reach.stamp == stamp && (reach.is_done || reach.distance <= reached) {
                    continue;
                }
                let key = reached.checked_add(potential[arc.from.index()].checked_sub(base)?)?;
                *reach = Reach { distance: reached, arc: arc.tag, node: NONE, stamp, ..Reach::default() };
                self.heap.push(key, arc.from.0);
            }
        }
        // What is missing can only bring points closer to the end, and so these links are awaited for certain.
        let mut first: Vec<(u32, u32)> =
            self.awaited.iter().copied().filter(|&(other, _)| !is_done(other)).collect();
        if first.is_empty() {
            return Some(Found::Done);
        }
        keep(nodes, first_node, first.iter_mut().map(|(_, node)| node));
        Some(Found::Awaits(first))
    }

    /// What the search found, but for the bypasses.
    pub(crate) fn row(&mut self, row: &mut Row) {
        row.reached.clear();
        row.reached.reserve_exact(self.settled.len());
        self.settled.sort_unstable();
        row.reached.extend(self.settled.iter().map(|&point| (point, self.reach[point as usize].distance)));
        self.awaited.sort_unstable();
        row.awaited.clone_from(&self.awaited);
    }

    /// Leaves out what an arc says already.
    pub(crate) fn leave_out_known(&mut self, link: &Link, graph: &Graph) {
        for &(point, weight, _) in &self.bypasses {
            self.reach[point as usize].distance = weight;
            self.reach[point as usize].is_done = false;
        }
        for arc in graph.arcs_into(link.activation.0) {
            // A lower case is not a constraint.
            let reach = &mut self.reach[arc.from.index()];
            reach.is_done |=
                reach.distance >= arc.weight && !matches!(graph.origin(arc.tag), Origin::Lower(_));
        }
        self.bypasses.retain(|&(point, ..)| !self.reach[point as usize].is_done);
    }
}

/// Keeps of a search's nodes only the paths that start at `starts`, which are made to point at what is kept.
fn keep<'a>(nodes: &mut Vec<Node>, first: usize, starts: impl Iterator<Item = &'a mut u32>) {
    let found = nodes.split_off(first);
    let mut kept = vec![NONE; found.len()];
    for start in starts {
        // A node is behind the one at which the rest of its path starts.
        let mut path = Vec::new();
        let mut node = *start;
        let mut next = loop {
            if node == NONE || (node as usize) < first {
                break node;
            }
            let index = node as usize - first;
            if kept[index] != NONE {
                break kept[index];
            }
            path.push(index);
            node = found[index].next;
        };
        for index in path.into_iter().rev() {
            nodes.push(Node { arc: found[index].arc, next });
            next = nodes.len() as u32 - 1;
            kept[index] = next;
        }
        *start = next;
    }
}
