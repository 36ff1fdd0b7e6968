//! The model-based executive: a control program in a closed loop with a plant (SPEC 9.3).
//!
//! Each step asserts goals, commands the plant toward them, lets nature answer, observes, updates the belief, and
//! moves the automaton by what is entailed: by the most likely state, or from a probability on that the program names.

mod closed_loop;
mod conditions;
mod estimator;
mod goal;
mod liveness;
mod monte_carlo;
pub mod proof;
mod reward_choice;
mod run;
mod system;

pub use closed_loop::{AskedCondition, ClosedLoop, Knowledge, LoopStep, ProgramExecution};
pub use estimator::{Estimator, StepOutcome};
pub use liveness::waits_forever;
pub use monte_carlo::{FaultTally, ProgramTally, Trials, run_seed, sample, wilson_interval};
pub use reward_choice::RewardChoice;
pub use run::{Options, Run, RunStatus, StepInput, StepRecord};
pub use system::{ControlledPlant, System, SystemCompilation};
