//! From a text to a network, and to plans that have been checked.

use kirk::{Options, Outcome, Search, Status, Unlimited};
use rmpl::{Diagnostic, Severity};
use tpn::{Network, Plan, Top};

/// Reads and compiles `text`; the diagnostics of both stages, each mistake told once.
pub fn compile(text: &str, top: &Top) -> (Option<Network>, Vec<Diagnostic>) {
    let parsed = rmpl::parse(text);
    let mut diagnostics = parsed.diagnostics();
    let (network, compiled) = tpn::compile(&parsed.program(), top);
    tpn::merge_diagnostics(&mut diagnostics, compiled);
    let has_error = diagnostics.iter().any(|found| found.severity == Severity::Error);
    (network.filter(|_| !has_error), diagnostics)
}

/// The network of the first scenario of `text`, which must have no errors.
pub fn network(text: &str) -> Network {
    let (network, diagnostics) = compile(text, &Top::Scenario(None));
    network.unwrap_or_else(|| panic!("{text}\ndoes not compile: {diagnostics:#?}"))
}

/// The codes of the errors in `text`, compiled for its first scenario.
pub fn error_codes(text: &str) -> Vec<&'static str> {
    let (_, diagnostics) = compile(text, &Top::Scenario(None));
    let errors = diagnostics.iter().filter(|found| found.severity == Severity::Error);
    errors.map(|found| found.code.0).collect()
}

/// The codes of the warnings in `text`.
pub fn warning_codes(text: &str) -> Vec<&'static str> {
    let (_, diagnostics) = compile(text, &Top::Scenario(None));
    let warnings = diagnostics.iter().filter(|found| found.severity == Severity::Warning);
    warnings.map(|found| found.code.0).collect()
}

/// Every distinct plan, as `search` finds them; each is checked, and so is its earliest schedule.
pub fn all_plans(network: &Network, search: Search) -> Outcome {
    try_plans(network, search, true).unwrap_or_else(|problem| panic!("{problem}"))
}

/// The first plan; checked, and so is its earliest schedule.
pub fn first_plan(network: &Network, search: Search) -> Outcome {
    try_plans(network, search, false).unwrap_or_else(|problem| panic!("{problem}"))
}

/// All plans or the first one, or what the checker has against them.
pub fn try_plans(network: &Network, search: Search, all: bool) -> Result<Outcome, String> {
    let options =
        Options { search, all, max_plans: 100_000, explain: false, relax: false, ..Options::default() };
    let outcome = kirk::plan(network, &options, &mut Unlimited);
    if !matches!(outcome.status, Status::Plan | Status::NoPlan) {
        return Err(format!("planning ends with {:?}", outcome.status));
    }
    outcome.plans.iter().try_for_each(|plan| sound(network, plan))?;
    Ok(outcome)
}

/// Whether the checker accepts `plan` and its earliest schedule.
pub fn sound(network: &Network, plan: &Plan) -> Result<(), String> {
    let checks = [
        ("plan", verify::check_plan(network, plan)),
        ("earliest schedule", verify::check_schedule(network, plan, &verify::earliest_schedule(plan))),
    ];
    for (what, verdict) in checks {
        if !verdict.valid {
            let messages: Vec<String> =
                verdict.violations.into_iter().map(|violation| violation.message).collect();
            return Err(format!("the checker refuses the {what}: {}", messages.join("; ")));
        }
    }
    Ok(())
}

/// What makes plans distinct, by name: choices, causal links, order of conflicts (README of the conformance cases).
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PlanKey {
    /// `D1=0`, …
    pub choices: Vec<String>,
    pub links: Vec<(String, String)>,
    /// First and then.
    pub conflicts: Vec<(String, String)>,
}

/// The key of a plan; `rename` maps names of events and intervals first.
pub fn key(network: &Network, plan: &Plan, rename: &dyn Fn(String) -> String) -> PlanKey {
    let label = |label| rename(network.label_name(label));
    let mut links: Vec<_> =
        plan.causal_links.iter().map(|link| (label(link.ask), label(link.tell))).collect();
    let mut conflicts: Vec<_> =
        plan.conflict_order.iter().map(|order| (label(order.first), label(order.then))).collect();
    links.sort();
    conflicts.sort();
    let choice =
        |choice: &tpn::Choice| format!("{}={}", Network::decision_name(choice.decision), choice.alternative);
    PlanKey { choices: plan.choices.iter().map(choice).collect(), links, conflicts }
}
