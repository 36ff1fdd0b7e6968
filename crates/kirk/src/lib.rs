//! The Kirk planner: selection, open conditions, threats, explanations and the search trace (SPEC 5).
//!
//! [`plan`] answers with plans as data (`tpn::Plan`), or with why there is none. Time is exact: bounds are scaled to
//! integers by their common denominator, and what does not fit into 64 bits is [`Status::Error`], with the event where
//! that was found in [`Outcome::unplannable`]. Nothing here checks its own answers: that is `verify`'s work.

mod answer;
mod antichain;
mod choices;
mod chronological;
mod conditions;
mod demands;
mod explain;
mod failure;
mod ids;
mod instants;
mod model;
mod nature_run;
mod nesting;
mod options;
mod partial_order;
mod planner;
mod precedence;
mod relax;
mod replay;
mod rotation;
mod single_reason;
mod solver;
mod solver_search;
mod state_order;
mod structure;
mod trace;
mod trace_lines;
mod unplannable;
mod wording;

use tpn::{Choice, Network};

pub use explain::{explain_choices, is_conflict};
pub use failure::{Failure, FailureKind, GAP_LABEL, Member, NATURE_ENDS, Reason, Relaxation};
pub use options::{ExpansionLimit, Options, Outcome, Search, Stats, Status, Termination, Unlimited};
pub use planner::Planner;
pub use replay::{Replay, ReplayStep};
pub use solver_search::has_open_order;
pub use trace::{
    Constraint, CycleMember, Departing, Entry, Event, SearchRound, Trace, TreeChoice, TreeNode, TreeNodeId,
    TreeStatus,
};
pub use trace_lines::trace_json_lines;
pub use unplannable::Unplannable;
pub use wording::{after_choices, contradiction};

use answer::answer;
use model::Model;

/// Plans `network`.
///
/// ```
/// let parsed = rmpl::parse("scenario Day[0,60] = { Drive()[20,30]; delay; Dig()[5,10] }");
/// let (network, _warnings) = tpn::compile(&parsed.program(), &tpn::Top::Scenario(None));
/// let network = network.expect("nothing in it is an error");
/// let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
/// let plan = tpn::plan_json::plan_to_json(&network, &outcome.plans[0]);
/// assert_eq!(plan["windows"]["Dig#1.start"].to_string(), "[20,55]");
/// ```
pub fn plan(network: &Network, options: &Options, termination: &mut dyn Termination) -> Outcome {
    plan_except(network, options, &[], termination)
}

/// The same without the plans that make all the choices of one of `excluded`, such as those that are listed already.
pub fn plan_except(
    network: &Network,
    options: &Options,
    excluded: &[Vec<Choice>],
    termination: &mut dyn Termination,
) -> Outcome {
    let model = Model::new(network, options.threat_gap);
    let outcome = model.and_then(|model| answer(network, &model, options, excluded, termination));
    outcome.unwrap_or_else(Outcome::of_size)
}
