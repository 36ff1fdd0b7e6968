//! The check of what a plan is worth (SPEC 12), where the mission has costs, rewards or an objective.

use exact::Rational;
use tpn::Worth;

use super::Checker;
use crate::{Rule, Violation};

impl Checker<'_> {
    /// Cost and reward are the sums over what is selected, the end is the earliest one. That no plan is better is not
    /// checked.
    pub(super) fn check_quality(&self, violations: &mut Vec<Violation>) {
        let (network, plan) = (self.network, self.plan);
        if network.worths.is_empty() && network.objective.is_empty() {
            return;
        }
        let selected = || network.worths.iter().filter(|worth| plan.selected_arcs[worth.arc.index()]);
        let sum =
            |of: fn(&Worth) -> Rational| selected().map(of).try_fold(Rational::ZERO, Rational::checked_add);
        let end = self.window(network.end.index()).map(|window| window.earliest.units());
        for (name, stated, expected) in [
            ("cost", plan.quality.cost, sum(|worth| worth.cost)),
            ("reward", plan.quality.reward, sum(|worth| worth.reward)),
            ("end", plan.quality.end.units(), end),
        ] {
            if expected != Some(stated) {
                let expected = expected.map_or_else(|| "no exact number".to_owned(), |it| it.to_string());
                let message = format!("the plan's {name} is {expected}, not {stated}");
                violations.push(Violation::new(Rule::Quality, message));
            }
        }
    }
}
