//! A planned mission executed in the simulated world, planning again with paths when the plan cannot be kept.

use std::sync::Arc;

use executive::{Disturbance, Facts, PlanError, Replanner, RunOutcome, World};
use kirk::Status;
use tpn::{Network, Plan};

use crate::ground::Grounds;
use crate::planning::{self, Planned, Problem};
use crate::traverse::Paths;

/// Executes the plan of `planned`, which `problem` gave; `None` if it has no plan.
pub fn execute(
    problem: &Problem<'_>,
    planned: &Planned,
    disturbances: &[Disturbance],
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Option<Result<RunOutcome, PlanError>> {
    let plan = planned.planning.outcome.plans.first()?.clone();
    let network = Arc::clone(&planned.network);
    let world = World::new(disturbances);
    let mut replanner = WithPaths { problem, grounds, paths };
    Some(executive::run(network, plan, problem.network.nodes.len(), &world, &mut replanner))
}

struct WithPaths<'run, 'input> {
    problem: &'run Problem<'input>,
    grounds: &'run mut Grounds,
    paths: &'run mut Paths,
}

impl Replanner for WithPaths<'_, '_> {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        let mut options = self.problem.options;
        (options.all, options.relax, options.trace_events) = (false, false, None);
        let problem = Problem { facts: Some(facts), options, ..*self.problem };
        let planned = planning::plan(&problem, self.grounds, self.paths, &mut || false);
        let outcome = &planned.planning.outcome;
        match outcome.plans.first() {
            Some(plan) => Ok((planned.network, plan.clone())),
            None if outcome.status == Status::Error => Err("a time does not fit into 64 bits".to_owned()),
            None => {
                let reasons = outcome.failure.iter().flat_map(|failure| &failure.reasons);
                let messages: Vec<&str> = reasons.map(|reason| reason.message.as_str()).take(3).collect();
                Err(format!("there is no plan from here: {}", messages.join("; ")))
            }
        }
    }
}
