//! One run of the closed loop, step by step and back (SPEC 9.3).

use std::collections::BTreeMap;
use std::sync::Arc;

use exact::Rational;
use hca::{Marking, Standing, TraceStep};
use plant::{
    Commands, ComponentId, Conflict, EstimateError, FactoredBelief, Observation, Random, State, StepBranches,
    VariableId, step_branches,
};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use super::closed_loop::{AskedCondition, ClosedLoop, Knowledge, ProgramExecution};
use super::estimator::{Estimator, StepOutcome};
use super::reward_choice::RewardChoice;
use super::system::System;

/// How a run is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// How many states the belief of a group of components keeps at most; as many as the estimator allows if not said.
    pub most_states: Option<usize>,
    /// With a seed, components fail by chance with their probabilities; without, only what is injected fails.
    pub seed: Option<u64>,
    /// What the program knows of its plant.
    pub knowledge: Knowledge,
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
    /// The state that the commands were planned from, if that is not the most likely one of the belief before.
    pub planned_from: Option<State>,
    /// Goals that are not pursued, in the form `EngineA=Standby`, each with the reason.
    pub unachievable: Vec<(SmolStr, String)>,
    /// Components that chance brought into another mode than the commanded one, with that mode.
    pub failed: Vec<(ComponentId, u8)>,
    /// The plant's true state at the step's end.
    pub true_state: State,
    /// What was observed.
    pub observation: Observation,
    /// The belief at the step's end; where nothing explains the observation, the one before.
    pub belief: FactoredBelief,
    /// Whether the observation can be explained.
    pub outcome: StepOutcome,
    /// The choices by rewards that led into the step.
    pub chosen: Vec<RewardChoice>,
    /// What the automaton asked for at the step's end, if the program names a probability from which on it is entailed.
    pub asked: Vec<AskedCondition>,
    /// Whether limits kept the estimate's dropped measure from becoming small, or leave open whether something asked for is
    /// entailed.
    pub is_uncertain: bool,
    /// Which mode assumptions the observation contradicts, when not all went as expected.
    pub conflicts: Vec<Conflict>,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunStatus {
    /// It can take another step.
    Running,
    /// The program has ended.
    Ended,
    /// No trajectory of the plant explains what was observed.
    Refuted,
    /// The limit of states leaves open whether some trajectory explains what was observed.
    LimitReached,
    /// Locks of the program wait for each other for ever.
    Deadlock,
}

/// Where a run is before a step, to come back to.
#[derive(Clone, Debug)]
struct Before {
    program: Standing,
    chosen: Vec<RewardChoice>,
    closed: ClosedLoop,
}

/// A run. It owns what it runs, so that it can be kept and stepped on.
#[derive(Clone, Debug)]
pub struct Run {
    program: ProgramExecution,
    estimator: Estimator,
    closed: ClosedLoop,
    records: Vec<StepRecord>,
    before: Vec<Before>,
}

impl Run {
    /// Starts with the plant in its most likely first state or, with a seed, in one that is drawn.
    pub fn new(system: &Arc<System>, options: Options) -> Self {
        let estimator = Estimator::new(system, options.most_states);
        Self::with_estimator(system, options, estimator)
    }

    /// The same with an estimator that remembers what earlier runs asked.
    pub fn with_estimator(system: &Arc<System>, options: Options, mut estimator: Estimator) -> Self {
        let closed = ClosedLoop::new(system, &mut estimator, options.seed.map(Random::new));
        let mut closed = closed.with_knowledge(system, options.knowledge);
        let mut program = ProgramExecution::new(system);
        closed.settle(&mut [&mut program], &mut estimator);
        Self { closed, estimator, program, records: Vec::new(), before: Vec::new() }
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

    /// Returns what happened so far, one record per step.
    pub fn records(&self) -> &[StepRecord] {
        &self.records
    }

    /// The current marking.
    pub const fn marking(&self) -> &Marking {
        self.program.stepper.marking()
    }

    /// The current belief.
    pub const fn belief(&self) -> &FactoredBelief {
        self.closed.belief()
    }

    /// Returns what was believed before a step, from 0.
    pub fn belief_before(&self, step: usize) -> Option<&FactoredBelief> {
        self.before.get(step).map(|before| before.closed.belief())
    }

    /// Returns how what was believed before a step, from 0, became what is believed after it; `None` if there is no
    /// such step.
    pub fn branches(&self, step: usize) -> Option<StepBranches> {
        let record = self.records.get(step)?;
        let after = (record.outcome == StepOutcome::Explained).then_some(&record.belief);
        let model = self.estimator.planner().model();
        step_branches(model, self.belief_before(step)?, &record.commands, &record.observation, after).ok()
    }

    /// The plant's true state.
    pub const fn true_state(&self) -> &State {
        self.closed.true_state()
    }

    /// Returns whether the program has ended.
    pub fn is_done(&self) -> bool {
        self.program.stepper.is_done()
    }

    /// Returns how far the run is.
    pub fn status(&self) -> RunStatus {
        match self.closed.outcome() {
            StepOutcome::Refuted { .. } => RunStatus::Refuted,
            StepOutcome::LimitReached => RunStatus::LimitReached,
            StepOutcome::Explained if self.is_done() => RunStatus::Ended,
            StepOutcome::Explained if self.closed.deadlock().is_some() => RunStatus::Deadlock,
            StepOutcome::Explained => RunStatus::Running,
        }
    }

    /// The names of the locks that wait for each other for ever.
    pub fn deadlock(&self) -> &[SmolStr] {
        self.closed.deadlock().unwrap_or_default()
    }

    /// The sum of the rewards that were counted.
    pub fn reward(&self) -> Rational {
        let rewards = self.records.iter().map(|record| record.trace.reward);
        rewards.fold(Rational::ZERO, |sum, reward| sum.checked_add(reward).unwrap_or(sum))
    }

    /// Returns whether time alone may change what happens next.
    pub fn depends_on_time(&self) -> bool {
        self.program.stepper.depends_on_time()
    }

    /// The marked locations, goals and labels of the next step.
    pub fn upcoming(&self) -> TraceStep {
        self.program.upcoming()
    }

    /// Takes back the last step; false if there is none.
    pub fn step_back(&mut self) -> bool {
        let Some(before) = self.before.pop() else { return false };
        self.records.pop();
        self.program.stepper.return_to(&before.program);
        self.program.steps -= 1;
        self.program.chosen = before.chosen;
        self.closed = before.closed;
        true
    }

    /// Goes to the state before step `step` (from 1): back, or forward with nothing from outside.
    pub fn jump(&mut self, step: u32) -> Result<(), EstimateError> {
        while self.records.len() + 1 > step as usize && self.step_back() {}
        while self.records.len() + 1 < step as usize && self.status() == RunStatus::Running {
            self.step(&StepInput::default())?;
        }
        Ok(())
    }

    /// Takes one step. After an error the run stands where it stood.
    pub fn step(&mut self, input: &StepInput) -> Result<&StepRecord, EstimateError> {
        let (program, chosen) = (self.program.stepper.standing(), self.program.chosen.clone());
        let before = Before { program, chosen, closed: self.closed.clone() };
        let step = self.closed.step(&mut [&mut self.program], &mut self.estimator, input)?;
        self.before.push(before);
        // There is one trace for the one program.
        let trace = step.traces.into_iter().next().unwrap_or_else(|| self.upcoming());
        self.records.push(StepRecord {
            trace,
            input: input.clone(),
            commands: step.commands,
            planned_from: step.planned_from,
            unachievable: step.unachievable,
            failed: step.failed,
            true_state: self.closed.true_state().clone(),
            observation: step.observation,
            belief: self.closed.belief().clone(),
            outcome: step.outcome,
            // There is one entry for the one program.
            chosen: step.chosen.into_iter().next().unwrap_or_default(),
            asked: step.asked.into_iter().next().unwrap_or_default(),
            is_uncertain: step.is_uncertain,
            conflicts: step.conflicts,
        });
        Ok(&self.records[self.records.len() - 1])
    }

    /// Returns what the run has found out about its plant, for another run.
    pub fn into_estimator(self) -> Estimator {
        self.estimator
    }
}
