//! The moments of a control run, from the run of a program with its plant or from a program alone.

use std::sync::Arc;

use executive::model_based::Run;
use hca::{Automaton, Estimate, Stepper, TraceStep, VariableId};
use link::control_run::{ControlProgram, Input, Moment, PlantMoment};

use crate::control::Control;

/// Returns what a control text comes to, for showing it.
pub(crate) fn control_program(control: &Control) -> ControlProgram {
    match control {
        Control::Bound(system) => ControlProgram::Bound {
            automaton: Arc::clone(&system.automaton),
            model: Arc::clone(&system.model),
        },
        Control::Unbound(automaton) => ControlProgram::Unbound(Arc::clone(automaton)),
        Control::Plant(model) => ControlProgram::Plant(Arc::clone(model)),
        Control::Nothing => ControlProgram::Broken,
    }
}

pub(crate) fn moment_of_run(run: &Run) -> Moment {
    let record = run.records().last().cloned();
    Moment {
        marking: run.marking().clone(),
        upcoming: run.upcoming(),
        taken: record.as_ref().map(|record| record.trace.clone()),
        plant: Some(PlantMoment {
            belief: run.belief().clone(),
            true_state: run.true_state().clone(),
            record,
            branches: run.records().len().checked_sub(1).and_then(|step| run.branches(step)),
            next_commands: None,
            unachievable: Vec::new(),
        }),
    }
}

/// The moments of a program without a plant; its steps take next to no time.
pub(crate) fn moments_of_automaton(automaton: &Arc<Automaton>, inputs: &[Input]) -> Vec<Moment> {
    let mut stepper = Stepper::new(automaton);
    let moment = |stepper: &Stepper, step: u32, taken: Option<TraceStep>| Moment {
        marking: stepper.marking().clone(),
        upcoming: TraceStep::at(stepper, step),
        taken,
        plant: None,
    };
    let mut moments = vec![moment(&stepper, 1, None)];
    for (input, step) in inputs.iter().zip(1..) {
        if stepper.is_done() {
            break;
        }
        let mut estimate = Estimate::unknown(automaton.variables.len());
        for (&variable, &value) in &input.known {
            estimate.set(VariableId(variable), Some(value));
        }
        let mut taken = TraceStep::at(&stepper, step);
        stepper.step_observed(&[estimate], &mut taken);
        moments.push(moment(&stepper, step + 1, Some(taken)));
    }
    moments
}
