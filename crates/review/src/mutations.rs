//! For each kind of line of the checklist the change of a mission, of its plan or of the rules that turns it red.

use std::sync::Arc;

use exact::{Rational, Time};
use snapshot::robustness::Others;
use snapshot::{Goal, Planning, Robustness, RobustnessSettings, Tally, Uncertainty};
use snapshot::{SeparationViolation, Snapshot};

use super::tests::{LASTING, MISSION, SCENARIO, refused, reviewed, reviewed_with, snapshot};
use super::{FlightRules, Line, MissionRule, Review, Section, Status, SuccessRate, review};

/// A condition that outlasts what needs it by 5 to 10.
const OPEN: &str = "var P : {OK, GONE};
primitive A()[5,10];
scenario S[0,100] = { { delay[5,5]; do { A() } maintaining P=OK }, P=OK [20,20] }";

/// The first line of a section that says this.
fn line<'a>(review: &'a Review, section: Section, part: &str) -> &'a Line {
    let lines = review.lines(section);
    let found = lines.iter().copied().find(|line| line.text.contains(part));
    found.unwrap_or_else(|| panic!("no line with \"{part}\": {lines:?}"))
}

/// The status of the worst line of a section.
fn worst(review: &Review, section: Section) -> Status {
    review.section_status(section)
}

fn ruled(mut review: Review, rules: &FlightRules) -> Review {
    review.judge(rules, None);
    review
}

/// The review of a snapshot that was changed.
fn changed(source: &str, change: impl FnOnce(&mut Snapshot)) -> Review {
    let mut snapshot = (*snapshot(source)).clone();
    change(&mut snapshot);
    review(&snapshot, &Goal::Default, 0, &mut || false)
}

fn change_planning(snapshot: &mut Snapshot, change: impl FnOnce(&mut Planning)) {
    change(Arc::make_mut(snapshot.planning.as_mut().expect("it was planned")));
}

#[test]
fn plan() {
    assert_eq!(line(&reviewed(OPEN), Section::Plan, "there is a plan").status, Status::Passed);
    let none = reviewed(&OPEN.replace("[20,20]", "[9,9]"));
    assert_eq!(line(&none, Section::Plan, "there is no plan").status, Status::Failed);
    let valid = "the independent checker accepts the plan";
    assert_eq!(line(&reviewed(OPEN), Section::Plan, valid).status, Status::Passed);
    let unchecked = reviewed_with(OPEN, None);
    assert_eq!(line(&unchecked, Section::Plan, "has not checked the plan").status, Status::Failed);
}

#[test]
fn a_plan_in_which_nothing_is_done() {
    for source in ["scenario S[0,10] = { }", "scenario S[0,10] = { delay[1,2] }"] {
        let empty = reviewed(source);
        assert_eq!(line(&empty, Section::Plan, "the plan is empty").status, Status::Attention, "{source}");
    }
    let review = reviewed(OPEN);
    assert!(review.lines(Section::Plan).iter().all(|line| !line.text.contains("the plan is empty")));
}

#[test]
fn what_a_plan_is_worth() {
    let source = "primitive A()[1,2] costs 3; objective minimize cost; scenario S[0,9] = { A() }";
    let worth = "objective: ";
    assert_eq!(line(&reviewed(source), Section::Plan, worth).status, Status::Passed);
    let open = changed(source, |snapshot| {
        change_planning(snapshot, |planning| planning.outcome.plans[0].quality.is_optimal = Some(false));
    });
    assert_eq!(line(&open, Section::Plan, worth).status, Status::Attention);
}

#[test]
fn choices() {
    assert_eq!(worst(&reviewed(SCENARIO), Section::Choices), Status::Passed);
    let stopped = review(&snapshot(SCENARIO), &Goal::Default, 0, &mut || true);
    assert_eq!(worst(&stopped, Section::Choices), Status::Attention);
}

#[test]
fn margins_of_causal_links() {
    let review = reviewed(OPEN);
    let link = line(&review, Section::CausalLinks, "outlasts it by 5 to 10 min");
    assert_eq!(link.status, Status::Passed);
    let criterion = link.criterion.as_deref().expect("it is held against something");
    assert!(criterion.contains("margin more than 0 min (flight rules, by default)"), "{criterion}");
    // The condition may end together with the activity.
    let tight = reviewed(&OPEN.replace("[20,20]", "[12,12]"));
    assert_eq!(worst(&tight, Section::CausalLinks), Status::Attention);
    assert_eq!(worst(&reviewed_with(OPEN, Some(refused())), Section::CausalLinks), Status::Failed);
    let asking = |units: i64| FlightRules { margin: Some(Time::from(units)), ..FlightRules::default() };
    assert_eq!(worst(&ruled(review.clone(), &asking(5)), Section::CausalLinks), Status::Passed);
    let more = ruled(review, &asking(6));
    assert_eq!(worst(&more, Section::CausalLinks), Status::Attention);
    let criterion = more.causal_links[0].line.criterion.clone().unwrap_or_default();
    assert!(criterion.contains("margin at least 6 min (flight rules of this mission)"), "{criterion}");
    let none = FlightRules { margin: None, ..FlightRules::default() };
    assert_eq!(worst(&ruled(tight, &none), Section::CausalLinks), Status::Passed, "no rule, no fault");
}

#[test]
fn gaps_between_what_must_not_overlap() {
    let review = reviewed(SCENARIO);
    assert_eq!(worst(&review, Section::Conflicts), Status::Passed, "1 to 185 minutes");
    let rules = FlightRules { margin: Some(Time::from(2)), ..FlightRules::default() };
    assert_eq!(worst(&ruled(review, &rules), Section::Conflicts), Status::Attention);
    assert_eq!(worst(&reviewed_with(SCENARIO, Some(refused())), Section::Conflicts), Status::Failed);
}

#[test]
fn states_and_reserves() {
    assert_eq!(worst(&reviewed(LASTING), Section::States), Status::Passed);
    assert_eq!(worst(&reviewed_with(LASTING, Some(refused())), Section::States), Status::Failed);
    let battery = |review: &Review| line(review, Section::Resources, "Battery").status;
    assert_eq!(battery(&reviewed(LASTING)), Status::Passed);
    let empty = LASTING.replace("= 60", "= 50");
    assert_eq!(battery(&reviewed(&empty)), Status::Attention, "it comes down to its least level");
    let mut rules = FlightRules::default();
    // A name that the mission does not have: the rule was held against nothing.
    rules.reserves.insert("Batery".into(), Rational::from_integer(10));
    let misspelled = ruled(reviewed(LASTING), &rules);
    assert_eq!(battery(&misspelled), Status::Passed);
    let text = "Batery: a reserve is required, but the plan has no resource with this name";
    assert_eq!(line(&misspelled, Section::MissionRules, "Batery").text, text);
    assert_eq!(misspelled.status, Status::Attention);
    rules.reserves.clear();
    rules.reserves.insert("Battery".into(), Rational::from_integer(10));
    assert_eq!(battery(&ruled(reviewed(LASTING), &rules)), Status::Passed);
    rules.reserves.insert("Battery".into(), Rational::from_integer(11));
    assert_eq!(battery(&ruled(reviewed(LASTING), &rules)), Status::Attention);
    // What one alone uses has nothing to spare; two of two have.
    let used = |capacity: i64| {
        let source = format!(
            "resource R capacity {capacity}; primitive A()[1,2] uses R {capacity}; scenario S[0,9] = {{ A() }}"
        );
        worst(&reviewed(&source), Section::Resources)
    };
    assert_eq!([used(1), used(2)], [Status::Passed, Status::Attention]);
}

#[test]
fn durations_that_the_plan_narrows() {
    assert_eq!(texts(&reviewed(OPEN), Section::Durations), Vec::<String>::new());
    let tight = reviewed(&OPEN.replace("[20,20]", "[12,12]"));
    let text = "A#1 is declared with [5,10], but the plan is valid only if it takes 5 to 7 min";
    assert_eq!(line(&tight, Section::Durations, "A#1").text, text);
    assert_eq!(worst(&tight, Section::Durations), Status::Attention);
    // Starting later than declared is the plan's own choice.
    let long = reviewed("primitive A()[5,10]; scenario S[8,20] = { A() }");
    assert_eq!(worst(&long, Section::Durations), Status::Information, "{:?}", long.durations);
    // Where no end is declared none is taken away, and the plan has one all the same.
    let endless = reviewed("primitive A()[5,inf]; scenario S[0,20] = { A() }");
    assert_eq!(
        texts(&endless, Section::Durations),
        ["A#1 is declared with 5 or longer, but the plan is valid only if it takes 5 to 20 min"]
    );
    assert_eq!(worst(&endless, Section::Durations), Status::Information);
    // The paper's mission: 405 to 486 minutes, of which the closing path leaves 450.
    let enroute = reviewed(MISSION);
    let drive = line(&enroute, Section::Durations, "Group-Traverse-Path(PATH1_1, …, TAI_POS)");
    assert!(
        drive.text.ends_with("[405,486], but the plan is valid only if it takes 405 to 450 min"),
        "{drive:?}"
    );
}

fn texts(review: &Review, section: Section) -> Vec<String> {
    review.lines(section).iter().map(|line| line.text.clone()).collect()
}

#[test]
fn windows_are_information_and_counted_apart() {
    let review = reviewed(SCENARIO);
    assert!(review.events.iter().all(|event| event.line.status == Status::Information));
    let [passed, attention, failed] = review.counts();
    let lines: usize = Section::ALL.iter().map(|&section| review.lines(section).len()).sum();
    assert!(passed < 10 && review.count(Status::Information) >= review.events.len(), "{review:?}");
    assert_eq!(passed + attention + failed + review.count(Status::Information), lines);
}

#[test]
fn clearance_and_slope() {
    let review = reviewed(MISSION);
    let traverse = |review: &Review| worst(review, Section::Traverses);
    let found = &review.traverses[0];
    let rules = |clearance_m: f64, slope_deg: f64| FlightRules {
        clearance_m: Some(clearance_m),
        slope_deg: Some(slope_deg),
        ..FlightRules::default()
    };
    let clearance_m = found.clearance_m.expect("there are obstacles");
    let slope_deg = found.slope_max_rad.to_degrees();
    let (less_m, more_deg) = ((clearance_m - 0.01).max(0.0), slope_deg + 0.01);
    assert_eq!(traverse(&ruled(review.clone(), &rules(less_m, more_deg))), Status::Passed);
    assert_eq!(traverse(&ruled(review.clone(), &rules(clearance_m + 0.01, more_deg))), Status::Attention);
    assert_eq!(traverse(&ruled(review.clone(), &rules(less_m, slope_deg - 0.01))), Status::Attention);
    let criterion = found.line.criterion.clone().unwrap_or_default();
    for part in ["clearance at least 0.25 m", "slope at most 15°", "slope at most 20.0° (vehicle limits)"] {
        assert!(criterion.contains(part), "{criterion}");
    }
    let mut steep = review;
    steep.traverses[0].slope_max_rad = 0.36;
    assert_eq!(
        traverse(&ruled(steep, &rules(0.0, 90.0))),
        Status::Failed,
        "20.6° are more than a rover climbs"
    );
    let inside = changed(MISSION, |snapshot| {
        let mut traverses = snapshot.traverses.to_vec();
        traverses[0].clearance_m = -0.1;
        snapshot.traverses = traverses.into();
    });
    assert_eq!(traverse(&inside), Status::Failed);
}

#[test]
fn vehicles_that_come_near_each_other() {
    assert_eq!(reviewed(MISSION).separation_violations, []);
    let near = changed(MISSION, |snapshot| {
        let violation = SeparationViolation {
            vehicles: [0, 1],
            since: 1.0,
            time: 2.0,
            position_m: nalgebra::Point2::new(1.0, 2.0),
            distance_m: 0.5,
            min_m: 2.2,
            schedule: Vec::new(),
        };
        snapshot.separation_violations = vec![violation].into();
    });
    assert_eq!(worst(&near, Section::SeparationViolations), Status::Failed);
}

#[test]
fn the_share_of_runs_that_reach_the_end() {
    let judged = |succeeded: u64, runs: u64, rules: &FlightRules| {
        let settings = RobustnessSettings { runs: 100, seed: 3, uncertainty: Uncertainty::default() };
        let tally = Tally { runs, succeeded, ..Tally::default() };
        let mut review = reviewed(OPEN);
        review.judge(rules, Some(&Robustness { settings, tally }));
        review
    };
    let rules = FlightRules::default();
    let of = |succeeded: u64| worst(&judged(succeeded, 100, &rules), Section::Robustness);
    assert_eq!([54, 79].map(of), [Status::Failed; 2]);
    assert_eq!([80, 94].map(of), [Status::Attention; 2]);
    assert_eq!([95, 100].map(of), [Status::Passed; 2]);
    assert_eq!(judged(54, 100, &rules).status, Status::Failed, "the whole review is not passed");
    let part = judged(50, 50, &rules);
    assert_eq!(worst(&part, Section::Robustness), Status::Attention, "only half of the runs were made");
    let text = &judged(54, 100, &rules).robustness.expect("a line").text;
    assert!(text.starts_with("54 % of 100 runs reached the end (Monte Carlo, seed 3;"), "{text}");
    let rate = SuccessRate { wanted: 0.5, least: 0.1 };
    let lenient = FlightRules { success_rate: Some(rate), ..rules.clone() };
    assert_eq!(worst(&judged(54, 100, &lenient), Section::Robustness), Status::Passed);
    let silent = FlightRules { success_rate: None, ..rules.clone() };
    assert_eq!(
        worst(&judged(54, 100, &silent), Section::Robustness),
        Status::Information,
        "held against nothing"
    );
    assert_eq!(worst(&judged(50, 50, &silent), Section::Robustness), Status::Attention);
    assert_eq!(judged(0, 0, &rules).robustness, None, "no runs, no line");
}

#[test]
fn runs_that_say_little_have_not_passed() {
    let judged = |settings: RobustnessSettings, tally: Tally| {
        let mut review = reviewed(OPEN);
        review.judge(&FlightRules::default(), Some(&Robustness { settings, tally }));
        let line = review.robustness.expect("a line");
        (line.status, line.text)
    };
    let settings = |runs: u64, others: Others| {
        let uncertainty = Uncertainty { others, ..Uncertainty::default() };
        RobustnessSettings { runs, seed: 3, uncertainty }
    };
    let all_of = |runs: u64| {
        judged(settings(runs, Others::Uniform), Tally { runs, succeeded: runs, ..Tally::default() })
    };
    // Wilson's interval of n out of n begins at n / (n + 1.96²): 72 % of 10, 84 % of 20.
    assert_eq!([1, 10].map(|runs| all_of(runs).0), [Status::Attention; 2], "that could be luck");
    assert_eq!([20, 100].map(|runs| all_of(runs).0), [Status::Passed; 2]);
    // Nothing but the plan itself was run.
    let tally = Tally { runs: 100, succeeded: 100, succeeded_by_replanning: 0, ..Tally::default() };
    let (status, text) = judged(settings(100, Others::Planned), tally.clone());
    assert_eq!(status, Status::Attention, "{text}");
    assert!(text.ends_with("; nothing in the runs was random"), "{text}");
    // A run that continued by another plan says nothing for this one.
    let tally = Tally { succeeded_by_replanning: 12, ..tally };
    let (_, text) = judged(settings(100, Others::Uniform), tally);
    assert!(text.ends_with(", 12 of them after replanning"), "{text}");
}

#[test]
fn problems_of_the_text() {
    assert_eq!(reviewed("scenario S[0,9] = { delay }").warnings, []);
    assert_eq!(worst(&reviewed("scenario S[0,9] = { A( }"), Section::Warnings), Status::Failed);
    // A condition that nothing asserts is only a warning until something needs it.
    let warned = reviewed("primitive A(); scenario S[0,9] = { B() }");
    assert!(worst(&warned, Section::Warnings) >= Status::Attention, "{:?}", warned.warnings);
}

#[test]
fn rules_of_the_mission() {
    let held = |source: &str, rule: &str, waivable: bool| {
        let rule = MissionRule { name: "Open".into(), rule: rule.into(), source: "FR 7".into(), waivable };
        let rules = FlightRules { rules: vec![rule], ..FlightRules::default() };
        let mut review = reviewed(source);
        review.judge(&rules, None);
        assert_eq!(worst(&review, Section::MissionRules), Status::Failed, "not evaluated is not passed");
        review.hold_against(&snapshot(source), &rules, None, &mut || false);
        let [line] = review.lines(Section::MissionRules)[..] else { panic!("one line") };
        (line.status, line.text.clone(), line.criterion.clone().unwrap_or_default())
    };
    let (status, text, criterion) = held(OPEN, "P=OK while A", false);
    assert_eq!((status, text.as_str()), (Status::Passed, "Open: holds in every schedule of the plan"));
    assert_eq!(criterion, "P=OK while A (FR 7, flight rules of this mission)");
    // The mission asserts it for too short a time.
    let short = OPEN.replace("do { A() } maintaining P=OK", "A()").replace("[20,20]", "[9,9]");
    let (status, text, _) = held(&short, "never A while P=OK", false);
    assert_eq!(status, Status::Failed, "{text}");
    assert!(text.contains("a schedule of the plan violates it, from 5 to 9,"), "{text}");
    assert_eq!(held(&short, "never A while P=OK", true).0, Status::Attention, "it may be waived");
    assert_eq!(held(&short, "P=OK while A", false).0, Status::Attention, "nothing says what it is from 9 on");
    assert_eq!(held(OPEN, "P=OFF", true).0, Status::Failed, "it cannot be read");
    assert_eq!(held(OPEN, "P=OK at start of A", false).0, Status::Passed);
    let none = held("primitive A(); scenario S[0,9] = { delay }", "never A", false);
    assert_eq!(none.0, Status::Passed);
    let unplanned = held(&OPEN.replace("[20,20]", "[9,9]"), "never A", true);
    assert_eq!(unplanned.0, Status::Failed, "there is no plan");
}

#[test]
fn what_nature_chooses_is_said_event_by_event() {
    let source = "primitive Drive() contingent [20,40]; scenario S[0,60] = { Drive(); delay }";
    let review = reviewed(source);
    let told = line(&review, Section::Plan, "uncontrolled");
    assert_eq!(told.text, "uncontrolled: Drive#1 ends 20 to 40 after its start");
    assert_eq!(told.status, Status::Information);
    let own = reviewed(&source.replace("contingent ", ""));
    assert!(!texts(&own, Section::Plan).iter().any(|text| text.starts_with("uncontrolled")));
}

#[test]
fn rules_are_read_back_and_wrong_ones_refused() {
    let mut rules = FlightRules { slope_deg: None, ..FlightRules::default() };
    rules.reserves.insert("Battery".into(), Rational::from_integer(20));
    let rule = MissionRule { name: "Open".into(), rule: "P=OK while A".into(), ..MissionRule::default() };
    rules.rules.push(rule);
    assert_eq!(FlightRules::from_json(&rules.to_json()), Ok(rules));
    let some =
        FlightRules::from_json("{\"format\": \"enroute-rules/1\", \"margin\": 15, \"clearance_m\": null}");
    let expected = FlightRules { margin: Some(Time::from(15)), clearance_m: None, ..FlightRules::default() };
    assert_eq!(some, Ok(expected));
    for wrong in [
        "{",
        "{\"margin\": 1}",
        "{\"format\": \"enroute-plan/1\"}",
        "{\"format\": \"enroute-rules/1\", \"margin\": -1}",
        "{\"format\": \"enroute-rules/1\", \"margins\": 1}",
        "{\"format\": \"enroute-rules/1\", \"rules\": [{\"name\": \"A\", \"rule\": \"\"}]}",
        "{\"format\": \"enroute-rules/1\", \"rules\": [{\"name\": \"\", \"rule\": \"P=OK\"}]}",
        "{\"format\": \"enroute-rules/1\", \"success_rate\": {\"wanted\": 0.5, \"least\": 0.6}}",
    ] {
        assert!(FlightRules::from_json(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn what_the_mission_does_not_keep_apart() {
    let mission = |clauses: [&str; 2], scenario: &str| {
        format!(
            "location A (0, 0); location B (9, 9); vehicle Rover : ATRV at A; vehicle Other : ATRV at B;
             resource Arm; resource Mast; primitive Drill()[5,9] requires Rover.at=A {};
             primitive Brush(rover)[4,6] {}; primitive Dance(rover)[4,6]; scenario S[0,60] = {scenario}",
            clauses[0], clauses[1]
        )
    };
    let both = "{ { delay; Drill() }, { delay; Brush(Rover) } }";
    let open = reviewed(&mission(["", ""], both));
    assert_eq!(
        texts(&open, Section::Overlaps),
        [
            "Drill and Brush may overlap on Rover: in some schedule of the plan, Drill#1 and Brush(Rover) are in progress at the same \
             time from 0 to 60"
        ]
    );
    assert_eq!(worst(&open, Section::Overlaps), Status::Attention);
    let apart = "no activities of Rover overlap in any schedule of the plan";
    for (clauses, scenario) in [
        (["uses Arm", "uses Arm"], both),
        (["", ""], "{ unordered { Drill(); Brush(Rover) } }"),
        (["", ""], "{ Drill(); Brush(Rover) }"),
        (["", ""], "{ { Drill()[5,5]; delay }, { delay[5,9]; Brush(Rover) } }"),
    ] {
        let review = reviewed(&mission(clauses, scenario));
        assert_eq!(texts(&review, Section::Overlaps), [apart], "{clauses:?} {scenario}");
        assert_eq!(worst(&review, Section::Overlaps), Status::Passed);
    }
    // Both take something whole, and different things.
    let declared = reviewed(&mission(["uses Arm", "uses Mast"], both));
    assert_eq!(
        texts(&declared, Section::Overlaps),
        [format!("{apart}, except those that each use a resource entirely")]
    );
    // Activities of different vehicles do not count, and a single activity overlaps nothing.
    let other = reviewed(&mission(["", ""], "{ { delay; Drill() }, { delay; Brush(Other) } }"));
    assert_eq!(texts(&other, Section::Overlaps), Vec::<String>::new());
    assert_eq!(other.section_status(Section::Overlaps), Status::Information);
    let twice = reviewed(&mission(["", ""], "{ { delay; Dance(Other) }, { delay; Dance(Other) } }"));
    let [text] = &texts(&twice, Section::Overlaps)[..] else { panic!("one line") };
    assert!(text.starts_with("two of Dance may overlap on Other: "), "{text}");
}

#[test]
fn a_sol_keeps_what_its_rover_does_apart() {
    let review = reviewed(include_str!("../../../assets/missions/sol.rmpl"));
    assert_eq!(worst(&review, Section::Overlaps), Status::Passed, "{:?}", review.overlaps);
}

#[test]
fn levels_that_are_required() {
    let source = "resource Battery 0..100 = 50; primitive Dig()[1,2] requires Battery >= 30 at start consumes Battery 10;
                  scenario S[0,9] = { Dig() }";
    let part = "Dig#1 requires Battery >= 30 at its start";
    assert_eq!(line(&reviewed(source), Section::States, part).status, Status::Passed);
    let higher = changed(source, |snapshot| {
        let network = Arc::make_mut(snapshot.network.as_mut().expect("it compiles"));
        let mut asked = network.uses.iter_mut().filter_map(|used| used.level.as_mut());
        asked.next().expect("a level is required").bound = Rational::from_integer(60);
        let network = network.clone();
        change_planning(snapshot, |planning| {
            planning.verdict = Some(verify::check_plan(&network, &planning.outcome.plans[0]));
        });
    });
    let part = "Dig#1 requires Battery >= 60 at its start";
    assert_eq!(line(&higher, Section::States, part).status, Status::Failed);
}
