//! What differs between two plans, by name: of two missions, of two revisions of one, or of plans saved as JSON.
//!
//! Nothing here plans: a [`Side`] is made from a snapshot that was worked out, or from a plan's JSON alone.

mod differences;
mod side;

use serde::{Deserialize, Serialize};
use tpn::Window;

pub use differences::compare;
pub use side::{Item, Side, SideError, Taken, Way};

/// What differs, and both plans side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What differs: choices first, then what happens in order of time, then conditions, orderings and paths.
    pub differences: Vec<Difference>,
    /// Everything that either plan has, in order of time.
    pub rows: Vec<Row>,
    /// The paths of either plan, in order of their names.
    pub paths: Vec<PathPair>,
}

/// One difference.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Difference {
    /// What happened to it.
    pub change: Change,
    /// What kind of thing it is.
    pub subject: Subject,
    /// Its name in all output: `Group-Wait#1`, `D1`, `Ask(PATH1=OK)@Group-Traverse-Path#1`.
    pub name: String,
    /// What the first plan says of it, if it has it.
    pub before: Option<String>,
    /// What the second plan says of it, if it has it.
    pub after: Option<String>,
}

/// What happened to a thing from the first plan to the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Only the second plan has it.
    Added,
    /// Only the first plan has it.
    Removed,
    /// It may happen at other times.
    Moved,
    /// It was decided otherwise: another alternative, another assertion that carries a condition, the other order.
    Rechosen,
    /// It is done otherwise: with other arguments, along another path.
    Changed,
}

impl Change {
    /// All, in the order in which they are counted.
    pub const ALL: [Self; 5] = [Self::Added, Self::Removed, Self::Moved, Self::Rechosen, Self::Changed];

    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Added => "added",
            Self::Removed => "removed",
            Self::Moved => "moved",
            Self::Rechosen => "re-chosen",
            Self::Changed => "changed",
        }
    }
}

/// What kind of thing differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Subject {
    /// A decision of the plan.
    Choice,
    /// A primitive activity.
    Activity,
    /// An activity that consists of others, or the whole scenario.
    Phase,
    Condition,
    Delay,
    /// A requirement with the assertion that carries it.
    Link,
    /// Two conflicting intervals in their order.
    Ordering,
    /// How far a resource is used, or what the plan is worth.
    Figure,
    /// The way of a traverse.
    Path,
}

impl Subject {
    /// The word for it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Choice => "choice",
            Self::Activity => "activity",
            Self::Phase => "phase",
            Self::Condition => "condition",
            Self::Delay => "delay",
            Self::Link => "link",
            Self::Ordering => "ordering",
            Self::Figure => "figure",
            Self::Path => "path",
        }
    }
}

/// Something that happens in either plan, with its times in both.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub name: String,
    pub subject: Subject,
    /// What happened to it; nothing if both plans have it at the same times.
    pub change: Option<Change>,
    /// When the first plan lets it start and end.
    pub before: Option<[Window; 2]>,
    /// When the second plan lets it start and end.
    pub after: Option<[Window; 2]>,
}

/// The way of a traverse in both plans.
#[derive(Clone, Debug, PartialEq)]
pub struct PathPair {
    pub name: String,
    /// Its way in the first plan.
    pub before: Option<Way>,
    /// Its way in the second plan.
    pub after: Option<Way>,
}

impl Comparison {
    /// Returns how many differences there are of each kind, in the order of [`Change::ALL`].
    pub fn counts(&self) -> [usize; 5] {
        Change::ALL.map(|change| self.differences.iter().filter(|it| it.change == change).count())
    }

    /// Returns whether the plans are the same in everything that is compared.
    pub fn is_same(&self) -> bool {
        self.differences.is_empty()
    }

    /// The counts in words: `2 added, 1 moved`; `no differences`.
    pub fn summary(&self) -> String {
        let counted = Change::ALL.into_iter().zip(self.counts()).filter(|(_, count)| *count > 0);
        let words: Vec<String> =
            counted.map(|(change, count)| format!("{count} {}", change.name())).collect();
        if words.is_empty() { "no differences".to_owned() } else { words.join(", ") }
    }
}

impl Difference {
    /// In one sentence, for people.
    pub fn sentence(&self) -> String {
        let subject = self.subject.name();
        let what = format!("{subject} {} {}", self.name, self.change.name());
        match (&self.before, &self.after) {
            (Some(before), Some(after)) => format!("{what}: {before} → {after}"),
            (Some(only), None) | (None, Some(only)) => format!("{what}: {only}"),
            (None, None) => what,
        }
    }
}

/// The windows of a start and an end, for people.
pub fn windows_text([start, end]: [Window; 2]) -> String {
    let interval = |window: Window| format!("[{}, {}]", window.earliest.readable(), window.latest.readable());
    format!("starts {}, ends {}", interval(start), interval(end)).replace("inf", "∞")
}

#[cfg(test)]
mod tests;
