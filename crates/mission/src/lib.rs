//! The shared planning core: one mission from text to plan to paths, incrementally, as an immutable snapshot.
//!
//! The page's worker, the native window and the command line all run [`Core`]; panels and reports read [`Snapshot`].
//! No planning, motion or language rules are here: this crate connects the crates that have them, and keeps each
//! stage's result so that an edit redoes only what it touched.

pub mod both_searches;
pub mod compare;
pub mod content;
pub mod control;
pub mod control_run;
mod core;
pub mod departures;
mod driving;
pub mod execution;
pub mod geojson;
pub mod ground;
pub mod job;
pub mod json_text;
pub mod link;
pub mod listing;
pub mod meetings;
mod nature;
mod network_text;
pub mod path_growth;
pub mod paths_json;
pub mod planning;
pub mod problem;
pub mod program_chance;
pub mod program_executor;
pub mod programs;
mod reading;
pub mod repairs;
pub mod request;
pub mod review;
pub mod robustness;
pub mod sampling;
pub mod separation;
pub mod simulation;
pub mod snapshot;
pub mod standing;
pub mod traverse;
pub mod wire;
pub mod worth;

pub use self::core::{Core, CoreHost};
pub use both_searches::{BothSearches, Searched};
pub use content::{ContentKey, PartKeys};
pub use control::{Control, read_control};
pub use control_run::{ControlProgram, ControlRun, ControlStanding};
pub use execution::{Executed, Execution};
pub use ground::{ClearanceOverlay, FreeSpace, Grounds};
pub use job::{Job, JobId, Kind};
pub use kirk::Search as SearchKind;
pub use link::{Link, LinkEvent, News, Transport};
pub use path_growth::{GrowthStanding, PathGrowth, WantedPlanner};
pub use problem::{Problem, TextEdit, TextFix};
pub use program_chance::{ProgramChance, sample_program};
pub use reading::{compile, compile_scenarios};
pub use request::{Goal, Request, Response, Update};
pub use robustness::{Robustness, RobustnessSettings, Tally, Uncertainty};
pub use simulation::{DriveFrame, SimulatedDrive, SimulatedVehicle};
pub use snapshot::{
    Keyframe, Leg, MapKey, PathFigures, Planning, SeparationViolation, Snapshot, Stage, Timings, Traverse,
    Undrivable, VehicleMotion,
};
pub use traverse::Paths;
