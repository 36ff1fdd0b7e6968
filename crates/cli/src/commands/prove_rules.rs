//! `enroute prove --rules`: the flight rules of a mission that hold in every plan.

use exact::counted;
use std::path::Path;
use std::process::ExitCode;

use mission::Manner;
use review::flight_rule::proof::{Counterexample, Proven, Verdict};
use review::{FlightRules, MissionRule};
use serde_json::{Value, json};
use tpn::Choice;

use crate::commands::report::read_rules;
use crate::deadline::{Deadline, TimeIsUp, Undecided};
use crate::diagnostics::print_problems;
use crate::output::{
    E_LIMIT, E_TIME, Format, LIMIT, NO, YES, document, escaped, exit, failure, print_json, print_text,
};
use crate::save::{refuse_input, save};
use crate::target::Target;

/// What is to be proven, and how.
pub(super) struct Call<'a> {
    pub(super) target: &'a Target,
    pub(super) rules: &'a Path,
    /// Where the first plan goes that violates a rule.
    pub(super) output: Option<&'a Path>,
    pub(super) alternatives: u64,
    pub(super) seed: u64,
    pub(super) format: Format,
}

/// Runs the command for a mission.
pub(super) fn run(call: &Call<'_>, deadline: Deadline) -> anyhow::Result<ExitCode> {
    let FlightRules { rules, .. } = read_rules(call.rules)?;
    call.output.map_or(Ok(()), refuse_input)?;
    let mut mission = call.target.open()?;
    let compiled = mission.compile()?;
    let mut problems = compiled.problems();
    if compiled.network().is_none() {
        return mission.refuse(&problems, call.format, ("prove", json!({ "rules": [] })));
    }
    let ground = mission.ground(&compiled)?;
    let manner = Manner { seed: call.seed, ..Manner::unexplained() };
    let evaluated = mission.plan(compiled, ground, manner, deadline)?;
    let mut proven: Vec<(MissionRule, Proven)> = Vec::new();
    for rule in rules {
        let found = mission.core.prove_rule(&evaluated, &rule, call.alternatives, &mut || deadline.is_over());
        proven.push((rule, found));
    }
    let verdicts = || proven.iter().map(|(_, found)| &found.verdict);
    let is_broken = verdicts().any(|verdict| !verdict.is_kept() && !verdict.is_open());
    let is_undecided = verdicts().any(Verdict::is_open);
    let counterexample = proven.iter().find_map(|(_, found)| found.verdict.counterexample());
    if let (Some(path), Some(found)) = (call.output, counterexample) {
        let body = json!({ "plans": [found.plan], "schedule": found.script.schedule });
        let plan = serde_json::to_string_pretty(&document("plan", &[], body))?;
        save(path, &format!("{}\n", escaped(&plan)))?;
    }
    match call.format {
        Format::Json => {
            let rules = proven.iter().map(|(rule, found)| rule_json(rule, found));
            let body = json!({ "rules": rules.collect::<Vec<_>>() });
            if is_undecided && !is_broken {
                let code = if deadline.is_over() { E_TIME } else { E_LIMIT };
                problems.push(failure(code, Undecided::Proof.in_words()));
            }
            print_json(&document("prove", &problems, body))?;
        }
        Format::Text => {
            print_problems(&mission.name, &mission.source, &problems)?;
            print_text(&evaluated.planned.network.readable(&text(&proven)))?;
            if is_undecided && deadline.is_over() {
                return Err(TimeIsUp(Undecided::Proof).into());
            }
        }
    }
    Ok(exit(if is_broken {
        NO
    } else if is_undecided {
        LIMIT
    } else {
        YES
    }))
}

fn rule_json(rule: &MissionRule, proven: &Proven) -> Value {
    let mut told = json!({
        "name": rule.name,
        "rule": rule.rule,
        "source": rule.source,
        "verdict": proven.verdict.name(),
        "text": proven.verdict.sentence(),
        "alternatives": proven.alternatives,
    });
    if let Some(found) = proven.verdict.counterexample() {
        told["counterexample"] = json!({
            "own": found.is_own,
            "text": found.text,
            "plan": found.plan,
            "schedule": found.script.schedule,
        });
    }
    told
}

fn text(proven: &[(MissionRule, Proven)]) -> String {
    let alternatives: u64 = proven.iter().map(|(_, found)| found.alternatives).sum();
    let tried = counted(alternatives, "alternative");
    let mut out = format!("Searched {tried} for plans that violate a rule.\n");
    for (rule, found) in proven {
        let word = if found.verdict.is_open() { "open" } else { found.verdict.name() };
        out.push_str(&format!("{word:<13}  {}: {}\n", rule.name, rule.rule));
        if !found.verdict.is_kept() {
            out.push_str(&format!("  {}\n", found.verdict.sentence()));
        }
        out.extend(found.verdict.counterexample().map(counterexample_text));
    }
    out
}

fn counterexample_text(found: &Counterexample) -> String {
    let choice = |&Choice { decision, alternative }: &Choice| format!("D{}={alternative}", decision.0 + 1);
    let choices: Vec<String> = found.choices.iter().map(choice).collect();
    let mut out = String::new();
    if !choices.is_empty() {
        out.push_str(&format!("  choices   {}\n", choices.join(", ")));
    }
    let mut times: Vec<_> = found.script.schedule.iter().collect();
    times.sort_by_key(|&(name, time)| (time, name));
    out.push_str("  schedule\n");
    out.extend(times.iter().map(|(name, time)| format!("    {:>9}  {name}\n", time.readable())));
    out
}
