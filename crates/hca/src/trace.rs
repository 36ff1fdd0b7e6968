//! A run of an automaton on given estimates, step by step.

use std::sync::Arc;

use exact::Rational;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::automaton::{Automaton, CompositeId, LocationId, TransitionId};
use crate::clock::ClockId;
use crate::knowledge::Estimate;
use crate::step::{StepObserver, Stepper};

/// What one step showed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TraceStep {
    /// The step's number, from 1.
    pub step: u32,
    /// The locations marked at its start.
    pub marked: Vec<LocationId>,
    /// The goals asserted, each once, in alphabetical order.
    pub goals: Vec<SmolStr>,
    /// The labels of the marked locations in alphabetical order.
    pub labels: Vec<SmolStr>,
    /// The composites that the estimate at its end preempted.
    pub preempted: Vec<CompositeId>,
    /// The transitions that fired at its end.
    pub fired: Vec<TransitionId>,
    /// The rewards that the marked locations count, and those of the alternatives that completed at its end.
    pub reward: Rational,
    /// The locks that are held at its start, by their names.
    pub locks: Vec<SmolStr>,
    /// The running clocks at its start, each with the number of steps after which it is up.
    pub clocks: Vec<(ClockId, u64)>,
    /// The clocks that were up at its end and did what they are for.
    pub elapsed: Vec<ClockId>,
    /// The sequences that moved on at its end, with the place of the child that had ended.
    pub continued: Vec<(CompositeId, usize)>,
}

impl StepObserver for TraceStep {
    fn preempted(&mut self, composite: CompositeId) {
        self.preempted.push(composite);
    }

    fn fired(&mut self, transition: TransitionId) {
        self.fired.push(transition);
    }

    fn continued(&mut self, sequence: CompositeId, child: usize) {
        self.continued.push((sequence, child));
    }

    fn elapsed(&mut self, clock: ClockId) {
        self.elapsed.push(clock);
    }

    fn earned(&mut self, reward: Rational) {
        self.reward = self.reward.checked_add(reward).unwrap_or(self.reward);
    }
}

impl TraceStep {
    /// Returns what is to be seen at the start of step `step`.
    pub fn at(stepper: &Stepper, step: u32) -> Self {
        let automaton = stepper.automaton();
        let marking = stepper.marking();
        Self {
            step,
            marked: marking.iter().collect(),
            goals: stepper.goals(),
            labels: automaton.labels(marking),
            clocks: stepper.running_clocks(),
            reward: automaton.reward(marking),
            locks: stepper.held_locks(),
            ..Self::default()
        }
    }
}

/// A run from the first step to the last.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trace {
    /// One entry per estimate used, and one for the marking after the last.
    pub steps: Vec<TraceStep>,
    /// Whether the program ended.
    pub terminated: bool,
}

/// Runs from the start until the program ends or the estimates are used up.
pub fn trace(automaton: &Arc<Automaton>, estimates: &[Estimate]) -> Trace {
    let mut stepper = Stepper::new(automaton);
    let mut trace = Trace::default();
    for estimate in estimates {
        if stepper.is_done() {
            break;
        }
        let mut step = TraceStep::at(&stepper, trace.steps.len() as u32 + 1);
        stepper.step_observed(std::slice::from_ref(estimate), &mut step);
        trace.steps.push(step);
    }
    trace.steps.push(TraceStep::at(&stepper, trace.steps.len() as u32 + 1));
    trace.terminated = stepper.is_done();
    trace
}
