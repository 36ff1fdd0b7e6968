//! Keys as the browser names them.

use std::ops::BitOr;

/// A key that is not a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    ArrowDown,
    ArrowLeft,
    ArrowRight,
    ArrowUp,
    Backspace,
    Delete,
    End,
    Enter,
    Escape,
    Home,
    PageDown,
    PageUp,
    Tab,
    /// F1 to F12.
    Function(u8),
    /// The key of a letter, a digit or a sign, as on a US keyboard.
    Character(char),
}

/// Keys held down while another is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Modifiers(pub u8);

impl Modifiers {
    pub const NONE: Self = Self(0);
    pub const ALT: Self = Self(1);
    pub const CONTROL: Self = Self(2);
    pub const SHIFT: Self = Self(8);

    /// Returns whether a key pressed with these still types a character.
    pub(super) fn types(self) -> bool {
        self.0 & (Self::ALT.0 | Self::CONTROL.0) == 0
    }
}

impl BitOr for Modifiers {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// How the `DevTools` protocol spells a key press.
pub(super) struct Spelling {
    /// What the key means: `a`, `Enter`.
    pub(super) key: String,
    /// Which key of the board it is: `KeyA`, `Enter`.
    pub(super) code: String,
    /// The number that Windows gives it.
    pub(super) number: u32,
    /// What it types.
    pub(super) text: Option<String>,
}

impl Key {
    pub(super) fn spelling(self) -> Spelling {
        let named = |name: &str, number: u32| Spelling {
            key: name.to_owned(),
            code: name.to_owned(),
            number,
            text: None,
        };
        match self {
            Self::ArrowLeft => named("ArrowLeft", 37),
            Self::ArrowUp => named("ArrowUp", 38),
            Self::ArrowRight => named("ArrowRight", 39),
            Self::ArrowDown => named("ArrowDown", 40),
            Self::Backspace => named("Backspace", 8),
            Self::Delete => named("Delete", 46),
            Self::End => named("End", 35),
            Self::Enter => Spelling { text: Some("\r".to_owned()), ..named("Enter", 13) },
            Self::Escape => named("Escape", 27),
            Self::Home => named("Home", 36),
            Self::PageDown => named("PageDown", 34),
            Self::PageUp => named("PageUp", 33),
            Self::Tab => named("Tab", 9),
            Self::Function(number) => named(&format!("F{number}"), 111 + u32::from(number)),
            Self::Character(character) => spell_character(character),
        }
    }
}

fn spell_character(character: char) -> Spelling {
    let upper = character.to_ascii_uppercase();
    let (code, number) = match upper {
        'A'..='Z' => (format!("Key{upper}"), u32::from(upper)),
        '0'..='9' => (format!("Digit{upper}"), u32::from(upper)),
        ' ' => ("Space".to_owned(), 32),
        '=' | '+' => ("Equal".to_owned(), 187),
        '-' | '_' => ("Minus".to_owned(), 189),
        '.' | '>' => ("Period".to_owned(), 190),
        ',' | '<' => ("Comma".to_owned(), 188),
        '/' | '?' => ("Slash".to_owned(), 191),
        ';' | ':' => ("Semicolon".to_owned(), 186),
        '[' | '{' => ("BracketLeft".to_owned(), 219),
        ']' | '}' => ("BracketRight".to_owned(), 221),
        '\'' | '"' => ("Quote".to_owned(), 222),
        // Signs on other keys and letters of other scripts: what they type is all that matters.
        _ => (String::new(), 0),
    };
    Spelling { key: character.to_string(), code, number, text: Some(character.to_string()) }
}
