//! What of a text is to be planned.

use exact::{Bound, Time};
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// What is to be planned.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Goal {
    /// The first scenario of the file; without one, its last activity with bounds `[0,inf]`.
    #[default]
    Default,
    /// The first scenario of the file.
    FirstScenario,
    /// The scenario of this name.
    Scenario(SmolStr),
    /// An activity, with the bounds of its invocation.
    Activity {
        name: SmolStr,
        /// Least duration.
        lower: Time,
        /// Greatest duration.
        upper: Bound,
    },
}
