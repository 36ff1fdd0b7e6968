//! What is known of a mission, as immutable data that panels, reports and reviews read: the program, its network, plans,
//! paths, runs, and how robust a plan is.
//!
//! The planning core makes it; nothing here plans, and nothing here asks.

pub mod blocked;
pub mod content;
mod drive;
mod execution;
mod goal;
pub mod ground;
pub mod json_text;
pub mod paths_json;
pub mod problem;
pub mod robustness;
mod snapshot;
pub mod standing;
pub mod vehicle;

pub use self::snapshot::{
    Keyframe, LeftOut, Leg, MapKey, MovementTimes, PathFigures, Planning, SeparationViolation, Snapshot,
    Stage, Timings, Traverse, Undrivable, VehicleMotion, joined,
};
pub use content::{ContentKey, PartKeys};
pub use drive::{DriveFrame, SimulatedDrive, SimulatedVehicle};
pub use execution::{Commanded, Executed, Execution};
pub use goal::Goal;
pub use problem::{Problem, TextEdit, TextFix};
pub use robustness::{Robustness, RobustnessSettings, Tally, Uncertainty};
