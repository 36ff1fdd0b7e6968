//! The best plan as a best-first search finds it (SPEC 12): the first one that it finishes.

use tpn::Plan;

use super::{Attempt, Searching};
use crate::partial_order;
use crate::solver::{Frontier, MinSums, Problem, Solver, Touching, Visit};
use crate::trace::Event;
use crate::unplannable::Unplannable;

impl Searching<'_> {
    /// The plan that a best-first search comes to first, which no other one is better than. `None` if too many states are open,
    /// or if the plan is not as good as its state promised.
    #[expect(clippy::option_option, reason = "no plan is not no answer")]
    pub(super) fn best_first(&mut self) -> Result<Option<Option<Plan>>, Unplannable> {
        let model = self.model;
        let goals = &model.demands.goals;
        let limits = vec![None; goals.len()];
        let attempt = self.recorded_problem(&limits, true, Touching::Where)?;
        let Some(Attempt { mut problem, mut solver, .. }) = attempt else { return Ok(Some(None)) };
        let mut frontier = Frontier::new(goals.len());
        let visit = self.visit_best(&mut problem, &mut solver, &mut frontier);
        let mut found = None;
        if visit == Visit::Solution {
            let solution = problem.complete_solution(&solver);
            found = partial_order::plan(self.network, model, &solution)?;
            debug_assert!(found.is_some(), "every solution is a plan");
        }
        let mut is_promised = visit != Visit::Solution;
        if let Some(plan) = &found {
            solver.record_solution(|| Event::Keep {
                orders: plan.orderings_added.clone(),
                uses: plan.uses_ordered.clone(),
            });
            let sums: MinSums =
                goals.iter().map(|goal| goal.sum(model, plan)).collect::<Result<_, Unplannable>>()?;
            is_promised = frontier.visited >= sums;
        }
        if is_promised && matches!(visit, Visit::Solution | Visit::NothingBetter) {
            solver.close(&frontier);
        }
        self.record = solver.record.take();
        if !is_promised || visit == Visit::TooManyStates {
            return Ok(None);
        }
        if visit == Visit::Stopped {
            let mut open = frontier.least().into_iter().flatten().zip(goals);
            self.bound = open.next().map(|(&least, goal)| goal.value(least));
        }
        let Some(mut plan) = found else { return Ok(Some(None)) };
        self.tell_values(&plan)?;
        let is_exact = goals.iter().all(|goal| goal.is_exact);
        plan.quality.is_optimal = Some(!self.is_stopped && is_exact);
        Ok(Some(Some(plan)))
    }

    fn visit_best(
        &mut self,
        problem: &mut Problem<'_>,
        solver: &mut Solver,
        frontier: &mut Frontier,
    ) -> Visit {
        solver.stats = self.stats;
        let (termination, is_stopped) = (&mut self.termination, &mut self.is_stopped);
        let visit = solver.visit_best(problem, frontier, &mut |stats| {
            *is_stopped |= termination.should_stop(stats);
            *is_stopped
        });
        self.stats = solver.stats;
        visit
    }
}
