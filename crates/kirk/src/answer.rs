//! From a prepared network to an answer: one search, or several where the first one proves nothing.

use std::collections::BTreeSet;

use stn::Overflow;
use tpn::{Network, Plan};

use crate::model::Model;
use crate::options::{Options, Outcome, Search, Stats, Status, Termination};
use crate::search::{Choices, Engine, Gaps, Halt, Setup};
use crate::trace::Event;
use crate::{explain, relax, solution};

/// Plans, or explains why there is no plan; also, whether gaps alone made something fail on the way.
pub(crate) fn answer(
    network: &Network,
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Overflow> {
    let (mut outcome, mut has_doubts) = searched(model, options, termination)?;
    if outcome.trace.as_ref().is_some_and(|trace| trace.is_truncated) && outcome.status == Status::Limit {
        // What is recorded is searched step by step as the paper does, and stops when the record is full: the answer is
        // up to a search that may take the shortcuts.
        let unrecorded = Options { trace_events: None, ..*options };
        let trace = outcome.trace.take();
        (outcome, has_doubts) = searched(model, &unrecorded, termination)?;
        outcome.trace = trace;
    }
    if outcome.status == Status::NoPlan && options.explain {
        let mut failure = explain::explain(network, model)?;
        if options.relax {
            failure.relaxations = relax::relaxations(network, model, &failure)?;
        }
        outcome.failure = Some(failure);
    }
    Ok((outcome, has_doubts))
}

fn searched(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Overflow> {
    if options.search == Search::ConflictDirected && !options.all {
        first_plan(model, options, termination)
    } else {
        run(model, options, (Gaps::Exact, Stats::default()), termination)
    }
}

/// The plan with these choices, if there is one, and if a search that trusts gaps would find it, too. Leaves in
/// `proposed` times that fit it; where times that nearly fit are there before, it takes less work.
pub(crate) fn with_choices(
    model: &Model,
    choices: &Choices,
    proposed: &mut Vec<i64>,
    termination: &mut dyn Termination,
) -> Result<Option<Outcome>, Overflow> {
    if !model.has_contexts {
        return Ok(None);
    }
    let setup = Setup {
        jumps: true,
        is_checking: true,
        assumed: Some(choices.clone()),
        proposed: std::mem::take(proposed),
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
    if engine.run(termination)? != Halt::Solution || engine.has_doubts || !engine.has_room_for_gaps()? {
        return Ok(None);
    }
    let plan = solution::plan_at(&mut engine)?;
    let stats = engine.stats;
    *proposed = engine.leaf.schedule;
    Ok(Some(Outcome { status: Status::Plan, plans: vec![plan], failure: None, stats, trace: None }))
}

/// The first plan that a search finds which expects no choice to force intervals to touch. Where it finds none and has
/// doubts, one without gaps may show that there is none, and otherwise one that blames every choice decides.
fn first_plan(
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Overflow> {
    let (mut outcome, has_doubts) = run(model, options, (Gaps::Trusted, Stats::default()), termination)?;
    if outcome.status != Status::NoPlan || !has_doubts {
        return Ok((outcome, has_doubts));
    }
    // The search without gaps is no part of a trace, which is of one search with the rules as they are.
    if options.trace_events.is_none() {
        let (without_gaps, _) = run(model, options, (Gaps::Ignored, outcome.stats), termination)?;
        if without_gaps.status != Status::Plan {
            return Ok((without_gaps, true));
        }
        outcome = without_gaps;
    }
    run(model, options, (Gaps::Exact, outcome.stats), termination)
}

/// One search, after others with `stats`, and whether it has doubts that there is nothing where it found nothing.
fn run(
    model: &Model,
    options: &Options,
    (gaps, stats): (Gaps, Stats),
    termination: &mut dyn Termination,
) -> Result<(Outcome, bool), Overflow> {
    let jumps = options.search == Search::ConflictDirected;
    let setup = Setup {
        jumps,
        gaps,
        by_structure: jumps,
        is_enumerating: options.all,
        trace_events: options.trace_events,
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
    engine.stats = Stats {
        nodes: engine.stats.nodes,
        arcs: engine.stats.arcs,
        decisions: engine.stats.decisions,
        ..stats
    };
    let mut plans: Vec<Plan> = Vec::new();
    let mut known = BTreeSet::new();
    let status = loop {
        match engine.run(termination)? {
            Halt::Exhausted if plans.is_empty() => break Status::NoPlan,
            Halt::Exhausted => break Status::Plan,
            Halt::Stopped => break Status::Limit,
            Halt::Solution => {
                let plan = solution::plan_at(&mut engine)?;
                if !options.all {
                    plans.push(plan);
                    break Status::Plan;
                }
                let key = (plan.choices.clone(), plan.causal_links.clone(), plan.conflict_order.clone());
                if known.insert(key) {
                    let number = plans.len() as u32;
                    engine.log(|_| Event::Solution { plan: number });
                    plans.push(plan);
                }
                if plans.len() >= options.max_plans {
                    break Status::Limit;
                }
            }
        }
    };
    if status == Status::Plan && !options.all {
        engine.log(|_| Event::Solution { plan: 0 });
    }
    let outcome = Outcome {
        status,
        plans,
        failure: None,
        stats: engine.stats,
        trace: engine.recorder.take().map(|recorder| recorder.trace),
    };
    Ok((outcome, engine.has_doubts))
}
