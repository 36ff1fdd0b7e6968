//! What is written of a mission or a network that was read and planned: the report, schedules for other tools, drawings,
//! and the network in other notations. Each has to be sound in its own format, whatever names and times the text has.

use std::sync::Arc;

use interchange::geojson::Projection;
use interchange::{Source, is_network_text};
use interchange::{plan_schema, ptpn, rmpl_text};
use link::Request;
use mission::Core;
use report::calendar::Calendar;
use report::export::{self, About, CSV_COLUMNS};
use review::{PlanStatus, Record, content_hash, review};
use snapshot::{Goal, Snapshot};

use super::missions::{Bounded, WORDS, last_snapshot, update_of};
use super::{NOTHING, Outcome, Reader, magnitude, nothing, read, refused, text_of};

/// Missions and networks with a plan, written in every way.
pub(super) const EXPORTS: Reader = Reader {
    name: "exports",
    seeds: &["assets/missions/*.rmpl", "tests/fuzz/corpus/networks/*", "tests/fuzz/corpus/ptpn/*"],
    words: WORDS,
    mend: nothing,
    exercise: exports,
    tested: 60,
    keeps_form: 8,
    cost: 40,
};

fn exports(input: &[u8]) -> Outcome {
    let text = &*text_of(input);
    let mut host = Bounded::new(300);
    Core::default().handle(Request::Update(update_of(text)), &mut host);
    let Some(snapshot) = last_snapshot(&host) else { return NOTHING };
    let Some(network) = snapshot.network.clone() else { return refused("no network") };
    let drawn = layout::network(&network, &layout::Options::default(), &display::approximate_text_width);
    let list = layout::network_list(&drawn, &network, &layout::NetworkState::default());
    well_formed(&display::svg(&[&list], display::Theme::Light, "Network"));
    let as_json = plan_schema::write(&network).to_string();
    assert!(Source::read(&as_json).is_ok(), "what is written can be read");
    let mut led = String::new();
    match ptpn::write(&network) {
        Ok(text) => {
            well_formed(&text);
            assert!(is_network_text(&text));
        }
        Err(reason) => led += &reason.to_string(),
    }
    if rmpl_text::write(&network, &["a name\nof two lines".to_owned()]).is_err() {
        led += " no RMPL";
    }
    if snapshot.plan().is_some() {
        led += &plan_written(&snapshot);
    }
    let counts = [network.occurrences.len(), network.arcs.len(), network.decisions.len()].map(magnitude);
    read(&format!("{led} {}", String::from_iter(counts)))
}

/// Writes what there is of a plan. Returns what could not be written.
fn plan_written(snapshot: &Arc<Snapshot>) -> String {
    let hash = content_hash(&snapshot.source, snapshot.map.as_ref(), &Goal::Default, 1);
    let unit = snapshot.program.options.time_unit;
    let calendar = Calendar::new("1999-12-31T23:59:59.5Z", unit).expect("a date");
    let about = About {
        content_hash: &hash,
        status: PlanStatus::Draft,
        calendar: Some(&calendar),
        pins: &[],
        plan: None,
    };
    let mut led = String::new();
    match export::csv(snapshot, &about) {
        Some(table) => is_table(&table),
        None => led += " no table",
    }
    match export::icalendar(snapshot, &about) {
        Some(text) => is_calendar(&text),
        None => led += " no calendar",
    }
    for document in [
        export::json(snapshot, &about),
        export::open_mct(snapshot, &about),
        report::plandev::plandev(snapshot, &about),
    ] {
        match document {
            Some(document) => {
                let again = serde_json::from_str::<serde_json::Value>(&document.to_string());
                assert_eq!(again.ok(), Some(document), "numbers that JSON has");
            }
            None => led += " no document",
        }
    }
    if let Some(plan) = report::plandev::plandev(snapshot, &about) {
        assert!(Source::read(&plan.to_string()).is_ok(), "a plan of PlanDev is read again");
    }
    let projection = Projection::Degrees { origin_deg: [179.9, -45.0], radius_m: 3_389_500.0 };
    let places = report::geojson::geojson(snapshot, &projection);
    assert!(serde_json::from_str::<serde_json::Value>(&places.to_string()).is_ok());
    let mut left = 400;
    let review = review(snapshot, &Goal::Default, 1, &mut || {
        left -= 1;
        left <= 0
    });
    let page = report::html(&report::Document {
        name: "mission",
        snapshot,
        review: &review,
        record: Some(&Record::default()),
        robustness: None,
        seed: 1,
        ground: None,
    });
    assert!(!page.to_ascii_lowercase().contains("<script"), "nothing in a report runs");
    assert!(page.chars().all(|letter| matches!(letter, '\n' | '\t') || !letter.is_control()));
    led
}

/// XML that other programs read.
fn well_formed(xml: &str) {
    let options = roxmltree::ParsingOptions { nodes_limit: u32::MAX, ..Default::default() };
    let parsed = roxmltree::Document::parse_with_options(xml, options);
    assert!(parsed.is_ok(), "{:?}", parsed.err());
}

/// A table after RFC 4180: as many cells in each line as there are columns.
fn is_table(table: &str) {
    let (mut cells, mut is_quoted, mut letters) = (1, false, table.chars());
    while let Some(letter) = letters.next() {
        match letter {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => cells += 1,
            '\r' if !is_quoted => {
                assert_eq!(letters.next(), Some('\n'), "lines end with CR LF");
                assert_eq!(cells, CSV_COLUMNS.len(), "{table}");
                cells = 1;
            }
            '\n' => assert!(is_quoted, "{table}"),
            _ => {}
        }
    }
    assert!(!is_quoted && table.ends_with("\r\n"));
}

/// A calendar after RFC 5545: lines of at most 75 bytes that end with CR LF, no control characters, and what begins ends.
fn is_calendar(text: &str) {
    let rest = text.strip_suffix("\r\n").expect("the last line ends");
    let mut open = Vec::new();
    for line in rest.split("\r\n") {
        assert!(line.len() <= 75, "{line}");
        assert!(!line.chars().any(char::is_control), "{line:?}");
    }
    for line in rest.replace("\r\n ", "").split("\r\n") {
        let (name, value) = line.split_once(':').expect("a name and a value");
        assert!(name.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'-'), "{line:?}");
        match name {
            "BEGIN" => open.push(value.to_owned()),
            "END" => assert_eq!(open.pop().as_deref(), Some(value)),
            _ => assert!(!open.is_empty()),
        }
    }
    assert!(open.is_empty());
}
