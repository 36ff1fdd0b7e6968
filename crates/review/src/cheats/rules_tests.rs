//! Boards that someone weakens, and flight rules that go away and come back.

use std::collections::BTreeSet;

use super::*;

/// Two people set flight rules at the same time, and each history has both.
#[test]
fn the_order_of_a_document_s_entries_does_not_choose_the_flight_rules() {
    let mut board = Board::new(LASTING);
    let mut other = board.record.clone();
    let strict = FlightRules { board: vec![Seat::new("Reviewer", 3)], ..board.record.rules().clone() };
    let lax = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..strict.clone() };
    board.say("Ada", Act::Rules { rules: lax });
    let who = board.who("Grace");
    other.add(who, Act::Rules { rules: strict.clone() }, &key("Grace"));
    board.record.merge(other);
    assert_eq!((board.record.heads().count(), board.record.rules()), (2, &strict));
    let swapped = board.read(|it| it["entries"].as_array_mut().expect("a list").swap(1, 2));
    let swapped = swapped.expect("each entry follows the first one");
    assert_eq!(swapped.rules(), &strict);
    assert_eq!(swapped, board.record);
}

#[test]
fn rules_that_change_between_two_approvals_leave_one_approval() {
    let mut board = Board::new(LASTING);
    let rules = board.record.rules().clone();
    board.approve("Ada");
    let flat = FlightRules { slope_deg: Some(1.0), ..rules.clone() };
    board.say("Chair", Act::Rules { rules: flat.clone() });
    board.review.judge(&flat, None);
    board.approve("Grace");
    assert_eq!((board.seats(), board.status()), ("Reviewer 1 of 2".to_owned(), PlanStatus::InReview));
    // With the former rules again, neither counts: the rules have changed since each of them.
    board.say("Chair", Act::Rules { rules: rules.clone() });
    board.review.judge(&rules, None);
    assert_eq!((board.seats(), board.status()), ("Reviewer 0 of 2".to_owned(), PlanStatus::InReview));
}

#[test]
fn approvals_do_not_count_again_once_the_rules_went_away_and_came_back() {
    let mut board = approved();
    let rules = board.record.rules().clone();
    let three = FlightRules { board: vec![Seat::new("Reviewer", 3)], ..rules.clone() };
    board.say("Chair", Act::Rules { rules: three.clone() });
    assert_eq!((board.status(), board.record.rules()), (PlanStatus::Lapsed, &three));
    // One person does not reset them, and neither do two of three.
    for by in ["Ada", "Ada", "Grace"] {
        board.say(by, Act::Rules { rules: rules.clone() });
        assert_eq!((board.status(), board.record.rules()), (PlanStatus::Lapsed, &three), "{by}");
    }
    board.say("Chair", Act::Rules { rules: rules.clone() });
    assert_eq!((board.record.rules(), board.status()), (&rules, PlanStatus::Lapsed));
    let standing = standing(&board.record, &Present::of_review(&board.review));
    let why = standing.lapsed.map(|(_, why)| why);
    assert_eq!(why, Some("the flight rules were changed and set again"));
    board.approve("Ada");
    assert_eq!(board.status(), PlanStatus::InReview);
    board.approve("Grace");
    assert_eq!(board.status(), PlanStatus::Approved);
}

#[test]
fn nobody_weakens_the_board_alone() {
    let safety = Seat { people: vec![key("Grace").public()], ..Seat::new("Safety", 1) };
    let two = || Seat::new("Reviewer", 2);
    for (before, after, others) in [
        // Fewer approvals, a role that no longer names people, a role less, another role.
        (vec![two()], vec![Seat::new("Reviewer", 1)], &["Grace"][..]),
        (vec![safety.clone()], vec![Seat::new("Safety", 1)], &["Grace"]),
        (vec![two(), safety.clone()], vec![two()], &["Chair", "Grace"]),
        (vec![safety], vec![Seat::new("Press", 1)], &["Grace"]),
    ] {
        let mut board = Board::new(LASTING);
        let of = |seats: &[Seat]| FlightRules { board: seats.to_vec(), ..FlightRules::default() };
        for by in ["Chair", "Grace"] {
            board.say(by, Act::Rules { rules: of(&before) });
        }
        assert_eq!(board.record.rules().board, before);
        let role = after[0].role.clone();
        let asked = board.say("Ada", Act::Rules { rules: of(&after) });
        assert_eq!(board.record.rules().board, before, "{after:?}");
        let mut review = board.review.clone();
        review.judge(&of(&after), None);
        let subject = Subject::new(&review, &board.source, Goal::Default, 0, Value::Null, None);
        let who = Who { role, ..board.who("Ada") };
        board.record.approve(who, subject, String::new(), Vec::new(), &key("Ada"));
        assert!(!board.status().is_approved(), "{after:?}");
        assert!(!board.status_under(&of(&after)).is_approved(), "{after:?}");
        // It is told what the change waits for, and the rest of the board agrees.
        let entry = board.record.entry(&asked).expect("it is there");
        let note = board.record.without_effect(entry).expect("it has none");
        assert!(note.contains("of the board in force"), "{note}");
        for (index, by) in others.iter().enumerate() {
            assert_eq!(board.record.proposals().len(), 1);
            assert_eq!(board.record.proposals()[0].by.len(), index + 1);
            board.say(by, Act::Rules { rules: of(&after) });
        }
        assert_eq!((&board.record.rules().board, board.record.proposals().len()), (&after, 0));
        let names: Vec<&str> = board.record.board_by().iter().map(|entry| entry.by.as_str()).collect();
        assert_eq!((names[0], names.len()), ("Ada", others.len() + 1));
        assert!(!board.status().is_approved(), "Ada approved before the board agreed");
    }
}

#[test]
fn who_agreed_to_leave_other_rules_did_not_agree_to_leave_these() {
    let mut board = Board::new(LASTING);
    let rules = board.record.rules().clone();
    let of = |count: u32| FlightRules { board: vec![Seat::new("Reviewer", count)], ..rules.clone() };
    board.say("Grace", Act::Rules { rules: of(1) });
    board.say("Chair", Act::Rules { rules: of(3) });
    let grace = board.record.entries()[1].clone();
    assert_eq!(
        board.record.without_effect(&grace).as_deref(),
        Some("weakened the board, which did not agree")
    );
    for by in ["Ada", "Chair"] {
        board.say(by, Act::Rules { rules: of(1) });
    }
    assert_eq!(board.record.rules(), &of(3), "two of three, and Grace agreed to leave two approvals");
    // An entry that was made apart, and names the former rules, agrees to nothing either.
    let said = Said { rules: of(2).digest(), act: Act::Rules { rules: of(1) }, ..board.said("Grace") };
    let said = Said { former: board.record.heads().map(str::to_owned).collect(), ..said };
    let apart = with_entry(&board.record, &Entry::signed(said, &key("Grace")));
    assert_eq!(apart.rules(), &of(3));
    board.say("Grace", Act::Rules { rules: of(1) });
    assert_eq!(board.record.rules(), &of(1));
}

/// Everyone chooses the date of an entry, and what it follows.
#[test]
fn rules_that_are_dated_back_do_not_take_a_board() {
    let of = |seat: Seat| FlightRules { board: vec![seat], ..FlightRules::default() };
    let of_ada = || Seat { people: vec![key("Ada").public()], ..Seat::new("Reviewer", 1) };
    for rules_before in [false, true] {
        let mut board = Board::new(LASTING);
        if rules_before {
            for by in ["Chair", "Grace"] {
                board.say(by, Act::Rules { rules: of(Seat::new("Reviewer", 1)) });
            }
        } else {
            // The first entry is a comment, and no one has set rules.
            let record = judged(Record::new("enroute"));
            board.record = record;
            board.record.seed([7; 32]);
            let comment =
                board.say("Grace", Act::Comment { about: None, to: None, text: "Long.".to_owned() });
            board.say("Grace", Act::Resolve { of: comment, text: "It is meant so.".to_owned() });
        }
        let former: Vec<String> = board.record.heads().map(str::to_owned).collect();
        let agreed = board.record.rules().digest();
        let early = board.said("Ada");
        board.say("Chair", Act::Rules { rules: of(Seat::new("Reviewer", 2)) });
        assert_eq!(board.record.rules(), &of(Seat::new("Reviewer", 2)));
        let said = Said { former, rules: agreed, act: Act::Rules { rules: of(of_ada()) }, ..early };
        board.record = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
        let names: BTreeSet<&str> =
            board.record.conflicting_rules().iter().map(|entry| entry.by.as_str()).collect();
        assert_eq!(names, BTreeSet::from(["Ada", "Chair"]), "{rules_before}");
        // Neither Ada alone nor both complete a board, under either rules.
        for by in ["Ada", "Grace"] {
            board.approve(by);
            assert!(!board.status().is_approved(), "{by}");
            assert!(!board.status_under(&of(of_ada())).is_approved(), "{by}");
            assert!(!board.status_under(&of(Seat::new("Reviewer", 2))).is_approved(), "{by}");
        }
        // What one of the boards sets after that ends nothing.
        for (by, rules) in [
            ("Ada", of(Seat::new("Reviewer", 1))),
            ("Ada", of(of_ada())),
            ("Chair", of(Seat::new("Reviewer", 2))),
            ("Grace", of(Seat::new("Reviewer", 2))),
        ] {
            board.say(by, Act::Rules { rules });
            let rules = board.record.rules().clone();
            board.review.judge(&rules, None);
            for by in ["Ada", "Grace", "Chair"] {
                board.approve(by);
            }
            assert!(!board.status().is_approved(), "{by}");
        }
        // Ada, who alone completes her board, agrees to that of the others.
        board.say("Ada", Act::Rules { rules: of(Seat::new("Reviewer", 2)) });
        assert!(board.record.conflicting_rules().is_empty());
        assert_eq!(board.record.rules(), &of(Seat::new("Reviewer", 2)));
        board.review.judge(&of(Seat::new("Reviewer", 2)), None);
        assert!(!board.status().is_approved(), "the approvals before do not count");
        for by in ["Ada", "Grace"] {
            board.approve(by);
        }
        assert!(board.status().is_approved());
    }
}

/// Many entries that conflict are no way around that.
#[test]
fn many_backdated_rules_do_not_take_a_board() {
    let of = |seat: Seat| FlightRules { board: vec![seat], ..FlightRules::default() };
    let of_ada = |role: &str| Seat { people: vec![key("Ada").public()], ..Seat::new(role, 1) };
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.record.seed([7; 32]);
    board.say("Grace", Act::Comment { about: None, to: None, text: "Long.".to_owned() });
    let former: Vec<String> = board.record.heads().map(str::to_owned).collect();
    let comment = former[0].clone();
    let early: Vec<Said> = (0..9).map(|_| board.said("Ada")).collect();
    board.say("Grace", Act::Resolve { of: comment, text: "It is meant so.".to_owned() });
    board.say("Chair", Act::Rules { rules: of(Seat::new("Reviewer", 2)) });
    let usual = FlightRules::default().digest();
    for (number, early) in early.into_iter().enumerate() {
        let act = Act::Rules { rules: of(of_ada(&format!("Role {number}"))) };
        let said = Said { former: former.clone(), rules: usual.clone(), act, ..early };
        board.record = with_entry(&board.record, &Entry::signed(said, &key("Ada")));
    }
    board.say("Ada", Act::Rules { rules: of(of_ada("Reviewer")) });
    let rules = board.record.rules().clone();
    board.review.judge(&rules, None);
    board.approve("Ada");
    assert!(!board.status().is_approved());
    assert!(!board.status_under(&of(of_ada("Reviewer"))).is_approved());
}

#[test]
fn of_two_boards_that_were_set_apart_the_stricter_one_is_in_force() {
    for is_strict_first in [false, true] {
        let mut board = Board::new(LASTING);
        let of =
            |count: u32| FlightRules { board: vec![Seat::new("Reviewer", count)], ..FlightRules::default() };
        let mut other = board.record.clone();
        let counts = if is_strict_first { [4, 3] } else { [3, 4] };
        board.say("Ada", Act::Rules { rules: of(counts[0]) });
        let who = board.who("Grace");
        other.add(who, Act::Rules { rules: of(counts[1]) }, &key("Grace"));
        board.record.merge(other);
        assert_eq!(board.record.rules(), &of(4), "{is_strict_first}");
        assert!(board.record.conflicting_rules().is_empty());
    }
}

#[test]
fn rules_that_only_unknown_keys_have_set_block_an_approval() {
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.record.seed([7; 32]);
    let two = FlightRules { board: vec![Seat::new("Reviewer", 2)], ..FlightRules::default() };
    board.say("Ada", Act::Comment { about: None, to: None, text: "Fine.".to_owned() });
    let comment = board.record.entries()[0].digest().to_owned();
    board.say("Ada", Act::Resolve { of: comment, text: "Done.".to_owned() });
    board.say_with("Eve", Act::Rules { rules: two }, &key("Eve"));
    board.review.judge(&FlightRules::default(), None);
    board.approve("Ada");
    let standing = standing(&board.record, &Present::of_review(&board.review));
    assert!(!standing.status.is_approved());
    let told = standing.blockers().join(", ");
    assert!(told.contains("Eve, whose key is unknown, has set flight rules"), "{told}");
}

/// Otherwise, a reader who lacks the key of the right person would see a weaker board.
#[test]
fn rules_with_an_unknown_key_wait_for_someone_who_has_seen_them() {
    let mut board = approved();
    let rules = board.record.rules().clone();
    let apart = board.record.clone();
    let three = FlightRules { board: vec![Seat::new("Reviewer", 3)], ..rules.clone() };
    board.say_with("Eve", Act::Rules { rules: three }, &key("Eve"));
    assert_eq!((board.record.rules(), board.status()), (&rules, PlanStatus::InReview));
    // An entry of someone who has not seen them confirms nothing.
    let mut apart = apart;
    let who = board.who("Grace");
    apart.add(who, Act::Rules { rules: rules.clone() }, &key("Grace"));
    board.record.merge(apart);
    assert!(board.record.unknown_rules().is_some_and(|entry| entry.by == "Eve"));
    // A weaker board settles them for its signer only.
    board.say("Chair", Act::Rules { rules: rules.clone() });
    assert!(board.record.unknown_rules().is_some());
    let mut ring = KeyRing::default();
    for name in ["Ada", "Grace", "Chair"] {
        let secret = (name == "Chair").then(|| key(name));
        ring.add(Person { secret, ..Person::new(name, key(name)) }).expect("a name");
    }
    let mut of_chair = board.record.clone();
    of_chair.judge(&ring.trust(), NOW);
    assert_eq!((of_chair.rules(), board.status_of(&of_chair)), (&rules, PlanStatus::Approved));
    // Rules that are at least as strict settle them for everyone, and so does a reader who requires the rules in force.
    let mut required = board.record.clone();
    required.confirm_rules();
    assert_eq!(board.status_of(&required), PlanStatus::Approved);
    let four = FlightRules { board: vec![Seat::new("Reviewer", 4)], ..rules };
    board.say("Grace", Act::Rules { rules: four });
    assert!(board.record.unknown_rules().is_none());
}

#[test]
fn agreeing_to_rules_twice_is_one_consent() {
    let mut board = Board::new(LASTING);
    let rules = board.record.rules().clone();
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..rules.clone() };
    let first = board.say("Ada", Act::Rules { rules: one.clone() });
    let again = board.say("Ada", Act::Rules { rules: one.clone() });
    // The same rules as in force, set again, end no proposal.
    board.say("Chair", Act::Rules { rules: rules.clone() });
    for digest in [&first, &again] {
        let entry = board.record.entry(digest).expect("it is there");
        let note = board.record.without_effect(entry);
        assert_eq!(note.as_deref(), Some("weakens the board, with 1 of 2 approvals of the board in force"));
    }
    board.say("Grace", Act::Rules { rules: one.clone() });
    assert_eq!(board.record.rules(), &one);
    for digest in [&first, &again] {
        let entry = board.record.entry(digest).expect("it is there");
        assert_eq!(board.record.without_effect(entry), None);
    }
}

#[test]
fn a_board_that_was_never_in_force_completes_nothing() {
    let mut board = Board::new(LASTING);
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..board.record.rules().clone() };
    board.say("Ada", Act::Rules { rules: one.clone() });
    let mut review = board.review.clone();
    review.judge(&one, None);
    let subject = Subject::new(&review, &board.source, Goal::Default, 0, Value::Null, None);
    let who = board.who("Ada");
    board.record.approve(who, subject, String::new(), Vec::new(), &key("Ada"));
    assert_eq!(board.status(), PlanStatus::InReview, "not lapsed");
}

#[test]
fn whoever_approves_first_does_not_hide_what_changed() {
    let mut board = approved();
    let complete = board.review.content_hash.clone();
    board.source = format!("{} ", board.source);
    board.review = reviewed(&board.source);
    let rules = board.record.rules().clone();
    board.review.judge(&rules, None);
    assert_ne!(board.review.content_hash, complete);
    board.approve("Ada");
    let (last, _) = board.record.last_approval().expect("an approval");
    assert_eq!(last.content_hash, complete, "the board has not approved what Ada has");
    board.approve("Grace");
    let (last, _) = board.record.last_approval().expect("an approval");
    assert_eq!(last.content_hash, board.review.content_hash);
}

#[test]
fn a_reason_has_letters_or_digits() {
    let mut board = Board::new(LASTING);
    let comment = board.say("Ada", Act::Comment { about: None, to: None, text: "Why?".to_owned() });
    for (text, counts) in [(" ", false), ("…", false), (".-!", false), ("FR 7", true)] {
        board.say("Ada", Act::Resolve { of: comment.clone(), text: text.to_owned() });
        let (_, problem) = last_check(&board.record);
        assert_eq!(problem.is_empty(), counts, "{text:?}: {problem}");
    }
}
