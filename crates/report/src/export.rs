//! A plan's schedule for other tools: tables, Open MCT and calendars. All times are those of the earliest schedule,
//! which every plan's constraints allow; windows are given where the format has room for them.

use mission::Snapshot;
use mission::review::schedule::{Scheduled, scheduled, slack};
use serde_json::{Map, Value, json};
use tpn::{Network, Occurrence, OccurrenceKind};

use crate::calendar::Calendar;

/// The columns of [`csv`].
pub const CSV_COLUMNS: [&str; 10] = [
    "name",
    "kind",
    "activity",
    "arguments",
    "start_earliest",
    "start_latest",
    "end_earliest",
    "end_latest",
    "start_slack",
    "end_slack",
];

/// The schedule as comma-separated values after RFC 4180, with a line of headings; times are exact, in mission units,
/// as decimals or fractions, and `inf` where nothing bounds them. `None` without a plan.
pub fn csv(snapshot: &Snapshot) -> Option<String> {
    let (network, rows) = rows(snapshot)?;
    let mut out = CSV_COLUMNS.join(",");
    out.push_str("\r\n");
    for row in rows {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let arguments: Vec<&str> = occurrence.arguments.iter().map(smol_str::SmolStr::as_str).collect();
        let cells = [
            occurrence.name.to_string(),
            kind_name(occurrence.kind).to_owned(),
            occurrence.activity.to_string(),
            arguments.join(" "),
            row.start.earliest.to_string(),
            row.start.latest.to_string(),
            row.end.earliest.to_string(),
            row.end.latest.to_string(),
            slack(row.start).to_string(),
            slack(row.end).to_string(),
        ];
        out.push_str(&cells.map(|cell| csv_cell(&cell)).join(","));
        out.push_str("\r\n");
    }
    Some(out)
}

/// The schedule as an Open MCT plan: one member for each group, with its activities; times are milliseconds since
/// 1970. `None` without a plan or beyond the calendar.
pub fn open_mct(snapshot: &Snapshot, calendar: &Calendar) -> Option<Value> {
    let (network, rows) = rows(snapshot)?;
    let mut groups = Map::new();
    for row in rows {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let (group, color, text_color) = open_mct_group(occurrence);
        let entry = json!({
            "name": occurrence.name,
            "start": calendar.at(row.start.earliest)?.as_millisecond(),
            "end": calendar.at(row.end.earliest)?.as_millisecond(),
            "type": group,
            "color": color,
            "textColor": text_color,
        });
        let entries = groups.entry(group).or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(entries) = entries {
            entries.push(entry);
        }
    }
    Some(Value::Object(groups))
}

/// The schedule as an iCalendar (RFC 5545) with one event for each activity and assertion, in UTC and to the second.
/// `None` without a plan or beyond the calendar.
///
/// `content_hash` makes the events' identifiers, so that importing the same plan again replaces its events. The
/// events are stamped with the start of the mission: nothing here reads a clock.
pub fn icalendar(snapshot: &Snapshot, calendar: &Calendar, content_hash: &str) -> Option<String> {
    let (network, rows) = rows(snapshot)?;
    let stamp = |time: jiff::Timestamp| time.strftime("%Y%m%dT%H%M%SZ").to_string();
    let mut out = String::new();
    let mut write = |line: &str| write_folded(line, &mut out);
    for line in ["BEGIN:VCALENDAR", "VERSION:2.0", "PRODID:-//Enroute//Mission schedule//EN"] {
        write(line);
    }
    for row in rows {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let (start, end) = (calendar.at(row.start.earliest)?, calendar.at(row.end.earliest)?);
        let description = format!(
            "Starts from {} to {}, ends from {} to {} after the start of the mission",
            row.start.earliest.readable(),
            row.start.latest.readable(),
            row.end.earliest.readable(),
            row.end.latest.readable()
        );
        write("BEGIN:VEVENT");
        write(&format!("UID:{}-{}@enroute", row.occurrence.0, content_hash));
        write(&format!("DTSTAMP:{}", stamp(calendar.epoch())));
        write(&format!("DTSTART:{}", stamp(start)));
        // An event without an end ends when it starts; an end must be later than the start.
        if end.as_second() > start.as_second() {
            write(&format!("DTEND:{}", stamp(end)));
        }
        write(&format!("SUMMARY:{}", calendar_text(&occurrence.name)));
        write(&format!("DESCRIPTION:{}", calendar_text(&description)));
        write(&format!("CATEGORIES:{}", calendar_text(open_mct_group(occurrence).0)));
        write("END:VEVENT");
    }
    write("END:VCALENDAR");
    Some(out)
}

/// What downstream tools list: activities and assertions, not delays.
fn rows(snapshot: &Snapshot) -> Option<(&Network, Vec<Scheduled>)> {
    let network = snapshot.network.as_deref()?;
    let mut rows = scheduled(network, snapshot.plan()?);
    rows.retain(|row| network.occurrences[row.occurrence.index()].kind != OccurrenceKind::Delay);
    Some((network, rows))
}

const fn kind_name(kind: OccurrenceKind) -> &'static str {
    match kind {
        OccurrenceKind::Primitive => "primitive",
        OccurrenceKind::Activity => "activity",
        OccurrenceKind::Assertion => "assertion",
        OccurrenceKind::Delay => "delay",
        OccurrenceKind::Scenario => "scenario",
        OccurrenceKind::Scope => "scope",
    }
}

/// The group of an occurrence, its colour and that of the text on it.
const fn open_mct_group(occurrence: &Occurrence) -> (&'static str, &'static str, &'static str) {
    match occurrence.kind {
        OccurrenceKind::Primitive => ("Activities", "#0068a8", "#ffffff"),
        OccurrenceKind::Assertion => ("Conditions", "#007555", "#ffffff"),
        _ => ("Phases", "#d9dfe6", "#161d26"),
    }
}

fn csv_cell(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A text value: backslashes, commas, semicolons and line ends are escaped.
fn calendar_text(text: &str) -> String {
    text.replace('\\', "\\\\").replace(';', "\\;").replace(',', "\\,").replace('\n', "\\n")
}

/// Lines are at most 75 bytes; what is longer goes on after a line end and a space, between characters.
const LONGEST_LINE_BYTES: usize = 75;

fn write_folded(line: &str, out: &mut String) {
    let mut used = 0;
    for character in line.chars() {
        if used + character.len_utf8() > LONGEST_LINE_BYTES {
            out.push_str("\r\n ");
            used = 1;
        }
        out.push(character);
        used += character.len_utf8();
    }
    out.push_str("\r\n");
}
