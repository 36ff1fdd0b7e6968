//! Lines that promise too much are contradicted, and those of the examples are not.

use exact::{Bound, Rational, Time};
use snapshot::Goal;

use super::super::tests::{MISSION, SCENARIO, snapshot};
use super::super::{FlightRules, MissionRule, Outcome, Review, Section, review};
use super::{Trial, Tried};

/// The lines of a mission as they were tried, after `change` has changed its review.
fn tried(source: &str, rules: &[&str], change: impl FnOnce(&mut Review)) -> Vec<Tried> {
    let snapshot = snapshot(source);
    let mut reviewed = review(&snapshot, &Goal::Default, 0, &mut || false);
    let named = rules.iter().enumerate().map(|(at, rule)| MissionRule {
        name: format!("R{at}"),
        rule: (*rule).to_owned(),
        ..MissionRule::default()
    });
    let rules = FlightRules { rules: named.collect(), ..FlightRules::default() };
    reviewed.hold_against(&snapshot, &rules, None, &mut || false);
    change(&mut reviewed);
    let mut trial = Trial::new(&snapshot, &reviewed).expect("a plan");
    trial.try_schedules(100, 1, &mut || false);
    trial.into_tried()
}

/// The lines of a section that were contradicted, and those that survived.
fn outcomes(tried: &[Tried], section: Section) -> [usize; 2] {
    let of = tried.iter().filter(|it| it.section == section && it.schedules > 0);
    let (contradicted, survived): (Vec<&Tried>, Vec<&Tried>) = of.partition(|it| it.counterexample.is_some());
    [contradicted.len(), survived.len()]
}

const OPEN: &str = "state Mast : {UP, DOWN} = DOWN; resource Battery 0..100 = 60; var Sun : {UP, SET};
primitive Raise()[1,2] sets Mast=UP; primitive Drive()[5,9] consumes Battery 20;
primitive Talk()[2,3] requires Mast=UP, Sun=UP;
scenario Day[0,60] = { { Raise(); delay; Talk(); Drive() }, { delay; Drive() }, { Sun=UP [50,50] } }";

#[test]
fn a_line_that_promises_too_much_is_contradicted() {
    let rules = ["Battery >= 20", "Mast=UP while Talk"];
    let honest = tried(OPEN, &rules, |_| {});
    assert!(honest.iter().all(|it| it.counterexample.is_none()), "{honest:?}");
    for section in [Section::Plan, Section::CausalLinks, Section::Resources, Section::MissionRules] {
        assert!(outcomes(&honest, section)[1] > 0, "{section:?}: {honest:?}");
    }
    let levels = tried(OPEN, &rules, |review| {
        review.resources[0].levels =
            tpn::Levels::Range { low: Rational::from_integer(40), high: Rational::from_integer(60) };
    });
    assert_eq!(outcomes(&levels, Section::Resources), [1, 0]);
    let margins = tried(OPEN, &rules, |review| {
        for link in &mut review.causal_links {
            link.margin.greatest = Bound::Finite(Time::ONE);
            link.lead.greatest = Bound::ZERO;
        }
    });
    let [contradicted, _] = outcomes(&margins, Section::CausalLinks);
    assert!(contradicted > 0, "{margins:?}");
    // What is taken for held and is not.
    let rule = tried(OPEN, &["Battery > 20"], |review| {
        review.findings[0].outcome = Outcome::Holds;
        let rules = review.rules.clone();
        review.judge(&rules, None);
    });
    assert_eq!(outcomes(&rule, Section::MissionRules), [1, 0]);
    let found = rule.iter().find_map(|it| it.counterexample.as_ref()).expect("a counterexample");
    let time = |name: &str| found.schedule.iter().find(|(it, _)| it == name).map(|(_, time)| *time);
    let both = [time("Drive#1.start"), time("Drive#2.start")].into_iter().max().flatten();
    assert_eq!(
        Some(found.text.clone()),
        both.map(|at| format!("it is not known to hold at {}", at.readable()))
    );
}

#[test]
fn no_schedule_contradicts_what_the_reviews_of_examples_have_passed() {
    let examples: [(&str, &[&str]); 6] = [
        (MISSION, &["PATH1=OK while Group-Traverse-Path", "never Group-Wait while PROCEED=OK"]),
        (SCENARIO, &["PROCEED!=OK while Group-Wait"]),
        (
            include_str!("../../../../assets/missions/arm.rmpl"),
            &["ARM=OUT while Dig", "never Drive while ARM=OUT"],
        ),
        (include_str!("../../../../assets/missions/battery.rmpl"), &["Battery >= 10", "Battery <= 100"]),
        (include_str!("../../../../assets/missions/storm.rmpl"), &["RELAY=UP while Send"]),
        (include_str!("../../../../assets/missions/sol.rmpl"), &["RELAY=UP while Downlink", "Memory <= 400"]),
    ];
    for (source, rules) in examples {
        let found = tried(source, rules, |_| {});
        assert!(found.iter().any(|it| it.schedules == 100), "{found:?}");
        let contradicted: Vec<&Tried> = found.iter().filter(|it| it.counterexample.is_some()).collect();
        assert!(contradicted.is_empty(), "{contradicted:?}");
    }
}
