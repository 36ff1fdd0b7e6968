//! Where everything is decided: conflicting pairs that the least times put in each other's way become choice points.

use std::collections::BTreeSet;

use tpn::{LabelId, VariableId};

use super::disjunctive::MAX_TASKS;
use super::encode::Problem;
use super::growth::{Growth, ORDER, Unencoded};
use super::interval::DueGap;
use super::literal::Literal;
use super::premise::Premise;
use super::touching::{Touching, Unordered};
use super::{ChoicePoint, ChoicePointKind, Solver};
use crate::failure::Member;
use crate::trace::Event;

/// Of a variable with more pairs, only those in each other's way are added.
const MAX_PAIRS_AT_ONCE: usize = 2_000;

impl Solver {
    /// Adds the pairs that the present solution breaks. `false` if it breaks none.
    pub(super) fn add_pairs(&mut self, problem: &mut Problem<'_>) -> bool {
        let mut new: BTreeSet<(LabelId, LabelId)> = BTreeSet::new();
        let mut exclusive: Vec<VariableId> = Vec::new();
        let mut unordered: Option<Unordered> = None;
        for variable in problem.labels_by_variable.keys() {
            let present: Vec<LabelId> = problem.labels_by_variable[variable]
                .iter()
                .copied()
                .filter(|&label| self.trail.holds(problem.intervals[label].presence))
                .collect();
            let mut broken = self.broken_pairs(problem, &present);
            if problem.touches.rule != Touching::Always && !broken.is_empty() {
                let unordered = unordered.get_or_insert_with(|| problem.unordered(self));
                // Where only a part of the mission is looked at, what the rest of it orders may overlap.
                broken.retain(|&pair| self.overlap(problem, pair) || !unordered.relates(problem.model, pair));
            }
            if broken.is_empty() {
                continue;
            }
            if !std::mem::replace(&mut problem.has_exclusion[variable], true) {
                exclusive.push(variable);
            }
            let all = Self::unordered_pairs(problem, &present);
            new.extend(if all.len() <= MAX_PAIRS_AT_ONCE { all } else { broken });
        }
        if new.is_empty() {
            return false;
        }
        for &(left, right) in &new {
            self.tell(|| Event::Threat { left, right });
        }
        self.retract(0);
        let first = self.differences.len();
        for &(left, right) in &new {
            self.add_pair(problem, left, right);
        }
        self.check_differences(first);
        for variable in exclusive {
            let exists = |label: &LabelId| !self.trail.fails(problem.intervals[*label].presence);
            let labels: Vec<LabelId> =
                problem.labels_by_variable[variable].iter().copied().filter(exists).collect();
            self.exclude_sets(problem, &labels, Premise::Variable(variable));
        }
        true
    }

    /// Finds sets among the labels of one variable that must be kept apart.
    fn exclude_sets(&mut self, problem: &mut Problem<'_>, labels: &[LabelId], premise: Premise) {
        let mut is_covered = vec![false; labels.len()];
        for (first, &seed) in labels.iter().enumerate() {
            if is_covered[first] || labels.len() > MAX_TASKS {
                continue;
            }
            let mut members = vec![seed];
            let mut due = DueGap::Always;
            for (position, &label) in labels.iter().enumerate() {
                if position == first || problem.intervals[label].duration == 0 {
                    continue;
                }
                let relations =
                    members.iter().map(|&member| problem.exclusion(member.min(label), member.max(label)));
                let relations: Option<Vec<DueGap>> = relations.collect();
                if let Some(relations) = relations {
                    due = relations.into_iter().fold(due, DueGap::min);
                    members.push(label);
                    is_covered[position] = true;
                }
            }
            if members.len() > 2 {
                let tasks = members.iter().map(|&label| problem.intervals[label]).collect();
                let when = if due == DueGap::Assumed { problem.touches.none } else { Literal::TRUE };
                let gap = if due == DueGap::Never { 0 } else { problem.model.gap };
                self.disjunctives.add_apart(tasks, (gap, when), premise);
            }
        }
    }

    /// Makes all conflicting pairs choice points, so that solutions differ in their orders.
    pub(super) fn add_all_pairs(
        &mut self,
        problem: &mut Problem<'_>,
        growth: &mut Growth<'_>,
    ) -> Result<(), Unencoded> {
        let exists = |label: LabelId| !self.trail.fails(problem.intervals[label].presence);
        let mut pairs: BTreeSet<(LabelId, LabelId)> = BTreeSet::new();
        for labels in &problem.labels_by_variable {
            for (position, &left) in labels.iter().enumerate() {
                let later = labels[position + 1..].iter().copied();
                growth.look_at(later.len())?;
                let before = pairs.len();
                pairs.extend(later.map(|right| (left, right)).filter(|&(left, right)| {
                    exists(left)
                        && exists(right)
                        && problem.can_be_together(left, right)
                        && problem.must_be_ordered((left, right))
                        && !problem.is_ordered_by_windows((left, right))
                }));
                growth.add(ORDER * (pairs.len() - before))?;
            }
        }
        let first = self.differences.len();
        for (left, right) in pairs {
            self.add_pair(problem, left, right);
        }
        self.check_differences(first);
        Ok(())
    }

    /// Returns whether the least times keep all conflicting pairs apart and satisfy all differences in force.
    pub(super) fn is_solution(&self, problem: &Problem<'_>) -> bool {
        let labels = &problem.labels_by_variable;
        let is_kept = |left: LabelId, right: LabelId| {
            let is_present = |label: LabelId| self.trail.holds(problem.intervals[label].presence);
            left == right
                || !problem.model.conditions.conflict(left, right)
                || !is_present(left)
                || !is_present(right)
                || !self.overlap(problem, (left, right))
        };
        labels
            .iter()
            .all(|labels| labels.iter().all(|&left| labels.iter().all(|&right| is_kept(left, right))))
            && self.differences.are_satisfied(&self.trail)
    }

    /// Returns whether two intervals that are present overlap in the least times; to touch is not to overlap.
    fn overlap(&self, problem: &Problem<'_>, (left, right): (LabelId, LabelId)) -> bool {
        let (one, other) = (problem.intervals[left], problem.intervals[right]);
        self.trail.least(one.end) > self.trail.least(other.start)
            && self.trail.least(other.end) > self.trail.least(one.start)
    }

    /// Conflicting pairs that overlap in the least times, by a sweep over them.
    fn broken_pairs(&self, problem: &Problem<'_>, present: &[LabelId]) -> Vec<(LabelId, LabelId)> {
        let mut by_start: Vec<(i64, i64, LabelId)> = present
            .iter()
            .map(|&label| {
                let interval = &problem.intervals[label];
                (self.trail.least(interval.start), self.trail.least(interval.end), label)
            })
            .collect();
        by_start.sort_unstable();
        let gap = problem.model.gap;
        let mut broken = Vec::new();
        let mut running: Vec<(i64, LabelId)> = Vec::new();
        for &(start, end, label) in &by_start {
            running.retain(|&(other_end, _)| other_end + gap > start);
            for &(_, other) in &running {
                let pair = (label.min(other), label.max(other));
                if problem.must_be_ordered(pair) && !problem.is_ordered_by_windows(pair) {
                    broken.push(pair);
                }
            }
            running.push((end, label));
        }
        broken
    }

    fn unordered_pairs(problem: &Problem<'_>, present: &[LabelId]) -> Vec<(LabelId, LabelId)> {
        let mut pairs = Vec::new();
        for (position, &left) in present.iter().enumerate() {
            for &right in &present[position + 1..] {
                if problem.must_be_ordered((left, right)) && !problem.is_ordered_by_windows((left, right)) {
                    pairs.push((left, right));
                    if pairs.len() > MAX_PAIRS_AT_ONCE {
                        return pairs;
                    }
                }
            }
        }
        pairs
    }

    fn add_pair(&mut self, problem: &mut Problem<'_>, left: LabelId, right: LabelId) {
        problem.known_pairs.insert((left, right));
        self.tell_from([left, right].map(Member::Condition));
        let (one, other) = (problem.intervals[left], problem.intervals[right]);
        let when = [one.presence, other.presence];
        let left_first = self.boolean();
        let first = self.differences.len();
        let touch = problem.touch(self, (left, right));
        self.check_differences(first);
        // Where both exist in any case, the second order is the first one's opposite.
        let is_certain = touch.is_empty() && self.are_certain(&when);
        let right_first = if is_certain { !left_first } else { self.boolean() };
        self.resize();
        // An order of intervals that are not both there says nothing: that it fails would only be more to propagate.
        if !is_certain {
            let orders = [!when[0], !when[1], left_first, right_first];
            self.at_least_one(orders.into_iter().chain(touch.iter().copied()));
        }
        for (order, (first, then), gap) in [
            (left_first, (one, other), problem.gap_between(left, right)),
            (right_first, (other, one), problem.gap_between(right, left)),
        ] {
            self.difference(then.start, first.end, -gap, [order; 2]);
        }
        problem.orders.insert((left, right), [left_first, right_first]);
        let kind = ChoicePointKind::Orders { left, right };
        let last = problem.preferred_order(left, right);
        let options = [left_first, right_first].into_iter().chain(touch).collect();
        self.add_choice_point(ChoicePoint { when: when.to_vec(), kind, options, last }, 0.0);
    }

    /// The option of a choice point to try first.
    pub(super) fn preferred(&self, choice_point: &ChoicePoint) -> Option<Literal> {
        let is_open = |option: &Literal| self.trail.is_open(*option);
        if self.is_in_textual_order && choice_point.kind != ChoicePointKind::Resolvers {
            return choice_point.options.iter().copied().find(is_open);
        }
        if let Some(last) = choice_point.last
            && let Some(option) = choice_point.options.get(last as usize)
            && is_open(option)
        {
            return Some(*option);
        }
        let mut open = choice_point.options.iter().copied().filter(is_open);
        match choice_point.kind {
            ChoicePointKind::Alternatives | ChoicePointKind::Carriers { .. } => open.next(),
            ChoicePointKind::Orders { .. } => {
                // That a pair touches comes last.
                let (orders, touches) = choice_point.options.split_at(2);
                let most = orders.iter().copied().filter(is_open).max_by_key(|&option| self.slack(option));
                most.or_else(|| touches.iter().copied().find(is_open))
            }
            ChoicePointKind::Sides | ChoicePointKind::Resolvers => {
                open.max_by_key(|&option| self.slack(option))
            }
        }
    }

    /// Returns how much room an order leaves.
    fn slack(&self, order: Literal) -> i64 {
        self.differences.slack(&self.trail, order)
    }
}
