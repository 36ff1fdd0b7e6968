//! The best plan as a best-first search finds it (SPEC 12): the first one that it finishes.

use tpn::Plan;

use super::{Attempt, Searching};
use crate::partial_order;
use crate::solver::{Frontier, LeastSums, Problem, Solver, Visit};
use crate::trace::Event;
use crate::unplannable::Unplannable;

impl Searching<'_> {
    /// The plan that a best-first search comes to first, which no other one is better than. `None` if too many states are open,
    /// or if the plan is not as good as its state promised.
    #[expect(clippy::option_option, reason = "no plan is not no answer")]
    pub(super) fn best_first(&mut self) -> Result<Option<Option<Plan>>, Unplannable> {
        let model = self.model;
        let goals = &model.demands.goals;
        let mut best: Option<(LeastSums, Plan)> = None;
        for &gaps in self.gaps() {
            let limits = vec![None; goals.len()];
            let attempt = self.recorded_problem(gaps, &limits, true)?;
            let Some(Attempt { mut problem, mut solver, .. }) = attempt else { break };
            let mut frontier = Frontier::new(goals.len());
            let than = best.as_ref().map(|(sums, _)| sums.clone());
            let (visit, found) = loop {
                let visit = self.visit_best(&mut problem, &mut solver, &mut frontier, than.as_ref());
                if visit != Visit::Solution {
                    break (visit, None);
                }
                let solution = problem.whole_solution(&solver);
                if let Some(plan) = partial_order::plan(self.network, model, &solution)? {
                    break (visit, Some(plan));
                }
                solver.record_failed(Event::NoRoomForGap);
                problem.forbid(&mut solver);
            };
            if let Some(plan) = found {
                solver.record_solution(|| Event::Keep {
                    orders: plan.orderings_added.clone(),
                    uses: plan.uses_ordered.clone(),
                });
                let sums = goals.iter().map(|goal| goal.sum(model, &plan)).collect::<Result<_, _>>()?;
                let is_promised = frontier.visited >= sums;
                best = Some((sums, plan));
                if !is_promised {
                    self.record = solver.record.take();
                    return Ok(None);
                }
            }
            if matches!(visit, Visit::Solution | Visit::NothingBetter) {
                solver.close(&frontier);
            }
            self.record = solver.record.take();
            match visit {
                Visit::Solution | Visit::NothingBetter => {}
                Visit::TooManyStates => return Ok(None),
                Visit::Stopped => {
                    let open = frontier.least().into_iter().flatten().zip(goals).enumerate();
                    let is_open =
                        |at: usize, least: i64| best.as_ref().is_none_or(|(sums, _)| sums[at] > least);
                    self.bound = open
                        .filter(|&(at, (&least, _))| is_open(at, least))
                        .map(|(_, (&least, goal))| goal.value(least))
                        .next();
                    break;
                }
            }
        }
        let Some((_, mut plan)) = best else { return Ok(Some(None)) };
        self.tell_values(&plan)?;
        let is_whole = goals.iter().all(|goal| goal.is_whole);
        plan.quality.is_optimal = Some(!self.is_stopped && is_whole);
        Ok(Some(Some(plan)))
    }

    fn visit_best(
        &mut self,
        problem: &mut Problem<'_>,
        solver: &mut Solver,
        frontier: &mut Frontier,
        than: Option<&LeastSums>,
    ) -> Visit {
        solver.stats = self.stats;
        let (termination, is_stopped) = (&mut self.termination, &mut self.is_stopped);
        let visit = solver.visit_best(problem, frontier, than, &mut |stats| {
            *is_stopped |= termination.should_stop(stats);
            *is_stopped
        });
        self.stats = solver.stats;
        visit
    }
}
