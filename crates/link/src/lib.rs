//! The connection of a front end with the core that plans its mission: requests and answers as data, jobs and their queue, the
//! rules by which a job replaces another, and the bytes that travel.
//!
//! No thread, worker or clock is here: a [`Transport`] has them.

pub mod both_searches;
pub mod control_run;
pub mod job;
mod link;
pub mod path_growth;
mod program_chance;
mod program_proof;
pub mod request;
mod source;
pub mod wire;

pub use self::link::{Link, LinkEvent, News, Transport};
pub use both_searches::{BothSearches, Searched};
pub use control_run::{ControlProgram, ControlRun, ControlStanding};
pub use job::{Job, JobId, Kind};
pub use path_growth::{GrowthStanding, PathGrowth, WantedPlanner};
pub use program_chance::ProgramChance;
pub use program_proof::{ProofAnswer, ProofQuestion};
pub use request::{Request, Response, Update};
pub use source::{Since, Source};
