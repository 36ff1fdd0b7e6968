//! One file per command: its flags and what it does with the core's answer.

pub mod check;
pub mod execute;
pub mod explain;
pub mod fmt;
pub mod import;
pub mod path;
pub mod plan;
pub mod simulate;
pub mod stn;
pub mod tpn;
pub mod verify;
