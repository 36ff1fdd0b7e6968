//! What planning is asked for, when it must stop, and what it answers.

use exact::{Rational, Time};
use serde::{Deserialize, Serialize};
use tpn::{Network, Plan};

use crate::failure::Failure;
use crate::trace::Trace;
use crate::unplannable::Unplannable;

/// How to search. Both list the same plans where all are asked for, and say of the same missions that they have none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Search {
    /// The paper's: on failure undo the last choice (SPEC 5.1 to 5.4). Its first plan is the canonical one.
    Chronological,
    /// Learns from each failure what caused it, jumps back to where that was chosen, and never repeats it (SPEC 5.6).
    /// It begins in the order of the text, and finds the canonical plan where that takes few steps back; otherwise
    /// a solver that learns about links, orderings and times as well finds a valid plan, the same one each time.
    #[default]
    ConflictDirected,
    /// Of all states that are open the one continues whose goals may still become best (A*, SPEC 12), so that the first
    /// plan is an optimal one. Keeps all open states: for missions small enough to look on. Without an objective, or
    /// where there are too many states, and for lists of plans, as [`Search::ConflictDirected`].
    BestFirst,
}

impl Search {
    /// All of them, the paper's first.
    pub const ALL: [Self; 3] = [Self::Chronological, Self::ConflictDirected, Self::BestFirst];

    /// Its name on the command line and in documents.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Chronological => "chronological",
            Self::ConflictDirected => "conflict-directed",
            Self::BestFirst => "best-first",
        }
    }

    /// Returns whether it learns from failures.
    pub(crate) const fn learns(self) -> bool {
        matches!(self, Self::ConflictDirected | Self::BestFirst)
    }
}

/// What planning is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Options {
    /// How to search.
    pub search: Search,
    /// The least gap between ordered intervals; the network's own if `None` (SPEC 5.3).
    pub threat_gap: Option<Time>,
    /// Every distinct plan instead of the first one.
    pub all: bool,
    /// How many plans to stop at, if `all`.
    pub max_plans: usize,
    /// So many plans that differ in their choices, the best first; without an objective, those found first (SPEC 12).
    pub best: usize,
    /// Whether to record the search, and how many events at most.
    pub trace_events: Option<usize>,
    /// Which search is recorded, if not the one that plans: it runs after that one, until the record is full. A network that
    /// only the solver plans has one search, and that is recorded.
    pub traced: Option<Search>,
    /// Whether to explain why there is no plan, if there is none.
    pub explain: bool,
    /// Whether to look for bounds whose relaxation gives a plan, if there is none; needs `explain`.
    pub relax: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            search: Search::default(),
            threat_gap: None,
            all: false,
            max_plans: 10_000,
            best: 1,
            trace_events: None,
            traced: None,
            explain: true,
            relax: true,
        }
    }
}

/// Decides when a search must stop without an answer. Asked once per alternative tried.
pub trait Termination {
    /// Returns whether to stop now.
    fn should_stop(&mut self, stats: &Stats) -> bool;
}

/// Searches to the end.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unlimited;

impl Termination for Unlimited {
    fn should_stop(&mut self, _: &Stats) -> bool {
        false
    }
}

/// Stops after so many alternatives have been tried.
#[derive(Clone, Copy, Debug)]
pub struct ExpansionLimit(pub u64);

impl Termination for ExpansionLimit {
    fn should_stop(&mut self, stats: &Stats) -> bool {
        stats.expanded >= self.0
    }
}

impl<F: FnMut(&Stats) -> bool> Termination for F {
    fn should_stop(&mut self, stats: &Stats) -> bool {
        self(stats)
    }
}

/// How much work a search was.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stats {
    /// Nodes of the network.
    pub nodes: u64,
    /// Arcs of the network.
    pub arcs: u64,
    /// Decisions of the network.
    pub decisions: u64,
    /// Alternatives tried: of decisions, links and orderings.
    pub expanded: u64,
    /// Choice points returned to.
    pub backtracks: u64,
    /// Choice points jumped over on the way back.
    pub jumped_over: u64,
    /// Failures that the search met.
    pub conflicts: u64,
    /// Nogoods learned.
    pub nogoods: u64,
    /// Complete choices whose conditions and threats were looked at.
    pub leaves: u64,
    /// Causal links tried.
    pub links_tried: u64,
    pub orderings_tried: u64,
}

/// How planning ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    Plan,
    /// There is none.
    NoPlan,
    /// The termination condition stopped the search before it had an answer (or all the plans asked for).
    Limit,
    /// The network is too large ([`Unplannable`]).
    Error,
}

/// The answer to a planning problem: plans, or why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How planning ended.
    pub status: Status,
    /// The plans: none, one (of the chronological search the canonical one, SPEC 5.4), or all distinct ones in the order
    /// they were found, the canonical one first.
    pub plans: Vec<Plan>,
    /// Where the plan is not known to be optimal: what no plan is better than, in the first goal that is not proven.
    pub bound: Option<Rational>,
    /// Why there is none.
    pub failure: Option<Failure>,
    /// How much work it was.
    pub stats: Stats,
    /// The search, if it was asked for.
    pub trace: Option<Trace>,
    /// What did not fit, if that was the end of it.
    pub unplannable: Option<Unplannable>,
}

impl Outcome {
    /// The answer where something does not fit.
    pub(crate) fn of_size(what: Unplannable) -> Self {
        Self {
            status: Status::Error,
            plans: Vec::new(),
            bound: None,
            failure: None,
            stats: Stats::default(),
            trace: None,
            unplannable: Some(what),
        }
    }

    /// Returns what does not fit, in the author's terms. `None` if everything fits.
    pub fn unplannable_message(&self, network: &Network) -> Option<String> {
        self.unplannable.map(|what| what.message(network))
    }
}
