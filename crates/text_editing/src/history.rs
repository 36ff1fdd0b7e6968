//! The steps of a text's history, and which edits are one step.

use rmpl::{Edit, Shift, Span};

use crate::carets::Carets;

/// How an edit joins the edits before it in the history.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditKind {
    /// Typed characters: a word and the blanks before it are undone as one.
    Typing,
    /// Deleted characters next to each other are undone as one.
    Deleting,
    /// A dragged number or place: the whole drag, known by this number, is undone as one.
    Drag(u64),
    /// Undone on its own.
    Single,
}

/// Edits that are undone together, with the carets before and after.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub(crate) kind: EditKind,
    pub(crate) changes: Vec<Change>,
    pub(crate) before: Carets,
    pub(crate) after: Carets,
}

/// One replacement, applied after the ones before it in its step.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    pub(crate) start: usize,
    pub(crate) removed: String,
    pub(crate) inserted: String,
}

impl Change {
    /// The replacement, or the one that takes it back, without what it leaves as it was.
    pub(crate) fn edit(&self, forwards: bool) -> Edit {
        let (removed, inserted) =
            if forwards { (&self.removed, &self.inserted) } else { (&self.inserted, &self.removed) };
        let Edit { span, text } = Shift::between(removed, inserted).edit(inserted);
        let at = |offset| self.start as u32 + offset;
        Edit { span: Span::new(at(span.start), at(span.end)), text }
    }
}

/// Returns whether `next` is undone together with `last`.
pub(crate) fn joins(last: &Step, next: &Step) -> bool {
    if last.kind != next.kind {
        return false;
    }
    let (Some(before), [change]) = (last.changes.last(), next.changes.as_slice()) else {
        return matches!(next.kind, EditKind::Drag(_));
    };
    match next.kind {
        EditKind::Drag(_) => true,
        EditKind::Single => false,
        EditKind::Deleting => {
            let backwards = change.start + change.removed.len() == before.start;
            let forwards = change.start == before.start;
            (backwards || forwards) && !change.removed.contains('\n')
        }
        EditKind::Typing => {
            let adjacent = change.start == before.start + before.inserted.len();
            let ends_blank = before.inserted.ends_with(char::is_whitespace);
            let starts_word = change.inserted.starts_with(|c: char| !c.is_whitespace());
            adjacent
                && change.removed.is_empty()
                && !change.inserted.contains('\n')
                && !before.inserted.contains('\n')
                && !(ends_blank && starts_word)
        }
    }
}
