//! PDDL: problems as missions, and plans of these as plans of the problems.

use std::process::Output;

use crate::command::{answer, enroute, file, said};
use crate::pddl_rules;

fn fixture(name: &str) -> String {
    format!("{}/tests/fixtures/pddl/{name}.pddl", env!("CARGO_MANIFEST_DIR"))
}

fn text_of(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    String::from_utf8(output.stdout.clone()).expect("text")
}

/// The mission of a problem among the fixtures, with what the command says beside it.
fn mission_of(domain: &str, problem: &str, times: &str) -> (String, String) {
    let arguments = ["import", &fixture(domain), &fixture(problem), "--times", times];
    let output = enroute(&arguments);
    (file(&format!("{problem}-{times}.rmpl"), &text_of(&output)), said(&output))
}

/// Plans a problem and holds the plan against the rules of PDDL. Returns the plan.
fn plan_of(domain: &str, problem: &str) -> String {
    let (mission, _) = mission_of(domain, problem, "1");
    let checked = enroute(&["check", &mission]);
    assert_eq!(checked.status.code(), Some(0), "{checked:?}");
    let plan = text_of(&enroute(&["export", &mission, "--as", "pddl"]));
    let read = |name: &str| std::fs::read_to_string(fixture(name)).expect("a fixture");
    assert!(pddl_rules::check(&read(domain), &read(problem), &plan) > 0, "{plan}");
    plan
}

#[test]
fn a_plan_of_the_mission_is_a_plan_of_the_problem() {
    let plan = plan_of("delivery-domain", "delivery-problem");
    assert!(plan.contains("(drive fast depot mill-1) [10.000]"), "{plan}");
    assert!(plan.contains("(load p1 fast depot) [2.000]") && !plan.contains("___"), "{plan}");
}

#[test]
fn a_plan_that_needs_two_things_at_once_is_found() {
    let plan = plan_of("cellar-domain", "cellar-problem");
    // One hand and 8 minutes of light: each of the two repairs of 5 minutes needs a match of its own.
    assert_eq!(plan.matches("light-match").count(), 2, "{plan}");
    assert_eq!(plan.matches("(repair").count(), 2, "{plan}");
}

#[test]
fn numbers_and_times_that_are_given_count() {
    let plan = plan_of("survey-domain", "survey-problem");
    let charge = plan.lines().find(|line| line.contains("(charge r)")).expect("it charges");
    let start: f64 = charge.split(':').next().and_then(|time| time.parse().ok()).expect("a time");
    assert!((20.0..=35.0).contains(&start), "while the sun shines: {plan}");
}

#[test]
fn the_best_plan_is_the_shortest() {
    let (mission, _) = mission_of("delivery-domain", "delivery-problem", "1");
    let plan = answer(&enroute(&["plan", &mission, "--format", "json"]));
    assert_eq!(plan["status"], "plan", "{plan}");
    assert_eq!(plan["plans"][0]["optimal"], true, "{plan}");
    let any = enroute(&["import", &fixture("delivery-domain"), &fixture("delivery-problem"), "--any-plan"]);
    assert!(!text_of(&any).contains("objective"), "{any:?}");
}

#[test]
fn what_a_condition_only_mentions_is_kept_apart() {
    // Neither order is part of the other product, but PDDL's rules look at every atom of a condition.
    let domain = "(define (domain stacks) (:types order product) (:predicates (includes ?o - order ?p - product)
        (started ?o - order) (made ?p - product) (free))
        (:durative-action begin :parameters (?o - order) :duration (= ?duration 1) :condition (at start (free))
            :effect (and (at start (not (free))) (at end (free)) (at end (started ?o))))
        (:durative-action make :parameters (?p - product) :duration (= ?duration 5)
            :condition (at start (forall (?o - order) (or (not (includes ?o ?p)) (started ?o))))
            :effect (at end (made ?p))))";
    let problem = "(define (problem two) (:domain stacks) (:objects o1 o2 - order p1 p2 - product)
        (:init (free) (includes o1 p1) (includes o2 p2)) (:goal (and (made p1) (made p2))) (:metric minimize (total-time)))";
    let mission =
        text_of(&enroute(&["import", &file("stacks.pddl", domain), &file("stacks-two.pddl", problem)]));
    assert!(mission.contains("___lock;"), "{mission}");
    let plan = text_of(&enroute(&["export", &file("stacks.rmpl", &mission), "--as", "pddl"]));
    assert_eq!(pddl_rules::check(domain, problem, &plan), 4, "{plan}");
}

#[test]
fn how_often_actions_may_happen_decides_whether_there_is_a_plan() {
    // There and back, with one van that carries one parcel at a time.
    let domain = "(define (domain ferry) (:types parcel site) (:predicates (van ?s - site) (at ?p - parcel ?s - site)
        (in ?p - parcel) (empty))
        (:durative-action drive :parameters (?a ?b - site) :duration (= ?duration 5) :condition (at start (van ?a))
            :effect (and (at start (not (van ?a))) (at end (van ?b))))
        (:action load :parameters (?p - parcel ?s - site) :precondition (and (at ?p ?s) (van ?s) (empty))
            :effect (and (not (at ?p ?s)) (not (empty)) (in ?p)))
        (:action unload :parameters (?p - parcel ?s - site) :precondition (and (in ?p) (van ?s))
            :effect (and (not (in ?p)) (empty) (at ?p ?s))))";
    let problem = "(define (problem two) (:domain ferry) (:objects p1 p2 - parcel a b - site)
        (:init (van a) (at p1 a) (at p2 a) (empty)) (:goal (and (at p1 b) (at p2 b))))";
    let (domain_file, problem_file) = (file("ferry.pddl", domain), file("ferry-two.pddl", problem));
    let planned = |times: &str| {
        let mission = text_of(&enroute(&["import", &domain_file, &problem_file, "--times", times]));
        let mission = file(&format!("ferry-{times}.rmpl"), &mission);
        enroute(&["export", &mission, "--as", "pddl"])
    };
    assert_eq!(planned("1").status.code(), Some(1), "one drive from a to b carries one parcel");
    let plan = text_of(&planned("2"));
    assert!(pddl_rules::check(domain, problem, &plan) >= 7, "{plan}");
    assert!(plan.contains("(load p1 a)\n"), "no duration: {plan}");
}

#[test]
fn what_no_mission_can_say_is_named() {
    let domain = |action: &str| {
        file(
            "named.pddl",
            &format!(
                "(define (domain d) (:predicates (p) (q)) (:functions (f) (g))\n(:durative-action a :parameters ()\n{action}))"
            ),
        )
    };
    let problem = file(
        "named-problem.pddl",
        "(define (problem x) (:domain d) (:init (= (f) 1) (= (g) 1)) (:goal (p)))",
    );
    let refused = |action: &str| {
        let output = enroute(&["import", &domain(action), &problem]);
        assert_eq!(output.status.code(), Some(2), "{action}: {output:?}");
        said(&output)
    };
    let of = |condition: &str, effect: &str| {
        refused(&format!(
            ":duration (= ?duration 5) :condition (and {condition}) :effect (and (at end (p)) {effect})"
        ))
    };
    for (told, what) in [
        (of("", "(at end (when (q) (p)))"), "a conditional effect (`when`) is not supported"),
        (of("", "(increase (f) (* #t 2))"), "the continuous effect"),
        (of("", "(at end (assign (f) 2))"), "the effect `assign`"),
        (of("(at start (or (p) (q)))", "(at end (not (q))) (at start (q))"), "`or`"),
        (
            of("(at start (>= (f) (g)))", "(at end (increase (f) 1)) (at end (increase (g) 1))"),
            "two numbers that change",
        ),
        (
            refused(":duration (= ?duration (f)) :effect (and (at end (p)) (at end (increase (f) 1)))"),
            "a duration that depends",
        ),
        (refused(":duration (= ?duration 0.001) :effect (at end (p))"), "shorter than"),
        (refused(":duration (= ?duration 1) :effect (at middle (p))"), "line 3"),
    ] {
        assert!(told.contains(what), "{what}: {told}");
    }
    let lonely = enroute(&["import", &domain(":duration (= ?duration 5) :effect (at end (p))")]);
    assert!(said(&lonely).contains("give the domain and the problem"), "{lonely:?}");
    let planned = enroute(&["plan", &problem]);
    assert!(said(&planned).contains("enroute import DOMAIN PROBLEM"), "{planned:?}");
    let other = file("other-problem.pddl", "(define (problem x) (:domain other) (:goal (p)))");
    let told = said(&enroute(&["import", &domain(":duration (= ?duration 5) :effect (at end (p))"), &other]));
    assert!(told.contains("belongs to the domain `other`"), "{told}");
}

#[test]
fn a_metric_that_cannot_be_said_is_named_and_the_plan_is_one() {
    let domain = "(define (domain d) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration 5) :effect (at end (p))))";
    let problem = "(define (problem x) (:domain d) (:goal (p)) (:metric maximize (total-time)))";
    let output = enroute(&["import", &file("metric.pddl", domain), &file("metric-problem.pddl", problem)]);
    assert!(said(&output).contains("the metric `maximize (total-time)` is left out"), "{output:?}");
    let plan = text_of(&enroute(&["export", &file("metric.rmpl", &text_of(&output)), "--as", "pddl"]));
    assert_eq!(pddl_rules::check(domain, problem, &plan), 1, "{plan}");
    assert!(plan.contains("0.000: (a) [5.000]"), "{plan}");
}

#[test]
fn any_mission_has_a_plan_in_pddl() {
    let mission =
        file("any.rmpl", "primitive Drive(v, to)[5,9];\nscenario S[0,60] = { Drive(R1, A); Drive(R1, B) }\n");
    let plan = text_of(&enroute(&["export", &mission, "--as", "pddl"]));
    assert!(plan.contains("0.000: (Drive R1 A) [5.000]\n5.000: (Drive R1 B) [5.000]\n"), "{plan}");
}

#[test]
fn options_of_another_format_and_very_long_actions_are_refused() {
    let (domain, problem) = (fixture("delivery-domain"), fixture("delivery-problem"));
    let refused = |arguments: &[&str], part: &str| {
        let output = enroute(&[&["import"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
        assert!(said(&output).contains(part), "{arguments:?}: {output:?}");
    };
    refused(&[&domain, &problem, "--origin", "1,2"], "remove --origin, --radius and --meters");
    let places = file("options.geojson", r#"{"type": "FeatureCollection", "features": []}"#);
    refused(&[&places, "--meters", "--times", "2"], "remove --times and --any-plan");
    refused(&[&places, "--meters", "--any-plan"], "remove --times and --any-plan");
    let parameters: String = (0..20_000).map(|at| format!(" ?p{at}")).collect();
    let domain = format!(
        "(define (domain many) (:predicates (done)) (:action a :parameters ({parameters}) :precondition () :effect (done)))"
    );
    let problem = "(define (problem one) (:domain many) (:objects o) (:init) (:goal (done)))";
    let files = [file("many.pddl", &domain), file("many-problem.pddl", problem)];
    refused(&[&files[0], &files[1]], "more than 100 parameters of an action");
}
