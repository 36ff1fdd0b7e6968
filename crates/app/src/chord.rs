//! The keys of commands as egui knows them.

use egui::{Key, KeyboardShortcut, Modifiers};
use workbench::command::chord::{self, Chord};
use workbench::registry::{CommandSpec, all_commands};
use workbench::state::AppState;

/// The chord as egui's shortcut.
pub fn shortcut(chord: Chord) -> KeyboardShortcut {
    let chord::Modifiers { command, shift, alt } = chord.modifiers;
    let held = [(command, Modifiers::COMMAND), (shift, Modifiers::SHIFT), (alt, Modifiers::ALT)];
    let modifiers = held.into_iter().filter(|(is_held, _)| *is_held).map(|(_, modifier)| modifier);
    KeyboardShortcut::new(modifiers.fold(Modifiers::NONE, |all, one| all | one), key(chord.key))
}

/// Whether a press of `key`, which lies where `place` does on an American keyboard, has a chord's key. With Shift, some
/// signs are called by what they type: Shift and `[` is `{`.
pub(crate) fn is_pressed(chord: Chord, key: Option<Key>, place: Option<Key>) -> Press {
    let wanted = self::key(chord.key);
    let shifted = match chord.key {
        chord::Key::OpenBracket => Some(Key::OpenCurlyBracket),
        chord::Key::CloseBracket => Some(Key::CloseCurlyBracket),
        chord::Key::Backslash => Some(Key::Pipe),
        _ => None,
    };
    let is_held = chord.modifiers.command || chord.modifiers.alt;
    let is_digit = matches!(wanted, Key::Num0 | Key::Num1 | Key::Num2 | Key::Num3 | Key::Num4);
    if key == Some(wanted) || chord.modifiers.shift && is_held && shifted.is_some() && key == shifted {
        Press::Named
    } else if is_held && (shifted.is_some() || is_digit) && place == Some(wanted) {
        Press::Placed
    } else {
        Press::Other
    }
}

/// How a press fits a chord's key, worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Press {
    Other,
    /// It lies where the key does on an American keyboard: others type brackets with `AltGr`, and some digits with Shift.
    Placed,
    /// It is what the keyboard calls the key.
    Named,
}

/// Returns whether a key press may be one of a command's.
pub fn is_of_command(key: Option<Key>, place: Option<Key>, pressed: Modifiers) -> bool {
    all_commands().flat_map(|command| command.keys).any(|&keys| {
        is_pressed(keys, key, place) != Press::Other && pressed.matches_logically(shortcut(keys).modifiers)
    })
}

/// Ctrl+Shift+P, with which Firefox opens a private window.
const CTRL_SHIFT_P: Chord =
    Chord { modifiers: chord::Modifiers { command: true, shift: true, alt: false }, key: chord::Key::P };

/// The command's keys as menus and lists write them, those first that the browser does not keep for itself. A menu shows
/// the first.
pub fn texts(egui: &egui::Context, spec: &CommandSpec, state: &AppState) -> Vec<String> {
    let is_kept = |chord: &Chord| state.system.is_firefox && *chord == CTRL_SHIFT_P;
    let (kept, ours): (Vec<Chord>, Vec<Chord>) = spec.keys.iter().partition(|chord| is_kept(chord));
    ours.into_iter().chain(kept).map(|chord| text(egui, chord)).collect()
}

/// The chord as menus and lists write it on this system.
fn text(egui: &egui::Context, chord: Chord) -> String {
    let shortcut = shortcut(chord);
    let name = printed(chord.key).map_or_else(|| shortcut.logical_key.name().to_owned(), str::to_owned);
    let mut held = egui::ModifierNames::NAMES.format(&shortcut.modifiers, egui.os().is_mac());
    if !held.is_empty() {
        held.push('+');
    }
    held + &name
}

/// Returns what is printed on a key, where that is not its name.
const fn printed(key: chord::Key) -> Option<&'static str> {
    Some(match key {
        chord::Key::ArrowDown => "Down",
        chord::Key::ArrowLeft => "Left",
        chord::Key::ArrowRight => "Right",
        chord::Key::ArrowUp => "Up",
        chord::Key::Backslash => "\\",
        chord::Key::CloseBracket => "]",
        chord::Key::Comma => ",",
        chord::Key::Equals => "=",
        chord::Key::Escape => "Esc",
        chord::Key::Minus => "-",
        chord::Key::OpenBracket => "[",
        chord::Key::Period => ".",
        chord::Key::Plus => "+",
        chord::Key::Questionmark => "?",
        chord::Key::Slash => "/",
        _ => return None,
    })
}

const fn key(key: chord::Key) -> Key {
    match key {
        chord::Key::A => Key::A,
        chord::Key::ArrowDown => Key::ArrowDown,
        chord::Key::ArrowLeft => Key::ArrowLeft,
        chord::Key::ArrowRight => Key::ArrowRight,
        chord::Key::ArrowUp => Key::ArrowUp,
        chord::Key::Backslash => Key::Backslash,
        chord::Key::C => Key::C,
        chord::Key::CloseBracket => Key::CloseBracket,
        chord::Key::Comma => Key::Comma,
        chord::Key::D => Key::D,
        chord::Key::Delete => Key::Delete,
        chord::Key::End => Key::End,
        chord::Key::Enter => Key::Enter,
        chord::Key::Equals => Key::Equals,
        chord::Key::Escape => Key::Escape,
        chord::Key::F => Key::F,
        chord::Key::F1 => Key::F1,
        chord::Key::F12 => Key::F12,
        chord::Key::F2 => Key::F2,
        chord::Key::F3 => Key::F3,
        chord::Key::F6 => Key::F6,
        chord::Key::F7 => Key::F7,
        chord::Key::F8 => Key::F8,
        chord::Key::F9 => Key::F9,
        chord::Key::G => Key::G,
        chord::Key::H => Key::H,
        chord::Key::Home => Key::Home,
        chord::Key::K => Key::K,
        chord::Key::L => Key::L,
        chord::Key::M => Key::M,
        chord::Key::Minus => Key::Minus,
        chord::Key::N => Key::N,
        chord::Key::Num0 => Key::Num0,
        chord::Key::Num1 => Key::Num1,
        chord::Key::Num2 => Key::Num2,
        chord::Key::Num3 => Key::Num3,
        chord::Key::Num4 => Key::Num4,
        chord::Key::O => Key::O,
        chord::Key::OpenBracket => Key::OpenBracket,
        chord::Key::P => Key::P,
        chord::Key::Period => Key::Period,
        chord::Key::Plus => Key::Plus,
        chord::Key::Questionmark => Key::Questionmark,
        chord::Key::S => Key::S,
        chord::Key::Slash => Key::Slash,
        chord::Key::Space => Key::Space,
        chord::Key::T => Key::T,
        chord::Key::Y => Key::Y,
        chord::Key::Z => Key::Z,
    }
}
