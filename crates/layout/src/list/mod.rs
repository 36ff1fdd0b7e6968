//! Display lists of drawings: each kind of drawing is built here, and nowhere else.
//!
//! What changes with the pointer or with time is a list of its own, thin, that is laid over the drawing's.

pub mod automaton;
pub mod machine;
pub mod map;
pub mod network;
pub mod network_before;
pub mod timeline;
