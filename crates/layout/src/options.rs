//! What a drawing shows and how wide its parts may get.

use std::collections::BTreeSet;

use tpn::BlockId;

/// What a drawing of a network shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Blocks whose inside is hidden behind a box.
    pub collapsed: BTreeSet<BlockId>,
    /// Whether activities show the arguments of their call.
    pub arguments: bool,
    /// Whether arcs that happen at once show their `[0,0]`.
    pub zero_bounds: bool,
    /// Names longer than this are cut with an ellipsis.
    pub longest_name: f64,
    /// Space kept under events and decisions for their time windows; wider windows are written smaller.
    /// Zero keeps none.
    pub window_width: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            collapsed: BTreeSet::new(),
            arguments: true,
            zero_bounds: true,
            longest_name: 230.0,
            window_width: 52.0,
        }
    }
}
