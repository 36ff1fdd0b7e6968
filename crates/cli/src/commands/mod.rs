//! One file per command: its flags and what it does with the core's answer.

pub mod check;
pub mod explain;
pub mod path;
pub mod plan;
pub mod stn;
