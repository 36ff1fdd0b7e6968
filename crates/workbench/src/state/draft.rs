//! A text kept beyond the end of a run.

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// An edited text and the name of its mission.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Draft {
    /// The mission's name, without extension.
    pub name: SmolStr,
    /// Its text.
    pub source: String,
}
