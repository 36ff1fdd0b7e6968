//! Plan dispatch, replanning, the model-based executive loop and the simulated world.
//!
//! Nothing here reads a clock: time is the mission's, exact, and moves from event to event.

pub mod activity_execution;
mod adversary;
mod arrivals;
mod dispatch;
pub mod facts;
mod instants;
pub mod log;
pub mod model_based;
pub mod pinned;
pub mod plan_network;
pub mod progress;
pub mod run;
pub mod stage;
pub mod strategy;
pub mod world;
mod world_state;

pub use activity_execution::{
    ActivityExecution, ActivityExecutor, AsPlanned, Contact, Ends, PlantReading, Revision,
};
pub use facts::Facts;
pub use log::{Ending, Entry, Happening, NEEDED_UNTIL};
pub use pinned::PinnedPlan;
pub use plan_network::{PlanError, PlanNetwork};
pub use progress::{Observations, Progress, Waiting, progress};
pub use run::{Replanner, RunOutcome, run, run_stage};
pub use stage::{ExecutedPlan, Stage, executed_network, without_vertex_deadlines};
pub use strategy::{Act, Actor, Course, Strategy, UnderWay};
pub use world::{Disturbance, Script, World, WorldChange};
