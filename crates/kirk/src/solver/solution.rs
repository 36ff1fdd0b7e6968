//! A solution as data: what a plan is made of.

use tpn::{DecisionId, LabelId, NodeId, StateOrder, UseId};
use typed_index_collections::TiVec;

/// What a solution chooses, and times that fit.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    pub(crate) alternatives: TiVec<DecisionId, Option<u32>>,
    /// Of variables that are known only where they are asserted: what carries each requirement.
    pub(crate) carriers: TiVec<LabelId, Option<LabelId>>,
    pub(crate) kept: Kept,
    /// Conflicting pairs that were ordered by choice, the earlier one first.
    pub(crate) orders: Vec<(LabelId, LabelId)>,
    /// Uses of resources that were, too.
    pub(crate) uses_ordered: Vec<(UseId, UseId)>,
    pub(crate) times: TiVec<NodeId, i64>,
}

/// What a solution says of variables that keep their values.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    /// What each selected requirement rests on, in textual order of the requirements.
    pub(crate) links: Vec<(LabelId, LabelId)>,
    /// What gives each variable its values, in order; only of variables that something changes.
    pub(crate) order: Vec<StateOrder>,
    /// Requirements that are over before a change that would break them, the requirement first.
    pub(crate) over_before: Vec<(LabelId, LabelId)>,
}
