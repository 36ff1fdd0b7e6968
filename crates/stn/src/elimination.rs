//! The elimination tree of a network, on which the windows of its time points are kept exact while some of them happen.
//!
//! Points are eliminated one after the other, those with few neighbors first; what a point says of its neighbors stays as
//! constraints between these, so that the network becomes directionally path-consistent (Dechter, Meiri and Pearl 1991).
//! Then a shortest way between two points leads up the tree and down again, as in customizable contraction hierarchies
//! (Dibbelt, Strasser and Wagner 2016). Of those that could be next the one is eliminated whose removal makes the tree
//! least high: of a network of bounded tree width, such as that of nested sequences and parallel blocks, it is
//! logarithmically high. Points that keep too many neighbors are not eliminated: they are the core.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use crate::network::{Overflow, PointId, Stn};

/// A constraint between a point and one that was eliminated later, or never.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UpEdge {
    pub(crate) to: u32,
    /// `to − from ≤ up`; [`FREE`] where it is not bounded.
    pub(crate) up: i64,
    /// `from − to ≤ down`; [`FREE`] where it is not bounded.
    pub(crate) down: i64,
}

pub(crate) const FREE: i64 = i64::MAX;

/// Points with more neighbors than this are not eliminated: it takes time quadratic in them.
const MAX_DEGREE: usize = 24;
/// How many levels of the tree a neighbor more is worth.
const DEGREE_WEIGHT: usize = 4;

/// The tree, with the core above it. Making it takes time linear in the number of points of bounded degree, but for the
/// queue.
#[derive(Clone, Debug)]
pub(crate) struct EliminationTree {
    /// The constraints of each point to those above it; of one of the core, to all its neighbors there.
    pub(crate) edges: Vec<Vec<UpEdge>>,
    /// The next point above each in the tree; [`ROOT`] for those that only the core is above of, and for the core.
    pub(crate) parent: Vec<u32>,
    /// How far below its root each is.
    pub(crate) depth: Vec<u32>,
    pub(crate) is_core: Vec<bool>,
    /// The points that were eliminated, in order.
    pub(crate) order: Vec<u32>,
}

/// Above the roots there is none.
pub(crate) const ROOT: u32 = u32::MAX;

/// What is known between a point and a neighbor: from it to the neighbor, and back.
type Neighbors = BTreeMap<u32, (i64, i64)>;

impl EliminationTree {
    /// The tree of a consistent network.
    pub(crate) fn new(stn: &Stn) -> Result<Self, Overflow> {
        let count = stn.num_points();
        let mut neighbors: Vec<Neighbors> = vec![Neighbors::new(); count];
        for edge in (0..stn.num_edges()).filter_map(|position| stn.edge(position)) {
            if edge.from != edge.to {
                tighten(&mut neighbors, edge.from.0, edge.to.0, (edge.weight, FREE));
            }
        }
        let mut tree = Self {
            edges: vec![Vec::new(); count],
            parent: vec![ROOT; count],
            depth: vec![0; count],
            is_core: vec![true; count],
            order: Vec::with_capacity(count),
        };
        let mut level = vec![0; count];
        let cost = |degree: usize, level: usize| DEGREE_WEIGHT * degree.max(2) + level;
        let mut costs: Vec<usize> = neighbors.iter().map(|own| cost(own.len(), 0)).collect();
        let mut queue: BinaryHeap<Reverse<(usize, u32)>> =
            (0..count as u32).map(|point| Reverse((costs[point as usize], point))).collect();
        while let Some(Reverse((at, point))) = queue.pop() {
            let index = point as usize;
            if !tree.is_core[index] || at != costs[index] || neighbors[index].len() > MAX_DEGREE {
                continue;
            }
            tree.is_core[index] = false;
            tree.order.push(point);
            let own: Vec<(u32, (i64, i64))> = std::mem::take(&mut neighbors[index]).into_iter().collect();
            tree.edges[index] = own.iter().map(|&(to, (up, down))| UpEdge { to, up, down }).collect();
            for &(one, _) in &own {
                neighbors[one as usize].remove(&point);
                level[one as usize] = level[one as usize].max(level[index] + 1);
            }
            for (place, &(one, (to_one, from_one))) in own.iter().enumerate() {
                for &(other, (to_other, from_other)) in &own[place + 1..] {
                    // Also where it bounds nothing: whom a point leads up to is to be above it in the tree.
                    let along = (sum(from_one, to_other, other)?, sum(from_other, to_one, one)?);
                    tighten(&mut neighbors, one, other, along);
                }
            }
            for &(one, _) in &own {
                let one = one as usize;
                costs[one] = cost(neighbors[one].len(), level[one]);
                queue.push(Reverse((costs[one], one as u32)));
            }
        }
        tree.arrange(&neighbors);
        Ok(tree)
    }

    /// The core keeps what is left, and every other point finds the next one above it.
    fn arrange(&mut self, left: &[Neighbors]) {
        let mut rank = vec![u32::MAX; self.edges.len()];
        for (place, &point) in (0..).zip(&self.order) {
            rank[point as usize] = place;
        }
        for (point, own) in left.iter().enumerate().filter(|(point, _)| self.is_core[*point]) {
            self.edges[point] = own.iter().map(|(&to, &(up, down))| UpEdge { to, up, down }).collect();
        }
        for &point in self.order.iter().rev() {
            let above = self.edges[point as usize].iter().map(|edge| edge.to);
            let above = above.filter(|&to| !self.is_core[to as usize]);
            if let Some(parent) = above.min_by_key(|&to| rank[to as usize]) {
                self.parent[point as usize] = parent;
                self.depth[point as usize] = self.depth[parent as usize] + 1;
            }
        }
    }

    /// A point and those above it in the tree, the root last. All that its constraints lead up to is among them or in the
    /// core.
    pub(crate) fn chain(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(point), |&point| {
            Some(self.parent[point as usize]).filter(|&parent| parent != ROOT)
        })
    }
}

fn tighten(neighbors: &mut [Neighbors], from: u32, to: u32, (there, back): (i64, i64)) {
    let known = neighbors[from as usize].entry(to).or_insert((FREE, FREE));
    *known = (known.0.min(there), known.1.min(back));
    let known = neighbors[to as usize].entry(from).or_insert((FREE, FREE));
    *known = (known.0.min(back), known.1.min(there));
}

/// The bound along two constraints. What is more than fits bounds nothing.
pub(crate) fn sum(first: i64, second: i64, point: u32) -> Result<i64, Overflow> {
    if first == FREE || second == FREE {
        return Ok(FREE);
    }
    match first.checked_add(second) {
        Some(sum) => Ok(sum),
        None if first > 0 => Ok(FREE),
        None => Err(Overflow { point: PointId(point) }),
    }
}
