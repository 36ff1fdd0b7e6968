//! Both searches of one network, recorded and measured, for showing side by side.

use kirk::{Search, Stats, Status, Trace};
use serde::{Deserialize, Serialize};

/// The two searches of a revision's network, with the paths that its plan needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BothSearches {
    /// The revision of the text.
    pub revision: u64,
    /// The chronological search, then the one directed by conflicts.
    pub searches: [Searched; 2],
}

/// One search, recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Searched {
    /// How it searched.
    pub search: Search,
    /// How it ended; [`Status::Limit`] when it was stopped because it took too long.
    pub status: Status,
    /// How much work it was.
    pub stats: Stats,
    /// How long it took in milliseconds, recording included, by the host's clock.
    pub millis: f64,
    pub trace: Trace,
}
