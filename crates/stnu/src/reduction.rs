//! The search back from one contingent link's end.
//!
//! A point that is `d` before the end must wait for the end or until `upper − d` after the activation. Where `d` is at
//! least the link's spread, the second comes first for certain, and the wait is an ordinary constraint: an edge to the
//! activation that bypasses the link's upper case. Where it is not, the point at least waits for the shortest duration;
//! only from there the search goes on (rules *relax*, *upper* and *lower* of RUL⁻).

use crate::checker::Row;
use crate::graph::{Graph, NONE, Origin};
use crate::heap::Heap;
use crate::network::Link;

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
    /// This other link must be up to date first; the path from its activation starts at the node.
    Awaits(u32, u32),
    /// The path that starts at the node leads from the link's activation to its end in less than its upper bound.
    Cycle(u32),
}

#[derive(Clone, Copy, Debug, Default)]
struct Reach {
    distance: i64,
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
    /// starts that they stand for together with the link's upper case.
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
        self.reach.resize(graph.potential.len(), Reach::default());
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
        let base = graph.potential[link.end.index()];
        self.reach[link.end.index()] = Reach { distance: 0, arc: NONE, node: NONE, stamp, is_done: false };
        self.heap.push(0, link.end.0);
        while let Some((_, point)) = self.heap.pop() {
            let reach = &mut self.reach[point as usize];
            if std::mem::replace(&mut reach.is_done, true) {
                continue;
            }
            let distance = reach.distance;
            let arc = reach.arc;
            if arc != NONE {
                let next = self.reach[graph.arcs[arc as usize].to as usize].node;
                nodes.push(Node { arc, next });
                self.reach[point as usize].node = nodes.len() as u32 - 1;
            }
            let node = self.reach[point as usize].node;
            if point == link.activation.0 && distance < link.upper {
                return Some(Found::Cycle(keep(nodes, first_node, node)));
            }
            self.settled.push(point);
            if distance >= spread {
                if point != link.activation.0 {
                    // At least −lower, and so nothing that overflows.
                    self.bypasses.push((point, distance - link.upper, node));
                }
                continue;
            }
            // Where the path starts with a step that is not up, the constraint of its second point implies this one.
            if graph.arcs.get(arc as usize).is_none_or(|arc| arc.weight > 0) {
                self.bypasses.push((point, -link.lower, node));
            }
            for &other in &activated[point as usize] {
                if !is_done(other) {
                    return Some(Found::Awaits(other, keep(nodes, first_node, node)));
                }
                self.awaited.push((other, node));
            }
            for (arc_id, arc) in graph.arcs_into(point) {
                if arc.origin == Origin::Lower(id) {
                    continue;
                }
                let reached = distance.checked_add(arc.weight)?;
                let reach = &mut self.reach[arc.from as usize];
                if reach.stamp == stamp && (reach.is_done || reach.distance <= reached) {
                    continue;
                }
                let key = reached.checked_add(graph.potential[arc.from as usize].checked_sub(base)?)?;
                *reach = Reach { distance: reached, arc: arc_id, node: NONE, stamp, is_done: false };
                self.heap.push(key, arc.from);
            }
        }
        Some(Found::Done)
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
        for (_, arc) in graph.arcs_into(link.activation.0) {
            // A lower case is no constraint.
            let reach = &mut self.reach[arc.from as usize];
            reach.is_done |= !matches!(arc.origin, Origin::Lower(_)) && reach.distance >= arc.weight;
        }
        self.bypasses.retain(|&(point, ..)| !self.reach[point as usize].is_done);
    }
}

/// Keeps of a search's nodes only the path that starts at `node`; where it starts then.
fn keep(nodes: &mut Vec<Node>, first: usize, node: u32) -> u32 {
    let arcs: Vec<u32> = crate::checker::path(nodes, node).collect();
    nodes.truncate(first);
    let mut next = NONE;
    for &arc in arcs.iter().rev() {
        nodes.push(Node { arc, next });
        next = nodes.len() as u32 - 1;
    }
    next
}
