//! What the tests of the crates together share: the conformance cases, missions from texts, an exhaustive reference
//! planner, random missions.

pub mod cases;
pub mod distances;
pub mod mission;
pub mod random;
pub mod reference;
