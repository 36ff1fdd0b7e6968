//! How commands are described: name, title, keys, when they can be used, and how they are made from arguments.

use serde_json::Value;

use crate::command::Command;
use crate::command::chord::{Chord, Key, Modifiers};
use crate::state::AppState;

/// A command as menus, key list, palette and host pages know it.
#[derive(Clone, Copy)]
pub struct CommandSpec {
    /// Its name for programs, such as `edit.undo`.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// The menu it is in.
    pub group: Group,
    /// Its keys, the first being the one that is shown.
    pub keys: &'static [Chord],
    /// Where its keys work.
    pub scope: Scope,
    /// Whether it can be used now.
    pub available: fn(&AppState) -> Availability,
    /// How it is made.
    pub build: Build,
}

/// The menus, each with the commands that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Group {
    /// Missions and files.
    File,
    Edit,
    /// The mission's activities.
    Draw,
    /// Going to places.
    Go,
    /// Panels, zoom, appearance.
    View,
    /// The ground, its camera and its tools.
    Terrain,
    Plan,
    /// Judging and comparing plans, and documents about them.
    Review,
    Play,
    Help,
}

impl Group {
    /// All of them, as the menu bar lists them.
    pub const ALL: [Self; 10] = [
        Self::File,
        Self::Edit,
        Self::Draw,
        Self::Go,
        Self::View,
        Self::Terrain,
        Self::Plan,
        Self::Review,
        Self::Play,
        Self::Help,
    ];

    /// Its name on screen.
    pub const fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Draw => "Draw",
            Self::Go => "Go",
            Self::View => "View",
            Self::Terrain => "Terrain",
            Self::Plan => "Plan",
            Self::Review => "Report",
            Self::Play => "Play",
            Self::Help => "Help",
        }
    }
}

/// Where a command's keys work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    Everywhere,
    /// In the editor, and where no text field has the focus.
    Editor,
    /// Only while the editor has the focus.
    Typing,
    /// Only while no text field has the focus: plain keys.
    NotTyping,
}

/// Whether a command can be used: `Err` says what it waits for.
pub type Availability = Result<(), &'static str>;

/// How a command is made.
#[derive(Clone, Copy)]
pub enum Build {
    /// From the state alone; these stand in menus and in the palette.
    Plain(fn(&AppState) -> Command),
    /// From JSON arguments, for host pages; `Err` says how to call it.
    FromJson(fn(&AppState, &Value) -> Result<Command, String>),
}

impl CommandSpec {
    /// The command, if it needs no arguments.
    pub fn plain(&self, state: &AppState) -> Option<Command> {
        match self.build {
            Build::Plain(make) => Some(make(state)),
            Build::FromJson(_) => None,
        }
    }

    /// Returns whether it is in menus and in the palette.
    pub fn is_plain(&self) -> bool {
        matches!(self.build, Build::Plain(_))
    }
}

pub(super) const PLAIN: Modifiers = Modifiers::NONE;
pub(super) const CTRL: Modifiers = Modifiers::COMMAND;
pub(super) const SHIFT: Modifiers = Modifiers::SHIFT;
pub(super) const ALT: Modifiers = Modifiers::ALT;
pub(super) const ALT_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::ALT };
pub(super) const CTRL_ALT: Modifiers = Modifiers { alt: true, ..Modifiers::COMMAND };
pub(super) const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

pub(super) const fn keys(modifiers: Modifiers, key: Key) -> Chord {
    Chord { modifiers, key }
}

/// A command that is in menus and in the palette.
pub(super) const fn plain(
    id: &'static str,
    title: &'static str,
    group: Group,
    shortcuts: &'static [Chord],
    scope: Scope,
    make: fn(&AppState) -> Command,
) -> CommandSpec {
    CommandSpec { id, title, group, keys: shortcuts, scope, available: always, build: Build::Plain(make) }
}

/// A command for host pages that needs arguments.
pub(super) const fn called(
    id: &'static str,
    title: &'static str,
    group: Group,
    make: fn(&AppState, &Value) -> Result<Command, String>,
) -> CommandSpec {
    CommandSpec {
        id,
        title,
        group,
        keys: &[],
        scope: Scope::Everywhere,
        available: always,
        build: Build::FromJson(make),
    }
}

pub(super) const fn when(mut spec: CommandSpec, available: fn(&AppState) -> Availability) -> CommandSpec {
    spec.available = available;
    spec
}

#[expect(clippy::unnecessary_wraps, reason = "it stands beside conditions that can fail")]
fn always(_: &AppState) -> Availability {
    Ok(())
}
