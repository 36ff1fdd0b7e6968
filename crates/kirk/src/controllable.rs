//! The first plan in textual order of a mission in which only nature is demanding, where it is controllable as it is.

use tpn::{Network, Plan};

use crate::answer;
use crate::demanding;
use crate::model::Model;
use crate::options::{Options, Outcome, Stats, Termination};
use crate::overflow::TimeOverflow;
use crate::structure::Relation;

/// Looks for the first plan as if the executive chose all durations: none that comes before it in textual order is
/// controllable, so that it is the first of these, too, if it is controllable. `None` where it is not, where it cannot be
/// found soon, or where conditions are kept apart by more than the structure of the program: by times that nature moves.
pub(crate) fn first_plan(
    network: &Network,
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, TimeOverflow> {
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
