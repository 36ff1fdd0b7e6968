//! Rules of missions, proven or broken; and random missions, whose plans are all listed and held against the rule.

use std::collections::BTreeMap;

use super::super::evaluate_plan;
use super::super::oracle::{Chance, schedules_in_order};
use super::*;
use crate::contradict::Scheduled;
use crate::tests::snapshot;

fn proven(source: &str, rule: &str) -> Proven {
    let snapshot = snapshot(source);
    let network = snapshot.network.as_deref().expect("a network");
    let mission =
        Mission { program: &snapshot.program, network, plan: snapshot.plan().map(|plan| (network, plan)) };
    let rule = MissionRule { name: "R".into(), rule: rule.into(), ..MissionRule::default() };
    prove(mission, &rule, Effort { alternatives: ALTERNATIVES, stop: &mut || false, paths: None })
}

#[test]
fn a_rule_that_only_some_choices_break_is_broken_by_another_plan() {
    let source = "primitive A()[1,1]; primitive B()[2,2]; scenario S[0,9] = { choose { A(), B() } }";
    let found = proven(source, "never B");
    let Verdict::Broken(found) = &found.verdict else { panic!("{found:?}") };
    assert!(!found.is_own, "{found:?}");
    assert_eq!(found.text, "from 0 to 2, after B#1.start, before B#1.end");
    assert_eq!(proven(source, "never (A and B)").verdict, Verdict::Holds);
    assert_eq!(proven(source, "A at end of A").verdict, Verdict::Holds);
    assert_eq!(proven(source, "B at end of A").verdict.name(), "broken");
}

#[track_caller]
fn is(source: &str, rule: &str, verdict: &str) -> Verdict {
    let found = proven(source, rule).verdict;
    assert_eq!(found.name(), verdict, "{rule}: {}", found.sentence());
    if let Some(counterexample) = found.counterexample() {
        // The plan is one of the mission, as anybody reads it.
        let snapshot = snapshot(source);
        let network = snapshot.network.as_deref().expect("a network");
        let plan = tpn::plan_json::plan_from_json(network, &counterexample.plan).expect("a plan");
        assert!(verify::check_plan(network, &plan).valid, "{rule}");
    }
    found
}

const ROVER: &str = "state Mast : {UP, DOWN} = DOWN; var Comm : {ON, OFF}; resource Battery 0..100 = 60;
resource Power capacity 3; primitive Raise()[1,2] sets Mast=UP; primitive Lower()[1,2] sets Mast=DOWN;
primitive Short()[5,9] consumes Battery 20 uses Power; primitive Long()[8,12] consumes Battery 45 uses Power 2;
primitive Charge()[4,4] produces Battery 30; primitive Talk()[2,3] uses Power;
scenario Day[0,60] = { { Raise(); delay; Lower() }, { choose { Short(), Long() }; delay; Charge() },
  { delay; Comm=ON [3,5]; delay; choose { Talk(), Comm=OFF [1,1] } } }";

#[test]
fn every_kind_of_condition_is_negated() {
    // Levels: which alternative is chosen, and what has come.
    is(ROVER, "Battery >= 15", "holds");
    is(ROVER, "Battery >= 16", "broken");
    is(ROVER, "Battery <= 70", "holds");
    is(ROVER, "Battery < 70 at end", "broken");
    is(ROVER, "Battery >= 15 at start of Charge", "holds");
    is(ROVER, "Power <= 3", "holds");
    is(ROVER, "Power <= 2", "broken");
    is(ROVER, "never (Battery > 20 and Battery < 40)", "holds");
    is(ROVER, "Power <= 0 from 0 to 1", "broken");
    // States, and activities that may overlap them.
    is(ROVER, "Mast=DOWN at end", "holds");
    is(ROVER, "Mast=UP while Charge", "broken");
    is(ROVER, "never Talk while Long", "broken");
    // Outside of what asserts a condition, it is not known to be false.
    is(ROVER, "never Talk while Comm=ON", "unsure");
    is(ROVER, "never Short while Long", "holds");
    is(ROVER, "never (Short and Long)", "holds");
    is(ROVER, "never Rest", "unreadable");
    // What nothing asserts is not known.
    is(ROVER, "Comm=ON or Comm=OFF", "unsure");
    is(ROVER, "Comm=ON at end", "broken");
    is(ROVER, "Mast=DOWN at start", "holds");
}

#[test]
fn what_the_environment_chooses_breaks_a_rule_but_no_plan() {
    let source = |most: u32| {
        format!(
            "primitive Drive() contingent [5,{most}]; primitive Talk()[3,3]; primitive Wait()[1,1];
             scenario S[0,30] = {{ Drive(), {{ delay[9,9]; choose {{ Talk(), Wait() }} }} }}"
        )
    };
    is(&source(9), "never Drive while Talk", "holds");
    is(&source(10), "never Drive while Talk", "broken");
    // Where the environment may drive longer than there is time, there is no such plan.
    let tight = "primitive Drive() contingent [5,10]; primitive Short()[1,1]; primitive Talk()[3,3];
        scenario S[0,12] = { Drive(); choose { Short(), Talk() } }";
    is(tight, "never Talk", "holds");
    is(tight, "never Short", "broken");
    // With a gap as well.
    let gap = "option threat_gap = 1; var C : {ON, OFF}; primitive Drive() contingent [5,10];
        scenario S[0,40] = { { Drive(); C=ON [2,3] }, { delay; C=OFF [2,2]; delay } }";
    is(gap, "never C=OFF while Drive", "broken");
    is(gap, "never (C=ON and C=OFF)", "unsure");
}

#[test]
fn a_mission_without_a_plan_and_a_search_that_is_stopped_prove_nothing() {
    is("primitive A()[9,9]; scenario S[0,5] = { A() }", "never A", "no-plan");
    let snapshot = snapshot(ROVER);
    let network = snapshot.network.as_deref().expect("a network");
    let plan = snapshot.plan().map(|plan| (network, plan));
    let mission = Mission { program: &snapshot.program, network, plan };
    let rule = MissionRule { rule: "Battery >= 15".into(), ..MissionRule::default() };
    let effort = Effort { alternatives: ALTERNATIVES, stop: &mut || true, paths: None };
    assert_eq!(prove(mission, &rule, effort).verdict.name(), "open");
}

/// Returns how the plans of a mission stand to a rule, by listing them: the worst of all.
fn worst(snapshot: &snapshot::Snapshot, network: &Network, rule: &str) -> Option<&'static str> {
    const MAX_PLANS: usize = 60;
    let options = Options { all: true, max_plans: MAX_PLANS, ..OPTIONS };
    let listed = kirk::plan(network, &options, &mut kirk::ExpansionLimit(20_000));
    if listed.status != Status::Plan || listed.plans.len() >= MAX_PLANS {
        return None;
    }
    let rules = [MissionRule { name: "R".into(), rule: rule.into(), ..MissionRule::default() }];
    let of = |plan: &Plan| {
        let finding =
            evaluate_plan(&snapshot.program, Some((network, plan)), &rules, &mut || false).remove(0);
        match finding.outcome {
            Outcome::NeverApplies => 0,
            Outcome::Holds => 1,
            Outcome::Unsure(_) => 2,
            Outcome::Broken(_) => 3,
            other => panic!("{other:?}"),
        }
    };
    let worst = listed.plans.iter().map(of).max()?;
    Some(["never-applies", "holds", "unsure", "broken"][worst])
}

#[test]
fn a_proof_agrees_with_the_list_of_all_plans() {
    let mut chance = Chance(7);
    let (mut decided, mut seen) = (0, BTreeMap::new());
    while decided < 1_200 {
        let has_uses = chance.below(2) == 0;
        let mut statement = |chance: &mut Chance| {
            let plain = |chance: &mut Chance| loop {
                let statement = chance.statement();
                let is_user = ["Drive", "Charge", "Store", "Talk"].iter().any(|it| statement.starts_with(it));
                if has_uses || !is_user {
                    break if chance.below(6) == 0 && statement.ends_with(']') {
                        statement.replace('[', " contingent [")
                    } else {
                        statement
                    };
                }
            };
            match chance.below(3) {
                0 => format!("choose {{ {}, {} }}", plain(chance), plain(chance)),
                _ => plain(chance),
            }
        };
        let source = chance.mission_of(&mut statement);
        let gap = chance.below(2);
        let source = source.replace("threat_gap = 0", &format!("threat_gap = {gap}"));
        let snapshot = snapshot(&source);
        let (Some(network), Some(_)) = (snapshot.network.as_deref(), snapshot.plan()) else { continue };
        for _ in 0..6 {
            let rule = chance.rule();
            let Some(expected) = worst(&snapshot, network, &rule) else { break };
            let found = proven(&source, &rule).verdict;
            // Plans that differ only in the order of uses are listed once, and each of them counts.
            let is_stricter = !network.uses.is_empty() && found.counterexample().is_some();
            let is_right = found.name() == expected || (is_stricter && expected != "broken");
            let is_open = matches!(found, Verdict::Open(_));
            assert!(is_right || is_open, "{rule} is {expected}, not {}\n{source}", found.sentence());
            *seen.entry(found.name()).or_insert(0) += 1;
            decided += 1;
        }
    }
    for verdict in ["never-applies", "holds", "broken", "unsure"] {
        assert!(seen.get(verdict).is_some_and(|count| *count > 10), "{seen:?}");
    }
    assert!(seen.get("open").is_none_or(|count| *count < 24), "{seen:?}");
}

/// A mission with choices, of statements that use resources.
fn mission_of_uses(chance: &mut Chance) -> String {
    chance.mission_of(&mut |chance: &mut Chance| match chance.below(4) {
        0 => format!("choose {{ {}, {} }}", chance.statement(), chance.statement()),
        _ => chance.statement(),
    })
}

/// What is proven is held against every schedule in whole ticks of everything that can be chosen, whatever plan it is of: uses
/// of resources may come in any order.
#[test]
fn what_is_proven_no_schedule_breaks() {
    let mut chance = Chance(11);
    let (mut kept, mut tried) = (0, 0);
    while kept < 400 {
        let source = mission_of_uses(&mut chance);
        let snapshot = snapshot(&source);
        let (Some(network), Some(_)) = (snapshot.network.as_deref(), snapshot.plan()) else { continue };
        let options = Options { all: true, max_plans: 60, ..OPTIONS };
        let listed = kirk::plan(network, &options, &mut kirk::ExpansionLimit(20_000));
        // One plan of each selection tells what is selected.
        let mut selections: Vec<&Plan> = Vec::new();
        for plan in &listed.plans {
            if selections.iter().all(|known| known.choices != plan.choices) {
                selections.push(plan);
            }
        }
        let schedules: Option<Vec<_>> =
            selections.iter().map(|plan| schedules_in_order(network, plan, &[])).collect();
        let Some(schedules) = schedules.filter(|_| listed.status == Status::Plan) else { continue };
        for _ in 0..4 {
            let text = chance.rule();
            let verdict = proven(&source, &text).verdict;
            if !matches!(verdict, Verdict::Holds | Verdict::NeverApplies) {
                continue;
            }
            kept += 1;
            let rule = read(&snapshot.program, network, &text).expect("a rule");
            for (plan, times) in selections
                .iter()
                .zip(&schedules)
                .flat_map(|(plan, all)| all.iter().map(move |times| (*plan, times)))
            {
                let times: Vec<Option<Time>> =
                    times.iter().map(|&at| (at >= 0).then(|| Time::from(at))).collect();
                let scheduled = Scheduled {
                    program: &snapshot.program,
                    network,
                    plan,
                    times: &times,
                    is_extreme: false,
                    log: None,
                };
                let breach = scheduled.first_breach(&rule);
                if breach.is_some() {
                    let checked = verify::check_schedule(network, plan, &times);
                    assert!(!checked.valid, "{text} at {breach:?} of {times:?}\n{source}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 10_000, "{tried}");
}
