//! The closed loop of one step: goals, commands, what nature answers, what is observed, what is believed then (SPEC 9.3).
//!
//! What a program knows is what its estimate entails: in the most likely state or, where the program says so, with a
//! probability (SPEC3 17.4). One plant may be under several programs at once: each step commands it toward the goals of all of them, and all move on
//! by the same estimate.

use std::collections::BTreeMap;
use std::sync::Arc;

use hca::{ChosenBy, StepObserver, Stepper, TestId, TraceStep, locks};
use plant::{
    Commands, ComponentId, Conflict, EstimateError, FactoredBelief, Formula, Goal, Interval, Known,
    NextCommands, Observation, Random, SimulatedPlant, Situation, State, ValueSet, draw_initial, intended,
};
use serde::{Deserialize, Serialize};
use smol_str::{SmolStr, ToSmolStr as _};

use super::estimator::{BeliefUpdate, Believed, Estimator, StepOutcome, Threshold};
use super::reward_choice::RewardChoice;
use super::run::StepInput;
use super::system::System;

/// A program under way.
#[derive(Clone, Debug)]
pub struct ProgramExecution {
    /// The program with its plant.
    pub system: Arc<System>,
    pub stepper: Stepper,
    /// How many steps it has taken.
    pub steps: u32,
    /// The choices by rewards that were made since the last step.
    pub(super) chosen: Vec<RewardChoice>,
}

impl ProgramExecution {
    /// Starts a program.
    pub fn new(system: &Arc<System>) -> Self {
        let stepper = Stepper::undecided(&system.automaton);
        Self { system: Arc::clone(system), stepper, steps: 0, chosen: Vec::new() }
    }

    /// The marked locations, goals and labels of the next step.
    pub fn upcoming(&self) -> TraceStep {
        TraceStep::at(&self.stepper, self.steps + 1)
    }

    /// The conditions that the next step may ask for, in order, each with what the plant has to make true for it.
    pub(super) fn asked(&self) -> Vec<(TestId, Formula)> {
        let settings: Vec<_> = self.stepper.settings().collect();
        let condition = |test| (test, self.system.condition(test, settings.clone()));
        self.stepper.asked().into_iter().map(condition).collect()
    }

    /// Moves on by what is entailed of what was `asked`.
    pub(super) fn step(
        &mut self,
        asked: &[(TestId, Formula)],
        known: Known<'_>,
        observer: &mut impl StepObserver,
    ) -> Vec<AskedCondition> {
        let system = Arc::clone(&self.system);
        let mut situation = Situation::new(&system.model, known.belief.most_likely(), known.observation);
        // A condition is asked for with a bar and without.
        let mut answers: BTreeMap<&Formula, (bool, Option<Interval>)> = BTreeMap::new();
        let mut shown: Vec<AskedCondition> = Vec::new();
        let mut entailed = Vec::with_capacity(asked.len());
        for (test, condition) in asked {
            let answer = answers.entry(condition).or_insert_with(|| match &system.entailment {
                None => (situation.entails(condition), None),
                Some(entailed_from) => {
                    let probability = known.probability(condition);
                    (probability.low >= *entailed_from, Some(probability))
                }
            });
            entailed.push(answer.0);
            let is_of_plant = !known.groups_of(condition).is_empty();
            if let (Some(guard), (is_entailed, Some(probability)), true) =
                (system.automaton.guard(*test), answer, is_of_plant)
            {
                let condition = guard.constraint.to_smolstr();
                if shown.iter().all(|known| known.condition != condition) {
                    let (probability, is_entailed) = (probability.clone(), *is_entailed);
                    shown.push(AskedCondition { condition, probability, is_entailed });
                }
            }
        }
        let is_entailed = |test: TestId| {
            let place = asked.binary_search_by_key(&test, |(asked, _)| *asked);
            place.is_ok_and(|place| entailed[place])
        };
        self.stepper.step_told(&is_entailed, observer);
        shown
    }
}

/// A condition about its plant that a program asked for, and how probable it was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AskedCondition {
    /// As it is written in labels.
    pub condition: SmolStr,
    pub probability: Interval,
    /// Whether it is at least as probable as the program demands.
    pub is_entailed: bool,
}

/// What programs know of their plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knowledge {
    /// What is estimated from commands and observations.
    #[default]
    Estimated,
    /// The true modes of all components.
    Perfect,
}

/// A plant under control, with what is believed of it.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    plant: SimulatedPlant,
    knowledge: Knowledge,
    believed: Believed,
    /// What was observed in the last step.
    observation: Observation,
    /// How the last step came out: after one that is not explained there is no further one.
    outcome: StepOutcome,
    /// The locks that wait for each other for ever.
    deadlock: Option<Vec<SmolStr>>,
    random: Option<Random>,
}

/// What happened in one step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopStep {
    /// What each program did, in the order in which they were given.
    pub traces: Vec<TraceStep>,
    /// The commands given.
    pub commands: Commands,
    /// The state that they were planned from, if that is not the most likely one.
    pub planned_from: Option<State>,
    /// Goals that are not pursued, each with the reason.
    pub unachievable: Vec<(SmolStr, String)>,
    /// Components that chance brought into another mode than the commanded one, with that mode.
    pub failed: Vec<(ComponentId, u8)>,
    /// What was observed.
    pub observation: Observation,
    /// Whether the observation can be explained. If not, the programs stay where they were, and so does the belief.
    pub outcome: StepOutcome,
    /// The choices by rewards of each program that led into the step.
    pub chosen: Vec<Vec<RewardChoice>>,
    /// What each program asked for, if it names a probability from which on conditions are entailed.
    pub asked: Vec<Vec<AskedCondition>>,
    /// Whether limits kept the estimate's dropped measure from becoming small, or leave open whether something asked for is
    /// entailed.
    pub is_uncertain: bool,
    /// Which mode assumptions the observation contradicts.
    pub conflicts: Vec<Conflict>,
}

/// What the programs command in a step.
pub(super) struct Commanded {
    pub(super) commands: Commands,
    planned_from: Option<State>,
    unachievable: Vec<(SmolStr, String)>,
    /// Why goals contradict each other, if some do.
    pub(super) contradiction: Option<String>,
}

/// What the programs know after a step, and how they came to it.
pub(super) struct Learned {
    is_explained: bool,
    asked: Vec<Vec<AskedCondition>>,
    is_uncertain: bool,
    conflicts: Vec<Conflict>,
}

impl ClosedLoop {
    /// A plant in its most likely first state. With a source of chance the first state is drawn, and components fail with
    /// their probabilities.
    pub fn new(system: &System, estimator: &mut Estimator, mut random: Option<Random>) -> Self {
        let believed = estimator.initial();
        let likeliest = believed.belief.most_likely();
        let state = match &mut random {
            Some(random) => draw_initial(&system.model, likeliest, random),
            None => likeliest.clone(),
        };
        Self {
            plant: SimulatedPlant::new(&system.model, Some(state)),
            knowledge: Knowledge::Estimated,
            believed,
            observation: Observation::default(),
            outcome: StepOutcome::Explained,
            deadlock: None,
            random,
        }
    }

    /// The same plant, with programs that know this of it.
    #[must_use]
    pub fn with_knowledge(mut self, system: &System, knowledge: Knowledge) -> Self {
        self.knowledge = knowledge;
        if knowledge == Knowledge::Perfect {
            self.believed = Believed::certain(system, self.plant.state());
        }
        self
    }

    /// The same loop with the plant in another first state.
    #[must_use]
    pub(super) fn starting_in(mut self, system: &System, state: State) -> Self {
        self.plant = SimulatedPlant::new(&system.model, Some(state));
        self
    }

    /// The names of the locks that wait for each other for ever, if there are any after the last step.
    pub fn deadlock(&self) -> Option<&[SmolStr]> {
        self.deadlock.as_deref()
    }

    /// Makes the choices of the programs that have been started, by chance if there is any and by rewards, and sets aside the
    /// goals that contradict what is locked.
    pub fn settle(&mut self, programs: &mut [&mut ProgramExecution], estimator: &mut Estimator) {
        for program in programs.iter_mut() {
            while let Some(choice) = program.stepper.open_choice() {
                let alternative = match (&choice.by, &mut self.random) {
                    (ChosenBy::Chance(weights), Some(random)) => drawn(weights, random),
                    (ChosenBy::Chance(_), None) => choice.first_best(),
                    (ChosenBy::Reward(_), _) => {
                        let standing = program.stepper.standing();
                        let made = estimator.choose(&program.system, standing, &self.believed.belief);
                        let alternative = made.alternative;
                        program.chosen.push(made);
                        alternative
                    }
                };
                program.stepper.choose(alternative);
            }
        }
        Self::set_aside(programs);
    }

    /// Sets aside the goals of programs, all choices of which are made, that contradict what is locked.
    pub(super) fn set_aside(programs: &mut [&mut ProgramExecution]) {
        locks::set_aside(&mut steppers(programs));
    }

    /// The plant's true state.
    pub const fn true_state(&self) -> &State {
        self.plant.state()
    }

    /// Returns what the programs know of the plant.
    pub const fn knowledge(&self) -> Knowledge {
        self.knowledge
    }

    /// Returns what is believed; after a step that nothing explains, what was believed before.
    pub const fn belief(&self) -> &FactoredBelief {
        &self.believed.belief
    }

    /// Returns what was observed in the last step.
    pub(super) const fn observation(&self) -> &Observation {
        &self.observation
    }

    /// Whether the last step can be explained; if not, no further one is taken.
    pub const fn outcome(&self) -> &StepOutcome {
        &self.outcome
    }

    /// One step of all `programs`, of which there is at least one, with what comes from outside. After an error the plant
    /// and the programs stand where they stood.
    pub fn step(
        &mut self,
        programs: &mut [&mut ProgramExecution],
        estimator: &mut Estimator,
        input: &StepInput,
    ) -> Result<LoopStep, EstimateError> {
        let before = (self.plant.state().clone(), self.random.clone());
        let system = programs.first().map(|program| Arc::clone(&program.system));
        let Some(system) = system.filter(|_| self.outcome == StepOutcome::Explained) else {
            return Err(EstimateError::Unexplained);
        };
        let stepped = self.advance(&system, programs, estimator, input);
        if stepped.is_err() {
            self.plant = SimulatedPlant::new(&system.model, Some(before.0));
            self.random = before.1;
        }
        stepped
    }

    fn advance(
        &mut self,
        system: &System,
        programs: &mut [&mut ProgramExecution],
        estimator: &mut Estimator,
        input: &StepInput,
    ) -> Result<LoopStep, EstimateError> {
        self.settle(programs, estimator);
        let chosen = programs.iter_mut().map(|program| std::mem::take(&mut program.chosen)).collect();
        let mut traces: Vec<TraceStep> = programs.iter().map(|program| program.upcoming()).collect();
        let commanded = self.command(system, programs, estimator);
        let failed = self.answer(system, &commanded.commands, input)?;
        let mut observation = match &mut self.random {
            Some(random) => self.plant.observation_with_chance(random),
            None => self.plant.observation(),
        };
        observation.0.extend(&input.observed);
        let learned =
            self.learn(system, programs, estimator, &commanded.commands, observation, &mut traces)?;
        if learned.is_explained {
            self.settle(programs, estimator);
            self.note_deadlock(programs);
        }
        Ok(LoopStep {
            traces,
            commands: commanded.commands,
            planned_from: commanded.planned_from,
            unachievable: commanded.unachievable,
            failed,
            observation: self.observation.clone(),
            outcome: self.outcome.clone(),
            chosen,
            asked: learned.asked,
            is_uncertain: learned.is_uncertain,
            conflicts: learned.conflicts,
        })
    }

    /// Returns what the settled programs command from where they are.
    pub(super) fn command(
        &self,
        system: &System,
        programs: &[&mut ProgramExecution],
        estimator: &mut Estimator,
    ) -> Commanded {
        let planned_from = self.planning_state(system, programs);
        let state = planned_from.as_ref().unwrap_or_else(|| self.belief().most_likely());
        let (next, mut unachievable) = command(programs, estimator, state);
        let model = estimator.planner().model();
        let contradiction = next.unreachable.iter().find(|failed| failed.is_contradiction);
        let contradiction = contradiction.map(|failed| failed.reason.clone());
        let described = next.unreachable.into_iter();
        unachievable.extend(described.map(|failed| (failed.goal.describe(model).into(), failed.reason)));
        unachievable.sort();
        unachievable.dedup();
        Commanded { commands: next.commands, planned_from, unachievable, contradiction }
    }

    /// Lets the plant carry out commands. Returns the components that chance brought into another mode than the commanded one,
    /// with that mode.
    fn answer(
        &mut self,
        system: &System,
        commands: &Commands,
        input: &StepInput,
    ) -> Result<Vec<(ComponentId, u8)>, EstimateError> {
        let Some(random) = &mut self.random else {
            self.plant.step(commands, &input.injected)?;
            return Ok(Vec::new());
        };
        let ids = system.model.component_ids();
        let intended = ids.map(|id| intended(&system.model, id, self.plant.state(), commands));
        let intended = intended.collect::<Result<Vec<ValueSet>, _>>()?;
        self.plant.step_with_chance(commands, &input.injected, random)?;
        let state = self.plant.state();
        let is_chance = |id: &ComponentId| {
            let is_intended =
                intended.get(id.0 as usize).is_some_and(|modes| modes.contains(state.mode(*id)));
            !is_intended && !input.injected.contains_key(id)
        };
        let by_chance = system.model.component_ids().filter(is_chance);
        Ok(by_chance.map(|id| (id, state.mode(id))).collect())
    }

    /// Brings the plant into a state; an error if its modes contradict each other.
    pub(super) fn enter(&mut self, state: State) -> Result<(), EstimateError> {
        self.plant.enter_state(state)
    }

    /// Updates the belief by an observation, and moves the programs on by it. Choices that they reach stay open.
    pub(super) fn learn(
        &mut self,
        system: &System,
        programs: &mut [&mut ProgramExecution],
        estimator: &mut Estimator,
        commands: &Commands,
        observation: Observation,
        observers: &mut [impl StepObserver],
    ) -> Result<Learned, EstimateError> {
        let asked: Vec<Vec<(TestId, Formula)>> = programs.iter().map(|program| program.asked()).collect();
        let update = match self.knowledge {
            Knowledge::Perfect => BeliefUpdate::certain(system, &self.believed, self.plant.state()),
            Knowledge::Estimated => {
                let thresholds: Vec<Threshold<'_>> = programs
                    .iter()
                    .zip(&asked)
                    .filter_map(|(program, asked)| Some((program.system.entailment.as_ref()?, asked)))
                    .flat_map(|(entailed_from, asked)| {
                        asked.iter().map(move |(_, condition)| Threshold { condition, entailed_from })
                    })
                    .collect();
                estimator.estimate(&self.believed, commands, &observation, &thresholds)?
            }
        };
        let is_explained = update.believed.is_some();
        self.outcome = update.outcome;
        if let Some(believed) = update.believed {
            self.believed = believed;
        }
        self.observation = observation;
        let known = self.known(system);
        let mut shown = vec![Vec::new(); programs.len()];
        for (at, (program, observer)) in programs.iter_mut().zip(observers).enumerate() {
            // Under a refuted belief no guard holds, and no goal is achieved.
            if is_explained {
                shown[at] = program.step(&asked[at], known, observer);
            }
            program.steps += 1;
        }
        if is_explained {
            locks::grant(&mut steppers(programs));
        }
        let (is_uncertain, conflicts) = (update.is_uncertain, update.conflicts);
        Ok(Learned { is_explained, asked: shown, is_uncertain, conflicts })
    }

    /// Finds out whether locks of the settled programs wait for each other.
    pub(super) fn note_deadlock(&mut self, programs: &mut [&mut ProgramExecution]) {
        self.deadlock = locks::deadlock(&steppers(programs));
    }

    fn known<'known>(&'known self, system: &'known System) -> Known<'known> {
        Known { groups: &system.groups, belief: self.belief(), observation: &self.observation }
    }

    /// The state that commands are planned from, if it is not the most likely one: where that satisfies goals that are not
    /// entailed, it is the most likely state that does not satisfy one of them.
    fn planning_state(&self, system: &System, programs: &[&mut ProgramExecution]) -> Option<State> {
        let known = self.known(system);
        let mut satisfied = Vec::new();
        for program in programs {
            let Some(entailed_from) = &program.system.entailment else { continue };
            let settings: Vec<_> = program.stepper.settings().collect();
            let marked = program.stepper.marking().iter();
            let marked = marked.filter(|location| !program.stepper.aside().contains(*location));
            let marked = marked.filter_map(|location| program.system.automaton.location(location));
            for goal in marked.filter_map(|location| location.assertion.as_ref()) {
                let goal = program.system.condition(goal.test, settings.clone());
                let mut likeliest =
                    Situation::new(&system.model, known.belief.most_likely(), known.observation);
                if likeliest.entails(&goal) && known.probability(&goal).low < *entailed_from {
                    satisfied.push(goal);
                }
            }
        }
        known.likeliest_without(&system.model, &satisfied)
    }
}

fn steppers<'programs>(programs: &'programs mut [&mut ProgramExecution]) -> Vec<&'programs mut Stepper> {
    programs.iter_mut().map(|program| &mut program.stepper).collect()
}

/// One of the alternatives, each with its probability.
fn drawn(weights: &[u64], random: &mut Random) -> usize {
    let mut left = random.below(weights.iter().sum());
    let is_it = |weight: &u64| {
        let is_it = left < *weight;
        left = left.saturating_sub(*weight);
        is_it
    };
    weights.iter().position(is_it).unwrap_or(0)
}

/// The commands from a state toward the goals of the marked locations, and the goals that no mode makes true.
pub(super) fn command(
    programs: &[&mut ProgramExecution],
    estimator: &mut Estimator,
    state: &State,
) -> (NextCommands, Vec<(SmolStr, String)>) {
    let mut goals: Vec<Goal> = Vec::new();
    let mut unachievable: Vec<(SmolStr, String)> = Vec::new();
    for program in programs {
        let system = &program.system;
        let marked = program.stepper.marking().iter();
        for location in marked.filter(|location| !program.stepper.aside().contains(*location)) {
            let Some(configurations) = system.goal_configurations(location) else { continue };
            if let Some(found) = configurations.goals(estimator.planner(), state) {
                goals.extend(found);
            } else {
                let label = system.automaton.location(location).map(|location| location.label.clone());
                let label = label.unwrap_or_default();
                let goal = SmolStr::new(label.trim_start_matches("assert "));
                unachievable.push((goal, "no mode of the plant makes it true".into()));
            }
        }
    }
    goals.sort_unstable();
    goals.dedup();
    (estimator.plan(state, &goals), unachievable)
}
