//! Strong controllability (Vidal and Fargier, 1999): one schedule of the executive's points that suits whatever the
//! environment chooses, without looking.
//!
//! Every end is its link's root, a point of the executive's, after a sum of durations. A constraint must hold for the
//! worst durations, which makes it one between roots: what is left is a simple temporal network.

use stn::{Inconsistency, Stn};

use crate::checker::Undecided;
use crate::network::{EdgeId, LinkId, Network, PointId};

/// The answer to [`check_strong`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StrongVerdict {
    /// A time for each point, of no particular origin; for the environment's points the earliest.
    Controllable(Vec<i64>),
    /// Constraints that no schedule keeps for all durations, in the order of a cycle of roots.
    Uncontrollable(Vec<EdgeId>),
}

/// Whether one schedule suits all that the environment may choose. `O(points · edges)` at worst.
pub fn check_strong(network: &Network) -> Result<StrongVerdict, Undecided> {
    let mut roots = Stn::new(network.num_points());
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
        roots.push(root(edge.from, &from), root(edge.to, &to), weight, id);
    }
    let points: Vec<PointId> = (0..network.num_points() as u32).map(PointId).collect();
    match roots.settle(&points) {
        Ok(()) => {
            let mut schedule = roots.schedule().to_vec();
            for point in points {
                let chain = chain(network, point);
                let Some(&last) = chain.last() else { continue };
                let mut time = roots.schedule()[network.link(last).activation.index()];
                for &link in &chain {
                    time = time.checked_add(network.link(link).lower).ok_or(Undecided::Overflow)?;
                }
                schedule[point.index()] = time;
            }
            Ok(StrongVerdict::Controllable(schedule))
        }
        Err(Inconsistency::Overflow(_)) => Err(Undecided::Overflow),
        Err(Inconsistency::NegativeCycle) => {
            Ok(StrongVerdict::Uncontrollable(roots.cycle().iter().map(|edge| EdgeId(edge.tag)).collect()))
        }
    }
}

/// The links before a point of the environment's, the latest first.
fn chain(network: &Network, point: PointId) -> Vec<LinkId> {
    let mut chain = Vec::new();
    let mut at = point;
    while let Some(link) = network.link_ending_at(at) {
        chain.push(link);
        at = network.link(link).activation;
    }
    chain
}
