//! Time.

use super::available::with_steps;
use super::{PLAIN, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::command::registry::{CommandSpec, Group, Scope};
use crate::state::search::SearchCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain(
            "play.toggle",
            "Play or pause",
            Group::Play,
            &[keys(PLAIN, Key::Space)],
            Scope::NotTyping,
            |_| Command::TogglePlaying,
        ),
        with_steps,
    ),
    when(
        plain(
            "play.forward",
            "Next event",
            Group::Play,
            &[keys(PLAIN, Key::Period)],
            Scope::NotTyping,
            |_| Command::StepTime(true),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.back",
            "Previous event",
            Group::Play,
            &[keys(PLAIN, Key::Comma)],
            Scope::NotTyping,
            |_| Command::StepTime(false),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.start",
            "To the start",
            Group::Play,
            &[keys(PLAIN, Key::Home)],
            Scope::NotTyping,
            |state| {
                if state.steps_search() { search(SearchCommand::GoTo(0)) } else { Command::Seek(0.0) }
            },
        ),
        with_steps,
    ),
    when(
        plain("play.end", "To the end", Group::Play, &[keys(PLAIN, Key::End)], Scope::NotTyping, |state| {
            if state.steps_search() {
                search(SearchCommand::GoTo(usize::MAX))
            } else {
                Command::Seek(state.playback.end)
            }
        }),
        with_steps,
    ),
    plain("play.faster", "Faster", Group::Play, &[], Scope::Everywhere, |state| {
        if state.steps_search() {
            search(SearchCommand::SetSpeed(state.search.steps_per_sec * 2.0))
        } else {
            Command::SetRate(state.playback.rate * 2.0)
        }
    }),
    plain("play.slower", "Slower", Group::Play, &[], Scope::Everywhere, |state| {
        if state.steps_search() {
            search(SearchCommand::SetSpeed(state.search.steps_per_sec / 2.0))
        } else {
            Command::SetRate(state.playback.rate / 2.0)
        }
    }),
];

fn search(command: SearchCommand) -> Command {
    Command::Search(command)
}
