//! What happened in a run, in order. A log with its mission, seed and disturbances replays exactly.

use exact::Time;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// When, in mission units.
    pub time: Time,
    /// What.
    #[serde(flatten)]
    pub happening: Happening,
}

/// The kinds of things that happen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Happening {
    /// A named event of the plan.
    Executed {
        /// Its name.
        name: SmolStr,
    },
    /// What an activity under way shows of itself, such as a step of its control program.
    Progress {
        /// The activity.
        name: SmolStr,
        /// What was done.
        text: String,
    },
    /// The plan can no longer be kept.
    Violation {
        /// The event that broke it.
        name: SmolStr,
        /// Why.
        reason: String,
    },
    /// A new plan was made from here.
    Replanned {
        /// The choices that changed, such as `D1 takes Carry(WEST) instead of Carry(EAST)`.
        changes: Vec<String>,
    },
    /// There is no plan from here: everything is stopped.
    Stopped {
        /// Why.
        reason: String,
    },
    /// The mission is over.
    Finished,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The mission's last event happened.
    Finished,
    /// It had to be stopped.
    Stopped,
}
