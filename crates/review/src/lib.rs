//! The review of a mission: a checklist that is computed, each line with its status and the place that it leads to.
//!
//! A review says what a plan is and how much room it has; it decides nothing. Every figure belongs to one text, map and
//! seed, and [`content_hash`] names them: a review with another hash is stale. What counts as enough is in
//! [`FlightRules`].

mod alternatives;
pub mod board;
pub mod check;
mod checklist;
pub mod compare;
pub mod contradict;
mod demand_lines;
pub mod distances;
mod entry;
pub mod flight_rule;
mod former_record;
mod hash;
mod judge;
pub mod keys;
mod late_drives;
mod lines;
pub mod names;
mod overlaps;
mod place;
mod plan_lines;
pub mod record;
pub mod rules;
pub mod ruling;
pub mod schedule;
pub mod sealed;
pub mod seat;
pub mod since;
pub mod strict;
pub mod waivers;

pub use alternatives::{Alternative, Fate};
pub use board::{PlanStatus, Present, Standing, standing};
pub use check::{Check, Signature};
pub use checklist::{
    ChoiceReview, ConflictReview, EventReview, Line, LinkReview, ResourceReview, Review, Section, Status,
    TimeRange, TraverseReview,
};
pub use flight_rule::{Finding, MissionRule, Outcome, Stretch};
pub use hash::{content_hash, plan_hash};
pub use lines::review;
pub use record::Record;
pub use rules::{FlightRules, SuccessRate};
pub use since::{Since, since};
pub use waivers::{Waiver, WaiverState};

/// Name and version of this program, which files say that it wrote.
pub const PROGRAM: &str = concat!("Enroute ", env!("CARGO_PKG_VERSION"));

#[cfg(test)]
mod board_tests;
#[cfg(test)]
mod cheats;
#[cfg(test)]
mod five_missions;
#[cfg(test)]
mod mutations;
#[cfg(test)]
mod record_tests;
#[cfg(test)]
mod tests;
