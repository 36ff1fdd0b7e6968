//! The first plan in textual order of a mission in which only nature is demanding, where it is controllable as it is.

use tpn::{Network, Plan};

use crate::answer;
use crate::demanding;
use crate::model::Model;
use crate::options::{Options, Outcome, Stats, Termination};
use crate::structure::Relation;
use crate::unplannable::Unplannable;

/// Looks for the first plan as if the executive chose all durations: none that comes before it in textual order is
/// controllable, so that it is the first of these, too, if it is controllable. `None` where it is not, where it cannot be
/// found soon, or where conditions are kept apart by more than the structure of the program: by times that nature moves.
pub(crate) fn first_plan(
    network: &Network,
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, Unplannable> {
    let is_one_asked_for = !options.all && options.best <= 1 && options.trace_events.is_none();
    if !is_one_asked_for || !demanding::is_only_natures(model) || !model.has_contexts {
        return Ok(None);
    }
    let outcome = answer::first_soon(model, options, termination)?;
    let is_controllable = outcome.as_ref().and_then(|outcome| outcome.plans.first()).is_some_and(|plan| {
        is_ordered_by_structure(model, plan) && withstands_nature(network, plan, termination) == Some(true)
    });
    Ok(outcome.filter(|_| is_controllable))
}

fn is_ordered_by_structure(model: &Model, plan: &Plan) -> bool {
    plan.conflict_order.iter().all(|order| model.nested_order(order.first, order.then) == Relation::Before)
}

/// `None` if nobody knows.
fn withstands_nature(network: &Network, plan: &Plan, termination: &mut dyn Termination) -> Option<bool> {
    let scale = controllability::scale(network).ok()?;
    let precedences = plan.precedences(network);
    let faced = controllability::plan_network(network, &plan.selected_arcs, &precedences, scale).ok()?;
    let mut stop = || termination.should_stop(&Stats::default());
    let refutation = faced.refute(network.controllability, &mut stop).ok()?;
    Some(refutation.is_none())
}

#[cfg(test)]
mod tests {
    use tpn::compile::{Top, compile};
    use tpn::families::nested;

    use crate::options::{Options, Status, Unlimited};

    /// A record is made by the solver alone: its plan has the same choices, and there is none where there is none.
    #[test]
    fn the_first_plan_in_textual_order_is_the_solvers() {
        let (mut plans, mut none) = (0, 0);
        for seed in 0..120 {
            let text = nested(12 + seed as usize % 30, -10 + 25 * (seed as i64 % 5), seed);
            // Nature chooses every second activity's duration.
            let mut parts = text.split("Work()[").enumerate();
            let first = parts.next().map_or("", |(_, first)| first).to_owned();
            let text = parts.fold(first, |text, (count, part)| {
                text + if count % 2 == 0 { "Work() contingent [" } else { "Work()[" } + part
            });
            let (network, _) = compile(&rmpl::parse(&text).program(), &Top::Scenario(None));
            let Some(network) = network else { continue };
            let quick = Options { explain: false, relax: false, ..Options::default() };
            let recorded = Options { trace_events: Some(100_000), ..quick };
            let [found, expected] =
                [quick, recorded].map(|options| crate::plan(&network, &options, &mut Unlimited));
            assert_eq!(found.status, expected.status, "{text}");
            let choices = |outcome: &crate::Outcome| outcome.plans.first().map(|plan| plan.choices.clone());
            assert_eq!(choices(&found), choices(&expected), "{text}");
            for plan in &found.plans {
                let verdict = verify::check_plan(&network, plan);
                assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
            }
            *if found.status == Status::Plan { &mut plans } else { &mut none } += 1;
        }
        assert!(plans > 20 && none > 5, "{plans} have a plan and {none} have none");
    }
}
