//! The closed loop of one step: goals, commands, what nature answers, what is observed, what is believed then (SPEC 9.3).
//!
//! One plant may be under several programs at once: each step commands it towards the goals of all of them, and all move on
//! by the same estimate.

use std::sync::Arc;

use hca::{Stepper, TraceStep};
use plant::successor::nominal;
use plant::{
    Commands, ComponentId, Conflict, EstimateError, FactoredBelief, Goal, Observation, Random,
    SimulatedPlant, State,
};
use smol_str::SmolStr;

use super::estimator::{Believed, Estimator, StepOutcome};
use super::run::{Knowledge, StepInput};
use super::system::System;

/// A program under way.
#[derive(Clone, Debug)]
pub struct ProgramExecution {
    /// The program with its plant.
    pub system: Arc<System>,
    /// Where it stands.
    pub stepper: Stepper,
    /// How many steps it has taken.
    pub steps: u32,
}

impl ProgramExecution {
    /// Starts a program.
    pub fn new(system: &Arc<System>) -> Self {
        Self { system: Arc::clone(system), stepper: Stepper::new(&system.automaton), steps: 0 }
    }

    /// The marked locations, goals and labels of the next step.
    pub fn upcoming(&self) -> TraceStep {
        TraceStep::at(&self.stepper, self.steps + 1)
    }
}

/// A plant under control, with what is believed of it.
#[derive(Clone, Debug)]
pub struct ClosedLoop {
    plant: SimulatedPlant,
    believed: Believed,
    /// How the last step came out: after one that is not explained there is no further one.
    outcome: StepOutcome,
    random: Option<Random>,
    knowledge: Knowledge,
}

/// What happened in one step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoopStep {
    /// What each program did, in the order in which they were given.
    pub traces: Vec<TraceStep>,
    /// The commands given.
    pub commands: Commands,
    /// Goals that are not pursued, each with the reason.
    pub unachievable: Vec<(SmolStr, String)>,
    /// Components that chance brought into another mode than the commanded one, with that mode.
    pub failed: Vec<(ComponentId, u8)>,
    /// What was observed.
    pub observation: Observation,
    /// Whether the observation can be explained. If not, the programs stay where they were, and so does the belief.
    pub outcome: StepOutcome,
    /// Whether the limit of states kept the estimate's dropped measure from becoming small.
    pub is_uncertain: bool,
    /// Which mode assumptions the observation contradicts.
    pub conflicts: Vec<Conflict>,
}

impl ClosedLoop {
    /// A plant in its initial state, which is known. With a source of chance components fail with their probabilities.
    pub fn new(system: &System, knowledge: Knowledge, random: Option<Random>) -> Self {
        Self {
            plant: SimulatedPlant::new(&system.model, None),
            believed: Believed::certain(&system.groups, &system.model.initial_state()),
            outcome: StepOutcome::Explained,
            random,
            knowledge,
        }
    }

    /// The plant's true state.
    pub const fn true_state(&self) -> &State {
        self.plant.state()
    }

    /// What is believed; after a step that nothing explains, what was believed before.
    pub const fn belief(&self) -> &FactoredBelief {
        &self.believed.belief
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
        let mut traces: Vec<TraceStep> = programs.iter().map(|program| program.upcoming()).collect();
        let (commands, unachievable) = self.command(programs, estimator);
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
        let update = estimator.estimate(&self.believed, &commands, &observation)?;
        let is_explained = update.believed.is_some();
        self.outcome = update.outcome;
        if let Some(believed) = update.believed {
            self.believed = believed;
        }
        let most = match self.knowledge {
            Knowledge::MostLikely => 1,
            Knowledge::CommonTo(most) => most.max(1),
        };
        for (program, trace) in programs.iter_mut().zip(&mut traces) {
            // Under a refuted belief no guard holds, and no goal is achieved.
            if is_explained {
                let likely = self.likely_states(most);
                let estimates: Vec<hca::Estimate> =
                    likely.iter().map(|state| program.system.estimate(state, &observation)).collect();
                program.stepper.step_observed(&estimates, trace);
            }
            program.steps += 1;
        }
        Ok(LoopStep {
            traces,
            commands,
            unachievable,
            failed,
            observation,
            outcome: self.outcome.clone(),
            is_uncertain: update.is_uncertain,
            conflicts: update.conflicts,
        })
    }

    /// The `most` most likely states.
    fn likely_states(&self, most: usize) -> Vec<State> {
        if most == 1 {
            return vec![self.belief().most_likely().clone()];
        }
        self.belief().states().take(most).map(|(state, _)| state).collect()
    }

    /// The commands towards the goals of the marked locations, from the most likely state.
    fn command(
        &self,
        programs: &[&mut ProgramExecution],
        estimator: &mut Estimator,
    ) -> (Commands, Vec<(SmolStr, String)>) {
        let state = self.belief().most_likely();
        let mut goals: Vec<Goal> = Vec::new();
        let mut unachievable: Vec<(SmolStr, String)> = Vec::new();
        for program in programs {
            let system = &program.system;
            for location in program.stepper.marking().iter() {
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
        let next = estimator.plan(state, &goals);
        let model = estimator.planner().model();
        let described =
            next.unreachable.iter().map(|failed| (failed.goal.describe(model).into(), failed.reason.clone()));
        unachievable.extend(described);
        unachievable.sort();
        unachievable.dedup();
        (next.commands, unachievable)
    }
}
