//! What editing keys do to a [`Document`]: typing, deleting, moving, indenting, commenting, moving lines.
//!
//! Everything here is a pure change of the document, so that several keys of one frame apply one after the other and
//! every one can be tested without a window.

use rmpl::{Edit, Span};
use unicode_segmentation::{GraphemeCursor, UnicodeSegmentation as _};

use crate::{Caret, Document, EditKind, pairs};

/// Blanks per level of indentation, as the formatter writes them.
pub const INDENT: &str = "  ";

/// A change of the text or of the caret, as a key asks for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TextCommand {
    /// Typed characters replace the selection.
    Insert(String),
    /// Pasted text replaces the selection, as one step.
    Paste(String),
    /// A line break, indented like its line and one deeper after an opening bracket.
    NewLine,
    /// Goes to the next stop of a template, or indents the selected lines, or inserts blanks up to the next level.
    Indent,
    /// Takes one level of indentation from the selected lines.
    Outdent,
    /// Deletes the selection, or what the motion passes over.
    Delete(Motion),
    /// Moves the caret; with `select` the selection grows.
    Move {
        motion: Motion,
        /// Whether the selection's other end stays.
        select: bool,
    },
    /// Selects from one offset to another; the caret goes to `head`.
    Select {
        /// Where the selection begins.
        anchor: usize,
        /// Where the caret goes.
        head: usize,
    },
    /// Selects the word at an offset.
    SelectWord(usize),
    /// Selects the line at an offset, with its line break.
    SelectLine(usize),
    /// Selects everything.
    SelectAll,
    /// Selects the lines that the selection touches, and one more if they are selected already.
    SelectLines,
    /// Selects the word at the caret, or with what is selected where it stands next, too.
    SelectNextOccurrence,
    /// Another caret at an offset, or one less.
    ToggleCaret(usize),
    /// Another caret in the line above.
    AddCaretAbove,
    /// Another caret in the line below.
    AddCaretBelow,
    /// Leaves the main caret only.
    OneCaret,
    /// Repeats the selected lines above themselves.
    CopyLinesUp,
    /// Repeats the selected lines below themselves.
    DuplicateLines,
    /// Deletes the selected lines.
    DeleteLines,
    /// Moves the selected lines one line up.
    MoveLinesUp,
    /// Moves the selected lines one line down.
    MoveLinesDown,
    /// Comments the selected lines out, or in again if all of them are comments.
    ToggleComment,
    /// Takes the last step back.
    Undo,
    /// Makes the last step that was taken back again.
    Redo,
}

/// A movement of the caret.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// One character as people count them, to the left.
    Left,
    /// One to the right.
    Right,
    /// To the start of the word before.
    WordLeft,
    /// To the end of the word after.
    WordRight,
    /// To the first character of the line that is not blank, or to its start if there already; of a line that is broken
    /// into rows, first to the start of the row.
    LineStart,
    /// To the end of the line; of one that is broken into rows, first to the end of the row.
    LineEnd,
    /// Rows up; a line has one, unless it is broken into several.
    Up(usize),
    /// Rows down.
    Down(usize),
    TextStart,
    TextEnd,
}

impl TextCommand {
    /// Applies the command.
    pub fn apply(&self, document: &mut Document) {
        match self {
            Self::Paste(text) => paste(document, text),
            Self::Insert(_) | Self::NewLine | Self::Delete(_) | Self::Move { .. } => {
                document.at_each_caret(|document, _| self.apply_at_caret(document));
            }
            _ => self.apply_at_caret(document),
        }
    }

    fn apply_at_caret(&self, document: &mut Document) {
        match self {
            Self::Insert(text) => insert(document, text),
            Self::Paste(text) => document.replace(selected(document), text, EditKind::Single),
            Self::SelectLines => {
                let lines = selected_lines(document);
                let start = document.line_range(lines.start).start;
                let end = next_line_start(document, lines.end - 1);
                let end = if document.caret().range() == (start..end) {
                    next_line_start(document, document.line_at(end))
                } else {
                    end
                };
                document.set_caret(Caret::selecting(start, end));
            }
            Self::SelectNextOccurrence => document.select_next_occurrence(),
            Self::ToggleCaret(offset) => document.toggle_caret(*offset),
            Self::AddCaretAbove => document.add_caret_beside(false),
            Self::AddCaretBelow => document.add_caret_beside(true),
            Self::OneCaret => document.set_caret(document.caret()),
            Self::CopyLinesUp => {
                let caret = document.caret();
                duplicate_lines(document);
                document.set_caret(caret);
            }
            Self::NewLine => new_line(document),
            Self::Indent if document.go_to_next_stop() => {}
            Self::Indent => indent(document),
            Self::Outdent => outdent(document),
            Self::Delete(motion) => delete(document, *motion),
            Self::Move { motion, select } => move_caret(document, *motion, *select),
            Self::Select { anchor, head } => document.set_caret(Caret::selecting(*anchor, *head)),
            Self::SelectWord(offset) => {
                let range = word_at(document.text(), document.boundary_before(*offset));
                document.set_caret(Caret::selecting(range.start, range.end));
            }
            Self::SelectLine(offset) => {
                let line = document.line_at(*offset);
                let start = document.line_range(line).start;
                let end = next_line_start(document, line);
                document.set_caret(Caret::selecting(start, end));
            }
            Self::SelectAll => {
                let file = document.file_range(document.caret().head);
                document.set_caret(Caret::selecting(file.start, file.end));
            }
            Self::DuplicateLines => duplicate_lines(document),
            Self::DeleteLines => {
                let lines = selected_lines(document);
                let start = document.line_range(lines.start).start;
                let end = next_line_start(document, lines.end - 1);
                document.replace(span(start, end), "", EditKind::Single);
            }
            Self::MoveLinesUp => move_lines(document, true),
            Self::MoveLinesDown => move_lines(document, false),
            Self::ToggleComment => toggle_comment(document),
            Self::Undo => document.undo(),
            Self::Redo => document.redo(),
        }
    }
}

/// The word around `offset`, or the run of blanks or signs there.
pub fn word_at(text: &str, offset: usize) -> std::ops::Range<usize> {
    let class = |c: char| {
        if is_name_character(c) { 2 } else { u8::from(!c.is_whitespace()) }
    };
    let before = text[..offset].chars().next_back().filter(|&c| c != '\n').map(class);
    let after = text[offset..].chars().next().filter(|&c| c != '\n').map(class);
    let Some(wanted) = before.max(after) else { return offset..offset };
    let belongs = |c: &char| *c != '\n' && class(*c) == wanted;
    let left: usize = text[..offset].chars().rev().take_while(belongs).map(char::len_utf8).sum();
    let right: usize = text[offset..].chars().take_while(belongs).map(char::len_utf8).sum();
    offset - left..offset + right
}

/// Returns whether a character is part of names such as `Group-Traverse-Path`.
pub fn is_name_character(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '-'
}

fn span(start: usize, end: usize) -> Span {
    Span::new(start as u32, end as u32)
}

fn selected(document: &Document) -> Span {
    let range = document.caret().range();
    span(range.start, range.end)
}

/// The lines that the selection touches; a selection that ends at a line's start does not touch that line.
fn selected_lines(document: &Document) -> std::ops::Range<usize> {
    let range = document.caret().range();
    let first = document.line_at(range.start);
    let mut last = document.line_at(range.end);
    if last > first && document.line_range(last).start == range.end {
        last -= 1;
    }
    first..last + 1
}

fn next_line_start(document: &Document, line: usize) -> usize {
    if line + 1 < document.line_count() { document.line_range(line + 1).start } else { document.text().len() }
}

/// Pastes at every caret: one line to each if there are as many, otherwise all of it.
fn paste(document: &mut Document, text: &str) {
    let lines: Vec<&str> = text.lines().collect();
    let carets = document.carets().len();
    let is_one_each = carets > 1 && lines.len() == carets;
    document.at_each_caret(|document, index| {
        let text = if is_one_each { lines[index] } else { text };
        document.replace(selected(document), text, EditKind::Single);
    });
}

fn insert(document: &mut Document, text: &str) {
    if pairs::insert(document, text) {
        return;
    }
    let caret = document.caret();
    let line = document.line_range(document.line_at(caret.head));
    let before = document.text().get(line.start..caret.range().start).unwrap_or_default();
    // A closing brace on a line of its own belongs under the line that opened the block.
    if text == "}" && caret.is_empty() && !before.is_empty() && before.trim().is_empty() {
        let kept = before.len().saturating_sub(INDENT.len());
        let edit = span(line.start + kept, caret.head);
        document.replace(edit, text, EditKind::Typing);
    } else {
        document.replace(selected(document), text, EditKind::Typing);
    }
}

fn new_line(document: &mut Document) {
    let range = document.caret().range();
    let line = document.line_range(document.line_at(range.start));
    let before = document.text().get(line.start..range.start).unwrap_or_default();
    let indent: String = before.chars().take_while(|c| *c == ' ' || *c == '\t').collect();
    let opens = before.trim_end().ends_with(['{', '(', '[']);
    let after = document.text().get(range.end..).unwrap_or_default();
    let closes = after.trim_start_matches([' ', '\t']).starts_with(['}', ')', ']']);
    let deeper = if opens { INDENT } else { "" };
    let text =
        if opens && closes { format!("\n{indent}{deeper}\n{indent}") } else { format!("\n{indent}{deeper}") };
    let caret = Caret::at(range.start + 1 + indent.len() + deeper.len());
    let edit = Edit { span: span(range.start, range.end), text };
    document.edit(&[edit], EditKind::Typing, Some(caret));
}

fn indent(document: &mut Document) {
    let caret = document.caret();
    let lines = selected_lines(document);
    if caret.is_empty() || lines.len() == 1 && document.line_range(lines.start) != caret.range() {
        let column = document.column_at(caret.range().start);
        let blanks = INDENT.len() - column % INDENT.len();
        document.replace(selected(document), &" ".repeat(blanks), EditKind::Single);
        return;
    }
    let edits: Vec<Edit> = lines
        .filter(|&line| !document.line_text(line).trim().is_empty())
        .map(|line| {
            let start = document.line_range(line).start;
            Edit { span: span(start, start), text: INDENT.to_owned() }
        })
        .collect();
    document.edit(&edits, EditKind::Single, None);
}

fn outdent(document: &mut Document) {
    let edits: Vec<Edit> = selected_lines(document)
        .filter_map(|line| {
            let start = document.line_range(line).start;
            let text = document.line_text(line);
            let blanks = if text.starts_with('\t') {
                1
            } else {
                text.bytes().take(INDENT.len()).take_while(|&byte| byte == b' ').count()
            };
            (blanks > 0).then(|| Edit { span: span(start, start + blanks), text: String::new() })
        })
        .collect();
    document.edit(&edits, EditKind::Single, None);
}

fn delete(document: &mut Document, motion: Motion) {
    let caret = document.caret();
    if !caret.is_empty() {
        document.replace(selected(document), "", EditKind::Single);
        return;
    }
    if motion == Motion::Left && pairs::delete_empty(document) {
        return;
    }
    let (to, _) = destination(document, motion);
    let (start, end) = (to.min(caret.head), to.max(caret.head));
    document.replace(span(start, end), "", EditKind::Deleting);
}

fn move_caret(document: &mut Document, motion: Motion, select: bool) {
    let caret = document.caret();
    // A selection is left at the end that the arrow points to.
    let collapsed = match motion {
        Motion::Left if !select && !caret.is_empty() => Some(caret.range().start),
        Motion::Right if !select && !caret.is_empty() => Some(caret.range().end),
        _ => None,
    };
    let (head, goal_column) = collapsed.map_or_else(|| destination(document, motion), |at| (at, None));
    let anchor = if select { caret.anchor } else { head };
    document.set_caret(Caret { anchor, head, goal_column });
}

/// Returns where a motion leads from the caret, and the column it keeps.
fn destination(document: &Document, motion: Motion) -> (usize, Option<usize>) {
    let text = document.text();
    let head = document.caret().head;
    let line = document.line_at(head);
    let row = document.row_in_line(head);
    let column = document.caret().goal_column.unwrap_or_else(|| document.column_in_row(head));
    let away = |rows: usize, down: bool| {
        let (line, row) = document.row_away(line, row, rows, down);
        (document.offset_in_row(line, row, column), Some(column))
    };
    let grapheme = |forwards: bool| {
        let mut cursor = GraphemeCursor::new(head, text.len(), true);
        let found = if forwards { cursor.next_boundary(text, 0) } else { cursor.prev_boundary(text, 0) };
        found.ok().flatten().unwrap_or(head)
    };
    match motion {
        Motion::Left => (grapheme(false), None),
        Motion::Right => (grapheme(true), None),
        Motion::WordLeft => (word_left(text, head), None),
        Motion::WordRight => (word_right(text, head), None),
        Motion::LineStart => (line_start(document, line, row), None),
        Motion::LineEnd => {
            let rows = document.rows_of_line(line);
            let end = document.last_place(&rows, row);
            (if head == end { document.line_range(line).end } else { end }, None)
        }
        Motion::Up(rows) if line == 0 && row == 0 && rows > 0 => (0, Some(column)),
        Motion::Up(rows) => away(rows, false),
        Motion::Down(rows) if rows > 0 && document.row_away(line, row, 1, true) == (line, row) => {
            (text.len(), Some(column))
        }
        Motion::Down(rows) => away(rows, true),
        Motion::TextStart => (0, None),
        Motion::TextEnd => (text.len(), None),
    }
}

/// The start of the row, where it is not the first one of its line and the caret not there; then the first character of
/// the line that is not blank, and then the line's start.
fn line_start(document: &Document, line: usize, row: usize) -> usize {
    let head = document.caret().head;
    let start = document.rows_of_line(line)[row].start;
    if row > 0 && head != start {
        return start;
    }
    let text = document.line_text(line);
    let range = document.line_range(line);
    let first = range.start + text.len() - text.trim_start().len();
    if head == first { range.start } else { first }
}

fn word_left(text: &str, offset: usize) -> usize {
    let before = &text[..offset];
    let trimmed = before.trim_end_matches([' ', '\t']);
    if trimmed.len() < before.len() && trimmed.ends_with('\n') || trimmed.is_empty() {
        return trimmed.len();
    }
    if let Some(line) = trimmed.strip_suffix('\n') {
        return line.len();
    }
    word_at(text, trimmed.len())
        .start
        .min(trimmed.len() - trimmed.graphemes(true).next_back().map_or(0, str::len))
}

fn word_right(text: &str, offset: usize) -> usize {
    let after = &text[offset..];
    let blanks = after.len() - after.trim_start_matches([' ', '\t']).len();
    let start = offset + blanks;
    match text[start..].graphemes(true).next() {
        None => text.len(),
        Some("\n") if blanks > 0 => start,
        Some("\n") => start + 1,
        Some(first) => {
            let wanted = first.chars().all(is_name_character);
            let run =
                text[start..].chars().take_while(|&c| !c.is_whitespace() && is_name_character(c) == wanted);
            start + run.map(char::len_utf8).sum::<usize>().max(first.len())
        }
    }
}

fn duplicate_lines(document: &mut Document) {
    let caret = document.caret();
    let lines = selected_lines(document);
    let start = document.line_range(lines.start).start;
    let end = document.line_range(lines.end - 1).end;
    let copy = format!("\n{}", &document.text()[start..end]);
    let moved = Caret::selecting(caret.anchor + copy.len(), caret.head + copy.len());
    document.edit(&[Edit { span: span(end, end), text: copy }], EditKind::Single, Some(moved));
}

fn move_lines(document: &mut Document, up: bool) {
    let lines = selected_lines(document);
    if up && lines.start == 0 || !up && lines.end >= document.line_count() {
        return;
    }
    let caret = document.caret();
    let block = document.line_range(lines.start).start..document.line_range(lines.end - 1).end;
    let text = document.text();
    let (edit, shift) = if up {
        let above = document.line_range(lines.start - 1);
        let swapped = format!("{}\n{}", &text[block.clone()], &text[above.clone()]);
        let shift = -((above.len() + 1) as isize);
        (Edit { span: span(above.start, block.end), text: swapped }, shift)
    } else {
        let below = document.line_range(lines.end);
        let swapped = format!("{}\n{}", &text[below.clone()], &text[block.clone()]);
        let shift = (below.len() + 1) as isize;
        (Edit { span: span(block.start, below.end), text: swapped }, shift)
    };
    let moved =
        Caret::selecting(caret.anchor.saturating_add_signed(shift), caret.head.saturating_add_signed(shift));
    document.edit(&[edit], EditKind::Single, Some(moved));
}

fn toggle_comment(document: &mut Document) {
    let lines: Vec<usize> =
        selected_lines(document).filter(|&line| !document.line_text(line).trim().is_empty()).collect();
    let marker = comment_marker(document.text());
    let first = |line: usize| {
        let text = document.line_text(line);
        (document.line_range(line).start + text.len() - text.trim_start().len(), text.trim_start())
    };
    let all_comments = lines.iter().all(|&line| first(line).1.starts_with(marker));
    let edits: Vec<Edit> = if all_comments {
        lines
            .iter()
            .map(|&line| {
                let (start, text) = first(line);
                let blank = usize::from(text[marker.len()..].starts_with(' '));
                Edit { span: span(start, start + marker.len() + blank), text: String::new() }
            })
            .collect()
    } else {
        let column = lines
            .iter()
            .map(|&line| first(line).0 - document.line_range(line).start)
            .min()
            .unwrap_or_default();
        lines
            .iter()
            .map(|&line| {
                let start = document.line_range(line).start + column;
                Edit { span: span(start, start), text: format!("{marker} ") }
            })
            .collect()
    };
    document.edit(&edits, EditKind::Single, None);
}

/// Returns how a line is commented out: control programs (SPEC 2) are in prefix form and use `;`.
fn comment_marker(text: &str) -> &'static str {
    let mut lines = text.lines().map(str::trim_start).filter(|line| !line.is_empty());
    if lines.clone().any(|line| line.starts_with("//")) {
        return "//";
    }
    match lines.next() {
        Some(line) if line.starts_with(['(', ';']) || line.contains("()::") || line.contains("() ::") => ";",
        _ => "//",
    }
}
