//! Keys that commands have, as plain data: the front end matches them with what is pressed.

/// A key with the modifiers that are held with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Chord {
    pub modifiers: Modifiers,
    /// What is pressed.
    pub key: Key,
}

/// What is held while a key is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Modifiers {
    /// Ctrl, or ⌘ on a Mac.
    pub command: bool,
    pub shift: bool,
    /// Alt, or ⌥ on a Mac.
    pub alt: bool,
}

impl Modifiers {
    pub const NONE: Self = Self { command: false, shift: false, alt: false };
    /// Ctrl, or ⌘ on a Mac.
    pub const COMMAND: Self = Self { command: true, ..Self::NONE };
    pub const SHIFT: Self = Self { shift: true, ..Self::NONE };
    /// Alt, or ⌥ on a Mac.
    pub const ALT: Self = Self { alt: true, ..Self::NONE };
}

/// The keys that commands have, by what they mean on the user's keyboard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    A,
    ArrowDown,
    ArrowLeft,
    ArrowRight,
    ArrowUp,
    Backslash,
    C,
    CloseBracket,
    Comma,
    D,
    Delete,
    End,
    Enter,
    Equals,
    Escape,
    F,
    F1,
    F12,
    F2,
    F3,
    F6,
    F7,
    F8,
    F9,
    G,
    H,
    Home,
    K,
    L,
    M,
    Minus,
    N,
    Num0,
    Num1,
    Num2,
    Num3,
    Num4,
    O,
    OpenBracket,
    P,
    Period,
    Plus,
    Questionmark,
    S,
    Slash,
    Space,
    T,
    Y,
    Z,
}
