//! One run with chance: what is drawn, and what it adds to the tally.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;

use exact::{Bound, Overflow, Time};
use executive::world::natures_ranges;
use executive::{
    ActivityExecutor, AsPlanned, Disturbance, Ending, Entry, Happening, PlanError, RunOutcome, Stage, World,
};
use motion::Path;
use plant::Random;
use rmpl::program::{Controllability, LabelMode, Program};
use smol_str::SmolStr;
use snapshot::robustness::{Breaks, Distribution, Faults, Incident, Others, Rocks, Traverses};
use snapshot::{RobustnessSettings, Tally, Uncertainty};
use tpn::{ArcId, Network, NodeId, Occurrence, OccurrenceId, OccurrenceKind, Plan};

use crate::execution::{self, Ran};
use crate::ground::Grounds;
use crate::nature::{self, Nature};
use crate::planning::{Planned, Problem};
use crate::program_executor::ProgramExecutor;
use crate::programs::Programs;
use crate::simulation::{self, Courses, Driving};
use crate::traverse::Paths;

/// Draws are multiples of this part of a unit.
const PER_UNIT: u32 = 1000;

/// A plan made ready for many runs with chance.
pub struct Sampler {
    /// The plan's, in which nature also chooses what the plan assumes.
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
    rocks: Rocks,
    nature: Nature,
    /// What is said of the durations that nature chooses.
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
        self.count(&ran, number, tally)
    }

    /// What nature chooses in the run of a seed.
    fn chosen(&self, seed: u64) -> Result<BTreeMap<SmolStr, Time>, PlanError> {
        let named = |occurrence: &Occurrence| {
            self.natures
                .iter()
                .find(|(name, _)| *name == occurrence.name)
                .map(|&(_, distribution)| distribution)
        };
        Ok(nature::choose(&self.network, seed, self.nature, &named)?)
    }

    /// What goes otherwise than planned in run `number`.
    pub fn draw(&self, seed: u64, number: u64) -> Result<Vec<Disturbance>, PlanError> {
        let mut random = Random::new(run_seed(seed, number));
        let mut drawn = Vec::new();
        for (activity, distribution) in &self.durations {
            let duration = distribution.draw(&mut random)?;
            drawn.push(Disturbance::Duration { activity: activity.clone(), duration });
        }
        for (condition, incident) in &self.late {
            if let Some(at) = incident.draw(&mut random)? {
                drawn.push(Disturbance::Late { condition: condition.clone(), at });
            }
        }
        for (condition, incident) in &self.withdrawn {
            if let Some(at) = incident.draw(&mut random)? {
                drawn.push(Disturbance::Withdrawn { condition: condition.clone(), at });
            }
        }
        let ways = self.courses.iter().flat_map(Courses::ways);
        for (path, place_ends_m) in ways {
            drawn.extend(self.rocks.draw(path, place_ends_m, &mut random));
        }
        Ok(drawn)
    }

    fn count(&self, ran: &Ran, number: u64, tally: &mut Tally) -> Result<(), PlanError> {
        let outcome = &ran.outcome;
        tally.runs += 1;
        if outcome.ending == Ending::Finished {
            tally.succeeded += 1;
            tally.succeeded_by_replanning += u64::from(outcome.plans.len() > 1);
            let end = outcome.log.last().map_or(Some(0), |entry| entry.time.whole_parts(PER_UNIT));
            let end = end.ok_or(PlanError::Overflow)?;
            tally.end_sum = tally.end_sum.checked_add(end).ok_or(PlanError::Overflow)?;
            tally.end_least = tally.end_least.into_iter().chain([end]).min();
            tally.end_most = tally.end_most.into_iter().chain([end]).max();
        }
        count_breaks(outcome, number, tally);
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

fn count_breaks(outcome: &RunOutcome, number: u64, tally: &mut Tally) {
    for (index, entry) in outcome.log.iter().enumerate() {
        let Happening::Violation { name, reason } = &entry.happening else { continue };
        let next = outcome.log.get(index + 1);
        let is_stop = matches!(next, Some(Entry { happening: Happening::Stopped { .. }, .. }));
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

/// The network in which nature chooses when the world acts, instead of the plan that assumes it (SPEC 13.3): from the
/// bounds that the mission gives it, or up to the mission's end where they have none. What the mission reads as
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

/// How long each activity takes that is left to chance.
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
    // Whoever says what nature chooses leaves the rest to the plan.
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

/// What is said of durations that nature chooses: by the name of the occurrence, or without its count.
fn natures(network: &Network, uncertainty: &Uncertainty) -> Vec<(SmolStr, Distribution)> {
    natures_ranges(network)
        .map(|(occurrence, [lower, upper])| {
            let named = said_of(occurrence, uncertainty);
            (occurrence.name.clone(), named.unwrap_or(Distribution::Uniform(lower, upper)))
        })
        .collect()
}

/// What is said of the duration of an occurrence that nature chooses.
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
    let lower = arc.lower.max(executive::world::least_drive(network, occurrence).ok()?);
    (lower < upper && !is_watched(network, id)).then_some(Distribution::Uniform(lower, upper))
}

/// Whether an activity is the body of a `watching`, or inside one: then it asserts that its condition is false.
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

/// The name without its count.
fn base(name: &str) -> &str {
    name.rsplit_once('#').map_or(name, |(base, _)| base)
}

impl Uncertainty {
    /// A name of whose times it says something that is no distribution.
    pub fn unsound(&self) -> Option<&SmolStr> {
        let durations = self.durations.iter();
        let incidents = self.late.iter().chain(&self.withdrawn).map(|(name, incident)| (name, &incident.at));
        durations.chain(incidents).find(|(_, distribution)| !distribution.is_sound()).map(|(name, _)| name)
    }

    /// What is wrong with it for the mission of `network`, if something is.
    pub fn problem(&self, network: &Network) -> Option<String> {
        let unknown = self.unknown_names(network);
        if !unknown.is_empty() {
            return Some(format!("no activity or condition is called {}", unknown.join(", ")));
        }
        if let Some(name) = self.unsound() {
            return Some(format!(
                "what is said of {name} is no distribution: its numbers must not fall, and not be below 0"
            ));
        }
        let mut incidents = self.late.iter().chain(&self.withdrawn);
        if let Some((name, it)) = incidents.find(|(_, it)| !(0.0..=1.0).contains(&it.probability)) {
            return Some(format!("the probability of {name} is from 0 to 1, and not {}", it.probability));
        }
        let rocks = "rocks have lengths from 0 on, and the least radius comes first";
        (!self.rocks.is_sound()).then(|| rocks.to_owned())
    }

    /// The names in it that nothing in `network` has.
    pub fn unknown_names(&self, network: &Network) -> Vec<SmolStr> {
        let is_known = |name: &SmolStr, kind: OccurrenceKind| {
            network.occurrences.iter().any(|occurrence| {
                occurrence.kind == kind
                    && (occurrence.name == *name
                        || occurrence.activity == *name
                        || base(&occurrence.name) == *name)
            })
        };
        let is_natures = |name: &SmolStr| {
            natures_ranges(network)
                .any(|(it, _)| it.name == *name || it.activity == *name || base(&it.name) == *name)
        };
        let activities = self.durations.keys();
        let activities =
            activities.filter(|name| !is_known(name, OccurrenceKind::Primitive) && !is_natures(name));
        let conditions = self
            .late
            .keys()
            .chain(self.withdrawn.keys())
            .filter(|name| !is_known(name, OccurrenceKind::Assertion));
        activities.chain(conditions).cloned().collect()
    }
}

impl Incident {
    fn draw(&self, random: &mut Random) -> Result<Option<Time>, Overflow> {
        // Both are always drawn, so that a probability can be changed without changing the rest of a run.
        let chance = unit(random);
        let at = self.at.draw(random)?;
        Ok((chance < self.probability).then_some(at))
    }
}

impl Rocks {
    /// Rocks about a path, none of them on a place that the path leads to. As much is drawn for each that might lie there as
    /// for one that does.
    fn draw(&self, path: &Path, place_ends_m: &[f64], random: &mut Random) -> Vec<Disturbance> {
        const ROOM_M: f64 = 3.0;
        let count = random.below(u64::from(self.most) + 1);
        let length_m = path.length_m();
        let mut rocks = Vec::new();
        for number in 0..u64::from(self.most) {
            let along_m = unit(random) * length_m;
            let aside_m = (2.0 * unit(random) - 1.0) * self.aside;
            let [least, greatest] = self.radius;
            let radius = least + (greatest - least) * unit(random);
            let mut places_m = place_ends_m.iter().copied().chain([0.0]);
            if number >= count || places_m.any(|end_m| (end_m - along_m).abs() < radius + ROOM_M) {
                continue;
            }
            let Some((place, segment)) = path.point_at(along_m) else { continue };
            let Some((from, to)) = path.segments().nth(segment) else { continue };
            let (east, north) = (to[0] - from[0], to[1] - from[1]);
            let length = (east * east + north * north).sqrt().max(1e-9);
            let (x, y) = (place[0] - north / length * aside_m, place[1] + east / length * aside_m);
            rocks.push(Disturbance::Obstacle { at: Time::ZERO, x, y, radius, low: false });
        }
        rocks
    }
}

/// A number from 0 up to 1.
fn unit(random: &mut Random) -> f64 {
    (random.next_bits() >> 11) as f64 / (1_u64 << 53) as f64
}

impl Distribution {
    /// What it draws is this and whole parts of a unit.
    fn least(self) -> Time {
        match self {
            Self::Fixed(least) | Self::Uniform(least, _) | Self::Triangular(least, ..) => least,
            Self::Normal(..) => Time::ZERO,
        }
    }

    /// Draws a time; an error if it does not fit.
    pub fn draw(self, random: &mut Random) -> Result<Time, Overflow> {
        let least = self.least();
        let after = |time: Time| time.checked_sub(least).ok_or(Overflow);
        let offset = match self {
            Self::Fixed(_) => Some(Time::ZERO),
            Self::Uniform(_, most) => {
                let steps = after(most)?.whole_parts(PER_UNIT).ok_or(Overflow)?.max(0) as u64;
                Time::new(random.below(steps.saturating_add(1)) as i64, i64::from(PER_UNIT))
            }
            Self::Triangular(_, likely, most) => {
                let (width, peak) = (after(most)?.to_f64(), after(likely)?.to_f64());
                let share = unit(random);
                let offset = if width <= 0.0 {
                    0.0
                } else if share * width < peak {
                    (share * width * peak).sqrt()
                } else {
                    width - ((1.0 - share) * width * (width - peak)).sqrt()
                };
                Time::from_f64_nearest(offset, PER_UNIT)
            }
            Self::Normal(mean, deviation) => {
                let (radius, angle) = (1.0 - unit(random), unit(random));
                let normal =
                    (-2.0 * libm::log(radius)).sqrt() * libm::cos(2.0 * std::f64::consts::PI * angle);
                let drawn = mean.to_f64() + deviation.to_f64() * normal;
                Time::from_f64_nearest(drawn, PER_UNIT).map(|drawn| drawn.max(Time::ZERO))
            }
        };
        offset.and_then(|offset| least.checked_add(offset)).ok_or(Overflow)
    }

    /// Whether it can be drawn from: in order, and not below 0.
    pub fn is_sound(&self) -> bool {
        match *self {
            Self::Fixed(time) => !time.is_negative(),
            Self::Uniform(least, most) => !least.is_negative() && least <= most,
            Self::Triangular(least, likely, most) => {
                !least.is_negative() && least <= likely && likely <= most
            }
            Self::Normal(mean, deviation) => !mean.is_negative() && !deviation.is_negative(),
        }
    }
}
