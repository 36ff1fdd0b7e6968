//! Goals as sums that have to stay below a limit: as they are, and with what resources leave room for at all.

use std::collections::BTreeMap;

use exact::Rational;
use tpn::{Choice, DecisionId, LabelId};

use super::encode::Problem;
use super::growth::Unencoded;
use super::linear::{self, LinearKind};
use super::literal::{Literal, Variable};
use super::relaxation::{self, Relaxation, Row, SCALE};
use super::{ChoicePointKind, Solver};
use crate::choices::Choices;
use crate::demands::ModelGoal;
use crate::ids::LinearId;

/// The sums of a goal in the solver, each with how many of its units one of the goal's is.
#[derive(Clone, Debug, Default)]
pub(crate) struct GoalSums(Vec<(LinearId, i64)>);

/// A goal's sum is at least `Σ weight · value + constant`, in parts of the goal's unit.
pub(super) struct Sum {
    pub(super) terms: Vec<(i64, Variable)>,
    pub(super) constant: i64,
    parts: i64,
}

/// Weights while they are added up.
pub(super) type Weights = BTreeMap<Variable, i128>;

impl Problem<'_> {
    /// Adds that a goal's sum is at most a limit. What would reach it best if everything could be taken in parts is tried
    /// first where `is_sought`.
    pub(crate) fn add_goal(
        &self,
        solver: &mut Solver,
        goal: &ModelGoal,
        limit: i64,
        is_sought: bool,
    ) -> Result<GoalSums, Unencoded> {
        let relaxation = self.relaxation(solver, goal);
        if is_sought && !relaxation.rows.is_empty() {
            self.prefer_taken(solver, &relaxation);
        }
        let mut sums = GoalSums::default();
        for Sum { terms, constant, parts } in self.sums(solver, goal, &relaxation.rows)? {
            let most = i128::from(limit) * i128::from(parts) - i128::from(constant);
            let most = most.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64;
            sums.0.push((solver.linears.add(terms, most, LinearKind::Goal), parts));
        }
        Ok(sums)
    }

    /// Lowers a goal's limit. Everything is taken back.
    pub(crate) fn lower_goal(solver: &mut Solver, sums: &GoalSums, by: i64) {
        solver.retract(0);
        for &(sum, parts) in &sums.0 {
            solver.linears.lower(sum, by.saturating_mul(parts));
        }
    }

    /// Returns what a goal's sum is at least, by what holds whatever is decided.
    pub(crate) fn goal_bound(&self, solver: &Solver, goal: &ModelGoal) -> i64 {
        let relaxation = self.relaxation(solver, goal);
        let least = |Sum { terms, constant, parts }: Sum| {
            let sum: i128 = terms.into_iter().map(|term| linear::least(&solver.trail, term)).sum();
            let sum = sum + i128::from(constant);
            let whole = sum.div_euclid(i128::from(parts)) + i128::from(sum.rem_euclid(i128::from(parts)) > 0);
            i64::try_from(whole).unwrap_or(i64::MIN)
        };
        let sums = self.sums(solver, goal, &relaxation.rows).unwrap_or_default();
        sums.into_iter().map(least).max().unwrap_or(i64::MIN)
    }

    /// The same of all goals.
    pub(super) fn goal_bounds(&self, solver: &Solver) -> Vec<i64> {
        self.model.demands.goals.iter().map(|goal| self.goal_bound(solver, goal)).collect()
    }

    /// Sums as values of the goals.
    pub(super) fn goal_values(&self, sums: &[i64]) -> Vec<Rational> {
        self.model.demands.goals.iter().zip(sums).map(|(goal, &sum)| goal.value(sum)).collect()
    }

    /// Tries these choices first.
    pub(crate) fn prefer(&self, solver: &mut Solver, choices: &[Choice]) {
        for choice in choices {
            self.prefer_option(solver, choice.decision, choice.alternative as usize);
        }
    }

    /// Tries these links first.
    pub(crate) fn prefer_links(&self, solver: &mut Solver, choices: &Choices) {
        for (ask, options) in &self.carriers {
            let preferred = choices.carriers[*ask];
            let position = options.iter().position(|&(tell, _)| Some(tell) == preferred);
            if let (Some(position), Some(&(_, link))) = (position, options.first()) {
                for id in solver.choice_points_of.iter(link.side.variable()) {
                    let choice_point = &mut solver.choice_points[id];
                    if (choice_point.kind == ChoicePointKind::Carriers { ask: *ask }) {
                        choice_point.last = Some(position as u32);
                    }
                }
            }
        }
    }

    /// Tries first what is taken for the most part where everything can be taken in parts.
    fn prefer_taken(&self, solver: &mut Solver, relaxation: &Relaxation) {
        let part = |option: &Literal| relaxation.taken.get(&option.side.variable()).copied();
        for (decision, options) in self.alternatives.iter_enumerated() {
            let parts: Vec<Option<f64>> = options.iter().map(part).collect();
            let told = parts.iter().enumerate().filter_map(|(at, part)| Some((at, (*part)?)));
            let Some((most, part)) = told.max_by(|one, other| one.1.total_cmp(&other.1)) else { continue };
            let untold = parts.iter().position(Option::is_none).filter(|_| part < 0.5);
            self.prefer_option(solver, decision, untold.unwrap_or(most));
        }
    }

    pub(super) fn prefer_option(&self, solver: &mut Solver, decision: DecisionId, option: usize) {
        let Some(literal) = self.alternatives[decision].get(option) else { return };
        for id in solver.choice_points_of.iter(literal.side.variable()) {
            let choice_point = &mut solver.choice_points[id];
            if choice_point.kind == ChoicePointKind::Alternatives {
                choice_point.last = Some(option as u32);
            }
        }
    }

    fn relaxation(&self, solver: &Solver, goal: &ModelGoal) -> Relaxation {
        if self.shares.is_empty() && self.turns.is_empty() {
            return Relaxation::default();
        }
        let terms: Vec<(i64, Variable)> = self
            .weights(goal)
            .into_iter()
            .filter_map(|(variable, weight)| Some((i64::try_from(weight).ok()?, variable)))
            .collect();
        relaxation::relax(&solver.trail, &terms, &self.shares.tasks(), &self.turns)
    }

    /// The sums that a goal's is at least: its own, and with these rows at their prices.
    fn sums(&self, solver: &Solver, goal: &ModelGoal, rows: &[(i64, Row)]) -> Result<Vec<Sum>, Unencoded> {
        let own = self.weights(goal);
        let mut priced: Weights =
            own.iter().map(|(&variable, &weight)| (variable, weight * i128::from(SCALE))).collect();
        let mut constant = 0;
        for (price, row) in rows {
            constant -= i128::from(*price) * i128::from(row.most);
            for (&variable, &weight) in &row.terms {
                *priced.entry(variable).or_default() += i128::from(*price) * i128::from(weight);
            }
        }
        let mut sums = vec![self.charged(solver, own, 0, 1).ok_or(Unencoded::TimesTooLarge)?];
        if !rows.is_empty() {
            sums.extend(self.charged(solver, priced, constant, SCALE));
        }
        Ok(sums)
    }

    /// A sum in which the cheapest alternative of each decision costs nothing: what it costs is charged to what the
    /// decision is part of. `None` if it is too large.
    pub(super) fn charged(
        &self,
        solver: &Solver,
        mut weights: Weights,
        mut constant: i128,
        parts: i64,
    ) -> Option<Sum> {
        // Decisions come after those that they are part of.
        for (decision, options) in self.alternatives.iter_enumerated().rev() {
            let open = || {
                options
                    .iter()
                    .filter(|option| !solver.trail.fails(**option))
                    .map(|option| option.side.variable())
            };
            let weight = |variable: &Variable| weights.get(variable).copied().unwrap_or(0);
            let Some(least) = open().map(|variable| weight(&variable)).min().filter(|&least| least != 0)
            else {
                continue;
            };
            for variable in open() {
                *weights.entry(variable).or_default() -= least;
            }
            match self.model.decisions[decision].context {
                None => constant += least,
                Some(choice) => {
                    *weights.entry(self.presence(Some(choice)).side.variable()).or_default() += least;
                }
            }
        }
        let terms = weights.into_iter().filter(|&(_, weight)| weight != 0);
        let terms = terms.map(|(variable, weight)| Some((i64::try_from(weight).ok()?, variable)));
        Some(Sum { terms: terms.collect::<Option<_>>()?, constant: i64::try_from(constant).ok()?, parts })
    }

    /// The weighted variables that a goal's sum consists of.
    fn weights(&self, goal: &ModelGoal) -> Weights {
        let mut weights = Weights::new();
        for &(arc, weight) in &goal.by_arc {
            let presence = self.presence(self.model.arcs[arc].context);
            *weights.entry(presence.side.variable()).or_default() += i128::from(weight);
        }
        self.add_departing(goal, &mut weights);
        if goal.per_tick != 0 {
            *weights.entry(self.times[self.model.demands.end]).or_default() += i128::from(goal.per_tick);
        }
        weights
    }

    /// What movements add by where they start: each of them the least of all its starts, and the rest by its own.
    fn add_departing(&self, goal: &ModelGoal, weights: &mut Weights) {
        if goal.by_departure.is_empty() {
            return;
        }
        let labels = &self.model.conditions.labels;
        let mut by_movement: BTreeMap<LabelId, Vec<(Literal, i64)>> = BTreeMap::new();
        for (departing, last) in &self.sides.departures {
            let weight = labels[departing.before]
                .value
                .and_then(|from| goal.by_departure.get(&(departing.movement, from)))
                .copied()
                .unwrap_or(0);
            by_movement.entry(departing.movement).or_default().push((*last, weight));
        }
        for (movement, starts) in by_movement {
            let least = starts.iter().map(|&(_, weight)| weight).min().unwrap_or(0);
            let presence = self.intervals[movement].presence;
            *weights.entry(presence.side.variable()).or_default() += i128::from(least);
            for (last, weight) in starts {
                *weights.entry(last.side.variable()).or_default() += i128::from(weight - least);
            }
        }
    }
}
