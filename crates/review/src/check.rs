//! Checks the entries of a history: whose signature each has, and whether it was that person's to make (SPEC 16.3).
//!
//! What an entry says of its signer is in its signature; what counts is decided here, for a list of trusted keys and a
//! time. An entry that does not count stays in the history, and is shown with the reason.

use jiff::tz::TimeZone;
use jiff::{SignedDuration, Timestamp, civil};
use serde::Serialize;

use super::keys::{PublicKey, Trust};
use super::names;
use super::record::{Act, Entry, Record};

/// What the signature of an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Signature {
    /// Of a trusted key.
    Valid,
    /// Of a key that is not trusted here.
    Unknown,
    /// Not of the key that the entry names: the entry was forged.
    Broken,
    /// There is none, as in histories of earlier versions.
    Unsigned,
}

impl Signature {
    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Unknown => "unknown key",
            Self::Broken => "broken",
            Self::Unsigned => "unsigned",
        }
    }
}

/// What was found of an entry.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Check {
    pub signature: Signature,
    /// Why it does not count in spite of its signature, or what else is odd about it.
    pub problem: Option<String>,
}

impl Check {
    /// Returns whether the entry counts.
    pub fn counts(&self) -> bool {
        self.signature == Signature::Valid && self.problem.is_none()
    }

    /// The signature, and what is wrong: `valid`, `unknown key: …`.
    pub fn words(&self) -> String {
        match &self.problem {
            None => self.signature.name().to_owned(),
            Some(problem) => format!("{}: {problem}", self.signature.name()),
        }
    }
}

/// What is said of an entry with characters that cannot be seen.
pub(super) const HIDDEN: &str = "its name, role or time contains line breaks or invisible characters";

/// How far clocks may be apart.
const CLOCK_TOLERANCE: SignedDuration = SignedDuration::from_mins(10);

/// Checks an entry that follows what `record` has. Without `now` every time is in the future.
pub(super) fn check(record: &Record, entry: &Entry, trust: &Trust, now: Option<Timestamp>) -> Check {
    let known = entry.key.as_ref().and_then(|key| trust.name_of(key));
    let signature = match known {
        _ if entry.key.is_none() || entry.signature().is_empty() => Signature::Unsigned,
        _ if !entry.is_signed() => Signature::Broken,
        Some(_) => Signature::Valid,
        None => Signature::Unknown,
    };
    let problem = problem_of_name(entry, known, trust)
        .or_else(|| problem_of_mission(record, entry))
        .or_else(|| problem_of_history(record, entry))
        .or_else(|| problem_of_time(record, entry, now))
        .or_else(|| problem_of_act(record, entry));
    Check { signature, problem }
}

fn problem_of_name(entry: &Entry, known: Option<&str>, trust: &Trust) -> Option<String> {
    let name = names::tidy(&entry.by);
    let name = name.as_str();
    match known {
        _ if !entry.is_visible() => Some(HIDDEN.to_owned()),
        Some(known) if known != name => {
            Some(format!("the key is that of “{known}”, and the entry names “{name}”"))
        }
        Some(_) => None,
        None => trust.alike(name).map(|known| format!("“{name}” is not “{known}”, who has another key")),
    }
}

fn problem_of_mission(record: &Record, entry: &Entry) -> Option<String> {
    let is_elsewhere = entry.key.is_some() && entry.mission != record.mission;
    is_elsewhere.then(|| match entry.mission.as_str() {
        "" => "it does not name its mission; sign it again".to_owned(),
        mission => format!("it belongs to the history of “{}”", names::one_line(mission)),
    })
}

fn problem_of_history(record: &Record, entry: &Entry) -> Option<String> {
    let problem = match record.history() {
        _ if entry.key.is_none() => return None,
        "" if !entry.history.is_empty() || !entry.nonce.is_empty() => {
            "it belongs to another history of this mission"
        }
        "" if record.has_several_starts() => {
            "several histories without an id are joined here, and nothing shows which entries belong together"
        }
        "" => return None,
        first if entry.digest() == first => return None,
        _ if entry.former.is_empty() => "it follows no entry, as only the first entry of a history may",
        first if entry.history != first => "it belongs to another history of this mission",
        _ if !record.is_after_first(entry) => "it does not follow the first entry of this history",
        _ => return None,
    };
    Some(problem.to_owned())
}

fn problem_of_time(record: &Record, entry: &Entry, now: Option<Timestamp>) -> Option<String> {
    let Some(time) = moment(&entry.time) else { return Some("its date is malformed".to_owned()) };
    let mut former = entry.former.iter().filter_map(|former| record.entry(former));
    if former.any(|former| is_after(&former.time, &entry.time)) {
        return Some("it is dated before an entry that it follows".to_owned());
    }
    let is_future = now.is_none_or(|now| now.duration_until(time) > CLOCK_TOLERANCE);
    is_future.then(|| "it is dated in the future".to_owned())
}

fn problem_of_act(record: &Record, entry: &Entry) -> Option<String> {
    let signed = moment(&entry.time).map(day_of);
    if let Some(objection) = objection(record, entry.key.as_ref(), &entry.act, signed) {
        return Some(objection.words(&entry.act).to_owned());
    }
    match &entry.act {
        _ if record.precedes_its_rules(entry) => {
            Some("it comes before the flight rules that it signs".to_owned())
        }
        Act::Approve { .. } if record.has_other_content(entry) => {
            Some("the text that it approves is not the one of its content hash".to_owned())
        }
        Act::Approve { .. }
            if record.subject(entry).is_none_or(|subject| subject.rules.digest() != entry.rules) =>
        {
            Some("it signs other flight rules than those that it approves".to_owned())
        }
        Act::Rules { rules } => rules.problem().map(str::to_owned),
        _ => None,
    }
}

/// Why no one, or not the owner of a key, may do something.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Objection {
    /// It takes a reason.
    NoReason,
    /// It takes a date.
    NoDate,
    /// Its date has come when it is signed.
    PastDate,
    /// A flight rule that the plan violates is waived, and not acknowledged.
    NeedsWaiver,
    /// Only the person who signed an entry withdraws it.
    NotSigner,
    /// Only comments, acknowledgments, waivers and approvals are withdrawn.
    Permanent,
    /// Only the author of a comment, or the person to whom it is addressed, resolves or reopens it.
    NotConcerned,
}

impl Objection {
    /// Returns what is said of an entry that does `act` all the same.
    const fn words(self, act: &Act) -> &'static str {
        match (self, act) {
            (Self::NoReason, Act::Resolve { .. }) => "a resolution needs a reason",
            (Self::NoReason, Act::Waive { .. }) => "a waiver needs a reason",
            (Self::NoReason, _) => "an acknowledgment needs a reason",
            (Self::NoDate, _) => "a waiver needs a date",
            (Self::PastDate, _) => "a waiver must lapse after the day on which it is signed (UTC)",
            (Self::NeedsWaiver, _) => "a flight rule that the plan violates needs a waiver",
            (Self::NotSigner, _) => "only the person who signed an entry can withdraw it",
            (Self::Permanent, _) => "only comments, acknowledgments, waivers and approvals can be withdrawn",
            (Self::NotConcerned, _) => {
                "only the author or the addressee of a comment can resolve or reopen it"
            }
        }
    }
}

/// Returns whether a waiver that is signed on one day lapses on a later one.
pub(super) fn can_lapse(signed: Option<civil::Date>, until: civil::Date) -> bool {
    signed.is_some_and(|signed| signed < until)
}

/// Returns what there is to say against `act` of the owner of a key, after what `record` has, on the day `signed`.
pub fn objection(
    record: &Record,
    key: Option<&PublicKey>,
    act: &Act,
    signed: Option<civil::Date>,
) -> Option<Objection> {
    let of = || act.of().and_then(|of| record.entry(of));
    let is_signer = || key.is_some() && of().is_some_and(|of| of.key.as_ref() == key);
    let is_concerned = || key.zip(of()).is_some_and(|(key, of)| is_concerned(key, of));
    let is_silent = || !act.text().chars().any(|it| it.is_alphanumeric() && !names::is_hidden(it));
    match act {
        Act::Resolve { .. } | Act::Acknowledge { .. } | Act::Waive { .. } if is_silent() => {
            Some(Objection::NoReason)
        }
        Act::Acknowledge { line, .. } if line.needs_waiver => Some(Objection::NeedsWaiver),
        Act::Waive { until, .. } => match day(until) {
            None => Some(Objection::NoDate),
            Some(until) if !can_lapse(signed, until) => Some(Objection::PastDate),
            Some(_) => None,
        },
        Act::Withdraw { .. } if !is_signer() => Some(Objection::NotSigner),
        Act::Withdraw { .. } if of().is_some_and(|of| is_permanent(&of.act)) => Some(Objection::Permanent),
        Act::Resolve { .. } | Act::Reopen { .. } if !is_concerned() => Some(Objection::NotConcerned),
        _ => None,
    }
}

/// Returns whether no one can withdraw this. Flight rules are replaced, and comments are reopened.
const fn is_permanent(act: &Act) -> bool {
    matches!(act, Act::Rules { .. } | Act::Resolve { .. } | Act::Reopen { .. } | Act::Withdraw { .. })
}

/// Returns whether the owner of a key wrote the comment `of`, or is the person to whom it is addressed.
pub fn is_concerned(key: &PublicKey, of: &Entry) -> bool {
    match &of.act {
        Act::Comment { to, .. } => of.key.as_ref() == Some(key) || to.as_ref() == Some(key),
        _ => false,
    }
}

/// Returns whether the first of two times is later by more than clocks may differ.
pub(super) fn is_after(later: &str, earlier: &str) -> bool {
    let times = moment(earlier).zip(moment(later));
    times.is_some_and(|(earlier, later)| earlier.duration_until(later) > CLOCK_TOLERANCE)
}

/// Reads a time in UTC such as `2026-01-02T03:04:05Z`, and nothing else: times of one shape are in order when their texts
/// are.
pub(super) fn moment(text: &str) -> Option<Timestamp> {
    let time: Timestamp = text.parse().ok()?;
    (time.strftime("%Y-%m-%dT%H:%M:%SZ").to_string() == text).then_some(time)
}

/// The day of a time, in UTC.
pub(super) fn day_of(time: Timestamp) -> civil::Date {
    time.to_zoned(TimeZone::UTC).date()
}

/// Reads a day such as `2026-01-02`, and nothing else: a day with a time or a zone is another one elsewhere.
pub(super) fn day(text: &str) -> Option<civil::Date> {
    let day: civil::Date = text.parse().ok()?;
    (day.to_string() == text).then_some(day)
}
