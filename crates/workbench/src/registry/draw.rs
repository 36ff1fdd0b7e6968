//! The mission's activities, as they are drawn in network and timeline.

use serde_json::Value;

use super::arguments::text_argument;
use super::available::{with_activities, with_statement};
use super::spec::{CTRL_SHIFT, PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::AppState;
use crate::state::drawing::{Change, DrawCommand, NEW_BOUNDS, Wrapping};

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("draw.add", "Add activity", Group::Draw, &[keys(PLAIN, Key::A)], Scope::NotTyping, |_| {
            Command::Draw(DrawCommand::Add)
        }),
        with_activities,
    ),
    when(
        plain(
            "draw.addBeside",
            "Add parallel activity",
            Group::Draw,
            &[keys(SHIFT, Key::A)],
            Scope::NotTyping,
            |_| Command::Draw(DrawCommand::AddBeside),
        ),
        with_activities,
    ),
    when(
        plain(
            "draw.earlier",
            "Move activity earlier",
            Group::Draw,
            &[keys(CTRL_SHIFT, Key::ArrowLeft)],
            Scope::NotTyping,
            |_| Command::Draw(DrawCommand::Shift { forwards: false }),
        ),
        with_statement,
    ),
    when(
        plain(
            "draw.later",
            "Move activity later",
            Group::Draw,
            &[keys(CTRL_SHIFT, Key::ArrowRight)],
            Scope::NotTyping,
            |_| Command::Draw(DrawCommand::Shift { forwards: true }),
        ),
        with_statement,
    ),
    when(
        plain("draw.bounds", "Set duration of activity", Group::Draw, &[], Scope::Everywhere, |state| {
            make(state, |what| Change::Bound(what, NEW_BOUNDS.to_owned()))
        }),
        with_statement,
    ),
    when(
        plain("draw.choose", "Wrap in choice", Group::Draw, &[], Scope::Everywhere, |state| {
            make(state, |what| Change::Wrap(what, Wrapping::Choose))
        }),
        with_statement,
    ),
    when(
        plain("draw.optional", "Make optional", Group::Draw, &[], Scope::Everywhere, |state| {
            make(state, |what| Change::Wrap(what, Wrapping::Optional))
        }),
        with_statement,
    ),
    when(
        plain("draw.unordered", "Allow any order with next", Group::Draw, &[], Scope::Everywhere, |state| {
            make(state, |what| Change::Wrap(what, Wrapping::Unordered))
        }),
        with_statement,
    ),
    when(
        plain("draw.unwrap", "Remove surrounding construct", Group::Draw, &[], Scope::Everywhere, |state| {
            make(state, Change::Unwrap)
        }),
        with_statement,
    ),
    when(
        plain(
            "draw.delete",
            "Delete activity",
            Group::Draw,
            &[keys(PLAIN, Key::Delete)],
            Scope::NotTyping,
            |_| Command::Draw(DrawCommand::Delete),
        ),
        with_statement,
    ),
    called("draw.paste", "Add statements after selection", Group::Draw, |_, arguments: &Value| {
        let text = text_argument(arguments, "text")?.to_owned();
        Ok(Command::Draw(DrawCommand::Paste(text)))
    }),
    called("draw.visit", "Send vehicle to location", Group::Draw, |_, arguments: &Value| {
        let vehicle = text_argument(arguments, "vehicle")?.to_owned();
        let location = text_argument(arguments, "location")?.to_owned();
        Ok(Command::Draw(DrawCommand::Make(Change::Visit { vehicle, location })))
    }),
];

/// A change of what is selected.
fn make(state: &AppState, change: impl FnOnce(rmpl::Span) -> Change) -> Command {
    let change = state.drawn_statement().map(change);
    // Without a statement, the command is not available.
    change.map_or(Command::Escape, |change| Command::Draw(DrawCommand::Make(change)))
}
