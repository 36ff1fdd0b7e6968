//! The check of what a plan is worth (SPEC 12), where the mission has costs, rewards or an objective.

use exact::Rational;
use rmpl::program::Measure;
use tpn::{Distance, ValueSet, Worth};

use super::Checker;
use crate::{Rule, Violation, departure};

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
                let expected = expected.map_or_else(|| "not an exact number".to_owned(), |it| it.to_string());
                let message = format!("the plan's {name} is {expected}, not {stated}");
                violations.push(Violation::new(Rule::Quality, message));
            }
        }
        self.check_length(violations);
    }

    /// The meters driven are those of the selected movements from where each of them starts, which are known to the
    /// millimeter, rounded up.
    fn check_length(&self, violations: &mut Vec<Violation>) {
        let (network, plan) = (self.network, self.plan);
        let terms = network.objective.iter().flat_map(|goal| &goal.terms);
        if network.distances.is_empty() || !terms.into_iter().any(|(_, measure)| *measure == Measure::Length)
        {
            return;
        }
        let movements = departure::of_plan(network, plan);
        let meters = movements.iter().filter_map(|movement| {
            let values = &network.labels[movement.before.index()].literal.values;
            let starts_there = |distance: &&Distance| {
                distance.arrival == movement.arrival && *values == ValueSet::In(vec![distance.from])
            };
            network.distances.iter().find(starts_there).map(|distance| distance.meters.to_f64())
        });
        let (sum, count) = meters.fold((0.0, 0.0), |(sum, count), meters| (sum + meters, count + 1.0));
        let stated = plan.quality.length_m;
        if (stated - sum).abs() > 0.002 * (count + 1.0) {
            let message = format!("the plan's length is {sum:.3} m, not {stated:.3} m");
            violations.push(Violation::new(Rule::Quality, message));
        }
    }
}
