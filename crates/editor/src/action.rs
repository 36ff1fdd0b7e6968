//! What the user of the editor wants, for its owner to do.

use text_editing::{Find, TextCommand};

/// Something that the user of the editor wants.
#[derive(Clone, Debug, PartialEq)]
pub enum EditorAction {
    /// A key, or the pointer, edits the text or moves the caret.
    Text(TextCommand),
    /// An assistive technology replaces the whole text.
    SetText(String),
    /// An input method composes this text at the caret; nothing when it stops.
    Compose(String),
    /// What is selected, or the caret's line, goes to the clipboard.
    Copy {
        /// Whether it leaves the text.
        cut: bool,
    },
    /// An entry of the menu that a right click opens, counted from 0.
    Menu(usize),
    /// An assistive technology gives the editor the keyboard.
    Focus,
    /// The pointer went down in the text.
    Press,
    /// The pointer is over a place that something is known of, or over none any more.
    Hover(Option<usize>),
    /// Folds what begins in this line, or unfolds it. Lines count from 0.
    ToggleFold(usize),
    /// The view has room for so many columns and breaks longer lines into rows, or breaks none.
    WrapAt(Option<usize>),
    /// Chooses so many entries further down in the list at the caret.
    MoveInPopup(isize),
    /// Takes an entry of the list at the caret: this one, or the chosen one.
    TakeFromPopup(Option<usize>),
    /// The find bar changed.
    SetFind(Find),
    /// Closes the find bar.
    CloseFind,
    /// Goes to the next match.
    FindNext,
    /// Goes to the match before.
    FindPrevious,
    /// Replaces the selected match and goes to the next.
    ReplaceOne,
    /// Replaces every match.
    ReplaceAll,
}
