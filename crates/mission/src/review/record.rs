//! What people add to a review: comments and sign-offs, as a document that is kept with the mission.
//!
//! Each entry carries the hash of what it is about. A sign-off counts only for that content: after an edit it is
//! stale, and after undoing the edit it counts again.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::FlightRules;
use crate::request::Goal;

/// Comments and sign-offs of one mission, oldest first.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Record {
    /// The mission's name.
    pub mission: String,
    /// What reviewers wrote.
    pub comments: Vec<Comment>,
    /// Who signed what.
    pub sign_offs: Vec<SignOff>,
    /// The flight rules of the mission, if somebody has set them.
    pub ruled: Option<Ruled>,
}

/// Flight rules, and who set them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ruled {
    /// Who.
    pub by: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// The rules.
    pub rules: FlightRules,
}

/// A reviewer's words.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Comment {
    /// Who wrote it.
    pub author: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// What it is about, by the names of all output; the whole mission if nothing is named.
    #[serde(default)]
    pub about: Option<String>,
    /// The words.
    pub text: String,
    /// The content it was written for.
    pub content_hash: String,
}

/// Somebody vouches for a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignOff {
    /// Who.
    pub name: String,
    /// When, as an ISO 8601 time in UTC.
    pub time: String,
    /// What was signed: see [`super::content_hash`].
    pub content_hash: String,
    /// How many lines of the review had passed, were for attention, and had failed.
    pub counts: [usize; 3],
    /// The signed text itself, so that later ones can be compared with it.
    pub source: String,
    /// What was planned.
    #[serde(default)]
    pub goal: Goal,
    /// The seed of its paths.
    #[serde(default)]
    pub seed: u64,
    /// The flight rules that it was held against.
    #[serde(default)]
    pub rules: FlightRules,
}

/// The format of the document.
pub const FORMAT: &str = "enroute-review/1";

/// Why a text is no record of a review.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// It is another kind of document, or a later version.
    #[error("this is not a review: its format is {found}, not \"{FORMAT}\"")]
    Format {
        /// What it says of itself.
        found: String,
    },
    /// It is damaged.
    #[error("this review cannot be read: {0}")]
    Damaged(String),
}

impl Record {
    /// Whether nobody has said anything yet.
    pub fn is_empty(&self) -> bool {
        self.comments.is_empty() && self.sign_offs.is_empty() && self.ruled.is_none()
    }

    /// The latest sign-off of this content, held against these rules.
    pub fn sign_off_of(&self, content_hash: &str, rules: &FlightRules) -> Option<&SignOff> {
        self.sign_offs.iter().rev().find(|it| it.content_hash == content_hash && it.rules == *rules)
    }

    /// The flight rules: those of the mission, otherwise the usual ones.
    pub fn rules(&self) -> FlightRules {
        self.ruled.as_ref().map(|ruled| ruled.rules.clone()).unwrap_or_default()
    }

    /// The document, on several lines.
    pub fn to_json(&self) -> String {
        let mut value = serde_json::to_value(self).unwrap_or_default();
        value["format"] = FORMAT.into();
        value["diagnostics"] = Value::Array(Vec::new());
        let mut text = serde_json::to_string_pretty(&value).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Reads the document.
    pub fn from_json(text: &str) -> Result<Self, RecordError> {
        let value: Value =
            serde_json::from_str(text).map_err(|error| RecordError::Damaged(error.to_string()))?;
        if value["format"] != FORMAT {
            return Err(RecordError::Format { found: value["format"].to_string() });
        }
        serde_json::from_value(value).map_err(|error| RecordError::Damaged(error.to_string()))
    }

    /// Adds what another record has and this one has not, in order of time. Answers how many entries are new.
    pub fn merge(&mut self, other: Self) -> usize {
        let before = self.comments.len() + self.sign_offs.len();
        for comment in other.comments {
            if !self.comments.contains(&comment) {
                self.comments.push(comment);
            }
        }
        for sign_off in other.sign_offs {
            if !self.sign_offs.contains(&sign_off) {
                self.sign_offs.push(sign_off);
            }
        }
        // The rules that were set last.
        if let Some(theirs) = other.ruled
            && self.ruled.as_ref().is_none_or(|mine| mine.time < theirs.time)
        {
            self.ruled = Some(theirs);
        }
        // Times in UTC and of one shape are in order when their texts are; equal ones keep theirs.
        self.comments.sort_by(|left, right| left.time.cmp(&right.time));
        self.sign_offs.sort_by(|left, right| left.time.cmp(&right.time));
        self.comments.len() + self.sign_offs.len() - before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comment(time: &str, text: &str) -> Comment {
        Comment {
            author: "A. Reviewer".to_owned(),
            time: time.to_owned(),
            about: Some("Group-Wait#1".to_owned()),
            text: text.to_owned(),
            content_hash: "0".repeat(64),
        }
    }

    fn sign_off(time: &str, hash: &str) -> SignOff {
        SignOff {
            name: "A. Reviewer".to_owned(),
            time: time.to_owned(),
            content_hash: hash.to_owned(),
            counts: [3, 1, 0],
            source: "scenario S = { }".to_owned(),
            goal: Goal::Default,
            seed: 7,
            rules: FlightRules::default(),
        }
    }

    #[test]
    fn a_record_is_read_back_as_it_was_written() {
        let record = Record {
            mission: "enroute".to_owned(),
            comments: vec![comment("2026-01-02T03:04:05Z", "Why \"this\" path?\nIt is longer.")],
            sign_offs: vec![sign_off("2026-01-02T03:05:00Z", "ab")],
            ruled: Some(Ruled {
                by: "C. Chair".to_owned(),
                time: "2026-01-01T00:00:00Z".to_owned(),
                rules: FlightRules { slope_deg: None, ..FlightRules::default() },
            }),
        };
        assert_eq!(Record::from_json(&record.to_json()), Ok(record));
    }

    #[test]
    fn other_documents_are_refused() {
        assert!(matches!(
            Record::from_json("{\"format\":\"enroute-plan/1\"}"),
            Err(RecordError::Format { found }) if found.contains("enroute-plan/1")
        ));
        assert!(matches!(Record::from_json("{"), Err(RecordError::Damaged(_))));
        assert!(matches!(
            Record::from_json("{\"format\":\"enroute-review/1\",\"comments\":[{}]}"),
            Err(RecordError::Damaged(_))
        ));
    }

    #[test]
    fn merging_keeps_both_and_nothing_twice() {
        let mut mine = Record {
            comments: vec![comment("2026-01-01T00:00:00Z", "mine"), comment("2026-01-03T00:00:00Z", "both")],
            ..Record::default()
        };
        let theirs = Record {
            comments: vec![
                comment("2026-01-03T00:00:00Z", "both"),
                comment("2026-01-02T00:00:00Z", "theirs"),
            ],
            sign_offs: vec![sign_off("2026-01-04T00:00:00Z", "ab")],
            ..Record::default()
        };
        assert_eq!(mine.merge(theirs), 2);
        let texts: Vec<&str> = mine.comments.iter().map(|it| it.text.as_str()).collect();
        assert_eq!(texts, ["mine", "theirs", "both"]);
    }

    #[test]
    fn the_latest_sign_off_of_a_content_counts() {
        let record = Record {
            sign_offs: vec![sign_off("1", "ab"), sign_off("2", "cd"), sign_off("3", "ab")],
            ..Record::default()
        };
        let rules = FlightRules::default();
        assert_eq!(record.sign_off_of("ab", &rules).map(|it| it.time.as_str()), Some("3"));
        assert_eq!(record.sign_off_of("ef", &rules), None);
        let others = FlightRules { slope_deg: None, ..rules };
        assert_eq!(record.sign_off_of("ab", &others), None, "other rules were not signed");
    }
}
