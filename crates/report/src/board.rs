//! The board in a report: how the plan stands, who approved it, what is open, what differs since the last approval, and
//! the whole history.

use std::collections::BTreeMap;

use review::record::{Act, Entry, LineKey, Rate, short};
use review::since::{LineChange, TextChange};
use review::{
    PlanStatus, Present, Record, Review, Signature, Since, Standing, Status, WaiverState, since, standing,
};

use crate::Document;
use crate::figure;
use crate::html::readable_time;
use crate::shown::{sentence, shown};
use crate::tables::{status, table, word};

/// The word for how a plan stands, with its sign and in its color.
pub(crate) fn status_word(status: PlanStatus) -> String {
    let look = match status {
        PlanStatus::Draft | PlanStatus::InReview => "information",
        PlanStatus::Approved => "passed",
        PlanStatus::ApprovedWithComments | PlanStatus::Lapsed => "attention",
    };
    word(look, status.name())
}

/// Returns how the plan stands, in the table of facts.
pub(crate) fn fact(record: &Record, review: &Review) -> String {
    let standing = standing(record, &Present::of_review(review));
    let lapsed = match (standing.status, standing.lapsed) {
        (PlanStatus::Lapsed, Some((last, why))) => {
            format!("; {} approved {}: {why}", shown(&last.by), shown(&readable_time(&last.time)))
        }
        _ => String::new(),
    };
    format!("{}; approvals: {}{lapsed}", status_word(standing.status), shown(&standing.seats_in_words()))
}

/// Returns where the board signs on paper, with those who have approved this very plan.
pub(crate) fn signatures(record: &Record, review: &Review) -> String {
    let standing = standing(record, &Present::of_review(review));
    let mut rows = Vec::new();
    for seat in &standing.seats {
        for entry in &seat.given {
            rows.push(vec![
                shown(seat.role),
                shown(&entry.by),
                shown(&readable_time(&entry.time)),
                shown(entry.act.text()),
                format!("<code>{}</code>", shown(short(entry.digest()))),
                String::new(),
            ]);
        }
        for _ in seat.given.len()..seat.wanted {
            let mut row = vec!["&nbsp;".to_owned(); 6];
            row[0] = shown(seat.role);
            rows.push(row);
        }
    }
    let rows = table(&["Role", "Name", "Date", "Comment", "Entry", "Signature"], rows);
    let blockers = standing.blockers();
    let open = if blockers.is_empty() {
        String::new()
    } else {
        format!("<p>Approval blocked: {}.</p>\n", shown(&blockers.join("; ")))
    };
    format!(
        "<div class=\"signatures\">\n<h2>Signatures</h2>\n{open}{rows}</div>\n{}",
        open_comments(&standing)
    )
}

fn open_comments(standing: &Standing<'_>) -> String {
    if standing.open_comments.is_empty() {
        return String::new();
    }
    let rows = standing.open_comments.iter().map(|entry| {
        vec![status(Status::Attention), who(entry), shown(&readable_time(&entry.time)), words(entry)]
    });
    format!("<h3>Open comments</h3>\n{}", table(&["", "Author", "Date", "Comment"], rows))
}

/// Returns who acknowledged a line and why, if someone has.
pub(crate) fn acknowledgment(acknowledged: &BTreeMap<&LineKey, &Entry>, key: &LineKey) -> String {
    let Some(entry) = acknowledged.get(key) else { return String::new() };
    let until = match &entry.act {
        Act::Waive { until, .. } => format!(" (waived until {})", shown(until)),
        _ => String::new(),
    };
    format!("{}: {}{until}", who(entry), lines_of(entry.act.text()))
}

/// The waivers, whether in force or lapsed; nothing where there are none.
pub(crate) fn waivers(record: &Record) -> String {
    let waivers = record.waivers();
    if waivers.is_empty() {
        return String::new();
    }
    let rows = waivers.iter().map(|waiver| {
        let look = match waiver.state {
            WaiverState::InForce => "passed",
            WaiverState::AboutToLapse => "attention",
            WaiverState::Lapsed => "failed",
        };
        vec![
            word(look, waiver.state.name()),
            sentence(&waiver.line.text),
            lines_of(waiver.entry.act.text()),
            who(waiver.entry),
            shown(waiver.until),
        ]
    });
    format!("<h2>Waivers</h2>\n{}", table(&["", "Item", "Reason", "Author", "Lapses on"], rows))
}

/// Returns what differs since the last approval; nothing where no one has approved.
pub(crate) fn changes(document: &Document<'_>, record: &Record) -> String {
    let Some((entry, approved)) = record.last_approval() else { return String::new() };
    let since = since(approved, document.snapshot, document.review, document.robustness);
    let mut out = format!(
        "<h2>Since the last approval</h2>\n<p class=\"muted\">By {}, {}, of content <code>{}</code>.</p>\n",
        who(entry),
        shown(&readable_time(&entry.time)),
        shown(short(&entry.content_hash))
    );
    if since.is_nothing() {
        out.push_str("<p>Text, plan, checklist, flight rules and Monte Carlo results are unchanged.</p>\n");
        return out;
    }
    if !since.text.is_empty() {
        out.push_str(&format!("<h3>Text</h3>\n<pre class=\"program\">{}</pre>\n", text(&since.text)));
    }
    out.push_str(&plan(&since));
    if since.plan.as_ref().is_some_and(|plan| !plan.is_same()) {
        out.push_str(&figure::html(&figure::timeline_since(document.snapshot, approved)));
        out.push_str(&figure::html(&figure::network_since(document.snapshot, approved)));
    }
    if !since.lines.is_empty() {
        let rows = since.lines.iter().map(line);
        out.push_str(&format!("<h3>Checklist</h3>\n{}", table(&["Section", "Change"], rows)));
    }
    if !since.rules.is_empty() {
        let rows = since.rules.iter().map(|pair| pair.iter().map(|rule| shown(rule)).collect());
        out.push_str(&format!("<h3>Flight rules</h3>\n{}", table(&["Before", "Now"], rows)));
    }
    if let Some(rates) = since.robustness {
        let [before, after] = rates.map(rate);
        out.push_str(&format!("<h3>Robustness</h3>\n<p>{before} → {after}</p>\n"));
    }
    out
}

fn plan(since: &Since) -> String {
    let heading = "<h3>Plan</h3>\n";
    match &since.plan {
        None => format!("{heading}<p>The approved plan was not saved.</p>\n"),
        Some(plan) if plan.is_same() => String::new(),
        Some(plan) => {
            let rows =
                plan.differences.iter().map(|it| vec![shown(it.subject.name()), sentence(&it.sentence())]);
            format!("{heading}<p>{}</p>\n{}", shown(&plan.summary()), table(&["", "What"], rows))
        }
    }
}

/// Lines of text that are written, at most.
const MAX_TEXT_LINES: usize = 400;

fn text(changes: &[TextChange]) -> String {
    let mut lines = Vec::new();
    for change in changes {
        lines.push(format!("<i class=\"comment\">@ line {}</i>", change.after_line));
        lines.extend(change.removed.iter().map(|line| format!("<del>− {}</del>", shown(line))));
        lines.extend(change.added.iter().map(|line| format!("<ins>+ {}</ins>", shown(line))));
    }
    let more = lines.len().saturating_sub(MAX_TEXT_LINES);
    lines.truncate(MAX_TEXT_LINES);
    if more > 0 {
        lines.push(format!("and {more} more lines, not listed"));
    }
    lines.join("\n")
}

fn line(change: &LineChange) -> Vec<String> {
    let section = change.section().map(review::Section::title).unwrap_or_default();
    vec![section.to_owned(), sentence(&change.sentence())]
}

fn rate(rate: Option<Rate>) -> String {
    match rate {
        Some(rate) => format!("{} of {} runs (seed {})", rate.succeeded, rate.runs, rate.seed),
        None => "no runs".to_owned(),
    }
}

/// Everything that was done, in order, and the digest that vouches for it.
pub(crate) fn history(record: &Record, review: &Review) -> String {
    if record.entries().is_empty() {
        return String::new();
    }
    let withdrawn = record.withdrawn();
    let rows = record.checked().enumerate().map(|(index, (entry, check))| {
        let of = entry.act.of().map(|of| format!(" entry {}", record.number(of))).unwrap_or_default();
        let look = match check.signature {
            _ if record.without_effect(entry).is_some() => "attention",
            _ if check.counts() => "passed",
            Signature::Broken => "failed",
            Signature::Valid | Signature::Unknown | Signature::Unsigned => "attention",
        };
        let taken_back = withdrawn.get(entry.digest());
        let state = match taken_back {
            Some(by) => word("attention", &format!("withdrawn by {}", shown(&by.by))),
            None if entry.content_hash == review.content_hash => word("passed", "current"),
            None if matches!(entry.act, Act::Rules { .. }) => String::new(),
            None => word("information", "different content"),
        };
        vec![
            (index + 1).to_string(),
            shown(&readable_time(&entry.time)),
            who(entry),
            format!("{}{of}", entry.act.name()),
            words(entry),
            state,
            word(look, &shown(&record.words_of(entry, check))),
            format!("<code>{}</code>", shown(short(&entry.content_hash))),
            format!("<code>{}</code>", shown(short(entry.digest()))),
        ]
    });
    let headings = ["#", "Date", "Author", "Action", "Comment", "", "Signature", "Content", "Entry"];
    let rows = table(&headings, rows);
    let heads: Vec<String> = record.heads().map(|head| format!("<code>{}</code>", shown(head))).collect();
    format!(
        "<h2>History of the review</h2>\n{rows}<p class=\"muted\">Each entry is signed, with the entries before it. Only entries with valid signatures of trusted keys count. Last entry: {}</p>\n",
        heads.join(", ")
    )
}

fn who(entry: &Entry) -> String {
    let name = if entry.by.is_empty() { "someone" } else { entry.by.as_str() };
    if entry.role.is_empty() { shown(name) } else { format!("{} ({})", shown(name), shown(&entry.role)) }
}

/// Returns what was said, and what it is about.
fn words(entry: &Entry) -> String {
    let text = lines_of(entry.act.text());
    match &entry.act {
        Act::Comment { about: Some(about), .. } => format!("<i>{}</i><br>{text}", shown(about)),
        Act::Acknowledge { line, .. } | Act::Waive { line, .. } => {
            format!("<i>{}</i><br>{text}", sentence(&line.text))
        }
        _ => text,
    }
}

fn lines_of(text: &str) -> String {
    shown(text).replace('\n', "<br>")
}
