//! The review report: one HTML file that needs nothing else, prints well and reads without scripts.

use data_encoding::BASE64;
use review::{Record, Review, Status};
use sha2::{Digest as _, Sha256};
use snapshot::{Robustness, Snapshot};
use terrain::Terrain;

use crate::shown::shown;
use crate::style::STYLE;
use crate::{board, export, figure, listing, tables};

/// What goes into a report.
#[derive(Clone, Copy)]
pub struct Document<'a> {
    /// The mission's name: that of its file.
    pub name: &'a str,
    /// The mission as it was worked out.
    pub snapshot: &'a Snapshot,
    pub review: &'a Review,
    /// What the board said and approved, if that is to stand in the report.
    pub record: Option<&'a Record>,
    /// How its plan fares in many runs with chance, if that is known.
    pub robustness: Option<&'a Robustness>,
    /// The seed of its paths.
    pub seed: u64,
    /// The ground, if the mission has one.
    pub ground: Option<&'a Terrain>,
}

/// Returns what a report may do wherever it is opened: look as its own style sheet says, and nothing else. It runs no
/// script, loads nothing and sends nothing, whatever a mission's names say. The style sheet is allowed by what it says
/// (CSP 3, section 2.3.1), so that no other can slip in.
fn policy(style: &str) -> String {
    let digest = BASE64.encode(&Sha256::digest(style.as_bytes()));
    format!("default-src 'none'; style-src 'sha256-{digest}'; base-uri 'none'; form-action 'none'")
}

/// Writes the report.
pub fn html(document: &Document<'_>) -> String {
    let review = document.snapshot.network.as_deref().map(|network| document.review.readable(network));
    let document = &Document { review: review.as_ref().unwrap_or(document.review), ..*document };
    let title = format!("Mission review: {}", document.name);
    let nothing = Record::default();
    let record = document.record.unwrap_or(&nothing);
    let hash = &document.review.content_hash;
    let content = content(document, record);
    let sheets = most_sheets(&content);
    let style = format!("{STYLE}{}{}", page_margins(hash), sheet_rules(sheets));
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{1}\">\n\
         <meta name=\"generator\" content=\"{2}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{0}</title>\n<style>{style}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
        shown(&title),
        policy(&style),
        review::PROGRAM
    );
    out.push_str(&in_content(hash, sheets));
    out.push_str(&content);
    out.push_str("<p class=\"end\">End of the report</p>\n</body>\n</html>\n");
    out
}

/// Returns what is below the title.
fn content(document: &Document<'_>, record: &Record) -> String {
    let mut out = facts(document, record);
    out.push_str(&tables::summary(document.review, document.record));
    out.push_str(&board::signatures(record, document.review));
    out.push_str(&board::waivers(record));
    out.push_str(&board::changes(document, record));
    out.push_str(&tables::sections(document.review));
    out.push_str(&tables::robustness(document.review, document.robustness));
    out.push_str(&tables::rules(document.review));
    out.push_str(&board::history(record, document.review));
    out.push_str(&figures(document));
    out.push_str("<h2 class=\"page\">Program</h2>\n");
    out.push_str(&listing::listing(&document.snapshot.source));
    out
}

/// Returns what is below each printed page: its number and which content it is about.
fn page_margins(content_hash: &str) -> String {
    // Hexadecimal digits only, so that nothing can end the text.
    let hash: String = content_hash.chars().filter(char::is_ascii_hexdigit).collect();
    format!(
        "@page {{ @bottom-left {{ content: \"Content {hash}\"; font-size: 6.5pt; color: #4e5b6a; }} \
         @bottom-right {{ content: \"Page \" counter(page) \" of \" counter(pages); font-size: 8pt; color: #4e5b6a; }} }}\n"
    )
}

/// Returns how many pages the report has at most: a page holds more rows, lines and drawings than are counted here.
fn most_sheets(content: &str) -> usize {
    let count = |element: &str| content.matches(element).count();
    20 + count("<tr") / 6 + count("<figure") + count("class=\"line\"") / 15 + content.len() / 20_000
}

/// Returns where the number of each page lies, for browsers that put nothing into the margins of pages.
fn sheet_rules(sheets: usize) -> String {
    (1..=sheets).map(|sheet| format!(".sheets :nth-child({sheet}) {{ --sheet: {sheet}; }}\n")).collect()
}

/// The hash and the numbers of pages for these browsers. They are not part of what is read aloud.
fn in_content(hash: &str, sheets: usize) -> String {
    let numbers: String = (1..=sheets).map(|sheet| format!("<i>Page {sheet}</i>")).collect();
    format!(
        "<p class=\"foot\" aria-hidden=\"true\">Content {}</p>\n<div class=\"sheets\" aria-hidden=\"true\">{numbers}</div>\n",
        shown(hash)
    )
}

fn facts(document: &Document<'_>, record: &Record) -> String {
    let review = document.review;
    let [passed, attention, failed] = review.counts();
    let information = review.count(Status::Information);
    let verdict = match review.status {
        Status::Information | Status::Passed => "passed",
        Status::Attention => "needs attention",
        Status::Failed => "not ready",
    };
    let unit = export::unit_in_words(document.snapshot);
    let map = match &document.snapshot.map {
        Some(key) if !key.asset.is_empty() => key.asset.to_string(),
        Some(_) => "flat ground".to_owned(),
        None => "none".to_owned(),
    };
    let need = if attention == 1 { "needs" } else { "need" };
    format!(
        "<dl class=\"facts\">\n<dt>Verdict</dt><dd>{}</dd>\n\
         <dt>Checklist</dt><dd>{passed} passed, {attention} {need} attention, {failed} failed; {information} informational</dd>\n\
         <dt>Times</dt><dd>in {unit} from the start of the mission</dd>\n\
         <dt>Map, seed</dt><dd>{}, {}</dd>\n\
         <dt>Board</dt><dd>{}</dd>\n\
         <dt>Content hash</dt><dd class=\"hash\">{}</dd>\n\
         <dt>Program</dt><dd>{}</dd>\n</dl>\n",
        tables::word(review.status.name(), verdict),
        shown(&map),
        document.seed,
        board::fact(record, review),
        shown(&review.content_hash),
        review::PROGRAM
    )
}

/// `2026-01-02T03:04:05Z` as `2026-01-02 03:04 UTC`; another text as it is.
pub(crate) fn readable_time(time: &str) -> String {
    match (time.get(..10), time.get(11..16), time.ends_with('Z')) {
        (Some(day), Some(minute), true) => format!("{day} {minute} UTC"),
        _ => time.to_owned(),
    }
}

fn figures(document: &Document<'_>) -> String {
    let snapshot = document.snapshot;
    let figures = [
        ("Timeline", figure::timeline(snapshot, document.review)),
        ("Network", figure::network(snapshot, document.review)),
        ("Map", figure::map(snapshot, document.ground).into_iter().collect()),
    ];
    let drawn = figures.iter().filter(|(_, figures)| !figures.is_empty());
    drawn.map(|(heading, figures)| figure::under_heading(heading, figures)).collect()
}
