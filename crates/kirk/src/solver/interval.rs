//! Labeled intervals, and what lies between two of them.

use super::literal::{Literal, Variable};

/// A labeled interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    pub(crate) start: Variable,
    pub(crate) end: Variable,
    pub(crate) presence: Literal,
    /// The least that it lasts.
    pub(crate) duration: i64,
}

/// The gap between two intervals that exclude each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum DueGap {
    /// They may touch.
    Never,
    /// As long as it is assumed that none touch.
    Assumed,
    Always,
}
