//! A plan over time as data: rows, the bars in them, when they can be, and where an axis has its marks.

pub mod before;
mod category;
mod chart;
mod lane;
mod owner;
mod pack;
pub mod profile;
mod row;
pub mod rule;
pub mod state;
mod ticks;

use serde::{Deserialize, Serialize};

pub use category::Category;
pub use chart::{Chart, Link, LinkKind, Past};
pub(crate) use row::scheduled;
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
    /// A lane for each vehicle and for each resource or state that belongs to none.
    #[default]
    Vehicle,
    /// A lane for each parallel branch of the program.
    Thread,
    /// A row for each activity, below the one that it is part of.
    Structure,
}

impl Grouping {
    /// All of them, as the timeline lists them.
    pub const ALL: [Self; 3] = [Self::Vehicle, Self::Thread, Self::Structure];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Vehicle => "By vehicle or resource",
            Self::Thread => "By thread",
            Self::Structure => "By activity",
        }
    }

    /// Its name in commands.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vehicle => "vehicle",
            Self::Thread => "thread",
            Self::Structure => "structure",
        }
    }
}
