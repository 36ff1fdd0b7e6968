//! Rules of missions, proven or broken; and random missions, whose plans are all listed and held against the rule.

use std::collections::BTreeMap;

use super::super::evaluate_plan;
use super::super::oracle::Chance;
use super::*;
use crate::tests::snapshot;

fn proven(source: &str, rule: &str) -> Proven {
    let snapshot = snapshot(source);
    let network = snapshot.network.as_deref().expect("a network");
    let mission =
        Mission { program: &snapshot.program, network, plan: snapshot.plan().map(|plan| (network, plan)) };
    let rule = MissionRule { name: "R".into(), rule: rule.into(), ..MissionRule::default() };
    prove(mission, &rule, Effort { alternatives: ALTERNATIVES, stop: &mut || false, with_paths: None })
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

/// How the plans of a mission stand to a rule, by listing them: the worst of all.
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
    while decided < 600 {
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
    assert!(seen.get("open").is_none_or(|count| *count < 12), "{seen:?}");
}
