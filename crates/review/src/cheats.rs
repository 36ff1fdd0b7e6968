//! Each way to cheat a board, tried: what is forged, moved, dropped, replayed or said by someone else counts for nothing.

use serde_json::{Value, json};
use snapshot::{Goal, Robustness, RobustnessSettings, Tally, Uncertainty};

use super::board::{PlanStatus, Present, standing};
use super::check::{Check, Signature};
use super::keys::{KeyError, KeyRing, Person, PublicKey, SecretKey};
use super::record::{Act, Entry, LineKey, Record, RecordError, Runs, Said, Subject, Who};
use super::record_tests::{NOW, judged, key, trust};
use super::seat::Seat;
use super::tests::{LASTING, SCENARIO, reviewed, snapshot};
use super::{FlightRules, MissionRule, Review, Section, Status, WaiverState};

mod assumptions_tests;
mod carried_tests;
mod histories_tests;
mod rules_tests;

const PEOPLE: [&str; 3] = ["Chair", "Ada", "Grace"];

/// A board of two people in one role, before a mission of which nothing needs attention.
struct Board {
    review: Review,
    source: String,
    record: Record,
    minute: u32,
}

impl Board {
    fn new(source: &str) -> Self {
        Self::of_mission("enroute", source)
    }

    fn of_mission(mission: &str, source: &str) -> Self {
        let seat = Seat::new("Reviewer", 2);
        let rules = FlightRules { board: vec![seat], ..FlightRules::default() };
        let mut review = reviewed(source);
        review.judge(&rules, None);
        let mut record = judged(Record::new(mission));
        record.seed(super::hash::sha256(source.as_bytes()).as_bytes()[..32].try_into().expect("32 bytes"));
        let mut board = Self { review, source: source.to_owned(), record, minute: 0 };
        board.say("Chair", Act::Rules { rules });
        board
    }

    fn who(&mut self, by: &str) -> Who {
        self.minute += 1;
        Who {
            by: by.to_owned(),
            role: "Reviewer".to_owned(),
            time: format!("2026-01-01T00:{:02}:00Z", self.minute),
            content_hash: self.review.content_hash.clone(),
            plan_hash: self.review.plan_hash.clone(),
        }
    }

    /// Returns what someone says who comes after no one, without an act of its own.
    fn said(&mut self, by: &str) -> Said {
        let who = self.who(by);
        let act = Act::Comment { about: None, to: None, text: "Fine.".to_owned() };
        let mission = "enroute".to_owned();
        Said { mission, former: Vec::new(), ..self.record.said(who, act) }
    }

    /// Someone says something, signed by a key. Returns the entry's digest.
    fn say_with(&mut self, by: &str, act: Act, secret: &SecretKey) -> String {
        let who = self.who(by);
        self.record.add(who, act, secret)
    }

    fn say(&mut self, by: &str, act: Act) -> String {
        self.say_with(by, act, &key(by))
    }

    fn approve_with(&mut self, by: &str, secret: &SecretKey) -> String {
        let plan = Value::Null;
        let subject = Subject::new(&self.review, &self.source, Goal::Default, 0, plan, None);
        let relied_on = standing(&self.record, &Present::of_review(&self.review)).relied_on;
        let who = self.who(by);
        self.record.approve(who, subject, String::new(), relied_on, secret)
    }

    fn approve(&mut self, by: &str) -> String {
        self.approve_with(by, &key(by))
    }

    fn status(&self) -> PlanStatus {
        self.status_of(&self.record)
    }

    fn status_of(&self, record: &Record) -> PlanStatus {
        let mut review = self.review.clone();
        review.judge(record.rules(), None);
        standing(record, &Present::of_review(&review)).status
    }

    /// The status for someone who holds the plan against other flight rules.
    fn status_under(&self, rules: &FlightRules) -> PlanStatus {
        let mut review = self.review.clone();
        review.judge(rules, None);
        standing(&self.record, &Present::of_review(&review)).status
    }

    fn seats(&self) -> String {
        standing(&self.record, &Present::of_review(&self.review)).seats_in_words()
    }

    /// The history as someone reads it who was handed the document with something done to it.
    fn read(&self, change: impl FnOnce(&mut Value)) -> Result<Record, RecordError> {
        let mut document: Value = serde_json::from_str(&self.record.to_json()).expect("JSON");
        change(&mut document);
        Record::from_json(&document.to_string()).map(judged)
    }
}

/// Returns what was found of the last entry.
fn last_check(record: &Record) -> (Signature, String) {
    let (_, check) = record.checked().next_back().expect("an entry");
    (check.signature, check.problem.clone().unwrap_or_default())
}

/// Approved by Ada and Grace.
fn approved() -> Board {
    let mut board = Board::new(LASTING);
    board.approve("Ada");
    assert_eq!(board.status(), PlanStatus::InReview);
    board.approve("Grace");
    assert_eq!(board.status(), PlanStatus::Approved);
    board
}

#[test]
fn one_person_with_three_spellings_is_one_person() {
    let mut ring = KeyRing::default();
    ring.add(Person::new("Ada", key("Ada"))).expect("a first name");
    for (spelled, secret) in
        [("Àda", key("b")), ("\u{410}da", key("c")), ("ada", key("d")), ("A d a", key("e"))]
    {
        let refused = ring.add(Person::new(spelled, secret)).expect_err("it looks like Ada");
        assert!(matches!(refused, KeyError::Alike { .. } | KeyError::Name(_)), "{spelled}: {refused}");
    }
    // By one key, all spellings are one person, and only under the name of the key.
    let mut board = Board::new(LASTING);
    board.approve("Ada");
    for spelled in ["Àda", "\u{410}da", "Grace"] {
        board.approve_with(spelled, &key("Ada"));
        let (signature, problem) = last_check(&board.record);
        assert_eq!(signature, Signature::Valid);
        assert!(problem.contains("the key is that of “Ada”"), "{problem}");
    }
    board.approve("Ada");
    assert_eq!((board.seats(), board.status()), ("Reviewer 1 of 2".to_owned(), PlanStatus::InReview));
    // With keys that no one trusts, none of them is anybody.
    for (spelled, secret) in [("Àda", key("b")), ("\u{410}da", key("c")), ("Grace", key("d"))] {
        board.approve_with(spelled, &secret);
        let (signature, problem) = last_check(&board.record);
        assert_eq!(signature, Signature::Unknown);
        assert!(problem.contains("who has another key"), "{problem}");
    }
    assert_eq!(board.seats(), "Reviewer 1 of 2");
}

#[test]
fn a_key_has_one_name_and_its_two_halves_belong_together() {
    let mut ring = KeyRing::default();
    ring.add(Person::new("Ada", key("Ada"))).expect("a first name");
    let again = ring.add(Person::new("Grace", key("Ada"))).expect_err("it is Ada's");
    assert!(matches!(again, KeyError::Known { .. }), "{again}");
    assert_eq!(KeyRing::from_json(&ring.to_json(true)), Ok(ring.clone()));
    let shared = KeyRing::from_json(&ring.to_json(false)).expect("keys to trust");
    let name = |ring: &KeyRing| ring.trust().name_of(&key("Ada").public()).map(str::to_owned);
    assert_eq!((shared.own().count(), name(&shared)), (0, name(&ring)));
    assert!(!ring.to_json(false).contains("secret"));
    let foreign = ring.to_json(true).replace(key("Ada").public().as_str(), key("Grace").public().as_str());
    assert!(matches!(KeyRing::from_json(&foreign), Err(KeyError::Damaged(_))));
    for (format, wrong) in [("enroute-keys/2", "later version"), ("enroute-rules/1", "not a key file")] {
        let refused = KeyRing::from_json(&json!({ "format": format, "keys": [] }).to_string());
        assert!(refused.expect_err("another format").to_string().contains(wrong), "{format}");
    }
    for wrong in ["", "ab", &"0".repeat(63), &"g".repeat(64)] {
        assert_eq!(PublicKey::read(wrong), None, "{wrong}");
    }
}

#[test]
fn rules_that_change_lapse_approvals_and_rules_of_nobody_are_none() {
    let mut board = approved();
    let rules = board.record.rules().clone();
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..rules.clone() };
    let flat = FlightRules { slope_deg: Some(1.0), ..rules.clone() };
    // An outsider asks for less: it has no effect, but it has to be looked at.
    board.say_with("Eve", Act::Rules { rules: one.clone() }, &key("Eve"));
    assert_eq!((board.record.rules(), board.status()), (&rules, PlanStatus::InReview));
    let three = FlightRules { board: vec![Seat::new("Reviewer", 3)], ..rules.clone() };
    for changed in [flat, three] {
        board.say("Chair", Act::Rules { rules: changed.clone() });
        assert_eq!(board.record.rules(), &changed);
        assert_eq!(board.status_of(&board.record), PlanStatus::Lapsed);
    }
    // What an approval signs and what it approves are held against each other.
    let mut board = Board::new(LASTING);
    let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
    let said = Said {
        rules: FlightRules::default().digest(),
        former: board.record.heads().map(str::to_owned).collect(),
        act: Act::Approve { subject: board.record.keep_subject(subject), text: String::new() },
        ..board.said("Ada")
    };
    let forged = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
    assert!(last_check(&forged).1.contains("other flight rules"), "{:?}", last_check(&forged));
}

/// A record to which someone has written an entry by other means than this program.
fn with_entry(record: &Record, entry: &Entry) -> Record {
    let mut document: Value = serde_json::from_str(&record.to_json()).expect("JSON");
    let written = json!({ "digest": entry.digest(), "said": entry.raw(), "signature": entry.signature() });
    document["entries"].as_array_mut().expect("a list").push(written);
    let heads = record.heads().filter(|head| !entry.former.iter().any(|former| former == head));
    document["heads"] = heads.chain([entry.digest()]).collect();
    judged(Record::from_json(&document.to_string()).expect("it is whole"))
}

#[test]
fn nobody_approves_in_the_role_of_somebody_else() {
    let mut board = Board::new(LASTING);
    let safety = Seat { people: vec![key("Grace").public()], ..Seat::new("Safety", 1) };
    let board_of = |seat: Seat| FlightRules { board: vec![seat], ..FlightRules::default() };
    for by in ["Chair", "Ada"] {
        board.say(by, Act::Rules { rules: board_of(safety.clone()) });
    }
    board.review.judge(board.record.rules(), None);
    let may = |board: &Board, by: &str| {
        standing(&board.record, &Present::of_review(&board.review)).may_approve(&key(by).public(), "Safety")
    };
    assert!(may(&board, "Ada").is_err_and(|why| why.contains("does not approve as Safety")));
    assert_eq!(may(&board, "Grace"), Ok(()));
    // If it is signed by other means, it still does not count as an approval of the role.
    for by in ["Ada", "Grace"] {
        let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
        let who = Who { role: "Safety".to_owned(), ..board.who(by) };
        board.record.approve(who, subject, String::new(), Vec::new(), &key(by));
        assert_eq!(board.status().is_approved(), by == "Grace", "{by}");
    }
    // A role cannot name fewer people than have to approve, or someone twice.
    for people in [vec![key("Ada")], vec![key("Ada"), key("Ada")]] {
        let people = people.iter().map(SecretKey::public).collect();
        assert!(board_of(Seat { people, ..Seat::new("Safety", 2) }).problem().is_some());
    }
    assert_eq!(board_of(safety).problem(), None);
}

#[test]
fn only_the_signer_takes_a_signature_back() {
    let mut board = Board::new(LASTING);
    board.approve("Grace");
    let of = board.approve("Ada");
    let take_back = |of: &str| Act::Withdraw { of: of.to_owned(), text: "Not read.".to_owned() };
    for (by, secret) in [("Grace", key("Grace")), ("Eve", key("Eve")), ("Ada", key("Eve"))] {
        board.say_with(by, take_back(&of), &secret);
        assert!(last_check(&board.record).1.contains("only the person who signed") || by == "Ada");
        assert!(!board.record.checked().next_back().is_some_and(|(_, check)| check.counts()), "{by}");
        assert_eq!(board.status(), PlanStatus::Approved, "{by}");
    }
    board.say("Ada", take_back(&of));
    assert_eq!(board.status(), PlanStatus::InReview);
}

#[test]
fn only_who_is_concerned_resolves_a_comment_and_says_why() {
    let mut board = approved();
    let to = Some(key("Grace").public());
    let of = board.say("Ada", Act::Comment { about: None, to, text: "Why so late?".to_owned() });
    assert_eq!(board.status(), PlanStatus::InReview);
    let resolve = |text: &str| Act::Resolve { of: of.clone(), text: text.to_owned() };
    for (by, text) in [("Chair", "It is fine."), ("Grace", " "), ("Eve", "It is fine.")] {
        board.say(by, resolve(text));
        assert_eq!(board.status(), PlanStatus::InReview, "{by}");
    }
    board.say("Grace", resolve("It waits for light."));
    assert_eq!(board.status(), PlanStatus::Approved);
    let other = board.say("Chair", Act::Reopen { of: of.clone(), text: "No.".to_owned() });
    assert_eq!(board.status(), PlanStatus::Approved, "it is not the Chair's to reopen: {other}");
    board.say("Ada", Act::Reopen { of: of.clone(), text: "Not at noon.".to_owned() });
    assert_eq!(board.status(), PlanStatus::InReview);
    board.say("Ada", resolve("It is night."));
    assert_eq!(board.status(), PlanStatus::Approved);
}

/// Writes the whole history again with something altered, as a forger does: digests that fit, and signatures that are left.
fn forge(board: &Board, change: impl Fn(usize, &mut Value)) -> Record {
    board
        .read(|document| {
            let mut renamed: Vec<(String, String)> = Vec::new();
            let entries = document["entries"].as_array_mut().expect("a list");
            for (index, entry) in entries.iter_mut().enumerate() {
                let mut text = entry["said"].to_string();
                for (from, to) in &renamed {
                    text = text.replace(from, to);
                }
                let mut said: Value = serde_json::from_str(&text).expect("JSON");
                change(index, &mut said);
                let sealed = super::sealed::Sealed::<Said>::read(said.clone()).expect("an entry");
                let former = entry["digest"].as_str().expect("a digest").to_owned();
                renamed.push((former, sealed.digest().to_owned()));
                entry["said"] = said;
                entry["digest"] = json!(sealed.digest());
            }
            let last = entries.last().expect("an entry")["digest"].clone();
            document["heads"] = json!([last]);
            let new = renamed.iter().find(|(from, _)| document["history"] == json!(from));
            document["history"] = json!(new.expect("the first entry").1);
        })
        .expect("it is whole")
}

#[test]
fn a_forged_history_counts_for_nothing_from_the_forged_entry_on() {
    let board = approved();
    assert_eq!(board.status_of(&forge(&board, |_, _| {})), PlanStatus::Approved, "nothing was altered");
    // Words, names, contents, times, keys: whatever is altered breaks its signature and all that follow.
    let elsewhere = key("Eve").public();
    let changes: [(&str, Value); 7] = [
        ("by", json!("Eve")),
        ("role", json!("Press")),
        ("time", json!("2026-01-01T00:00:30Z")),
        ("content_hash", json!("c2")),
        ("plan_hash", json!("p2")),
        ("acknowledged", json!(["0"])),
        ("key", json!(elsewhere)),
    ];
    for (member, value) in changes {
        let forged = forge(&board, |index, said| {
            if index == 1 {
                said[member] = value.clone();
            }
        });
        let signatures: Vec<Signature> = forged.checked().map(|(_, check)| check.signature).collect();
        assert_eq!(signatures, [Signature::Valid, Signature::Broken, Signature::Broken], "{member}");
        assert!(!board.status_of(&forged).is_approved());
        assert_eq!(forged.counted().count(), 1, "{member}");
    }
    // A forger with a key of his own signs, and no one knows the key.
    let mut forger = Board::new(LASTING);
    forger.approve_with("Ada", &key("Eve"));
    forger.approve_with("Grace", &key("Mallory"));
    let signatures: Vec<Signature> = forger.record.checked().map(|(_, check)| check.signature).collect();
    assert_eq!(signatures, [Signature::Valid, Signature::Unknown, Signature::Unknown]);
    assert_eq!(forger.status(), PlanStatus::Draft);
}

#[test]
fn entries_that_are_dropped_put_elsewhere_or_there_twice_are_noticed() {
    let board = approved();
    let says = |found: Result<Record, RecordError>, words: &str| match found {
        Err(RecordError::Broken(why)) => assert!(why.contains(words), "{why}"),
        other => panic!("{words}: {other:?}"),
    };
    let entries = |it: &mut Value| it["entries"].as_array_mut().expect("a list").clone();
    for index in 0..2 {
        let dropped = board.read(|it| {
            it["entries"].as_array_mut().expect("a list").remove(index);
        });
        says(dropped, "follows a missing entry");
    }
    says(board.read(|it| it["entries"].as_array_mut().expect("a list").swap(1, 2)), "a missing entry");
    says(
        board.read(|it| {
            let again = entries(it)[2].clone();
            it["entries"].as_array_mut().expect("a list").push(again);
        }),
        "twice",
    );
    // The last entries can be left out with the heads, and whoever has seen them still has them.
    let mut shorter = board
        .read(|it| {
            let all = entries(it);
            it["entries"].as_array_mut().expect("a list").pop();
            it["heads"] = json!([all[1]["digest"]]);
        })
        .expect("it is whole");
    assert_eq!(board.status_of(&shorter), PlanStatus::InReview);
    shorter.merge(board.record.clone());
    assert_eq!(board.status_of(&shorter), PlanStatus::Approved);
}

#[test]
fn an_approval_is_not_replayed_for_another_content_or_another_history() {
    let board = approved();
    let mut other = Board::new(SCENARIO);
    let approvals: Vec<Entry> = board.record.entries()[1..].to_vec();
    for approval in &approvals {
        let mut document: Value = serde_json::from_str(&other.record.to_json()).expect("JSON");
        document["entries"].as_array_mut().expect("a list").push(
            json!({ "digest": approval.digest(), "said": approval.raw(), "signature": approval.signature() }),
        );
        let read = Record::from_json(&document.to_string());
        assert!(matches!(read, Err(RecordError::Broken(_))), "{read:?}");
    }
    // The signature of one entry below the words of another.
    let moved = board.read(|it| it["entries"][1]["signature"] = it["entries"][2]["signature"].clone());
    let moved = moved.expect("it is whole");
    assert_eq!(moved.checked().nth(1).map(|(_, check)| check.signature), Some(Signature::Broken));
    assert_eq!(board.status_of(&moved), PlanStatus::InReview);
    // Joined histories of two missions: an approval is of its content.
    other.record.merge(board.record.clone());
    assert!(!other.status().is_approved());
    // A broken copy does not displace what is valid, and gives way to it.
    let mut mine = board.record.clone();
    mine.merge(moved.clone());
    assert_eq!(board.status_of(&mine), PlanStatus::Approved);
    let mut theirs = moved;
    theirs.merge(board.record.clone());
    assert_eq!(board.status_of(&theirs), PlanStatus::Approved);
}

#[test]
fn impossible_dates_and_missing_signatures_are_marked() {
    for (time, words) in [
        ("2026-03-01T00:00:00Z", "in the future"),
        ("2025-12-31T00:00:00Z", "before an entry that it follows"),
        ("yesterday", "malformed"),
        ("2026-01-01", "malformed"),
        ("2026-13-01T00:00:00Z", "malformed"),
        ("2026-01-01T00:00:00+01:00", "malformed"),
    ] {
        let mut board = Board::new(LASTING);
        let said = Said {
            time: time.to_owned(),
            former: board.record.heads().map(str::to_owned).collect(),
            ..board.said("Ada")
        };
        let read = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
        let (signature, problem) = last_check(&read);
        assert_eq!(signature, Signature::Valid);
        assert!(problem.contains(words), "{time}: {problem}");
        assert_eq!(read.counted().count(), 1);
    }
    // Clocks may differ by minutes.
    let mut late = approved().record;
    late.judge(&trust(&PEOPLE), "2025-12-31T23:55:00Z");
    assert_eq!(late.counted().count(), 3);
    late.judge(&trust(&PEOPLE), "2025-12-31T23:45:00Z");
    assert_eq!(late.counted().count(), 0);
    // What earlier versions wrote has no signatures.
    let board = approved();
    let bare = board.read(|it| {
        it["format"] = json!("enroute-review/2");
        for entry in it["entries"].as_array_mut().expect("a list") {
            entry.as_object_mut().expect("members").remove("signature");
        }
    });
    let bare = bare.expect("it is whole");
    assert!(bare.checked().all(|(_, check)| check.signature == Signature::Unsigned));
    assert_eq!((bare.counted().count(), board.status_of(&bare)), (0, PlanStatus::Draft));
}

#[test]
fn nothing_counts_before_it_is_known_whose_keys_are_trusted() {
    let board = approved();
    let mut read = Record::from_json(&board.record.to_json()).expect("it is whole");
    assert_eq!((read.counted().count(), read.rules()), (0, &FlightRules::default()));
    read.judge(&trust(&["Chair", "Ada"]), NOW);
    assert_eq!(board.status_of(&read), PlanStatus::InReview, "nobody knows Grace");
    read.judge(&trust(&PEOPLE), NOW);
    assert_eq!(board.status_of(&read), PlanStatus::Approved);
}

/// A mission in which the world waits for a while, before this or that.
fn with_delay(world: &str) -> String {
    format!(
        "var GO : {{OK, NO}}; var STORM : {{ON, OFF}}; primitive Dig()[4,4];
        scenario Day[0,90] = {{ {{ delay; do {{ Dig() }} maintaining GO=OK }}, {{ {world} }} }}"
    )
}

/// A second pair of the same activities is not accepted with the first one, and neither is the same pair elsewhere.
#[test]
fn an_acknowledged_overlap_is_of_all_its_pairs_and_their_places() {
    let of = |tail: &str| {
        reviewed(&format!(
            "location A (0, 0); vehicle R : ATRV at A;
             primitive Dig()[5,9]; primitive Look()[5,9]; primitive Wait()[1,1];
             scenario S[0,90] = {{ {{ Dig(), Look() }}; {tail} }}"
        ))
    };
    let overlaps = |review: &Review| {
        let lines = review.overlaps.iter().filter(|line| line.status == Status::Attention);
        let lines = lines.filter(|line| line.text.starts_with("Dig and Look"));
        lines.map(|line| LineKey::new(Section::Overlaps, line)).collect::<Vec<_>>()
    };
    let one = of("Wait()");
    let [line] = &overlaps(&one)[..] else { panic!("one item: {:?}", one.overlaps) };
    let more = ["{ Dig(), Look() }", "{ Dig(), { Wait(); Look() } }", "{ Dig(), Look() }; { Dig(), Look() }"];
    let mut seen = vec![line.clone()];
    for tail in more {
        let several = of(tail);
        let lines = overlaps(&several);
        assert_eq!(lines.len(), 1, "{lines:?}");
        assert!(lines[0].text.contains("pair"), "{}", lines[0].text);
        assert!(!seen.contains(&lines[0]), "{tail}");
        seen.extend(lines);
    }
}

#[test]
fn a_flight_rule_that_the_plan_violates_is_waived_and_not_acknowledged() {
    let source = "var P : {OK, GONE}; primitive A()[5,10];
        scenario S[0,100] = { { delay[5,5]; A() }, P=OK [9,9] }";
    let mut board = Board::new(source);
    let rule = MissionRule {
        name: "Open".to_owned(),
        rule: "never A while P=OK".to_owned(),
        source: "FR 7".to_owned(),
        waivable: true,
    };
    let rules = FlightRules { rules: vec![rule], ..board.record.rules().clone() };
    board.say("Chair", Act::Rules { rules: rules.clone() });
    board.review.hold_against(&snapshot(source), &rules, None, &mut || false);
    let [line] = board.review.lines(Section::MissionRules)[..] else { panic!("one line") };
    assert_eq!((line.status, line.needs_waiver), (Status::Attention, true), "{}", line.text);
    let line = LineKey::new(Section::MissionRules, line);
    // With the mark left out, it is another line.
    for line in [line.clone(), LineKey { needs_waiver: false, ..line.clone() }] {
        board.say("Ada", Act::Acknowledge { line, text: "Fine.".to_owned() });
        let standing = standing(&board.record, &Present::of_review(&board.review));
        assert!(
            standing.blockers().contains(&"1 item needs a waiver".to_owned()),
            "{:?}",
            standing.blockers()
        );
    }
    let (text, until) = ("Fine today.".to_owned(), "2026-02-05".to_owned());
    board.say("Ada", Act::Waive { line, text, until });
    let standing = standing(&board.record, &Present::of_review(&board.review));
    assert!(standing.unacknowledged.is_empty());
}

#[test]
fn an_acknowledgment_is_of_a_place_and_not_only_of_words() {
    let here = with_delay("delay[5,20]; GO=OK [10,10]; STORM=ON [5,5]");
    let mut board = Board::new(&here);
    let assumed = |review: &Review| {
        let lines = review
            .plan
            .iter()
            .filter(|line| line.text.starts_with("assumes favorable timing of external events"));
        let lines: Vec<LineKey> = lines.map(|line| LineKey::new(Section::Plan, line)).collect();
        let [line] = lines.as_slice() else { panic!("one line: {lines:?}") };
        line.clone()
    };
    let line = assumed(&board.review);
    assert_eq!(line.place, "[5,20] in a branch of scenario#1, after the start, before Tell(GO=OK)#1");
    let lines: Vec<LineKey> = standing(&board.record, &Present::of_review(&board.review))
        .unacknowledged
        .iter()
        .map(|(section, line)| LineKey::new(*section, line))
        .collect();
    for line in lines {
        board.say("Ada", Act::Acknowledge { line, text: "As meant.".to_owned() });
    }
    board.approve("Ada");
    board.approve("Grace");
    assert_eq!(board.status(), PlanStatus::Approved);
    // The same words at another place are another line.
    for moved in ["GO=OK [10,10]; delay[5,20]; STORM=ON [5,5]", "STORM=ON [5,5]; delay[5,20]; GO=OK [10,10]"]
    {
        let mut there = reviewed(&with_delay(moved));
        there.judge(board.record.rules(), None);
        let moved_line = assumed(&there);
        assert_eq!((&moved_line.text, &moved_line.criterion), (&line.text, &line.criterion));
        assert_ne!(moved_line.place, line.place);
        let standing = standing(&board.record, &Present::of_review(&there));
        let open = standing.unacknowledged.iter().map(|(section, line)| LineKey::new(*section, line));
        assert!(open.collect::<Vec<_>>().contains(&moved_line), "{moved}");
    }
    // What comes next in the text is another one, and all else as it was.
    let other_next = reviewed(&with_delay("delay[5,20]; STORM=ON [5,5]; GO=OK [10,10]"));
    assert_ne!(assumed(&other_next).place, line.place);
    // So is a branch beside another one, although the same comes next.
    let branch = reviewed(&with_delay("{ delay[5,20], STORM=OFF[1,1] }; GO=OK [10,10]; STORM=ON [5,5]"));
    assert_ne!(assumed(&branch).place, line.place);
    // An edit elsewhere leaves the place as it is.
    let longer = reviewed(&here.replace("Dig()[4,4]", "Dig()[4,5]"));
    assert_eq!(assumed(&longer), line);
}

#[test]
fn acknowledgments_and_rules_of_another_mission_count_for_nothing() {
    let mut theirs = Board::of_mission("elsewhere", SCENARIO);
    let lax = FlightRules {
        slope_deg: None,
        board: vec![Seat::new("Reviewer", 1)],
        ..theirs.record.rules().clone()
    };
    for by in ["Chair", "Ada"] {
        theirs.say(by, Act::Rules { rules: lax.clone() });
    }
    assert_eq!(theirs.record.rules(), &lax);
    for line in unacknowledged(&theirs) {
        theirs.say("Ada", Act::Acknowledge { line, text: "As meant there.".to_owned() });
    }
    assert!(unacknowledged(&theirs).is_empty());
    // The same items at the same places, in a mission of the same text.
    let mut mine = Board::new(SCENARIO);
    let (open, rules) = (unacknowledged(&mine), mine.record.rules().clone());
    assert!(!open.is_empty());
    mine.record.merge(theirs.record.clone());
    assert_eq!((unacknowledged(&mine), mine.record.rules()), (open.clone(), &rules));
    assert!(
        last_check(&mine.record).1.contains("the history of “elsewhere”"),
        "{:?}",
        last_check(&mine.record)
    );
    // The document says that it is of this mission, and the signatures say otherwise.
    let renamed = theirs.read(|it| it["mission"] = json!("enroute")).expect("it is whole");
    assert_eq!(renamed.counted().count(), 0);
    let forged = forge(&theirs, |_, said| said["mission"] = json!("enroute"));
    assert!(forged.checked().all(|(_, check)| check.signature == Signature::Broken));
    mine.record.merge(renamed);
    assert_eq!((unacknowledged(&mine), mine.record.rules()), (open, &rules));
}

/// The items that need attention that no one has acknowledged.
fn unacknowledged(board: &Board) -> Vec<LineKey> {
    let mut review = board.review.clone();
    review.judge(board.record.rules(), None);
    let standing = standing(&board.record, &Present::of_review(&review));
    standing.unacknowledged.iter().map(|(section, line)| LineKey::new(*section, line)).collect()
}

#[test]
fn an_entry_from_the_future_keeps_nobody_from_taking_an_approval_back() {
    for (by, secret) in [("Grace", key("Grace")), ("Eve", key("Eve"))] {
        let mut board = approved();
        let of = board.record.entries()[1].digest().to_owned();
        let said = Said {
            time: "2026-03-01T00:00:00Z".to_owned(),
            former: board.record.heads().map(str::to_owned).collect(),
            ..board.said(by)
        };
        board.record = with_entry(&board.record, &Entry::signed(said, &secret));
        assert!(last_check(&board.record).1.contains("in the future"), "{:?}", last_check(&board.record));
        let taken_back = board.say("Ada", Act::Withdraw { of, text: "Not read.".to_owned() });
        assert!(board.record.check_of(&taken_back).is_some_and(Check::counts));
        assert_eq!(board.record.number(&taken_back), 4, "before the entry from the future");
        assert_eq!(board.status(), PlanStatus::InReview, "{by}");
        // Not even when its day has come.
        board.record.judge(&trust(&PEOPLE), "2026-04-01T00:00:00Z");
        assert!(!board.status().is_approved());
        let read = Record::from_json(&board.record.to_json()).map(judged).expect("it is whole");
        assert_eq!(board.status_of(&read), PlanStatus::InReview);
    }
}

#[test]
fn an_approval_that_was_taken_back_is_not_handed_in_again() {
    let mut board = approved();
    let before = board.record.clone();
    let of = board.record.entries()[1].digest().to_owned();
    board.say("Ada", Act::Withdraw { of, text: "Not read.".to_owned() });
    board.record.merge(before.clone());
    assert_eq!(board.status(), PlanStatus::InReview);
    let mut theirs = before;
    theirs.merge(board.record.clone());
    assert_eq!(board.status_of(&theirs), PlanStatus::InReview);
}

#[test]
fn rules_and_resolutions_stay_and_an_entry_that_takes_them_back_does_not_count() {
    let mut board = approved();
    let to = Some(key("Grace").public());
    let asked = board.say("Ada", Act::Comment { about: None, to, text: "Why so late?".to_owned() });
    let resolved = board.say("Grace", Act::Resolve { of: asked, text: "It waits for light.".to_owned() });
    let rules = board.record.entries()[0].digest().to_owned();
    for (by, of) in [("Chair", rules), ("Grace", resolved)] {
        board.say(by, Act::Withdraw { of: of.clone(), text: "No.".to_owned() });
        assert!(last_check(&board.record).1.contains("can be withdrawn"), "{:?}", last_check(&board.record));
        assert!(!board.record.withdrawn().contains_key(of.as_str()));
    }
    assert_eq!(board.status(), PlanStatus::Approved);
}

#[test]
fn a_document_says_no_more_runs_than_can_be_made_again() {
    let mut board = Board::new(LASTING);
    let content = board.review.content_hash.clone();
    board.record.keep_runs(Runs::new(&content, &tallied(90)));
    assert!(board.read(|_| ()).is_ok());
    for (runs, succeeded) in [(100, 101), (1_000_000_000_000, 90)] {
        let mut forged = tallied(succeeded);
        (forged.settings.runs, forged.tally.runs) = (runs, runs);
        board.record.keep_runs(Runs::new(&content, &forged));
        assert!(matches!(board.read(|_| ()), Err(RecordError::Damaged(_))), "{runs}");
    }
}

/// 100 runs, of which `succeeded` reached the end.
fn tallied(succeeded: u64) -> Robustness {
    let settings = RobustnessSettings { runs: 100, seed: 1, uncertainty: Uncertainty::default() };
    Robustness { settings, tally: Tally { runs: 100, succeeded, ..Tally::default() } }
}

#[test]
fn a_waiver_lapses_on_its_date() {
    let mut board = Board::new(SCENARIO);
    let lines: Vec<LineKey> = standing(&board.record, &Present::of_review(&board.review))
        .unacknowledged
        .iter()
        .map(|(section, line)| LineKey::new(*section, line))
        .collect();
    assert_eq!(lines.len(), board.review.count(Status::Attention));
    for line in lines {
        let (text, until) = ("Until the software is mended.".to_owned(), "2026-02-05".to_owned());
        board.say("Chair", Act::Waive { line, text, until });
    }
    board.approve("Ada");
    board.approve("Grace");
    let at = |board: &Board, now: &str| {
        let mut record = board.record.clone();
        record.judge(&trust(&PEOPLE), now);
        (board.status_of(&record), record.waivers()[0].state)
    };
    assert_eq!(at(&board, "2026-01-28T23:59:59Z"), (PlanStatus::Approved, WaiverState::InForce));
    assert_eq!(at(&board, "2026-01-29T00:00:00Z"), (PlanStatus::Approved, WaiverState::AboutToLapse));
    assert_eq!(at(&board, "2026-02-04T23:59:59Z"), (PlanStatus::Approved, WaiverState::AboutToLapse));
    assert_eq!(at(&board, "2026-02-05T00:00:00Z"), (PlanStatus::InReview, WaiverState::Lapsed));
    // Without a review of the lines, the signatures show that a waiver has lapsed.
    let unseen = |now: &str| {
        let mut record = board.record.clone();
        record.judge(&trust(&PEOPLE), now);
        let present = Present { review: None, ..Present::of_review(&board.review) };
        standing(&record, &present).seats_in_words()
    };
    assert_eq!(unseen("2026-02-04T23:59:59Z"), "Reviewer 2 of 2");
    assert_eq!(unseen("2026-02-05T00:00:00Z"), "Reviewer 0 of 2");
    // A waiver needs a reason and a day. The day must exist, and be the same everywhere.
    let line = board.record.waivers()[0].line.clone();
    for (text, until) in [
        (" ", "2026-02-05"),
        ("Fine.", "soon"),
        ("Fine.", ""),
        ("Fine.", "2026-02-30"),
        ("Fine.", "2026-13-01"),
        ("Fine.", "20260205"),
        ("Fine.", " 2026-02-05"),
        ("Fine.", "2026-02-05T00:00:00"),
        ("Fine.", "2026-02-05T23:59:59+14:00"),
        ("Fine.", "2026-02-05T00:00:00Z"),
        ("Fine.", "2026-02-05[Pacific/Kiritimati]"),
    ] {
        let waive = Act::Waive { line: line.clone(), text: text.to_owned(), until: until.to_owned() };
        board.say("Chair", waive);
        assert!(last_check(&board.record).1.starts_with("a waiver needs"), "{:?}", last_check(&board.record));
    }
    // No one waives for a day that has passed, or that ends with the present one.
    for until in ["2025-12-31", "2026-01-01"] {
        let text = "Fine.".to_owned();
        board.say("Chair", Act::Waive { line: line.clone(), text, until: until.to_owned() });
        assert!(last_check(&board.record).1.contains("after the day"), "{:?}", last_check(&board.record));
    }
    // Taken back by its signer, it is none.
    let of = board.record.waivers()[0].entry.digest().to_owned();
    board.say("Chair", Act::Withdraw { of, text: "Mended.".to_owned() });
    assert_eq!(board.status(), PlanStatus::InReview);
}

#[test]
fn a_key_that_is_trusted_later_counts_from_then_on_and_one_that_no_one_trusts_no_longer_does() {
    let mut board = approved();
    let of = |index: usize| board.record.entries()[index].digest().to_owned();
    let back = Act::Withdraw { of: of(1), text: "Not read.".to_owned() };
    let mut record = board.record.clone();
    for (people, expected) in [
        (&["Chair", "Ada"][..], PlanStatus::InReview),
        (&PEOPLE[..], PlanStatus::Approved),
        // Without the rules of the chair, no board that was in force has approved.
        (&["Ada", "Grace"][..], PlanStatus::InReview),
        (&["Chair"][..], PlanStatus::Draft),
    ] {
        record.judge(&trust(people), NOW);
        assert_eq!(board.status_of(&record), expected, "{people:?}");
    }
    // What an unknown key takes back stays, when the key is trusted too.
    board.say_with("Eve", back, &key("Eve"));
    for people in [&PEOPLE[..], &["Chair", "Ada", "Grace", "Eve"][..]] {
        board.record.judge(&trust(people), NOW);
        assert_eq!(board.status(), PlanStatus::Approved, "{people:?}");
    }
}

#[test]
fn an_approval_of_no_plan_does_not_count_for_every_plan() {
    let mut board = Board::new(LASTING);
    board.approve("Grace");
    let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
    let who = Who { plan_hash: String::new(), ..board.who("Ada") };
    board.record.approve(who, subject, String::new(), Vec::new(), &key("Ada"));
    assert_eq!(last_check(&board.record), (Signature::Valid, String::new()));
    assert_eq!((board.seats(), board.status()), ("Reviewer 1 of 2".to_owned(), PlanStatus::InReview));
}

#[test]
fn names_and_roles_with_characters_that_cannot_be_seen_are_refused() {
    let board = approved();
    for hidden in ["\n   9  Grace approved [valid]", "\u{202e}", "\u{200b}", "\u{1b}[2K"] {
        for member in ["by", "role", "time"] {
            let mut forger = Board::new(LASTING);
            let mut who = forger.who("Ada");
            let part = match member {
                "by" => &mut who.by,
                "role" => &mut who.role,
                _ => &mut who.time,
            };
            part.push_str(hidden);
            forger.record.add(who, Act::Comment { about: None, to: None, text: "Fine.".into() }, &key("Ada"));
            assert!(last_check(&forger.record).1.contains("invisible"), "{member} {hidden:?}");
            let read = forger.read(|_| ());
            assert!(
                matches!(&read, Err(RecordError::Damaged(why)) if why.contains("entry 2") && !why.contains(hidden)),
                "{member} {hidden:?}: {read:?}"
            );
        }
    }
    // Spaces around a name and another spelling of its letters are the same name.
    let mut spaced = board.record.clone();
    spaced.add(
        Who { by: " Ada\u{a0}".to_owned(), ..super::record_tests::who("Ada", NOW) },
        Act::Comment { about: None, to: None, text: "Fine.".to_owned() },
        &key("Ada"),
    );
    assert_eq!(last_check(&spaced), (Signature::Valid, String::new()));
    // The names of two roles must not look alike.
    for role in ["Reviewer ", "reviewer", "R\u{435}viewer", "Re\u{200b}viewer", "Réviewer", "\u{3000}"] {
        let rules = FlightRules {
            board: vec![Seat::new("Reviewer", 1), Seat::new(role, 1)],
            ..FlightRules::default()
        };
        assert!(rules.problem().is_some_and(|why| why.contains("role")), "{role:?}");
    }
}

/// Programs take the first or the last of two members with the same name, so people may see something else.
#[test]
fn documents_with_two_members_of_one_name_are_refused() {
    let board = approved();
    let document = board.record.to_json();
    for (from, to, name) in [
        ("\"entries\": [", "\"entries\": [], \"entries\": [", "`entries`"),
        ("\"role\": \"Reviewer\",", "\"role\": \"Press\", \"role\": \"Reviewer\",", "`role`"),
        ("\"by\": \"Ada\",", "\"by\": \"Eve\", \"by\": \"Ada\",", "`by`"),
        ("\"subjects\": {", "\"subjects\": {}, \"subjects\": {", "`subjects`"),
    ] {
        let twice = document.replacen(from, to, 1);
        assert_ne!(twice, document, "{from}");
        let why = Record::from_json(&twice).expect_err(name);
        assert!(matches!(&why, RecordError::Damaged(why) if why.contains(name)), "{why}");
    }
    let mut ring = KeyRing::default();
    ring.add(Person::new("Ada", key("Ada"))).expect("a name");
    let keys = ring.to_json(false).replace("\"name\": \"Ada\"", "\"name\": \"Eve\", \"name\": \"Ada\"");
    let why = KeyRing::from_json(&keys).expect_err("two names");
    assert!(matches!(&why, KeyError::Damaged(why) if why.contains("`name`")), "{why}");
    let rules = "{\"format\": \"enroute-rules/1\", \"slope_deg\": 1, \"slope_deg\": 90}";
    let why = FlightRules::from_json(rules).expect_err("two slopes");
    assert!(why.contains("`slope_deg`"), "{why}");
}

/// Who reads what has changed since the last approval would read an invented text.
#[test]
fn an_approval_of_another_text_than_its_content_hash_names_does_not_count() {
    let invented = |board: &mut Board, change: &dyn Fn(&mut Subject)| {
        let plan = Value::Null;
        let mut subject = Subject::new(&board.review, &board.source, Goal::Default, 0, plan, None);
        change(&mut subject);
        let who = board.who("Ada");
        board.record.approve(who, subject, String::new(), Vec::new(), &key("Ada"));
        last_check(&board.record).1
    };
    let text = |subject: &mut Subject| subject.source.push_str(" // harmless");
    let map = |subject: &mut Subject| {
        let asset = "flat".into();
        subject.map = Some(snapshot::MapKey { asset, cell_mm: 1000, origin_mm: [0, 0], version: None });
    };
    let changes: [&dyn Fn(&mut Subject); 4] =
        [&text, &map, &|it| it.seed = 1, &|it| it.goal = Goal::Scenario("Other".into())];
    for change in changes {
        let mut board = Board::new(LASTING);
        board.approve("Grace");
        let problem = invented(&mut board, change);
        assert!(problem.contains("not the one of its content hash"), "{problem}");
        assert_eq!(board.seats(), "Reviewer 1 of 2");
        let (last, _) = board.record.last_approval().expect("that of Grace");
        assert_eq!(last.by, "Grace");
    }
    // Histories of earlier versions have no map: an invented text shows once the text of the content is known.
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.say("Chair", Act::Rules { rules: board.review.rules.clone() });
    board.approve("Grace");
    assert_eq!(invented(&mut board, &text), "");
    let (hash, source) = (board.review.content_hash.clone(), board.source.clone());
    board.record.learn_source(&hash, &source);
    assert!(last_check(&board.record).1.contains("not the one of its content hash"));
    assert_eq!(board.seats(), "Reviewer 1 of 2");
}
