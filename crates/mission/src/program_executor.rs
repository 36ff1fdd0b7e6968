//! Runs control programs when the executive starts their activities (SPEC 15).
//!
//! All programs of a mission control one plant, which stays as they leave it, and so does what is believed of it. Programs
//! that command different components run at once: each step commands the plant toward the goals of all of them. One that
//! commands what another one does waits until that has ended. The plant steps as long as some program runs; one that is
//! started between two steps takes its first one with the next.
//!
//! How activities will go is worked out when one is started, and again when another one is started or given up: the runs
//! go back to that time and on from there.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::sync::Arc;

use exact::{Bound, Overflow, Time};
use executive::model_based::{
    ClosedLoop, Estimator, LoopStep, ProgramExecution, RewardChoice, StepInput, StepOutcome, System,
};
use executive::{
    ActivityExecution, ActivityExecutor, Contact, Disturbance, Ends, Entry, Happening, PlantReading, Revision,
};
use plant::{ComponentId, Model, Random};
use smol_str::SmolStr;
use tpn::{Network, OccurrenceId};

use crate::programs::{Programs, named};

/// A program is given up after this many steps, even if its activity may last forever.
const MAX_STEPS: i64 = 1000;

/// Runs control programs when the executive starts their activities; leaves all other activities to another executor.
pub struct ProgramExecutor<'run> {
    programs: &'run Programs,
    disturbances: &'run [Disturbance],
    /// Lets components fail by chance.
    chance: Option<Random>,
    others: &'run mut dyn ActivityExecutor,
    estimator: Option<Estimator>,
    /// The plant and the programs after each step, in order of time; the last one is what is known to come.
    moments: Vec<Moment>,
    /// How activities go as far as their programs say.
    told: BTreeMap<OccurrenceId, ActivityExecution>,
    revision: Option<Revision>,
}

/// Where everything is after a step.
#[derive(Clone)]
struct Moment {
    time: Time,
    closed: ClosedLoop,
    running: Vec<Active>,
    /// In the order in which they were started.
    waiting: Vec<Active>,
}

/// An activity with its program.
#[derive(Clone)]
struct Active {
    occurrence: OccurrenceId,
    name: SmolStr,
    program: ProgramExecution,
    commanded: Arc<BTreeSet<ComponentId>>,
    started: Time,
    /// When it is known not to end in time.
    given_up: Time,
}

impl Moment {
    /// Lets those begin that wait for no one any more.
    fn let_begin(&mut self) {
        let mut waiting = Vec::new();
        for active in std::mem::take(&mut self.waiting) {
            let mut before = self.running.iter().chain(&waiting);
            let is_free = before.all(|other| other.commanded.is_disjoint(&active.commanded));
            let target =
                if is_free && active.started <= self.time { &mut self.running } else { &mut waiting };
            target.push(active);
        }
        self.waiting = waiting;
    }

    fn active(&self) -> impl Iterator<Item = &Active> {
        self.running.iter().chain(&self.waiting)
    }

    /// Whom a program that waits is kept from beginning by.
    fn holder(&self, waiting: &Active) -> Option<&Active> {
        let mut others = self.active().filter(|other| other.occurrence != waiting.occurrence);
        others.find(|other| !other.commanded.is_disjoint(&waiting.commanded))
    }
}

impl<'run> ProgramExecutor<'run> {
    /// With a seed, components fail by chance; without, only those fail that `disturbances` name.
    pub fn new(
        programs: &'run Programs,
        disturbances: &'run [Disturbance],
        seed: Option<u64>,
        others: &'run mut dyn ActivityExecutor,
    ) -> Self {
        Self {
            programs,
            disturbances,
            chance: seed.map(Random::new),
            others,
            estimator: None,
            moments: Vec::new(),
            told: BTreeMap::new(),
            revision: None,
        }
    }

    /// Starts the program of an activity, which may change how the others under way will go.
    fn begin(
        &mut self,
        system: &Arc<System>,
        network: &Network,
        id: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow> {
        let active = self.activity(system, network, id, start)?;
        self.go_back(start);
        match self.moments.last_mut() {
            // Nothing runs: the steps are counted from here on.
            Some(moment) if moment.running.is_empty() && moment.waiting.is_empty() => {
                let resumed = Moment { time: start, waiting: vec![active], ..moment.clone() };
                self.moments.push(resumed);
            }
            Some(moment) => moment.waiting.push(active),
            None => {
                let random = self.chance.as_mut().map(|chance| Random::new(chance.next_bits()));
                let estimator = self.estimator.get_or_insert_with(|| Estimator::new(system, None));
                let closed = ClosedLoop::new(system, estimator, random);
                let (running, waiting) = (Vec::new(), vec![active]);
                self.moments.push(Moment { time: start, closed, running, waiting });
            }
        }
        self.run_on(network, start)?;
        let own = self.told.get(&id).cloned().unwrap_or_default();
        self.revision.as_mut().into_iter().for_each(|it| it.executions.retain(|(other, _)| *other != id));
        Ok(own)
    }

    fn activity(
        &self,
        system: &Arc<System>,
        network: &Network,
        id: OccurrenceId,
        start: Time,
    ) -> Result<Active, Overflow> {
        let occurrence = &network.occurrences[id.index()];
        let step = self.programs.step();
        let upper = occurrence.arc.and_then(|arc| network.arcs.get(arc.index())).map(|arc| arc.upper);
        let most_steps = match upper {
            // One step more than there is time for shows whether it would have ended later.
            Some(Bound::Finite(upper)) => {
                let steps = upper.checked_ratio(step).ok_or(Overflow)?.floor();
                steps.saturating_add(1).clamp(1, MAX_STEPS)
            }
            _ => MAX_STEPS,
        };
        let most = step.checked_mul(most_steps).ok_or(Overflow)?;
        Ok(Active {
            occurrence: id,
            name: occurrence.name.clone(),
            program: ProgramExecution::new(system),
            commanded: Arc::new(system.commanded()),
            started: start,
            given_up: start.checked_add(most).ok_or(Overflow)?,
        })
    }

    /// Drops everything that was planned after `now`.
    fn go_back(&mut self, now: Time) {
        let known = self.moments.partition_point(|moment| moment.time <= now);
        self.moments.truncate(known);
        let Some(moment) = self.moments.last() else { return };
        for active in moment.active() {
            if let Some(told) = self.told.get_mut(&active.occurrence) {
                told.ends = Ends::AsPlanned;
                told.entries.retain(|entry| entry.time <= now);
            }
        }
    }

    /// Runs all programs to their ends, or until none can end in time any more.
    fn run_on(&mut self, network: &Network, now: Time) -> Result<(), Overflow> {
        let first = self.moments.len().saturating_sub(1);
        let concerned: Vec<OccurrenceId> = self
            .moments
            .last()
            .into_iter()
            .flat_map(Moment::active)
            .map(|active| active.occurrence)
            .collect();
        while self.step()? {}
        let executions = concerned.iter().filter_map(|id| Some((*id, self.told.get(id)?.clone()))).collect();
        let readings = self.readings(network, first, now);
        self.revision = Some(Revision { executions, readings: Some(readings) });
        Ok(())
    }

    /// Takes one step. `false` if there is no one left to wait for.
    fn step(&mut self) -> Result<bool, Overflow> {
        let Some(last) = self.moments.last_mut() else { return Ok(false) };
        last.let_begin();
        let mut moment = last.clone();
        self.end_what_is_done(&mut moment)?;
        let is_awaited = |active: &Active| active.given_up > moment.time;
        if !moment.active().any(is_awaited) {
            // A program that ends at once has no step of its own.
            self.moments.pop();
            self.moments.push(moment);
            return Ok(false);
        }
        let time = moment.time.checked_add(self.programs.step()).ok_or(Overflow)?;
        let system = moment.running.first().map(|active| Arc::clone(&active.program.system));
        if let Some(system) = system {
            let estimator = self.estimator.get_or_insert_with(|| Estimator::new(&system, None));
            let input = faults(self.disturbances, &moment.running);
            let mut programs: Vec<&mut ProgramExecution> =
                moment.running.iter_mut().map(|active| &mut active.program).collect();
            let step = match moment.closed.step(&mut programs, estimator, &input) {
                Ok(step) => step,
                Err(error) => {
                    for active in &moment.running {
                        let number = active.program.steps + 1;
                        let reason = format!("step {number} of the program failed: {error}");
                        self.told.entry(active.occurrence).or_default().ends = Ends::Never(reason);
                    }
                    moment.time = moment.active().map(|active| active.given_up).max().unwrap_or(time);
                    self.give_up(&moment);
                    return Ok(false);
                }
            };
            for (active, chosen) in moment.running.iter().zip(&step.chosen) {
                let text = text(active, &step, chosen, &input);
                let happening = Happening::Progress { name: active.name.clone(), text };
                self.told.entry(active.occurrence).or_default().entries.push(Entry { time, happening });
            }
            let deadlock = moment
                .closed
                .deadlock()
                .map(|names| format!("locks of the programs wait for each other: {}", names.join(", ")));
            if let Some(reason) = unexplained(&system.model, &step.outcome).or(deadlock) {
                moment.time = time;
                self.end_unexplained(&mut moment, &reason);
                self.moments.push(moment);
                return Ok(false);
            }
        }
        moment.time = time;
        self.end_what_is_done(&mut moment)?;
        self.give_up(&moment);
        self.moments.push(moment);
        Ok(true)
    }

    /// Nothing is known of the plant any more: no program reaches its end.
    fn end_unexplained(&mut self, moment: &mut Moment, reason: &str) {
        for active in moment.active() {
            self.told.entry(active.occurrence).or_default().ends = Ends::Never(reason.to_owned());
        }
        moment.running.clear();
        moment.waiting.clear();
    }

    fn end_what_is_done(&mut self, moment: &mut Moment) -> Result<(), Overflow> {
        for active in moment.running.iter().filter(|active| active.program.stepper.is_done()) {
            let lasted = moment.time.checked_sub(active.started).ok_or(Overflow)?;
            self.told.entry(active.occurrence).or_default().ends = Ends::After(lasted);
        }
        moment.running.retain(|active| !active.program.stepper.is_done());
        moment.let_begin();
        Ok(())
    }

    /// Says of those whose time is over that they do not end in time. They continue commanding.
    fn give_up(&mut self, moment: &Moment) {
        for active in moment.active().filter(|active| active.given_up <= moment.time) {
            let told = self.told.entry(active.occurrence).or_default();
            if told.ends != Ends::AsPlanned {
                continue;
            }
            let holder = moment.holder(active).filter(|_| active.program.steps == 0);
            told.ends = Ends::Never(match holder {
                Some(holder) => format!("its program waits for that of {}, which has not ended", holder.name),
                None => {
                    format!("its program did not end within {}", exact::counted(active.program.steps, "step"))
                }
            });
        }
    }

    /// Returns how the modes that the mission reads are estimated to change after `now`, by moments from `first` on.
    fn readings(&self, network: &Network, first: usize, now: Time) -> Vec<PlantReading> {
        let variables = network.variables.iter();
        let read: Vec<(&SmolStr, &str)> =
            variables.filter_map(|variable| Some((&variable.name, variable.component()?))).collect();
        let mut readings = Vec::new();
        let moments = self.moments.get(first..).unwrap_or_default();
        for (at, pair) in (first..).zip(moments.windows(2)) {
            let [before, after] = pair else { continue };
            let Some(active) = before.active().next().filter(|_| after.time > now) else { continue };
            let model = &active.program.system.model;
            for &(variable, component) in &read {
                let Some(id) = model.component_named(component) else { continue };
                let mode = |moment: &Moment| moment.closed.belief().most_likely().mode(id);
                // Before the first step the mission takes each component by itself to be in its most likely mode.
                let initial = model.component(id).filter(|_| at == 0).map(|component| component.initial);
                if initial.unwrap_or_else(|| mode(before)) != mode(after) {
                    let value = SmolStr::new(model.mode_name(id, mode(after)));
                    readings.push(PlantReading { at: after.time, variable: variable.clone(), value });
                }
            }
        }
        readings
    }

    /// Programs of activities that are given up command nothing any more; the plant is as they had brought it by then.
    fn stop_programs(&mut self, network: &Network, of: &[OccurrenceId], now: Time) {
        let is_given_up = |active: &Active| of.contains(&active.occurrence);
        let known = self.moments.partition_point(|moment| moment.time <= now);
        let is_under_way = known
            .checked_sub(1)
            .and_then(|last| self.moments.get(last))
            .is_some_and(|moment| moment.active().any(is_given_up));
        if !is_under_way {
            return;
        }
        self.go_back(now);
        if let Some(moment) = self.moments.last_mut() {
            moment.running.retain(|active| !is_given_up(active));
            moment.waiting.retain(|active| !is_given_up(active));
        }
        // Times that do not fit are found out when the activities are started.
        let _ = self.run_on(network, now);
    }
}

impl ActivityExecutor for ProgramExecutor<'_> {
    fn start(
        &mut self,
        network: &Network,
        occurrence: OccurrenceId,
        start: Time,
    ) -> Result<ActivityExecution, Overflow> {
        let described = network.occurrences.get(occurrence.index());
        match described.and_then(|described| self.programs.system(described)).cloned() {
            Some(system) => self.begin(&system, network, occurrence, start),
            None => self.others.start(network, occurrence, start),
        }
    }

    fn whereabouts(&self, network: &Network, of: &[OccurrenceId], now: Time) -> Vec<(u32, [f64; 2])> {
        self.others.whereabouts(network, of, now)
    }

    fn abandon(&mut self, network: &Network, of: &[OccurrenceId], now: Time) {
        self.others.abandon(network, of, now);
        self.stop_programs(network, of, now);
    }

    fn contact(&self) -> Option<Contact> {
        self.others.contact()
    }

    fn revise(&mut self) -> Option<Revision> {
        match (self.revision.take(), self.others.revise()) {
            (Some(mut own), Some(others)) => {
                own.executions.extend(others.executions);
                Some(own)
            }
            (own, others) => own.or(others),
        }
    }

    fn granularity(&self) -> Time {
        let others = self.others.granularity();
        if self.programs.is_empty() {
            return others;
        }
        // A part too small to be kept is found out when the plan is made ready.
        self.programs.step().common_part(others).unwrap_or(others)
    }
}

/// Returns why no program continues after a step, if nothing explains what was observed in it.
fn unexplained(model: &Model, outcome: &StepOutcome) -> Option<String> {
    match outcome {
        StepOutcome::Explained => None,
        StepOutcome::Refuted { conflict } => {
            let observed = model.observation_names(conflict);
            let observed: Vec<String> =
                observed.iter().map(|(name, value)| format!("{name}={value}")).collect();
            Some(format!("no tracked state of the plant explains {}", observed.join(", ")))
        }
        StepOutcome::LimitReached => {
            Some("no tracked state of the plant explains the observations".to_owned())
        }
    }
}

/// The faults of the next step.
fn faults(disturbances: &[Disturbance], running: &[Active]) -> StepInput {
    let mut input = StepInput::default();
    for disturbance in disturbances {
        let Disturbance::Fault { activity, step, component, mode } = disturbance else { continue };
        let fits = |active: &&Active| active.name == *activity && *step == active.program.steps + 1;
        if let Some(active) = running.iter().find(fits)
            && let Some((component, mode)) = named(&active.program.system.model, component, mode)
        {
            input.injected.insert(component, mode);
        }
    }
    input
}

/// Returns what a step of a program did, in words: its commands, then what is found out.
fn text(active: &Active, step: &LoopStep, chosen: &[RewardChoice], input: &StepInput) -> String {
    let model: &Model = &active.program.system.model;
    let mut own = step.commands.clone();
    for (value, variable) in own.0.iter_mut().zip(&model.command_variables) {
        if !active.commanded.contains(&variable.component) {
            *value = 0;
        }
    }
    let commands = model.command_names(&own);
    let commands: Vec<String> = commands.iter().map(|(name, value)| format!("{name}.{value}")).collect();
    let commands = if commands.is_empty() { "no command".to_owned() } else { commands.join(", ") };
    let mut text = format!("step {}: {commands}", active.program.steps);
    for (&component, &mode) in &input.injected {
        let name = model.component(component).map_or("?", |component| component.name.as_str());
        let _ = write!(text, "; {name} goes to {}", model.mode_name(component, mode));
    }
    for made in chosen {
        let _ = write!(text, "; {}", made.describe());
    }
    let found: Vec<String> = step.conflicts.iter().map(|conflict| conflict.describe(model)).collect();
    if !found.is_empty() {
        let _ = write!(text, "; {}", found.join("; "));
    }
    text
}
