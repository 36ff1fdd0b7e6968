//! Many runs of a control program whose components fail by chance: what they are.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// What the runs are.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProgramChance {
    /// The plant that a program without one of its own is bound to.
    pub plant: Option<Arc<str>>,
    /// How many runs.
    pub runs: u64,
    pub seed: u64,
    /// A run that has not ended after so many steps has not reached its end.
    pub most_steps: u32,
    /// In every run, the modes that components are brought into, by step from 1 and by component.
    pub injected: BTreeMap<u32, BTreeMap<SmolStr, SmolStr>>,
}
