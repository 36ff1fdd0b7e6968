//! What a drawing shows and how wide its parts may get.

use std::collections::BTreeSet;

use tpn::BlockId;

use crate::metrics::TextRole;

/// What a drawing of a network shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Blocks whose inside is hidden behind a box.
    pub collapsed: BTreeSet<BlockId>,
    /// What else is hidden behind boxes, because it is finer than this.
    pub detail: Detail,
    /// Sequences longer than this are broken into rows, as text is into lines.
    pub row_width: f64,
    /// Whether activities show the arguments of their call.
    pub arguments: bool,
    /// Whether arcs that only say what comes at once or later show their `[0,0]` and `[0,∞]`.
    pub zero_bounds: bool,
    /// Whether arcs show what they change of states (`Set`) and what holds at first (`Init`).
    pub changes: bool,
    /// How much is written at arcs.
    pub written: Written,
    /// Conditions go on the line of the bounds up to this width, or that of the name above if it is wider.
    pub easy_line: f64,
    /// No text is smaller than this.
    pub min_text: f64,
    /// Names longer than this are cut with an ellipsis.
    pub longest_name: f64,
    /// Space kept under events and decisions for their time windows; wider windows are written smaller.
    /// Zero keeps none.
    pub window_width: f64,
}

/// Names are cut to so many points of the screen where less is written.
const SHORT_NAME: f64 = 88.0;

/// How much is written at arcs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Written {
    /// What they are called, their bounds and their conditions.
    Everything,
    /// The same, of delays only the bounds.
    Short,
    /// What they are called, or else their bounds.
    Names,
}

/// A level of detail: blocks and neighbors that hold no more steps of the program than this are one box.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Detail {
    /// How many steps a box may hold; with 0 there are none.
    pub grain: u32,
    /// Where it is finer; of those that a block lies in, the last one counts.
    pub finer: Vec<Finer>,
}

/// Neighbors in a sequence or among branches that are open, and drawn in more detail than what is around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Finer {
    pub first: BlockId,
    pub last: BlockId,
    /// How many steps a box inside may hold.
    pub grain: u32,
}

impl Options {
    /// The size of a text of this role.
    pub(crate) fn text_size(&self, role: TextRole) -> f64 {
        role.size().max(self.min_text)
    }

    /// The same with no more written than a drawing in little room needs, in texts of at least `min_text`.
    pub(crate) fn brief(&self, min_text: f64) -> Self {
        Self {
            arguments: false,
            zero_bounds: false,
            changes: false,
            easy_line: 200.0,
            min_text,
            ..self.clone()
        }
    }

    /// The same for a drawing at this zoom with no more written than `written`.
    pub(crate) fn shortened(&self, written: Written, zoom: f64) -> Self {
        let longest = if written == Written::Everything { self.longest_name } else { SHORT_NAME };
        Self { written, longest_name: longest / zoom, ..self.clone() }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            collapsed: BTreeSet::new(),
            detail: Detail::default(),
            row_width: f64::INFINITY,
            arguments: true,
            zero_bounds: true,
            changes: true,
            written: Written::Everything,
            easy_line: 130.0,
            min_text: 0.0,
            longest_name: 260.0,
            window_width: 52.0,
        }
    }
}
