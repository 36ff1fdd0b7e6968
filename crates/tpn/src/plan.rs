//! A plan as data: what was selected, linked and ordered, and the window of every selected event.
//!
//! The planner makes it and the checker reads it; neither's code is here.

use exact::{Bound, Time};
use serde::{Deserialize, Serialize};

use crate::network::{DecisionId, LabelId};

/// A plan of a [`crate::Network`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The decisions that were reached and the alternative taken, in textual order.
    pub choices: Vec<Choice>,
    /// Whether each node is selected; indexed by node.
    pub selected_nodes: Vec<bool>,
    /// Whether each arc is selected; indexed by arc.
    pub selected_arcs: Vec<bool>,
    /// Which assertion carries each requirement, in textual order of the requirements.
    pub causal_links: Vec<CausalLink>,
    /// Every pair of conflicting selected intervals, the earlier first.
    pub conflict_order: Vec<Ordering>,
    /// The orderings that planning had to add, in the order they were added.
    pub orderings_added: Vec<Ordering>,
    /// The window of each node relative to the start; `None` if not selected. Indexed by node.
    pub windows: Vec<Option<Window>>,
}

/// A decision taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Choice {
    /// The decision.
    pub decision: DecisionId,
    /// The alternative, from 0.
    pub alternative: u32,
}

/// An assertion that contains a requirement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct CausalLink {
    /// The requirement.
    pub ask: LabelId,
    /// The assertion.
    pub tell: LabelId,
}

/// Two conflicting intervals, one before the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Ordering {
    /// Ends before `then` starts.
    pub first: LabelId,
    /// Starts after `first` has ended.
    pub then: LabelId,
}

/// When an event may happen, in time units from the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Window {
    /// At the earliest.
    pub earliest: Time,
    /// At the latest.
    pub latest: Bound,
}
