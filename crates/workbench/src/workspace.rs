//! The workspaces and what has a layout of its own.

use serde::{Deserialize, Serialize};

/// What the user has come to do (DESIGN 1).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Workspace {
    /// Write a mission.
    #[default]
    Author,
    /// See how planning works.
    Teach,
    Review,
    /// Run a mission or a control program.
    Execute,
}

/// What has a layout of its own: a workspace, where missions and control programs need other panels also by notation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Arrangement {
    /// A workspace with a mission, or where both are worked on alike.
    Of(Workspace),
    /// A control program as it runs: there is nothing to show over time or on the ground.
    Program,
    /// A lesson: its panel is beside what the stop wants to be seen.
    Lesson,
}

impl Arrangement {
    /// All arrangements, those of workspaces first.
    pub const ALL: [Self; 6] = [
        Self::Of(Workspace::Author),
        Self::Of(Workspace::Teach),
        Self::Of(Workspace::Review),
        Self::Of(Workspace::Execute),
        Self::Program,
        Self::Lesson,
    ];

    /// That of a workspace with a mission or a control program in it.
    pub const fn new(workspace: Workspace, is_control: bool) -> Self {
        match (workspace, is_control) {
            (Workspace::Execute, true) => Self::Program,
            (workspace, _) => Self::Of(workspace),
        }
    }

    /// Its name in storage.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Of(workspace) => workspace.name(),
            Self::Program => "program",
            Self::Lesson => "lesson",
        }
    }
}

impl Workspace {
    /// All of them, as the tabs stand.
    pub const ALL: [Self; 4] = [Self::Author, Self::Teach, Self::Review, Self::Execute];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Author => "Author",
            Self::Teach => "Teach",
            Self::Review => "Review",
            Self::Execute => "Execute",
        }
    }

    /// Its name in addresses, commands and storage.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Author => "author",
            Self::Teach => "teach",
            Self::Review => "review",
            Self::Execute => "execute",
        }
    }

    /// The workspace of this name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|workspace| workspace.name() == name)
    }
}
