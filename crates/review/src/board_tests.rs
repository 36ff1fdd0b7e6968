//! How a plan stands with its board: every transition of its status.

use snapshot::Goal;

use super::board::{PlanStatus, Present, standing};
use super::record::{Act, LineKey, Record, Subject, Who, seen_lines};
use super::record_tests::{judged, key};
use super::seat::Seat;
use super::tests::{LASTING, SCENARIO, reviewed, snapshot};
use super::{FlightRules, Review, Section, Status, since};

fn who(by: &str, role: &str, review: &Review, time: &str) -> Who {
    Who {
        by: by.to_owned(),
        role: role.to_owned(),
        time: format!("2026-01-01T00:00:{time}Z"),
        content_hash: review.content_hash.clone(),
        plan_hash: review.plan_hash.clone(),
    }
}

/// A board of two in Science and one in Mobility.
fn rules() -> FlightRules {
    let seat = |role: &str, approvals| Seat::new(role, approvals);
    FlightRules { board: vec![seat("Science", 2), seat("Mobility", 1)], ..FlightRules::default() }
}

/// What the board looks at: a mission of which nothing has failed.
struct Table {
    review: Review,
    source: &'static str,
    record: Record,
}

impl Table {
    fn new(source: &'static str, rules: &FlightRules) -> Self {
        let mut review = reviewed(source);
        review.judge(rules, None);
        let mut record = judged(Record::default());
        record.add(who("Chair", "", &review, "00"), Act::Rules { rules: rules.clone() }, &key("Chair"));
        Self { review, source, record }
    }

    fn status(&self) -> PlanStatus {
        self.standing(|standing| standing.status)
    }

    fn standing<T>(&self, of: impl FnOnce(&super::Standing<'_>) -> T) -> T {
        of(&standing(&self.record, &Present::of_review(&self.review)))
    }

    fn blockers(&self) -> Vec<String> {
        standing(&self.record, &Present::of_review(&self.review)).blockers()
    }

    fn seats(&self) -> String {
        standing(&self.record, &Present::of_review(&self.review)).seats_in_words()
    }

    fn approve(&mut self, by: &str, role: &str, time: &str, text: &str) {
        self.may_approve(by, role).expect("nothing stands in the way");
        let plan = serde_json::Value::Null;
        let subject = Subject::new(&self.review, self.source, Goal::Default, 0, plan, None);
        let relied_on = self.standing(|standing| standing.relied_on.clone());
        let who = who(by, role, &self.review, time);
        self.record.approve(who, subject, text.to_owned(), relied_on, &key(by));
    }

    fn may_approve(&self, by: &str, role: &str) -> Result<(), String> {
        self.standing(|standing| standing.may_approve(&key(by).public(), role))
    }

    fn say(&mut self, by: &str, time: &str, act: Act) -> String {
        self.record.add(who(by, "Science", &self.review, time), act, &key(by));
        self.record.entries().last().expect("it was added").digest().to_owned()
    }
}

fn comment() -> Act {
    Act::Comment { about: None, to: Some(key("Grace").public()), text: "Why so late?".to_owned() }
}

#[test]
fn a_plan_is_approved_once_everybody_has_approved_who_has_to() {
    let mut table = Table::new(LASTING, &rules());
    assert_eq!(table.status(), PlanStatus::Draft, "rules are not about this plan");
    table.approve("Ada", "Science", "01", "");
    assert_eq!(table.status(), PlanStatus::InReview);
    for role in ["Science", "Mobility"] {
        let again = table.may_approve("Ada", role);
        assert!(again.is_err_and(|why| why.contains("already")), "a key counts once, in {role} too");
    }
    let elsewhere = table.may_approve("Grace", "Press");
    assert!(elsewhere.is_err_and(|why| why.contains("no role \"Press\"")));
    table.approve("Grace", "Mobility", "02", "");
    assert_eq!(table.seats(), "Science 1 of 2, Mobility 1 of 1");
    assert_eq!(table.status(), PlanStatus::InReview);
    table.approve("Katherine", "Science", "03", "");
    assert_eq!(table.status(), PlanStatus::Approved);
    assert!(table.blockers().is_empty());
}

#[test]
fn words_that_go_with_an_approval_are_part_of_its_status() {
    let mut table = Table::new(LASTING, &FlightRules::default());
    table.approve("Ada", "Reviewer", "01", "Only with a full battery.");
    assert_eq!(table.status(), PlanStatus::ApprovedWithComments);
    assert!(table.status().is_approved());
}

#[test]
fn open_comments_stand_in_the_way_until_they_are_resolved() {
    let mut table = Table::new(LASTING, &FlightRules::default());
    let asked = table.say("Ada", "01", comment());
    assert_eq!(table.status(), PlanStatus::InReview);
    let refused = table.may_approve("Ada", "Reviewer");
    assert_eq!(refused, Err("1 comment is open".to_owned()));
    table.say("Grace", "02", Act::Resolve { of: asked.clone(), text: "It waits for light.".to_owned() });
    table.approve("Ada", "Reviewer", "03", "");
    assert_eq!(table.status(), PlanStatus::Approved);
    table.say("Grace", "04", Act::Reopen { of: asked.clone(), text: String::new() });
    assert_eq!(table.status(), PlanStatus::InReview, "an approval does not count past an open comment");
    table.say("Ada", "05", Act::Withdraw { of: asked, text: "A slip.".to_owned() });
    assert_eq!(table.status(), PlanStatus::Approved);
}

#[test]
fn each_item_that_needs_attention_is_acknowledged_as_it_is() {
    let mut table = Table::new(SCENARIO, &FlightRules::default());
    let lines: Vec<(Section, LineKey)> = table.standing(|standing| {
        standing
            .unacknowledged
            .iter()
            .map(|(section, line)| (*section, LineKey::new(*section, line)))
            .collect()
    });
    assert_eq!(lines.len(), table.review.count(Status::Attention));
    assert!(!lines.is_empty());
    let mut last = String::new();
    for (index, (_, line)) in lines.iter().enumerate() {
        let left = lines.len() - index;
        let blockers = table.blockers().join(", ");
        assert!(blockers.starts_with(&format!("{left} item")), "{blockers}");
        last =
            table.say("Ada", "01", Act::Acknowledge { line: line.clone(), text: "As planned.".to_owned() });
    }
    table.approve("Ada", "Reviewer", "02", "");
    assert_eq!(table.status(), PlanStatus::Approved);
    table.say("Ada", "03", Act::Withdraw { of: last, text: String::new() });
    assert_eq!(table.status(), PlanStatus::InReview);
    // Under another rule it is another line.
    let (section, line) = table.standing(|it| (it.unacknowledged[0].0, it.unacknowledged[0].1.clone()));
    let again = Act::Acknowledge { line: LineKey::new(section, &line), text: "As planned.".to_owned() };
    table.say("Ada", "04", again);
    assert_eq!(table.status(), PlanStatus::Lapsed, "the approval was of another acknowledgment");
    table.approve("Ada", "Reviewer", "05", "");
    assert_eq!(table.status(), PlanStatus::Approved);
    let margin = exact::Time::from(3);
    table.review.judge(&FlightRules { margin: Some(margin), ..FlightRules::default() }, None);
    assert!(table.standing(|it| it.unacknowledged.len()) > 0);
    assert!(!table.status().is_approved());
}

#[test]
fn an_approval_lapses_with_the_text_the_plan_or_the_rules_and_counts_again_after_undo() {
    let mut table = Table::new(LASTING, &FlightRules::default());
    table.approve("Ada", "Reviewer", "01", "");
    let approved = table.review.clone();
    let lapsed = |table: &Table| {
        assert_eq!(table.status(), PlanStatus::Lapsed);
        table.standing(|it| it.lapsed.map(|(entry, why)| (entry.by.clone(), why))).expect("an approval")
    };
    table.review.content_hash.push('0');
    assert_eq!(lapsed(&table), ("Ada".to_owned(), "the text, map, goal or seed has changed"));
    table.review = Review { plan_hash: "0".to_owned(), ..approved.clone() };
    assert_eq!(lapsed(&table), ("Ada".to_owned(), "the plan has changed"));
    table.review = approved.clone();
    table.review.judge(&rules(), None);
    assert_eq!(lapsed(&table), ("Ada".to_owned(), "the flight rules have changed"));
    table.review = approved;
    assert_eq!(table.status(), PlanStatus::Approved);
    // What was never complete does not lapse.
    let mut half = Table::new(LASTING, &rules());
    half.approve("Ada", "Science", "01", "");
    half.review.content_hash.push('0');
    assert_eq!(half.status(), PlanStatus::InReview);
    // An approval of the new content is the work of the board again.
    table.review.content_hash.push('0');
    let act = Act::Rules { rules: rules() };
    table.record.add(who("Chair", "", &table.review, "02"), act, &key("Chair"));
    table.review.judge(&rules(), None);
    table.approve("Ada", "Science", "03", "");
    assert_eq!(table.status(), PlanStatus::InReview);
}

#[test]
fn what_is_taken_back_does_not_count_and_does_not_lapse() {
    let mut table = Table::new(LASTING, &FlightRules::default());
    table.approve("Ada", "Reviewer", "01", "");
    let approval = table.record.entries().last().expect("an approval").digest().to_owned();
    table.say("Ada", "02", Act::Withdraw { of: approval.clone(), text: "Not read.".to_owned() });
    assert_eq!(table.status(), PlanStatus::InReview);
    assert!(table.record.last_approval().is_none());
    assert_eq!(table.record.withdrawn()[approval.as_str()].by, "Ada", "who took it back is there");
    table.review.content_hash.push('0');
    assert_eq!(table.status(), PlanStatus::InReview, "nothing approved has lapsed");
    table.review.content_hash.pop();
    table.approve("Ada", "Reviewer", "03", "");
    assert_eq!(table.status(), PlanStatus::Approved);
}

#[test]
fn what_has_failed_or_has_no_plan_is_not_approved() {
    let table = Table::new("scenario S[0,5] = { delay[8,9] }", &FlightRules::default());
    let why = table.may_approve("Ada", "Reviewer").expect_err("there is no plan");
    assert!(why.contains("there is no plan") && why.contains("failed"), "{why}");
    let record = Record::default();
    let fine = Table::new(LASTING, &FlightRules::default());
    let unreviewed = Present { review: None, ..Present::of_review(&fine.review) };
    assert!(standing(&record, &unreviewed).may_approve(&key("Ada").public(), "Reviewer").is_err());
}

#[test]
fn a_board_has_roles_with_names_of_their_own() {
    let board = |seats: &[(&str, u32)]| {
        let seats = seats.iter().map(|(role, approvals)| Seat::new(role, *approvals));
        FlightRules { board: seats.collect(), ..FlightRules::default() }
    };
    assert_eq!(rules().problem(), None);
    for wrong in [&[][..], &[("", 1)], &[("A", 0)], &[("A", 10)], &[("A", 1), ("A", 1)], &[("A", 1); 13]] {
        assert!(board(wrong).problem().is_some(), "{wrong:?}");
    }
    let document = rules().to_json();
    assert_eq!(FlightRules::from_json(&document), Ok(rules()));
    assert!(rules().in_words("min").contains(&"required approvals: 2 Science, 1 Mobility".to_owned()));
}

#[test]
fn what_differs_since_an_approval_is_told_by_name() {
    let before = snapshot(SCENARIO);
    let after = snapshot(&SCENARIO.replace("PATH1=OK [450,450]", "PATH1=OK [460,460]"));
    let (was, is) = (reviewed(SCENARIO), reviewed(&after.source));
    let (network, plan) = (before.network.as_deref().expect("a network"), before.plan().expect("a plan"));
    let plan = tpn::plan_json::plan_to_json(network, plan);
    let subject = Subject::new(&was, SCENARIO, Goal::Default, 0, plan, None);
    assert!(since(&subject, &before, &was, None).is_nothing());
    let since = since(&subject, &after, &is, None);
    let [place] = since.text.as_slice() else { panic!("one place: {:?}", since.text) };
    assert!(place.removed[0].contains("[450,450]") && place.added[0].contains("[460,460]"));
    assert!(SCENARIO.lines().nth(place.before_line - 1).is_some_and(|line| *line == place.removed[0]));
    let moved: Vec<String> = since
        .plan
        .expect("it was kept")
        .differences
        .iter()
        .map(crate::compare::Difference::sentence)
        .collect();
    assert!(moved.iter().any(|it| it.starts_with("condition Tell(PATH1=OK)#1 moved: ")), "{moved:?}");
    let link = since.lines.iter().find(|it| it.section() == Some(Section::CausalLinks)).expect("its margin");
    assert!(link.before.is_some() && link.after.is_some(), "{link:?}");
    assert!(link.sentence().contains(" → "), "{}", link.sentence());
    assert!(seen_lines(&was).iter().all(|line| line.section != Section::Events));
}
