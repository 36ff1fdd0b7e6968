//! One run with chance: what is drawn, and what it adds to the tally.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use exact::{Bound, Time};
use executive::world::natures_ranges;
use executive::{
    ActivityExecutor, AsPlanned, Contact, Disturbance, Ending, Entry, Happening, PlanError, Stage, World,
};
use plant::Random;
use rmpl::program::{Controllability, LabelMode, Program};
use smol_str::SmolStr;
use snapshot::robustness::{Breaks, Distribution, Faults, Incident, Others, Rocks, Traverses, base};
use snapshot::{RobustnessSettings, Tally, Uncertainty};
use tpn::{ArcId, Network, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan};

use crate::draws::{self, PER_UNIT};
use crate::execution::{self, Ran};
use crate::ground::Grounds;
use crate::nature::{self, Nature};
use crate::planning::{Planned, Problem};
use crate::program_executor::ProgramExecutor;
use crate::programs::Programs;
use crate::simulation::{self, Courses, Driving};
use crate::traverse::Paths;

/// A plan made ready for many runs with chance.
pub struct Sampler {
    /// The plan's, in which the environment also chooses what the plan assumes.
    network: Arc<Network>,
    stage: Stage,
    windows: Vec<(SmolStr, NodeId, Time, Time)>,
    durations: Vec<(SmolStr, Distribution)>,
    late: Vec<(SmolStr, Incident)>,
    withdrawn: Vec<(SmolStr, Incident)>,
    programs: Programs,
    faults: Faults,
    /// The traverses that are driven; none if their durations are drawn.
    courses: Option<Courses>,
    /// The plan with the paths that vehicles keep an even pace on, where they are not driven.
    planned: Option<Planned>,
    rocks: Rocks,
    nature: Nature,
    /// What is said of the durations that the environment chooses.
    natures: Vec<(SmolStr, Distribution)>,
}

impl Sampler {
    /// Makes the plan of `planned` ready; `None` if there is none.
    pub fn new(
        problem: &Problem<'_>,
        planned: &Planned,
        uncertainty: &Uncertainty,
    ) -> Option<Result<Self, PlanError>> {
        let program = problem.program;
        let plan = planned.planning.outcome.plans.first()?;
        let network = &planned.network;
        let programs = problem.programs().into_owned();
        let courses = (uncertainty.traverses == Traverses::Driven).then(|| {
            let mut courses = Courses::default();
            courses.learn(program, planned);
            courses
        });
        let durations = durations(network, uncertainty, &programs, courses.as_ref());
        let network = &with_assumed(program, network, uncertainty);
        let natures = natures(network, uncertainty);
        let late = incidents(network, &uncertainty.late);
        let withdrawn = incidents(network, &uncertainty.withdrawn);
        let part = Time::ONE.checked_div(PER_UNIT).unwrap_or_default();
        let mut grid = vec![part, programs.step()];
        grid.extend(courses.as_ref().map(|_| simulation::granularity(program)));
        let incidents = late.iter().chain(&withdrawn).map(|(_, incident)| incident.at);
        grid.extend(durations.iter().map(|&(_, it)| it).chain(incidents).map(Distribution::least));
        grid.extend(natures.iter().map(|&(_, it)| it).map(Distribution::least));
        let stage = Stage::new(Arc::clone(network), plan.clone(), &grid);
        let windows = windows(network, plan);
        Some(stage.map(|stage| Self {
            network: Arc::clone(network),
            stage,
            windows,
            durations,
            late,
            withdrawn,
            programs,
            faults: uncertainty.faults,
            planned: courses.is_none().then(|| planned.clone()),
            courses,
            rocks: uncertainty.rocks,
            nature: if uncertainty.adversary { Nature::Adversary } else { Nature::Chance },
            natures,
        }))
    }

    /// Makes run `number` and adds it to `tally`.
    pub fn run(
        &self,
        problem: &Problem<'_>,
        settings: &RobustnessSettings,
        number: u64,
        grounds: &mut Grounds,
        paths: &mut Paths,
        tally: &mut Tally,
    ) -> Result<(), PlanError> {
        let disturbances = self.draw(settings.seed, number)?;
        let chosen = self.chosen(run_seed(settings.seed, number))?;
        let mut world = World::new(&disturbances).with_chosen(chosen.clone());
        if self.nature == Nature::Adversary {
            world = world.with_adversary();
        }
        // Faults are drawn apart from the rest, so that they do not change it.
        let seed = Random::new(run_seed(settings.seed, number) ^ FAULTS).next_bits();
        let fault_seed = (self.faults == Faults::ByChance).then_some(seed);
        let courses = self.courses.clone().map(RefCell::new);
        let mut driving = courses.as_ref().zip(problem.ground).map(|(courses, (_, map))| {
            Driving::new(problem, map, &disturbances, courses, run_seed(settings.seed, number))
        });
        if let Some(driving) = &mut driving {
            driving.hurry(chosen);
        }
        let mut as_planned = AsPlanned;
        let others: &mut dyn ActivityExecutor = match &mut driving {
            Some(driving) => driving,
            None => &mut as_planned,
        };
        let mut executor = ProgramExecutor::new(&self.programs, &[], fault_seed, others);
        let ran = execution::execute_stage(
            problem,
            self.stage.clone(),
            &world,
            &mut executor,
            (grounds, paths),
            courses.as_ref(),
        )?;
        let contact = self.planned.as_ref().and_then(|planned| contact(problem.program, planned, &ran));
        self.count(&ran, contact, number, tally)
    }

    /// Returns what the environment chooses in the run of a seed.
    fn chosen(&self, seed: u64) -> Result<BTreeMap<SmolStr, Time>, PlanError> {
        let named = |occurrence: &Occurrence| {
            self.natures
                .iter()
                .find(|(name, _)| *name == occurrence.name)
                .map(|&(_, distribution)| distribution)
        };
        Ok(nature::choose(&self.network, seed, self.nature, &named)?)
    }

    /// Returns what goes otherwise than planned in run `number`.
    pub fn draw(&self, seed: u64, number: u64) -> Result<Vec<Disturbance>, PlanError> {
        let mut random = Random::new(run_seed(seed, number));
        let mut drawn = Vec::new();
        for (activity, distribution) in &self.durations {
            let duration = draws::draw(*distribution, &mut random)?;
            drawn.push(Disturbance::Duration { activity: activity.clone(), duration });
        }
        for (condition, incident) in &self.late {
            if let Some(at) = draws::incident(incident, &mut random)? {
                drawn.push(Disturbance::Late { condition: condition.clone(), at });
            }
        }
        for (condition, incident) in &self.withdrawn {
            if let Some(at) = draws::incident(incident, &mut random)? {
                drawn.push(Disturbance::Withdrawn { condition: condition.clone(), at });
            }
        }
        let ways = self.courses.iter().flat_map(Courses::ways);
        for (path, place_ends_m) in ways {
            drawn.extend(draws::rocks(&self.rocks, path, place_ends_m, &mut random));
        }
        Ok(drawn)
    }

    fn count(
        &self,
        ran: &Ran,
        contact: Option<Contact>,
        number: u64,
        tally: &mut Tally,
    ) -> Result<(), PlanError> {
        let outcome = &ran.outcome;
        tally.runs += 1;
        if let Some(Contact { at, name, reason }) = contact {
            let before = outcome.log.iter().take_while(|entry| entry.time <= at);
            count_breaks(before, number, tally);
            count_break((&name, &reason), true, number, tally);
            return Ok(());
        }
        if outcome.ending == Ending::Finished {
            tally.succeeded += 1;
            tally.succeeded_by_replanning += u64::from(outcome.plans.len() > 1);
            let end = outcome.log.last().map_or(Some(0), |entry| entry.time.integer_parts(PER_UNIT));
            let end = end.ok_or(PlanError::Overflow)?;
            tally.end_sum = tally.end_sum.checked_add(end).ok_or(PlanError::Overflow)?;
            tally.end_least = tally.end_least.into_iter().chain([end]).min();
            tally.end_most = tally.end_most.into_iter().chain([end]).max();
        }
        count_breaks(outcome.log.iter(), number, tally);
        let Some(first) = outcome.plans.first() else { return Ok(()) };
        for (event, node, earliest, latest) in &self.windows {
            let Some(time) = first.times[node.index()] else { continue };
            let (earliest, latest) = (earliest.to_f64(), latest.to_f64());
            let share = (time.to_f64() - earliest) / (latest - earliest);
            let used = ((share * 1000.0).floor() as i64).clamp(0, 1000) as u64;
            let slack = tally.slack.entry(event.clone()).or_default();
            slack.count += 1;
            slack.sum_permille += used;
            slack.most_permille = slack.most_permille.max(used);
        }
        Ok(())
    }
}

/// Told from the seed of everything else by this.
const FAULTS: u64 = 0x6661_756c_7473;

/// The seed of one run.
const fn run_seed(seed: u64, number: u64) -> u64 {
    Random::new(seed).next_bits() ^ Random::new(number).next_bits()
}

/// The first contact of vehicles in a run without driving, if some schedule of a plan brings them too close. The run is over
/// then: the executive cannot foresee it.
fn contact(program: &Program, planned: &Planned, ran: &Ran) -> Option<Contact> {
    let replanned = ran.replanned.iter().map(|(_, planned)| planned);
    if std::iter::once(planned).chain(replanned).all(|planned| planned.meetings.is_empty()) {
        return None;
    }
    let plans = execution::as_run(program, planned, &ran.outcome.plans, &ran.replanned);
    let end = ran.outcome.log.last().map_or(Time::ZERO, |entry| entry.time);
    simulation::first_on_paths(program, &plans).filter(|contact| contact.at <= end)
}

/// Counts the violations in (the beginning of) the log of a run.
fn count_breaks<'a>(log: impl Iterator<Item = &'a Entry>, number: u64, tally: &mut Tally) {
    let mut log = log.peekable();
    while let Some(entry) = log.next() {
        let Happening::Violation { name, reason, .. } = &entry.happening else { continue };
        let is_stop = matches!(log.peek(), Some(Entry { happening: Happening::Stopped { .. }, .. }));
        count_break((name, reason), is_stop, number, tally);
    }
}

fn count_break((name, reason): (&SmolStr, &String), is_stop: bool, number: u64, tally: &mut Tally) {
    let breaks = tally.breaks.entry(name.clone()).or_insert_with(|| Breaks {
        example: reason.clone(),
        example_run: number,
        ..Breaks::default()
    });
    if number < breaks.example_run {
        (breaks.example, breaks.example_run) = (reason.clone(), number);
    }
    breaks.violations += 1;
    breaks.stops += u64::from(is_stop);
}

/// The starts and ends of activities and conditions whose windows are neither a moment nor without an end.
fn windows(network: &Network, plan: &Plan) -> Vec<(SmolStr, NodeId, Time, Time)> {
    let mut found = Vec::new();
    for (index, node) in network.nodes.iter().enumerate() {
        let Some(window) = plan.windows[index] else { continue };
        let Bound::Finite(latest) = window.latest else { continue };
        let event = node.events.iter().find(|event| {
            let kind = network.occurrences[event.occurrence.index()].kind;
            let is_vertex = matches!(event.end, tpn::EventEnd::PathVertex { .. });
            matches!(kind, OccurrenceKind::Primitive | OccurrenceKind::Assertion) && !is_vertex
        });
        if let Some(&event) = event.filter(|_| window.earliest < latest) {
            found.push((
                network.event_name(event).into(),
                NodeId::from_index(index),
                window.earliest,
                latest,
            ));
        }
    }
    found
}

/// The network in which the environment chooses when the world acts, instead of the plan that assumes it (SPEC 13.3):
/// from the bounds that the mission gives it, or up to the mission's end where they have none. What the mission reads as
/// ordinary, and what is to be as planned, stays as it is.
fn with_assumed(program: &Program, network: &Arc<Network>, uncertainty: &Uncertainty) -> Arc<Network> {
    let assumed = tpn::assumed(program);
    if assumed.is_empty() || network.controllability == Controllability::None {
        return Arc::clone(network);
    }
    let scenario = network.occurrences.iter().find(|it| it.kind == OccurrenceKind::Scenario);
    let scenario_arc = scenario.and_then(|scenario| scenario.arc);
    let horizon = scenario_arc.map_or(Bound::Infinite, |arc| network.arcs[arc.index()].upper);
    let mut changed = Network::clone(network);
    for occurrence in &network.occurrences {
        let is_world = matches!(occurrence.kind, OccurrenceKind::Delay | OccurrenceKind::Assertion);
        let is_assumed = is_world && occurrence.span.is_some_and(|span| assumed.contains(&span));
        let Some(arc) = occurrence.arc.filter(|_| is_assumed) else { continue };
        if uncertainty.others == Others::Planned && said_of(occurrence, uncertainty).is_none() {
            continue;
        }
        let arc = &mut changed.arcs[arc.index()];
        let upper = if arc.upper == Bound::Infinite { horizon } else { arc.upper };
        if Bound::Finite(arc.lower) < upper && upper != Bound::Infinite {
            (arc.upper, arc.is_contingent) = (upper, true);
        }
    }
    Arc::new(changed)
}

/// Returns how long each activity takes that is left to chance.
fn durations(
    network: &Network,
    uncertainty: &Uncertainty,
    programs: &Programs,
    driven: Option<&Courses>,
) -> Vec<(SmolStr, Distribution)> {
    let is_natures = |occurrence: &Occurrence| {
        let is_chosen = |arc: ArcId| {
            network.is_uncertain(arc) || (uncertainty.adversary && network.arcs[arc.index()].is_contingent)
        };
        occurrence.arc.is_some_and(is_chosen)
    };
    // If uncertainty is given for what the environment chooses, the plan decides the rest.
    let is_told = network.occurrences.iter().any(is_natures);
    let primitives = network.occurrences.iter().enumerate();
    primitives
        .filter(|(_, occurrence)| occurrence.kind == OccurrenceKind::Primitive && !is_natures(occurrence))
        .filter(|(_, occurrence)| programs.system(occurrence).is_none())
        .filter_map(|(index, occurrence)| {
            let named = uncertainty.durations.get(&occurrence.name);
            let named = named.or_else(|| uncertainty.durations.get(&occurrence.activity));
            let distribution = match (named, uncertainty.others) {
                (Some(named), _) => *named,
                (None, Others::Planned) => return None,
                (None, _) if is_told => return None,
                (None, _) if driven.is_some_and(|it| it.has(OccurrenceId::from_index(index))) => return None,
                (None, Others::Uniform) => by_bounds(network, OccurrenceId::from_index(index))?,
            };
            Some((occurrence.name.clone(), distribution))
        })
        .collect()
}

/// Returns what is said of durations that the environment chooses: by the name of the occurrence, or without its count.
fn natures(network: &Network, uncertainty: &Uncertainty) -> Vec<(SmolStr, Distribution)> {
    natures_ranges(network)
        .map(|(occurrence, [lower, upper])| {
            let named = said_of(occurrence, uncertainty);
            (occurrence.name.clone(), named.unwrap_or(Distribution::Uniform(lower, upper)))
        })
        .collect()
}

/// Returns what is said of the duration of an occurrence that the environment chooses.
fn said_of(occurrence: &Occurrence, uncertainty: &Uncertainty) -> Option<Distribution> {
    let said = &uncertainty.durations;
    let named = said.get(&occurrence.name).or_else(|| said.get(&occurrence.activity));
    named.or_else(|| said.get(base(&occurrence.name))).copied()
}

/// Anything between the bounds, for an activity that is not ended by the executive itself: one that is watched.
fn by_bounds(network: &Network, id: OccurrenceId) -> Option<Distribution> {
    let occurrence = network.occurrences.get(id.index())?;
    let arc = network.arcs.get(occurrence.arc?.index())?;
    let Bound::Finite(upper) = arc.upper else { return None };
    let lower = arc.lower.max(executive::world::min_drive(network, occurrence).ok()?);
    (lower < upper && !is_watched(network, id)).then_some(Distribution::Uniform(lower, upper))
}

/// Returns whether an activity is the body of a `watching`, or inside one: then it asserts that its condition is false.
fn is_watched(network: &Network, id: OccurrenceId) -> bool {
    let ancestors: Vec<OccurrenceId> =
        std::iter::successors(Some(id), |at| network.occurrences.get(at.index())?.parent)
            .take(network.occurrences.len())
            .collect();
    let span = |id: OccurrenceId| network.occurrences.get(id.index()).and_then(|occurrence| occurrence.span);
    network.labels.iter().filter(|label| label.mode == LabelMode::Tell).any(|label| {
        let Some(owner) = label.owner else { return false };
        let Some(kind) = network.occurrences.get(owner.index()).map(|occurrence| occurrence.kind) else {
            return false;
        };
        let contains = || {
            let (outer, inner) = (span(owner)?, span(id)?);
            Some(outer.start <= inner.start && inner.end <= outer.end)
        };
        match kind {
            OccurrenceKind::Primitive | OccurrenceKind::Activity => ancestors.contains(&owner),
            OccurrenceKind::Scope => contains().unwrap_or(false),
            _ => false,
        }
    })
}

/// The conditions that something may happen to.
fn incidents(
    network: &Network,
    declared: &std::collections::BTreeMap<SmolStr, Incident>,
) -> Vec<(SmolStr, Incident)> {
    let is_meant = |occurrence: &Occurrence, name: &SmolStr| {
        occurrence.kind == OccurrenceKind::Assertion
            && (occurrence.name == *name || occurrence.activity == *name || base(&occurrence.name) == *name)
    };
    network
        .occurrences
        .iter()
        .filter_map(|occurrence| {
            let (_, incident) = declared.iter().find(|(name, _)| is_meant(occurrence, name))?;
            Some((occurrence.name.clone(), *incident))
        })
        .collect()
}

/// A plan made ready for runs with chance, and what it belongs to.
pub(crate) struct Sampled {
    pub(crate) revision: u64,
    pub(crate) uncertainty: Uncertainty,
    pub(crate) sampler: Sampler,
}
