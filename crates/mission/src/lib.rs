//! The shared planning core: one mission from text to plan to paths, incrementally, as an immutable snapshot.
//!
//! The page's worker, the native window and the command line all run [`Core`]; panels and reports read [`snapshot::Snapshot`].
//! No planning, motion or language rules are here: this crate connects the crates that have them, and keeps each
//! stage's result so that an edit redoes only what it touched.

mod both_searches;
mod contradicting;
pub mod control;
mod core;
mod departures;
pub mod draws;
mod driving;
mod evaluated;
pub mod execution;
mod given_plan;
pub mod ground;
mod host;
mod listing;
pub mod meetings;
mod moments;
mod nature;
mod network_text;
pub mod planning;
mod program_chance;
pub mod program_executor;
mod program_proof;
pub mod programs;
mod proving;
mod reading;
pub mod repairs;
pub mod sampling;
mod saved_state;
pub mod separation;
mod sight;
mod simulation;
mod spots;
pub mod traverse;
mod world_index;

pub use self::core::Core;
pub use control::{Control, read_control};
pub use evaluated::{Compiled, Evaluated, Ground, Manner, Scenarios};
pub use ground::{FreeSpace, Grounds};
pub use host::CoreHost;
pub use program_chance::sample_program;
pub use reading::compile;
pub use saved_state::{Place, SavedState};
pub use traverse::Paths;
