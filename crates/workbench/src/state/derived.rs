//! What was computed from which changes of the state; `acts::derived` has the table.

use std::collections::BTreeMap;
use std::sync::Arc;

use snapshot::Snapshot;

/// Something that is computed from inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Derivation {
    /// What the language knows about the text.
    Language,
    /// The rows of the text that are folded away.
    Folding,
    /// Whether the text is a control program, which the core is to run then.
    Program,
    /// The conflicts of the current step of the program.
    Conflicts,
    /// Selection, pins, search, trees and picture, carried over to what is shown now.
    Shown,
    /// What the present content is called, and what of it has been reviewed.
    Review,
    /// Where time ends.
    Extent,
    /// What has happened of the run at the time shown.
    Moment,
    /// What the stop of a lesson shows, and whether its task is done.
    Lesson,
    /// What the core is asked besides plans.
    Questions,
}

/// What was computed from which changes of its inputs.
#[derive(Debug, Default)]
pub struct Derived {
    /// By row, the changes of its inputs that it was last computed from.
    pub(crate) seen: BTreeMap<Derivation, Vec<u64>>,
    /// What was computed after the last command, answer or moment, in order.
    pub(crate) latest: Vec<Derivation>,
    /// The snapshot that selection, pins, search and trees belong to.
    pub(crate) shown: Option<Arc<Snapshot>>,
    /// The name of what was selected until an edit took it away.
    pub(crate) lost_selection: Option<String>,
    /// The revision and the place of a new statement that was drawn: it is selected once the revision is planned.
    pub(crate) made: Option<(u64, u32)>,
}

impl Derived {
    /// Returns what was computed after the last command, answer or moment, in order.
    pub fn latest(&self) -> &[Derivation] {
        &self.latest
    }
}
