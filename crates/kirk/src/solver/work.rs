//! How much work a mission has time for: what requires or changes one state takes turns, and so does what shares a
//! resource, so that no state and no resource does more than there is time for.
//!
//! Where each alternative of a choice gives work to one of many, all of them may have too little time although none of them
//! has: no search over single vehicles shows that in reasonable time (the pigeonhole principle).

use tpn::LabelId;

use super::Solver;
use super::encode::{Part, Problem};
use super::goals::{Sum, Weights};
use super::interval::Interval;
use super::linear::LinearKind;
use super::relaxation::Share;
use crate::conditions::Conditions;

/// Of more conditions on one state not all are compared with each other.
const MAX_LABELS: usize = 400;

/// Where fewer compete, they are soon tried one by one.
const MIN_INTERVALS: usize = 3;

impl Problem<'_> {
    /// Finds what takes turns because it requires or changes the same state, and limits the work of all states together, and
    /// of all resources together. That says nothing about which part of it is too much, so that explanations do without it.
    pub(super) fn limit_work(&mut self, solver: &mut Solver, part: Part<'_>) {
        if solver.takes_nothing_for_granted() || solver.is_contradictory {
            return;
        }
        let variables = self.model.demands.variables.iter().map(|variable| {
            let changes = variable.changes.iter().map(|&change| Holding::Change(change));
            let labels = changes.chain(variable.asks.iter().map(|&ask| Holding::Ask(ask)));
            let counts = |holding: &Holding| {
                let label = holding.label();
                part.active_labels.is_none_or(|active| active[label])
                    && self.intervals[label].duration > 0
                    && !solver.trail.fails(self.intervals[label].presence)
            };
            self.taking_turns(labels.filter(counts).take(MAX_LABELS))
        });
        self.turns = variables.filter(|turns| turns.len() >= MIN_INTERVALS).collect();
        let trail = &solver.trail;
        let states: Vec<Share> = self.turns.iter().map(|turns| Share::taking_turns(trail, turns)).collect();
        let resources = self.shares.tasks().into_iter();
        let resources: Vec<Share> = resources
            .filter_map(|(supply, tasks)| Share::new(trail, supply, &tasks))
            .filter(|share| share.works.len() >= MIN_INTERVALS)
            .collect();
        for shares in [states, resources] {
            if shares.len() > 1 {
                self.limit_until_the_end(solver, &shares);
                self.limit_at_the_latest(solver, &shares);
            }
        }
    }

    /// Some of the labels of one state, of which no two can be at one time.
    fn taking_turns(&self, labels: impl Iterator<Item = Holding>) -> Vec<Interval> {
        let conditions = &self.model.conditions;
        let mut turns: Vec<Holding> = Vec::new();
        for label in labels {
            if turns.iter().all(|&other| other.takes_turns_with(label, conditions)) {
                turns.push(label);
            }
        }
        turns.into_iter().map(|holding| self.intervals[holding.label()]).collect()
    }

    /// All work is done before the mission ends.
    fn limit_until_the_end(&self, solver: &mut Solver, shares: &[Share]) {
        let (start, end) = (self.times[self.model.start], self.times[self.model.demands.end]);
        let mut weights = Weights::new();
        let (mut done, mut capacity) = (0_i128, 0_i128);
        for share in shares {
            capacity += i128::from(share.capacity);
            for work in &share.works {
                let amount = i128::from(work.duration) * i128::from(work.amount);
                match work.variable {
                    Some(variable) => *weights.entry(variable).or_default() += amount,
                    None => done += amount,
                }
            }
        }
        let most = -done - capacity * i128::from(solver.trail.least(start));
        *weights.entry(end).or_default() -= capacity;
        self.limit(solver, weights, most);
    }

    /// The same at the latest end, where what each does is a multiple of what all its work has in common.
    fn limit_at_the_latest(&self, solver: &mut Solver, shares: &[Share]) {
        let (start, end) = (self.times[self.model.start], self.times[self.model.demands.end]);
        let (from, to) = (solver.trail.least(start), solver.trail.most(end));
        if from >= to {
            return;
        }
        let mut weights = Weights::new();
        let mut most = 0_i128;
        for share in shares {
            let Some(row) = share.row(from, to) else { return };
            most += i128::from(row.most);
            for (variable, weight) in row.terms {
                *weights.entry(variable).or_default() += i128::from(weight);
            }
        }
        self.limit(solver, weights, most);
    }

    /// Tells that a sum is at most this, with what each choice adds at least charged to all.
    pub(super) fn limit(&self, solver: &mut Solver, weights: Weights, most: i128) {
        let Some(Sum { terms, constant, .. }) = self.charged(solver, weights, 0, 1) else { return };
        let Ok(most) = i64::try_from(most - i128::from(constant)) else { return };
        if !terms.is_empty() {
            solver.linears.add(terms, most, LinearKind::Amounts);
        } else if most < 0 {
            solver.at_least_one([]);
        }
    }
}

/// A label of a state.
#[derive(Clone, Copy)]
enum Holding {
    Change(LabelId),
    Ask(LabelId),
}

impl Holding {
    const fn label(self) -> LabelId {
        match self {
            Self::Change(label) | Self::Ask(label) => label,
        }
    }

    /// Returns whether two labels of one state are never at one time, whatever is planned (SPEC 10.2).
    fn takes_turns_with(self, other: Self, conditions: &Conditions) -> bool {
        match (self, other) {
            (Self::Change(left), Self::Change(right)) => conditions.exclude(left, right),
            (Self::Change(change), Self::Ask(ask)) | (Self::Ask(ask), Self::Change(change)) => {
                conditions.breaks(change, ask)
            }
            (Self::Ask(left), Self::Ask(right)) => conditions.contradict(left, right),
        }
    }
}
