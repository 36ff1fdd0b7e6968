//! How commands are described: name, title, keys, when they can be used, and how they are made from arguments.

use serde_json::Value;

use crate::command::chord::Chord;
use crate::command::{Command, all_commands};
use crate::host::RemoteError;
use crate::state::AppState;

/// A command as menus, key list, palette and host pages know it.
#[derive(Clone, Copy)]
pub struct CommandSpec {
    /// Its name for programs, such as `edit.undo`.
    pub id: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// The menu it stands in.
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
    pub const ALL: [Self; 9] = [
        Self::File,
        Self::Edit,
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

    /// Whether it stands in menus and in the palette.
    pub fn is_plain(&self) -> bool {
        matches!(self.build, Build::Plain(_))
    }
}

/// The command of this name.
pub fn by_id(id: &str) -> Option<&'static CommandSpec> {
    all_commands().find(|spec| spec.id == id)
}

/// The command of this name with these arguments, for host pages.
pub fn from_json(state: &AppState, id: &str, arguments: &Value) -> Result<Command, RemoteError> {
    let spec = by_id(id).ok_or_else(|| RemoteError::UnknownCommand { name: id.to_owned() })?;
    (spec.available)(state)
        .map_err(|reason| RemoteError::Unavailable { command: id.to_owned(), reason: reason.to_owned() })?;
    match spec.build {
        Build::Plain(make) => Ok(make(state)),
        Build::FromJson(make) => make(state, arguments)
            .map_err(|reason| RemoteError::BadArguments { command: id.to_owned(), reason }),
    }
}

/// The commands without arguments whose title or group has the letters of `query` in order, best first: whole words
/// and word starts count more than letters in between.
pub fn matching(query: &str) -> Vec<&'static CommandSpec> {
    let mut found: Vec<(i32, usize, &CommandSpec)> = all_commands()
        .enumerate()
        .filter(|(_, spec)| spec.is_plain())
        .filter_map(|(order, spec)| {
            let title = score(spec.title, query);
            let with_group = score(&format!("{} {}", spec.group.title(), spec.title), query);
            Some((title.max(with_group.map(|score| score - 1))?, order, spec))
        })
        .collect();
    found.sort_by_key(|&(score, order, _)| (-score, order));
    found.into_iter().map(|(_, _, spec)| spec).collect()
}

/// How well the letters of `query` are found in `text`, in order and ignoring case; `None` if they are not.
pub fn score(text: &str, query: &str) -> Option<i32> {
    let text: Vec<char> = text.to_lowercase().chars().collect();
    let wanted: Vec<char> = query.to_lowercase().chars().filter(|c| !c.is_whitespace()).collect();
    let starts_word =
        |at: usize| at == 0 || text.get(at.wrapping_sub(1)).is_none_or(|before| !before.is_alphanumeric());
    let mut total = 0;
    let mut from = 0;
    let mut last = None;
    for letter in wanted {
        let candidates = (from..text.len()).filter(|&at| text.get(at) == Some(&letter));
        let adjacent = last.map(|last: usize| last + 1);
        // A letter right behind the last one beats a word start, which beats the first of the others.
        let best = candidates.clone().find(|&at| Some(at) == adjacent);
        let best = best.or_else(|| candidates.clone().find(|&at| starts_word(at)));
        let at = best.or_else(|| candidates.clone().next())?;
        total += if Some(at) == adjacent {
            6
        } else if starts_word(at) {
            8
        } else {
            1
        };
        last = Some(at);
        from = at + 1;
    }
    Some(total * 4 - text.len() as i32 / 8)
}
