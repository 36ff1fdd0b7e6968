//! The dialogs over the panels, as data.

use smol_str::SmolStr;

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
            Self::Keys => "keys",
            Self::About => "about",
        }
    }

    /// An empty palette.
    pub fn palette() -> Self {
        Self::Palette { query: String::new(), chosen: 0 }
    }

    /// An empty question for a line.
    pub fn go_to_line() -> Self {
        Self::GoToLine { line: String::new() }
    }
}
