//! The lines of a review under trial.

use review::contradict::{Effort, Trial};
use review::record::LineKey;

/// A trial, and what it belongs to: the revision of the text, the one line that is tried, and how much is tried.
pub(crate) struct Trying {
    pub(crate) of: (u64, Option<LineKey>, Effort),
    pub(crate) trial: Trial,
}
