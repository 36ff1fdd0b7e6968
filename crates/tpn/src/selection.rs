//! What a set of choices selects: the closure of the start (SPEC 3.1).

use crate::network::{ArcId, Network};
use crate::plan::Choice;

/// The nodes and arcs that are selected when each decision is taken as `choices` say. A decision that is reached but
/// not in `choices` selects nothing. Time is linear.
pub fn closure(network: &Network, choices: &[Choice]) -> (Vec<bool>, Vec<bool>) {
    let mut taken: Vec<Option<u32>> = vec![None; network.decisions.len()];
    for choice in choices {
        if let Some(slot) = taken.get_mut(choice.decision.index()) {
            *slot = Some(choice.alternative);
        }
    }
    let mut nodes = vec![false; network.nodes.len()];
    let mut arcs = vec![false; network.arcs.len()];
    let mut open = vec![network.start];
    nodes[network.start.index()] = true;
    while let Some(node) = open.pop() {
        let node = &network.nodes[node.index()];
        let is_selected = |arc: &ArcId| match node.decision {
            None => true,
            Some(decision) => network.arcs[arc.index()].choice.is_some_and(|(of, alternative)| {
                of == decision && taken[decision.index()] == Some(alternative)
            }),
        };
        for &arc in node.out_arcs.iter().filter(|arc| is_selected(arc)) {
            arcs[arc.index()] = true;
            let to = network.arcs[arc.index()].to;
            if !std::mem::replace(&mut nodes[to.index()], true) {
                open.push(to);
            }
        }
    }
    for constraint in network.constraints() {
        let arc = &network.arcs[constraint.index()];
        arcs[constraint.index()] = nodes[arc.from.index()] && nodes[arc.to.index()];
    }
    (nodes, arcs)
}
