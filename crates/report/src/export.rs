//! A plan's schedule for other tools: tables, JSON, Open MCT and calendars. All times are those of the earliest schedule,
//! which every plan's constraints allow; windows are given where the format has room for them. Each says which content it
//! is of, how that stands with its board, and which events someone has pinned.

use exact::{Bound, Time};
use review::PlanStatus;
use review::schedule::{Scheduled, scheduled, slack};
use rmpl::program::TimeUnit;
use serde_json::{Map, Value, json};
use snapshot::Snapshot;
use tpn::{Network, NodeId, Occurrence, OccurrenceKind, Plan, Window};

use crate::calendar::Calendar;

/// What is said of a schedule beside its times.
#[derive(Clone, Copy, Debug)]
pub struct About<'a> {
    /// What was planned: see [`review::content_hash`].
    pub content_hash: &'a str,
    /// How it stands with its board.
    pub status: PlanStatus,
    /// When the mission starts, if that is known.
    pub calendar: Option<&'a Calendar>,
    /// The events that are pinned, with their times.
    pub pins: &'a [(NodeId, Time)],
    /// The plan with the windows that the pins leave; otherwise that of the snapshot.
    pub plan: Option<&'a Plan>,
}

impl About<'_> {
    /// Returns how the schedule stands, for programs: pinned events make it another one than the board has looked at.
    fn status(&self) -> Value {
        if self.pins.is_empty() { json!(self.status) } else { json!("pinned") }
    }

    fn is_approved(&self) -> bool {
        self.pins.is_empty() && self.status.is_approved()
    }

    /// The same for people.
    pub(crate) fn status_in_words(&self) -> String {
        if self.pins.is_empty() {
            return self.status.name().to_owned();
        }
        format!("pinned, not approved (its plan: {})", self.status.name())
    }

    fn is_pinned(&self, node: NodeId) -> bool {
        self.pins.iter().any(|(pinned, _)| *pinned == node)
    }

    /// Returns which of its ends are pinned: `start`, `end`, `start end` or nothing.
    fn pinned(&self, occurrence: &Occurrence) -> String {
        let ends = [("start", occurrence.start), ("end", occurrence.end)];
        let pinned = ends.into_iter().filter(|(_, node)| self.is_pinned(*node));
        pinned.map(|(end, _)| end).collect::<Vec<_>>().join(" ")
    }

    /// A time as a date in UTC; empty without a calendar or beyond it.
    fn utc(&self, time: Time) -> String {
        let time = self.calendar.and_then(|calendar| calendar.at(time));
        time.map(|time| time.to_string()).unwrap_or_default()
    }
}

/// Returns what a mission counts time in: `min` or `s`.
fn unit(snapshot: &Snapshot) -> &'static str {
    match snapshot.program.options.time_unit {
        TimeUnit::Minute => "min",
        TimeUnit::Second => "s",
    }
}

/// The unit of the mission's times, spelled out.
pub(crate) fn unit_in_words(snapshot: &Snapshot) -> &'static str {
    match snapshot.program.options.time_unit {
        TimeUnit::Minute => "minutes",
        TimeUnit::Second => "seconds",
    }
}

/// The columns of [`csv()`].
pub const CSV_COLUMNS: [&str; 16] = [
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
    "unit",
    "start_utc",
    "end_utc",
    "pinned",
    "plan_status",
    "content_hash",
];

/// The schedule as comma-separated values after RFC 4180, with a line of headings; times are decimals in mission units, to the
/// nearest of nine places, and `inf` where nothing bounds them: spreadsheets take a fraction for a date. A text that they would
/// take for a formula is behind an apostrophe. `None` without a plan.
pub fn csv(snapshot: &Snapshot, about: &About<'_>) -> Option<String> {
    let (network, rows) = rows(snapshot, about)?;
    let mut out = CSV_COLUMNS.join(",");
    out.push_str("\r\n");
    for row in rows {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let arguments: Vec<&str> = occurrence.arguments.iter().map(smol_str::SmolStr::as_str).collect();
        let cells = [
            csv_text(&occurrence.name),
            kind_name(occurrence.kind).to_owned(),
            csv_text(&occurrence.activity),
            csv_text(&arguments.join(" ")),
            row.start.earliest.nearest_decimal(),
            row.start.latest.nearest_decimal(),
            row.end.earliest.nearest_decimal(),
            row.end.latest.nearest_decimal(),
            slack(row.start).nearest_decimal(),
            slack(row.end).nearest_decimal(),
            unit(snapshot).to_owned(),
            about.utc(row.start.earliest),
            about.utc(row.end.earliest),
            about.pinned(occurrence),
            about.status_in_words(),
            about.content_hash.to_owned(),
        ];
        out.push_str(&cells.map(|cell| csv_cell(&cell)).join(","));
        out.push_str("\r\n");
    }
    Some(out)
}

/// The schedule as a document `enroute-schedule/1`. `None` without a plan.
pub fn json(snapshot: &Snapshot, about: &About<'_>) -> Option<Value> {
    let (network, rows) = rows(snapshot, about)?;
    let utc = |time: Time| Some(about.utc(time)).filter(|text| !text.is_empty());
    let window = |window: Window, node: NodeId| {
        let latest = match window.latest {
            Bound::Finite(latest) => utc(latest),
            Bound::Infinite => None,
        };
        json!({
            "earliest": window.earliest,
            "latest": window.latest,
            "slack": slack(window),
            "earliest_utc": utc(window.earliest),
            "latest_utc": latest,
            "pinned": about.is_pinned(node),
        })
    };
    let rows = rows.iter().map(|row| {
        let occurrence = &network.occurrences[row.occurrence.index()];
        json!({
            "name": occurrence.name,
            "kind": kind_name(occurrence.kind),
            "activity": occurrence.activity,
            "arguments": occurrence.arguments,
            "start": window(row.start, occurrence.start),
            "end": window(row.end, occurrence.end),
        })
    });
    let pinned = about.pins.iter().map(|(node, time)| {
        let events = network.nodes.get(node.index()).into_iter().flat_map(|node| &node.events);
        let events: Vec<String> = events.map(|&event| network.event_name(event)).collect();
        json!({ "events": events, "time": time })
    });
    Some(json!({
        "format": "enroute-schedule/1",
        "program": review::PROGRAM,
        "diagnostics": [],
        "content_hash": about.content_hash,
        "plan_status": about.status(),
        "plan_status_without_pins": about.status,
        "unit": unit(snapshot),
        "epoch": about.calendar.map(|calendar| calendar.epoch().to_string()),
        "pinned": pinned.collect::<Vec<Value>>(),
        "activities": rows.collect::<Vec<Value>>(),
    }))
}

/// The schedule as an Open MCT plan: one member for each group, with its activities; times are milliseconds since
/// 1970. `None` without a plan or a calendar, or beyond it. What Open MCT does not know is in each activity.
pub fn open_mct(snapshot: &Snapshot, about: &About<'_>) -> Option<Value> {
    let calendar = about.calendar?;
    let (network, rows) = rows(snapshot, about)?;
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
            "unit": unit(snapshot),
            "pinned": about.pinned(occurrence),
            "planStatus": about.status_in_words(),
            "contentHash": about.content_hash,
        });
        let entries = groups.entry(group).or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(entries) = entries {
            entries.push(entry);
        }
    }
    Some(Value::Object(groups))
}

/// The schedule as an iCalendar (RFC 5545) with one event for each activity and assertion, in UTC and to the second:
/// confirmed where the plan is approved, tentative otherwise. `None` without a plan or a calendar, or beyond it.
///
/// The content hash makes the events' identifiers, so that importing the same plan again replaces its events. The
/// events are stamped with the start of the mission: nothing here reads a clock.
pub fn icalendar(snapshot: &Snapshot, about: &About<'_>) -> Option<String> {
    let calendar = about.calendar?;
    let (network, rows) = rows(snapshot, about)?;
    let stamp = |time: jiff::Timestamp| time.strftime("%Y%m%dT%H%M%SZ").to_string();
    let content_hash = about.content_hash;
    let mut out = String::new();
    let mut write = |line: &str| write_folded(line, &mut out);
    write("BEGIN:VCALENDAR");
    write("VERSION:2.0");
    write(&format!("PRODID:-//Enroute//{}//EN", review::PROGRAM));
    write(&format!("X-ENROUTE-CONTENT-HASH:{content_hash}"));
    write(&format!("X-ENROUTE-PLAN-STATUS:{}", about.status_in_words()));
    write(&format!("X-ENROUTE-TIME-UNIT:{}", unit(snapshot)));
    for row in rows {
        let occurrence = &network.occurrences[row.occurrence.index()];
        let (start, end) = (calendar.at(row.start.earliest)?, calendar.at(row.end.earliest)?);
        let pinned = match about.pinned(occurrence) {
            ends if ends.is_empty() => ends,
            ends => format!("; pinned: {ends}"),
        };
        let description = format!(
            "Starts {} to {}, ends {} to {} {} after the start of the mission{pinned}; {}, content {}",
            row.start.earliest.readable(),
            row.start.latest.readable(),
            row.end.earliest.readable(),
            row.end.latest.readable(),
            unit(snapshot),
            about.status_in_words(),
            review::record::short(content_hash)
        );
        write("BEGIN:VEVENT");
        write(&format!("UID:{}-{content_hash}@enroute", row.occurrence.0));
        write(&format!("DTSTAMP:{}", stamp(calendar.epoch())));
        write(&format!("DTSTART:{}", stamp(start)));
        // An event without an end ends when it starts; an end must be later than the start.
        if end.as_second() > start.as_second() {
            write(&format!("DTEND:{}", stamp(end)));
        }
        write(&format!("SUMMARY:{}", calendar_text(&occurrence.name)));
        write(&format!("DESCRIPTION:{}", calendar_text(&description)));
        write(&format!("CATEGORIES:{}", calendar_text(open_mct_group(occurrence).0)));
        write(if about.is_approved() { "STATUS:CONFIRMED" } else { "STATUS:TENTATIVE" });
        write("END:VEVENT");
    }
    write("END:VCALENDAR");
    Some(out)
}

/// Returns what downstream tools list: activities and assertions, not delays.
fn rows<'a>(snapshot: &'a Snapshot, about: &About<'_>) -> Option<(&'a Network, Vec<Scheduled>)> {
    let network = snapshot.network.as_deref()?;
    let planned = snapshot.plan()?;
    let mut rows = scheduled(network, about.plan.unwrap_or(planned));
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

/// The group of an occurrence, its color and that of the text on it.
const fn open_mct_group(occurrence: &Occurrence) -> (&'static str, &'static str, &'static str) {
    match occurrence.kind {
        OccurrenceKind::Primitive => ("Activities", "#0068a8", "#ffffff"),
        OccurrenceKind::Assertion => ("Conditions", "#007555", "#ffffff"),
        _ => ("Phases", "#d9dfe6", "#161d26"),
    }
}

/// A text that no spreadsheet takes for a formula, whatever its file says.
fn csv_text(text: &str) -> String {
    let is_formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']);
    if is_formula { format!("'{text}") } else { text.to_owned() }
}

fn csv_cell(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A text value: backslashes, commas, semicolons and line ends are escaped. Other control characters have no place in one.
fn calendar_text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' | ';' | ',' => out.extend(['\\', letter]),
            '\n' => out.push_str("\\n"),
            _ if letter.is_control() => out.push(' '),
            _ => out.push(letter),
        }
    }
    out
}

/// Lines are at most 75 bytes; what is longer continues after a line end and a space, between characters.
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
