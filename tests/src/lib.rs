//! What the tests of the crates together share: the conformance cases, missions from texts, exhaustive reference planners,
//! random missions.

pub mod cases;
pub mod distances;
pub mod lasting;
pub mod lasting_missions;
pub mod mission;
pub mod missions;
pub mod random;
pub mod reference;
