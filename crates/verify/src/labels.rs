//! The selected labeled intervals, and which pairs of them conflict where the variable does not last (SPEC 3.1).

use exact::Bound;
use tpn::{Extent, LabelId, Network, NodeId, Plan};

/// A selected labeled interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) label: LabelId,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    /// It is one event, or its arc is `[0,0]`: it holds at one instant (SPEC 5.3).
    pub(crate) is_instant: bool,
}

/// The interval of a label: what is about the start of its arc, or about the start of everything, is an instant.
pub(crate) fn interval(network: &Network, label: LabelId) -> Interval {
    let of = &network.labels[label.index()];
    let arc = &network.arcs[of.arc.index()];
    let is_at_start = matches!(of.extent, Extent::Start | Extent::Initial);
    let end = if is_at_start { arc.from } else { arc.to };
    let has_no_length = arc.lower.is_zero() && arc.upper == Bound::ZERO;
    Interval { label, start: arc.from, end, is_instant: is_at_start || has_no_length }
}

/// Returns whether the plan selects the label's arc.
pub(crate) fn is_selected(network: &Network, plan: &Plan, label: LabelId) -> bool {
    plan.selected_arcs[network.labels[label.index()].arc.index()]
}

/// Returns whether the label is of a variable that keeps its value (SPEC 10).
pub(crate) fn is_lasting(network: &Network, label: LabelId) -> bool {
    let variable = network.labels[label.index()].literal.variable;
    network.variables.get(variable.index()).is_some_and(|variable| variable.is_lasting)
}

/// The labels that the plan selects, in textual order.
pub(crate) fn selected(network: &Network, plan: &Plan) -> Vec<LabelId> {
    (0..network.labels.len())
        .map(LabelId::from_index)
        .filter(|&label| is_selected(network, plan, label))
        .collect()
}

/// Every pair of `labels` that cannot hold together, the textually earlier one first. Only labels of one variable are
/// compared, and none of a variable that lasts: [`crate::state`] is about those.
pub(crate) fn conflicting_pairs(network: &Network, labels: &[LabelId]) -> Vec<(LabelId, LabelId)> {
    let mut by_variable: Vec<Vec<LabelId>> = vec![Vec::new(); network.variables.len()];
    for &label in labels.iter().filter(|&&label| !is_lasting(network, label)) {
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
