//! The dialogs over the panels, as data.

use review::keys::Person;
use smol_str::SmolStr;

use crate::library::MissionId;
use crate::state::documents::ScheduleForm;

/// Which dialog is open, and what the user has entered in it.
#[derive(Clone, Debug, PartialEq)]
pub enum Dialog {
    /// Finds commands by name.
    Palette {
        /// What was typed.
        query: String,
        /// Which of the found commands Enter runs.
        chosen: usize,
    },
    /// Asks for a line number.
    GoToLine {
        /// What was typed.
        line: String,
    },
    /// Asks for a new name.
    Rename {
        /// The name as it is.
        old: String,
        /// What was typed.
        name: String,
    },
    /// Asks when the mission starts.
    Epoch {
        /// The schedule that is to be written.
        form: ScheduleForm,
        /// What was typed.
        epoch: String,
    },
    /// Explains a kind of problem.
    Explain(SmolStr),
    /// Lists the missions, to open, begin, name, copy and delete them.
    Missions {
        /// What was typed to find one.
        query: String,
        /// The mission that is being given another name, with what was typed.
        renaming: Option<(MissionId, String)>,
    },
    /// Asks for a name of the open mission.
    MissionName {
        /// What was typed.
        name: String,
    },
    /// Asks what a version is to be called.
    VersionName {
        /// What was typed.
        name: String,
    },
    /// Asks for a name of a file of the mission.
    FileName {
        /// What was typed.
        name: String,
        /// Whether the file at the caret gets it; otherwise a new one does.
        renames: bool,
    },
    /// Asks whether to trust the keys of a file.
    TrustKeys {
        /// The name of the file.
        file: String,
        /// Those that are not trusted yet, and those whose secret keys are new.
        people: Vec<Person>,
    },
    Settings,
    /// Lists all keys.
    Keys,
    /// What this program is.
    About,
}

impl Dialog {
    /// Its name for programs.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Palette { .. } => "palette",
            Self::GoToLine { .. } => "go-to-line",
            Self::Rename { .. } => "rename",
            Self::Epoch { .. } => "epoch",
            Self::Explain(_) => "explain",
            Self::Missions { .. } => "missions",
            Self::MissionName { .. } => "mission-name",
            Self::VersionName { .. } => "version-name",
            Self::FileName { .. } => "file-name",
            Self::TrustKeys { .. } => "trust-keys",
            Self::Settings => "settings",
            Self::Keys => "keys",
            Self::About => "about",
        }
    }

    /// Its title for those who do not see it.
    pub fn title(&self) -> &'static str {
        match self {
            Self::Palette { .. } => "Command palette",
            Self::GoToLine { .. } => "Go to line",
            Self::Rename { .. } => "Rename",
            Self::Epoch { .. } => "Mission start (date and time, UTC)",
            Self::Explain(_) => "Explanation",
            Self::Missions { .. } => "Missions",
            Self::MissionName { .. } => "Mission name",
            Self::VersionName { .. } => "Version name",
            Self::FileName { renames: true, .. } => "Rename file",
            Self::FileName { renames: false, .. } => "Add file",
            Self::TrustKeys { .. } => "Trust keys",
            Self::Settings => "Settings",
            Self::Keys => "Keyboard shortcuts",
            Self::About => "About Enroute",
        }
    }

    /// An empty palette.
    pub fn palette() -> Self {
        Self::Palette { query: String::new(), chosen: 0 }
    }

    /// The whole list of missions.
    pub fn missions() -> Self {
        Self::Missions { query: String::new(), renaming: None }
    }

    /// An empty question for a line.
    pub fn go_to_line() -> Self {
        Self::GoToLine { line: String::new() }
    }
}
