//! Strong controllability (Vidal and Fargier, 1999): one schedule of the executive's points that suits whatever nature
//! chooses, without looking.
//!
//! Every end is its link's root, a point of the executive's, after a sum of durations. A constraint must hold for the
//! worst durations, which makes it one between roots: what is left is a simple temporal network.

use crate::checker::Undecided;
use crate::graph::{Contradiction, Graph, Origin};
use crate::network::{EdgeId, LinkId, Network, PointId};

/// The answer to [`check_strong`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StrongVerdict {
    /// A time for each point, of no particular origin; for nature's points the earliest.
    Controllable(Vec<i64>),
    /// Constraints that no schedule keeps for all durations, in the order of a cycle of roots.
    Uncontrollable(Vec<EdgeId>),
}

/// Whether one schedule suits all that nature may choose. `O(points · edges)` at worst.
pub fn check_strong(network: &Network) -> Result<StrongVerdict, Undecided> {
    let mut graph = Graph::default();
    graph.resize(network.num_points());
    for (id, edge) in (0..).zip(network.edges()) {
        let (from, to) = (chain(network, edge.from), chain(network, edge.to));
        // Links of both chains count alike for both ends.
        let shared = from.iter().rev().zip(to.iter().rev()).take_while(|(one, other)| one == other).count();
        let mut weight = edge.weight;
        for link in &to[..to.len() - shared] {
            weight = weight.checked_sub(network.link(*link).upper).ok_or(Undecided::Overflow)?;
        }
        for link in &from[..from.len() - shared] {
            weight = weight.checked_add(network.link(*link).lower).ok_or(Undecided::Overflow)?;
        }
        let root =
            |point, chain: &[LinkId]| chain.last().map_or(point, |&link| network.link(link).activation);
        graph.push(root(edge.from, &from).0, root(edge.to, &to).0, weight, Origin::Edge(id));
    }
    match graph.repair_all() {
        Ok(()) => {
            let mut schedule = graph.potential.clone();
            for point in (0..network.num_points() as u32).map(PointId) {
                let chain = chain(network, point);
                let Some(&last) = chain.last() else { continue };
                let mut time = graph.potential[network.link(last).activation.index()];
                for &link in &chain {
                    time = time.checked_add(network.link(link).lower).ok_or(Undecided::Overflow)?;
                }
                schedule[point.index()] = time;
            }
            Ok(StrongVerdict::Controllable(schedule))
        }
        Err(Contradiction::Overflow) => Err(Undecided::Overflow),
        Err(Contradiction::NegativeCycle) => Ok(StrongVerdict::Uncontrollable(
            graph
                .cycle
                .iter()
                .filter_map(|&arc| match graph.arcs[arc as usize].origin {
                    Origin::Edge(id) => Some(EdgeId(id)),
                    Origin::Lower(_) | Origin::Bypass { .. } => None,
                })
                .collect(),
        )),
    }
}

/// The links before a point of nature's, the latest first.
fn chain(network: &Network, point: PointId) -> Vec<LinkId> {
    let mut chain = Vec::new();
    let mut at = point;
    while let Some(link) = network.link_ending_at(at) {
        chain.push(link);
        at = network.link(link).activation;
    }
    chain
}
