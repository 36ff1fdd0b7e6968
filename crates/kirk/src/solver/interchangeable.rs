//! Alternatives of one choice that are alike, of which only the first needs to be tried.
//!
//! Two alternatives are interchangeable if they have the same shape and bounds, and if their conditions, in order, stand
//! in the same relations to all conditions outside the choice and to each other: then a plan with one is a plan with
//! the other in its place.

use std::collections::BTreeMap;

use tpn::{ArcId, DecisionId, LabelId, NodeId};

use crate::model::Model;

/// Larger alternatives are not compared.
const MAX_NODES: usize = 64;
/// Variables with more labels are not looked through.
const MAX_LABELS: usize = 2_000;

/// The alternatives of `decision` that are like an earlier one.
pub(super) fn repeated(model: &Model, decision: DecisionId) -> Vec<u32> {
    let count = model.decisions[decision].alternatives.len() as u32;
    let mut kept: Vec<u32> = Vec::new();
    let mut repeated = Vec::new();
    for alternative in 0..count {
        if kept.iter().take(8).any(|&earlier| are_alike(model, decision, earlier, alternative)) {
            repeated.push(alternative);
        } else {
            kept.push(alternative);
        }
    }
    repeated
}

fn are_alike(model: &Model, decision: DecisionId, left: u32, right: u32) -> bool {
    let alternatives = &model.decisions[decision].alternatives;
    let mut counterparts: BTreeMap<NodeId, NodeId> = BTreeMap::new();
    let mut labels: Vec<(LabelId, LabelId)> = Vec::new();
    let mut open: Vec<(ArcId, ArcId)> = vec![(alternatives[left as usize], alternatives[right as usize])];
    while let Some((left_arc, right_arc)) = open.pop() {
        let (one, other) = (&model.arcs[left_arc], &model.arcs[right_arc]);
        let (left_labels, right_labels) =
            (model.conditions.labels_of(left_arc), model.conditions.labels_of(right_arc));
        if (one.lower, one.upper, one.is_uncertain) != (other.lower, other.upper, other.is_uncertain)
            || left_labels.len() != right_labels.len()
        {
            return false;
        }
        labels.extend(left_labels.iter().copied().zip(right_labels.iter().copied()));
        let merge = model.decisions[decision].merge;
        if Some(one.to) == merge || Some(other.to) == merge {
            if one.to != other.to {
                return false;
            }
            continue;
        }
        if let Some(&known) = counterparts.get(&one.to) {
            if known != other.to {
                return false;
            }
            continue;
        }
        let (left_out, right_out) = (model.out_arcs(one.to), model.out_arcs(other.to));
        let is_choice = |node: NodeId| model.decision_of[node].is_some();
        if left_out.len() != right_out.len()
            || model.is_constrained(one.to)
            || model.is_constrained(other.to)
            || is_choice(one.to) != is_choice(other.to)
            || counterparts.values().any(|&known| known == other.to)
            || counterparts.len() >= MAX_NODES
        {
            return false;
        }
        counterparts.insert(one.to, other.to);
        open.extend(left_out.iter().copied().zip(right_out.iter().copied()));
    }
    labels.iter().all(|&(one, other)| have_same_relations(model, decision, &labels, one, other))
}

fn have_same_relations(
    model: &Model,
    decision: DecisionId,
    labels: &[(LabelId, LabelId)],
    one: LabelId,
    other: LabelId,
) -> bool {
    let conditions = &model.conditions;
    let (left, right) = (&conditions.labels[one], &conditions.labels[other]);
    let variable = &conditions.variables[left.variable];
    if left.variable != right.variable || left.is_ask != right.is_ask || variable.labels.len() > MAX_LABELS {
        return false;
    }
    let same = |third: LabelId, counterpart: LabelId| {
        conditions.conflict(one, third) == conditions.conflict(other, counterpart)
            && conditions.supports(one, third) == conditions.supports(other, counterpart)
            && conditions.supports(third, one) == conditions.supports(counterpart, other)
    };
    let outside = variable.labels.iter().filter(|&&label| !is_inside(model, label, decision));
    outside.copied().all(|third| same(third, third)) && labels.iter().all(|&(third, its)| same(third, its))
}

/// Returns whether a label belongs to an alternative of a decision.
fn is_inside(model: &Model, label: LabelId, decision: DecisionId) -> bool {
    let mut context = model.arcs[model.conditions.labels[label].arc].context;
    while let Some(choice) = context {
        if choice.decision == decision {
            return true;
        }
        context = model.decisions[choice.decision].context;
    }
    false
}
