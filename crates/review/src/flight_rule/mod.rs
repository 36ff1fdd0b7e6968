//! Flight rules in the mission's own language, held against every execution that a plan allows (SPEC 16.1).
//!
//! An execution is a schedule of the plan's constraints, and an instant of it is a cut: some events have come, the others
//! have not. A rule that some cut breaks is broken; one that no cut breaks holds whatever happens. What cannot be decided
//! never counts as held.

mod cases;
mod cut;
mod finding;
mod level;
mod meaning;
pub mod proof;

use rmpl::Diagnostic;
use rmpl::program::Program;
use rmpl::rule::{Rule, Undeclared};
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::{Network, OccurrenceKind, Plan};

use super::place::place_of_rule;

pub use finding::{Finding, MissionRule, Outcome, Stretch};

/// Holds the plan of a snapshot against rules, one after the other; `stop` says when to leave the others undecided.
pub fn evaluate(snapshot: &Snapshot, rules: &[MissionRule], stop: &mut dyn FnMut() -> bool) -> Vec<Finding> {
    let plan = snapshot.planning.as_deref().and_then(|planning| planning.outcome.plans.first());
    let planned = snapshot.network.as_deref().zip(plan);
    evaluate_plan(&snapshot.program, planned, rules, stop)
}

/// Holds a plan, if there is one, against the rules of its mission.
pub fn evaluate_plan(
    program: &Program,
    planned: Option<(&Network, &Plan)>,
    rules: &[MissionRule],
    stop: &mut dyn FnMut() -> bool,
) -> Vec<Finding> {
    let mut findings = Vec::with_capacity(rules.len());
    for rule in rules {
        let outcome = match planned {
            Some(_) if stop() => Err(Outcome::Undecided),
            Some((network, plan)) => finding(program, network, plan, &rule.rule, stop),
            None => Err(Outcome::NoPlan),
        };
        let mut found = outcome.unwrap_or_else(|outcome| Finding::without_times(&rule.rule, outcome));
        if let Some((network, _)) = planned
            && matches!(found.outcome, Outcome::Broken(_) | Outcome::Unsure(_) | Outcome::Undecided)
        {
            found.place = place_of_rule(network, &rule.rule);
        }
        findings.push(found);
    }
    findings
}

/// Returns what is found of one rule; an outcome alone where there are no times to tell.
fn finding(
    program: &Program,
    network: &Network,
    plan: &Plan,
    text: &str,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Finding, Outcome> {
    let rule = read(program, network, text).map_err(|found| unreadable(text, &found))?;
    let times = cut::Times::new(network, plan, &meaning::times_of(&rule)).ok_or(Outcome::Undecided)?;
    let mut meaning = meaning::Meaning::new(program, network, plan, times);
    meaning.examine(text, &rule, stop).map(|(finding, _)| finding).ok_or(Outcome::Undecided)
}

/// Reads a rule in view of all that the mission has.
pub(super) fn read(program: &Program, network: &Network, text: &str) -> Result<Rule, Vec<Diagnostic>> {
    let variables: Vec<SmolStr> = network.variables.iter().map(|it| it.name.clone()).collect();
    let called = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
    let activities: Vec<(SmolStr, usize)> =
        called.map(|it| (it.activity.clone(), it.arguments.len())).collect();
    let sights: Vec<rmpl::rule::Sight> = network
        .sights
        .iter()
        .map(|sight| rmpl::rule::Sight {
            variable: network.variables[sight.variable.index()].name.clone(),
            location: sight.location.clone(),
            places: network.seen_from(sight),
        })
        .collect();
    let undeclared = Undeclared { variables: &variables, activities: &activities, sights: &sights };
    rmpl::rule::read(text, program, undeclared)
}

/// Returns what is wrong with a rule in a mission, if something is; [`Outcome::Unreadable`].
pub fn problem(program: &Program, network: &Network, text: &str) -> Option<Outcome> {
    read(program, network, text).err().map(|found| unreadable(text, &found))
}

fn unreadable(text: &str, found: &[Diagnostic]) -> Outcome {
    let first = found.first();
    let hint = first.and_then(|it| it.hint.as_ref()).map(|hint| format!("; {hint}"));
    Outcome::Unreadable {
        column: first.map_or(1, |it| column(text, it.span.start)),
        message: first.map(|it| format!("{}{}", it.message, hint.unwrap_or_default())).unwrap_or_default(),
    }
}

/// Returns which character of a text begins at a byte, from 1.
fn column(text: &str, at: u32) -> u32 {
    text.get(..at as usize).map_or(1, |before| before.chars().count() as u32 + 1)
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
