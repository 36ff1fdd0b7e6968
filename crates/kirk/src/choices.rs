//! What a plan chooses.

use tpn::{DecisionId, LabelId};
use typed_index_collections::TiVec;

/// What a plan chose.
#[derive(Clone, Debug, Default)]
pub(crate) struct Choices {
    /// The alternative of each decision, where one is given.
    pub(crate) alternatives: TiVec<DecisionId, Option<u32>>,
    /// The assertion that carries each requirement, by label, where one is given.
    pub(crate) carriers: TiVec<LabelId, Option<LabelId>>,
    /// Times that fit, by node.
    pub(crate) times: Vec<i64>,
}
