//! From a prepared network to an answer: one search, or several where the first one proves nothing.

use tpn::{Choice, Network};

use crate::failure::{Failure, FailureKind, Reason};
use crate::model::Model;
use crate::nature_run::nature_run;
use crate::options::{Options, Outcome, Status, Termination};
use crate::unplannable::Unplannable;
use crate::{chronological, explain, relax, solver_search};

/// Plans, or explains why there is no plan.
pub(crate) fn answer(
    network: &Network,
    model: &Model,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Result<Outcome, Unplannable> {
    let traced = options.traced.unwrap_or(options.search);
    if options.trace_events.is_some() && traced != options.search && !solver_search::has_demands(model) {
        let unrecorded = Options { trace_events: None, ..*options };
        let outcome = answer(network, model, &unrecorded, excluded, termination)?;
        let recorded = Options { search: traced, ..*options };
        let trace = search(network, model, &recorded, excluded, termination)?.trace;
        return Ok(Outcome { trace, ..outcome });
    }
    let mut outcome = search(network, model, options, excluded, termination)?;
    let is_full = outcome.trace.as_ref().is_some_and(|trace| trace.is_truncated);
    if outcome.status == Status::Limit && is_full && !is_by_solver(model, options, excluded) {
        // What is recorded stops when the record is full: the answer is up to a search that need not be recorded.
        let unrecorded = Options { trace_events: None, ..*options };
        let trace = outcome.trace.take();
        outcome = answer(network, model, &unrecorded, excluded, termination)?;
        outcome.trace = trace;
        return Ok(outcome);
    }
    if outcome.status == Status::NoPlan && options.explain && excluded.is_empty() {
        let mut failure = explain::explain(network, model, &[], termination);
        if options.relax {
            failure.relaxations = relax::relaxations(network, model, &failure, termination)?;
            failure.is_of_gap = relax::has_plan_without_gap(network, model, options, termination)?;
            add_failing_run(&mut failure, network, options, termination);
        }
        outcome.failure = Some(failure);
    }
    Ok(outcome)
}

/// Searches once, in the way that is asked for.
fn search(
    network: &Network,
    model: &Model,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Result<Outcome, Unplannable> {
    if is_by_solver(model, options, excluded) {
        solver_search::search(network, model, options, excluded, termination)
    } else {
        chronological::search(network, model, options, excluded, termination)
    }
}

fn is_by_solver(model: &Model, options: &Options, excluded: &[Vec<Choice>]) -> bool {
    solver_search::has_demands(model)
        || model.has_contexts && (options.search.learns() || options.best > 1 || !excluded.is_empty())
}

/// Gives the first of the environment's reasons that the run belongs to the run in which it fails.
fn add_failing_run(
    failure: &mut Failure,
    network: &Network,
    options: &Options,
    termination: &mut dyn Termination,
) {
    let is_natures = |reason: &&mut Reason| reason.kind == FailureKind::Controllability;
    if failure.reasons.iter_mut().any(|reason| is_natures(&reason))
        && let Some((choices, run)) = nature_run(network, options.threat_gap, termination)
    {
        let is_its = |reason: &&mut Reason| reason.choices.iter().all(|choice| choices.contains(choice));
        if let Some(reason) = failure.reasons.iter_mut().filter(is_natures).find(is_its) {
            reason.failing_run = Some(run);
        }
    }
}

#[cfg(test)]
mod tests {
    use exact::Time;
    use tpn::compile::{Top, compile};
    use tpn::families::{chain, long_requirements, nested, open_shop, pigeonholes, symmetric};
    use tpn::generate::{Recipe, Tightness, mission};

    use super::*;
    use crate::options::{ExpansionLimit, Search, Unlimited};

    fn network(text: &str) -> Network {
        let (network, diagnostics) = compile(&rmpl::parse(text).program(), &Top::Scenario(None));
        network.unwrap_or_else(|| panic!("does not compile: {diagnostics:?}\n{text}"))
    }

    /// The solver says that there is a plan exactly where the paper's search does, and its plans are plans.
    #[test]
    fn the_solver_agrees_with_the_chronological_search() {
        let mut texts = Vec::new();
        for seed in 0..150 {
            texts.extend([90, 110, 150].map(|percent| nested(20 + seed as usize % 30, percent, seed)));
            texts.extend([70, 85, 100].map(|percent| long_requirements(3, 3, seed, percent)));
            texts.push(open_shop(2, 95 + seed as i64 % 12, seed));
            for tightness in [Tightness::Feasible, Tightness::Boundary, Tightness::Infeasible] {
                texts.push(mission(Recipe { nodes: 30 + seed as usize % 40, tightness, seed }));
            }
        }
        texts.extend([pigeonholes(4, 0), pigeonholes(4, 1), symmetric(3, 2, 0), symmetric(3, 2, 1)]);
        texts.extend([chain(5, true), chain(5, false)]);
        let (mut plans, mut none) = (0, 0);
        for text in &texts {
            for gap in [None, Some(Time::from(1))] {
                let network = network(text);
                let chronological = Options {
                    search: Search::Chronological,
                    threat_gap: gap,
                    explain: false,
                    relax: false,
                    ..Options::default()
                };
                let expected = crate::plan(&network, &chronological, &mut ExpansionLimit(20_000));
                if expected.status == Status::Limit {
                    continue;
                }
                let options = Options { search: Search::ConflictDirected, ..chronological };
                let outcome = crate::plan(&network, &options, &mut Unlimited);
                assert_eq!(outcome.status, expected.status, "gap {gap:?}\n{text}");
                let mut network = network;
                network.threat_gap = gap.unwrap_or(network.threat_gap);
                for plan in &outcome.plans {
                    let verdict = verify::check_plan(&network, plan);
                    assert!(verdict.violations.is_empty(), "{verdict:?}\n{text}");
                }
                *if outcome.plans.is_empty() { &mut none } else { &mut plans } += 1;
            }
        }
        assert!(plans > 300 && none > 300, "{plans} have a plan and {none} have none");
    }
}
