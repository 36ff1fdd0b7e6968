//! What the core is asked, and what it answers; both cross to a worker as bytes.

use std::sync::Arc;

use rmpl::{Bound, Rational};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

use crate::snapshot::Snapshot;

/// Asks for a mission to be worked out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Request {
    /// Compile and plan this text; a later request supersedes an earlier one that is still under way.
    Update {
        /// Counts the edits of the text; every answer says which revision it belongs to.
        revision: u64,
        /// The whole text.
        source: Arc<str>,
        /// What to plan.
        goal: Goal,
        /// How to search.
        search: SearchKind,
        /// Seeds path planning.
        seed: u64,
        /// Whether to record the search for stepping through it.
        trace: bool,
    },
    /// Makes a map file available to `terrain "name"` declarations.
    ImportMap {
        /// The name that the declaration uses.
        name: SmolStr,
        /// The file.
        bytes: Vec<u8>,
    },
}

/// What is to be planned.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Goal {
    /// The first scenario of the file; without one, its last activity with bounds `[0,inf]`.
    #[default]
    Default,
    /// The scenario of this name.
    Scenario(SmolStr),
    /// An activity, with the bounds of its invocation.
    Activity {
        /// Its name.
        name: SmolStr,
        /// Least duration.
        lower: Rational,
        /// Greatest duration.
        upper: Bound,
    },
}

/// Which search plans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum SearchKind {
    /// The paper's search; its first plan is the canonical one.
    #[default]
    Chronological,
    /// Learns from conflicts and jumps back.
    ConflictDirected,
}

/// An answer of the core.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Response {
    /// The state of a revision; a revision is answered more than once as its stages complete.
    Snapshot(Arc<Snapshot>),
    /// A map file could not be read.
    MapRejected {
        /// The name it was to have.
        name: SmolStr,
        /// Why, for the person who chose the file.
        reason: String,
    },
}
