//! The review of the mission.

use review::record::{Act, Entry, LineKey};
use review::{
    Check, FlightRules, Line, PlanStatus, Present, Record, Section, Signature, Status, WaiverState,
};
use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;

/// The review of the mission.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Review {
    /// The hash of the reviewed text, map and seed; `null` before the first review of this mission.
    pub hash: Option<String>,
    /// The hash of the present text, map and seed.
    pub current_hash: Option<String>,
    /// The hash of the reviewed plan; empty without one.
    pub plan_hash: Option<String>,
    /// Whether the content, the plan or the search has changed since.
    pub stale: bool,
    pub running: bool,
    #[cfg_attr(test, ts(type = "\"information\" | \"passed\" | \"attention\" | \"failed\" | null"))]
    pub status: Option<Status>,
    pub counts: Option<ReviewCounts>,
    /// The flight rules: see section 16 of the specification.
    #[cfg_attr(
        test,
        ts(
            type = "{ margin: number | string | null; clearance_m: number | null; slope_deg: number | null; reserve: number | string | null; reserves: Record<string, number | string>; success_rate: { wanted: number; least: number } | null; rules: { name: string; rule: string; source: string; waivable: boolean }[]; board: { role: string; approvals: number; people: string[] }[] }"
        )
    )]
    pub rules: FlightRules,
    pub items: Vec<ReviewItem>,
    /// The status of the plan with its board.
    #[cfg_attr(
        test,
        ts(
            type = "\"draft\" | \"in-review\" | \"approved\" | \"approved-with-comments\" | \"lapsed\" | null"
        )
    )]
    pub plan_status: Option<PlanStatus>,
    /// The required approvals, and who has given them.
    pub board: Vec<BoardSeat>,
    /// What blocks any approval.
    pub blockers: Vec<String>,
    /// The latest approval that has not been withdrawn.
    pub signed: Option<SignOff>,
    pub comments: Vec<ReviewComment>,
    /// All acts, in order.
    pub history: Vec<HistoryEntry>,
    /// The digests of the last entries of the history.
    pub heads: Vec<String>,
    /// Why a saved review of this mission was set aside and is not used, if there is one.
    pub aside: Option<String>,
    /// Why the history is not saved beyond this visit; `null` if it is saved.
    pub unkept: Option<String>,
    /// The waivers that count, oldest first.
    pub waivers: Vec<ReviewWaiver>,
    /// The people whose signatures count here.
    pub people: Vec<ReviewPerson>,
}

/// A waiver of an item until some day.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewWaiver {
    /// The entry of the history.
    pub id: String,
    /// The text of the item.
    pub item: String,
    pub reason: String,
    pub by: String,
    /// The day on which it lapses: `2026-01-31`.
    pub until: String,
    #[cfg_attr(test, ts(type = "\"in-force\" | \"about-to-lapse\" | \"lapsed\""))]
    pub state: WaiverState,
}

/// Someone whose signatures count here.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewPerson {
    pub name: String,
    /// The public key, in 64 hexadecimal digits.
    pub key: String,
    /// Whether that person can sign here.
    pub own: bool,
}

/// How many items of a review have each status.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewCounts {
    pub passed: usize,
    pub attention: usize,
    pub failed: usize,
    /// Items without a criterion.
    pub information: usize,
}

/// An item of a review.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewItem {
    #[cfg_attr(test, ts(type = "string"))]
    pub section: Section,
    #[cfg_attr(test, ts(type = "\"information\" | \"passed\" | \"attention\" | \"failed\""))]
    pub status: Status,
    pub text: String,
    /// Its criterion, with the source of the criterion.
    pub criterion: Option<String>,
    /// The line of its place in the text, from 1.
    pub line: Option<u32>,
    /// Its subjects, by their names in all output.
    pub names: Vec<String>,
    /// Who acknowledged it, and the reason.
    #[cfg_attr(test, ts(type = "{ by: string; text: string } | null"))]
    pub acknowledged: Option<Acknowledged>,
}

/// Someone has acknowledged an item.
#[derive(Debug, Serialize)]
pub struct Acknowledged {
    pub by: String,
    pub text: String,
}

/// A role of the board.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct BoardSeat {
    pub role: String,
    /// The required number of approvals.
    pub wanted: usize,
    /// Who has approved the present plan.
    pub given: Vec<String>,
}

/// A comment.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewComment {
    /// The argument of `review.resolve`, `review.reopen` and `review.withdraw`.
    pub id: String,
    pub author: String,
    pub role: String,
    /// An ISO 8601 time in UTC.
    pub time: String,
    pub about: Option<String>,
    pub text: String,
    pub content_hash: String,
    /// Whether it is neither resolved nor withdrawn.
    pub open: bool,
}

/// An entry of the history.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct HistoryEntry {
    /// Its digest.
    pub id: String,
    pub by: String,
    pub role: String,
    /// An ISO 8601 time in UTC.
    pub time: String,
    /// The act, in words.
    pub act: String,
    /// The words of the entry.
    pub text: String,
    /// The entry that it is about.
    pub of: Option<String>,
    /// The content that it is about.
    pub hash: String,
    /// The plan that it is about; empty if none was known.
    pub plan_hash: String,
    /// Whether someone withdrew it.
    pub withdrawn: bool,
    /// The public key that it names, in 64 hexadecimal digits; `null` in histories of earlier versions.
    pub key: Option<String>,
    #[cfg_attr(test, ts(type = "\"valid\" | \"unknown\" | \"broken\" | \"unsigned\""))]
    pub signature: Signature,
    /// Why it does not count in spite of its signature, or another problem with it.
    pub problem: Option<String>,
    /// Whether it counts.
    pub counts: bool,
    /// Why it has no effect although it counts: it weakens the board, which has not agreed.
    pub without_effect: Option<String>,
}

/// An approval of a plan.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct SignOff {
    pub name: String,
    /// An ISO 8601 time in UTC.
    pub time: String,
    pub role: String,
    /// The content that was approved.
    pub hash: String,
    /// Whether the content, the plan or the rules have changed since.
    pub stale: bool,
}

pub(super) fn review(state: &AppState) -> Review {
    let record = state.review.record();
    let standing = state.review.standing();
    let shown = state.review.shown();
    Review {
        hash: shown.map(|(review, _)| review.content_hash.clone()),
        current_hash: state.review.hash().map(ToString::to_string),
        plan_hash: shown.map(|(review, _)| review.plan_hash.clone()),
        stale: shown.is_some_and(|(_, is_stale)| is_stale),
        running: state.review.is_running(),
        status: shown.map(|(review, _)| review.status),
        counts: shown.map(|(review, _)| {
            let [passed, attention, failed] = review.counts();
            ReviewCounts { passed, attention, failed, information: review.count(Status::Information) }
        }),
        rules: record.rules().clone(),
        items: shown.map(|(review, _)| items(review, record)).unwrap_or_default(),
        plan_status: standing.as_ref().map(|standing| standing.status),
        board: standing.iter().flat_map(|standing| &standing.seats).map(seat).collect(),
        blockers: standing.as_ref().map(review::Standing::blockers).unwrap_or_default(),
        signed: signed(state),
        comments: comments(record),
        history: history(record),
        waivers: waivers(record),
        people: people(state),
        heads: record.heads().map(str::to_owned).collect(),
        aside: state.review.aside().map(|aside| aside.reason.clone()),
        unkept: state.review.unkept().map(ToString::to_string),
    }
}

fn seat(seat: &review::board::Approvals<'_>) -> BoardSeat {
    let given = seat.given.iter().map(|entry| entry.by.clone()).collect();
    BoardSeat { role: seat.role.to_owned(), wanted: seat.wanted, given }
}

/// The latest approval that has not been withdrawn.
fn signed(state: &AppState) -> Option<SignOff> {
    let record = state.review.record();
    let (entry, subject) = record.last_approval()?;
    let review = state.review.current().map(AsRef::as_ref);
    let present = Present {
        content_hash: state.review.hash().unwrap_or_default(),
        plan_hash: review.map(|review| review.plan_hash.as_str()),
        rules: record.rules(),
        review,
    };
    Some(SignOff {
        name: entry.by.clone(),
        time: entry.time.clone(),
        role: entry.role.clone(),
        hash: entry.content_hash.clone(),
        stale: present.difference(record, entry, subject).is_some(),
    })
}

fn waivers(record: &Record) -> Vec<ReviewWaiver> {
    let waiver = |waiver: review::Waiver<'_>| ReviewWaiver {
        id: waiver.entry.digest().to_owned(),
        item: waiver.line.text.clone(),
        reason: waiver.entry.act.text().to_owned(),
        by: waiver.entry.by.clone(),
        until: waiver.until.to_owned(),
        state: waiver.state,
    };
    record.waivers().into_iter().map(waiver).collect()
}

fn people(state: &AppState) -> Vec<ReviewPerson> {
    let person = |person: &review::keys::Person| ReviewPerson {
        name: person.name.clone(),
        key: person.key.as_str().to_owned(),
        own: person.secret.is_some(),
    };
    state.keys.ring().people().iter().map(person).collect()
}

fn comments(record: &Record) -> Vec<ReviewComment> {
    let open = review::board::open_comments(record);
    let comment = |entry: &Entry| {
        let Act::Comment { about, text, .. } = &entry.act else { return None };
        Some(ReviewComment {
            id: entry.digest().to_owned(),
            author: entry.by.clone(),
            role: entry.role.clone(),
            time: entry.time.clone(),
            about: about.clone(),
            text: text.clone(),
            content_hash: entry.content_hash.clone(),
            open: open.iter().any(|it| it.digest() == entry.digest()),
        })
    };
    record.entries().iter().filter_map(comment).collect()
}

fn history(record: &Record) -> Vec<HistoryEntry> {
    let withdrawn = record.withdrawn();
    let entry = |(entry, check): (&Entry, &Check)| HistoryEntry {
        id: entry.digest().to_owned(),
        by: entry.by.clone(),
        role: entry.role.clone(),
        time: entry.time.clone(),
        act: entry.act.name().to_owned(),
        text: entry.act.text().to_owned(),
        of: entry.act.of().map(str::to_owned),
        hash: entry.content_hash.clone(),
        plan_hash: entry.plan_hash.clone(),
        withdrawn: withdrawn.contains_key(entry.digest()),
        key: entry.key.as_ref().map(|key| key.as_str().to_owned()),
        signature: check.signature,
        problem: check.problem.clone(),
        counts: check.counts(),
        without_effect: record.without_effect(entry),
    };
    record.checked().map(entry).collect()
}

fn items(review: &review::Review, record: &Record) -> Vec<ReviewItem> {
    let acknowledged = record.acknowledgments();
    let by = |section: Section, line: &Line| {
        let entry = (line.status == Status::Attention)
            .then(|| acknowledged.get(&LineKey::new(section, line)))
            .flatten()?;
        Some(Acknowledged { by: entry.by.clone(), text: entry.act.text().to_owned() })
    };
    let mut items = Vec::new();
    for section in Section::ALL {
        items.extend(review.lines(section).into_iter().map(|line| ReviewItem {
            section,
            status: line.status,
            text: line.text.clone(),
            criterion: line.criterion.clone(),
            line: line.line_number,
            names: line.names.iter().map(ToString::to_string).collect(),
            acknowledged: by(section, line),
        }));
    }
    items
}
