//! What keys, clipboard, input methods and screen readers ask of the editor while it has the focus.

use egui::{Context, Event, EventFilter, Id, ImeEvent, Key, Modifiers};
use text_editing::{Motion, TextCommand};

use crate::EditorAction;

/// The keys that the editor keeps for itself while it has the focus.
pub(crate) const EVENT_FILTER: EventFilter =
    EventFilter { tab: true, horizontal_arrows: true, vertical_arrows: true, escape: true };

/// Lines that a page key moves.
const PAGE_LINES: usize = 24;

/// What the editor is doing while keys come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Keyboard {
    /// The editor's id.
    pub id: Id,
    /// Whether an input method is composing text.
    pub is_composing: bool,
    /// Whether a list is open at the caret.
    pub has_popup: bool,
    /// Whether assistive technologies may give the editor the keyboard.
    pub can_take_focus: bool,
}

/// Takes what is typed into the editor out of the input. Returns what that asks for, in order.
pub fn typed(context: &Context, keyboard: &Keyboard) -> Vec<EditorAction> {
    let id = keyboard.id;
    let mut actions = Vec::new();
    context.input_mut(|input| {
        input.consume_accesskit_action_requests(id, |request| {
            let action = assistive(request, keyboard);
            let is_ours = action.is_some();
            actions.extend(action);
            is_ours
        });
    });
    if !context.memory(|memory| memory.has_focus(id)) {
        return actions;
    }
    let events = context.input(|input| input.filtered_events(&EVENT_FILTER));
    let mut has_popup = keyboard.has_popup;
    for event in &events {
        let in_popup = popup_action(event).filter(|_| has_popup);
        let action = in_popup.or_else(|| action_of(event, keyboard.is_composing));
        // Only the first action of a frame can mean the list: whatever it does, the list may be gone then. Keys that are
        // let go, and the pointer, leave it.
        if let Some(action) = &action {
            has_popup &= matches!(action, EditorAction::MoveInPopup(_));
        }
        actions.extend(action);
    }
    actions
}

fn assistive(request: &egui::accesskit::ActionRequest, keyboard: &Keyboard) -> Option<EditorAction> {
    use egui::accesskit::{Action, ActionData};
    match (request.action, &request.data) {
        (Action::SetValue, Some(ActionData::Value(text))) => Some(EditorAction::SetText(text.to_string())),
        (Action::ReplaceSelectedText, Some(ActionData::Value(text))) => {
            Some(EditorAction::Text(TextCommand::Paste(text.to_string())))
        }
        (Action::Focus, _) if keyboard.can_take_focus => Some(EditorAction::Focus),
        _ => None,
    }
}

/// Returns what these events do to the text of an editor without a list, whatever else they may do.
pub fn typed_ahead(events: &[Event]) -> Vec<TextCommand> {
    let of_text = |event: &Event| match action_of(event, false)? {
        EditorAction::Text(command) => Some(command),
        _ => None,
    };
    events.iter().filter_map(of_text).collect()
}

/// Returns what a key does to the list at the caret.
fn popup_action(event: &Event) -> Option<EditorAction> {
    let Event::Key { key, pressed: true, modifiers, .. } = event else { return None };
    if !modifiers.is_none() {
        return None;
    }
    match key {
        Key::ArrowDown => Some(EditorAction::MoveInPopup(1)),
        Key::ArrowUp => Some(EditorAction::MoveInPopup(-1)),
        Key::PageDown => Some(EditorAction::MoveInPopup(8)),
        Key::PageUp => Some(EditorAction::MoveInPopup(-8)),
        Key::Enter | Key::Tab => Some(EditorAction::TakeFromPopup(None)),
        _ => None,
    }
}

fn action_of(event: &Event, is_composing: bool) -> Option<EditorAction> {
    match event {
        Event::Text(text) if !text.is_empty() && text != "\n" && text != "\r" => {
            Some(EditorAction::Text(TextCommand::Insert(text.clone())))
        }
        Event::Paste(text) if !text.is_empty() => Some(EditorAction::Text(TextCommand::Paste(text.clone()))),
        Event::Copy => Some(EditorAction::Copy { cut: false }),
        Event::Cut => Some(EditorAction::Copy { cut: true }),
        Event::Ime(ImeEvent::Preedit { text, .. }) => {
            (is_composing || !text.is_empty()).then(|| EditorAction::Compose(text.clone()))
        }
        Event::Ime(ImeEvent::Commit(text)) if !text.is_empty() => {
            Some(EditorAction::Text(TextCommand::Insert(text.clone())))
        }
        Event::Ime(ImeEvent::Commit(_)) => Some(EditorAction::Compose(String::new())),
        Event::Key { key, pressed: true, modifiers, .. } => {
            text_command(*key, *modifiers).map(EditorAction::Text)
        }
        _ => None,
    }
}

/// Returns what a key does to the text.
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
