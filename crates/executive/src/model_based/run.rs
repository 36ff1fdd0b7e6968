//! One run of the closed loop, step by step and back (SPEC 9.3).

use std::collections::BTreeMap;
use std::sync::Arc;

use hca::{Marking, Stepper, TraceStep};
use plant::successor::nominal;
use plant::{
    Belief, Commands, ComponentId, Conflict, EstimateError, Goal, Observation, Random, SimulatedPlant, State,
    VariableId,
};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use super::estimator::{Estimation, Estimator};
use super::system::System;

/// What the automaton takes for known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Knowledge {
    /// The most likely state.
    #[default]
    MostLikely,
    /// What is true in all of this many of the most likely states.
    CommonTo(usize),
}

/// How a run is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// What the automaton takes for known.
    pub knowledge: Knowledge,
    /// How the belief is kept; chosen by the model's size if not said.
    pub estimation: Option<Estimation>,
    /// With a seed, components fail by chance with their probabilities; without, only what is injected fails.
    pub seed: Option<u64>,
}

/// What comes from outside in one step. The inputs of a run's steps are its log: they replay it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepInput {
    /// Components that are in the given modes after this step, whatever is commanded.
    pub injected: BTreeMap<ComponentId, u8>,
    /// Observations to make instead of what the plant shows.
    pub observed: BTreeMap<VariableId, u8>,
}

/// What happened in one step.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Marked locations, goals and labels at the step's start, and what the automaton did at its end.
    pub trace: TraceStep,
    /// What came from outside.
    pub input: StepInput,
    /// The commands given.
    pub commands: Commands,
    /// Goals that are not pursued, in the form `EngineA=Standby`, each with the reason.
    pub unachievable: Vec<(SmolStr, String)>,
    /// Components that chance brought into another mode than the commanded one, with that mode.
    pub failed: Vec<(ComponentId, u8)>,
    /// The plant's true state at the step's end.
    pub true_state: State,
    /// What was observed.
    pub observation: Observation,
    /// The belief at the step's end.
    pub belief: Belief,
    /// Whether nothing that was believed possible explains the observation, which was then left out of account.
    pub is_unexplained: bool,
    /// Which mode assumptions the observation contradicts, when not all went as expected.
    pub conflicts: Vec<Conflict>,
}

/// Where a run stands before a step, to come back to.
#[derive(Clone, Debug)]
struct Standing {
    marking: Marking,
    belief: Belief,
    state: State,
    random: Option<Random>,
}

/// A run. It owns what it runs, so that it can be kept and stepped on.
#[derive(Clone, Debug)]
pub struct Run {
    system: Arc<System>,
    options: Options,
    estimator: Estimator,
    stepper: Stepper,
    plant: SimulatedPlant,
    belief: Belief,
    random: Option<Random>,
    records: Vec<StepRecord>,
    before: Vec<Standing>,
}

impl Run {
    /// Starts with the plant in its initial state, which is known.
    pub fn new(system: &Arc<System>, options: Options) -> Self {
        let estimation = options.estimation.unwrap_or_else(|| Estimation::for_model(&system.model));
        let estimator = Estimator::new(Arc::clone(&system.planner), estimation);
        Self::with_estimator(system, options, estimator)
    }

    /// The same with an estimator that remembers what earlier runs asked.
    pub fn with_estimator(system: &Arc<System>, options: Options, estimator: Estimator) -> Self {
        Self {
            options,
            estimator,
            stepper: Stepper::new(&system.automaton),
            plant: SimulatedPlant::new(&system.model, None),
            belief: Belief::certain(system.model.initial_state()),
            random: options.seed.map(Random::new),
            records: Vec::new(),
            before: Vec::new(),
            system: Arc::clone(system),
        }
    }

    /// Starts with the plant as an earlier run left it, and with what was believed then.
    pub fn resumed(
        system: &Arc<System>,
        options: Options,
        estimator: Estimator,
        state: State,
        belief: Belief,
    ) -> Self {
        let mut run = Self::with_estimator(system, options, estimator);
        run.plant = SimulatedPlant::new(&system.model, Some(state));
        run.belief = belief;
        run
    }

    /// Runs again what was logged.
    pub fn replay(system: &Arc<System>, options: Options, log: &[StepInput]) -> Result<Self, EstimateError> {
        let mut run = Self::new(system, options);
        for input in log {
            run.step(input)?;
        }
        Ok(run)
    }

    /// The inputs of all steps so far.
    pub fn log(&self) -> Vec<StepInput> {
        self.records.iter().map(|record| record.input.clone()).collect()
    }

    /// What happened so far, one record per step.
    pub fn records(&self) -> &[StepRecord] {
        &self.records
    }

    /// The current marking.
    pub const fn marking(&self) -> &Marking {
        self.stepper.marking()
    }

    /// The current belief.
    pub const fn belief(&self) -> &Belief {
        &self.belief
    }

    /// The plant's true state.
    pub const fn true_state(&self) -> &State {
        self.plant.state()
    }

    /// Whether the program has ended.
    pub fn is_done(&self) -> bool {
        self.stepper.is_done()
    }

    /// The marked locations, goals and labels of the next step.
    pub fn upcoming(&self) -> TraceStep {
        TraceStep::at(&self.stepper, self.records.len() as u32 + 1)
    }

    /// Takes back the last step; false if there is none.
    pub fn step_back(&mut self) -> bool {
        let Some(standing) = self.before.pop() else { return false };
        self.records.pop();
        self.stepper.set_marking(&standing.marking);
        self.belief = standing.belief;
        self.plant = SimulatedPlant::new(&self.system.model, Some(standing.state));
        self.random = standing.random;
        true
    }

    /// Goes to the state before step `step` (from 1): back, or forward with nothing from outside.
    pub fn jump(&mut self, step: u32) -> Result<(), EstimateError> {
        while self.records.len() + 1 > step as usize && self.step_back() {}
        while self.records.len() + 1 < step as usize && !self.is_done() {
            self.step(&StepInput::default())?;
        }
        Ok(())
    }

    /// Takes one step. After an error the run stands where it stood.
    pub fn step(&mut self, input: &StepInput) -> Result<&StepRecord, EstimateError> {
        let standing = Standing {
            marking: self.stepper.marking().clone(),
            belief: self.belief.clone(),
            state: self.plant.state().clone(),
            random: self.random.clone(),
        };
        match self.advance(input) {
            Ok(record) => {
                self.before.push(standing);
                self.records.push(record);
                Ok(&self.records[self.records.len() - 1])
            }
            Err(error) => {
                self.plant = SimulatedPlant::new(&self.system.model, Some(standing.state));
                self.random = standing.random;
                Err(error)
            }
        }
    }

    fn advance(&mut self, input: &StepInput) -> Result<StepRecord, EstimateError> {
        let system = Arc::clone(&self.system);
        let mut trace = self.upcoming();
        let (commands, unachievable) = self.command();
        let mut failed = Vec::new();
        match &mut self.random {
            Some(random) => {
                let expected = nominal(&system.model, self.plant.state(), &commands)?;
                self.plant.step_with_chance(&commands, &input.injected, random)?;
                let state = self.plant.state();
                let is_chance = |id: &ComponentId| {
                    state.mode(*id) != expected.mode(*id) && !input.injected.contains_key(id)
                };
                let by_chance = system.model.component_ids().filter(is_chance);
                failed.extend(by_chance.map(|id| (id, state.mode(id))));
            }
            None => self.plant.step(&commands, &input.injected)?,
        }
        let mut observation = self.plant.observation();
        observation.0.extend(&input.observed);
        let update = self.estimator.estimate(&self.belief, &commands, &observation)?;
        self.belief = update.belief.clone();
        let most = match self.options.knowledge {
            Knowledge::MostLikely => 1,
            Knowledge::CommonTo(most) => most.max(1),
        };
        let shown = if update.is_unexplained { Observation::default() } else { observation.clone() };
        let estimates: Vec<hca::Estimate> =
            self.belief.states().take(most).map(|(state, _)| system.estimate(state, &shown)).collect();
        self.stepper.step_observed(&estimates, &mut trace);
        Ok(StepRecord {
            trace,
            input: input.clone(),
            commands,
            unachievable,
            failed,
            true_state: self.plant.state().clone(),
            observation,
            belief: update.belief,
            is_unexplained: update.is_unexplained,
            conflicts: update.conflicts,
        })
    }

    /// The commands towards the goals of the marked locations, from the most likely state.
    fn command(&mut self) -> (Commands, Vec<(SmolStr, String)>) {
        let system = Arc::clone(&self.system);
        let state = self.belief.most_likely().clone();
        let mut goals: Vec<Goal> = Vec::new();
        let mut unachievable: Vec<(SmolStr, String)> = Vec::new();
        for location in self.stepper.marking().iter() {
            let Some(configurations) = system.goal_configurations(location) else { continue };
            if let Some(found) = configurations.goals(self.estimator.planner(), &state) {
                goals.extend(found);
            } else {
                let label = system
                    .automaton
                    .location(location)
                    .map(|location| location.label.clone())
                    .unwrap_or_default();
                let goal = SmolStr::new(label.trim_start_matches("assert "));
                unachievable.push((goal, "no mode of the plant makes it true".into()));
            }
        }
        goals.sort_unstable();
        goals.dedup();
        let next = self.estimator.plan(&state, &goals);
        let described = next
            .unreachable
            .iter()
            .map(|failed| (failed.goal.describe(&system.model).into(), failed.reason.clone()));
        unachievable.extend(described);
        unachievable.sort();
        unachievable.dedup();
        (next.commands, unachievable)
    }

    /// What the run has found out about its plant, for another run.
    pub fn into_estimator(self) -> Estimator {
        self.estimator
    }
}
