//! Help.

use super::{PLAIN, called, keys, plain};
use crate::Dialog;
use crate::command::Command;
use crate::command::chord::Key;
use crate::command::registry::{CommandSpec, Group, Scope};
use crate::state::ToastKind;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain(
        "help.keys",
        "Keyboard shortcuts",
        Group::Help,
        &[keys(PLAIN, Key::Questionmark)],
        Scope::NotTyping,
        |_| Command::ShowDialog(Dialog::Keys),
    ),
    plain("help.about", "About Enroute", Group::Help, &[], Scope::Everywhere, |_| {
        Command::ShowDialog(Dialog::About)
    }),
    called("help.newVersion", "Say that there is a new version", Group::Help, |_, _| {
        let text = "A new version of Enroute is here. It opens when all its tabs have been closed.";
        Ok(Command::Notify(ToastKind::Info, text.to_owned()))
    }),
];
