//! The check of conflicting intervals of variables that do not last: which one the plan says is first (SPEC 5.3).

use std::collections::BTreeSet;

use tpn::{LabelId, Network, Ordering, Plan};

use super::Checker;
use crate::labels::{self, interval};
use crate::uncertainty::natures_events;
use crate::{Rule, Violation};

/// The order of conflicts as the plan states it; each pair is accounted for by the rule that asks for it.
pub(super) struct Stated {
    /// Sorted, without repeats.
    said: Vec<(LabelId, LabelId)>,
    /// Whether each of them has been asked for.
    is_accounted: Vec<bool>,
    added: BTreeSet<(LabelId, LabelId)>,
    /// Whether the document that the plan was read from leaves out some pairs.
    is_cut: bool,
}

/// What is said of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The one that was asked for first is first.
    InOrder,
    /// The other one is.
    Reversed,
    /// The document leaves the pair out.
    Omitted,
}

impl Stated {
    pub(super) fn new(plan: &Plan) -> Self {
        let pair = |ordering: &Ordering| (ordering.first, ordering.then);
        let mut said: Vec<(LabelId, LabelId)> = plan.conflict_order.iter().map(pair).collect();
        said.sort_unstable();
        said.dedup();
        let is_accounted = vec![false; said.len()];
        let added = plan.orderings_added.iter().map(pair).collect();
        Self { said, is_accounted, added, is_cut: plan.conflict_order_omitted > 0 }
    }

    fn is_said(&self, first: LabelId, then: LabelId) -> bool {
        self.said.binary_search(&(first, then)).is_ok()
    }

    /// Returns whether it is said; then it has been accounted for.
    fn take(&mut self, first: LabelId, then: LabelId) -> bool {
        let found = self.said.binary_search(&(first, then));
        if let Ok(index) = found {
            self.is_accounted[index] = true;
        }
        found.is_ok()
    }

    /// Returns which of two that must be ordered is first; what is wrong, if the plan does not say exactly that.
    pub(super) fn side(&mut self, network: &Network, one: LabelId, other: LabelId) -> Result<Side, String> {
        let names = || (network.label_name(one), network.label_name(other));
        match (self.take(one, other), self.take(other, one)) {
            (true, false) => Ok(Side::InOrder),
            (false, true) => Ok(Side::Reversed),
            (true, true) => Err(format!("{} and {} are ordered in both directions", names().0, names().1)),
            (false, false) if self.is_cut => Ok(Side::Omitted),
            (false, false) => {
                Err(format!("the plan does not say which of {} and {} is first", names().0, names().1))
            }
        }
    }

    /// What is said of pairs that no rule asks for, and what was added without being said.
    pub(super) fn check_rest(&self, network: &Network, plan: &Plan, violations: &mut Vec<Violation>) {
        let mut complain = |message: String, (one, other): (LabelId, LabelId)| {
            let names = vec![network.label_name(one), network.label_name(other)];
            violations.push(Violation::new(Rule::Conflict, message).with_intervals(names));
        };
        let unaccounted =
            self.said.iter().zip(&self.is_accounted).filter(|(_, is_accounted)| !**is_accounted);
        for (&(first, then), _) in unaccounted {
            let (first_name, then_name) = (network.label_name(first), network.label_name(then));
            complain(
                format!("{first_name} and {then_name} are ordered, but do not conflict or are not selected"),
                (first, then),
            );
        }
        let of_conditions = plan.orderings_added.iter().filter(|it| !labels::is_lasting(network, it.first));
        for ordering in of_conditions.filter(|_| !self.is_cut) {
            // Intervals without length, of a variable that does not last, may be at one instant: then each is before the
            // other, and the stated order, which has been looked at, may be the other one.
            if !self.is_said(ordering.first, ordering.then) && !self.is_said(ordering.then, ordering.first) {
                let (first, then) = (network.label_name(ordering.first), network.label_name(ordering.then));
                complain(
                    format!("{first} comes before {then}, but the plan's conflict order lacks this pair"),
                    (ordering.first, ordering.then),
                );
            }
        }
    }
}

impl Checker<'_> {
    /// `before` of SPEC 5.3. What the environment executes waits for no gap (SPEC 13.1): `natures` says which events it does.
    fn is_before(&self, first: LabelId, then: LabelId, stated: &Stated, natures: &[bool]) -> bool {
        if stated.added.contains(&(first, then)) {
            return true;
        }
        let (first, then) = (interval(self.network, first), interval(self.network, then));
        let is_natures = natures.get(then.start.index()) == Some(&true);
        let least = if first.is_instant && !is_natures { self.gap } else { 0 };
        self.entailment.is_at_least(first.end, then.start, least)
    }

    pub(super) fn check_conflicts(&self, stated: &mut Stated, violations: &mut Vec<Violation>) {
        let network = self.network;
        let selected = labels::selected(network, self.plan);
        let natures = natures_events(network, &self.plan.selected_arcs);
        let mut complain = |message: String, (one, other): (LabelId, LabelId)| {
            let names = vec![network.label_name(one), network.label_name(other)];
            violations.push(Violation::new(Rule::Conflict, message).with_intervals(names));
        };
        for (one, other) in labels::conflicting_pairs(network, &selected) {
            let side = stated.side(network, one, other);
            if network.labels[one.index()].arc == network.labels[other.index()].arc {
                let (one_name, other_name) = (network.label_name(one), network.label_name(other));
                complain(format!("{one_name} and {other_name} are on the same arc"), (one, other));
                continue;
            }
            let (first, then) = match side {
                Ok(Side::Reversed) => (other, one),
                Ok(Side::Omitted) if self.is_before(other, one, stated, &natures) => (other, one),
                Ok(Side::InOrder | Side::Omitted) => (one, other),
                Err(problem) => {
                    complain(problem, (one, other));
                    continue;
                }
            };
            if !self.is_before(first, then, stated, &natures) {
                let (first_name, then_name) = (network.label_name(first), network.label_name(then));
                complain(
                    format!("{first_name} must come before {then_name}, but may overlap it"),
                    (first, then),
                );
            }
        }
    }
}
