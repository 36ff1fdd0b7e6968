//! The independent checker of plans and schedules (SPEC 5.5, 10 to 13), written from the definitions; it shares no planning
//! code.
//!
//! Every check is made against the network and the plan as data. Distances come from a plain Bellman–Ford and from
//! Dijkstra rows over exact integers, so that a mistake of the planner's own propagation cannot hide itself here.

mod amounts;
mod antichain;
mod controllability;
mod departure;
mod distance;
mod entailment;
mod instant;
mod labels;
mod plan;
mod schedule;
mod selection;
mod state;
mod uncertainty;

use serde::{Deserialize, Serialize};

pub use plan::check_plan;
pub use schedule::{check_schedule, earliest_schedule};

/// What the checker found.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Verdict {
    /// Whether there are no violations.
    pub valid: bool,
    /// What is wrong, in the order of the checks.
    pub violations: Vec<Violation>,
}

/// One thing that is wrong with a plan or a schedule.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Violation {
    /// The rule that is broken.
    pub rule: Rule,
    /// What is wrong, with the names of SPEC 3.2.
    pub message: String,
    /// The events it is about, as named in all output.
    pub events: Vec<String>,
    /// The labeled intervals and the uses of resources that it is about.
    pub intervals: Vec<String>,
}

/// The rules of SPEC 5.5, and those of state that lasts (SPEC 10.2), resources (SPEC 11), objectives (SPEC 12) and
/// durations that the environment chooses (SPEC 13.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// The plan does not fit the network at all: wrong sizes, unknown ids, or numbers too large to check exactly.
    Form,
    /// Start and end are selected; of a selected node all out-arcs, of a decision exactly one; nothing else.
    Selection,
    /// The selected arcs and the added constraints have no negative cycle, and no cycle of events of which each happens
    /// before the next (SPEC 10.4).
    Temporal,
    /// Every Ask lies inside a supporting Tell; of a state variable it has a producer whose value is one it allows.
    Support,
    /// Conflicting intervals do not overlap, and the plan says which comes first.
    Conflict,
    /// The reported windows are the exact ones.
    Window,
    /// A duration of a schedule is within its bounds.
    Duration,
    /// A state variable has a required value throughout, nothing else changes it meanwhile, its changes exclude each
    /// other, and their order has no circle; a movement has the time that it takes from where it starts.
    State,
    /// A resource is never used beyond its capacity, nor its level outside its range, and a plan tells how far it goes.
    Resource,
    /// Cost, reward and end of a plan are what its selection and its times make them.
    Quality,
    /// Whatever durations the environment chooses, as they are seen, execution can continue to the end.
    Controllability,
}

impl Verdict {
    fn new(violations: Vec<Violation>) -> Self {
        Self { valid: violations.is_empty(), violations }
    }
}

impl Violation {
    fn new(rule: Rule, message: impl Into<String>) -> Self {
        Self { rule, message: message.into(), events: Vec::new(), intervals: Vec::new() }
    }

    fn with_events(mut self, events: Vec<String>) -> Self {
        self.events = events;
        self
    }

    fn with_intervals(mut self, intervals: Vec<String>) -> Self {
        self.intervals = intervals;
        self
    }
}

/// The first name of a node, or its number where it has none.
fn node_name(network: &tpn::Network, node: tpn::NodeId) -> String {
    match network.nodes.get(node.index()).and_then(|node| node.events.first()) {
        Some(&event) => network.event_name(event),
        None => format!("node {}", node.0),
    }
}
