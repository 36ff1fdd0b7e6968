//! The rows of a timeline and the bars in them, as data.

use std::ops::Range;

use smol_str::SmolStr;
use tpn::{ArcId, LabelId, Network, NodeId, OccurrenceId, OccurrenceKind, Plan, Window};

/// A row of the timeline, with the bars in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub kind: RowKind,
    /// What is written on its left.
    pub name: SmolStr,
    /// How far that is indented.
    pub depth: u32,
    /// Under which name it can be closed, if it has rows below it.
    pub key: Option<SmolStr>,
    /// Whether the rows below it are hidden; their bars are then in this row.
    pub is_closed: bool,
    /// The number of the lane that it is part of, from the top.
    pub lane: usize,
    pub bars: Range<usize>,
}

/// What a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// The heading of conditions, states, resources, or rules.
    Heading,
    /// One activity or delay.
    Single,
    /// Activities and delays of a lane, one after the other.
    Packed,
    /// The assertions of a variable that is known only there, or what is required of it.
    Track,
    /// The values of a variable that keeps them.
    State,
    /// A part of the profile of a resource.
    Profile(ProfilePart),
    /// The flight rule of this number.
    Rule(usize),
    /// What is gone of another plan, by its number.
    Gone(usize),
}

/// Which rows of a chart a profile has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProfilePart {
    /// Which of [`super::Chart::profiles`].
    pub profile: usize,
    /// Which of its rows, from 0.
    pub part: usize,
}

/// An activity, condition or delay over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    pub kind: BarKind,
    /// Whose bar it is.
    pub occurrence: Option<OccurrenceId>,
    /// The condition that it is, on a track.
    pub label: Option<LabelId>,
    /// Its first and its last event.
    pub events: [NodeId; 2],
    /// What people call it: an activity with its arguments, or a condition.
    pub name: SmolStr,
    /// Its site or its value, by [`super::Chart::legend`].
    pub category: Option<usize>,
    /// When it can start, earliest and latest, in mission units.
    pub start: [f64; 2],
    /// When it can end; the latest may be infinite.
    pub end: [f64; 2],
    /// The same without pinned events.
    pub free: [[f64; 2]; 2],
    /// The least and the greatest duration, where the environment chooses it.
    pub natures: Option<[f64; 2]>,
    /// What it requires and asserts.
    pub labels: Vec<LabelId>,
}

/// What a bar is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BarKind {
    /// Has others inside.
    Composite,
    /// A primitive activity.
    Activity,
    /// An activity of an earlier plan that was executed to its end.
    Past,
    /// What was executed of an activity of an earlier plan before it was ended early.
    Aborted,
    Delay,
    /// An asserted condition.
    Tell,
    /// A required condition.
    Ask,
    /// A value that a variable keeps, in the earliest schedule.
    Value,
    /// A variable has no value while something changes it, in the earliest schedule.
    Changing,
    /// What is required of a variable that keeps its value, in the earliest schedule.
    Need,
}

impl BarKind {
    /// Returns whether it was executed, and the plan followed now has it no longer.
    pub const fn is_past(self) -> bool {
        matches!(self, Self::Past | Self::Aborted)
    }

    /// Returns whether it is part of the track of a variable that keeps its value.
    pub const fn is_of_state(self) -> bool {
        matches!(self, Self::Value | Self::Changing | Self::Need)
    }
}

/// A row before it is known which rows are closed.
#[derive(Clone, Debug)]
pub(super) struct Item {
    pub(super) kind: RowKind,
    /// What is written on its left.
    pub(super) name: SmolStr,
    /// Its name among the closed ones, if there are rows below it.
    pub(super) key: Option<SmolStr>,
    /// How deep it lies.
    pub(super) depth: u32,
    pub(super) bars: Vec<Bar>,
}

/// When something with these windows is scheduled: as early as it can be.
pub(crate) fn scheduled([start, end]: [[f64; 2]; 2]) -> [f64; 2] {
    [start[0], end[0].max(start[0])]
}

impl Bar {
    /// When it starts and ends as it is scheduled now: as early as it can, or as it is pinned or was executed.
    pub fn scheduled(&self) -> [f64; 2] {
        scheduled([self.start, self.end])
    }

    /// From when to when it can end by an uncontrolled duration, once it has started as scheduled; `None` if it is known
    /// when it ends.
    pub fn contingent(&self) -> Option<[f64; 2]> {
        let [minimum, maximum] = self.natures.filter(|_| self.end[0] < self.end[1])?;
        let ends = [minimum, maximum].map(|duration| self.start[0] + duration);
        (ends[0] < ends[1]).then_some(ends)
    }

    /// Returns whether pinned events have narrowed its windows.
    pub fn is_narrowed(&self) -> bool {
        self.free != [self.start, self.end]
    }

    /// Returns whether it represents all of its occurrence, and not for a condition of an activity that has its own
    /// bar.
    pub fn is_complete(&self, network: &Network) -> bool {
        let occurrence = self.occurrence.and_then(|id| network.occurrences.get(id.index()));
        self.label.is_none() || occurrence.is_some_and(|it| it.kind == OccurrenceKind::Assertion)
    }

    /// Its windows in `plan`; `None` for what that does not have.
    pub(super) fn times_in(&self, plan: &Plan) -> Option<[[f64; 2]; 2]> {
        times(plan, self.events).filter(|_| !self.kind.is_past())
    }
}

/// The range of an arc's duration, in mission units, if the environment chooses it.
pub(super) fn natures(network: &Network, arc: Option<ArcId>) -> Option<[f64; 2]> {
    let id = arc.filter(|&id| network.is_uncertain(id))?;
    let arc = &network.arcs[id.index()];
    Some([arc.lower.to_f64(), arc.upper.to_f64()])
}

/// The windows of two events, in mission units; `None` if the plan lacks one.
pub fn times(plan: &Plan, events: [NodeId; 2]) -> Option<[[f64; 2]; 2]> {
    let window = |node: NodeId| plan.windows.get(node.index()).copied().flatten();
    let pair = |window: Window| [window.earliest.to_f64(), window.latest.to_f64()];
    Some([pair(window(events[0])?), pair(window(events[1])?)])
}
