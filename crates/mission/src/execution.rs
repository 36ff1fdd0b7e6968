//! A planned mission executed in the simulated world, planning again with paths when the plan cannot be kept.
//!
//! A run follows from its mission, seed and disturbances alone. So whoever watches one with the clock in hand need not
//! run it step by step: a disturbance at the present moment changes nothing before it, and the run is worked out anew.

use std::sync::Arc;

use executive::{
    Disturbance, Ending, Entry, Facts, PlanError, Replanner, RunOutcome, Script, Stage, World, run_stage,
};
use kirk::Status;
use rmpl::program::Program;
use rmpl::{Bound, Rational};
use serde::{Deserialize, Serialize};
use tpn::{Network, Plan, Window};

use crate::ground::Grounds;
use crate::planning::{self, Planned, Problem};
use crate::snapshot::{Traverse, VehicleMotion};
use crate::traverse::Paths;

/// A run of a mission.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Execution {
    /// The revision of the text that was executed.
    pub revision: u64,
    /// What went otherwise than planned.
    #[serde(with = "crate::json_text")]
    pub script: Script,
    /// What happened, in order.
    #[serde(with = "crate::json_text")]
    pub log: Vec<Entry>,
    /// How it ended.
    pub ending: Ending,
    /// The plans that were executed, one after the other; there is at least one.
    pub plans: Vec<Executed>,
}

/// A plan that was executed until the run ended or planned again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Executed {
    /// When it was made.
    pub from: Rational,
    /// Its network, with its paths; what was known by then of durations is in it, what had happened is in `times`.
    pub network: Arc<Network>,
    /// The plan.
    pub plan: Plan,
    /// When each node happened, up to the end of the run.
    pub times: Vec<Option<Rational>>,
    /// Its traverses.
    pub traverses: Vec<Traverse>,
    /// Where the vehicles are over time: as it happened, and as planned for what did not happen.
    pub motions: Vec<VehicleMotion>,
}

/// A run with what replanning found.
pub struct Ran {
    /// How it went.
    pub outcome: RunOutcome,
    /// What each replan gave, in order.
    pub replanned: Vec<Planned>,
}

/// Executes the plan of `planned`, which `problem` gave; `None` if it has no plan.
pub fn execute(
    problem: &Problem<'_>,
    planned: &Planned,
    disturbances: &[Disturbance],
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Option<Result<Ran, PlanError>> {
    let plan = planned.planning.outcome.plans.first()?.clone();
    let world = World::new(disturbances);
    let stage = Stage::new(Arc::clone(&planned.network), plan, &world.times(&planned.network));
    Some(stage.and_then(|stage| execute_stage(problem, stage, &world, grounds, paths)))
}

/// Executes a plan of `problem` that was made ready for `world`.
pub fn execute_stage(
    problem: &Problem<'_>,
    stage: Stage,
    world: &World,
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Result<Ran, PlanError> {
    let mut replanner = WithPaths { problem, grounds, paths, replanned: Vec::new() };
    let num_program_nodes = problem.network.nodes.len();
    let outcome = run_stage(stage, num_program_nodes, world, &mut executive::AsPlanned, &mut replanner)?;
    Ok(Ran { outcome, replanned: replanner.replanned })
}

impl Execution {
    /// What a run of `planned` under `script` comes to.
    pub fn new(revision: u64, script: Script, program: &Program, planned: &Planned, ran: Ran) -> Self {
        let last_times = ran.outcome.last().times.clone();
        let all_planned = std::iter::once(planned).chain(&ran.replanned);
        let plans = ran
            .outcome
            .plans
            .into_iter()
            .zip(all_planned)
            .map(|(executed, planned)| {
                let shared = executed.times.len().min(last_times.len());
                let times: Vec<Option<Rational>> = executed
                    .times
                    .iter()
                    .enumerate()
                    .map(|(index, &time)| time.or_else(|| last_times[..shared].get(index).copied().flatten()))
                    .collect();
                let (network, plan) = without_facts(&executed.network, executed.plan);
                let as_run = with_times(&plan, &times);
                let traverses = planned.traverses.clone();
                let motions = planning::motions_of(program, &network, &as_run, planned);
                Executed { from: executed.from, network, plan, times, traverses, motions }
            })
            .collect();
        Self { revision, script, log: ran.outcome.log, ending: ran.outcome.ending, plans }
    }

    /// The plan that was followed at `time`, and its number from 0.
    pub fn plan_at(&self, time: f64) -> Option<(usize, &Executed)> {
        let is_made = |plan: &&Executed| number(plan.from) <= time + 1e-9;
        let at = self.plans.iter().take_while(is_made).count().max(1) - 1;
        Some((at, self.plans.get(at)?))
    }

    /// When the last entry of the log was written.
    pub fn end(&self) -> Rational {
        self.log.last().map(|entry| entry.time).unwrap_or_default()
    }
}

fn number(time: Rational) -> f64 {
    *time.numer() as f64 / *time.denom() as f64
}

/// A network without the arcs by which facts hold events in the past: nothing else leads back to the start.
fn without_facts(network: &Arc<Network>, mut plan: Plan) -> (Arc<Network>, Plan) {
    let own = network.arcs.iter().rposition(|arc| arc.to != network.start).map_or(0, |last| last + 1);
    if own == network.arcs.len() {
        return (Arc::clone(network), plan);
    }
    let mut stripped = network.as_ref().clone();
    stripped.arcs.truncate(own);
    plan.selected_arcs.truncate(own);
    for node in &mut stripped.nodes {
        node.out_arcs.retain(|arc| arc.index() < own);
        node.in_arcs.retain(|arc| arc.index() < own);
    }
    (Arc::new(stripped), plan)
}

/// The plan with the windows of what happened closed to when it did.
fn with_times(plan: &Plan, times: &[Option<Rational>]) -> Plan {
    let mut plan = plan.clone();
    for (window, time) in plan.windows.iter_mut().zip(times) {
        if let (Some(_), Some(time)) = (&window, *time) {
            *window = Some(Window { earliest: time, latest: Bound::Finite(time) });
        }
    }
    plan
}

struct WithPaths<'run, 'input> {
    problem: &'run Problem<'input>,
    grounds: &'run mut Grounds,
    paths: &'run mut Paths,
    replanned: Vec<Planned>,
}

impl Replanner for WithPaths<'_, '_> {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        let mut options = self.problem.options;
        (options.all, options.relax, options.trace_events) = (false, false, None);
        let problem = Problem { facts: Some(facts), options, ..*self.problem };
        let planned = planning::plan(&problem, self.grounds, self.paths, &mut || false);
        let outcome = &planned.planning.outcome;
        match outcome.plans.first() {
            Some(plan) => {
                let found = (Arc::clone(&planned.network), plan.clone());
                self.replanned.push(planned);
                Ok(found)
            }
            None if outcome.status == Status::Error => Err("a time does not fit into 64 bits".to_owned()),
            None => {
                let reasons = outcome.failure.iter().flat_map(|failure| &failure.reasons);
                let messages: Vec<&str> = reasons.map(|reason| reason.message.as_str()).take(3).collect();
                Err(format!("there is no plan from here: {}", messages.join("; ")))
            }
        }
    }
}
