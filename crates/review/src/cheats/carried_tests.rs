//! What was accepted, approved or seen once, used for something else.

use super::super::record::USUAL_RULES;
use super::*;

fn open(board: &Board) -> Vec<LineKey> {
    let present = Present::of_review(&board.review);
    let standing = standing(&board.record, &present);
    standing.unacknowledged.iter().map(|(section, line)| LineKey::new(*section, line)).collect()
}

/// The same history beside another mission.
fn beside(board: &Board, source: &str, review: Review) -> Board {
    Board { review, source: source.to_owned(), record: board.record.clone(), minute: board.minute }
}

#[test]
fn a_waiver_of_a_rule_does_not_cover_an_activity_elsewhere() {
    let of = |scenario: &str| {
        let head = "var P : {OK, GONE}; primitive A()[5,5]; primitive B()[5,5]; primitive C()[5,6];";
        format!("{head} scenario S[0,100] = {{ {scenario}, P=OK [15,15] }}")
    };
    let one = of("{ delay[5,5]; A(); B() }");
    let mut board = Board::new(&one);
    let rule = MissionRule {
        name: "Open".to_owned(),
        rule: "never A while P=OK".to_owned(),
        source: "FR 7".to_owned(),
        waivable: true,
    };
    let rules = FlightRules { rules: vec![rule], ..board.record.rules().clone() };
    board.say("Chair", Act::Rules { rules: rules.clone() });
    let review_of = |source: &str| {
        let mut review = reviewed(source);
        review.hold_against(&snapshot(source), &rules, None, &mut || false);
        review
    };
    board.review = review_of(&one);
    for line in open(&board) {
        let (text, until) = ("A is short here.".to_owned(), "2026-03-01".to_owned());
        board.say("Ada", Act::Waive { line, text, until });
    }
    assert!(open(&board).is_empty());
    let text = |review: &Review| review.lines(Section::MissionRules)[0].text.clone();
    for (scenario, is_open) in [
        ("{ B(); A(); delay[5,5] }", true),
        ("{ B(); A(); delay[5,5] }, { B(); A(); B() }", true),
        ("{ delay[5,5]; A(); B() }, { B(); B() }", false),
    ] {
        let source = of(scenario);
        let later = beside(&board, &source, review_of(&source));
        assert_eq!(text(&later.review), text(&board.review), "the words are the same");
        let rules = open(&later).into_iter().filter(|line| line.section == Section::MissionRules);
        assert_eq!(rules.count() > 0, is_open, "{scenario}");
    }
}

#[test]
fn an_acknowledged_success_rate_is_of_one_content_and_one_set_of_distributions() {
    let found = |longest: i64| {
        let durations = json!({ "A": { "uniform": [5, longest] } });
        let uncertainty = Uncertainty {
            durations: serde_json::from_value(durations).expect("distributions"),
            ..Uncertainty::default()
        };
        let settings = RobustnessSettings { runs: 100, seed: 1, uncertainty };
        Robustness { settings, tally: Tally { runs: 100, succeeded: 90, ..Tally::default() } }
    };
    let source = "primitive A()[5,9]; scenario S[0,90] = { A() }";
    let mut board = Board::new(source);
    let rules = board.record.rules().clone();
    board.review.judge(&rules, Some(&found(9)));
    for line in open(&board) {
        board.say("Ada", Act::Acknowledge { line, text: "Nine of ten suffice.".to_owned() });
    }
    assert!(open(&board).is_empty());
    let other = source.replace("[5,9]", "[5,30]");
    for (source, longest) in [(other.as_str(), 9), (source, 50)] {
        let mut review = reviewed(source);
        review.judge(&rules, Some(&found(longest)));
        let later = beside(&board, source, review);
        assert!(open(&later).iter().any(|line| line.section == Section::Robustness), "{longest}");
    }
}

#[test]
fn an_approval_of_runs_does_not_count_without_them_or_with_others() {
    let mut board = Board::new(LASTING);
    let found = tallied(99);
    let rules = board.record.rules().clone();
    board.review.judge(&rules, Some(&found));
    for line in open(&board) {
        board.say("Chair", Act::Acknowledge { line, text: "As meant.".to_owned() });
    }
    for by in ["Ada", "Grace"] {
        let subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, Some(&found));
        let relied_on = standing(&board.record, &Present::of_review(&board.review)).relied_on;
        let who = board.who(by);
        board.record.approve(who, subject, String::new(), relied_on, &key(by));
    }
    let status = |board: &Board| standing(&board.record, &Present::of_review(&board.review)).status;
    assert_eq!(status(&board), PlanStatus::Approved);
    let seeded = Robustness {
        settings: RobustnessSettings { seed: 2, ..found.settings.clone() },
        tally: found.tally.clone(),
    };
    for runs in [None, Some(&seeded), Some(&tallied(100))] {
        board.review.judge(&rules, runs);
        let standing = standing(&board.record, &Present::of_review(&board.review));
        assert_eq!(standing.status, PlanStatus::Lapsed);
        assert_eq!(standing.lapsed.map(|(_, why)| why), Some("the Monte Carlo runs have changed"));
    }
    board.review.judge(&rules, Some(&found));
    assert_eq!(status(&board), PlanStatus::Approved);
}

#[test]
fn nothing_is_approved_without_a_review_of_it() {
    let mut board = approved();
    let rules = board.record.rules().clone();
    let present = Present { review: None, ..Present::of_review(&board.review) };
    let found = standing(&board.record, &Present { rules: &rules, ..present });
    assert_eq!(found.status, PlanStatus::InReview);
    assert!(found.blockers().contains(&"the present content has not been reviewed".to_owned()));
    board.review.judge(&rules, None);
    assert_eq!(board.status(), PlanStatus::Approved);
}

/// Grace sets a board of her own before the Chair's, by its date, and approves another text under it.
#[test]
fn who_approves_under_rules_of_the_past_does_not_choose_what_is_compared() {
    let rules = FlightRules { board: vec![Seat::new("Reviewer", 2)], ..FlightRules::default() };
    let mut board = Board::new(LASTING);
    board.record = judged(Record::new("enroute"));
    board.record.seed([3; 32]);
    let first = board.say("Chair", Act::Comment { about: None, to: None, text: "Start.".to_owned() });
    board.say("Chair", Act::Resolve { of: first.clone(), text: "Started.".to_owned() });
    let early = board.said("Grace");
    board.say("Chair", Act::Rules { rules: rules.clone() });
    board.review.judge(&rules, None);
    board.approve("Ada");
    board.approve("Chair");
    assert_eq!(board.status(), PlanStatus::Approved);
    let own = FlightRules { board: vec![Seat::new("Reviewer", 1)], slope_deg: Some(14.0), ..rules };
    let said = Said { former: vec![first], rules: USUAL_RULES.digest(), ..early };
    let set = Entry::signed(Said { act: Act::Rules { rules: own.clone() }, ..said.clone() }, &key("Grace"));
    board.record = with_entry(&board.record, &set);
    let mut other = reviewed(SCENARIO);
    other.judge(&own, None);
    for former in [vec![set.digest().to_owned()], board.record.heads().map(str::to_owned).collect()] {
        let subject = Subject::new(&other, SCENARIO, Goal::Default, 0, Value::Null, None);
        let mut record = board.record.clone();
        let act = Act::Approve { subject: record.keep_subject(subject), text: String::new() };
        let (content_hash, plan_hash) = (other.content_hash.clone(), other.plan_hash.clone());
        let time = if former.len() == 1 { said.time.clone() } else { "2026-01-02T00:00:00Z".to_owned() };
        let approval =
            Said { act, content_hash, plan_hash, former, time, rules: own.digest(), ..said.clone() };
        let record = with_entry(&record, &Entry::signed(approval, &key("Grace")));
        let (last, _) = record.last_approval().expect("an approval");
        assert_eq!(last.content_hash, board.review.content_hash);
    }
}

#[test]
fn who_holds_no_seat_does_not_choose_what_is_compared() {
    let mut board = approved();
    let mut subject = Subject::new(&board.review, &board.source, Goal::Default, 0, Value::Null, None);
    subject.lines.clear();
    for (by, role) in [("Chair", "Nobody"), ("Chair", "Reviewer")] {
        let who = Who { role: role.to_owned(), ..board.who(by) };
        board.record.approve(who, subject.clone(), String::new(), Vec::new(), &key(by));
        if role == "Nobody" {
            let (last, approved) = board.record.last_approval().expect("an approval");
            assert_eq!((last.by.as_str(), approved.lines.is_empty()), ("Grace", false));
        }
    }
}

/// The reader lacks the Chair's key, and Grace, who knows of the Chair's board, sets a weaker one.
#[test]
fn a_left_out_key_does_not_give_a_weaker_board() {
    let mut board = Board::new(LASTING);
    let one = FlightRules { board: vec![Seat::new("Reviewer", 1)], ..FlightRules::default() };
    board.say("Grace", Act::Rules { rules: one.clone() });
    board.review.judge(&one, None);
    board.approve("Grace");
    assert!(!board.status().is_approved());
    board.record.judge(&trust(&["Ada", "Grace"]), NOW);
    assert_eq!(board.record.rules(), &one);
    assert!(board.record.unknown_rules().is_some_and(|entry| entry.by == "Chair"));
    assert!(!board.status().is_approved());
    // On her own machine, Grace decides which keys to trust.
    let mut ring = KeyRing::default();
    ring.add(Person::new("Grace", key("Grace"))).expect("a name");
    board.record.judge(&ring.trust(), NOW);
    assert!(board.record.unknown_rules().is_none());
}
