//! Edits of a text: what several of them come to, and which were made since a revision.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::diagnostic::Edit;
use crate::span::Span;

/// How one text became another: a single replacement that covers all that changed, in bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shift {
    /// Where the replacement begins, in both texts.
    pub start: u32,
    /// How many bytes of the old text were replaced.
    pub removed: u32,
    /// How many bytes of the new text stand there instead.
    pub inserted: u32,
}

impl Shift {
    /// Returns what edits come to, each of the text that those before it left.
    pub fn of<'edits>(edits: impl IntoIterator<Item = &'edits Edit>) -> Self {
        edits.into_iter().fold(Self::default(), Self::then)
    }

    /// The smallest replacement that turns one text into another. Where the edits are known, [`Shift::of`] says it
    /// without reading the texts.
    pub fn between(old: &str, new: &str) -> Self {
        // Bytes first, because they are quick to compare; then back to character boundaries.
        let same = |(left, right): &(u8, u8)| left == right;
        let common = old.bytes().zip(new.bytes()).take_while(same).count();
        let start = old.floor_char_boundary(common).min(new.floor_char_boundary(common));
        let endings = old.bytes().skip(start).rev().zip(new.bytes().skip(start).rev());
        let mut tail = endings.take_while(same).count();
        while !(old.is_char_boundary(old.len() - tail) && new.is_char_boundary(new.len() - tail)) {
            tail -= 1;
        }
        let replaced = |text: &str| (text.len() - tail - start) as u32;
        Self { start: start as u32, removed: replaced(old), inserted: replaced(new) }
    }

    /// This change and then an edit of the text that it left.
    #[must_use]
    pub fn then(self, edit: &Edit) -> Self {
        let (removed, inserted) = (edit.span.end - edit.span.start, edit.text.len() as u32);
        if self.is_nothing() {
            return Self { start: edit.span.start, removed, inserted };
        }
        let start = self.start.min(edit.span.start);
        let end = self.start + self.inserted;
        // What only one of the two covers is the same in the other one's texts.
        let around = self.start - start + edit.span.end.saturating_sub(end);
        Self { start, removed: self.removed + around, inserted: self.inserted + around + inserted - removed }
    }

    /// Returns whether no text was replaced by none.
    pub const fn is_nothing(self) -> bool {
        self.removed == 0 && self.inserted == 0
    }

    /// The replacement as an edit of the old text, given the new one.
    pub fn edit(self, new: &str) -> Edit {
        let inserted = new.get(self.start as usize..(self.start + self.inserted) as usize);
        Edit {
            span: Span::new(self.start, self.start + self.removed),
            text: inserted.unwrap_or_default().to_owned(),
        }
    }

    /// Returns where what stood at `span` stands now, if the change is outside of it, or inside but not at its ends.
    pub const fn moved(self, span: Span) -> Span {
        let end = if span.end <= self.start { span.end } else { self.behind(span.end) };
        // What is empty stays where it ends.
        let start = if span.start == span.end { end } else { self.behind(span.start) };
        Span::new(start, end)
    }

    const fn behind(self, offset: u32) -> u32 {
        if offset >= self.start + self.removed { offset - self.removed + self.inserted } else { offset }
    }

    /// Returns where a span of the old text is in the new one; `None` if all of it was replaced.
    pub fn surviving(self, span: Span) -> Option<Span> {
        let (start, end) = (self.edge(span.start, true), self.edge(span.end, false));
        (start < end || span.start == span.end).then(|| Span::new(start, end))
    }

    const fn edge(self, offset: u32, is_start: bool) -> u32 {
        if offset < self.start || offset == self.start && (!is_start || self.removed > 0) {
            offset
        } else if offset >= self.start + self.removed {
            offset - self.removed + self.inserted
        } else if is_start {
            self.start + self.inserted
        } else {
            self.start
        }
    }
}

/// The latest edits of a text, by the revisions that they led to. It does not hold the text.
#[derive(Clone, Debug, Default)]
pub struct Journal {
    /// The revision that all edits lead to.
    revision: u64,
    /// The earliest one that they lead on from.
    first: u64,
    /// In order, each with the revision that it is a part of.
    edits: VecDeque<(u64, Edit)>,
    /// How many bytes they insert.
    bytes: usize,
}

/// So many edits are kept, and edits that insert so many bytes together: beyond, a text is told quicker as a whole.
const MAX_EDITS: usize = 1_000;
const MAX_BYTES: usize = 200_000;

impl Journal {
    /// The journal of a text of which nothing earlier is known.
    pub fn starting_at(revision: u64) -> Self {
        Self { revision, first: revision, ..Self::default() }
    }

    /// The revision of the text.
    pub const fn revision(&self) -> u64 {
        self.revision
    }

    /// Writes down how the text came to a later revision; without edits, the revision says the same.
    pub fn record(&mut self, revision: u64, edits: impl IntoIterator<Item = Edit>) {
        for edit in edits {
            self.bytes += edit.text.len();
            self.edits.push_back((revision, edit));
        }
        self.revision = revision;
        while self.edits.len() > MAX_EDITS || self.bytes > MAX_BYTES {
            let Some((lost, edit)) = self.edits.pop_front() else { return };
            self.bytes -= edit.text.len();
            self.first = lost;
        }
    }

    /// The edits that led from one revision to a later one, each of the text that those before it left; `None` if that
    /// is not known.
    pub fn between(&self, from: u64, to: u64) -> Option<impl Iterator<Item = &Edit>> {
        let is_known = self.first <= from && from <= to && to <= self.revision;
        let upto = |revision: u64| self.edits.partition_point(|(of, _)| *of <= revision);
        is_known.then(|| self.edits.range(upto(from)..upto(to)).map(|(_, edit)| edit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edit(start: u32, end: u32, text: &str) -> Edit {
        Edit { span: Span::new(start, end), text: text.to_owned() }
    }

    #[test]
    fn a_difference_is_the_least_that_turns_one_text_into_the_other() {
        let shown = |before: &str, after: &str| {
            let edit = Shift::between(before, after).edit(after);
            let mut text = before.to_owned();
            text.replace_range(edit.span.range(), &edit.text);
            assert_eq!(text, after);
            (edit.span.start, edit.span.end, edit.text)
        };
        assert_eq!(shown("abc", "abc"), (3, 3, String::new()));
        assert_eq!(shown("abc", "abxc"), (2, 2, "x".to_owned()));
        assert_eq!(shown("aaa", "aa"), (2, 3, String::new()));
        assert_eq!(shown("", "new"), (0, 0, "new".to_owned()));
        assert_eq!(shown("∞∞", "∞"), (3, 6, String::new()));
        assert_eq!(shown("[0,∞]", "[0,inf]"), (3, 6, "inf".to_owned()));
        // The first byte of both letters is the same.
        assert_eq!(shown("aéb", "aèb"), (1, 3, "è".to_owned()));
        // So is the last.
        assert_eq!(shown("\u{e9}", "\u{129}"), (0, 2, "\u{129}".to_owned()));
    }

    #[test]
    fn edits_come_to_one_that_covers_them() {
        let mut text = "one two three".to_owned();
        let edits = [edit(4, 7, "2"), edit(0, 3, ""), edit(7, 7, "!"), edit(1, 2, "∞∞")];
        for edit in &edits {
            text.replace_range(edit.span.range(), &edit.text);
        }
        let covering = Shift::of(&edits);
        let mut again = "one two three".to_owned();
        let edit = covering.edit(&text);
        again.replace_range(edit.span.range(), &edit.text);
        assert_eq!(again, text);
        assert_eq!(covering, Shift { start: 0, removed: 12, inserted: 13 });
    }

    #[test]
    fn an_edit_that_was_undone_comes_to_nothing() {
        assert!(Shift::of(&[edit(4, 4, "x"), edit(4, 5, "")]).is_nothing());
    }

    #[test]
    fn what_is_behind_an_edit_moves_and_what_is_around_it_grows() {
        let shift = Shift { start: 4, removed: 2, inserted: 5 };
        assert_eq!(shift.moved(Span::new(0, 4)), Span::new(0, 4));
        assert_eq!(shift.moved(Span::new(6, 8)), Span::new(9, 11));
        assert_eq!(shift.moved(Span::new(2, 8)), Span::new(2, 11));
        let insertion = Shift { start: 4, removed: 0, inserted: 2 };
        assert_eq!(insertion.moved(Span::new(2, 4)), Span::new(2, 4), "it ends before the insertion");
        assert_eq!(insertion.moved(Span::new(4, 5)), Span::new(6, 7), "it begins behind the insertion");
    }

    #[test]
    fn spans_survive_with_the_text_around_them() {
        let shift = Shift::between("one two three", "one 2222222 three");
        assert_eq!(shift.surviving(Span::new(0, 3)), Some(Span::new(0, 3)));
        assert_eq!(shift.surviving(Span::new(8, 13)), Some(Span::new(12, 17)));
        assert_eq!(shift.surviving(Span::new(5, 6)), None);
    }

    #[test]
    fn typing_before_a_span_pushes_it_on_and_typing_behind_it_leaves_it() {
        let before = Shift::between("ab", "xab");
        assert_eq!(before.surviving(Span::new(0, 2)), Some(Span::new(1, 3)));
        let behind = Shift::between("ab", "abx");
        assert_eq!(behind.surviving(Span::new(0, 2)), Some(Span::new(0, 2)));
    }

    #[test]
    fn a_journal_tells_the_edits_since_a_revision_as_far_back_as_it_goes() {
        let mut journal = Journal::starting_at(5);
        journal.record(6, [edit(0, 0, "a"), edit(1, 1, "b")]);
        journal.record(7, []);
        journal.record(9, [edit(2, 2, "c")]);
        let told = |from, to| {
            let edits = journal.between(from, to)?;
            Some(edits.map(|edit| edit.text.as_str()).collect::<String>())
        };
        assert_eq!(told(5, 9).as_deref(), Some("abc"));
        assert_eq!(told(6, 9).as_deref(), Some("c"));
        assert_eq!(told(5, 7).as_deref(), Some("ab"));
        assert_eq!(told(9, 9).as_deref(), Some(""));
        assert_eq!(told(4, 9), None, "nothing is known of what was before");
        assert_eq!(told(9, 6), None, "it does not go back");
        assert_eq!(told(5, 10), None, "there is no such text yet");
    }

    #[test]
    fn a_journal_forgets_what_is_long_ago_and_what_is_large() {
        let mut journal = Journal::starting_at(1);
        for revision in 2..=2_002 {
            journal.record(revision, [edit(0, 0, "x")]);
        }
        assert_eq!(journal.between(1_002, 2_002).map(Iterator::count), Some(1_000));
        assert!(journal.between(1_001, 2_002).is_none());
        journal.record(2_003, [edit(0, 0, "a"), edit(0, 0, &"x".repeat(MAX_BYTES))]);
        assert!(journal.between(2_002, 2_003).is_none());
        assert_eq!(journal.between(2_003, 2_003).map(Iterator::count), Some(0));
        journal.record(2_004, [edit(0, 0, "x")]);
        assert_eq!(journal.between(2_003, 2_004).map(Iterator::count), Some(1));
    }
}
