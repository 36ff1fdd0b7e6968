//! A text that is edited: its lines, its caret and an exact history, what editing keys do to it, finding and replacing,
//! which of its lines are folded away, and how long lines are broken into rows.
//!
//! Everything here is a pure change of data: no key, no pointer and no pixel. The widget that shows such a text is the
//! crate `editor`.

mod carets;
mod document;
mod find;
mod history;
mod pairs;
mod rows;
mod template;
mod typing;
mod wrap;

pub use document::{Caret, Document};
pub use find::{Find, Pattern};
pub use history::EditKind;
pub use rows::Rows;
pub use typing::{INDENT, Motion, TextCommand, is_name_character, word_at};
pub use wrap::{MIN_WRAP_COLUMNS, WrappedRows};
