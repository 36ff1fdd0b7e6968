//! The text: what the author typed, where the caret is, and an exact history of edits.
//!
//! Offsets are bytes and always lie on character boundaries; lines count from 0 and end in `\n` only. What keys do to
//! the text is in [`TextCommand`](crate::TextCommand).

use std::sync::{Arc, OnceLock};

use rmpl::files::MARK;
use rmpl::{Edit, Journal, Shift, Span};

use crate::carets::Carets;
use crate::history::{Change, EditKind, Step, joins};
use crate::template::Stops;

/// Where text is selected: from `anchor`, where the selection began, to `head`, where the caret is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Caret {
    /// Byte offset where the selection began; equal to `head` if nothing is selected.
    pub anchor: usize,
    /// Byte offset of the caret.
    pub head: usize,
    /// The column that moving up and down keeps, in characters from 0.
    pub goal_column: Option<usize>,
}

impl Caret {
    /// A caret without a selection.
    pub const fn at(offset: usize) -> Self {
        Self { anchor: offset, head: offset, goal_column: None }
    }

    /// A selection from `anchor` to `head`.
    pub const fn selecting(anchor: usize, head: usize) -> Self {
        Self { anchor, head, goal_column: None }
    }

    /// The selected bytes.
    pub fn range(self) -> std::ops::Range<usize> {
        self.anchor.min(self.head)..self.anchor.max(self.head)
    }

    /// Returns whether no text is selected.
    pub const fn is_empty(self) -> bool {
        self.anchor == self.head
    }
}

/// The text with its caret and its history.
#[derive(Debug)]
pub struct Document {
    text: String,
    shared: OnceLock<Arc<str>>,
    line_starts: Vec<usize>,
    /// The lines that begin another file of the mission (`rmpl::files`).
    headings: Vec<usize>,
    journal: Journal,
    saved_revision: u64,
    pub(crate) caret: Caret,
    pub(crate) others: Vec<Caret>,
    /// Carets at which a key has done its work already while it does so at the others.
    pub(crate) parked: Vec<Caret>,
    /// Whether a key does its work at one caret after the other.
    pub(crate) is_many: bool,
    /// Where stands what was written to close a bracket or a quote.
    pub(crate) closers: Vec<usize>,
    /// The template around the caret.
    pub(crate) stops: Stops,
    pub(crate) undo: Vec<Step>,
    redo: Vec<Step>,
    pub(crate) may_join: bool,
    /// The columns at which the view breaks lines into rows.
    pub(crate) wrap_columns: Option<usize>,
}

/// What is added at the end of a text to begin another file.
const NEW_FILE: &str = "\n\u{1c}";

impl Document {
    /// A document at revision 1, with the caret at the start and no history.
    pub fn new(text: &str) -> Self {
        let text = normalized(text);
        Self {
            headings: headings(&text),
            line_starts: line_starts(&text),
            text,
            shared: OnceLock::new(),
            journal: Journal::starting_at(1),
            saved_revision: 1,
            caret: Caret::default(),
            others: Vec::new(),
            parked: Vec::new(),
            is_many: false,
            closers: Vec::new(),
            stops: Stops::default(),
            undo: Vec::new(),
            redo: Vec::new(),
            may_join: false,
            wrap_columns: None,
        }
    }

    /// Replaces everything, history included: another mission was opened. The revision continues counting.
    pub fn open(&mut self, text: &str) {
        let revision = self.revision() + 1;
        let journal = Journal::starting_at(revision);
        *self = Self { journal, wrap_columns: self.wrap_columns, ..Self::new(text) };
        self.saved_revision = revision;
    }

    /// Takes this document up again where another one was: its revisions continue from that one's.
    pub fn count_on_from(&mut self, revision: u64) {
        let is_saved = !self.is_modified();
        self.journal = Journal::starting_at(self.revision().max(revision) + 1);
        if is_saved {
            self.mark_saved();
        }
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text, shared; copied at most once per revision.
    pub fn shared_text(&self) -> Arc<str> {
        Arc::clone(self.shared.get_or_init(|| Arc::from(self.text.as_str())))
    }

    /// Counts the changes of the text, undone and redone ones included.
    pub fn revision(&self) -> u64 {
        self.journal.revision()
    }

    /// The edits since a revision, each of the text that those before it left; `None` if they are not known, as of
    /// another text and of one that was edited much since.
    pub fn edits_since(&self, revision: u64) -> Option<impl Iterator<Item = &Edit>> {
        self.journal.between(revision, self.revision())
    }

    /// Counts on without a change: something else that answers depend on has changed.
    pub fn touch(&mut self) {
        let is_saved = !self.is_modified();
        self.journal.record(self.revision() + 1, []);
        if is_saved {
            self.mark_saved();
        }
    }

    /// Returns whether the text has changed since it was opened or saved.
    pub fn is_modified(&self) -> bool {
        self.revision() != self.saved_revision
    }

    /// The present text has been saved.
    pub fn mark_saved(&mut self) {
        self.saved_revision = self.revision();
    }

    /// The caret and the selected text.
    pub fn caret(&self) -> Caret {
        self.caret
    }

    /// Moves the caret, and leaves only this one; out-of-range offsets go to the nearest character boundary before them. What is typed next
    /// starts a new step of the history.
    pub fn set_caret(&mut self, caret: Caret) {
        let caret = Caret {
            anchor: self.boundary_before(caret.anchor),
            head: self.boundary_before(caret.head),
            goal_column: caret.goal_column,
        };
        self.may_join &= caret.head == self.caret.head && caret.anchor == self.caret.anchor;
        self.caret = caret;
        self.others.clear();
        if caret.head < self.stops.range.0 || caret.head > self.stops.range.1 {
            self.stops = Stops::default();
        }
        if !self.is_many {
            self.closers.retain(|&closer| closer >= caret.head);
        }
    }

    /// The selected text.
    pub fn selected_text(&self) -> &str {
        self.text.get(self.caret.range()).unwrap_or_default()
    }

    /// Returns how many lines there are; an empty text has one.
    pub fn line_count(&self) -> usize {
        self.line_starts.len()
    }

    /// The line that holds `offset`.
    pub fn line_at(&self, offset: usize) -> usize {
        self.line_starts.partition_point(|&start| start <= offset).saturating_sub(1)
    }

    /// The bytes of a line, without its line break; the end of the text for lines beyond it.
    pub fn line_range(&self, line: usize) -> std::ops::Range<usize> {
        let start = self.line_starts.get(line).copied().unwrap_or(self.text.len());
        let end = self.line_starts.get(line + 1).map_or(self.text.len(), |&next| next - 1);
        start..end.max(start)
    }

    /// The text of a line, without its line break.
    pub fn line_text(&self, line: usize) -> &str {
        self.text.get(self.line_range(line)).unwrap_or_default()
    }

    /// The lines that begin another file of the mission: they hold its name, and no edit touches them.
    pub fn headings(&self) -> &[usize] {
        &self.headings
    }

    /// The name of the file that a line begins, if it does.
    pub fn heading(&self, line: usize) -> Option<&str> {
        self.headings.binary_search(&line).ok()?;
        self.line_text(line).strip_prefix(MARK)
    }

    /// The first line of the file that holds a line, and the one after its last; a heading belongs to no file.
    pub fn file_lines(&self, line: usize) -> std::ops::Range<usize> {
        let next = self.headings.partition_point(|&heading| heading <= line);
        let first = next.checked_sub(1).map_or(0, |own| self.headings[own] + 1);
        first..self.headings.get(next).copied().unwrap_or(self.line_count())
    }

    /// The number of a line in its file, from 1; of a heading in the file that it begins, 0.
    pub fn line_in_file(&self, line: usize) -> usize {
        (line + 1).saturating_sub(self.file_lines(line).start)
    }

    /// The bytes of the file that holds `offset`, without the line break in front of the next heading.
    pub fn file_range(&self, offset: usize) -> std::ops::Range<usize> {
        let lines = self.file_lines(self.line_at(offset));
        self.line_range(lines.start).start..self.line_range(lines.end.max(lines.start + 1) - 1).end
    }

    /// Returns whether a replacement would change where a file begins or what it is called.
    fn is_of_heading(&self, start: usize, end: usize) -> bool {
        self.headings.iter().any(|&heading| {
            let line = self.line_range(heading);
            // With the line breaks on both sides.
            let (from, to) = (line.start.saturating_sub(1), line.end + 1);
            if start == end { from < start && start < to } else { start < to && from < end }
        })
    }

    /// The column of `offset` in its line, in characters from 0.
    pub fn column_at(&self, offset: usize) -> usize {
        let start = self.line_range(self.line_at(offset)).start;
        self.text.get(start..offset).map_or(0, |before| before.chars().count())
    }

    /// The offset of a column of a line; the end of the line if it is shorter.
    pub fn offset_at(&self, line: usize, column: usize) -> usize {
        let range = self.line_range(line.min(self.line_count() - 1));
        let line = &self.text[range.clone()];
        line.char_indices().nth(column).map_or(range.end, |(at, _)| range.start + at)
    }

    /// The nearest character boundary at or before `offset`.
    pub fn boundary_before(&self, offset: usize) -> usize {
        self.text.floor_char_boundary(offset)
    }

    /// Applies disjoint edits in textual order as one step, and puts the caret at `caret`, an offset in the new text;
    /// without one it moves along with the text around it. What would change where a file begins is left out, but for a
    /// new file at the end.
    pub fn edit(&mut self, edits: &[Edit], kind: EditKind, caret: Option<Caret>) {
        if self.headings.is_empty() && !edits.iter().any(|edit| edit.text.contains(MARK)) {
            return self.edit_freely(edits, kind, caret);
        }
        let whole = |edit: &&Edit| {
            let [start, end] = [edit.span.start, edit.span.end].map(|at| self.boundary_before(at as usize));
            !self.is_of_heading(start, end.max(start))
        };
        let plain = |edit: &Edit| {
            let adds_file = edit.span.start as usize == self.text.len() && edit.text.starts_with(NEW_FILE);
            let text = if adds_file { edit.text.clone() } else { edit.text.replace(MARK, "") };
            Edit { text, ..edit.clone() }
        };
        let left: Vec<Edit> = edits.iter().filter(whole).map(plain).collect();
        let caret = caret.filter(|_| left.len() == edits.len());
        self.edit_freely(&left, kind, caret);
    }

    fn edit_freely(&mut self, edits: &[Edit], kind: EditKind, caret: Option<Caret>) {
        let mut changes = Vec::with_capacity(edits.len());
        let mut shift = 0_isize;
        let before = Carets { main: self.caret, others: self.others.clone() };
        let (mut anchor, mut head) = (self.caret.anchor, self.caret.head);
        for edit in edits {
            let shifted = |offset: u32| self.boundary_before((offset as usize).saturating_add_signed(shift));
            let start = shifted(edit.span.start);
            let end = shifted(edit.span.end).max(start);
            let inserted = normalized(&edit.text);
            let Some(removed) = self.text.get(start..end).map(str::to_owned) else { continue };
            if removed == inserted {
                continue;
            }
            anchor = moved(anchor, start, removed.len(), inserted.len());
            head = moved(head, start, removed.len(), inserted.len());
            for caret in self.others.iter_mut().chain(&mut self.parked) {
                caret.anchor = moved(caret.anchor, start, removed.len(), inserted.len());
                caret.head = moved(caret.head, start, removed.len(), inserted.len());
            }
            self.closers.retain(|&closer| closer < start || closer >= start + removed.len());
            let stops = &mut self.stops;
            for at in stops.left.iter_mut().chain([&mut stops.range.0, &mut stops.range.1]) {
                *at = moved(*at, start, removed.len(), inserted.len());
            }
            for closer in &mut self.closers {
                *closer = moved(*closer, start, removed.len(), inserted.len());
            }
            shift += inserted.len() as isize - removed.len() as isize;
            changes.push(Change { start, removed, inserted });
            if let Some(change) = changes.last() {
                self.text.replace_range(change.start..change.start + change.removed.len(), &change.inserted);
            }
        }
        if changes.is_empty() {
            if let Some(caret) = caret {
                self.set_caret(caret);
            }
            return;
        }
        self.text_changed(changes.iter().map(|it| it.edit(true)).collect());
        let after = caret.unwrap_or(Caret::selecting(anchor, head));
        self.caret = Caret {
            anchor: self.boundary_before(after.anchor),
            head: self.boundary_before(after.head),
            goal_column: None,
        };
        for caret in self.others.iter_mut().chain(&mut self.parked) {
            caret.anchor = self.text.floor_char_boundary(caret.anchor);
            caret.head = self.text.floor_char_boundary(caret.head);
        }
        let after = Carets { main: self.caret, others: self.others.clone() };
        self.record(Step { kind, changes, before, after });
    }

    /// Replaces a span as one step and puts the caret after the new text.
    pub fn replace(&mut self, span: Span, text: &str, kind: EditKind) {
        let end = self.boundary_before(span.start as usize) + normalized(text).len();
        self.edit(&[Edit { span, text: text.to_owned() }], kind, Some(Caret::at(end)));
    }

    /// Replaces the whole text, its files included, as one undoable step, changing only what differs.
    pub fn replace_all(&mut self, text: &str) {
        let text = normalized(text);
        let edit = Shift::between(&self.text, &text).edit(&text);
        self.edit_freely(&[edit], EditKind::Single, None);
    }

    /// Returns whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Returns whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.redo.is_empty()
    }

    /// Takes the last step back, caret included.
    pub fn undo(&mut self) {
        let Some(step) = self.undo.pop() else { return };
        let edits: Vec<Edit> = step.changes.iter().rev().map(|change| change.edit(false)).collect();
        for edit in &edits {
            self.text.replace_range(edit.span.range(), &edit.text);
        }
        (self.caret, self.others) = (step.before.main, step.before.others.clone());
        self.closers.clear();
        self.stops = Stops::default();
        self.redo.push(step);
        self.may_join = false;
        self.text_changed(edits);
    }

    /// Makes the last step that was taken back again.
    pub fn redo(&mut self) {
        let Some(step) = self.redo.pop() else { return };
        let edits: Vec<Edit> = step.changes.iter().map(|change| change.edit(true)).collect();
        for edit in &edits {
            self.text.replace_range(edit.span.range(), &edit.text);
        }
        (self.caret, self.others) = (step.after.main, step.after.others.clone());
        self.closers.clear();
        self.stops = Stops::default();
        self.undo.push(step);
        self.may_join = false;
        self.text_changed(edits);
    }

    fn text_changed(&mut self, edits: Vec<Edit>) {
        self.line_starts = line_starts(&self.text);
        self.headings = headings(&self.text);
        self.shared = OnceLock::new();
        self.journal.record(self.revision() + 1, edits);
    }

    fn record(&mut self, step: Step) {
        self.redo.clear();
        if self.may_join
            && let Some(last) = self.undo.last_mut()
            && joins(last, &step)
        {
            last.changes.extend(step.changes);
            last.after = step.after;
        } else {
            self.undo.push(step);
        }
        self.may_join = true;
    }
}

impl Default for Document {
    fn default() -> Self {
        Self::new("")
    }
}

/// Returns where `offset` ends up when `removed` bytes at `start` become `inserted` bytes.
fn moved(offset: usize, start: usize, removed: usize, inserted: usize) -> usize {
    if offset < start {
        offset
    } else if offset >= start + removed {
        offset - removed + inserted
    } else {
        start + (offset - start).min(inserted)
    }
}

fn normalized(text: &str) -> String {
    if text.contains('\r') { text.replace("\r\n", "\n").replace('\r', "\n") } else { text.to_owned() }
}

fn line_starts(text: &str) -> Vec<usize> {
    let breaks = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(at, _)| at + 1);
    std::iter::once(0).chain(breaks).collect()
}

/// The lines that begin another file of the mission.
fn headings(text: &str) -> Vec<usize> {
    if !text.contains(MARK) {
        return Vec::new();
    }
    let lines = text.split('\n').enumerate();
    lines.filter(|(line, text)| *line > 0 && text.starts_with(MARK)).map(|(line, _)| line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, TextCommand};

    fn apply(document: &mut Document, commands: &[TextCommand]) {
        for command in commands {
            command.apply(document);
        }
    }

    fn typed(text: &str) -> Vec<TextCommand> {
        text.chars().map(|character| TextCommand::Insert(character.to_string())).collect()
    }

    #[test]
    fn words_are_undone_one_by_one_and_a_moved_caret_starts_a_new_step() {
        let mut document = Document::new("");
        apply(&mut document, &typed("delay two"));
        apply(&mut document, &[TextCommand::Move { motion: Motion::Left, select: false }]);
        apply(&mut document, &typed("x"));
        assert_eq!(document.text(), "delay twxo");
        document.undo();
        assert_eq!(document.text(), "delay two");
        document.undo();
        assert_eq!(document.text(), "delay ");
        document.undo();
        assert_eq!(document.text(), "");
        assert!(!document.can_undo());
    }

    #[test]
    fn several_edits_are_one_step_and_the_caret_stays_with_its_text() {
        let mut document = Document::new("a b a b");
        document.set_caret(Caret::at(6));
        let edit = |start, end, text: &str| Edit { span: Span::new(start, end), text: text.to_owned() };
        document.edit(&[edit(0, 1, "long"), edit(4, 5, "")], EditKind::Single, None);
        assert_eq!(document.text(), "long b  b");
        assert_eq!(document.caret(), Caret::at(8));
        document.undo();
        assert_eq!(document.text(), "a b a b");
        assert_eq!(document.caret(), Caret::at(6));
        document.redo();
        assert_eq!(document.text(), "long b  b");
    }

    #[test]
    fn a_drag_is_undone_as_a_whole() {
        let mut document = Document::new("location A (1, 2);");
        for x in ["3", "45", "6"] {
            let end = document.text().find(',').expect("a comma") as u32;
            document.replace(Span::new(12, end), x, EditKind::Drag(1));
        }
        assert_eq!(document.text(), "location A (6, 2);");
        document.undo();
        assert_eq!(document.text(), "location A (1, 2);");
    }

    #[test]
    fn any_mix_of_keys_can_be_undone_to_the_start_and_redone_to_the_end() {
        let motions = [
            Motion::Left,
            Motion::Right,
            Motion::WordLeft,
            Motion::WordRight,
            Motion::LineStart,
            Motion::LineEnd,
            Motion::Up(1),
            Motion::Down(2),
            Motion::TextStart,
            Motion::TextEnd,
        ];
        let start = "scenario S = {\n  délai[0,∞];\n\tA(x, y)\n}\n";
        for seed in 0..200_u64 {
            let mut document = Document::new(start);
            let mut random = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
            let mut next = |below: u64| {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                random % below
            };
            for _ in 0..40 {
                let motion = motions[next(motions.len() as u64) as usize];
                let command = match next(14) {
                    0 => TextCommand::Insert("é".to_owned()),
                    1 => TextCommand::Insert("}".to_owned()),
                    2 => TextCommand::Paste("a\r\n∞b".to_owned()),
                    3 => TextCommand::NewLine,
                    4 => TextCommand::Indent,
                    5 => TextCommand::Outdent,
                    6 => TextCommand::Delete(motion),
                    7 => TextCommand::DuplicateLines,
                    8 => TextCommand::MoveLinesUp,
                    9 => TextCommand::MoveLinesDown,
                    10 => TextCommand::ToggleComment,
                    11 => TextCommand::SelectWord(next(60) as usize),
                    12 => TextCommand::DeleteLines,
                    _ => TextCommand::Move { motion, select: next(2) == 0 },
                };
                let (revision, mut followed) = (document.revision(), document.text().to_owned());
                command.apply(&mut document);
                for edit in document.edits_since(revision).expect("the edits of one key are known") {
                    followed.replace_range(edit.span.range(), &edit.text);
                }
                assert_eq!(followed, document.text(), "seed {seed}: {command:?}");
                let caret = document.caret();
                assert!(document.text().is_char_boundary(caret.head), "seed {seed}: {command:?}");
                assert!(document.text().is_char_boundary(caret.anchor), "seed {seed}: {command:?}");
            }
            let end = document.text().to_owned();
            while document.can_undo() {
                document.undo();
            }
            assert_eq!(document.text(), start, "seed {seed}");
            while document.can_redo() {
                document.redo();
            }
            assert_eq!(document.text(), end, "seed {seed}");
        }
    }
}
