//! The entries of a review's history: who did what about which content, and what was approved.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use snapshot::Goal;
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use super::sealed::Sealed;
use super::{FlightRules, Line, Review, Section, Status};

/// An entry of the history; nothing changes it any more.
pub type Entry = Sealed<Said>;

/// What an entry says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Said {
    pub by: String,
    /// In which role; empty if in none.
    pub role: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// The content that it is about: see [`super::content_hash`].
    pub content_hash: String,
    /// The plan that it is about: see [`super::plan_hash`]; empty if none was known.
    pub plan_hash: String,
    /// The digests of the entries that were the last ones: one, or several where histories were joined.
    pub former: Vec<String>,
    /// What was done.
    pub act: Act,
}

/// What somebody did. `of` is the digest of the entry that it is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Act {
    /// Wrote a comment, which is open until it is resolved.
    Comment {
        /// What it is about, by the names of all output; the whole mission if nothing is named.
        about: Option<String>,
        text: String,
    },
    /// Resolved a comment.
    Resolve { of: String, text: String },
    /// Opened a resolved comment again.
    Reopen { of: String, text: String },
    /// Acknowledged a line for attention.
    Acknowledge {
        line: LineKey,
        /// Why it may be so.
        text: String,
    },
    Approve {
        /// The digest of what was approved: a [`Subject`].
        subject: String,
        /// What goes with it; empty for an approval without comments.
        text: String,
    },
    /// Took an entry back.
    Withdraw { of: String, text: String },
    /// Set the flight rules.
    Rules { rules: FlightRules },
}

impl Act {
    /// The word for it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Comment { .. } => "commented",
            Self::Resolve { .. } => "resolved",
            Self::Reopen { .. } => "reopened",
            Self::Acknowledge { .. } => "acknowledged",
            Self::Approve { .. } => "approved",
            Self::Withdraw { .. } => "took back",
            Self::Rules { .. } => "set the flight rules",
        }
    }

    /// What was said with it.
    pub fn text(&self) -> &str {
        match self {
            Self::Comment { text, .. }
            | Self::Resolve { text, .. }
            | Self::Reopen { text, .. }
            | Self::Acknowledge { text, .. }
            | Self::Approve { text, .. }
            | Self::Withdraw { text, .. } => text,
            Self::Rules { .. } => "",
        }
    }

    /// The entry that it is about.
    pub fn of(&self) -> Option<&str> {
        match self {
            Self::Resolve { of, .. } | Self::Reopen { of, .. } | Self::Withdraw { of, .. } => Some(of),
            Self::Comment { .. } | Self::Acknowledge { .. } | Self::Approve { .. } | Self::Rules { .. } => {
                None
            }
        }
    }
}

/// What tells a line of a checklist from others: an acknowledgement holds as long as the line says the same.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LineKey {
    pub section: Section,
    pub text: String,
    /// What it is held against.
    pub criterion: Option<String>,
}

impl LineKey {
    /// The key of a line.
    pub fn new(section: Section, line: &Line) -> Self {
        Self { section, text: line.text.clone(), criterion: line.criterion.clone() }
    }
}

/// What was approved, as it was then: later contents can be compared with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    pub source: String,
    /// What was planned.
    pub goal: Goal,
    /// The seed of its paths.
    pub seed: u64,
    /// The flight rules that it was held against.
    pub rules: FlightRules,
    /// How many lines of the review had passed, were for attention, and had failed.
    pub counts: [usize; 3],
    /// The lines of the checklist, those of events and their windows excepted.
    #[serde(default)]
    pub lines: Vec<SeenLine>,
    /// The plan, as `enroute plan` prints one (DESIGN 4.2); nothing where it was not kept.
    #[serde(default)]
    pub plan: Value,
    /// What runs with chance had come to, if any had been made.
    #[serde(default)]
    pub robustness: Option<Rate>,
}

/// A line of a checklist as it was seen.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeenLine {
    pub section: Section,
    pub status: Status,
    pub text: String,
    /// What it was about, by the names of all output.
    pub names: Vec<String>,
}

/// How many of some runs with chance reached the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Rate {
    /// How many reached the end.
    pub succeeded: u64,
    pub runs: u64,
    /// The seed of the runs.
    pub seed: u64,
}

impl Rate {
    /// Of runs that were made.
    pub fn new(found: &Robustness) -> Self {
        Self { succeeded: found.tally.succeeded, runs: found.tally.runs, seed: found.settings.seed }
    }
}

impl Subject {
    /// What is approved when a review is: `plan` is that of the reviewed content, as JSON.
    pub fn new(
        review: &Review,
        source: &str,
        goal: Goal,
        seed: u64,
        plan: Value,
        found: Option<&Robustness>,
    ) -> Self {
        Self {
            source: source.to_owned(),
            goal,
            seed,
            rules: review.rules.clone(),
            counts: review.counts(),
            lines: seen_lines(review),
            plan,
            robustness: found.map(Rate::new),
        }
    }
}

/// The lines of a checklist, those of events and their windows excepted.
pub fn seen_lines(review: &Review) -> Vec<SeenLine> {
    let sections = Section::ALL.into_iter().filter(|&section| section != Section::Events);
    let lines =
        sections.flat_map(|section| review.lines(section).into_iter().map(move |line| (section, line)));
    let seen = lines.map(|(section, line)| SeenLine {
        section,
        status: line.status,
        text: line.text.clone(),
        names: line.names.clone(),
    });
    seen.collect()
}

/// What runs with chance came to of one content.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Runs {
    /// The content: see [`super::content_hash`].
    pub content_hash: String,
    /// How many were asked for.
    pub runs: u64,
    pub seed: u64,
    /// What was left to chance.
    pub uncertainty: Uncertainty,
    /// What those came to that were made.
    pub tally: Tally,
}

impl Runs {
    pub fn new(content_hash: &str, found: &Robustness) -> Self {
        let Robustness { settings: RobustnessSettings { runs, seed, uncertainty }, tally } = found.clone();
        Self { content_hash: content_hash.to_owned(), runs, seed, uncertainty, tally }
    }

    /// What is known of the content's robustness.
    pub fn robustness(&self) -> Robustness {
        let Self { runs, seed, uncertainty, tally, .. } = self.clone();
        Robustness { settings: RobustnessSettings { runs, seed, uncertainty }, tally }
    }
}

/// Who does something, when, and about what.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Who {
    pub by: String,
    /// The role; empty for none.
    pub role: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// The content that it is about.
    pub content_hash: String,
    /// The plan that it is about; empty if none is known.
    pub plan_hash: String,
}
