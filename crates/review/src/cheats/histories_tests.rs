//! Histories that are spliced, and entries that come before what they sign.

use super::*;

/// Another history of the same mission, in which the Chair sets these rules.
fn elsewhere(rules: &FlightRules) -> Board {
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.record.seed([9; 32]);
    board.say("Chair", Act::Rules { rules: rules.clone() });
    board
}

/// The document of a record with more entries at its end, whatever they follow.
fn spliced(record: &Record, entries: &[&Entry]) -> Value {
    let mut document: Value = serde_json::from_str(&record.to_json()).expect("JSON");
    let written = document["entries"].as_array_mut().expect("a list");
    let mut heads: Vec<String> = record.heads().map(str::to_owned).collect();
    for entry in entries {
        written
            .push(json!({ "digest": entry.digest(), "said": entry.raw(), "signature": entry.signature() }));
        heads.retain(|head| !entry.former.contains(head));
        heads.push(entry.digest().to_owned());
    }
    heads.sort();
    document["heads"] = json!(heads);
    document
}

fn read(document: &Value) -> Record {
    judged(Record::from_json(&document.to_string()).expect("it is whole"))
}

fn problems(record: &Record) -> Vec<String> {
    record.checked().map(|(_, check)| check.problem.clone().unwrap_or_default()).collect()
}

#[test]
fn rules_of_another_history_of_the_same_mission_count_for_nothing() {
    let mut board = Board::new(LASTING);
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..board.record.rules().clone() };
    let theirs = elsewhere(&one);
    assert_eq!(theirs.record.rules(), &one);
    let [spliced_in] = theirs.record.entries() else { panic!("one entry") };
    // Ada joins the two, and approves under the rules that were spliced in.
    let mut review = board.review.clone();
    review.judge(&one, None);
    let subject = Subject::new(&review, &board.source, Goal::Default, 0, Value::Null, None);
    let subject = board.record.keep_subject(subject);
    let histories = [board.record.history().to_owned(), theirs.record.history().to_owned()];
    let mut approval = |history: &str| {
        let former = board.record.heads().map(str::to_owned).chain([spliced_in.digest().to_owned()]);
        let said = Said {
            history: history.to_owned(),
            rules: one.digest(),
            former: former.collect(),
            act: Act::Approve { subject: subject.clone(), text: String::new() },
            ..board.said("Ada")
        };
        Entry::signed(said, &key("Ada"))
    };
    let approvals = histories.each_ref().map(|history| approval(history));
    for approval in &approvals {
        let mut document = spliced(&board.record, &[spliced_in, approval]);
        let joined = read(&document);
        assert!(!board.status_of(&joined).is_approved(), "{:?}", problems(&joined));
        let (_, check) = joined.checked().find(|(entry, _)| *entry == spliced_in).expect("it is there");
        assert!(check.problem.as_deref().is_some_and(|why| why.contains("follows no entry")), "{check:?}");
        assert_eq!(joined.rules(), board.record.rules());
        // The file says that it is the other history: the Chair's first board is not in that one, as its reader sees.
        document["history"] = json!(theirs.record.history());
        let other = read(&document);
        assert_eq!(other.history(), theirs.record.history());
        let chairs = other.check_of(board.record.history()).expect("it is there");
        assert!(chairs.problem.as_deref().is_some_and(|why| why.contains("follows no entry")), "{chairs:?}");
        document["history"] = json!("");
        let none = read(&document);
        assert_eq!(none.counted().count(), 0, "{:?}", problems(&none));
        document["history"] = json!("0".repeat(64));
        let missing = Record::from_json(&document.to_string());
        assert!(matches!(missing, Err(RecordError::Broken(why)) if why.contains("first entry")));
    }
    // Merged, the entries of the other history are there and do not count.
    assert!(!board.record.is_same_history(&theirs.record) && !board.record.can_join(&theirs.record));
    board.record.merge(theirs.record.clone());
    assert_eq!((board.record.counted().count(), board.record.rules().board[0].approvals), (1, 2));
    // Who has nothing that counts takes the other history over.
    let mut stranger = Record::new("enroute");
    stranger.seed([3; 32]);
    stranger.add(board.who("Eve"), Act::Comment { about: None, to: None, text: "Hm.".into() }, &key("Eve"));
    let mut stranger = judged(stranger);
    assert!(stranger.can_join(&theirs.record));
    stranger.merge(theirs.record.clone());
    assert_eq!((stranger.history(), stranger.rules()), (theirs.record.history(), &one));
}

#[test]
fn a_history_has_one_first_entry() {
    let mut board = Board::new(LASTING);
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..board.record.rules().clone() };
    for time in ["1999-01-01T00:00:00Z", "2026-01-01T00:30:00Z"] {
        let said =
            Said { time: time.to_owned(), act: Act::Rules { rules: one.clone() }, ..board.said("Ada") };
        let second = Entry::signed(said, &key("Ada"));
        let after = Said { former: vec![second.digest().to_owned()], ..board.said("Ada") };
        let after = Entry::signed(after, &key("Ada"));
        let read = read(&spliced(&board.record, &[&second, &after]));
        let problem = |entry: &Entry| read.check_of(entry.digest()).and_then(|check| check.problem.clone());
        assert!(problem(&second).is_some_and(|why| why.contains("follows no entry")), "{time}");
        assert!(problem(&after).is_some_and(|why| why.contains("does not follow the first")), "{time}");
        assert_eq!((read.rules(), read.counted().count()), (board.record.rules(), 1));
    }
    // The history is signed in each entry.
    board.approve("Ada");
    let [first, second] = board.record.entries() else { panic!("two entries") };
    assert_eq!((first.nonce.len(), first.history.as_str()), (64, ""));
    assert_eq!((second.nonce.as_str(), second.history.as_str()), ("", first.digest()));
    // Another history of the same words at the same time has another first entry.
    let other = elsewhere(board.record.rules());
    assert_ne!(other.record.history(), board.record.history());
}

#[test]
fn a_history_without_an_id_is_one_only_if_it_has_one_first_entry() {
    let unnamed = |minute: u32| {
        let mut board = Board::new(LASTING);
        (board.record, board.minute) = (judged(Record::new("enroute")), minute);
        let rules = FlightRules { board: vec![Seat::new("Reviewer", 2)], ..FlightRules::default() };
        board.say("Chair", Act::Rules { rules });
        board
    };
    let mut board = unnamed(0);
    board.approve("Ada");
    board.approve("Grace");
    let mut read = read(&serde_json::from_str(&board.record.to_json()).expect("JSON"));
    assert_eq!((read.history(), board.status_of(&read)), ("", PlanStatus::Approved));
    // It goes on without an id, also where it is prepared for one.
    read.seed([5; 32]);
    read.add(board.who("Ada"), Act::Comment { about: None, to: None, text: "Fine.".into() }, &key("Ada"));
    assert_eq!(read.counted().count(), 4);
    let other = unnamed(30);
    assert!(!board.record.is_same_history(&other.record));
    // A start of someone whom no one trusts spoils nothing.
    let forged =
        Entry::signed(Said { time: "1999-01-01T00:00:00Z".into(), ..board.said("Eve") }, &key("Eve"));
    assert_eq!(board.status_of(&with_entry(&board.record, &forged)), PlanStatus::Approved);
    board.record.merge(other.record);
    assert_eq!((board.record.counted().count(), board.status()), (0, PlanStatus::Draft));
    assert!(problems(&board.record).iter().all(|why| why.contains("several histories without an id")));
}

#[test]
fn an_entry_does_not_precede_the_rules_that_it_signs() {
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.record.seed([4; 32]);
    let first = board.say("Grace", Act::Comment { about: None, to: None, text: "Hm.".into() });
    let said = board.said("Ada");
    board.say("Chair", Act::Rules { rules: board.review.rules.clone() });
    let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
    let act = Act::Approve { subject: board.record.keep_subject(subject), text: String::new() };
    let rules = board.record.rules().digest();
    let said = Said { former: vec![first], rules, act, ..said };
    let early = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
    let (_, check) = early.checked().nth(1).expect("the approval");
    assert_eq!(check.problem.as_deref(), Some("it comes before the flight rules that it signs"));
}

#[test]
fn an_approval_that_comes_before_its_rules_does_not_count() {
    let mut board = Board::new(LASTING);
    let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
    let rules = board.record.rules().digest();
    let subject = board.record.keep_subject(subject);
    let act = Act::Approve { subject, text: String::new() };
    let time = "1999-01-01T00:00:00Z".to_owned();
    let said = Said { time, rules, act, ..board.said("Ada") };
    let early = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
    let (_, check) = early.checked().next().expect("the approval");
    assert!(check.problem.is_some(), "{check:?}");
    assert_eq!(board.status_of(&early), PlanStatus::Draft);
}
