//! The registry: every command with its name, title, menu and keys (DESIGN 1).

mod arguments;
mod available;
mod draw;
mod edit;
mod file;
mod go;
mod help;
mod learn;
mod lesson;
mod plan;
mod play;
mod review;
mod run;
mod search;
mod spec;
mod synonyms;
mod terrain;
mod view;

use serde_json::Value;

use crate::command::Command;
use crate::host::RemoteError;
use crate::state::AppState;

pub use lesson::{command_of_lesson, read_lesson};
pub use spec::{Availability, Build, CommandSpec, Group, Scope};

use self::synonyms::score_of_synonyms;

/// Every command, in the order of the menus.
pub fn all_commands() -> impl Iterator<Item = &'static CommandSpec> {
    let areas = [
        file::COMMANDS,
        edit::COMMANDS,
        draw::COMMANDS,
        go::COMMANDS,
        view::COMMANDS,
        terrain::COMMANDS,
        plan::COMMANDS,
        review::COMMANDS,
        play::COMMANDS,
        search::COMMANDS,
        run::COMMANDS,
        learn::COMMANDS,
        help::COMMANDS,
    ];
    areas.into_iter().flatten()
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

/// The commands without arguments whose title or group has the letters of `query` in order, or that another word means,
/// best first: whole words and word starts count more than letters in between.
pub fn matching(query: &str) -> Vec<&'static CommandSpec> {
    let mut found: Vec<(i32, usize, &CommandSpec)> = all_commands()
        .enumerate()
        .filter(|(_, spec)| spec.is_plain())
        .filter_map(|(order, spec)| {
            Some((score_of_entry(spec.id, [spec.group.title(), spec.title], query)?, order, spec))
        })
        .collect();
    found.sort_by_key(|&(score, order, _)| (-score, order));
    found.into_iter().map(|(_, _, spec)| spec).collect()
}

/// Returns how well an entry of the palette is found: by its title, by its group and title, or by another word for the
/// command or panel that is called `id`.
pub fn score_of_entry(id: &str, [group, title]: [&str; 2], query: &str) -> Option<i32> {
    let with_group = score(&format!("{group} {title}"), query).map(|score| score - 1);
    score(title, query).max(with_group).max(score_of_synonyms(id, query))
}

/// Returns how well the letters of `query` are found in `text`, in order and ignoring case; `None` if they are not.
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
        // A letter right after the last one beats a word start, which beats the first of the others.
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
