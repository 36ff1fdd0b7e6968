//! The review of the mission.

use mission::review::record::Comment;
use mission::review::{FlightRules, Section, Status};
use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

use crate::state::AppState;
use crate::state::review::Signed;

/// The review of the mission.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
#[serde(rename_all = "camelCase")]
pub struct Review {
    /// The hash of what was reviewed; `null` before the first review of this mission.
    hash: Option<String>,
    /// The hash of the present text, map and seed.
    current_hash: Option<String>,
    /// Whether the two differ.
    stale: bool,
    running: bool,
    #[cfg_attr(test, ts(type = "\"information\" | \"passed\" | \"attention\" | \"failed\" | null"))]
    status: Option<Status>,
    counts: Option<ReviewCounts>,
    /// What the mission is held against: see section 16 of the specification.
    #[cfg_attr(
        test,
        ts(
            type = "{ margin: number | string | null; clearance_m: number | null; slope_deg: number | null; reserve: number | string | null; reserves: Record<string, number | string>; success_rate: { wanted: number; least: number } | null }"
        )
    )]
    rules: FlightRules,
    items: Vec<ReviewItem>,
    /// The latest sign-off of the present content, otherwise the latest of any.
    signed: Option<SignOff>,
    #[cfg_attr(
        test,
        ts(
            type = "{ author: string; time: string; about: string | null; text: string; content_hash: string }[]"
        )
    )]
    comments: Vec<Comment>,
    /// Why comments and sign-offs are not kept beyond this visit, if they are not.
    unkept: Option<String>,
}

/// How many lines of a review stand how.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewCounts {
    passed: usize,
    attention: usize,
    failed: usize,
    /// Lines that say how things are, with nothing to hold them against.
    information: usize,
}

/// A line of a review.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct ReviewItem {
    #[cfg_attr(test, ts(type = "string"))]
    section: Section,
    #[cfg_attr(test, ts(type = "\"information\" | \"passed\" | \"attention\" | \"failed\""))]
    status: Status,
    text: String,
    /// What it is held against, and where that comes from.
    criterion: Option<String>,
    /// The line of its place in the text, from 1.
    line: Option<u32>,
    /// What it is about, by the names of all output.
    names: Vec<String>,
}

/// Somebody vouches for a plan.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct SignOff {
    name: String,
    /// An ISO 8601 time in UTC.
    time: String,
    /// The content that was signed.
    hash: String,
    /// Whether the present content is another.
    stale: bool,
}

pub(super) fn review(state: &AppState) -> Review {
    let sign_off = |by: &mission::review::record::SignOff, stale: bool| SignOff {
        name: by.name.clone(),
        time: by.time.clone(),
        hash: by.content_hash.clone(),
        stale,
    };
    let signed = match state.review.signed() {
        Signed::Never => None,
        Signed::Current(by) => Some(sign_off(by, false)),
        Signed::Stale(by) => Some(sign_off(by, true)),
    };
    let shown = state.review.shown(state.settings.plan.search);
    Review {
        hash: shown.map(|(review, _)| review.content_hash.clone()),
        current_hash: state.review.hash().map(ToString::to_string),
        stale: shown.is_some_and(|(_, is_stale)| is_stale),
        running: state.review.is_running(),
        status: shown.map(|(review, _)| review.status),
        counts: shown.map(|(review, _)| {
            let [passed, attention, failed] = review.counts();
            ReviewCounts { passed, attention, failed, information: review.count(Status::Information) }
        }),
        rules: state.review.record().rules(),
        items: shown.map(|(review, _)| items(review)).unwrap_or_default(),
        signed,
        comments: state.review.record().comments.clone(),
        unkept: state.review.unkept().map(ToString::to_string),
    }
}

fn items(review: &mission::review::Review) -> Vec<ReviewItem> {
    let items = Section::ALL.iter().flat_map(|&section| {
        review.lines(section).into_iter().map(move |line| ReviewItem {
            section,
            status: line.status,
            text: line.text.clone(),
            criterion: line.criterion.clone(),
            line: line.line_number,
            names: line.names.iter().map(ToString::to_string).collect(),
        })
    });
    items.collect()
}
