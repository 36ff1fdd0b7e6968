//! Plans held against the flight rules that are in their mission's own language (SPEC 16.1), as `enroute plan --rules` tells.

use mission::planning::Planned;
use review::flight_rule::{Finding, Outcome, Stretch, evaluate_plan};
use review::{FlightRules, Line, MissionRule, Status};
use rmpl::program::Program;
use serde_json::{Value, json};
use tpn::{Network, Plan};

use crate::commands::plan::all_plans;

/// Each rule with what was found of it, for each plan that was asked for; for none where there is no plan.
#[derive(Default)]
pub struct HeldRules {
    plans: Vec<Vec<Held>>,
}

/// A rule with what was found of it in one plan.
struct Held {
    rule: MissionRule,
    finding: Finding,
    line: Line,
}

impl HeldRules {
    /// Holds every plan that was asked for against the rules.
    pub fn new(rules: &FlightRules, program: &Program, planned: &Planned) -> Self {
        let hold = |plan: Option<(&Network, &Plan)>| -> Vec<Held> {
            let findings = evaluate_plan(program, plan, &rules.rules, &mut || false);
            let lines: Vec<Line> = rules.rules.iter().map(|rule| rule.line(&findings)).collect();
            let held = rules.rules.iter().cloned().zip(findings).zip(lines);
            held.map(|((rule, finding), line)| Held { rule, finding, line }).collect()
        };
        let mut plans: Vec<Vec<Held>> = all_plans(planned).map(|plan| hold(Some(plan))).collect();
        if plans.is_empty() {
            plans.push(hold(None));
        }
        Self { plans }
    }

    /// Returns whether no one has to look at any of them in any plan.
    pub fn are_kept(&self) -> bool {
        self.plans.iter().flatten().all(|held| held.line.status <= Status::Passed)
    }

    /// One line for each rule and plan.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (held, number) in self.plans.iter().zip(1..) {
            if self.plans.len() > 1 && !held.is_empty() {
                text.push_str(&format!("rules of plan {number} of {}\n", self.plans.len()));
            }
            for Held { line, .. } in held {
                let criterion = line.criterion.as_deref().unwrap_or_default();
                text.push_str(&format!("{}: {} [{criterion}]\n", line.status.name(), line.text));
            }
        }
        text
    }

    /// Returns what was found of each rule in the plan that keeps it the least, for other programs: `plan` is its
    /// number, from 1.
    pub fn worst_json(&self) -> Value {
        let Some(first) = self.plans.first() else { return json!([]) };
        let worst = (0..first.len()).filter_map(|rule| {
            let of_rule =
                self.plans.iter().zip(1..).filter_map(|(held, number)| Some((held.get(rule)?, number)));
            // The first of those that are alike.
            of_rule.reduce(|worst, next| if next.0.line.status > worst.0.line.status { next } else { worst })
        });
        let told = worst.map(|(held, number)| {
            let mut told = held.json();
            if self.plans.len() > 1 {
                told["plan"] = json!(number);
            }
            told
        });
        told.collect()
    }

    /// Returns what was found of each rule in each plan, in the order of the plans.
    pub fn by_plan_json(&self) -> Value {
        self.plans.iter().map(|held| held.iter().map(Held::json).collect::<Value>()).collect()
    }
}

impl Held {
    fn json(&self) -> Value {
        let Self { rule, finding, line } = self;
        let stretches = |all: &[Stretch]| all.iter().map(|it| json!([it.from, it.to])).collect::<Vec<_>>();
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
