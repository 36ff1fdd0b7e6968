//! A plan held against the flight rules that are in its mission's own language (SPEC 16.1), as `enroute plan --rules` tells.

use mission::planning::Planned;
use review::flight_rule::{Finding, Outcome, Stretch, evaluate_plan};
use review::{FlightRules, Line, MissionRule, Status};
use rmpl::program::Program;
use serde_json::{Value, json};

/// Each rule with what was found of it.
#[derive(Default)]
pub struct HeldRules {
    held: Vec<(MissionRule, Finding, Line)>,
}

impl HeldRules {
    /// Holds the first plan that was found against the rules.
    pub fn new(rules: &FlightRules, program: &Program, planned: &Planned) -> Self {
        let plan = planned.planning.outcome.plans.first().map(|plan| (planned.network.as_ref(), plan));
        let findings = evaluate_plan(program, plan, &rules.rules, &mut || false);
        let lines = rules.rules.iter().map(|rule| rule.line(&findings));
        let lines: Vec<Line> = lines.collect();
        let held = rules.rules.iter().cloned().zip(findings).zip(lines);
        Self { held: held.map(|((rule, finding), line)| (rule, finding, line)).collect() }
    }

    /// Whether nobody has to look at any of them.
    pub fn are_kept(&self) -> bool {
        self.held.iter().all(|(_, _, line)| line.status <= Status::Passed)
    }

    /// One line for each rule.
    pub fn text(&self) -> String {
        let line = |(_, _, line): &(MissionRule, Finding, Line)| {
            let criterion = line.criterion.as_deref().unwrap_or_default();
            format!("{}: {} [{criterion}]\n", line.status.name(), line.text)
        };
        self.held.iter().map(line).collect()
    }

    /// The same for other programs.
    pub fn json(&self) -> Value {
        let stretches = |all: &[Stretch]| all.iter().map(|it| json!([it.from, it.to])).collect::<Vec<_>>();
        let told = self.held.iter().map(|(rule, finding, line)| {
            json!({
                "name": rule.name,
                "rule": rule.rule,
                "source": rule.source,
                "status": line.status,
                "text": line.text,
                "outcome": outcome_name(&finding.outcome),
                "applies": stretches(&finding.applies),
                "breaks": stretches(&finding.breaks),
                "open": stretches(&finding.open),
            })
        });
        told.collect()
    }
}

const fn outcome_name(outcome: &Outcome) -> &'static str {
    match outcome {
        Outcome::Holds => "holds",
        Outcome::NeverApplies => "never-applies",
        Outcome::Broken(_) => "broken",
        Outcome::Unsure(_) => "unsure",
        Outcome::Undecided => "undecided",
        Outcome::Unreadable { .. } => "unreadable",
        Outcome::NoPlan => "no-plan",
    }
}
