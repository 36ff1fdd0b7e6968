//! Rigid components and the dispatchable form (SPEC 6.1; Muscettola, Morris and Tsamardinos, 1998).

use crate::distance::{DistanceMatrix, INFINITE};
use crate::network::PointId;

/// Points whose times differ by constants.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RigidComponent {
    /// The earliest member; the one with the least id among equals.
    pub leader: PointId,
    /// All members, the leader first, with their time after the leader's.
    pub members: Vec<(PointId, i64)>,
}

/// An edge of the dispatchable form: `to − from ≤ weight`, between leaders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct DispatchEdge {
    /// The leader where the edge starts.
    pub from: PointId,
    /// Another leader.
    pub to: PointId,
    /// The exact distance.
    pub weight: i64,
}

/// A network in which propagating an executed time to direct neighbors never leads into a dead end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispatchable {
    /// The components, by leader.
    pub components: Vec<RigidComponent>,
    /// How many edges the complete graph of finite distances between leaders has.
    pub num_edges_before_pruning: usize,
    /// The edges that are left, by `from` and `to`.
    pub edges: Vec<DispatchEdge>,
}

/// The rigid components of `points`, ordered by leader. Takes time quadratic in their number.
pub fn rigid_components(distances: &DistanceMatrix, points: &[PointId]) -> Vec<RigidComponent> {
    let mut components: Vec<RigidComponent> = Vec::new();
    'points: for &point in points {
        for component in &mut components {
            let there = distances.get(component.leader, point);
            let back = distances.get(point, component.leader);
            if there != INFINITE && back != INFINITE && there.checked_add(back) == Some(0) {
                component.members.push((point, there));
                continue 'points;
            }
        }
        components.push(RigidComponent { leader: point, members: vec![(point, 0)] });
    }
    for component in &mut components {
        component.members.sort_by_key(|&(point, offset)| (offset, point));
        let (leader, first) = component.members[0];
        component.leader = leader;
        for (_, offset) in &mut component.members {
            *offset -= first;
        }
    }
    components.sort_by_key(|component| component.leader);
    components
}

/// The minimal dispatchable form of the network over `points`. Takes time cubic in the number of components.
pub fn dispatchable(distances: &DistanceMatrix, points: &[PointId]) -> Dispatchable {
    let components = rigid_components(distances, points);
    let leaders: Vec<PointId> = components.iter().map(|component| component.leader).collect();
    let count = leaders.len();
    let weight = |from: usize, to: usize| distances.get(leaders[from], leaders[to]);
    let mut present = vec![false; count * count];
    for from in 0..count {
        for to in 0..count {
            present[from * count + to] = from != to && weight(from, to) != INFINITE;
        }
    }
    let num_edges_before_pruning = present.iter().filter(|&&edge| edge).count();
    for from in 0..count {
        for to in 0..count {
            if present[from * count + to] {
                present[from * count + to] = !is_dominated(&present, count, &weight, from, to);
            }
        }
    }
    let mut edges = Vec::new();
    for from in 0..count {
        for to in 0..count {
            if present[from * count + to] {
                edges.push(DispatchEdge { from: leaders[from], to: leaders[to], weight: weight(from, to) });
            }
        }
    }
    Dispatchable { components, num_edges_before_pruning, edges }
}

/// Returns whether an edge that is still present makes `from → to` superfluous.
fn is_dominated(
    present: &[bool],
    count: usize,
    weight: &impl Fn(usize, usize) -> i64,
    from: usize,
    to: usize,
) -> bool {
    let direct = weight(from, to);
    (0..count).filter(|&middle| middle != from && middle != to).any(|middle| {
        let (first, second) = (weight(from, middle), weight(middle, to));
        if first == INFINITE || second == INFINITE || first.checked_add(second) != Some(direct) {
            return false;
        }
        if direct >= 0 {
            second >= 0 && present[middle * count + to]
        } else {
            first < 0 && present[from * count + middle]
        }
    })
}
