//! What a search is asked for, and how it comes to a halt.

use tpn::{DecisionId, LabelId};
use typed_index_collections::TiVec;

/// What a search is like.
#[derive(Clone, Debug, Default)]
pub(crate) struct Setup {
    /// Jump back over choices that have nothing to do with the failure, and learn.
    pub(crate) jumps: bool,
    pub(crate) gaps: Gaps,
    /// Take the choices made before as they are, and look for a contradiction once all are made.
    pub(crate) is_checking: bool,
    /// Use the program's structure for phase 1 if there is one; otherwise arcs are propagated as they are selected.
    pub(crate) by_structure: bool,
    /// Keep what every failure rests on.
    pub(crate) records_failures: bool,
    /// Whether the search goes on after a plan, so that going back does not mean failure.
    pub(crate) is_enumerating: bool,
    pub(crate) trace_events: Option<usize>,
    /// Labels that count; all if `None`. Assertions that do not count still support.
    pub(crate) active_labels: Option<TiVec<LabelId, bool>>,
    /// What has been chosen before.
    pub(crate) assumed: Option<Choices>,
    /// Order conflicting pairs that the times given leave less than the gap after all others, which may then order them
    /// without a gap; otherwise in textual order, as SPEC 5.4 does.
    pub(crate) orders_touching_last: bool,
    /// Whether conflicting pairs may be ordered at once by a schedule, and the search may stop where that fails.
    pub(crate) schedules: bool,
    /// Times that are likely to fit, by node; it only saves work. None if empty.
    pub(crate) proposed: Vec<i64>,
}

/// What a plan chose.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choices {
    /// The alternative of each decision, where one is given.
    pub(crate) alternatives: TiVec<DecisionId, Option<u32>>,
    /// The assertion that carries each requirement, by label, where one is given; empty if all are open.
    pub(crate) carriers: TiVec<LabelId, Option<LabelId>>,
    /// Times by node that tell how conflicting pairs are ordered; empty if that is open.
    pub(crate) times: Vec<i64>,
}

/// What a search makes of orders that fail only because of the gap they ask for, but would hold by touching if other
/// choices forced the intervals to (SPEC 5.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Gaps {
    /// Such a failure rests on every choice made, since none of them forces it.
    #[default]
    Exact,
    /// No choice is expected to: the failure rests on what contradicts the gap. Finds only plans, but may miss some.
    Trusted,
    /// Orders ask for no more than touching: where this finds nothing, there is no plan.
    Ignored,
}

/// How a search came to a halt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Halt {
    Solution,
    Exhausted,
    Stopped,
}
