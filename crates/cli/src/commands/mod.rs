//! One file per command: its flags and what it does with the core's answer.

pub mod check;
pub mod compare;
pub mod contradict;
pub mod estimate;
pub mod execute;
pub mod explain;
pub mod export;
pub mod fmt;
pub mod hca;
pub mod held_rules;
pub mod import;
mod import_models;
pub mod path;
pub mod plan;
pub mod prove;
mod prove_rules;
pub mod reconfigure;
pub mod report;
pub mod review;
pub mod robustness;
pub mod run;
pub mod schema;
pub mod simulate;
pub mod step;
pub mod stn;
pub mod tpn;
pub mod verify;
