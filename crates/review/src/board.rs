//! How a plan stands with its board: who has to approve, who has, and what stands in the way (SPEC 16.2).

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::record::{Act, Entry, LineKey, Record, Subject};
use super::seat::Seat;
use super::{FlightRules, Line, Review, Section, Status};

/// How a plan stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlanStatus {
    /// Nobody has said anything of it.
    Draft,
    /// The board is at work.
    InReview,
    /// Everybody has approved who has to, and nothing is open.
    Approved,
    /// The same, and an approval has words with it.
    ApprovedWithComments,
    /// It had been approved, and is another one now.
    Lapsed,
}

impl PlanStatus {
    /// The words for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::InReview => "in review",
            Self::Approved => "approved",
            Self::ApprovedWithComments => "approved with comments",
            Self::Lapsed => "approval lapsed",
        }
    }

    /// Whether the plan may fly.
    pub const fn is_approved(self) -> bool {
        matches!(self, Self::Approved | Self::ApprovedWithComments)
    }
}

/// What is asked how it stands.
#[derive(Clone, Copy, Debug)]
pub struct Present<'a> {
    /// The content: see [`super::content_hash`].
    pub content_hash: &'a str,
    /// The plan: see [`super::plan_hash`]; `None` before it is known.
    pub plan_hash: Option<&'a str>,
    /// What it is held against.
    pub rules: &'a FlightRules,
    /// Its review, if it has been made.
    pub review: Option<&'a Review>,
}

impl<'a> Present<'a> {
    /// What a review is about.
    pub fn of_review(review: &'a Review) -> Self {
        Self {
            content_hash: &review.content_hash,
            plan_hash: Some(&review.plan_hash),
            rules: &review.rules,
            review: Some(review),
        }
    }

    /// What is another than in `approval`, which approved `subject`; nothing if it counts.
    pub fn difference(&self, approval: &Entry, subject: &Subject) -> Option<&'static str> {
        let is_known = !approval.plan_hash.is_empty();
        match self.plan_hash {
            _ if approval.content_hash != self.content_hash => Some("text, map, goal or seed are others"),
            Some(plan_hash) if is_known && approval.plan_hash != plan_hash => Some("the plan is another one"),
            _ if subject.rules != *self.rules => Some("the flight rules are others"),
            _ => None,
        }
    }
}

/// How a plan stands with its board.
#[derive(Clone, Debug)]
pub struct Standing<'a> {
    pub status: PlanStatus,
    /// The roles, in the board's order, each with the approvals that count.
    pub seats: Vec<Approvals<'a>>,
    /// The latest approval of a board that does not count any more, with what is another since.
    pub lapsed: Option<(&'a Entry, &'static str)>,
    /// Comments that are not resolved, oldest first.
    pub open_comments: Vec<&'a Entry>,
    /// Lines for attention that nobody has acknowledged.
    pub unacknowledged: Vec<(Section, &'a Line)>,
    /// Lines that have failed.
    pub failed: usize,
    /// What there is nothing to approve without, if it is missing: a review of the very content, and a plan in it.
    pub missing: Option<&'static str>,
}

/// The approvals of a role.
#[derive(Clone, Debug)]
pub struct Approvals<'a> {
    /// What the role is called.
    pub role: &'a str,
    /// How many people have to approve.
    pub wanted: usize,
    /// The approvals of the present plan, one of each person.
    pub given: Vec<&'a Entry>,
}

/// How what `present` names stands by what `record` has. Nothing else is looked at.
pub fn standing<'a>(record: &'a Record, present: &Present<'a>) -> Standing<'a> {
    let withdrawn = record.withdrawn();
    let is_standing = |entry: &&'a Entry| !withdrawn.contains_key(entry.digest());
    let approvals: Vec<(&Entry, &Subject)> = (record.entries().iter().filter(is_standing))
        .filter_map(|entry| Some((entry, record.subject(entry)?)))
        .collect();
    let current = approvals.iter().filter(|(entry, subject)| present.difference(entry, subject).is_none());
    let seats = seats(&present.rules.board, &current.map(|(entry, _)| *entry).collect::<Vec<_>>());
    let open_comments = open_comments(record);
    let unacknowledged = present.review.map(|review| unacknowledged(record, review)).unwrap_or_default();
    let failed = present.review.map_or(0, |review| review.count(Status::Failed));
    let lapsed = lapsed(&approvals, present);
    let is_blocked = !open_comments.is_empty() || !unacknowledged.is_empty() || failed > 0;
    let is_complete = is_complete(&seats);
    let mut given = seats.iter().flat_map(|seat| &seat.given);
    let status = if is_complete && !is_blocked {
        let has_words = given.any(|entry| !entry.act.text().is_empty());
        if has_words { PlanStatus::ApprovedWithComments } else { PlanStatus::Approved }
    } else if given.next().is_some() {
        PlanStatus::InReview
    } else if lapsed.is_some() {
        PlanStatus::Lapsed
    } else if record.entries().iter().any(|entry| !matches!(entry.act, Act::Rules { .. })) {
        PlanStatus::InReview
    } else {
        PlanStatus::Draft
    };
    let missing = match present.review {
        None => Some("the present content has not been reviewed"),
        Some(review) if !review.is_planned() => Some("there is no plan"),
        Some(_) => None,
    };
    Standing { status, seats, lapsed, open_comments, unacknowledged, failed, missing }
}

/// The approvals of each role; a person counts once in a role.
fn seats<'a>(board: &'a [Seat], approvals: &[&'a Entry]) -> Vec<Approvals<'a>> {
    let seat = |seat: &'a Seat| {
        let mut people = BTreeSet::new();
        let is_first = |entry: &&&'a Entry| entry.role == seat.role && people.insert(person(&entry.by));
        let given = approvals.iter().rev().filter(is_first).copied().collect();
        Approvals { role: &seat.role, wanted: seat.approvals as usize, given }
    };
    board.iter().map(seat).collect()
}

/// A person by name, however it is spelled: by its letters and digits alone, for spaces, dashes and what nobody sees make
/// no other person.
fn person(name: &str) -> String {
    name.chars().filter(|letter| letter.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

fn is_complete(seats: &[Approvals<'_>]) -> bool {
    !seats.is_empty() && seats.iter().all(|seat| seat.given.len() >= seat.wanted)
}

/// The latest approval that completed a board, of something else than the present.
fn lapsed<'a>(
    approvals: &[(&'a Entry, &'a Subject)],
    present: &Present<'_>,
) -> Option<(&'a Entry, &'static str)> {
    approvals.iter().rev().find_map(|(last, subject)| {
        let difference = present.difference(last, subject)?;
        let same = approvals.iter().filter(|(entry, other)| {
            entry.content_hash == last.content_hash
                && entry.plan_hash == last.plan_hash
                && other.rules == subject.rules
        });
        let same: Vec<&Entry> = same.map(|(entry, _)| *entry).collect();
        is_complete(&seats(&subject.rules.board, &same)).then_some((*last, difference))
    })
}

/// The comments of a record that are not resolved, oldest first.
pub fn open_comments(record: &Record) -> Vec<&Entry> {
    let mut open: Vec<&Entry> = Vec::new();
    let mut resolved: Vec<&Entry> = Vec::new();
    for entry in record.entries() {
        match &entry.act {
            Act::Comment { .. } => open.push(entry),
            Act::Resolve { of, .. } => resolved.extend(open.extract_if(.., |it| it.digest() == of)),
            Act::Reopen { of, .. } => open.extend(resolved.extract_if(.., |it| it.digest() == of)),
            Act::Withdraw { of, .. } => open.retain(|it| it.digest() != of),
            Act::Acknowledge { .. } | Act::Approve { .. } | Act::Rules { .. } => {}
        }
    }
    open
}

/// The lines for attention that nobody has acknowledged.
fn unacknowledged<'a>(record: &Record, review: &'a Review) -> Vec<(Section, &'a Line)> {
    let acknowledged = record.acknowledgements();
    let lines = Section::ALL
        .into_iter()
        .flat_map(|section| review.lines(section).into_iter().map(move |line| (section, line)));
    let is_left = |(section, line): &(Section, &Line)| {
        line.status == Status::Attention && !acknowledged.contains_key(&LineKey::new(*section, line))
    };
    lines.filter(is_left).collect()
}

impl Record {
    /// Who acknowledged which line last; each holds for a line as long as it says the same.
    pub fn acknowledgements(&self) -> BTreeMap<&LineKey, &Entry> {
        let withdrawn = self.withdrawn();
        let standing = self.entries().iter().filter(|entry| !withdrawn.contains_key(entry.digest()));
        let acknowledged = standing.filter_map(|entry| match &entry.act {
            Act::Acknowledge { line, .. } => Some((line, entry)),
            _ => None,
        });
        acknowledged.collect()
    }
}

impl Standing<'_> {
    /// What stands in the way of any approval, in words.
    pub fn blockers(&self) -> Vec<String> {
        let some = |count: usize, one: &str, many: &str| {
            (count > 0).then(|| format!("{count} {}", if count == 1 { one } else { many }))
        };
        let missing = self.missing.map(str::to_owned);
        missing
            .into_iter()
            .chain(some(self.failed, "line has failed", "lines have failed"))
            .chain(some(
                self.unacknowledged.len(),
                "line for attention is not acknowledged",
                "lines for attention are not acknowledged",
            ))
            .chain(some(self.open_comments.len(), "comment is open", "comments are open"))
            .collect()
    }

    /// Whether somebody may approve in a role; `Err` says why not.
    pub fn may_approve(&self, name: &str, role: &str) -> Result<(), String> {
        let blockers = self.blockers();
        let Some(seat) = self.seats.iter().find(|seat| seat.role == role) else {
            return Err(format!("the board has no role \"{role}\""));
        };
        match seat.given.iter().find(|entry| person(&entry.by) == person(name)) {
            _ if !blockers.is_empty() => Err(blockers.join(", ")),
            _ if person(name).is_empty() => Err("an approval needs a name".to_owned()),
            Some(_) => Err(format!("{} has approved as {role} already", name.trim())),
            None => Ok(()),
        }
    }

    /// The roles in words: `Science 1 of 2, Mobility 0 of 1`.
    pub fn seats_in_words(&self) -> String {
        let seat = |seat: &Approvals<'_>| format!("{} {} of {}", seat.role, seat.given.len(), seat.wanted);
        self.seats.iter().map(seat).collect::<Vec<_>>().join(", ")
    }
}
