//! Records of the version before, which had comments and sign-offs and no history.

use serde::Deserialize;
use serde_json::Value;
use snapshot::Goal;

use super::FlightRules;
use super::record::{Act, Record, Subject, Who};
use super::seat::DEFAULT_ROLE;

/// The format of the document.
pub(super) const FORMAT: &str = "enroute-review/1";

#[derive(Default, Deserialize)]
#[serde(default)]
struct Former {
    mission: String,
    comments: Vec<Comment>,
    sign_offs: Vec<SignOff>,
    ruled: Option<Ruled>,
}

#[derive(Deserialize)]
struct Comment {
    author: String,
    time: String,
    #[serde(default)]
    about: Option<String>,
    text: String,
    content_hash: String,
}

#[derive(Deserialize)]
struct SignOff {
    name: String,
    time: String,
    content_hash: String,
    counts: [usize; 3],
    source: String,
    #[serde(default)]
    goal: Goal,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    rules: FlightRules,
}

#[derive(Deserialize)]
struct Ruled {
    by: String,
    time: String,
    rules: FlightRules,
}

/// One thing that was said, without its time.
enum Part {
    Act(Act),
    Approval(Box<Subject>),
}

/// Reads such a document: what it has becomes a history in order of time, the same one wherever it is read.
pub(super) fn read(document: Value) -> Result<Record, serde_json::Error> {
    let former = Former::deserialize(document)?;
    let who = |by: String, role: &str, time: String, content_hash: String| Who {
        by,
        role: role.to_owned(),
        time,
        content_hash,
        plan_hash: String::new(),
    };
    let mut parts = Vec::new();
    for comment in former.comments {
        let Comment { author, time, about, text, content_hash } = comment;
        parts.push((who(author, "", time, content_hash), Part::Act(Act::Comment { about, to: None, text })));
    }
    for SignOff { name, time, content_hash, counts, source, goal, seed, rules } in former.sign_offs {
        let (lines, plan, robustness, runs) = (Vec::new(), Value::Null, None, None);
        let subject = Subject { source, goal, seed, map: None, rules, counts, lines, plan, robustness, runs };
        parts.push((who(name, DEFAULT_ROLE, time, content_hash), Part::Approval(Box::new(subject))));
    }
    if let Some(Ruled { by, time, rules }) = former.ruled {
        parts.push((who(by, "", time, String::new()), Part::Act(Act::Rules { rules })));
    }
    parts.sort_by(|(left, _), (right, _)| left.time.cmp(&right.time));
    let mut record = Record::new(&former.mission);
    for (who, part) in parts {
        match part {
            Part::Act(act) => record.add_unsigned(who, act),
            Part::Approval(subject) => {
                let subject = record.keep_subject(*subject);
                record.add_unsigned(who, Act::Approve { subject, text: String::new() });
            }
        }
    }
    Ok(record)
}
