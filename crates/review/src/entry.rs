//! The entries of a review's history: who did what about which content, and what was approved.

use std::ops::Deref;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use snapshot::{Goal, MapKey};
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use super::keys::{PublicKey, SecretKey};
use super::names;
use super::sealed::Sealed;
use super::{FlightRules, Line, Review, Section, Status};

/// An entry of the history with its signature; nothing changes it any more.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    said: Sealed<Said>,
    signature: String,
    /// Whether the signature is that of the key that the entry names.
    is_signed: bool,
}

/// Changes when the meaning of the signed bytes does.
const DOMAIN: &str = "enroute-signature/1\n";

impl Entry {
    /// Returns what someone said, signed.
    pub fn signed(said: Said, secret: &SecretKey) -> Self {
        let said = Sealed::new(Said { key: Some(secret.public()), ..said });
        let signature = secret.sign(signed_bytes(said.digest()).as_bytes());
        Self { said, signature, is_signed: true }
    }

    /// Returns what was said, with what is written as its signature.
    pub fn new(said: Sealed<Said>, signature: String) -> Self {
        let message = signed_bytes(said.digest());
        let is_signed = said.key.as_ref().is_some_and(|key| key.verify(message.as_bytes(), &signature));
        Self { said, signature, is_signed }
    }

    /// Returns what was said.
    pub fn said(&self) -> &Sealed<Said> {
        &self.said
    }

    /// Returns what is written of it.
    pub fn raw(&self) -> &Value {
        self.said.raw()
    }

    /// The SHA-256 of what is written of it, in hexadecimal: what is signed.
    pub fn digest(&self) -> &str {
        self.said.digest()
    }

    /// The signature in hexadecimal; empty if there is none.
    pub fn signature(&self) -> &str {
        &self.signature
    }

    /// Returns whether the signature is that of the key that the entry names.
    pub fn is_signed(&self) -> bool {
        self.is_signed
    }
}

impl Deref for Entry {
    type Target = Said;

    fn deref(&self) -> &Said {
        &self.said
    }
}

fn signed_bytes(digest: &str) -> String {
    format!("{DOMAIN}{digest}")
}

/// What an entry says. All of it is signed, with the entries before it by their digests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Said {
    pub by: String,
    /// The mission in whose history it is; empty in histories of earlier versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub mission: String,
    /// The history that it continues: the digest of its first entry. Empty in the first entry, and in histories of earlier
    /// versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub history: String,
    /// In the first entry of a history: a random number in hexadecimal, so that no two histories have the same first entry.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub nonce: String,
    /// Whose signature it has; none in histories of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<PublicKey>,
    /// In which role; empty if in none.
    pub role: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// The content that it is about: see [`super::content_hash`].
    pub content_hash: String,
    /// The plan that it is about: see [`super::plan_hash`]; empty if none was known.
    pub plan_hash: String,
    /// The digest of the flight rules that were in force, those of the board among them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub rules: String,
    /// Of an approval: the digests of the acknowledgments and waivers that it relies on.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub acknowledged: Vec<String>,
    /// The digests of the entries that were the last ones: one, or several where histories were joined.
    pub former: Vec<String>,
    /// What was done.
    pub act: Act,
}

impl Said {
    /// Returns whether the name, the role and the time can be seen as they are.
    pub fn is_visible(&self) -> bool {
        [&self.by, &self.role, &self.time].into_iter().all(|text| names::is_visible(text))
    }
}

/// What someone did. `of` is the digest of the entry that it is about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Act {
    /// Wrote a comment, which is open until it is resolved.
    Comment {
        /// What it is about, by the names of all output; the whole mission if nothing is named.
        about: Option<String>,
        /// Who is to answer it, if someone is named.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        to: Option<PublicKey>,
        text: String,
    },
    /// Resolved a comment.
    Resolve { of: String, text: String },
    /// Opened a resolved comment again.
    Reopen { of: String, text: String },
    /// Acknowledged an item that needs attention.
    Acknowledge {
        line: LineKey,
        /// Why it may be so.
        text: String,
    },
    /// Waived an item that needs attention until some day.
    Waive {
        line: LineKey,
        /// Why it may be so until then.
        text: String,
        /// The day, in UTC, on which the waiver lapses: `2026-01-31`.
        until: String,
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
            Self::Waive { .. } => "waived",
            Self::Approve { .. } => "approved",
            Self::Withdraw { .. } => "took back",
            Self::Rules { .. } => "set the flight rules",
        }
    }

    /// Returns what was said with it.
    pub fn text(&self) -> &str {
        match self {
            Self::Comment { text, .. }
            | Self::Resolve { text, .. }
            | Self::Reopen { text, .. }
            | Self::Acknowledge { text, .. }
            | Self::Waive { text, .. }
            | Self::Approve { text, .. }
            | Self::Withdraw { text, .. } => text,
            Self::Rules { .. } => "",
        }
    }

    /// The entry that it is about.
    pub fn of(&self) -> Option<&str> {
        match self {
            Self::Resolve { of, .. } | Self::Reopen { of, .. } | Self::Withdraw { of, .. } => Some(of),
            Self::Comment { .. }
            | Self::Acknowledge { .. }
            | Self::Waive { .. }
            | Self::Approve { .. }
            | Self::Rules { .. } => None,
        }
    }
}

/// What tells a line of a checklist from others: an acknowledgment holds as long as the line says the same at the same
/// place of the network.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct LineKey {
    pub section: Section,
    pub text: String,
    /// What it is held against.
    pub criterion: Option<String>,
    /// Where in the network it is, with what is before and after it: see [`Line::place`].
    #[serde(default)]
    pub place: String,
    /// Whether it can only be waived: see [`Line::needs_waiver`].
    #[serde(default)]
    pub needs_waiver: bool,
}

impl LineKey {
    /// The key of a line.
    pub fn new(section: Section, line: &Line) -> Self {
        let Line { text, criterion, place, needs_waiver, .. } = line.clone();
        Self { section, text, criterion, place, needs_waiver }
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
    /// The map of its ground, if it has one. With it, the content hash of the text can be checked. Histories of earlier
    /// versions do not have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub map: Option<MapKey>,
    /// The flight rules that it was held against.
    pub rules: FlightRules,
    /// How many lines of the review had passed, needed attention, and had failed.
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
    /// The digest of these runs: see [`Runs::digest`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub runs: Option<String>,
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
    /// Returns what is approved when a review is of a mission without a map: `plan` is that of the reviewed content, as
    /// JSON.
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
            map: None,
            rules: review.rules.clone(),
            counts: review.counts(),
            lines: seen_lines(review),
            plan,
            robustness: found.map(Rate::new),
            runs: found.map(|found| Runs::new(&review.content_hash, found).digest()),
        }
    }

    /// The content hash of what was approved.
    pub fn content_hash(&self) -> String {
        super::content_hash(&self.source, self.map.as_ref(), &self.goal, self.seed)
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

    /// The SHA-256 of the runs in hexadecimal, with their settings and their content.
    pub fn digest(&self) -> String {
        Sealed::new(self.clone()).digest().to_owned()
    }

    /// Returns what is known of the content's robustness.
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
