//! The Kirk planner: selection, open conditions, threats, explanations and the search trace (SPEC 5).
//!
//! [`plan`] answers with plans as data (`tpn::Plan`), or with why there is none. Time is exact: bounds are scaled to
//! integers by their common denominator, and what does not fit into 64 bits is [`Status::Error`]. Nothing here checks
//! its own answers: that is `verify`'s work.

mod conditions;
mod enclosed;
mod explain;
mod failure;
mod leaf;
mod levels;
mod lookahead;
mod model;
mod options;
mod plan_network;
mod planner;
mod record;
mod relax;
mod replay;
mod search;
mod selection;
mod solution;
mod structure;
mod trace;
mod trace_lines;
mod wording;

use std::collections::BTreeSet;

use stn::Overflow;
use tpn::{Network, Plan};

pub use explain::is_conflict;
pub use failure::{Failure, FailureKind, Member, Reason, Relaxation};
pub use options::{ExpansionLimit, Options, Outcome, Search, Stats, Status, Termination, Unlimited};
pub use plan_network::{PlanNetwork, Remaining};
pub use planner::Planner;
pub use replay::{Replay, ReplayStep};
pub use trace::{Constraint, CycleMember, Entry, Event, Trace, TreeChoice, TreeNode, TreeNodeId, TreeStatus};
pub use trace_lines::trace_json_lines;

use model::Model;
use search::{Engine, Halt, Setup};

/// Plans `network`.
pub fn plan(network: &Network, options: &Options, termination: &mut dyn Termination) -> Outcome {
    let model = Model::new(network, options.threat_gap);
    let outcome = model.and_then(|model| answer(network, &model, options, termination));
    outcome.unwrap_or_else(|Overflow| Outcome::overflow())
}

fn answer(
    network: &Network,
    model: &Model,
    options: &Options,
    termination: &mut dyn Termination,
) -> Result<Outcome, Overflow> {
    let mut outcome = search(model, options, termination)?;
    if outcome.status == Status::NoPlan && options.explain {
        let mut failure = explain::explain(network, model)?;
        if options.relax {
            failure.relaxations = relax::relaxations(network, model, &failure)?;
        }
        outcome.failure = Some(failure);
    }
    Ok(outcome)
}

fn search(model: &Model, options: &Options, termination: &mut dyn Termination) -> Result<Outcome, Overflow> {
    let jumps = options.search == Search::ConflictDirected;
    let setup = Setup {
        jumps,
        by_structure: jumps,
        is_enumerating: options.all,
        trace_events: options.trace_events,
        ..Setup::default()
    };
    let mut engine = Engine::new(model, setup);
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
    Ok(Outcome {
        status,
        plans,
        failure: None,
        stats: engine.stats,
        trace: engine.recorder.take().map(|recorder| recorder.trace),
    })
}
