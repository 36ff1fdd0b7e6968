//! A planned mission executed in the simulated world, planning again with paths when the plan cannot be kept.
//!
//! A run follows from its mission, seed and disturbances alone. To watch a run, it is not executed step by step: after a
//! disturbance at the present moment, the whole run is executed again, and nothing before that moment changes.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::sync::Arc;

use exact::{Bound, Rational, Time};
use executive::world::{abort_name, natures_ranges};
use executive::{
    ActivityExecutor, AsPlanned, Disturbance, ExecutedPlan, Facts, PlanError, Replanner, RunOutcome, Script,
    Stage, World, run_stage,
};
use rmpl::program::{Controllability, Program};
use smol_str::SmolStr;
use snapshot::{Commanded, Executed, Execution, SimulatedDrive};
use tpn::plan_json::node_name;
use tpn::{Network, NodeId, OccurrenceKind, Plan, Supply, Window};

use crate::ground::Grounds;
use crate::nature::{self, Nature};
use crate::planning::{self, Planned, Problem};
use crate::program_executor::ProgramExecutor;
use crate::programs::Programs;
use crate::simulation::{self, Courses, Driving};
use crate::traverse::Paths;

/// A run with what replanning found.
pub struct Ran {
    pub outcome: RunOutcome,
    /// What each replan started from and gave, in order.
    pub replanned: Vec<(Facts, Planned)>,
    /// The traverses as they were driven, in order of departure; none where durations are only drawn.
    pub drives: Vec<SimulatedDrive>,
    /// What the control programs command.
    pub commanded: Option<Commanded>,
}

/// Executes the plan of `planned`, which `problem` gave; `None` if it has no plan. Vehicles drive their traverses in
/// simulation, as late as that makes them; what the environment chooses and the script does not say is drawn by the
/// seed of the script, or of `problem`.
pub fn execute(
    problem: &Problem<'_>,
    planned: &Planned,
    script: &Script,
    grounds: &mut Grounds,
    paths: &mut Paths,
) -> Option<Result<Ran, PlanError>> {
    let plan = planned.planning.outcome.plans.first()?.clone();
    let disturbances = &script.disturbances;
    let nature = if script.adversary { Nature::Adversary } else { Nature::Chance };
    let seed = script.run_seed.unwrap_or(problem.seed);
    let mut chosen = match nature::choose(&planned.network, seed, nature, &|_| None) {
        Ok(chosen) => chosen,
        Err(overflow) => return Some(Err(overflow.into())),
    };
    chosen.extend(script.nature.clone());
    let mut world =
        World::new(disturbances).with_chosen(chosen.clone()).with_schedule(script.schedule.clone());
    if script.adversary {
        world = world.with_adversary();
    }
    let courses = RefCell::new(Courses::default());
    courses.borrow_mut().learn(problem.program, planned);
    let mut driving = problem.ground.map(|(_, map)| Driving::new(problem, map, disturbances, &courses, seed));
    if let Some(driving) = &mut driving {
        driving.hurry(chosen);
    }
    let programs = problem.programs();
    let mut as_planned = AsPlanned;
    let others: &mut dyn ActivityExecutor = match &mut driving {
        Some(driving) => driving,
        None => &mut as_planned,
    };
    let mut executor = ProgramExecutor::new(&programs, disturbances, None, others);
    let granularity = executor.granularity();
    let grid = world.times(&planned.network).map_err(PlanError::from);
    let stage = grid.and_then(|mut grid| {
        grid.push(granularity);
        Stage::new(dispatched(&planned.network, script), plan, &grid)
    });
    let ran = stage.and_then(|stage| {
        let mut replanner =
            WithPaths { problem, grounds, paths, replanned: Vec::new(), courses: Some(&courses) };
        let num_program_nodes = problem.network.nodes.len();
        let outcome = run_stage(stage, num_program_nodes, &world, &mut executor, &mut replanner)?;
        Ok((outcome, replanner.replanned))
    });
    let drives = driving.map(Driving::into_drives).unwrap_or_default();
    let commanded = programs.commanded(&planned.network);
    Some(ran.map(|(outcome, replanned)| Ran { outcome, replanned, drives, commanded }))
}

/// The network that the first plan is dispatched in. A schedule says what nature does as well, so that nobody waits for it.
fn dispatched(network: &Arc<Network>, script: &Script) -> Arc<Network> {
    if script.schedule.is_empty() {
        return Arc::clone(network);
    }
    let mut scheduled = Network::clone(network);
    scheduled.controllability = Controllability::None;
    Arc::new(scheduled)
}

/// Executes a plan of `problem` that was made ready for `world` and `executor`, which looks for its traverses in
/// `courses` if vehicles drive.
pub(crate) fn execute_stage(
    problem: &Problem<'_>,
    stage: Stage,
    world: &World,
    executor: &mut dyn ActivityExecutor,
    planner: (&mut Grounds, &mut Paths),
    courses: Option<&RefCell<Courses>>,
) -> Result<Ran, PlanError> {
    let (grounds, paths) = planner;
    let mut replanner = WithPaths { problem, grounds, paths, replanned: Vec::new(), courses };
    let num_program_nodes = problem.network.nodes.len();
    let outcome = run_stage(stage, num_program_nodes, world, executor, &mut replanner)?;
    Ok(Ran { outcome, replanned: replanner.replanned, drives: Vec::new(), commanded: None })
}

/// Whether a script means something and is about what the mission has; if not, what is wrong with it.
pub fn check_script(
    network: &Network,
    program: &Program,
    programs: &Programs,
    script: &Script,
) -> Result<(), String> {
    let disturbances = &script.disturbances;
    if let Some(problem) = script.problem() {
        return Err(problem.to_owned());
    }
    check_names(network, script)?;
    let is_unknown = |name: &&SmolStr| !program.world.vehicles.iter().any(|it| it.name.text == **name);
    let vehicles = disturbances.iter().filter_map(Disturbance::vehicle).filter(is_unknown).cloned();
    let unknown: Vec<SmolStr> = World::unknown(network, disturbances).into_iter().chain(vehicles).collect();
    if !unknown.is_empty() {
        return Err(format!("the mission has no {}", unknown.join(", ")));
    }
    for disturbance in disturbances {
        if let Some(problem) = wrong_kind(network, disturbance) {
            return Err(problem);
        }
    }
    let unknown = programs.unknown_faults(network, disturbances);
    if !unknown.is_empty() {
        return Err(format!("the mission has no {}", unknown.join(", ")));
    }
    disturbances.iter().try_for_each(|disturbance| match disturbance {
        Disturbance::State { variable, value, .. } => check_state(network, variable, value),
        Disturbance::Level { resource, level, .. } => check_level(network, resource, *level),
        _ => Ok(()),
    })
}

/// Whether nature's durations and the events of a schedule are those of the mission. Vertices of paths are not in its network.
fn check_names(network: &Network, script: &Script) -> Result<(), String> {
    let is_natures = |name: &SmolStr| {
        let is_abort = |it: &tpn::Occurrence| it.aborts.is_some() && abort_name(it) == *name;
        natures_ranges(network).any(|(it, _)| it.name == *name) || network.occurrences.iter().any(is_abort)
    };
    if let Some(name) = script.nature.keys().find(|name| !is_natures(name)) {
        return Err(format!("the duration of {name} is not contingent"));
    }
    if script.schedule.is_empty() {
        return Ok(());
    }
    let nodes = (0..network.nodes.len()).map(NodeId::from_index);
    let mut known: BTreeSet<String> = nodes.map(|node| node_name(network, node)).collect();
    known.extend(network.nodes.iter().flat_map(|node| &node.events).map(|&event| network.event_name(event)));
    let is_unknown = |name: &&SmolStr| !known.contains(name.as_str()) && !name.contains(".leg");
    match script.schedule.keys().find(is_unknown) {
        Some(name) => Err(format!("the mission has no event {name}")),
        None => Ok(()),
    }
}

/// Returns what is wrong with a disturbance that is about an occurrence of another kind, such as an activity that is to
/// be withdrawn.
fn wrong_kind(network: &Network, disturbance: &Disturbance) -> Option<String> {
    let name = disturbance.occurrence()?;
    let occurrence = network.occurrences.iter().find(|occurrence| occurrence.name == *name)?;
    let is_natures = || natures_ranges(network).any(|(it, _)| it.name == *name);
    let (is_right, wanted) = match disturbance {
        Disturbance::Duration { .. } => {
            let is_activity = occurrence.kind == OccurrenceKind::Primitive;
            (is_activity || is_natures(), "an activity, and its duration is not contingent")
        }
        Disturbance::Slow { .. } | Disturbance::Fault { .. } => {
            (occurrence.kind == OccurrenceKind::Primitive, "an activity")
        }
        _ => (occurrence.kind == OccurrenceKind::Assertion, "a condition that starts and ends"),
    };
    (!is_right).then(|| format!("{name} is not {wanted}"))
}

/// Whether a disturbance may give a variable a value.
fn check_state(network: &Network, variable: &SmolStr, value: &SmolStr) -> Result<(), String> {
    let known = network.variables.iter().find(|known| known.name == *variable);
    let known = known.ok_or_else(|| format!("the mission does not use the variable {variable}"))?;
    if !known.is_lasting {
        return Err(format!(
            "{variable} has a value only while it is asserted: withdraw an assertion instead"
        ));
    }
    if variable.ends_with(".at") {
        return Err(format!("{variable} is the place of a vehicle, so only driving changes it"));
    }
    if !known.values.contains(value) {
        return Err(format!("{variable} cannot be {value}: use one of {}", known.values.join(", ")));
    }
    Ok(())
}

/// Whether a disturbance may bring a resource to a level.
fn check_level(network: &Network, resource: &SmolStr, level: Rational) -> Result<(), String> {
    let known = network.resources.iter().find(|known| known.name == *resource);
    let known = known.ok_or_else(|| format!("the mission does not use the resource {resource}"))?;
    match known.supply {
        Supply::Reusable { .. } => Err(format!("{resource} has a capacity, not a level")),
        Supply::Reservoir { least, greatest, .. } if !(least..=greatest).contains(&level) => Err(format!(
            "the level of {resource} must be from {} to {}",
            least.readable(),
            greatest.readable()
        )),
        Supply::Reservoir { .. } => Ok(()),
    }
}

/// Returns what a run of `planned` under `script` comes to.
pub fn executed(revision: u64, script: Script, program: &Program, planned: &Planned, ran: Ran) -> Execution {
    let mut plans = as_run(program, planned, &ran.outcome.plans, &ran.replanned);
    for executed in &mut plans {
        simulation::put_into(&mut executed.motions, &ran.drives);
    }
    Execution {
        revision,
        script,
        log: ran.outcome.log,
        ending: ran.outcome.ending,
        plans,
        drives: ran.drives,
        commanded: ran.commanded,
    }
}

/// The plans of a run, with the times at which events happened, and vehicles that keep an even pace along their paths.
pub(crate) fn as_run(
    program: &Program,
    planned: &Planned,
    executed: &[ExecutedPlan],
    replanned: &[(Facts, Planned)],
) -> Vec<Executed> {
    let all_times = executed.last().map_or(&[][..], |last| &last.times);
    let last_facts = replanned.last().map_or(0, |(facts, _)| facts.num_world_events());
    let last_times = &all_times[..all_times.len() - last_facts];
    let none = Facts::default();
    let replanned = replanned.iter().map(|(facts, planned)| (facts, planned));
    let all_planned = std::iter::once((&none, planned)).chain(replanned);
    let as_run = |(executed, (facts, planned)): (&ExecutedPlan, (&Facts, &Planned))| {
        let (network, plan) = without_facts(facts, &executed.network, executed.plan.clone());
        let shared = network.nodes.len().min(last_times.len());
        let times: Vec<Option<Time>> = executed
            .times
            .iter()
            .take(network.nodes.len())
            .enumerate()
            .map(|(index, &time)| time.or_else(|| last_times[..shared].get(index).copied().flatten()))
            .collect();
        let motions = planning::motions_of(program, &network, &with_times(&plan, &times), planned);
        Executed { from: executed.from, network, plan, times, traverses: planned.traverses.clone(), motions }
    };
    executed.iter().zip(all_planned).map(as_run).collect()
}

/// A network without what holds it to facts: arcs that lead back to the start, and the world's own events.
fn without_facts(facts: &Facts, network: &Arc<Network>, mut plan: Plan) -> (Arc<Network>, Plan) {
    if network.arcs.iter().all(|arc| arc.to != network.start) {
        return (Arc::clone(network), plan);
    }
    let mut stripped = network.as_ref().clone();
    facts.remove(&mut stripped, &mut plan);
    (Arc::new(stripped), plan)
}

/// The plan with the windows of what happened closed to when it did. What did not happen comes no earlier than the last of it:
/// where a run stops late, the plan's own times for the rest may be over.
fn with_times(plan: &Plan, times: &[Option<Time>]) -> Plan {
    let mut plan = plan.clone();
    let last = times.iter().flatten().max().copied().unwrap_or_default();
    for (window, time) in plan.windows.iter_mut().zip(times) {
        let Some(window) = window else { continue };
        *window = match *time {
            Some(time) => Window { earliest: time, latest: Bound::Finite(time) },
            None => {
                Window { earliest: window.earliest.max(last), latest: window.latest.max(Bound::Finite(last)) }
            }
        };
    }
    plan
}

struct WithPaths<'run, 'input> {
    problem: &'run Problem<'input>,
    grounds: &'run mut Grounds,
    paths: &'run mut Paths,
    replanned: Vec<(Facts, Planned)>,
    /// Where those who drive look for their paths.
    courses: Option<&'run RefCell<Courses>>,
}

impl Replanner for WithPaths<'_, '_> {
    fn replan(&mut self, facts: &Facts) -> Result<(Arc<Network>, Plan), String> {
        let mut options = self.problem.options;
        (options.all, options.relax, options.trace_events) = (false, false, None);
        let problem = Problem { facts: Some(facts), options, ..*self.problem };
        let planned = planning::plan(&problem, self.grounds, self.paths, &mut || false);
        let outcome = &planned.planning.outcome;
        if let Some(plan) = outcome.plans.first() {
            let found = (Arc::clone(&planned.network), plan.clone());
            if let Some(courses) = self.courses {
                courses.borrow_mut().learn(self.problem.program, &planned);
            }
            self.replanned.push((facts.clone(), planned));
            return Ok(found);
        }
        if let Some(message) = outcome.unplannable_message(&planned.network) {
            return Err(message);
        }
        let reasons = outcome.failure.iter().flat_map(|failure| &failure.reasons);
        let messages: Vec<&str> = reasons.map(|reason| reason.message.as_str()).take(3).collect();
        Err(format!("no plan from here: {}", messages.join("; ")))
    }
}
