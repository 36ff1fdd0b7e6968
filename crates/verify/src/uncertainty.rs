//! What of a plan the environment decides (SPEC 13.1): durations that it chooses, and the events that it executes.

use exact::Bound;
use rmpl::program::Controllability;
use tpn::{ArcId, Network};

/// Returns whether the environment chooses the duration of a selected arc, and the mission asks for plans that
/// withstand that.
pub(crate) fn is_uncertain(network: &Network, selected_arcs: &[bool], arc: ArcId) -> bool {
    network.controllability != Controllability::None
        && network.arcs[arc.index()].is_contingent
        && selected_arcs[arc.index()]
}

/// Returns whether the environment executes each node: a duration that it chooses ends there, or at an event at the
/// same instant because of `[0,0]` alone.
pub(crate) fn natures_events(network: &Network, selected_arcs: &[bool]) -> Vec<bool> {
    let mut natures = vec![false; network.nodes.len()];
    let mut ties = Vec::new();
    for (index, arc) in network.arcs.iter().enumerate() {
        if is_uncertain(network, selected_arcs, ArcId::from_index(index)) {
            natures[arc.to.index()] = true;
        } else if selected_arcs[index] && arc.lower.is_zero() && arc.upper == Bound::ZERO {
            ties.push((arc.from.index(), arc.to.index()));
        }
    }
    // From what is known along the ties until nothing is new.
    while natures.contains(&true) {
        let mut is_new = false;
        for &(from, to) in &ties {
            if natures[from] != natures[to] {
                (natures[from], natures[to]) = (true, true);
                is_new = true;
            }
        }
        if !is_new {
            break;
        }
    }
    natures
}
