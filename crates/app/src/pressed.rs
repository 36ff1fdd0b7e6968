//! Finds the commands whose keys were pressed.

use egui::{Context, Event, KeyboardShortcut};
use workbench::PanelKind;
use workbench::command::Command;
use workbench::registry::{CommandSpec, Scope, all_commands};
use workbench::state::AppState;
use workbench::state::window::WindowCommand;

use crate::chord::{Press, is_pressed, shortcut};

/// Who has the keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Focus {
    Editor,
    TextField,
    /// The network or the terrain as a whole.
    Drawing,
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
            let Event::Key { key, physical_key, pressed: true, modifiers, .. } = event else { return true };
            // There, these go from word to word.
            let is_arrow = matches!(key, egui::Key::ArrowLeft | egui::Key::ArrowRight);
            if is_mac && is_arrow && focus == Focus::Editor && modifiers.matches_exact(egui::Modifiers::ALT) {
                return true;
            }
            let found = best_match(*key, *physical_key, *modifiers, focus, state);
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
        Some(_) if panels::is_drawing_focused(context) => Focus::Drawing,
        Some(_) => Focus::Widget,
    }
}

/// The usable command with the most specific matching key.
fn best_match(
    key: egui::Key,
    place: Option<egui::Key>,
    modifiers: egui::Modifiers,
    focus: Focus,
    state: &AppState,
) -> Option<&'static CommandSpec> {
    matching(key, place, modifiers)
        .filter(|(spec, _, keys)| {
            works(spec.scope, focus, *keys)
                && (!is_letter(*keys)
                    || focus != Focus::Nothing
                    || state.window.active_panel != PanelKind::Editor)
                && (spec.available)(state).is_ok()
        })
        .max_by_key(|(_, press, keys)| (*press, specificity(*keys)))
        .map(|(spec, ..)| spec)
}

/// The commands whose keys these are, with how well they fit.
fn matching(
    key: egui::Key,
    place: Option<egui::Key>,
    modifiers: egui::Modifiers,
) -> impl Iterator<Item = (&'static CommandSpec, Press, KeyboardShortcut)> {
    all_commands()
        .flat_map(move |spec| {
            let fit = move |&keys| (spec, is_pressed(keys, Some(key), place), shortcut(keys));
            spec.keys.iter().map(fit)
        })
        .filter(move |(_, press, keys)| *press != Press::Other && matches_modifiers(modifiers, *keys))
}

/// Letters and function keys want exactly their modifiers; signs may need Shift on some keyboards.
fn matches_modifiers(pressed: egui::Modifiers, keys: KeyboardShortcut) -> bool {
    let key = keys.logical_key;
    if is_sign_key(key) {
        pressed.matches_logically(keys.modifiers)
    } else if is_bracket(key) && keys.modifiers.is_none() && pressed.alt && pressed.ctrl {
        // AltGr, by which many keyboards type brackets, is Ctrl and Alt to some systems.
        true
    } else {
        pressed.matches_exact(keys.modifiers)
    }
}

fn is_bracket(key: egui::Key) -> bool {
    matches!(key, egui::Key::OpenBracket | egui::Key::CloseBracket)
}

fn is_sign_key(key: egui::Key) -> bool {
    use egui::Key;
    matches!(
        key,
        Key::Questionmark
            | Key::Plus
            | Key::Minus
            | Key::Equals
            | Key::Slash
            | Key::Period
            | Key::Comma
            | Key::Num0
            | Key::Num1
            | Key::Num2
            | Key::Num3
            | Key::Num4
    )
}

fn works(scope: Scope, focus: Focus, keys: KeyboardShortcut) -> bool {
    match scope {
        Scope::Everywhere => true,
        Scope::Editor => focus != Focus::TextField,
        Scope::Typing => focus == Focus::Editor,
        Scope::NotTyping => match focus {
            Focus::Nothing => true,
            // Plain arrow keys go to the neighbor in the drawing.
            Focus::Drawing => {
                let is_own = matches!(keys.logical_key, egui::Key::Space | egui::Key::Delete);
                is_own || !is_widget_key(keys.logical_key) || !keys.modifiers.is_none()
            }
            // A focused button is pressed by Space and left by arrows, and Delete releases an event that is pinned.
            Focus::Widget => !keys.conflicts_with_text_editing() || !is_widget_key(keys.logical_key),
            Focus::Editor | Focus::TextField => false,
        },
    }
}

/// Returns whether it is a letter alone. Letters act only where a panel was turned to that is not the text: what is
/// typed while the text happens not to have the keyboard is meant for the text.
fn is_letter(keys: KeyboardShortcut) -> bool {
    let name = keys.logical_key.name();
    let is_held = keys.modifiers.command || keys.modifiers.alt || keys.modifiers.ctrl;
    !is_held && name.len() == 1 && name.chars().all(|sign| sign.is_ascii_alphabetic())
}

fn is_widget_key(key: egui::Key) -> bool {
    use egui::Key;
    matches!(
        key,
        Key::Space
            | Key::Enter
            | Key::Delete
            | Key::ArrowLeft
            | Key::ArrowRight
            | Key::ArrowUp
            | Key::ArrowDown
    )
}

fn specificity(keys: KeyboardShortcut) -> u32 {
    let modifiers = keys.modifiers;
    u32::from(modifiers.shift) + u32::from(modifiers.alt) + u32::from(modifiers.command)
}

#[cfg(test)]
mod tests {
    use egui::{Key, Modifiers};
    use workbench::command::chord;

    use super::*;

    /// What a browser tells of a press: what the keyboard calls the key, its place, and what is held for the sign alone.
    #[derive(Clone, Copy, Debug)]
    struct Typed {
        key: &'static str,
        code: &'static str,
        held: Modifiers,
    }

    const fn typed(key: &'static str, code: &'static str, held: Modifiers) -> Typed {
        Typed { key, code, held }
    }

    const NONE: Modifiers = Modifiers::NONE;
    const SHIFT: Modifiers = Modifiers::SHIFT;
    /// As Windows tells it; Linux tells nothing of it.
    const ALT_GR: Modifiers = Modifiers { alt: true, ctrl: true, command: true, ..Modifiers::NONE };

    /// Returns how a chord's sign is typed on an American, a German and a French keyboard, where they differ.
    fn typed_on_three(chord: chord::Chord) -> Option<[Typed; 3]> {
        let is_held = chord.modifiers.command && chord.modifiers.shift;
        Some(match chord.key {
            // Brackets behind AltGr are typed at the place of the American ones.
            chord::Key::OpenBracket if is_held => {
                ["{", "Ü", "Dead"].map(|key| typed(key, "BracketLeft", NONE))
            }
            chord::Key::CloseBracket if is_held => {
                ["}", "*", "£"].map(|key| typed(key, "BracketRight", NONE))
            }
            chord::Key::Backslash if is_held => ["|", "'", "µ"].map(|key| typed(key, "Backslash", NONE)),
            chord::Key::OpenBracket => {
                [typed("[", "BracketLeft", NONE), typed("[", "Digit8", ALT_GR), typed("[", "Digit5", ALT_GR)]
            }
            chord::Key::CloseBracket => {
                [typed("]", "BracketRight", NONE), typed("]", "Digit9", ALT_GR), typed("]", "Minus", ALT_GR)]
            }
            chord::Key::Comma => {
                [typed(",", "Comma", NONE), typed(",", "Comma", NONE), typed(",", "KeyM", NONE)]
            }
            chord::Key::Period => {
                [typed(".", "Period", NONE), typed(".", "Period", NONE), typed(".", "Comma", SHIFT)]
            }
            chord::Key::Minus => {
                [typed("-", "Minus", NONE), typed("-", "Slash", NONE), typed("-", "Digit6", NONE)]
            }
            chord::Key::Equals => {
                [typed("=", "Equal", NONE), typed("=", "Digit0", SHIFT), typed("=", "Equal", NONE)]
            }
            chord::Key::Plus => {
                [typed("+", "Equal", SHIFT), typed("+", "BracketRight", NONE), typed("+", "Equal", SHIFT)]
            }
            chord::Key::Questionmark => {
                [typed("?", "Slash", SHIFT), typed("?", "Minus", SHIFT), typed("?", "KeyM", SHIFT)]
            }
            chord::Key::Slash => {
                [typed("/", "Slash", NONE), typed("/", "Digit7", SHIFT), typed("/", "Period", SHIFT)]
            }
            // With Ctrl, a French keyboard's digits are pressed as they are: their signs are others.
            chord::Key::Num0 if chord.modifiers.command => {
                ["0", "0", "à"].map(|key| typed(key, "Digit0", NONE))
            }
            chord::Key::Num1 if chord.modifiers.command => {
                ["1", "1", "&"].map(|key| typed(key, "Digit1", NONE))
            }
            chord::Key::Num2 if chord.modifiers.command => {
                ["2", "2", "é"].map(|key| typed(key, "Digit2", NONE))
            }
            chord::Key::Num3 if chord.modifiers.command => {
                ["3", "3", "\""].map(|key| typed(key, "Digit3", NONE))
            }
            chord::Key::Num4 if chord.modifiers.command => {
                ["4", "4", "'"].map(|key| typed(key, "Digit4", NONE))
            }
            chord::Key::Num0 => {
                [typed("0", "Digit0", NONE), typed("0", "Digit0", NONE), typed("0", "Digit0", SHIFT)]
            }
            chord::Key::Z => [typed("z", "KeyZ", NONE), typed("z", "KeyY", NONE), typed("z", "KeyW", NONE)],
            chord::Key::Y => [typed("y", "KeyY", NONE), typed("y", "KeyZ", NONE), typed("y", "KeyY", NONE)],
            chord::Key::M => {
                [typed("m", "KeyM", NONE), typed("m", "KeyM", NONE), typed("m", "Semicolon", NONE)]
            }
            _ => return None,
        })
    }

    #[test]
    fn every_shortcut_is_found_on_american_german_and_french_keyboards() {
        for spec in all_commands() {
            for &chord in spec.keys {
                let wanted = shortcut(chord);
                let same = [typed(wanted.logical_key.name(), "", NONE); 3];
                for (keyboard, press) in typed_on_three(chord).unwrap_or(same).into_iter().enumerate() {
                    for held in [press.held, if press.held == ALT_GR { NONE } else { press.held }] {
                        // As eframe makes an event of it.
                        let place = Key::from_name(press.code);
                        let key = Key::from_name(press.key).or(place);
                        let key = key.unwrap_or_else(|| panic!("{} {press:?}", spec.id));
                        let mut modifiers = wanted.modifiers | held;
                        modifiers.ctrl |= modifiers.command;
                        let found: Vec<_> = matching(key, place, modifiers).collect();
                        let fit =
                            |(_, press, keys): &(_, Press, KeyboardShortcut)| (*press, specificity(*keys));
                        let mine = found.iter().filter(|(it, ..)| it.id == spec.id).map(fit).max();
                        let best = found.iter().filter(|(it, ..)| it.scope == spec.scope).map(fit).max();
                        assert!(mine.is_some(), "{} on keyboard {keyboard}: {press:?}", spec.id);
                        assert_eq!(mine, best, "{} on keyboard {keyboard}: {press:?}", spec.id);
                    }
                }
            }
        }
    }
}
