//! What keys, clipboard, input methods and screen readers ask of the editor while it has the focus.

use egui::{Context, Event, EventFilter, Id, ImeEvent, Key, Modifiers};
use workbench::command::{Command, EditorCommand};
use workbench::state::{AppState, Motion, TextCommand};

/// The editor's widget id: who has the focus while the author types.
pub fn editor_id() -> Id {
    Id::unique("mission text editor")
}

/// The keys that the editor keeps for itself while it has the focus.
pub(super) const EVENT_FILTER: EventFilter =
    EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: false };

/// Lines that a page key moves.
const PAGE_LINES: usize = 24;

/// Takes what is typed into the editor out of the input and answers it as commands, in order.
pub fn typed_text(context: &Context, state: &AppState) -> Vec<Command> {
    let id = editor_id();
    let mut commands = Vec::new();
    context.input_mut(|input| {
        input.consume_accesskit_action_requests(id, |request| {
            let command = assistive(request, state);
            let is_ours = command.is_some();
            commands.extend(command);
            is_ours
        });
    });
    if !context.memory(|memory| memory.has_focus(id)) {
        return commands;
    }
    let events = context.input(|input| input.filtered_events(&EVENT_FILTER));
    let is_composing = !state.editor.composition.is_empty();
    let mut has_popup = state.editor.popup.is_some();
    for event in &events {
        let in_popup = popup_command(event).filter(|_| has_popup);
        let command = in_popup.map(Command::Editor).or_else(|| command_of(event, is_composing));
        // Only the first command of a frame can mean the list: whatever it does, the list may be gone then. Keys that
        // are let go, and the pointer, leave it.
        if let Some(command) = &command {
            has_popup &= matches!(command, Command::Editor(EditorCommand::MoveInPopup(_)));
        }
        commands.extend(command);
    }
    commands
}

fn assistive(request: &egui::accesskit::ActionRequest, state: &AppState) -> Option<Command> {
    use egui::accesskit::{Action, ActionData};
    match (request.action, &request.data) {
        (Action::SetValue, Some(ActionData::Value(text))) => Some(Command::SetSource(text.to_string())),
        (Action::ReplaceSelectedText, Some(ActionData::Value(text))) => {
            Some(Command::Text(TextCommand::Paste(text.to_string())))
        }
        (Action::Focus, _) if state.dialog.is_none() => Some(Command::Editor(EditorCommand::Focus)),
        _ => None,
    }
}

/// What a key does to the list at the caret.
fn popup_command(event: &Event) -> Option<EditorCommand> {
    let Event::Key { key, pressed: true, modifiers, .. } = event else { return None };
    if !modifiers.is_none() {
        return None;
    }
    match key {
        Key::ArrowDown => Some(EditorCommand::MoveInPopup(1)),
        Key::ArrowUp => Some(EditorCommand::MoveInPopup(-1)),
        Key::PageDown => Some(EditorCommand::MoveInPopup(8)),
        Key::PageUp => Some(EditorCommand::MoveInPopup(-8)),
        Key::Enter | Key::Tab => Some(EditorCommand::TakeFromPopup(None)),
        _ => None,
    }
}

fn command_of(event: &Event, is_composing: bool) -> Option<Command> {
    match event {
        Event::Text(text) if !text.is_empty() && text != "\n" && text != "\r" => {
            Some(Command::Text(TextCommand::Insert(text.clone())))
        }
        Event::Paste(text) if !text.is_empty() => Some(Command::Text(TextCommand::Paste(text.clone()))),
        Event::Copy => Some(Command::Editor(EditorCommand::CopySelection { cut: false })),
        Event::Cut => Some(Command::Editor(EditorCommand::CopySelection { cut: true })),
        Event::Ime(ImeEvent::Preedit { text, .. }) => {
            (is_composing || !text.is_empty()).then(|| Command::Editor(EditorCommand::Compose(text.clone())))
        }
        Event::Ime(ImeEvent::Commit(text)) if !text.is_empty() => {
            Some(Command::Text(TextCommand::Insert(text.clone())))
        }
        Event::Ime(ImeEvent::Commit(_)) => Some(Command::Editor(EditorCommand::Compose(String::new()))),
        Event::Key { key, pressed: true, modifiers, .. } => text_command(*key, *modifiers).map(Command::Text),
        _ => None,
    }
}

/// What a key does to the text.
fn text_command(key: Key, modifiers: Modifiers) -> Option<TextCommand> {
    let select = modifiers.shift;
    let by_word = modifiers.ctrl || modifiers.alt || (modifiers.command && !modifiers.mac_cmd);
    let to_edge = modifiers.mac_cmd;
    let move_to = |motion| Some(TextCommand::Move { motion, select });
    match key {
        Key::ArrowLeft if to_edge => move_to(Motion::LineStart),
        Key::ArrowRight if to_edge => move_to(Motion::LineEnd),
        Key::ArrowUp if to_edge => move_to(Motion::TextStart),
        Key::ArrowDown if to_edge => move_to(Motion::TextEnd),
        Key::ArrowLeft if by_word => move_to(Motion::WordLeft),
        Key::ArrowRight if by_word => move_to(Motion::WordRight),
        Key::ArrowLeft => move_to(Motion::Left),
        Key::ArrowRight => move_to(Motion::Right),
        Key::ArrowUp => move_to(Motion::Up(1)),
        Key::ArrowDown => move_to(Motion::Down(1)),
        Key::PageUp => move_to(Motion::Up(PAGE_LINES)),
        Key::PageDown => move_to(Motion::Down(PAGE_LINES)),
        Key::Home if modifiers.command => move_to(Motion::TextStart),
        Key::End if modifiers.command => move_to(Motion::TextEnd),
        Key::Home => move_to(Motion::LineStart),
        Key::End => move_to(Motion::LineEnd),
        Key::A if modifiers.command => Some(TextCommand::SelectAll),
        Key::Backspace if to_edge => Some(TextCommand::Delete(Motion::LineStart)),
        Key::Backspace if by_word => Some(TextCommand::Delete(Motion::WordLeft)),
        Key::Backspace => Some(TextCommand::Delete(Motion::Left)),
        Key::Delete if by_word => Some(TextCommand::Delete(Motion::WordRight)),
        Key::Delete => Some(TextCommand::Delete(Motion::Right)),
        Key::Enter => Some(TextCommand::NewLine),
        Key::Tab if modifiers.shift => Some(TextCommand::Outdent),
        Key::Tab if modifiers.is_none() => Some(TextCommand::Indent),
        _ => None,
    }
}
