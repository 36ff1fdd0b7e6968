//! Histories: what is written is read back, what was altered is refused, and what two people did apart is joined.

use serde_json::{Value, json};
use snapshot::Goal;
use snapshot::{Robustness, RobustnessSettings, Tally, Uncertainty};

use super::keys::{KeyRing, Person, SecretKey, Trust};
use super::record::{Act, Record, RecordError, Runs, Subject, Who};
use super::{FlightRules, Signature, since};

/// The key of a person of these tests: the same for the same name.
pub(super) fn key(name: &str) -> SecretKey {
    let mut bytes = [7; 32];
    bytes.iter_mut().zip(name.bytes()).for_each(|(byte, letter)| *byte = letter);
    SecretKey::from_bytes(bytes)
}

/// Trusts these people.
pub(super) fn trust(names: &[&str]) -> Trust {
    let mut ring = KeyRing::default();
    for name in names {
        let person = Person { secret: None, ..Person::new(name, key(name)) };
        ring.add(person).expect("a name of its own");
    }
    ring.trust()
}

/// A time after everything in these tests.
pub(super) const NOW: &str = "2026-02-01T00:00:00Z";

/// A record for someone who trusts the usual people.
pub(super) fn judged(mut record: Record) -> Record {
    record.judge(&trust(&["Chair", "Ada", "Grace", "Katherine"]), NOW);
    record
}

pub(super) fn who(by: &str, time: &str) -> Who {
    Who {
        by: by.to_owned(),
        role: "Reviewer".to_owned(),
        time: time.to_owned(),
        content_hash: "c1".to_owned(),
        plan_hash: "p1".to_owned(),
    }
}

pub(super) fn subject() -> Subject {
    Subject {
        source: "scenario S = { }".to_owned(),
        goal: Goal::Default,
        seed: 7,
        map: None,
        rules: FlightRules::default(),
        counts: [3, 1, 0],
        lines: Vec::new(),
        plan: Value::Null,
        robustness: None,
        runs: None,
    }
}

pub(super) fn comment(text: &str) -> Act {
    let to = Some(key("Grace").public());
    Act::Comment { about: Some("Group-Wait#1".to_owned()), to, text: text.to_owned() }
}

fn runs(content_hash: &str, runs: u64) -> Runs {
    let settings = RobustnessSettings { runs, seed: 5, uncertainty: Uncertainty::default() };
    let tally = Tally { runs, succeeded: runs / 2, ..Tally::default() };
    Runs::new(content_hash, &Robustness { settings, tally })
}

/// One of nearly every act.
fn full() -> Record {
    let mut record = judged(Record::new("enroute"));
    let rules = FlightRules { slope_deg: None, clearance_m: Some(1.0), ..FlightRules::default() };
    let say = |record: &mut Record, by: &str, day: u32, act: Act| {
        record.add(who(by, &format!("2026-01-{day:02}T00:00:00Z")), act, &key(by));
        record.entries().last().expect("it was added").digest().to_owned()
    };
    say(&mut record, "Chair", 1, Act::Rules { rules: rules.clone() });
    let of = say(&mut record, "Ada", 2, comment("Why \"this\" path?\nIt is longer."));
    say(&mut record, "Grace", 3, Act::Resolve { of: of.clone(), text: "Shade.".into() });
    say(&mut record, "Ada", 4, Act::Reopen { of: of.clone(), text: "Not at noon.".into() });
    say(&mut record, "Ada", 5, Act::Resolve { of, text: "It is night.".into() });
    let subject = Subject { rules, ..subject() };
    let ada = who("Ada", "2026-01-06T00:00:00Z");
    record.approve(ada, subject, "Watch the margin.".to_owned(), Vec::new(), &key("Ada"));
    let of = record.entries()[5].digest().to_owned();
    say(&mut record, "Ada", 7, Act::Withdraw { of, text: "A slip.".into() });
    record.keep_runs(runs("c1", 20));
    record
}

#[test]
fn a_record_is_read_back_as_it_was_written() {
    let record = full();
    assert_eq!(Record::from_json(&record.to_json()), Ok(record.clone()));
    assert_eq!(record.counted().count(), record.entries().len());
    // Programs that write whole numbers without a point leave it whole.
    let value: Value = serde_json::from_str(&record.to_json()).expect("JSON");
    let spelled = value.to_string();
    let otherwise = spelled.replace("\"clearance_m\":1.0,", "\"clearance_m\":1,");
    assert_ne!(spelled, otherwise);
    let read = Record::from_json(&otherwise).map(judged);
    assert_eq!(read.map(|it| it.rules().clone()), Ok(record.rules().clone()));
    assert_eq!(record.heads().count(), 1);
    assert_eq!(record.runs_of("c1").map(Runs::robustness).expect("runs").tally.runs, 20);
}

/// The document with something done to it.
fn altered(change: impl FnOnce(&mut Value)) -> Result<Record, RecordError> {
    let mut document: Value = serde_json::from_str(&full().to_json()).expect("JSON");
    change(&mut document);
    Record::from_json(&document.to_string())
}

#[test]
fn whatever_is_altered_is_said_with_its_entry() {
    assert!(altered(|_| {}).is_ok());
    for entry in [json!([]), json!(4), json!("said"), json!(null), json!({})] {
        assert!(
            matches!(altered(|it| it["entries"][0] = entry.clone()), Err(RecordError::Damaged(_))),
            "{entry}"
        );
    }
    let says = |found: Result<Record, RecordError>, words: &str| match found {
        Err(RecordError::Broken(why)) => assert!(why.contains(words), "{why}"),
        other => panic!("{words}: {other:?}"),
    };
    // Every member of every entry is sealed.
    for index in 0..full().entries().len() {
        for member in ["by", "role", "time", "content_hash", "plan_hash"] {
            let found = altered(|it| it["entries"][index]["said"][member] = json!("x"));
            says(found, &format!("entry {} ", index + 1));
        }
        says(altered(|it| it["entries"][index]["digest"] = json!("0")), "has been changed");
        says(altered(|it| it["entries"][index]["said"]["more"] = json!(1)), "has been changed");
    }
    says(altered(|it| it["entries"][5]["said"]["act"]["approve"]["text"] = json!("")), "entry 6 (Ada, ");
    let remove = |it: &mut Value, index: usize| {
        it["entries"].as_array_mut().expect("a list").remove(index);
    };
    says(altered(|it| remove(it, 0)), "entry 1 (Ada, 2026-01-02T00:00:00Z) follows a missing entry");
    says(altered(|it| remove(it, 3)), "entry 4 ");
    says(altered(|it| remove(it, 6)), "at the end");
    says(altered(|it| it["entries"].as_array_mut().expect("a list").swap(1, 2)), "a missing entry");
    says(altered(|it| it["entries"][6] = it["entries"][5].clone()), "twice");
    let other_source = |it: &mut Value| {
        let subjects = it["subjects"].as_object_mut().expect("members");
        subjects.values_mut().for_each(|subject| subject["source"] = json!("scenario S = { delay }"));
    };
    says(altered(other_source), "the approved subject");
    says(altered(|it| it["subjects"] = json!({})), "approves content that is missing");
}

#[test]
fn other_documents_and_later_versions_are_refused_as_what_they_are() {
    let read = |text: &str| Record::from_json(text);
    assert!(matches!(
        read("{\"format\":\"enroute-plan/1\"}"),
        Err(RecordError::Format { found }) if found.contains("enroute-plan/1")
    ));
    assert!(matches!(read("{\"format\":\"enroute-review/4\"}"), Err(RecordError::Newer { .. })));
    for damaged in
        ["{", "{\"format\":\"enroute-review/3\"}", "{\"format\":\"enroute-review/1\",\"comments\":[{}]}"]
    {
        assert!(matches!(read(damaged), Err(RecordError::Damaged(_))), "{damaged}");
    }
}

#[test]
fn runs_that_were_altered_are_refused_and_those_without_a_digest_are_made_again() {
    let why = altered(|it| it["runs"][0]["tally"]["succeeded"] = json!(20)).expect_err("it is altered");
    assert!(matches!(&why, RecordError::Broken(why) if why.contains("runs of content c1")), "{why}");
    let bare = altered(|it| {
        it["runs"][0].as_object_mut().expect("members").remove("digest");
        it["runs"][0]["tally"]["succeeded"] = json!(20);
    });
    let bare = bare.expect("the history is as it was");
    assert_eq!((bare.runs_of("c1"), bare.entries().len()), (None, 7));
}

#[test]
fn what_the_version_before_kept_becomes_a_history_the_same_everywhere() {
    let document = json!({
        "format": "enroute-review/1",
        "mission": "Day",
        "comments": [{ "author": "Ada", "time": "2026-01-02T00:00:00Z", "text": "why?", "content_hash": "c1" }],
        "sign_offs": [{ "name": "Grace", "time": "2026-01-01T00:00:00Z", "content_hash": "c1",
                        "counts": [1, 2, 0], "source": "scenario S = { }" }],
        "ruled": { "by": "Chair", "time": "2026-01-03T00:00:00Z", "rules": { "slope_deg": 2.5 } },
    })
    .to_string();
    let record = Record::from_json(&document).expect("it is known");
    let told: Vec<(&str, &str)> =
        record.entries().iter().map(|entry| (entry.by.as_str(), entry.act.name())).collect();
    assert_eq!(told, [("Grace", "approved"), ("Ada", "commented"), ("Chair", "set the flight rules")]);
    // No one has signed any of it: it is told, and counts for nothing.
    let record = judged(record);
    assert!(record.checked().all(|(_, check)| check.signature == Signature::Unsigned && !check.counts()));
    assert_eq!((record.last_approval(), record.rules()), (None, &FlightRules::default()));
    assert_eq!(record.subject(&record.entries()[0]).map(|subject| subject.counts), Some([1, 2, 0]));
    assert_eq!(Record::from_json(&document), Ok(record.clone()));
    let mut twice = record.clone();
    assert_eq!(twice.merge(Record::from_json(&document).expect("the same")), 0);
    assert_eq!(Record::from_json(&record.to_json()), Ok(record));
    // A name can't add lines to what is printed of it.
    let hidden = document.replace("\"Ada\"", "\"Ada\\n9 Grace approved [valid]\"");
    assert!(matches!(Record::from_json(&hidden), Err(RecordError::Damaged(_))), "{hidden}");
}

#[test]
fn what_two_people_did_apart_is_joined_to_one_history_whoever_joins_it() {
    let common = full();
    let (mut mine, mut theirs) = (common.clone(), common.clone());
    mine.add(who("Ada", "2026-01-10T00:00:00Z"), comment("mine"), &key("Ada"));
    theirs.add(who("Grace", "2026-01-09T00:00:00Z"), comment("theirs"), &key("Grace"));
    theirs.keep_runs(runs("c1", 40));
    theirs.keep_runs(runs("c2", 10));
    let (mut joined, mut other_way) = (mine.clone(), theirs.clone());
    assert_eq!((joined.merge(theirs.clone()), other_way.merge(mine)), (1, 1));
    assert_eq!(joined.entries(), other_way.entries());
    assert_eq!(joined.heads().count(), 2);
    assert_eq!(joined.runs_of("c1").map(|runs| runs.runs), Some(40));
    assert_eq!(joined.merge(theirs), 0, "nothing twice");
    // What comes next closes both.
    joined.add(who("Chair", "2026-01-11T00:00:00Z"), comment("both read"), &key("Chair"));
    assert_eq!(joined.heads().count(), 1);
    let texts: Vec<&str> = joined.entries().iter().skip(7).map(|entry| entry.act.text()).collect();
    assert_eq!(texts, ["theirs", "mine", "both read"]);
    assert_eq!(Record::from_json(&joined.to_json()), Ok(joined));
}

#[test]
fn entries_stay_after_those_that_they_were_made_after_whatever_their_clocks_say() {
    let mut mine = Record::default();
    mine.add(who("Ada", "2026-01-05T00:00:00Z"), comment("first"), &key("Ada"));
    let mut theirs = mine.clone();
    // Grace's clock is slow by minutes.
    theirs.add(who("Grace", "2026-01-04T23:55:00Z"), comment("second"), &key("Grace"));
    mine.add(who("Ada", "2026-01-06T00:00:00Z"), comment("third"), &key("Ada"));
    mine.merge(theirs);
    let texts: Vec<&str> = mine.entries().iter().map(|entry| entry.act.text()).collect();
    assert_eq!(texts, ["first", "second", "third"]);
    assert_eq!(Record::from_json(&mine.to_json()), Ok(mine));
}

#[test]
fn runs_of_the_last_contents_are_kept() {
    let mut record = Record::default();
    for content in 0..20 {
        record.keep_runs(runs(&format!("c{content}"), 10));
    }
    assert_eq!(record.runs.len(), super::record::MAX_RUNS_KEPT);
    assert!(record.runs_of("c19").is_some() && record.runs_of("c0").is_none());
    assert!(!record.is_empty());
}

#[test]
fn texts_differ_where_they_differ() {
    let changes = since::text_changes("a\nb\nc\nd\ne\n", "a\nB\nc\nd\nd2\ne\n");
    let places: Vec<_> = changes
        .iter()
        .map(|it| (it.before_line, it.after_line, it.removed.join("|"), it.added.join("|")))
        .collect();
    let expected = [(2, 2, "b", "B"), (5, 5, "", "d2")];
    assert_eq!(places, expected.map(|(from, to, gone, new)| (from, to, gone.to_owned(), new.to_owned())));
    assert_eq!(since::text_changes("a\n", "a\n"), []);
    let [all] = since::text_changes("", "x\ny").try_into().expect("one place");
    assert_eq!((all.removed.len(), all.added.len()), (0, 2));
}
