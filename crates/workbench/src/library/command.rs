//! What can be asked of the library.

use smol_str::SmolStr;

use super::{MissionId, Template};

/// Something that is asked of the library. Where an id may be missing, the open mission is meant.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryCommand {
    /// Begins a mission from a template and opens it.
    New(&'static Template),
    /// Begins a mission that is a copy of an example and opens it.
    NewFromExample(SmolStr),
    Open(MissionId),
    /// Gives a mission another name.
    Rename {
        id: Option<MissionId>,
        name: String,
    },
    /// Opens a copy of a mission.
    Duplicate(Option<MissionId>),
    /// Deletes a mission; it can be brought back.
    Delete(Option<MissionId>),
    /// Brings a deleted mission back; the last one if none is named.
    Restore(Option<MissionId>),
    /// Keeps the open text as a version of this name.
    KeepVersion(String),
    /// Makes the text what it was in a version, as an edit that can be undone.
    RestoreVersion(usize),
    /// Saves the layout of the present workspace with the open mission, under this name.
    SaveLayout(String),
    /// Shows a saved layout of the open mission, by its number.
    ShowLayout(usize),
    /// Deletes a saved layout of the open mission.
    DeleteLayout(usize),
    /// Writes the open network of another tool in RMPL.
    TurnIntoRmpl,
    /// Lets the user save the whole open mission as one file.
    SaveMissionFile,
    /// Lets the user save what is kept and cannot be read.
    SaveUnreadable(usize),
}
