//! How a plan stands with its board: who has to approve, who has, and what is in the way (SPEC 16.2).

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::keys::PublicKey;
use super::record::{Act, Entry, LineKey, Record, Subject};
use super::seat::Seat;
use super::{FlightRules, Line, Review, Section, Status, Waiver, names};

/// How a plan stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlanStatus {
    /// No one has said anything of it.
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

    /// Returns whether the plan may fly.
    pub const fn is_approved(self) -> bool {
        matches!(self, Self::Approved | Self::ApprovedWithComments)
    }
}

/// The mission and plan whose status is asked for.
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
    /// Returns what a review is about.
    pub fn of_review(review: &'a Review) -> Self {
        Self {
            content_hash: &review.content_hash,
            plan_hash: Some(&review.plan_hash),
            rules: &review.rules,
            review: Some(review),
        }
    }

    /// Returns what is another than in `approval` of `record`, which approved `subject`; nothing if it counts.
    pub fn difference(&self, record: &Record, approval: &Entry, subject: &Subject) -> Option<&'static str> {
        self.difference_by(record, &Accepted::new(record, &record.waivers()), approval, subject)
    }

    fn difference_by(
        &self,
        record: &Record,
        accepted: &Accepted<'_>,
        approval: &Entry,
        subject: &Subject,
    ) -> Option<&'static str> {
        match self.plan_hash {
            _ if approval.content_hash != self.content_hash => {
                Some("the text, map, goal or seed has changed")
            }
            Some(plan_hash) if approval.plan_hash != plan_hash => Some("the plan has changed"),
            _ if subject.rules != *self.rules || subject.rules != *record.rules() => {
                Some("the flight rules have changed")
            }
            _ if !record.is_under_rules(approval) => Some("the flight rules were changed and set again"),
            _ if subject.runs.is_some() && self.review.is_some_and(|review| review.runs != subject.runs) => {
                Some("the Monte Carlo runs have changed")
            }
            _ if !accepted.hold_for(approval, self.review) => Some("the acknowledgments have changed"),
            _ => None,
        }
    }
}

/// The acknowledgments, and the waivers in force, by what they are about.
struct Accepted<'a>(BTreeMap<&'a LineKey, Vec<&'a Entry>>);

impl<'a> Accepted<'a> {
    fn new(record: &'a Record, waivers: &[Waiver<'a>]) -> Self {
        let mut accepted: BTreeMap<&LineKey, Vec<&Entry>> = BTreeMap::new();
        for entry in record.standing_entries() {
            if let Act::Acknowledge { line, .. } = &entry.act {
                accepted.entry(line).or_default().push(entry);
            }
        }
        for Waiver { entry, line, .. } in waivers.iter().filter(|waiver| waiver.state.is_in_force()) {
            accepted.entry(line).or_default().push(entry);
        }
        Self(accepted)
    }

    fn of(&self, section: Section, line: &Line) -> &[&'a Entry] {
        self.0.get(&LineKey::new(section, line)).map(Vec::as_slice).unwrap_or_default()
    }

    /// Returns whether an approval has signed an acknowledgment or a waiver that still holds for each item that needs
    /// attention that someone has accepted. Without a review the lines are not known: all that the approval has signed
    /// has to hold.
    fn hold_for(&self, approval: &Entry, review: Option<&Review>) -> bool {
        let signed: BTreeSet<&str> = approval.acknowledged.iter().map(String::as_str).collect();
        let Some(review) = review else {
            let known: BTreeSet<&str> = self.0.values().flatten().map(|entry| entry.digest()).collect();
            return signed.is_subset(&known);
        };
        for_attention(review).all(|(section, line)| {
            let accepted = self.of(section, line);
            accepted.is_empty() || accepted.iter().any(|entry| signed.contains(entry.digest()))
        })
    }
}

fn for_attention(review: &Review) -> impl Iterator<Item = (Section, &Line)> {
    let lines = Section::ALL
        .into_iter()
        .flat_map(|section| review.lines(section).into_iter().map(move |line| (section, line)));
    lines.filter(|(_, line)| line.status == Status::Attention)
}

/// How a plan stands with its board.
#[derive(Clone, Debug)]
pub struct Standing<'a> {
    pub status: PlanStatus,
    /// The roles, in the board's order, each with the approvals that count.
    pub seats: Vec<Approvals<'a>>,
    /// The latest approval of a board that does not count any more, with what is another since.
    pub lapsed: Option<(&'a Entry, &'static str)>,
    /// Entries that set different flight rules: see [`Record::conflicting_rules`].
    pub conflicting_rules: Vec<&'a Entry>,
    /// The last entry that sets flight rules with an unknown key: see [`Record::unknown_rules`].
    pub unknown_rules: Option<&'a Entry>,
    /// Comments that are not resolved, oldest first.
    pub open_comments: Vec<&'a Entry>,
    /// Items that need attention that no one has acknowledged, and that no waiver in force is about.
    pub unacknowledged: Vec<(Section, &'a Line)>,
    /// The digests of the acknowledgments and waivers that an approval of the present plan relies on, and signs.
    pub relied_on: Vec<String>,
    /// The waivers, oldest first.
    pub waivers: Vec<Waiver<'a>>,
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
    /// The role in the flight rules.
    pub seat: &'a Seat,
    /// The approvals of the present plan, one of each person.
    pub given: Vec<&'a Entry>,
}

/// The status of what `present` names, from `record` alone.
pub fn standing<'a>(record: &'a Record, present: &Present<'a>) -> Standing<'a> {
    let approvals: Vec<(&Entry, &Subject)> =
        record.standing_entries().filter_map(|entry| Some((entry, record.subject(entry)?))).collect();
    let waivers = record.waivers();
    let accepted = Accepted::new(record, &waivers);
    let current = approvals
        .iter()
        .filter(|(entry, subject)| present.difference_by(record, &accepted, entry, subject).is_none());
    let seats = seats(&present.rules.board, &current.map(|(entry, _)| *entry).collect::<Vec<_>>());
    let open_comments = open_comments(record);
    let (mut unacknowledged, mut relied_on) = (Vec::new(), BTreeSet::new());
    for (section, line) in present.review.into_iter().flat_map(for_attention) {
        match accepted.of(section, line) {
            [] => unacknowledged.push((section, line)),
            entries => relied_on.extend(entries.iter().map(|entry| entry.digest().to_owned())),
        }
    }
    let failed = present.review.map_or(0, |review| review.count(Status::Failed));
    let lapsed = lapsed(record, &approvals, &accepted, present);
    let conflicting_rules = record.conflicting_rules();
    let unknown_rules = record.unknown_rules();
    let missing = match present.review {
        None => Some("the present content has not been reviewed"),
        Some(review) if !review.is_planned() => Some("there is no plan"),
        Some(_) => None,
    };
    let is_blocked = missing.is_some()
        || !conflicting_rules.is_empty()
        || unknown_rules.is_some()
        || !open_comments.is_empty()
        || !unacknowledged.is_empty()
        || failed > 0;
    let is_complete = is_complete(&seats);
    let mut given = seats.iter().flat_map(|seat| &seat.given);
    let status = if is_complete && !is_blocked {
        let has_words = given.any(|entry| !entry.act.text().is_empty());
        if has_words { PlanStatus::ApprovedWithComments } else { PlanStatus::Approved }
    } else if given.next().is_some() {
        PlanStatus::InReview
    } else if lapsed.is_some() {
        PlanStatus::Lapsed
    } else if record.counted().any(|entry| !matches!(entry.act, Act::Rules { .. })) {
        PlanStatus::InReview
    } else {
        PlanStatus::Draft
    };
    Standing {
        status,
        seats,
        lapsed,
        conflicting_rules,
        unknown_rules,
        open_comments,
        unacknowledged,
        relied_on: relied_on.into_iter().collect(),
        waivers,
        failed,
        missing,
    }
}

/// The approvals of each role; a key counts once, by its first approval in a role of the board.
fn seats<'a>(board: &'a [Seat], approvals: &[&'a Entry]) -> Vec<Approvals<'a>> {
    let empty = |seat: &'a Seat| {
        let (role, wanted) = (seat.role.as_str(), seat.approvals as usize);
        Approvals { role, wanted, seat, given: Vec::new() }
    };
    let mut seats: Vec<Approvals<'a>> = board.iter().map(empty).collect();
    let mut keys = BTreeSet::new();
    for &entry in approvals {
        let is_of = |it: &&mut Approvals<'_>| {
            entry.role == it.role && entry.key.as_ref().is_some_and(|key| it.seat.admits(key))
        };
        let seat = seats.iter_mut().find(is_of);
        if let Some(seat) = seat.filter(|_| keys.insert(&entry.key)) {
            seat.given.push(entry);
        }
    }
    seats
}

fn is_complete(seats: &[Approvals<'_>]) -> bool {
    !seats.is_empty() && seats.iter().all(|seat| seat.given.len() >= seat.wanted)
}

/// The latest approval that completed a board, of something else than the present.
fn lapsed<'a>(
    record: &Record,
    approvals: &[(&'a Entry, &'a Subject)],
    accepted: &Accepted<'_>,
    present: &Present<'_>,
) -> Option<(&'a Entry, &'static str)> {
    completed(record, approvals)
        .rev()
        .find_map(|(entry, subject)| Some((entry, present.difference_by(record, accepted, entry, subject)?)))
}

/// The approvals that hold a seat of a board that was in force and complete, oldest first.
fn completed<'a>(
    record: &Record,
    approvals: &[(&'a Entry, &'a Subject)],
) -> impl DoubleEndedIterator<Item = (&'a Entry, &'a Subject)> {
    let key = |entry: &'a Entry| (&entry.content_hash, &entry.plan_hash, &entry.rules);
    let mut same: BTreeMap<_, (Vec<&'a Entry>, &'a Subject)> = BTreeMap::new();
    for &(entry, subject) in approvals.iter().filter(|(entry, _)| record.was_under_rules(entry)) {
        same.entry(key(entry)).or_insert_with(|| (Vec::new(), subject)).0.push(entry);
    }
    let mut holding: BTreeSet<&str> = BTreeSet::new();
    for (entries, subject) in same.values() {
        let seats = seats(&subject.rules.board, entries);
        if is_complete(&seats) {
            holding.extend(seats.iter().flat_map(|seat| &seat.given).map(|entry| entry.digest()));
        }
    }
    approvals.iter().copied().filter(move |(entry, _)| holding.contains(entry.digest()))
}

/// The comments of a record that are not resolved, oldest first.
pub fn open_comments(record: &Record) -> Vec<&Entry> {
    let mut open: Vec<&Entry> = Vec::new();
    let mut resolved: Vec<&Entry> = Vec::new();
    for entry in record.counted() {
        match &entry.act {
            Act::Comment { .. } => open.push(entry),
            Act::Resolve { of, .. } => resolved.extend(open.extract_if(.., |it| it.digest() == of)),
            Act::Reopen { of, .. } => open.extend(resolved.extract_if(.., |it| it.digest() == of)),
            Act::Withdraw { of, .. } => open.retain(|it| it.digest() != of),
            Act::Acknowledge { .. } | Act::Waive { .. } | Act::Approve { .. } | Act::Rules { .. } => {}
        }
    }
    open
}

impl Record {
    /// Returns who acknowledged which line, or waived it, last; each holds for a line as long as it says the same at
    /// the same place.
    pub fn acknowledgments(&self) -> BTreeMap<&LineKey, &Entry> {
        let mut last = BTreeMap::new();
        for (line, entries) in Accepted::new(self, &self.waivers()).0 {
            last.extend(entries.last().map(|entry| (line, *entry)));
        }
        last
    }

    /// The latest approval that has not been taken back, with what was approved: of those that completed the board in force, of
    /// those that completed a former board, or of all. Otherwise the first person who approves, or who
    /// approves under rules with an earlier date, would hide from the others what changed.
    pub fn last_approval(&self) -> Option<(&Entry, &Subject)> {
        let approvals: Vec<(&Entry, &Subject)> =
            self.standing_entries().filter_map(|entry| Some((entry, self.subject(entry)?))).collect();
        let completed = completed(self, &approvals).collect::<Vec<_>>();
        let present = completed.iter().rev().find(|(entry, _)| self.is_under_rules(entry));
        present.or(completed.last()).or(approvals.last()).copied()
    }
}

impl Standing<'_> {
    /// Returns what is in the way of any approval, in words.
    pub fn blockers(&self) -> Vec<String> {
        let some = |count: usize, one: &str, many: &str| {
            (count > 0).then(|| format!("{count} {}", if count == 1 { one } else { many }))
        };
        let missing = self.missing.map(str::to_owned);
        let names: BTreeSet<String> =
            self.conflicting_rules.iter().map(|entry| names::one_line(&entry.by)).collect();
        let conflicting = (!names.is_empty()).then(|| {
            let names = names.into_iter().collect::<Vec<_>>().join(" and ");
            format!("different flight rules are in force, set by {names}: their boards must agree to the same rules")
        });
        let unknown = self.unknown_rules.map(|entry| {
            let name = names::one_line(&entry.by);
            format!("{name}, whose key is unknown, has set flight rules: trust the key, or confirm the rules in force")
        });
        let needing_waivers = self.unacknowledged.iter().filter(|(_, line)| line.needs_waiver).count();
        missing
            .into_iter()
            .chain(conflicting)
            .chain(unknown)
            .chain(some(self.failed, "item has failed", "items have failed"))
            .chain(some(needing_waivers, "item needs a waiver", "items need waivers"))
            .chain(some(
                self.unacknowledged.len() - needing_waivers,
                "item that needs attention is not acknowledged",
                "items that need attention are not acknowledged",
            ))
            .chain(some(self.open_comments.len(), "comment is open", "comments are open"))
            .collect()
    }

    /// Whether the owner of a key may approve in a role; `Err` says why not.
    pub fn may_approve(&self, key: &PublicKey, role: &str) -> Result<(), String> {
        let blockers = self.blockers();
        let Some(wanted) = self.seats.iter().find(|seat| seat.role == role) else {
            return Err(format!("the board has no role \"{role}\""));
        };
        if !wanted.seat.admits(key) {
            return Err(format!(
                "the key {} does not approve as {role}: the flight rules name other keys for this role",
                key.fingerprint()
            ));
        }
        let is_own = |entry: &&&Entry| entry.key.as_ref() == Some(key);
        let given = self.seats.iter().find_map(|seat| Some((seat, seat.given.iter().find(is_own)?)));
        match given {
            _ if !blockers.is_empty() => Err(blockers.join(", ")),
            Some((seat, entry)) => Err(format!("{} has approved as {} already", entry.by, seat.role)),
            None => Ok(()),
        }
    }

    /// The roles in words: `Science 1 of 2, Mobility 0 of 1`.
    pub fn seats_in_words(&self) -> String {
        let seat = |seat: &Approvals<'_>| format!("{} {} of {}", seat.role, seat.given.len(), seat.wanted);
        self.seats.iter().map(seat).collect::<Vec<_>>().join(", ")
    }
}
