//! What a plan is worth, in the words of people (SPEC 12): its cost, its reward and what its mission's objective counts.

use std::cmp::Ordering;

use crate::{Network, Plan};
use exact::Rational;
use rmpl::program::Measure;

/// Returns what matters of the plans of a network: what the objective counts, and costs and rewards that some activity
/// has.
pub fn measures(network: &Network) -> Vec<Measure> {
    let counted = |measure: Measure| {
        let terms = network.objective.iter().flat_map(|goal| &goal.terms);
        let is_goal = terms.into_iter().any(|(_, it)| *it == measure);
        let is_given = network.worths.iter().any(|worth| match measure {
            Measure::Cost => !worth.cost.is_zero() || !worth.cost_per_meter.is_zero(),
            Measure::Reward => !worth.reward.is_zero(),
            Measure::End | Measure::Length => false,
        });
        is_goal || is_given
    };
    let all = [Measure::Cost, Measure::Reward, Measure::End, Measure::Length];
    all.into_iter().filter(|&measure| counted(measure)).collect()
}

/// Returns what a plan comes to in one measure: `cost 30`, `end 45`.
pub fn figure(plan: &Plan, measure: Measure) -> String {
    let quality = &plan.quality;
    match measure {
        Measure::Cost => format!("cost {}", quality.cost.readable()),
        Measure::Reward => format!("reward {}", quality.reward.readable()),
        Measure::End => format!("end {}", quality.end.readable()),
        Measure::Length => format!("{:.1} m driven", quality.length_m),
    }
}

/// All that a plan is worth, in one line; `None` where its mission counts nothing.
pub fn words(network: &Network, plan: &Plan) -> Option<String> {
    let figures: Vec<String> = measures(network).into_iter().map(|it| figure(plan, it)).collect();
    (!figures.is_empty()).then(|| figures.join(", "))
}

/// Returns what a plan comes to in each goal of its mission's objective, with so many meters driven, rounded up to the
/// millimeter; `None` where a number does not fit.
pub fn goal_values(network: &Network, plan: &Plan, driven_m: f64) -> Option<Vec<Rational>> {
    let quality = &plan.quality;
    let value = |measure: Measure| match measure {
        Measure::Cost => Some(quality.cost),
        Measure::Reward => Some(quality.reward),
        Measure::End => Some(quality.end.units()),
        Measure::Length => rounded_up(driven_m),
    };
    let add = |sum: Rational, &(factor, measure): &(Rational, Measure)| {
        sum.checked_add(factor.checked_mul(value(measure)?)?)
    };
    network.objective.iter().map(|goal| goal.terms.iter().try_fold(Rational::ZERO, add)).collect()
}

/// Meters as numbers that plans are weighed by: to the millimeter, rounded up.
pub fn rounded_up(length_m: f64) -> Option<Rational> {
    Rational::from_f64_up(length_m, 1000)
}

/// Whether one plan is better than another by its mission's objective, with the meters that each drives.
pub fn compare(network: &Network, one: &Plan, other: &Plan) -> Ordering {
    let [left, right] = [one, other].map(|plan| goal_values(network, plan, plan.quality.length_m));
    let (Some(left), Some(right)) = (left, right) else { return Ordering::Equal };
    let each = network.objective.iter().zip(left).zip(right);
    let orders =
        each.map(|((goal, left), right)| if goal.is_maximized { right.cmp(&left) } else { left.cmp(&right) });
    orders.fold(Ordering::Equal, Ordering::then)
}

/// Whether a plan is known to be the best, in words; `None` without an objective.
pub const fn standing(plan: &Plan) -> Option<&'static str> {
    match plan.quality.is_optimal {
        Some(true) => Some("optimal: no better plan exists"),
        Some(false) => Some("not proven optimal: a better plan may exist"),
        None => None,
    }
}
