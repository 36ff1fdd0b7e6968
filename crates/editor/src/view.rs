//! What the editor is told: the text and what is known of it, for one frame.

use std::ops::Range;

use egui::{Color32, Id};
use text_editing::{Document, Find, Rows};
use theme::Tokens;
use theme::icon::Icon;

/// Everything that the editor shows in one frame. Ranges are bytes of the document.
#[derive(Clone, Copy)]
pub struct EditorView<'a> {
    /// The widget's id: who has the focus while someone types.
    pub id: Id,
    /// What assistive technologies call the text.
    pub name: &'a str,
    /// The text and its caret.
    pub document: &'a Document,
    /// Which lines are folded away.
    pub rows: &'a Rows,
    /// Whether long lines are broken into rows of the view's width.
    pub wraps: bool,
    /// What an input method is composing at the caret.
    pub composition: &'a str,
    /// The keys that open what a manual says of the place under the pointer, if there is one.
    pub manual_keys: Option<&'a str>,
    /// The find bar, when it is open.
    pub find: Option<&'a Find>,
    /// The list at the caret, when it is open.
    pub popup: Option<&'a Popup<'a>>,
    /// The menu that a right click opens, in groups.
    pub menu: &'a [&'a [MenuEntry<'a>]],
    /// What is wrong with the text, in the order in which it is told where several things are wrong at one place.
    pub diagnostics: &'a [Diagnostic<'a>],
    /// Places that are marked, the lowest first.
    pub marks: &'a [Mark],
    /// Where to scroll, once.
    pub reveal: Option<Reveal>,
    /// Whether the editor takes the keyboard, once.
    pub takes_focus: bool,
    /// When the caret last moved or the text last changed, on the clock of `now_secs`: the caret blinks from then.
    pub active_secs: f64,
    /// Seconds at the start of this frame, on any clock.
    pub now_secs: f64,
    pub tokens: &'static Tokens,
}

/// A place to scroll to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reveal {
    /// The place, in bytes.
    pub offset: usize,
    /// Whether it is moved to the middle even when it is visible at an edge.
    pub center: bool,
}

/// Something wrong with the text: a wavy line, a sign in the gutter, and words under the pointer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic<'a> {
    /// Its place; empty for a single point.
    pub bytes: Range<usize>,
    /// How bad it is.
    pub severity: Severity,
    /// What it is called.
    pub code: &'a str,
    /// What is wrong, in Markdown.
    pub message: &'a str,
    /// What to do about it, in Markdown.
    pub hint: Option<&'a str>,
    /// The keys that list what fixes it, if something does.
    pub fix_keys: Option<&'a str>,
}

/// How bad something is; the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The text means nothing as it is.
    Error,
    /// It probably does not mean what its author thinks.
    Warning,
    /// Worth knowing.
    Note,
}

impl Severity {
    /// The sign and the color of a severity; the sign alone tells them apart.
    pub const fn sign(self, tokens: &Tokens) -> (Icon, Color32) {
        match self {
            Self::Error => (Icon::Error, tokens.error),
            Self::Warning => (Icon::Warning, tokens.warning),
            Self::Note => (Icon::Info, tokens.info),
        }
    }
}

/// A marked place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    pub bytes: Range<usize>,
    /// What is behind its text.
    pub fill: Color32,
    /// The line below its text, if it has one.
    pub underline: Option<Color32>,
}

/// A piece of text with a color of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Highlight {
    pub bytes: Range<usize>,
    pub color: Color32,
}

/// An entry of the menu that a right click opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MenuEntry<'a> {
    pub label: &'a str,
    /// The keys that do the same.
    pub keys: &'a str,
    /// Why it cannot be chosen now, if so.
    pub unavailable: Option<&'a str>,
}

/// A list at the caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Popup<'a> {
    /// Its entries, best first.
    pub items: Vec<PopupItem<'a>>,
    /// Which entry Enter and Tab take.
    pub chosen: usize,
    /// Whether the entries are pieces of text, in its font; otherwise they are words.
    pub is_code: bool,
    /// What assistive technologies read before each entry.
    pub prefix: &'a str,
}

/// An entry of a list at the caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PopupItem<'a> {
    pub label: &'a str,
    /// More about it.
    pub detail: &'a str,
    /// A letter for what kind of thing it is, and its color.
    pub sign: Option<(&'static str, Color32)>,
}

/// The signature of the call around the caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    pub label: String,
    /// The parameter that is being written, in bytes of the label.
    pub active: Option<Range<usize>>,
    /// What the call does.
    pub documentation: String,
}

/// What the editor asks of those who know the language of the text. Offsets and ranges are bytes of the document.
pub trait LanguageService {
    /// The colored pieces in a part of the text, in textual order; what is between them is plain.
    fn highlights(&mut self, bytes: Range<usize>) -> Vec<Highlight>;

    /// Returns what is known about the text at a place, in Markdown.
    fn hover(&mut self, offset: usize) -> Option<String>;

    /// The signature of the call around a place.
    fn signature(&mut self, offset: usize) -> Option<Signature>;

    /// The lines at which something can be folded, ascending. Lines count from 0.
    fn foldable_lines(&mut self) -> &[usize];
}
