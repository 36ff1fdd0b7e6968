//! Rules of a mission, each with the change that breaks it.

use exact::{Bound, Time};

use super::super::tests::{MISSION, SCENARIO, snapshot};
use super::{Finding, MissionRule, Outcome, Stretch, evaluate};

fn found(source: &str, rule: &str) -> Finding {
    let rules = [MissionRule { name: "R".into(), rule: rule.into(), ..MissionRule::default() }];
    evaluate(&snapshot(source), &rules, &mut || false).remove(0)
}

fn stretch(from: i64, to: i64) -> Stretch {
    Stretch { from: Time::from(from), to: Bound::Finite(Time::from(to)) }
}

#[track_caller]
fn holds(source: &str, rule: &str) {
    assert_eq!(found(source, rule).outcome, Outcome::Holds, "{rule}");
}

#[track_caller]
fn broken(source: &str, rule: &str, words: &str) {
    let found = found(source, rule);
    assert_eq!(found.outcome, Outcome::Broken(words.to_owned()), "{rule}");
    assert!(!found.breaks.is_empty());
}

const ROVER: &str = "state Mast : {UP, DOWN} = DOWN; resource Battery 0..100 = 60; resource Power capacity 3;
location Base (0, 0); location Rock (9, 9); vehicle Rover1 : ATRV at Base;
primitive Raise()[1,2] sets Mast=UP; primitive Lower()[1,2] sets Mast=DOWN;
primitive Drive(to)[5,9] consumes Battery 20 uses Power 2; primitive Charge()[4,4] produces Battery 30;
primitive Talk()[2,3] uses Power;
scenario Day[0,60] = { Raise(); Talk(); Lower(); Drive(Rock); Charge() }";

#[test]
fn what_the_plan_puts_in_order_holds() {
    holds(ROVER, "never Drive while Mast=UP");
    holds(ROVER, "Mast=UP while Talk");
    holds(ROVER, "Mast=DOWN at end");
    holds(ROVER, "Mast=UP at start of Talk");
    broken(
        &ROVER.replace("Lower(); Drive(Rock)", "Drive(Rock); Lower()"),
        "never Drive while Mast=UP",
        "from 3 to 14, after Drive(Rock).start, before Drive(Rock).end",
    );
}

/// Changes that come at one instant follow each other as the plan says.
#[test]
fn of_changes_at_one_instant_the_last_one_counts() {
    let source =
        "state X : {A, B} = A; scenario S[0,7] = { { X=A [4,6] }, { X=A [0,0]; X=B }, { delay[0,1] } }";
    holds(source, "X=A at end");
    holds(source, "X=A from 1 to 7");
    for rule in ["X=B", "X=B at end", "X=B from 3 to 5"] {
        assert!(matches!(found(source, rule).outcome, Outcome::Broken(_)), "{rule}");
    }
}

#[test]
fn a_rule_and_its_negation_never_both_hold() {
    const ABC: &str = "state M : {UP, DOWN} = DOWN; var C : {ON, OFF}; option threat_gap = 0;
primitive A()[2,2]; primitive B()[3,3]; primitive Raise()[0,0] sets M=UP; primitive Lower()[0,0] sets M=DOWN;
scenario S[0,60] = { { A(); B(); Raise(); Lower() }, { C=ON [2,2]; C=OFF [3,3] } }";
    for moment in
        ["at end of A", "at start of B", "at end of Raise", "at start of Lower", "at end", "", "from 1 to 5"]
    {
        for condition in ["A", "B", "M=UP", "M=DOWN", "C=ON", "not C=ON", "A or B", "A and C=ON", "Raise"] {
            let outcomes =
                ["", "never "].map(|word| found(ABC, &format!("{word}{condition} {moment}")).outcome);
            let holding = outcomes.iter().filter(|outcome| **outcome == Outcome::Holds).count();
            assert!(holding <= 1, "{condition} {moment}: {outcomes:?}");
        }
    }
    // What only touches a moment is enough for a rule that wants it, and too much for one that does not.
    holds(ABC, "B at end of A");
    for rule in [
        "never B at end of A",
        "never A at start of B",
        "never M=UP at end of Raise",
        "M=UP while B at end of A",
    ] {
        let outcome = found(ABC, rule).outcome;
        assert!(matches!(outcome, Outcome::Unsure(_)), "{rule}: {outcome:?}");
    }
    holds(ABC, "never B at start of A");
}

#[test]
fn what_is_under_way_at_the_same_time_in_one_execution_only_breaks_a_rule() {
    let source = |delay: &str| {
        format!(
            "primitive A()[3,5]; primitive B()[2,2]; scenario S[0,20] = {{ A(), {{ delay{delay}; B() }} }}"
        )
    };
    holds(&source("[5,9]"), "never A while B");
    broken(&source("[4,9]"), "never A while B", "from 4 to 5, after B#1.start, before A#1.end");
}

#[test]
fn levels_are_the_lowest_and_the_highest_of_all_executions() {
    holds(ROVER, "Battery >= 40");
    broken(ROVER, "Battery > 40", "from 4 to 20, after Drive(Rock).start: Battery is 40");
    holds(ROVER, "Battery >= 60 at end");
    holds(ROVER, "Battery <= 70");
    holds(ROVER, "Battery >= 60 at start of Drive");
    broken(ROVER, "Battery >= 60 at end of Drive", "from 9 to 16, with Drive(Rock).end: Battery is 40");
    holds(ROVER, "Power <= 2");
    broken(ROVER, "Power <= 1", "from 4 to 16, after Drive(Rock).start: Power is 2");
    // Twice the consumption in parallel: each alone leaves 40, both together 20.
    let two = "resource Battery 0..100 = 60; primitive Drive()[5,9] consumes Battery 20;
        primitive Charge()[1,1] produces Battery 20;
        scenario S[0,40] = { { delay[0,20]; Drive(); Charge() }, { delay[0,20]; Drive(); Charge() } }";
    holds(two, "Battery >= 20");
    assert!(matches!(found(two, "Battery > 20").outcome, Outcome::Broken(_)));
    // Each drive waits for the charge of the other: never both at once.
    let one = two.replace("}, {", ";").replace("{ {", "{").replace("} }", "}");
    holds(&one, "Battery >= 40");
}

#[test]
fn rules_hold_in_their_time_only() {
    let source = "resource Battery 0..100 = 60; primitive Drive()[5,5] consumes Battery 30;
        scenario S[30,30] = { delay[10,10]; Drive(); delay }";
    holds(source, "Battery >= 60 from 0 to 10");
    broken(source, "Battery >= 60 from 0 to 11", "from 10 to 11, after Drive#1.start: Battery is 30");
    broken(source, "Battery >= 60", "from 10 to 30, after Drive#1.start: Battery is 30");
    let found = found(source, "Battery >= 60 from 5 to 15");
    assert_eq!((found.applies, found.breaks), (vec![stretch(5, 15)], vec![stretch(10, 15)]));
}

#[test]
fn what_nothing_says_is_not_held() {
    let source = "var Comm : {UP, DOWN}; primitive Talk()[5,5];
        scenario S[0,30] = { delay[3,3]; { Comm=UP [10,10], { delay[1,1]; Talk() } } }";
    holds(source, "Comm=UP while Talk");
    holds(source, "never Comm=DOWN while Talk");
    let unsure = found(source, "never Comm=DOWN");
    let Outcome::Unsure(words) = &unsure.outcome else { panic!("{unsure:?}") };
    assert!(words.starts_with("from 0 to 3"), "{words}");
    let told = source.replace("Comm=UP [10,10]", "Comm=DOWN [10,10]");
    broken(
        &told,
        "never Comm=DOWN",
        "from 3 to 13, after Tell(Comm=DOWN)#1.start, before Tell(Comm=DOWN)#1.end",
    );
}

#[test]
fn what_a_plan_never_comes_to_has_not_passed() {
    let source = "primitive A()[1,1]; primitive B()[1,1]; scenario S[0,5] = { choose { A(), B() } }";
    assert_eq!(found(source, "A at start of B").outcome, Outcome::NeverApplies);
    assert_eq!(found(source, "never A while B").outcome, Outcome::NeverApplies);
    assert_eq!(found(source, "never B").outcome, Outcome::Holds);
    assert_eq!(
        found(source, "A and B at start of A").outcome,
        Outcome::Broken("at 0, with A#1.start".into())
    );
}

#[test]
fn a_rule_that_does_not_fit_the_mission_is_told_where() {
    let unreadable = |rule: &str| match found(ROVER, rule).outcome {
        Outcome::Unreadable { column, message } => (column, message),
        other => panic!("{other:?}"),
    };
    assert_eq!(
        unreadable("Mast=OFF"),
        (6, "`OFF` is not a value of `Mast`; `Mast` is one of UP, DOWN".to_owned())
    );
    assert_eq!(unreadable("Mäst=UP").0, 1);
    let none = "scenario S[0,5] = { delay[9,9] }";
    assert_eq!(found(none, "never Drive").outcome, Outcome::NoPlan);
}

#[test]
fn the_missions_of_the_paper() {
    holds(SCENARIO, "PATH1=OK while Group-Traverse-Path");
    holds(SCENARIO, "PROCEED!=OK while Group-Wait");
    holds(MISSION, "Rover1.at=TAI_POS at end of Group-Traverse-Path");
    broken(MISSION, "Rover1.at=BASE at end", "from 660 to 800, with scenario#1.end");
}

#[test]
fn nature_has_the_last_word() {
    let source = "primitive Drive() contingent [5,9]; primitive Talk()[3,3];
        scenario S[0,30] = { Drive(), { delay[9,9]; Talk() } }";
    holds(source, "never Drive while Talk");
    assert!(matches!(
        found(&source.replace("[5,9]", "[5,10]"), "never Drive while Talk").outcome,
        Outcome::Broken(_)
    ));
}

#[test]
fn a_state_that_nothing_changes_is_as_it_is_declared() {
    let source = "state MAST : {DOWN, UP} = UP; state ARM : {STOWED, OUT} = STOWED; location A (0, 0);
        location B (9, 9); vehicle Rover : ATRV at A; primitive Deploy()[2,3] sets ARM=OUT;
        scenario M[0,20] = { delay; Deploy(); delay }";
    for rule in
        ["MAST=UP", "never MAST=DOWN", "MAST=UP while Deploy", "Rover.at=A", "never Rover.at=B at end"]
    {
        holds(source, rule);
    }
    broken(source, "MAST=DOWN at end", "from 2 to 20, with scenario#1.end");
    broken(source, "never Deploy while MAST=UP", "from 0 to 20, after Deploy#1.start, before Deploy#1.end");
    assert_eq!(found(source, "never Deploy while MAST=DOWN").outcome, Outcome::NeverApplies);
}

#[test]
fn two_bounds_on_one_level_are_held_against_each_execution() {
    // Any of the three may have come: 60, 55, 50, 45, 40, 35, 30 in some order.
    let source = "resource Battery 0..100 = 60; primitive A()[1,1] consumes Battery 5;
        primitive B()[1,1] consumes Battery 10; primitive C()[1,1] consumes Battery 15;
        scenario S[0,40] = { { delay; A(); delay }, { delay; B(); delay }, { delay; C(); delay } }";
    holds(source, "never (Battery > 50 and Battery < 55)");
    holds(source, "Battery <= 60 and Battery >= 30");
    for (rule, level) in [
        ("never (Battery > 50 and Battery < 60)", 55),
        ("never (Battery >= 45 and Battery < 50)", 45),
        ("never (Battery < 40 and Battery > 30)", 35),
    ] {
        let Outcome::Broken(words) = found(source, rule).outcome else { panic!("{rule}") };
        assert!(words.ends_with(&format!("Battery is {level}")), "{rule}: {words}");
    }
    // Of two resources at once, too: what takes from one gives to the other.
    let both = "resource Battery 0..100 = 60; resource Memory 0..100 = 0;
        primitive A()[0,0] consumes Battery 5 produces Memory 7;
        primitive B()[0,0] consumes Battery 10 produces Memory 1;
        scenario S[0,40] = { { delay; A(); delay[1,40] }, { delay; B(); delay[1,40] } }";
    holds(both, "never (Battery <= 50 and Battery > 45 and Memory > 1)");
    assert!(matches!(found(both, "never (Battery < 60 and Memory < 7)").outcome, Outcome::Broken(_)));
}
