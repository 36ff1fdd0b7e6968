//! Going to places.

use super::arguments::text_argument;
use super::available::{with_problems, with_selection};
use super::spec::{ALT, CTRL, CTRL_SHIFT, PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::dialog::Dialog;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::editor::EditorCommand;
use crate::state::selection::Selection;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    plain(
        "go.palette",
        "Show command palette",
        Group::Go,
        &[keys(CTRL_SHIFT, Key::P), keys(PLAIN, Key::F1)],
        Scope::Everywhere,
        |_| Command::Window(WindowCommand::ShowDialog(Dialog::palette())),
    ),
    plain("go.line", "Go to line…", Group::Go, &[keys(CTRL, Key::G)], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::ShowDialog(Dialog::go_to_line()))
    }),
    plain(
        "go.definition",
        "Go to definition",
        Group::Go,
        &[keys(PLAIN, Key::F12)],
        Scope::Everywhere,
        |_| Command::Editor(EditorCommand::GoToDefinition),
    ),
    plain("go.references", "Find references", Group::Go, &[keys(SHIFT, Key::F12)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindReferences)
    }),
    plain(
        "go.bracket",
        "Go to matching bracket",
        Group::Go,
        &[keys(CTRL_SHIFT, Key::Backslash), keys(PLAIN, Key::F7)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::GoToBracket),
    ),
    plain("go.back", "Go back", Group::Go, &[keys(ALT, Key::ArrowLeft)], Scope::Editor, |_| {
        Command::Editor(EditorCommand::GoToPlace { forwards: false })
    }),
    plain("go.forward", "Go forward", Group::Go, &[keys(ALT, Key::ArrowRight)], Scope::Editor, |_| {
        Command::Editor(EditorCommand::GoToPlace { forwards: true })
    }),
    when(
        plain(
            "go.nextProblem",
            "Go to next problem",
            Group::Go,
            &[keys(PLAIN, Key::F8)],
            Scope::Everywhere,
            |_| Command::Editor(EditorCommand::GoToProblem { forwards: true }),
        ),
        with_problems,
    ),
    when(
        plain(
            "go.previousProblem",
            "Go to previous problem",
            Group::Go,
            &[keys(SHIFT, Key::F8)],
            Scope::Everywhere,
            |_| Command::Editor(EditorCommand::GoToProblem { forwards: false }),
        ),
        with_problems,
    ),
    plain("go.findNext", "Find next", Group::Go, &[keys(PLAIN, Key::F3)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindNext)
    }),
    plain("go.findPrevious", "Find previous", Group::Go, &[keys(SHIFT, Key::F3)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FindPrevious)
    }),
    when(
        plain("go.selectionText", "Go to source of selection", Group::Go, &[], Scope::Everywhere, |state| {
            Command::SelectAndReveal(state.selection.clone())
        }),
        with_selection,
    ),
    plain("go.editor", "Focus mission text", Group::Go, &[keys(CTRL, Key::Num0)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Focus)
    }),
    plain("go.leave", "Close or cancel", Group::Go, &[keys(PLAIN, Key::Escape)], Scope::Everywhere, |_| {
        Command::Escape
    }),
    called("edit.renameTo", "Rename symbol at cursor", Group::Edit, |_, arguments| {
        let name = text_argument(arguments, "name")?;
        Ok(Command::Editor(EditorCommand::RenameTo(name.to_owned())))
    }),
    called("go.select", "Select by name", Group::Go, |state, arguments| {
        let name = text_argument(arguments, "name")?;
        if name.is_empty() {
            return Ok(Command::Select(Selection::None));
        }
        let snapshot = state.shown().ok_or("the mission is still being planned")?;
        Selection::by_name(snapshot, name)
            .map(Command::Select)
            .ok_or_else(|| format!("nothing in the mission is named \"{name}\""))
    }),
];
