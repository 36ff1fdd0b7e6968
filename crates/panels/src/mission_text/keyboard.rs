//! What the editor's user wants, as commands of the workbench.

use editor::{EditorAction, Keyboard};
use egui::{Context, Event, Id};
use text_editing::TextCommand;
use workbench::PanelKind;
use workbench::command::Command;
use workbench::state::AppState;
use workbench::state::editor::EditorCommand;
use workbench::state::window::WindowCommand;

/// The editor's widget id: who has the focus while the author types.
pub fn editor_id() -> Id {
    Id::unique("mission text editor")
}

/// Takes what is typed into the editor out of the input and answers it as commands, in order.
pub fn typed_text(context: &Context, state: &AppState) -> Vec<Command> {
    let keyboard = Keyboard {
        id: editor_id(),
        is_composing: !state.editor.composition.is_empty(),
        has_popup: state.editor.popup.is_some(),
        can_take_focus: state.window.dialog.is_none(),
    };
    editor::typed(context, &keyboard).into_iter().filter_map(|action| command(state, action)).collect()
}

/// Returns what events do to the text that no frame has taken in yet: nothing, if the editor does not have the
/// keyboard.
pub fn typed_ahead(context: &Context, events: &[Event]) -> Vec<TextCommand> {
    if context.memory(|memory| memory.has_focus(editor_id())) {
        editor::typed_ahead(events)
    } else {
        Vec::new()
    }
}

/// The command for what the editor's user wants.
pub(super) fn command(state: &AppState, action: EditorAction) -> Option<Command> {
    Some(Command::Editor(match action {
        EditorAction::Menu(index) => return super::menu::command(state, index),
        EditorAction::Text(command) => return Some(Command::Text(command)),
        EditorAction::SetText(text) => return Some(Command::SetSource(text)),
        EditorAction::Press => return Some(Command::Window(WindowCommand::Activate(PanelKind::Editor))),
        EditorAction::Compose(text) => EditorCommand::Compose(text),
        EditorAction::Copy { cut } => EditorCommand::CopySelection { cut },
        EditorAction::Focus => EditorCommand::Focus,
        EditorAction::Hover(place) => EditorCommand::Hover(place),
        EditorAction::ToggleFold(line) => EditorCommand::ToggleFold(line),
        EditorAction::WrapAt(columns) => EditorCommand::WrapAt(columns),
        EditorAction::MoveInPopup(steps) => EditorCommand::MoveInPopup(steps),
        EditorAction::TakeFromPopup(index) => EditorCommand::TakeFromPopup(index),
        EditorAction::SetFind(find) => EditorCommand::SetFind(find),
        EditorAction::CloseFind => EditorCommand::CloseFind,
        EditorAction::FindNext => EditorCommand::FindNext,
        EditorAction::FindPrevious => EditorCommand::FindPrevious,
        EditorAction::ReplaceOne => EditorCommand::ReplaceOne,
        EditorAction::ReplaceAll => EditorCommand::ReplaceAll,
    }))
}
