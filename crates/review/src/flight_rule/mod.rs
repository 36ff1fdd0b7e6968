//! Flight rules in the mission's own language, held against every execution that a plan allows (SPEC 16.1).
//!
//! An execution is a schedule of the plan's constraints, and an instant of it is a cut: some events have come, the others
//! have not. A rule that some cut breaks is broken; one that no cut breaks holds whatever happens. What cannot be decided
//! never counts as held.

mod cases;
mod cut;
mod level;
mod meaning;

use exact::{Bound, Time};
use rmpl::Diagnostic;
use rmpl::program::Program;
use rmpl::rule::{Rule, Undeclared};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use snapshot::Snapshot;
use tpn::{Network, NodeId, OccurrenceKind, Plan};

/// A flight rule of a mission.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionRule {
    /// What it is called.
    pub name: String,
    /// What it says: see [`rmpl::rule`].
    pub rule: String,
    /// Where it comes from, such as a paragraph of the flight rules; may be empty.
    #[serde(default)]
    pub source: String,
    /// Whether somebody may acknowledge that a plan breaks it; otherwise such a plan has failed.
    #[serde(default)]
    pub waivable: bool,
}

/// What was found of a rule.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// What the rule says.
    pub rule: String,
    /// How the plan stands to it.
    pub outcome: Outcome,
    /// The times at which some execution is held against it.
    pub applies: Vec<Stretch>,
    /// The times at which some execution breaks it.
    pub breaks: Vec<Stretch>,
    /// The times at which it is not known to hold in every execution, those of `breaks` among them.
    pub open: Vec<Stretch>,
    /// The events between which that is, by name.
    pub names: Vec<String>,
    pub nodes: Vec<NodeId>,
}

/// A stretch of time, counted from the start of the mission.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stretch {
    /// It begins here.
    pub from: Time,
    /// It ends here, perhaps never.
    pub to: Bound,
}

/// How a plan stands to a rule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// No execution of the plan breaks it.
    Holds,
    /// The plan never comes to what the rule is about.
    NeverApplies,
    /// Some execution breaks it, as these words tell.
    Broken(String),
    /// The mission does not say enough to be sure of it, as these words tell.
    Unsure(String),
    /// There are too many cases to go through, or figures that are too large.
    Undecided,
    /// The rule cannot be read in this mission: the place in it, from 1, and what is wrong there.
    Unreadable {
        /// The character.
        column: u32,
        /// What is wrong.
        message: String,
    },
    NoPlan,
}

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
        findings.push(outcome.unwrap_or_else(|outcome| Finding::without_times(&rule.rule, outcome)));
    }
    findings
}

impl Finding {
    fn without_times(rule: &str, outcome: Outcome) -> Self {
        Self {
            rule: rule.to_owned(),
            outcome,
            applies: Vec::new(),
            breaks: Vec::new(),
            open: Vec::new(),
            names: Vec::new(),
            nodes: Vec::new(),
        }
    }
}

/// What is found of one rule; an outcome alone where there are no times to tell.
fn finding(
    program: &Program,
    network: &Network,
    plan: &Plan,
    text: &str,
    stop: &mut dyn FnMut() -> bool,
) -> Result<Finding, Outcome> {
    let rule = read(program, network, text).map_err(|found| unreadable(text, &found))?;
    let times = cut::Times::new(network, plan, &meaning::times_of(&rule)).ok_or(Outcome::Undecided)?;
    let mut meaning = meaning::Meaning::new(network, plan, times);
    meaning.examine(text, &rule, stop).ok_or(Outcome::Undecided)
}

/// Reads a rule in view of all that the mission has.
fn read(program: &Program, network: &Network, text: &str) -> Result<Rule, Vec<Diagnostic>> {
    let variables: Vec<SmolStr> = network.variables.iter().map(|it| it.name.clone()).collect();
    let called = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
    let activities: Vec<(SmolStr, usize)> =
        called.map(|it| (it.activity.clone(), it.arguments.len())).collect();
    let undeclared = Undeclared { variables: &variables, activities: &activities };
    rmpl::rule::read(text, program, undeclared)
}

/// What is wrong with a rule in a mission, if something is; [`Outcome::Unreadable`].
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

/// Which character of a text begins at a byte, from 1.
fn column(text: &str, at: u32) -> u32 {
    text.get(..at as usize).map_or(1, |before| before.chars().count() as u32 + 1)
}

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;
