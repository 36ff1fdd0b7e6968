//! Boards that someone weakens, and flight rules that go away and come back.

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
