//! What the editor shows besides the text: the find bar, the completion list, text being composed.

use rmpl::editor::CompletionKind;
use rmpl::{Edit, Span};
use text_editing::Find;

use crate::state::folding::Folding;

/// What only the editor does.
#[derive(Clone, Debug, PartialEq)]
pub enum EditorCommand {
    /// Gives the editor the keyboard.
    Focus,
    /// The pointer is over a place of the text that something is known of, or over none any more.
    Hover(Option<usize>),
    /// Text that an input method is composing.
    Compose(String),
    /// Opens the find bar, with the replacement row or without.
    Find {
        /// Whether the replacement row is open.
        replacing: bool,
    },
    /// Changes what is looked for.
    SetFind(Find),
    /// Closes the find bar.
    CloseFind,
    /// Selects the next match.
    FindNext,
    /// Selects the match before.
    FindPrevious,
    /// Replaces the selected match and selects the next.
    ReplaceOne,
    /// Replaces all matches.
    ReplaceAll,
    /// Goes to a line, from 1.
    GoToLine(usize),
    /// Goes to the next or the previous problem.
    GoToProblem {
        /// Whether to go forwards.
        forwards: bool,
    },
    /// Lists what can be written at the caret.
    Complete,
    /// Lists what fixes the problem at the caret.
    QuickFix,
    /// Lists where the name at the caret stands.
    FindReferences,
    /// Goes to where the name at the caret is declared.
    GoToDefinition,
    /// Goes to the bracket that belongs to the one at the caret.
    GoToBracket,
    /// Goes where the caret was before, or forward again.
    GoToPlace {
        /// Whether to go forward.
        forwards: bool,
    },
    /// Moves in the list at the caret.
    MoveInPopup(isize),
    /// Takes an entry of the list at the caret, the chosen one if none is given.
    TakeFromPopup(Option<usize>),
    /// Closes the list at the caret.
    ClosePopup,
    /// Asks for a new name of the name at the caret.
    Rename,
    /// Gives the name at the caret a new name.
    RenameTo(String),
    /// Gives the text its canonical layout.
    Format,
    /// Selects the next larger piece of structure.
    ExpandSelection,
    /// Folds away or shows the piece of text that begins in this line, from 0.
    ToggleFold(usize),
    /// Folds the innermost open piece of text around the caret, or shows it again.
    FoldAtCaret(bool),
    /// Folds every outermost piece, or shows everything.
    FoldAll(bool),
    /// The view breaks lines into rows of so many columns, or breaks none.
    WrapAt(Option<usize>),
    /// Cuts or copies the selection, or the line of the caret.
    CopySelection {
        /// Whether it is taken away.
        cut: bool,
    },
}

/// The editor's own state.
#[derive(Clone, Debug, Default)]
pub struct EditorState {
    /// The find bar, when it is open.
    pub find: Option<Find>,
    /// The list at the caret: completions, fixes, references.
    pub popup: Option<Popup>,
    /// The line that was copied or cut last, if that was a whole line.
    pub copied_line: Option<String>,
    /// What is folded away.
    pub folding: Folding,
    /// Where the caret was before it went elsewhere.
    pub places: Places,
    /// Text that an input method is composing at the caret; it is not part of the document yet.
    pub composition: String,
    /// The place under the pointer that something is known of.
    pub hovered: Option<usize>,
    /// When the caret last moved or the text last changed, in seconds on the host's clock: the caret blinks from then.
    pub active_secs: f64,
}

/// The places that the caret went away from, to go back to and forward again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Places {
    back: Vec<usize>,
    forward: Vec<usize>,
}

/// So many places are remembered.
const MAX_PLACES: usize = 50;

impl Places {
    /// The caret leaves a place for one far away.
    pub(crate) fn leave(&mut self, offset: usize) {
        if self.back.last() != Some(&offset) {
            self.back.push(offset);
        }
        let surplus = self.back.len().saturating_sub(MAX_PLACES);
        self.back.drain(..surplus);
        self.forward.clear();
    }

    /// The place before or after `here`, which can be returned to.
    pub(crate) fn step(&mut self, here: usize, forwards: bool) -> Option<usize> {
        let (from, to) =
            if forwards { (&mut self.forward, &mut self.back) } else { (&mut self.back, &mut self.forward) };
        let place = from.pop()?;
        to.push(here);
        Some(place)
    }
}

/// A place to scroll to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reveal {
    pub span: Span,
    /// Whether it is moved to the middle even when it is visible at an edge.
    pub center: bool,
}

/// A list at the caret.
#[derive(Clone, Debug, PartialEq)]
pub struct Popup {
    /// What it lists.
    pub kind: PopupKind,
    /// Its entries, best first.
    pub items: Vec<PopupItem>,
    /// Which entry Enter and Tab take.
    pub chosen: usize,
    /// Where it belongs: the word being completed, or the place of the fixes.
    pub span: Span,
}

/// What a list at the caret is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PopupKind {
    /// What can be written here.
    Completion,
    /// What fixes the problem here.
    Fixes,
    /// Where the name here stands.
    References,
}

/// An entry of a list at the caret.
#[derive(Clone, Debug, PartialEq)]
pub struct PopupItem {
    pub label: String,
    /// More about it.
    pub detail: String,
    pub kind: Option<CompletionKind>,
    /// What taking it does.
    pub action: PopupAction,
}

/// What taking an entry does.
#[derive(Clone, Debug, PartialEq)]
pub enum PopupAction {
    /// Writes this instead of the popup's span; `$0` is where the caret goes.
    Insert(String),
    /// Edits the text.
    Edit(Vec<Edit>),
    /// Goes to a place.
    Reveal(Span),
}
