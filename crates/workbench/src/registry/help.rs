//! Help.

use super::spec::{PLAIN, called, keys, plain};
use crate::command::Command;
use crate::command::chord::Key;
use crate::dialog::Dialog;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::toast::ToastKind;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain(
        "help.keys",
        "Show keyboard shortcuts",
        Group::Help,
        &[keys(PLAIN, Key::Questionmark)],
        Scope::NotTyping,
        |_| Command::Window(WindowCommand::ShowDialog(Dialog::Keys)),
    ),
    plain("help.about", "About Enroute", Group::Help, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::ShowDialog(Dialog::About))
    }),
    called("help.newVersion", "Announce new version", Group::Help, |_, _| {
        let text = "A new version is available. Close all other Enroute tabs, then reload this one.";
        Ok(Command::Window(WindowCommand::Notify(ToastKind::Info, text.to_owned())))
    }),
];
