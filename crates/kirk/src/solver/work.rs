//! How much work a mission has time for: what requires or changes one state takes turns, and so does what shares a
//! resource, so that no state and no resource does more than there is time for.
//!
//! Where each alternative of a choice gives work to one of many, all of them may have too little time although none of them
//! has: no search over single vehicles shows that in reasonable time (the pigeonhole principle).

use std::collections::BTreeMap;

use tpn::LabelId;

use super::Solver;
use super::encode::{Part, Problem};
use super::goals::{Sum, Weights};
use super::interval::Interval;
use super::linear::LinearKind;
use super::literal::Literal;
use super::relaxation::Row;
use crate::conditions::Conditions;
use crate::demands::ModelSupply;

/// Of more conditions on one state not all are compared with each other.
const MAX_LABELS: usize = 400;

/// Where fewer compete, they are soon tried one by one.
const MIN_INTERVALS: usize = 3;

/// What shares a state or a resource, and how much of it can be done at once.
struct Pool {
    capacity: i64,
    /// With what each takes of the capacity.
    works: Vec<(Interval, i64)>,
}

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
        let of_state = |turns: &Vec<Interval>| Pool {
            capacity: 1,
            works: turns.iter().map(|&interval| (interval, 1)).collect(),
        };
        let states: Vec<Pool> = self.turns.iter().map(of_state).collect();
        let resources = self.shares.tasks().into_iter().filter_map(|(supply, tasks)| {
            let ModelSupply::Reusable { capacity } = supply else { return None };
            let tasks = tasks.into_iter().filter(|task| task.is_active && task.interval.duration > 0);
            let works: Vec<(Interval, i64)> = tasks.map(|task| (task.interval, task.amount)).collect();
            (works.len() >= MIN_INTERVALS).then_some(Pool { capacity, works })
        });
        let resources: Vec<Pool> = resources.collect();
        for pools in [states, resources] {
            if pools.len() > 1 {
                self.limit_until_the_end(solver, &pools);
                self.limit_at_the_latest(solver, &pools);
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
    fn limit_until_the_end(&self, solver: &mut Solver, pools: &[Pool]) {
        let (start, end) = (self.times[self.model.start], self.times[self.model.demands.end]);
        let mut weights = Weights::new();
        let (mut done, mut capacity) = (0_i128, 0_i128);
        for pool in pools {
            capacity += i128::from(pool.capacity);
            for (interval, amount) in &pool.works {
                let work = i128::from(interval.duration) * i128::from(*amount);
                if solver.trail.holds(interval.presence) {
                    done += work;
                } else {
                    add(&mut weights, interval.presence, work);
                }
            }
        }
        let most = -done - capacity * i128::from(solver.trail.least(start));
        *weights.entry(end).or_default() -= capacity;
        self.limit(solver, weights, most);
    }

    /// The same at the latest end, where what each pool does is a multiple of what all its work has in common.
    fn limit_at_the_latest(&self, solver: &mut Solver, pools: &[Pool]) {
        let (start, end) = (self.times[self.model.start], self.times[self.model.demands.end]);
        let Some(time) = solver.trail.most(end).checked_sub(solver.trail.least(start)) else { return };
        let mut weights = Weights::new();
        let mut most = 0_i128;
        for pool in pools {
            let (mut terms, mut done) = (BTreeMap::new(), 0_i128);
            for (interval, amount) in &pool.works {
                let Some(work) = interval.duration.checked_mul(*amount) else { return };
                if solver.trail.holds(interval.presence) {
                    done += i128::from(work);
                } else {
                    let sum: &mut i64 = terms.entry(interval.presence.side.variable()).or_default();
                    let Some(added) = sum.checked_add(work) else { return };
                    *sum = added;
                }
            }
            let room = i128::from(pool.capacity) * i128::from(time) - done;
            let Ok(room) = i64::try_from(room) else { return };
            if room < 0 {
                return;
            }
            let row = Row { terms, most: room }.rounded();
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

    /// Whether two labels of one state are never at one time, whatever is planned (SPEC 10.2).
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

fn add(weights: &mut Weights, presence: Literal, work: i128) {
    *weights.entry(presence.side.variable()).or_default() += work;
}
