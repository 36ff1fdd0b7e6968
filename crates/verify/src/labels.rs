//! The selected labelled intervals, by variable, and which pairs of them conflict.

use tpn::{LabelId, Network, NodeId, Plan};

/// A selected labelled interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) label: LabelId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    /// Its arc is `[0,0]`: it holds at one instant (SPEC 5.3).
    pub(crate) is_instant: bool,
}

/// The interval of a label.
pub(crate) fn interval(network: &Network, label: LabelId) -> Interval {
    let arc = &network.arcs[network.labels[label.index()].arc.index()];
    let is_instant = exact::Bound::Finite(arc.lower) == exact::Bound::ZERO && arc.upper == exact::Bound::ZERO;
    Interval { label, start: arc.from, end: arc.to, is_instant }
}

/// Whether the plan selects the label's arc.
pub(crate) fn is_selected(network: &Network, plan: &Plan, label: LabelId) -> bool {
    plan.selected_arcs[network.labels[label.index()].arc.index()]
}

/// The labels that the plan selects, in textual order.
pub(crate) fn selected(network: &Network, plan: &Plan) -> Vec<LabelId> {
    (0..network.labels.len())
        .map(LabelId::from_index)
        .filter(|&label| is_selected(network, plan, label))
        .collect()
}

/// Every pair of `labels` that cannot hold together, the textually earlier one first. Only labels of one variable are
/// compared.
pub(crate) fn conflicting_pairs(network: &Network, labels: &[LabelId]) -> Vec<(LabelId, LabelId)> {
    let mut by_variable: Vec<Vec<LabelId>> = vec![Vec::new(); network.variables.len()];
    for &label in labels {
        if let Some(of_variable) = by_variable.get_mut(network.labels[label.index()].literal.variable.index())
        {
            of_variable.push(label);
        }
    }
    let mut pairs = Vec::new();
    for of_variable in by_variable {
        for (position, &first) in of_variable.iter().enumerate() {
            for &second in &of_variable[position + 1..] {
                if network.labels[first.index()].literal.conflicts(&network.labels[second.index()].literal) {
                    pairs.push((first, second));
                }
            }
        }
    }
    pairs
}
