//! Help.

use super::{PLAIN, keys, plain};
use crate::Dialog;
use crate::command::Command;
use crate::command::chord::Key;
use crate::command::registry::{CommandSpec, Group, Scope};

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
];
