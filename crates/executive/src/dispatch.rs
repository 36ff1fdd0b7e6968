//! What settling the time of an event of a plan comes to (SPEC 6.2).

use stn::PointId;

/// No upper bound.
pub const NEVER: i64 = i64::MAX;

/// Why an event cannot have come at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettleError {
    /// It came outside its window.
    OutOfWindow {
        /// The window's beginning, in ticks.
        earliest: i64,
        /// Its end, or [`NEVER`].
        latest: i64,
    },
    /// This event, of which nothing is known yet, must come first.
    NotYet(PointId),
    /// This event, which follows, could only come at a time that does not fit.
    Overflow(PointId),
}
