//! Playing and stepping.

use super::available::with_steps;
use super::spec::{PLAIN, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::playback::TransportCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain(
            "play.toggle",
            "Play or pause",
            Group::Play,
            &[keys(PLAIN, Key::Space)],
            Scope::NotTyping,
            |_| transport(TransportCommand::TogglePlaying),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.forward",
            "Go to next event",
            Group::Play,
            &[keys(PLAIN, Key::Period)],
            Scope::NotTyping,
            |_| transport(TransportCommand::Step(true)),
        ),
        with_steps,
    ),
    when(
        plain(
            "play.back",
            "Go to previous event",
            Group::Play,
            &[keys(PLAIN, Key::Comma)],
            Scope::NotTyping,
            |_| transport(TransportCommand::Step(false)),
        ),
        with_steps,
    ),
    when(
        plain("play.start", "Go to start", Group::Play, &[keys(PLAIN, Key::Home)], Scope::NotTyping, |_| {
            transport(TransportCommand::Start)
        }),
        with_steps,
    ),
    when(
        plain("play.end", "Go to end", Group::Play, &[keys(PLAIN, Key::End)], Scope::NotTyping, |_| {
            transport(TransportCommand::End)
        }),
        with_steps,
    ),
    plain("play.faster", "Increase playback speed", Group::Play, &[], Scope::Everywhere, |_| {
        transport(TransportCommand::Speed(2.0))
    }),
    plain("play.slower", "Decrease playback speed", Group::Play, &[], Scope::Everywhere, |_| {
        transport(TransportCommand::Speed(0.5))
    }),
];

const fn transport(command: TransportCommand) -> Command {
    Command::Transport(command)
}
