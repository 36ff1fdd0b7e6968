//! The registry: every command with its name, title, menu and keys (DESIGN 1).

mod arguments;
mod available;
mod edit;
mod file;
mod go;
mod help;
mod learn;
mod plan;
mod play;
mod review;
mod run;
mod search;
mod terrain;
mod view;

use serde_json::Value;

use crate::command::Command;
use crate::command::chord::{Chord, Key, Modifiers};
use crate::command::registry::{Availability, Build, CommandSpec, Group, Scope};
use crate::state::AppState;

/// Every command, in the order of the menus.
pub fn all_commands() -> impl Iterator<Item = &'static CommandSpec> {
    let areas = [
        file::COMMANDS,
        edit::COMMANDS,
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

const PLAIN: Modifiers = Modifiers::NONE;
const CTRL: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const ALT: Modifiers = Modifiers::ALT;
const ALT_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::ALT };
const CTRL_ALT: Modifiers = Modifiers { alt: true, ..Modifiers::COMMAND };
const CTRL_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

const fn keys(modifiers: Modifiers, key: Key) -> Chord {
    Chord { modifiers, key }
}

/// A command that stands in menus and in the palette.
const fn plain(
    id: &'static str,
    title: &'static str,
    group: Group,
    shortcuts: &'static [Chord],
    scope: Scope,
    make: fn(&AppState) -> Command,
) -> CommandSpec {
    CommandSpec {
        id,
        title,
        group,
        keys: shortcuts,
        scope,
        available: available::always,
        build: Build::Plain(make),
    }
}

/// A command for host pages that needs arguments.
const fn called(
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
        available: available::always,
        build: Build::FromJson(make),
    }
}

const fn when(mut spec: CommandSpec, available: fn(&AppState) -> Availability) -> CommandSpec {
    spec.available = available;
    spec
}
