//! A plan over time as data: rows, the bars in them, when they can be, and where an axis has its marks.

pub mod before;
mod chart;
mod group;
pub mod profile;
mod row;
pub mod rule;
pub mod state;
mod ticks;

use serde::{Deserialize, Serialize};

pub use chart::{Chart, Link, LinkKind};
pub use row::{Bar, BarKind, ProfilePart, Row, RowKind, times};
pub use ticks::Ticks;

/// What a chart shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChartOptions {
    /// Conditions as tracks, one for each variable that is known only where it is asserted.
    pub conditions: bool,
    /// What variables that keep their values are from when to when.
    pub states: bool,
    /// How far resources are used.
    pub resources: bool,
    /// Delays as bars of their own.
    pub delays: bool,
    /// By what the bars are grouped.
    pub grouping: Grouping,
}

/// By what the bars of the timeline are grouped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Grouping {
    /// By the activities that they are part of.
    #[default]
    Structure,
    /// By the parallel branches of the program.
    Thread,
    /// By the vehicles that they occupy.
    Vehicle,
}

impl Grouping {
    /// All of them, as the timeline lists them.
    pub const ALL: [Self; 3] = [Self::Structure, Self::Thread, Self::Vehicle];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Structure => "By activity",
            Self::Thread => "By thread",
            Self::Vehicle => "By vehicle",
        }
    }

    /// Its name in commands.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Structure => "structure",
            Self::Thread => "thread",
            Self::Vehicle => "vehicle",
        }
    }
}
