//! What holds in all runs of a control program: what is asked, and what is found.

use std::sync::Arc;

use executive::model_based::Knowledge;
use executive::model_based::proof::Verdict;
use serde::{Deserialize, Serialize};

/// What is to be proven, and of which runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProofQuestion {
    /// The plant that a program without one of its own is bound to.
    pub plant: Option<Arc<str>>,
    /// Properties as texts; none for the checks that every program should pass.
    pub properties: Vec<String>,
    /// How often components fail at most in a run.
    pub faults: u32,
    pub knowledge: Knowledge,
    /// How many states are kept at most.
    pub states: usize,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProofAnswer {
    /// Each property with whether it holds.
    pub verdicts: Vec<(String, Verdict)>,
    pub states: usize,
    pub transitions: usize,
    /// The most steps that the shortest run to a state takes.
    pub depth: u32,
    /// Why not all states were explored, if that is so.
    pub stopped: Option<String>,
}
