//! Flight rules of a mission as data, and what is found of them.

use exact::{Bound, Time};
use serde::{Deserialize, Serialize};
use tpn::NodeId;

/// A flight rule of a mission.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionRule {
    /// What it is called.
    pub name: String,
    /// What it says: see [`rmpl::rule`].
    pub rule: String,
    /// Where it comes from, such as a paragraph of the flight rules; may be empty.
    #[serde(default)]
    pub source: String,
    /// Whether someone may acknowledge that a plan breaks it; otherwise such a plan has failed.
    #[serde(default)]
    pub waivable: bool,
}

/// What was found of a rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What the rule says.
    pub rule: String,
    /// How the plan stands to it.
    pub outcome: Outcome,
    /// The times at which some execution is held against it.
    pub applies: Vec<Stretch>,
    /// The times at which some execution breaks it.
    pub breaks: Vec<Stretch>,
    /// The times at which it is not known to hold in every execution, those of `breaks` among them.
    pub open: Vec<Stretch>,
    /// The events between which that is, by name.
    pub names: Vec<String>,
    pub nodes: Vec<NodeId>,
    /// Where in the network what the rule names is, if the rule is not known to hold: see [`super::super::Line::place`].
    pub place: String,
}

/// A stretch of time, counted from the start of the mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stretch {
    /// It begins here.
    pub from: Time,
    /// It ends here, perhaps never.
    pub to: Bound,
}

/// How a plan stands to a rule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// No execution of the plan breaks it.
    Holds,
    /// The plan never comes to what the rule is about.
    NeverApplies,
    /// Some execution breaks it, as these words tell.
    Broken(String),
    /// The mission does not say enough to be sure of it, as these words tell.
    Unsure(String),
    /// There are too many cases to go through, or figures that are too large.
    Undecided,
    /// The rule cannot be read in this mission: the place in it, from 1, and what is wrong there.
    Unreadable {
        /// The character.
        column: u32,
        /// What is wrong.
        message: String,
    },
    NoPlan,
}

impl Finding {
    pub(super) fn without_times(rule: &str, outcome: Outcome) -> Self {
        Self {
            rule: rule.to_owned(),
            outcome,
            applies: Vec::new(),
            breaks: Vec::new(),
            open: Vec::new(),
            names: Vec::new(),
            nodes: Vec::new(),
            place: String::new(),
        }
    }
}
