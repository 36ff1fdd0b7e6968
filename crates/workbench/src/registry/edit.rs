//! The text.

use text_editing::TextCommand;

use super::arguments::{number_argument, text_argument};
use super::available::{with_redo, with_undo};
use super::spec::{ALT, ALT_SHIFT, CTRL, CTRL_ALT, CTRL_SHIFT, PLAIN, SHIFT, called, keys, plain, when};
use crate::command::Command;
use crate::command::chord::Key;
use crate::registry::spec::{CommandSpec, Group, Scope};
use crate::state::editor::EditorCommand;
use crate::state::window::WindowCommand;

/// In the order of the menus.
pub(super) const COMMANDS: &[CommandSpec] = &[
    when(
        plain("edit.undo", "Undo", Group::Edit, &[keys(CTRL, Key::Z)], Scope::Editor, |_| {
            Command::Text(TextCommand::Undo)
        }),
        with_undo,
    ),
    when(
        plain(
            "edit.redo",
            "Redo",
            Group::Edit,
            &[keys(CTRL_SHIFT, Key::Z), keys(CTRL, Key::Y)],
            Scope::Editor,
            |_| Command::Text(TextCommand::Redo),
        ),
        with_redo,
    ),
    plain("edit.cut", "Cut", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::CopySelection { cut: true })
    }),
    plain("edit.copy", "Copy", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::CopySelection { cut: false })
    }),
    plain("edit.paste", "Paste", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Window(WindowCommand::Paste)
    }),
    plain("edit.find", "Find…", Group::Edit, &[keys(CTRL, Key::F)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Find { replacing: false })
    }),
    plain("edit.replace", "Replace…", Group::Edit, &[keys(CTRL, Key::H)], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::Find { replacing: true })
    }),
    plain(
        "edit.toggleComment",
        "Toggle comment",
        Group::Edit,
        &[keys(CTRL, Key::Slash)],
        Scope::Editor,
        |_| Command::Text(TextCommand::ToggleComment),
    ),
    plain(
        "edit.selectNext",
        "Add next occurrence to selection",
        Group::Edit,
        &[keys(CTRL, Key::D)],
        Scope::Typing,
        |_| Command::Text(TextCommand::SelectNextOccurrence),
    ),
    plain(
        "edit.caretAbove",
        "Add cursor above",
        Group::Edit,
        &[keys(CTRL_ALT, Key::ArrowUp)],
        Scope::Typing,
        |_| Command::Text(TextCommand::AddCaretAbove),
    ),
    plain(
        "edit.caretBelow",
        "Add cursor below",
        Group::Edit,
        &[keys(CTRL_ALT, Key::ArrowDown)],
        Scope::Typing,
        |_| Command::Text(TextCommand::AddCaretBelow),
    ),
    plain("edit.selectLine", "Select line", Group::Edit, &[keys(CTRL, Key::L)], Scope::Typing, |_| {
        Command::Text(TextCommand::SelectLines)
    }),
    plain(
        "edit.copyUp",
        "Copy lines up",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::ArrowUp)],
        Scope::Typing,
        |_| Command::Text(TextCommand::CopyLinesUp),
    ),
    plain(
        "edit.duplicate",
        "Copy lines down",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::ArrowDown), keys(CTRL_SHIFT, Key::D)],
        Scope::Typing,
        |_| Command::Text(TextCommand::DuplicateLines),
    ),
    plain(
        "edit.deleteLines",
        "Delete lines",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::K)],
        Scope::Typing,
        |_| Command::Text(TextCommand::DeleteLines),
    ),
    plain("edit.moveUp", "Move lines up", Group::Edit, &[keys(ALT, Key::ArrowUp)], Scope::Typing, |_| {
        Command::Text(TextCommand::MoveLinesUp)
    }),
    plain(
        "edit.moveDown",
        "Move lines down",
        Group::Edit,
        &[keys(ALT, Key::ArrowDown)],
        Scope::Typing,
        |_| Command::Text(TextCommand::MoveLinesDown),
    ),
    plain(
        "edit.complete",
        "Trigger completion",
        Group::Edit,
        &[keys(CTRL, Key::Space)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::Complete),
    ),
    plain(
        "edit.quickFix",
        "Show quick fixes…",
        Group::Edit,
        &[keys(CTRL, Key::Period)],
        Scope::Everywhere,
        |_| Command::Editor(EditorCommand::QuickFix),
    ),
    plain("edit.rename", "Rename…", Group::Edit, &[keys(PLAIN, Key::F2)], Scope::Editor, |_| {
        Command::Editor(EditorCommand::Rename)
    }),
    plain(
        "edit.format",
        "Format document",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::F)],
        Scope::Everywhere,
        |_| Command::Editor(EditorCommand::Format),
    ),
    plain(
        "edit.expandSelection",
        "Expand selection",
        Group::Edit,
        &[keys(ALT_SHIFT, Key::ArrowRight)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::ExpandSelection),
    ),
    plain(
        "edit.fold",
        "Fold",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::OpenBracket), keys(PLAIN, Key::F9)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::FoldAtCaret(true)),
    ),
    plain(
        "edit.unfold",
        "Unfold",
        Group::Edit,
        &[keys(CTRL_SHIFT, Key::CloseBracket), keys(SHIFT, Key::F9)],
        Scope::Typing,
        |_| Command::Editor(EditorCommand::FoldAtCaret(false)),
    ),
    plain("edit.foldAll", "Fold all", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FoldAll(true))
    }),
    plain("edit.unfoldAll", "Unfold all", Group::Edit, &[], Scope::Everywhere, |_| {
        Command::Editor(EditorCommand::FoldAll(false))
    }),
    called("edit.setSource", "Replace text", Group::Edit, |_, arguments| {
        text_argument(arguments, "text").map(|text| Command::SetSource(text.to_owned()))
    }),
    called("edit.insert", "Insert text at cursor", Group::Edit, |_, arguments| {
        let text = text_argument(arguments, "text")?;
        Ok(Command::Text(TextCommand::Insert(text.to_owned())))
    }),
    called("edit.select", "Select text", Group::Edit, |state, arguments| {
        let anchor = number_argument(arguments, "start")?;
        let head = number_argument(arguments, "end").unwrap_or(anchor);
        let offset = |value: f64| state.document.boundary_before(value.max(0.0) as usize);
        Ok(Command::Text(TextCommand::Select { anchor: offset(anchor), head: offset(head) }))
    }),
];
