//! Plans of missions with variables that keep their values, resources, objectives, durations that nature chooses or
//! bounds between threads (SPEC 10 to 14): the solver finds them, and each becomes a plan that holds in every schedule.
//!
//! Without an objective the plan is the first one in textual order, where a search in that order comes to an end soon: its
//! choice points are decided in the order of the text, each with its first option that is left, so that the first
//! solution is the first in that order. With an objective better and better plans are looked for, goal by goal.

mod best_first;

use std::collections::BTreeSet;

use exact::Rational;
use tpn::exchange::Exchanges;
use tpn::{Choice, DecisionId, DistinctPlans, LabelId, Network, Plan, StateOrder};
use typed_index_collections::TiVec;

use crate::choices::Choices;
use crate::demands::{LastingVariable, ModelGoal, lasting_variables};
use crate::model::Model;
use crate::options::{Options, Outcome, Search, Stats, Status, Termination};
use crate::partial_order;
use crate::solver::{Answer, GoalSums, Growth, Part, Problem, Record, Solver, Touching, Unencoded};
use crate::structure::Relation;
use crate::trace::{Event, SearchRound};
use crate::unplannable::Unplannable;

/// How many conflicts a search in textual order may meet before one that follows its conflicts takes over.
const MAX_CONFLICTS_IN_ORDER: u64 = 200;

/// How many conflicts a search for a better plan may meet at first before one near the last plan takes over: each next time
/// more.
const CONFLICTS_EVERYWHERE: u64 = 50;

/// How many the search near the last plan may meet.
const CONFLICTS_NEAR: u64 = 100;

/// How many conflicts it may take to find out that choices that were a plan still are.
const MAX_CONFLICTS_TO_KEEP: u64 = 500;

/// How many conflicts it may take to find a plan that differs from another one in exchanged vehicles.
const MAX_CONFLICTS_TO_EXCHANGE: u64 = 2_000;

/// Returns whether the network has anything that only the solver plans. Quadratic in the changes of a variable.
pub(crate) fn has_demands(model: &Model) -> bool {
    model.has_uncertainty || has_executives_demands(model)
}

fn has_executives_demands(model: &Model) -> bool {
    let demands = &model.demands;
    let is_open =
        |variable: &LastingVariable| !variable.asks.is_empty() || !are_nested(model, &variable.changes);
    !model.constraints.is_empty()
        || !demands.resources.is_empty()
        || !demands.goals.is_empty()
        || demands.variables.iter().any(is_open)
}

/// Returns whether the order in which some variable that keeps its value changes is left to planning (SPEC 10.2).
pub fn has_open_order(network: &Network) -> bool {
    // Most missions change each variable once, which needs no closer look.
    let has_several = lasting_variables(network).iter().any(|variable| variable.changes.len() > 1);
    has_several
        && Model::new(network, None).is_ok_and(|model| {
            model.demands.variables.iter().any(|variable| !are_nested(&model, &variable.changes))
        })
}

/// Returns whether the program's structure orders all changes of a variable that exclude each other.
fn are_nested(model: &Model, changes: &[LabelId]) -> bool {
    changes.iter().enumerate().all(|(position, &left)| {
        changes[position + 1..].iter().all(|&right| {
            !model.conditions.exclude(left, right)
                || !model.can_be_together(left, right)
                || model.nested_order(left, right) != Relation::Open
        })
    })
}

/// The order of the selected changes, of a network whose structure orders them.
pub(crate) fn nested_changes(model: &Model, selected_arcs: &[bool]) -> Vec<StateOrder> {
    let is_selected = |label: &LabelId| selected_arcs[model.conditions.labels[*label].arc.index()];
    let is_before = |first: LabelId, then: LabelId| model.nested_order(first, then) == Relation::Before;
    let of_variable = model.demands.variables.iter().filter_map(|variable| {
        let changes: Vec<LabelId> = variable.changes.iter().copied().filter(is_selected).collect();
        variable.in_order(&model.conditions, &changes, is_before)
    });
    of_variable.collect()
}

/// The plan that makes the same choices as another one, if there is one.
pub(crate) fn keep(
    network: &Network,
    model: &Model,
    choices: &Choices,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, Unplannable> {
    if !model.has_contexts {
        return Ok(None);
    }
    let part = Part { alternatives: Some(&choices.alternatives), ..Part::default() };
    let stats = Stats {
        nodes: model.num_nodes as u64,
        arcs: model.arcs.len() as u64,
        decisions: model.decisions.len() as u64,
        ..Stats::default()
    };
    let Ok((mut problem, mut solver)) = Problem::new(model, part, &mut || termination.should_stop(&stats))
    else {
        return Ok(None);
    };
    solver.stats = stats;
    problem.prefer_links(&mut solver, choices);
    problem.preferred_times.clone_from(&choices.times);
    let mut enough =
        |stats: &Stats| termination.should_stop(stats) || stats.conflicts > MAX_CONFLICTS_TO_KEEP;
    if solver.solve(&mut problem, &mut enough) != Answer::Solved {
        return Ok(None);
    }
    let plan = partial_order::plan(network, model, &problem.complete_solution(&solver))?;
    Ok(plan.map(|plan| Outcome {
        status: Status::Plan,
        plans: vec![plan],
        bound: None,
        failure: None,
        stats: solver.stats,
        trace: None,
        unplannable: None,
    }))
}

/// Plans; why there is no plan is explained elsewhere.
pub(crate) fn search(
    network: &Network,
    model: &Model,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Result<Outcome, Unplannable> {
    let has_goals = !model.demands.goals.is_empty();
    let mut searching = Searching {
        network,
        model,
        termination,
        stats: Stats::default(),
        is_stopped: false,
        bound: None,
        floor: None,
        excluded: excluded.to_vec(),
        incumbent: None,
        record: options.trace_events.map(|limit| Box::new(Record::new(limit, has_goals))),
        // Without an objective no state is better than another.
        is_best_first: has_goals && options.search == Search::BestFirst,
        is_listing: options.all || options.best > 1 || !excluded.is_empty(),
    };
    searching.stats.nodes = model.num_nodes as u64;
    searching.stats.arcs = model.arcs.len() as u64;
    searching.stats.decisions = model.decisions.len() as u64;
    if !model.has_contexts {
        return Err(Unplannable::Entangled);
    }
    let (status, plans) =
        if options.all { searching.all(options.max_plans)? } else { searching.several(options.best)? };
    let Searching { stats, bound, mut record, .. } = searching;
    if let Some(record) = record.as_mut().filter(|_| plans.is_empty()) {
        record.fail();
    }
    let trace = record.map(|record| record.into_trace());
    Ok(Outcome { status, plans, bound, failure: None, stats, trace, unplannable: None })
}

struct Searching<'a> {
    network: &'a Network,
    model: &'a Model,
    termination: &'a mut dyn Termination,
    stats: Stats,
    is_stopped: bool,
    /// What no plan is better than, of the first goal that is not at its optimum yet.
    bound: Option<Rational>,
    /// The least value of that goal that propagation leaves possible, once it has been looked for.
    floor: Option<i64>,
    /// The choices of plans that are not looked for: of those that have been found, where others are.
    excluded: Vec<Vec<Choice>>,
    /// The choices of the best plan so far, where a better one is looked for.
    incumbent: Option<Vec<Choice>>,
    /// What is told of all searches; the solver has it while it searches.
    record: Option<Box<Record>>,
    is_best_first: bool,
    /// Whether several plans are looked for.
    is_listing: bool,
}

/// What came of looking for the next plan of a problem.
enum Next {
    Plan(Box<Plan>),
    Nothing,
    Stopped,
}

/// What a limit on each goal is.
type Limits = Vec<Option<i64>>;

impl<'a> Searching<'a> {
    const fn status(&self, has_plan: bool) -> Status {
        match (has_plan, self.is_stopped) {
            (true, _) => Status::Plan,
            (false, true) => Status::Limit,
            (false, false) => Status::NoPlan,
        }
    }

    /// A problem and its solver, which continues with the record. `None` if it was stopped meanwhile.
    fn recorded_problem(
        &mut self,
        limits: &Limits,
        is_in_order: bool,
        touching: Touching,
    ) -> Result<Option<Attempt<'a>>, Unplannable> {
        let (termination, stats) = (&mut self.termination, &self.stats);
        let part = Part { touching, lists_all: self.is_listing, ..Part::default() };
        let attempt = Problem::new(self.model, part, &mut || termination.should_stop(stats))
            .and_then(|encoded| self.attempt(encoded, limits, is_in_order));
        match attempt {
            Ok(mut attempt) => {
                self.begin_record(&mut attempt, limits);
                Ok(Some(attempt))
            }
            Err(Unencoded::Stopped) => {
                self.is_stopped = true;
                Ok(None)
            }
            Err(Unencoded::TimesTooLarge) => Err(Unplannable::at(self.model.start)),
            Err(Unencoded::TooManyLinks) => Err(Unplannable::Links),
        }
    }

    /// Continues with the record in a solver that begins to search within these limits.
    fn begin_record(&mut self, attempt: &mut Attempt<'_>, limits: &Limits) {
        let Some(record) = self.record.take() else { return };
        let goals = self.model.demands.goals.iter().zip(limits);
        let values = goals.map_while(|(goal, limit)| limit.map(|limit| (goal, limit)));
        let mut values: Vec<(&ModelGoal, i64)> = values.collect();
        // The last of them is to be better than this.
        if let Some((_, limit)) = values.last_mut() {
            *limit += 1;
        }
        let round = SearchRound {
            is_in_textual_order: attempt.solver.is_in_textual_order,
            is_best_first: self.is_best_first,
            bound: values
                .last()
                .map(|(goal, _)| goal.value(attempt.problem.goal_bound(&attempt.solver, goal))),
            values: values.into_iter().map(|(goal, value)| goal.value(value)).collect(),
        };
        attempt.solver.begin_record(&attempt.problem, Some(record), round);
    }

    /// A problem that is new to its solver, with what this search asks for beside the network.
    fn attempt<'part>(
        &self,
        (problem, mut solver): (Problem<'part>, Solver),
        limits: &Limits,
        is_in_order: bool,
    ) -> Result<Attempt<'part>, Unencoded> {
        solver.is_in_textual_order = is_in_order;
        for choices in &self.excluded {
            problem.forbid_choices(&mut solver, choices);
        }
        let mut attempt = Attempt { problem, solver, sums: GoalSums::default() };
        self.add_limits(&mut attempt, limits)?;
        Ok(attempt)
    }

    /// Adds a limit on each goal that has one, and prefers the best plan's choices.
    fn add_limits(&self, attempt: &mut Attempt<'_>, limits: &Limits) -> Result<(), Unencoded> {
        let Attempt { problem, solver, sums } = attempt;
        if let Some(incumbent) = &self.incumbent {
            problem.prefer(solver, incumbent);
        }
        let sought = limits.iter().rposition(Option::is_some);
        for (at, (goal, limit)) in self.model.demands.goals.iter().zip(limits).enumerate() {
            if let Some(limit) = *limit {
                *sums = problem.add_goal(solver, goal, limit, sought == Some(at))?;
            }
        }
        Ok(())
    }

    /// Solves, with at most so many conflicts where a number is given. `None` if these are spent, or the search was stopped.
    fn solve(&mut self, problem: &mut Problem<'_>, solver: &mut Solver, most: Option<u64>) -> Option<bool> {
        let before = self.stats.conflicts;
        solver.stats = self.stats;
        let (termination, is_stopped) = (&mut self.termination, &mut self.is_stopped);
        let answer = solver.solve(problem, &mut |stats| {
            *is_stopped |= termination.should_stop(stats);
            *is_stopped || most.is_some_and(|most| stats.conflicts > before + most)
        });
        self.stats = solver.stats;
        match answer {
            Answer::Solved => Some(true),
            Answer::Unsolvable => Some(false),
            Answer::Stopped => None,
        }
    }

    /// The next plan of a problem whose solutions are all looked at in turn, as long as they become plans within `limits`.
    fn next_plan(
        &mut self,
        (problem, solver): (&mut Problem<'_>, &mut Solver),
        limits: &Limits,
        most: Option<u64>,
    ) -> Result<Next, Unplannable> {
        let model = self.model;
        loop {
            match self.solve(problem, solver, most) {
                None => return Ok(Next::Stopped),
                Some(false) => return Ok(Next::Nothing),
                Some(true) => {}
            }
            let solution = problem.complete_solution(solver);
            if let Some(plan) = partial_order::plan(self.network, model, &solution)? {
                debug_assert!(self.is_within(&plan, limits)?, "a plan is as good as its solution");
                solver.record_solution(|| Event::Keep {
                    orders: plan.orderings_added.clone(),
                    uses: plan.uses_ordered.clone(),
                });
                return Ok(Next::Plan(Box::new(plan)));
            }
            debug_assert!(false, "every solution is a plan");
            problem.forbid(solver);
            solver.record_restart(problem);
        }
    }

    /// Returns whether a plan keeps the limits. One in which intervals need not touch may not, though its solution
    /// does.
    fn is_within(&self, plan: &Plan, limits: &Limits) -> Result<bool, Unplannable> {
        for (goal, limit) in self.model.demands.goals.iter().zip(limits) {
            if let Some(limit) = *limit
                && goal.sum(self.model, plan)? > limit
            {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// So many plans that differ in their choices, the best first.
    fn several(&mut self, count: usize) -> Result<(Status, Vec<Plan>), Unplannable> {
        let mut plans: Vec<Plan> = Vec::new();
        let exchanges = Exchanges::new(self.network);
        let mut found = BTreeSet::new();
        while plans.len() < count.max(1) && !self.is_stopped {
            let plan = if self.model.demands.goals.is_empty() { self.first()? } else { self.best()? };
            let Some(plan) = plan else { break };
            let choices = exchanges.least(&plan).choices;
            let plan = if found.contains(&choices) {
                self.excluded.push(plan.choices);
                continue;
            } else if plan.choices == choices {
                plan
            } else {
                self.excluded.push(plan.choices.clone());
                self.exchanged(plan, &choices)?
            };
            found.insert(choices);
            if let Some(record) = &mut self.record {
                record.tell_plan(plans.len() as u32);
            }
            self.excluded.push(plan.choices.clone());
            let is_last = plan.choices.is_empty();
            plans.push(plan);
            if is_last {
                break;
            }
        }
        Ok((self.status(!plans.is_empty()), plans))
    }

    fn first(&mut self) -> Result<Option<Plan>, Unplannable> {
        let limits = Vec::new();
        let attempt = self.recorded_problem(&limits, true, Touching::Unneeded)?;
        let Some(mut attempt) = attempt else { return Ok(None) };
        for most in [Some(MAX_CONFLICTS_IN_ORDER), None] {
            let next = self.next_plan((&mut attempt.problem, &mut attempt.solver), &limits, most)?;
            self.record = attempt.solver.record.take();
            match next {
                Next::Plan(plan) => return Ok(Some(*plan)),
                Next::Nothing => return Ok(None),
                Next::Stopped if self.is_stopped => return Ok(None),
                Next::Stopped => {
                    attempt.solver.is_in_textual_order = false;
                    attempt.problem.prefer_short(&mut attempt.solver);
                    self.begin_record(&mut attempt, &limits);
                }
            }
        }
        Ok(None)
    }

    /// Returns a plan with these choices that is no worse than `plan`. They differ from those of `plan` in which of several
    /// interchangeable vehicles does what. Returns `plan` if there is none, for example because some spots are farther away.
    fn exchanged(&mut self, plan: Plan, choices: &[Choice]) -> Result<Plan, Unplannable> {
        let model = self.model;
        let values = model.demands.goals.iter().map(|goal| goal.sum(model, &plan).map(Some));
        let limits: Limits = values.collect::<Result<_, Unplannable>>()?;
        let mut given: TiVec<DecisionId, Option<u32>> = vec![None; model.decisions.len()].into();
        for choice in choices {
            given[choice.decision] = Some(choice.alternative);
        }
        self.incumbent = None;
        let part = Part { alternatives: Some(&given), ..Part::default() };
        let (termination, stats) = (&mut self.termination, &self.stats);
        let encoded = Problem::new(model, part, &mut || termination.should_stop(stats));
        let Ok(mut attempt) = encoded.and_then(|encoded| self.attempt(encoded, &limits, false)) else {
            return Ok(plan);
        };
        self.begin_record(&mut attempt, &limits);
        let search = (&mut attempt.problem, &mut attempt.solver);
        let next = self.next_plan(search, &limits, Some(MAX_CONFLICTS_TO_EXCHANGE))?;
        self.record = attempt.solver.record.take();
        let Next::Plan(mut exchanged) = next else { return Ok(plan) };
        exchanged.quality.is_optimal = plan.quality.is_optimal;
        Ok(*exchanged)
    }

    /// Every plan that differs in its choices, its links, or the order of what excludes each other.
    fn all(&mut self, most: usize) -> Result<(Status, Vec<Plan>), Unplannable> {
        let attempt = self.recorded_problem(&Vec::new(), true, Touching::Where)?;
        let Some(Attempt { mut problem, mut solver, .. }) = attempt else {
            return Ok((Status::Limit, Vec::new()));
        };
        let (termination, stats) = (&mut *self.termination, self.stats);
        let mut stop = || termination.should_stop(&stats);
        match problem.order_all_pairs(&mut solver, &mut Growth::new(&mut stop)) {
            Ok(()) => {}
            Err(Unencoded::Stopped) => {
                self.record = solver.record.take();
                return Ok((Status::Limit, Vec::new()));
            }
            Err(_) => return Err(Unplannable::Links),
        }
        solver.record_choice_points(&problem);
        let mut plans = DistinctPlans::new(self.network);
        let is_complete = loop {
            let plan = match self.next_plan((&mut problem, &mut solver), &Vec::new(), None)? {
                Next::Stopped => break false,
                Next::Nothing => break true,
                Next::Plan(plan) => plan,
            };
            let count = plans.plans().len();
            if plans.insert(*plan) {
                if let Some(record) = &mut solver.record {
                    record.tell_plan(count as u32);
                }
                if count + 1 >= most {
                    break false;
                }
            }
            problem.forbid(&mut solver);
            solver.record_restart(&problem);
        };
        self.record = solver.record.take();
        let plans = plans.into_plans();
        let status = match (is_complete, plans.is_empty()) {
            (false, _) => Status::Limit,
            (true, true) => Status::NoPlan,
            (true, false) => Status::Plan,
        };
        Ok((status, plans))
    }

    /// A plan that no other one is better than, goal by goal; the best one found where the search is stopped before.
    fn best(&mut self) -> Result<Option<Plan>, Unplannable> {
        if self.is_best_first {
            if let Some(plan) = self.best_first()? {
                return Ok(plan);
            }
            // Better and better plans need not keep what is open.
            self.is_best_first = false;
        }
        let model = self.model;
        let mut limits: Limits = vec![None; model.demands.goals.len()];
        (self.incumbent, self.floor) = (None, None);
        // Better plans are looked for where the first one was found.
        let mut improving = None;
        let Some(mut plan) = self.better(&mut improving, &limits)? else {
            return Ok(None);
        };
        self.tell_values(&plan)?;
        for goal in 0..model.demands.goals.len() {
            if goal > 0 {
                (improving, self.floor) = (None, None);
            }
            loop {
                let value = model.demands.goals[goal].sum(model, &plan)?;
                limits[goal] = Some(value - 1);
                self.incumbent = Some(plan.choices.clone());
                let Some(better) = self.better(&mut improving, &limits)? else {
                    limits[goal] = Some(value);
                    break;
                };
                plan = better;
                self.tell_values(&plan)?;
            }
            if self.is_stopped {
                limits[goal] = None;
                self.bound = self.proven_bound(goal, &limits);
                break;
            }
        }
        let is_exact = model.demands.goals.iter().all(|goal| goal.is_exact);
        plan.quality.is_optimal = Some(!self.is_stopped && is_exact);
        Ok(Some(plan))
    }

    /// Tells what a plan is worth that is better than those before.
    fn tell_values(&mut self, plan: &Plan) -> Result<(), Unplannable> {
        let Some(record) = &mut self.record else { return Ok(()) };
        let goals = self.model.demands.goals.iter();
        let values = goals.map(|goal| Ok(goal.value(goal.sum(self.model, plan)?)));
        record.tell_improvement(values.collect::<Result<_, Unplannable>>()?);
        Ok(())
    }

    /// Returns what follows for a goal from the limits of those before it, whatever is decided.
    fn proven_bound(&self, goal: usize, limits: &Limits) -> Option<Rational> {
        let part = Part { touching: Touching::Where, ..Part::default() };
        let encoded = Problem::new(self.model, part, &mut || false).ok()?;
        let Attempt { problem, solver, .. } = self.attempt(encoded, limits, false).ok()?;
        let goal = &self.model.demands.goals[goal];
        let bound = problem.goal_bound(&solver, goal);
        Some(goal.value(self.floor.map_or(bound, |floor| floor.max(bound))))
    }

    /// The least value of the last goal with a limit that propagation alone does not refute, by halves (destructive bounds: Klein
    /// and Scholl 1999).
    fn refuted_limit(&mut self, attempt: &mut Attempt<'_>, limits: &Limits) -> i64 {
        let mut goals = self.model.demands.goals.iter().zip(limits).rev();
        let Some((goal, limit)) = goals.find_map(|(goal, limit)| Some((goal, (*limit)?))) else {
            return i64::MIN;
        };
        // None of this is recorded.
        let record = attempt.solver.record.take();
        let mut least = attempt.problem.goal_bound(&attempt.solver, goal);
        let mut most = limit + 1;
        while i64::MIN < least && least < most && !self.is_stopped {
            let middle = (i128::from(least) + i128::from(most)).div_euclid(2);
            let middle = i64::try_from(middle).unwrap_or(least);
            let mut solver = attempt.solver.clone();
            Problem::lower_goal(&mut solver, &attempt.sums, limit.saturating_sub(middle));
            let (termination, stats, is_stopped) = (&mut self.termination, &self.stats, &mut self.is_stopped);
            match solver.is_refuted_at_root(&mut || {
                *is_stopped |= termination.should_stop(stats);
                *is_stopped
            }) {
                Some(true) => least = middle + 1,
                Some(false) => most = middle,
                None => {}
            }
        }
        attempt.solver.record = record;
        least
    }

    /// A plan within the limits, the same one each time. The last of them is no greater than in the attempts before, with
    /// whose solver the search continues.
    fn better(
        &mut self,
        improving: &mut Improving<'a>,
        limits: &Limits,
    ) -> Result<Option<Plan>, Unplannable> {
        let limit = limits.iter().rev().find_map(|limit| *limit);
        let mut attempt = match improving.take() {
            Some((mut attempt, last_limit)) => {
                match (last_limit, limit) {
                    (Some(last), Some(limit)) => {
                        Problem::lower_goal(&mut attempt.solver, &attempt.sums, last - limit);
                    }
                    _ => self
                        .add_limits(&mut attempt, limits)
                        .map_err(|_| Unplannable::at(self.model.start))?,
                }
                self.begin_record(&mut attempt, limits);
                attempt
            }
            None => match self.recorded_problem(limits, false, Touching::Unneeded)? {
                Some(attempt) => attempt,
                None => return Ok(None),
            },
        };
        let is_first = self.incumbent.is_none();
        if is_first {
            attempt.problem.prefer_spread(&mut attempt.solver);
        }
        if is_first && self.model.demands.goals.first().is_some_and(|goal| goal.per_tick > 0) {
            attempt.problem.begin_dispatch(&mut attempt.solver);
        }
        let mut everywhere = CONFLICTS_EVERYWHERE;
        let mut is_near = false;
        let next = loop {
            let most = (!is_first).then_some(if is_near { CONFLICTS_NEAR } else { everywhere });
            let next = self.next_plan((&mut attempt.problem, &mut attempt.solver), limits, most)?;
            if !matches!(next, Next::Stopped) || self.is_stopped {
                break next;
            }
            is_near = !is_near;
            if self.floor.is_none() {
                self.floor = Some(self.refuted_limit(&mut attempt, limits));
            }
            if is_near {
                attempt.solver.search_near();
            } else {
                attempt.solver.search_everywhere();
                everywhere += everywhere / 8;
            }
        };
        self.record = attempt.solver.record.take();
        Ok(match next {
            Next::Plan(found) => {
                attempt.solver.note_solution();
                attempt.solver.search_everywhere();
                *improving = Some((attempt, limit));
                Some(*found)
            }
            Next::Nothing | Next::Stopped => None,
        })
    }
}

/// A problem that is being solved.
struct Attempt<'m> {
    problem: Problem<'m>,
    solver: Solver,
    /// Of the last goal that has a limit.
    sums: GoalSums,
}

/// The last attempt to reach less and less of one goal, with its limit.
type Improving<'m> = Option<(Attempt<'m>, Option<i64>)>;

#[cfg(test)]
mod tests {
    use tpn::{Top, compile};

    use crate::{Options, Unlimited};

    /// Returns whether the plan of a mission with this objective is called optimal.
    fn is_optimal(objective: &str) -> Option<bool> {
        let text = format!(
            "primitive Drive()[3,5] costs 2 per metre costs 1 rewards 4; primitive Wait()[2,4] costs 1;
             {objective} scenario S[0,20] = {{ choose {{ Drive(), Wait() }} }}"
        );
        let (network, diagnostics) = compile(&rmpl::parse(&text).program(), &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
        crate::plan(&network, &Options::default(), &mut Unlimited).plans[0].quality.is_optimal
    }

    #[test]
    fn only_what_was_searched_for_is_called_optimal() {
        assert_eq!(is_optimal(""), None);
        assert_eq!(is_optimal("objective minimize end, maximize reward;"), Some(true));
        // Meters are only known of planned paths, and no path is looked for because it is shorter.
        for objective in ["minimize length", "minimize cost", "maximize reward, minimize end + length"] {
            assert_eq!(is_optimal(&format!("objective {objective};")), Some(false), "{objective}");
        }
    }

    /// Better schedules in which intervals touch are not plans where nothing forces them to: that ends, too.
    #[test]
    fn what_would_be_sooner_only_by_touching_is_not_looked_for_for_ever() {
        let text = "objective minimize end;
             scenario S[0,30] = { { delay; ARM=a [4,4] }, { delay; ARM=b [3,3] }, { delay; ARM=c [9,9] } }";
        let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
        let network = network.unwrap_or_else(|| panic!("{diagnostics:?}"));
        let plan = &crate::plan(&network, &Options::default(), &mut Unlimited).plans[0];
        let end = plan.windows[network.end.index()].map(|window| window.earliest);
        assert_eq!((end, plan.quality.is_optimal), (Some(exact::Time::from(18)), Some(true)));
    }
}
