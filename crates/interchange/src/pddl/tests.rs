//! Names, and what the text of a mission says.

use super::*;

const ONCE: Settings = Settings { times: 1, has_metric: true };

const DOMAIN: &str = "(define (domain d) (:types place) (:predicates (at ?p - place) (road ?a ?b - place))
    (:functions (fuel))
    (:durative-action drive :parameters (?a ?b - place) :duration (= ?duration 10)
      :condition (and (at start (at ?a)) (over all (road ?a ?b)) (at start (>= (fuel) 3)))
      :effect (and (at start (not (at ?a))) (at end (at ?b)) (at start (decrease (fuel) 3)))))";

fn problem(goal: &str) -> String {
    format!(
        "(define (problem x) (:domain d) (:objects a b c - place)
        (:init (at a) (road a b) (road c b) (= (fuel) 5)) (:goal {goal}))"
    )
}

fn mission(goal: &str) -> Result<String, PddlError> {
    translate(("d.pddl", DOMAIN), ("x.pddl", &problem(goal)), ONCE).map(|read| read.mission)
}

#[test]
fn only_actions_that_can_happen_and_may_help_are_written() {
    let text = mission("(at b)").expect("a mission");
    let primitives: Vec<&str> = text.lines().filter(|line| line.starts_with("primitive")).collect();
    assert_eq!(
        primitives,
        [
            "primitive drive__a__b___start()[0.02,0.02] requires at__a=yes sets at__a=no uses fuel_____lock \
             consumes fuel_____level 3;",
            "primitive drive__a__b___end()[0.02,0.02] sets at__b=yes;",
            "primitive drive__a__b()[10,10];",
        ],
        "{text}"
    );
    // From 5 the fuel can fall to 2 at the least.
    assert!(text.contains("resource fuel_____level 0..3 = 3; // (fuel) - 2\n"), "{text}");
    assert!(text.contains("  ask at__b=yes\n"), "{text}");
    assert!(
        rmpl::parse(&text).diagnostics().iter().all(|found| found.severity != rmpl::Severity::Error),
        "{text}"
    );
}

#[test]
fn places_of_one_thing_are_the_values_of_one_state() {
    let domain = DOMAIN.replace("(at ?a)", "(at ?v ?a)").replace("(at ?b)", "(at ?v ?b)");
    let domain = domain
        .replace(":parameters (?a ?b - place)", ":parameters (?v - van ?a ?b - place)")
        .replace("(:types place)", "(:types place van)");
    let problem = "(define (problem x) (:domain d) (:objects a b - place v - van)
        (:init (at v a) (road a b) (road b a) (= (fuel) 5)) (:goal (at v b)))";
    let text = translate(("d.pddl", &domain), ("x.pddl", problem), ONCE).expect("a mission").mission;
    assert!(text.contains("state v___is : {none, at__v__a, at__v__b} = at__v__a;"), "{text}");
    let start = "drive__v__a__b___start()[0.02,0.02] requires v___is=at__v__a sets v___is=none uses";
    assert!(
        text.contains(start) && text.contains("drive__v__a__b___end()[0.02,0.02] sets v___is=at__v__b;"),
        "{text}"
    );
    // With someone who can be put anywhere, the places exclude each other no longer.
    let beside =
        "(:action put :parameters (?v - van ?a - place) :precondition (road ?a ?a) :effect (at ?v ?a))";
    let domain = format!("{} {beside})", domain.strip_suffix(')').expect("its last parenthesis"));
    let roads = problem.replace("(road a b)", "(road a b) (road b b)");
    let text = translate(("d.pddl", &domain), ("x.pddl", &roads), ONCE).map(|read| read.mission);
    assert!(text.as_ref().is_ok_and(|text| !text.contains("___is")), "{text:?}");
}

#[test]
fn a_goal_that_nothing_reaches_is_asked_for_all_the_same() {
    let text = mission("(at c)").expect("a mission");
    assert!(text.contains("ask at__c=yes") && !text.contains("primitive"), "{text}");
    assert_eq!(mission("(road b a)"), Err(PddlError::NeverTrue));
}

#[test]
fn names_lead_back_to_actions() {
    let words = |name: &'static str| named_action(name).map(|action| action.words);
    assert_eq!(words("drive__a-1__b_2"), Some(vec!["drive", "a-1", "b_2"]));
    assert_eq!(words("wait__"), Some(vec!["wait"]));
    assert_eq!(words("drive__a___start"), None);
    assert_eq!(words("wait_____end"), None);
    let instant = named_action("wait_____instant");
    assert_eq!(instant, Some(NamedAction { words: vec!["wait"], is_instant: true }));
    let renamed = DOMAIN.replace("drive", "drive__to");
    let refused = translate(("d.pddl", &renamed), ("x.pddl", &problem("(at b)")), ONCE);
    assert_eq!(refused, Err(PddlError::Name { name: "drive__to".to_owned() }));
}

#[test]
fn what_begins_with_define_is_pddl() {
    for text in
        ["(define (domain d))", "; a comment\n\n( DEFINE\n (problem x))", "\u{feff}(define(domain d))"]
    {
        assert!(is_pddl(text), "{text}");
    }
    for text in ["(defmission x)", "(DEFCONTROL p)", "scenario S[0,1] = { A() }", "", "(defines)"] {
        assert!(!is_pddl(text), "{text}");
    }
}

#[test]
fn what_is_not_well_formed_has_its_line() {
    let told = |domain: &str| {
        translate(("d.pddl", domain), ("x.pddl", &problem("(at b)")), ONCE).expect_err(domain).to_string()
    };
    assert_eq!(told("(define (domain d)\n(:types a"), "d.pddl, line 2: unclosed `(`");
    assert!(
        told("(define (domain d)))").contains("text after the closing parenthesis"),
        "{}",
        told("(define (domain d)))")
    );
    assert!(
        told("(define (domain d)\n(:derived (p) (q)))").starts_with("d.pddl, line 2: a derived predicate")
    );
    assert!(told(&"(".repeat(1000)).contains("nest deeper"));
}

#[test]
fn facts_and_parameters_are_checked() {
    let of = |domain: &str, problem: &str| translate(("d.pddl", domain), ("x.pddl", problem), ONCE);
    for (fact, unknown) in [("(at d)", "d"), ("(at 5 (at e))", "e"), ("(= (fuel f) 1)", "f")] {
        let text = problem("(at b)").replace("(at a)", &format!("(at a) {fact}"));
        let expected = PddlError::Unknown { place: ":init".to_owned(), name: unknown.to_owned() };
        assert_eq!(of(DOMAIN, &text), Err(expected), "{fact}");
    }
    let twice = DOMAIN.replace(":parameters (?a ?b", ":parameters (?a ?a ?b");
    let refused = of(&twice, &problem("(at b)")).expect_err("one name twice").to_string();
    assert!(refused.contains("a parameter of the same name"), "{refused}");
}

#[test]
fn what_only_improves_the_metric_is_kept() {
    let domain = DOMAIN.replace("(:functions (fuel))", "(:functions (fuel) (photos))").replacen(
        "(:durative-action",
        "(:durative-action shoot :parameters () :duration (= ?duration 1) :condition () \
         :effect (at end (increase (photos) 1))) (:durative-action",
        1,
    );
    let with = |metric: &str| {
        let text = problem("(at b)").replace("(= (fuel) 5)", "(= (fuel) 5) (= (photos) 0) (at 7 (at c))");
        let text = text.replace("(:goal", &format!("{metric} (:goal"));
        translate(("d.pddl", &domain), ("x.pddl", &text), ONCE).expect(metric)
    };
    let kept = with("(:metric maximize (photos))");
    assert!(kept.mission.contains("primitive shoot__()[1,1] rewards 1;"), "{}", kept.mission);
    assert!(kept.mission.contains("objective minimize -reward;"), "{}", kept.mission);
    assert!(!with("(:metric minimize (photos))").mission.contains("shoot"));
    let timed = with("(:metric minimize (total-time))");
    let remark = "the mission ends after the last timed change, at 7, even if the goal is reached earlier";
    assert!(timed.remarks.iter().any(|it| it == remark), "{:?}", timed.remarks);
}
