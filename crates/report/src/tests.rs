//! The Enroute mission as documents, each read back; the times are those of SPEC 3.6.

mod paper;

use std::sync::Arc;

use link::Response;
use review::keys::{KeyRing, Person, SecretKey};
use review::record::{Act, LineKey, Subject, Who};
use review::{PlanStatus, Present, Record, Review, Section, review, standing};
use rmpl::program::TimeUnit;
use snapshot::{Goal, Snapshot};
use terrain::Terrain;

use crate::calendar::Calendar;
use crate::{Document, export, html};

const SCENARIO: &str = include_str!("../../../tests/conformance/t01_enroute_scenario.rmpl");
const MISSION: &str = include_str!("../../../assets/missions/enroute.rmpl");
const EPOCH: &str = "2004-01-25T05:05:00Z";

struct Planned {
    snapshot: Arc<Snapshot>,
    ground: Option<Arc<Terrain>>,
    review: Review,
}

fn planned(source: &str) -> Planned {
    let answers = test_core::answers(source);
    let snapshot = answers.snapshot();
    let ground = answers.0.into_iter().find_map(|answer| match answer {
        Response::Map { map, .. } => Some(map),
        _ => None,
    });
    let review = review(&snapshot, &Goal::Default, 0, &mut || false);
    Planned { snapshot, ground, review }
}

fn report(source: &str, name: &str) -> String {
    let planned = planned(source);
    html(&Document {
        name,
        snapshot: &planned.snapshot,
        review: &planned.review,
        record: None,
        robustness: None,
        seed: 0,
        ground: planned.ground.as_deref(),
    })
}

fn about(calendar: Option<&Calendar>) -> export::About<'_> {
    export::About { content_hash: HASH, status: PlanStatus::InReview, calendar, pins: &[], plan: None }
}

const HASH: &str = "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff";

fn calendar() -> Calendar {
    Calendar::new(EPOCH, TimeUnit::Minute).expect("a date")
}

/// The row of a table of the report that has this cell, without its tags.
fn row_with(page: &str, cell: &str) -> String {
    let row = page
        .split("<tr>")
        .find(|row| row.contains(&format!(">{cell}<")))
        .unwrap_or_else(|| panic!("no row for {cell}"));
    let row = row.split("</tr>").next().unwrap_or("");
    row.split('<')
        .filter_map(|piece| piece.split_once('>'))
        .map(|(_, text)| text)
        .collect::<Vec<_>>()
        .join("|")
}

#[test]
fn the_report_has_the_windows_the_margins_and_the_hash() {
    let page = report(SCENARIO, "t01.rmpl");
    assert!(
        row_with(&page, "Group-Wait(TAI_HOLD1, TAI_HOLD2).end").contains("|415||514||99|"),
        "{}",
        row_with(&page, "Group-Wait(TAI_HOLD1, TAI_HOLD2).end")
    );
    assert!(row_with(&page, "Tell(PROCEED=OK)#1.start").contains("|460||600||140|"));
    assert!(row_with(&page, "Ask(PATH1=OK)@Group-Traverse-Path(PATH1_1, …, TAI_POS)").contains("[0, 45]"));
    assert!(page.contains("[1, 185]"));
    assert!(page.contains(&planned(SCENARIO).review.content_hash));
    for activity in ["Group-Traverse-Path", "Group-Transmit", "Group-Wait"] {
        assert!(!page.contains(&format!("{activity}#")), "{activity} has an identifier");
    }
}

#[test]
fn the_summary_comes_first_and_each_page_has_its_number_and_the_hash() {
    let page = report(SCENARIO, "t01.rmpl");
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text}"));
    assert!(at("<h2>Summary</h2>") < at("<h2>Signatures</h2>"));
    assert!(at("<h2>Signatures</h2>") < at("<h2>Causal links</h2>"));
    assert!(at("<h2>Flight rules</h2>") > at("<h2>Robustness</h2>"));
    let hash = planned(SCENARIO).review.content_hash;
    assert!(page.contains(&format!("@bottom-left {{ content: \"Content {hash}\"")));
    assert!(page.contains("\"Page \" counter(page) \" of \" counter(pages)"));
    // The same in the page's own content, for browsers without margins.
    assert!(page.contains(&format!("<p class=\"foot\" aria-hidden=\"true\">Content {hash}</p>")));
    let sheets = page.matches("<i>Page ").count();
    assert!(sheets >= 20 && page.contains(&format!(".sheets :nth-child({sheets}) {{ --sheet: {sheets}; }}")));
    let summary = &page[at("<h2>Summary</h2>")..at("<h2>Signatures</h2>")];
    assert!(summary.contains("outlasts it by 0 to 45 min") && summary.contains("margin more than 0 min"));
    let fine = report("primitive A()[1,2]; scenario S[0,9] = { A() }", "fine.rmpl");
    assert!(fine.contains("Nothing failed, and nothing needs attention."));
}

#[test]
fn the_report_needs_nothing_from_elsewhere_and_no_scripts() {
    let page = report(MISSION, "enroute.rmpl");
    // Nor may it have any, whatever would slip into it: the policy is before everything that it is about.
    let policy =
        page.find("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';").expect("a policy");
    assert!(policy < page.find("<title>").expect("a title"));
    // One style sheet is allowed, by its digest, and elements have no styles of their own.
    assert!(page.contains("style-src 'sha256-") && !page.contains("unsafe-inline"));
    assert_eq!(page.matches("<style").count(), 1);
    assert!(!page.contains(" style="));
    for outside in ["http://", "https://", "src=", "url(", "@import", "<script", "<link", "<iframe"] {
        assert!(!page.contains(outside), "{outside}");
    }
    for drawing in ["Timeline of the plan", "Temporal plan network", "Map with the paths of the plan"] {
        assert!(page.contains(&format!("<title>{drawing}</title>")), "{drawing}");
    }
    assert!(page.contains("<path d=") && page.contains("@page") && page.contains("@media print"));
}

#[test]
fn what_the_author_wrote_stands_for_itself() {
    let page = report(&format!("// <script>alert(\"1\" & '2')</script>\n{SCENARIO}"), "<b>.rmpl");
    assert!(!page.contains("<script"));
    assert!(page.contains("&lt;script&gt;alert(&quot;1&quot; &amp; &#39;2&#39;)&lt;/script&gt;"));
    assert!(page.contains("<title>Mission review: &lt;b&gt;.rmpl</title>"));
}

#[test]
fn every_element_of_the_report_is_closed() {
    let page = report(MISSION, "enroute.rmpl");
    let mut open: Vec<&str> = Vec::new();
    for tag in page.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').expect("a tag ends");
        let name = tag.trim_start_matches('/').split([' ', '/', '\n']).next().unwrap_or("");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "</{name}>");
        } else if !tag.ends_with('/') && !["!doctype", "meta"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
}

#[test]
fn no_comment_of_the_program_changes_the_direction_of_what_is_signed() {
    let page = report(&format!("// \u{202e}[0,60]\n{SCENARIO}"), "t01.rmpl");
    assert!(page.contains("\u{fffd}[0,60]") && !page.contains('\u{202e}'));
}

#[test]
fn the_listing_is_the_program_and_links_lead_into_it() {
    let page = report(SCENARIO, "t01.rmpl");
    let listing = page.split("<pre").nth(1).and_then(|rest| rest.split("</pre>").next()).expect("a listing");
    let without_numbers: String = listing
        .split("</b>")
        .skip(1)
        .map(|line| {
            let line = line.split("</span>").next().unwrap_or("");
            let text: String = format!("x>{line}")
                .split('<')
                .filter_map(|piece| piece.split_once('>'))
                .map(|(_, text)| text)
                .collect();
            text.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&")
        })
        .collect();
    assert_eq!(without_numbers.trim_end(), SCENARIO.replace('\r', "").trim_end());
    for link in page.split("href=\"#").skip(1) {
        let target = link.split('"').next().unwrap_or("");
        assert!(page.contains(&format!("id=\"{target}\"")), "{target}");
    }
}

#[test]
fn a_mission_without_a_plan_has_a_report_that_says_why() {
    let page = report(&SCENARIO.replace("PATH1=OK [450,450]", "PATH1=OK [400,400]"), "none.rmpl");
    assert!(page.contains("there is no plan") && page.contains("not ready"));
    assert!(page.contains("Temporal plan network") && !page.contains("Timeline of the plan"));
}

#[test]
fn the_table_is_read_back_with_its_times() {
    let text = export::csv(&planned(MISSION).snapshot, &about(None)).expect("a plan");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    assert_eq!(reader.headers().expect("headings"), &csv::StringRecord::from(export::CSV_COLUMNS.to_vec()));
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("rows");
    let row = |name: &str| rows.iter().find(|row| &row[0] == name).unwrap_or_else(|| panic!("no {name}"));
    let wait: Vec<&str> = row("Group-Wait#1").iter().skip(3).take(7).collect();
    assert_eq!(wait, ["TAI_HOLD1 TAI_HOLD2", "415", "460", "415", "514", "45", "99"]);
    assert_eq!(&row("scenario#1")[7], "800");
    assert!(text.ends_with("\r\n") && !text.replace("\r\n", "").contains('\n'));
}

/// A network of another tool: times of thirds, and names that a spreadsheet would run, a calendar cannot have, and XML neither.
const HOSTILE_NETWORK: &str = r#"{"network-id": "net",
    "net": {"tpn-type": "network", "begin-node": "s", "end-node": "e"},
    "s": {"tpn-type": "state", "activities": ["a"]}, "m": {"tpn-type": "state", "activities": ["b"]},
    "e": {"tpn-type": "state", "activities": []},
    "a": {"tpn-type": "activity", "name": "=HYPERLINK(\"x\")", "end-node": "m", "constraints": ["c"]},
    "b": {"tpn-type": "activity", "name": "bell\u0007 \r\nEND:VCALENDAR \uffff <script>", "end-node": "e"},
    "c": {"tpn-type": "temporal-constraint", "value": ["1/3", "2/3"], "end-node": "m"}}"#;

#[test]
fn spreadsheets_read_decimals_and_run_no_name() {
    let text = export::csv(&planned(HOSTILE_NETWORK).snapshot, &about(None)).expect("a plan");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let rows: Vec<csv::StringRecord> = reader.records().collect::<Result<_, _>>().expect("rows");
    let row = rows.iter().find(|row| row[0].contains("HYPERLINK")).expect("the activity");
    assert!(row[0].starts_with("'=HYPERLINK") && row[2].starts_with("'="), "{row:?}");
    let times: Vec<&str> = row.iter().skip(4).take(6).collect();
    assert_eq!(times, ["0", "0", "0.333333333", "0.666666667", "0", "0.333333333"], "{text}");
}

#[test]
fn names_break_neither_calendars_nor_drawings_nor_reports() {
    let planned = planned(HOSTILE_NETWORK);
    let text = export::icalendar(&planned.snapshot, &about(Some(&calendar()))).expect("a plan");
    assert!(text.split("\r\n").all(|line| !line.contains(char::is_control)), "{text:?}");
    assert_eq!(text.matches("\r\nEND:VCALENDAR").count(), 1, "{text}");
    assert_eq!(calendar_events(&text).len(), 2);
    let page = html(&Document {
        name: "net.tpn.json",
        snapshot: &planned.snapshot,
        review: &planned.review,
        record: None,
        robustness: None,
        seed: 0,
        ground: None,
    });
    assert!(!page.contains("<script") && !page.contains('\u{ffff}') && !page.contains('\u{7}'));
}

#[test]
fn the_open_mct_plan_has_its_groups_and_milliseconds() {
    let plan = export::open_mct(&planned(SCENARIO).snapshot, &about(Some(&calendar()))).expect("a plan");
    let plan: serde_json::Value = serde_json::from_str(&plan.to_string()).expect("JSON");
    let groups = plan.as_object().expect("an object of groups");
    for entry in groups.values().flat_map(|group| group.as_array().expect("a list")) {
        assert!(entry["start"].as_i64() <= entry["end"].as_i64(), "{entry}");
        for member in ["name", "type", "color", "textColor"] {
            assert!(entry[member].is_string(), "{member}: {entry}");
        }
    }
    // 2004-01-25T05:05:00Z is 1075007100 s after 1970; the drive starts 10 and ends 415 minutes later.
    let drive = groups["Activities"].as_array().expect("a list");
    let drive = drive.iter().find(|it| it["name"] == "Group-Traverse-Path#1").expect("the drive");
    assert_eq!(drive["start"], 1_075_007_700_000_i64);
    assert_eq!(drive["end"], 1_075_032_000_000_i64);
}

/// Reads an iCalendar: its events, as names and values, after undoing the folding.
fn calendar_events(text: &str) -> Vec<Vec<(String, String)>> {
    assert!(text.ends_with("\r\n"));
    assert!(text.split("\r\n").all(|line| line.len() <= 75 && !line.contains('\n')), "long lines are folded");
    let unfolded = text.replace("\r\n ", "");
    let mut events = Vec::new();
    for line in unfolded.split("\r\n").filter(|line| !line.is_empty()) {
        let (name, value) = line.split_once(':').expect("a name and a value");
        let value = value.replace("\\,", ",").replace("\\;", ";").replace("\\\\", "\\");
        match (name, value.as_str()) {
            ("BEGIN", "VEVENT") => events.push(Vec::new()),
            _ => {
                if let Some(event) = events.last_mut() {
                    event.push((name.to_owned(), value));
                }
            }
        }
    }
    events
}

#[test]
fn the_calendar_has_an_event_for_each_activity() {
    let planned = planned(SCENARIO);
    let text = export::icalendar(&planned.snapshot, &about(Some(&calendar()))).expect("a plan");
    assert!(
        text.starts_with("BEGIN:VCALENDAR\r\nVERSION:2.0\r\nPRODID:") && text.ends_with("END:VCALENDAR\r\n")
    );
    let events = calendar_events(&text);
    let value = |event: &[(String, String)], name: &str| {
        event.iter().find(|(key, _)| key == name).map(|(_, value)| value.clone())
    };
    let find = |summary: &str| {
        events
            .iter()
            .find(|event| value(event, "SUMMARY").as_deref() == Some(summary))
            .unwrap_or_else(|| panic!("no {summary}"))
    };
    let drive = find("Group-Traverse-Path#1");
    assert_eq!(value(drive, "DTSTART").as_deref(), Some("20040125T051500Z"));
    assert_eq!(value(drive, "DTEND").as_deref(), Some("20040125T120000Z"));
    // The wait takes no time in the earliest schedule.
    assert_eq!(value(find("Group-Wait#1"), "DTEND"), None);
    let mut identifiers: Vec<_> = events.iter().map(|event| value(event, "UID")).collect();
    identifiers.sort();
    identifiers.dedup();
    assert_eq!(identifiers.len(), events.len());
    assert!(value(drive, "DESCRIPTION").is_some_and(|text| text.contains("10 to 55, ends 415 to 460")));
}

#[test]
fn a_start_of_the_mission_is_a_date_with_or_without_a_time() {
    let at = |epoch: &str| Calendar::new(epoch, TimeUnit::Second).map(|it| it.epoch().to_string());
    assert_eq!(at("2004-01-25").as_deref(), Some("2004-01-25T00:00:00Z"));
    assert_eq!(at("2004-01-25T05:05").as_deref(), Some("2004-01-25T05:05:00Z"));
    assert_eq!(at("2004-01-25T05:05:00+02:00").as_deref(), Some("2004-01-25T03:05:00Z"));
    assert_eq!([at("tomorrow"), at("2004-13-01"), at("")], [None, None, None]);
    assert_eq!(at("-000044-03-15"), None, "no calendar of four digits has it");
}

/// A page with this record.
fn page_with(planned: &Planned, record: &Record) -> String {
    html(&Document {
        name: "t01.rmpl",
        snapshot: &planned.snapshot,
        review: &planned.review,
        record: Some(record),
        robustness: None,
        seed: 0,
        ground: None,
    })
}

fn who(by: &str, review: &Review) -> Who {
    Who {
        by: by.to_owned(),
        role: "Reviewer".to_owned(),
        time: "2026-01-02T03:04:05Z".to_owned(),
        content_hash: review.content_hash.clone(),
        plan_hash: review.plan_hash.clone(),
    }
}

/// The key of a person.
fn key(name: &str) -> SecretKey {
    let mut bytes = [7; 32];
    bytes.iter_mut().zip(name.bytes()).for_each(|(byte, letter)| *byte = letter);
    SecretKey::from_bytes(bytes)
}

/// A record of a board of people whose keys are trusted.
fn judged() -> Record {
    let mut ring = KeyRing::default();
    for name in ["Ada & Co", "Grace"] {
        ring.add(Person::new(name, key(name))).expect("a name of its own");
    }
    let mut record = Record::default();
    record.judge(&ring.trust(), "2026-01-02T03:04:05Z");
    record
}

/// Returns what is approved of a mission.
fn subject(planned: &Planned) -> Subject {
    let (network, plan) =
        (planned.snapshot.network.as_deref().expect("a network"), planned.snapshot.plan().expect("a plan"));
    let plan = tpn::plan_json::plan_to_json(network, plan);
    Subject::new(&planned.review, &planned.snapshot.source, Goal::Default, 0, plan, None)
}

#[test]
fn a_report_has_the_history_of_the_board_its_status_and_who_took_what_back() {
    let planned = planned(SCENARIO);
    let mut record = judged();
    assert!(page_with(&planned, &record).contains("draft</span>; approvals: Reviewer 0 of 1"));
    let about = Some("Group-Wait#1".to_owned());
    let text = "Long wait.\nIs that <intended>?".to_owned();
    let to = Some(key("Ada & Co").public());
    record.add(who("Grace", &planned.review), Act::Comment { about, to, text }, &key("Grace"));
    let asked = record.entries()[0].digest().to_owned();
    let page = page_with(&planned, &record);
    assert!(page.contains("in review</span>") && page.contains("<h3>Open comments</h3>"));
    assert!(page.contains("Long wait.<br>Is that &lt;intended&gt;?") && page.contains("1 comment is open"));
    let resolve = Act::Resolve { of: asked, text: "Yes.".to_owned() };
    record.add(who("Ada & Co", &planned.review), resolve, &key("Ada & Co"));
    for section in Section::ALL {
        for line in planned.review.lines(section) {
            let line = LineKey::new(section, line);
            record.add(
                who("Ada & Co", &planned.review),
                Act::Acknowledge { line, text: "As meant.".to_owned() },
                &key("Ada & Co"),
            );
        }
    }
    let relied_on = standing(&record, &Present::of_review(&planned.review)).relied_on;
    let ada = who("Ada & Co", &planned.review);
    record.approve(ada, subject(&planned), "Mind the wind.".to_owned(), relied_on, &key("Ada & Co"));
    let page = page_with(&planned, &record);
    assert!(page.contains("approved with comments</span>; approvals: Reviewer 1 of 1"), "{page}");
    assert!(page.contains("Ada &amp; Co (Reviewer): As meant."), "who acknowledged stands in the summary");
    assert!(page.contains("resolved entry 1") && page.contains("Mind the wind."));
    assert!(page.contains("Text, plan, checklist, flight rules and Monte Carlo results are unchanged."));
    assert!(page.contains(record.heads().next().expect("a last entry")));
    let approved = record.entries().last().expect("the approval").digest().to_owned();
    let withdraw = Act::Withdraw { of: approved, text: "Too early.".to_owned() };
    record.add(who("Ada & Co", &planned.review), withdraw.clone(), &key("Grace"));
    let page = page_with(&planned, &record);
    assert!(page.contains("approved with comments"), "the key is Grace's");
    assert!(page.contains("valid: the key is that of “Grace”, and the entry names “Ada &amp; Co”"), "{page}");
    record.add(who("Ada & Co", &planned.review), withdraw, &key("Ada & Co"));
    let page = page_with(&planned, &record);
    assert!(page.contains("withdrawn by Ada &amp; Co") && !page.contains("approved with comments"));
}

#[test]
fn a_report_of_an_edited_mission_says_that_the_approval_lapsed_and_what_differs() {
    let before = planned("primitive A()[1,2]; scenario S[0,9] = { A() }");
    let after = planned("primitive A()[3,4]; scenario S[0,9] = { A() }");
    let mut record = judged();
    let ada = who("Ada & Co", &before.review);
    record.approve(ada, subject(&before), String::new(), Vec::new(), &key("Ada & Co"));
    assert!(page_with(&before, &record).contains("approved</span>; approvals: Reviewer 1 of 1"));
    let page = page_with(&after, &record);
    let lapsed = "approval lapsed</span>; approvals: Reviewer 0 of 1; Ada &amp; Co approved 2026-01-02 03:04 UTC: the text, map, goal or seed has changed";
    assert!(page.contains(lapsed), "{page}");
    assert!(page.contains("<del>− primitive A()[1,2]; scenario S[0,9] = { A() }</del>"));
    assert!(page.contains("<ins>+ primitive A()[3,4]; scenario S[0,9] = { A() }</ins>"));
    assert!(page.contains("activity A#1 moved: "));
}

#[test]
fn a_report_draws_the_network_over_the_approved_one() {
    let before = planned("primitive A()[1,2]; primitive B()[1,1]; scenario S[0,9] = { A(); B() }");
    let after = planned("primitive A()[2,3]; primitive C()[4,4]; scenario S[0,9] = { A(); C() }");
    let mut record = judged();
    let ada = who("Ada & Co", &before.review);
    record.approve(ada, subject(&before), String::new(), Vec::new(), &key("Ada & Co"));
    assert!(!page_with(&before, &record).contains("over the approved one"), "nothing differs");
    let page = page_with(&after, &record);
    let drawing = page.split("Network of the plan over the approved one").nth(1).expect("the drawing");
    let drawing = drawing.split("</svg>").next().unwrap_or_default();
    for words in [">new<", ">end was 1–2<", "Removed from the plan", ">B#1<", "stroke-dasharray"] {
        assert!(drawing.contains(words), "no {words} in {drawing}");
    }
}

#[test]
fn schedules_say_what_they_are_of_how_that_stands_and_what_is_pinned() {
    let planned = planned(SCENARIO);
    let (network, plan) =
        (planned.snapshot.network.as_deref().expect("a network"), planned.snapshot.plan().expect("a plan"));
    let wait = network.occurrences.iter().find(|it| it.name == "Group-Wait#1").expect("the wait");
    let calendar = calendar();
    let mut pinned = plan.clone();
    let time = exact::Time::from(500);
    let window = tpn::Window { earliest: time, latest: exact::Bound::Finite(time) };
    pinned.windows[wait.end.index()] = Some(window);
    let pins = [(wait.end, time)];
    let about = export::About {
        pins: &pins,
        plan: Some(&pinned),
        status: PlanStatus::Approved,
        ..about(Some(&calendar))
    };
    let table = export::csv(&planned.snapshot, &about).expect("a plan");
    let row = table.lines().find(|line| line.starts_with("Group-Wait#1,")).expect("the wait");
    assert!(
        row.ends_with(&format!(
            ",500,500,45,0,min,2004-01-25T12:00:00Z,2004-01-25T13:25:00Z,end,\"pinned, not approved (its plan: approved)\",{HASH}"
        )),
        "{row}"
    );
    let document = export::json(&planned.snapshot, &about).expect("a plan");
    assert_eq!(document["format"], "enroute-schedule/1");
    assert_eq!((&document["content_hash"], &document["plan_status"]), (&HASH.into(), &"pinned".into()));
    assert_eq!(document["plan_status_without_pins"], "approved");
    assert_eq!((&document["unit"], &document["epoch"]), (&"min".into(), &EPOCH.into()));
    assert_eq!(document["pinned"][0]["time"], 500);
    let events = document["pinned"][0]["events"].as_array().expect("names");
    assert!(events.contains(&"Group-Wait#1.end".into()), "{events:?}");
    let rows = document["activities"].as_array().expect("a list");
    let row = rows.iter().find(|row| row["name"] == "Group-Wait#1").expect("the wait");
    assert_eq!(row["end"]["earliest_utc"], "2004-01-25T13:25:00Z");
    assert_eq!((&row["end"]["pinned"], &row["start"]["pinned"]), (&true.into(), &false.into()));
    let without = export::json(&planned.snapshot, &self::about(None)).expect("a plan");
    assert!(without["epoch"].is_null() && without["activities"][0]["start"]["earliest_utc"].is_null());
    let ics = export::icalendar(&planned.snapshot, &about).expect("a calendar").replace("\r\n ", "");
    for line in [&format!("X-ENROUTE-CONTENT-HASH:{HASH}"), "X-ENROUTE-TIME-UNIT:min", "STATUS:TENTATIVE"] {
        assert!(ics.contains(&format!("{line}\r\n")), "{line}");
    }
    assert!(
        ics.contains("pinned: end\\; pinned\\, not approved (its plan: approved)\\, content 001122334455"),
        "{ics}"
    );
    let plan = export::open_mct(&planned.snapshot, &about).expect("a calendar");
    let wait = plan["Activities"].as_array().expect("a list").iter().find(|it| it["name"] == "Group-Wait#1");
    let wait = wait.expect("the wait");
    assert_eq!(
        (&wait["pinned"], &wait["planStatus"], &wait["unit"]),
        (&"end".into(), &"pinned, not approved (its plan: approved)".into(), &"min".into())
    );
    assert!(export::open_mct(&planned.snapshot, &self::about(None)).is_none());
}

#[test]
fn a_moment_is_written_to_the_second_in_utc() {
    assert_eq!(crate::calendar::utc_text(1_767_323_045_678), "2026-01-02T03:04:05Z");
    assert_eq!(crate::calendar::utc_text(i64::MAX), "");
}
