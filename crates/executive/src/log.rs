//! What happened in a run, in order. A log with its mission, seed and disturbances replays exactly.

use exact::{Rational, Time};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// One thing that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// When, in mission units.
    pub time: Time,
    #[serde(flatten)]
    pub happening: Happening,
}

/// The kinds of things that happen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Happening {
    /// A named event of the plan.
    Executed { name: SmolStr },
    /// What an activity under way shows of itself, such as a step of its control program.
    Progress {
        name: SmolStr,
        /// What was done.
        text: String,
    },
    /// A variable that lasts changes (SPEC 10).
    State {
        /// Its name; that of a vehicle's place is `Rover1.at`.
        variable: SmolStr,
        /// The value from now on; absent while it is changing.
        value: Option<SmolStr>,
        /// The activity or assertion that changes it; absent if it is the world.
        by: Option<SmolStr>,
    },
    /// How far a resource is used changes (SPEC 11).
    Level {
        resource: SmolStr,
        /// The level of a reservoir; of another resource what is in use.
        level: Rational,
        /// The activity that takes or gives; absent if it is the world.
        by: Option<SmolStr>,
    },
    /// The plan can no longer be kept.
    Violation {
        /// The event that broke it.
        name: SmolStr,
        reason: String,
        /// Two vehicles touch.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        is_contact: bool,
    },
    /// A new plan was made from here.
    Replanned {
        /// The choices that changed, such as `D1 takes Carry(WEST) instead of Carry(EAST)`.
        changes: Vec<String>,
    },
    /// There is no plan from here: everything is stopped.
    Stopped { reason: String },
    /// The mission is over.
    Finished,
}

impl Happening {
    /// A change of the world's state for people: `Deploy#1 changes ARM`, then `ARM=OUT by Deploy#1`; `None` for anything
    /// else.
    pub fn state_words(&self) -> Option<String> {
        let who = |by: &Option<SmolStr>| by.clone().unwrap_or_else(|| "the world".into());
        match self {
            Self::State { variable, value: Some(value), by } => {
                Some(format!("{variable}={value} by {}", who(by)))
            }
            Self::State { variable, value: None, by } => Some(format!("{} changes {variable}", who(by))),
            Self::Level { resource, level, by } => {
                Some(format!("{resource}={} by {}", level.readable(), who(by)))
            }
            _ => None,
        }
    }
}

/// What parts a violation's reason into what was withdrawn and until when the plan needs it.
pub const NEEDED_UNTIL: &str = ", but the plan needs it until ";

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// The mission's last event happened.
    Finished,
    /// It had to be stopped.
    Stopped,
}
