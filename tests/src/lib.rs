//! What the tests of the crates together share: missions from texts, an exhaustive reference planner, random missions.

pub mod distances;
pub mod mission;
pub mod random;
pub mod reference;
