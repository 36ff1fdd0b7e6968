//! Finds the commands whose keys were pressed.

use egui::{Context, Event, KeyboardShortcut};
use workbench::PanelKind;
use workbench::command::Command;
use workbench::registry::{CommandSpec, Scope, all_commands};
use workbench::state::AppState;
use workbench::state::window::WindowCommand;

use crate::chord::shortcut;

/// Who has the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Focus {
    Editor,
    TextField,
    Widget,
    Nothing,
}

/// Takes the key presses that belong to commands out of the input and answers the commands, in order.
pub fn take_pressed(context: &Context, state: &AppState, editor: egui::Id) -> Vec<Command> {
    // An open menu has the keys to itself: Escape closes it, and nothing else.
    if egui::Popup::is_any_open(context) {
        return Vec::new();
    }
    if state.window.dialog.is_some() {
        return take_in_dialog(context);
    }
    let focus = focus(context, editor);
    let mut commands = Vec::new();
    let is_mac = context.os().is_mac();
    context.input_mut(|input| {
        input.events.retain(|event| {
            let Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
            // There, these go from word to word.
            let is_arrow = matches!(key, egui::Key::ArrowLeft | egui::Key::ArrowRight);
            if is_mac && is_arrow && focus == Focus::Editor && modifiers.matches_exact(egui::Modifiers::ALT) {
                return true;
            }
            let found = best_match(*key, *modifiers, focus, state);
            commands.extend(found.and_then(|spec| spec.plain(state)));
            found.is_none()
        });
        // The key that was taken also arrives as text.
        if !commands.is_empty() && focus != Focus::TextField && focus != Focus::Editor {
            input.events.retain(|event| !matches!(event, Event::Text(_)));
        }
    });
    commands
}

/// Under a dialog only Escape works; the dialog's own keys are its own.
fn take_in_dialog(context: &Context) -> Vec<Command> {
    let escape = context.input_mut(|input| input.consume_key(egui::Modifiers::NONE, egui::Key::Escape));
    if escape { vec![Command::Window(WindowCommand::CloseDialog)] } else { Vec::new() }
}

fn focus(context: &Context, editor: egui::Id) -> Focus {
    match context.memory(egui::Memory::focused) {
        None => Focus::Nothing,
        Some(_) if panels::is_region_focused(context) => Focus::Nothing,
        Some(id) if id == editor => Focus::Editor,
        Some(_) if context.text_edit_focused() => Focus::TextField,
        Some(_) => Focus::Widget,
    }
}

/// The usable command with the most specific matching key.
fn best_match(
    key: egui::Key,
    modifiers: egui::Modifiers,
    focus: Focus,
    state: &AppState,
) -> Option<&'static CommandSpec> {
    let matching = all_commands().flat_map(|spec| spec.keys.iter().map(move |&keys| (spec, shortcut(keys))));
    matching
        .filter(|(spec, keys)| {
            keys.logical_key == key
                && matches_modifiers(modifiers, *keys)
                && works(spec.scope, focus, *keys)
                && (!is_letter(*keys)
                    || focus != Focus::Nothing
                    || state.window.active_panel != PanelKind::Editor)
                && (spec.available)(state).is_ok()
        })
        .max_by_key(|(_, keys)| specificity(*keys))
        .map(|(spec, _)| spec)
}

/// Letters and function keys want exactly their modifiers; signs may need Shift on some keyboards.
fn matches_modifiers(pressed: egui::Modifiers, keys: KeyboardShortcut) -> bool {
    let is_sign = keys.logical_key.name().chars().count() != 1 && is_sign_key(keys.logical_key);
    if is_sign { pressed.matches_logically(keys.modifiers) } else { pressed.matches_exact(keys.modifiers) }
}

fn is_sign_key(key: egui::Key) -> bool {
    use egui::Key;
    matches!(
        key,
        Key::Questionmark | Key::Plus | Key::Minus | Key::Equals | Key::Slash | Key::Period | Key::Comma
    )
}

fn works(scope: Scope, focus: Focus, keys: KeyboardShortcut) -> bool {
    match scope {
        Scope::Everywhere => true,
        Scope::Editor => focus != Focus::TextField,
        Scope::Typing => focus == Focus::Editor,
        Scope::NotTyping => match focus {
            Focus::Nothing => true,
            // A focused button is pressed by Space and left by arrows.
            Focus::Widget => !keys.conflicts_with_text_editing() || !is_widget_key(keys.logical_key),
            Focus::Editor | Focus::TextField => false,
        },
    }
}

/// Whether it is a letter alone. Letters act only where a panel was turned to that is not the text: what is typed while
/// the text happens not to have the keyboard is meant for the text.
fn is_letter(keys: KeyboardShortcut) -> bool {
    let name = keys.logical_key.name();
    let is_held = keys.modifiers.command || keys.modifiers.alt || keys.modifiers.ctrl;
    !is_held && name.len() == 1 && name.chars().all(|sign| sign.is_ascii_alphabetic())
}

fn is_widget_key(key: egui::Key) -> bool {
    use egui::Key;
    matches!(key, Key::Space | Key::Enter | Key::ArrowLeft | Key::ArrowRight | Key::ArrowUp | Key::ArrowDown)
}

fn specificity(keys: KeyboardShortcut) -> u32 {
    let modifiers = keys.modifiers;
    u32::from(modifiers.shift) + u32::from(modifiers.alt) + u32::from(modifiers.command)
}
