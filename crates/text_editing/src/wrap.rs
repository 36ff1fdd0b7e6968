//! Long lines broken into rows of the width of a view: where they break, which row stands where, and how a caret moves
//! from row to row.
//!
//! Widths are columns of a font in which all characters are as wide, or twice as wide. A place between two rows of a line
//! belongs to the row that it begins.

use std::ops::Range;

use unicode_segmentation::UnicodeSegmentation as _;

use crate::{Document, INDENT, Rows};

/// Lines are not broken into rows of fewer columns.
pub const MIN_WRAP_COLUMNS: usize = 20;

/// Columns of a tab, as the view draws it.
const TAB_COLUMNS: usize = 4;

/// Characters from here on are twice as wide: Hangul, Han, Kana, full-width forms, pictographs.
const FIRST_WIDE: char = '\u{1100}';

/// Returns where a line breaks into rows of so many columns, in bytes of the line; at least one row. Rows end after
/// blanks and signs where they can, and within a word where it is longer than a row. One blank may hang over the end of
/// a row.
fn break_line(text: &str, columns: usize) -> Vec<Range<usize>> {
    let columns = columns.max(MIN_WRAP_COLUMNS);
    // A character has no more columns than bytes, but for tabs.
    if text.len() <= columns && !text.contains('\t') {
        return vec![Range { start: 0, end: text.len() }];
    }
    let hanging = hanging_columns(text, columns);
    let mut rows = Vec::new();
    let (mut start, mut used) = (0, 0);
    // Behind the last sign after which the row may end, and the columns up to there.
    let mut good = (0, 0);
    for (at, grapheme) in text.grapheme_indices(true) {
        let width = columns_of(grapheme);
        let room = if start == 0 { columns } else { columns - hanging };
        let is_blank = grapheme.chars().all(char::is_whitespace);
        if used + width > room && !(is_blank && used <= room) {
            let (end, done) = if good.0 > start { good } else { (at, used) };
            rows.push(start..end);
            (start, used) = (end, used - done);
        }
        used += width;
        let end = at + grapheme.len();
        if is_blank && !text[start..at].trim().is_empty()
            || grapheme.ends_with([',', ';', ')', '}', ']', '|'])
        {
            good = (end, used);
        }
    }
    rows.push(start..text.len());
    rows
}

/// The columns by which the rows of a line after its first one stand further right: as its own text, and a level more.
fn hanging_columns(text: &str, columns: usize) -> usize {
    let columns = columns.max(MIN_WRAP_COLUMNS);
    let is_blank = |grapheme: &&str| grapheme.chars().all(char::is_whitespace);
    // More than half of the columns are none of the indent.
    let blanks = text.graphemes(true).take_while(is_blank).take(columns);
    let indent: usize = blanks.map(columns_of).sum();
    (indent + INDENT.len()).min(columns / 2)
}

fn columns_of(grapheme: &str) -> usize {
    match grapheme.chars().next() {
        Some('\t') => TAB_COLUMNS,
        Some(first) if first >= FIRST_WIDE => 2,
        _ => 1,
    }
}

impl Document {
    /// The columns at which the view breaks lines into rows, if it does.
    pub fn wrap_columns(&self) -> Option<usize> {
        self.wrap_columns
    }

    /// From now on the view breaks lines into rows of so many columns, or does not. The text stays as it is.
    pub fn wrap_at(&mut self, columns: Option<usize>) {
        self.wrap_columns = columns;
    }

    /// The rows of a line, in bytes of the text; at least one. The name of a file has one.
    pub fn rows_of_line(&self, line: usize) -> Vec<Range<usize>> {
        let range = self.line_range(line);
        match self.wrap_columns {
            Some(columns) if self.heading(line).is_none() => {
                let rows = break_line(self.line_text(line), columns).into_iter();
                rows.map(|row| range.start + row.start..range.start + row.end).collect()
            }
            _ => vec![range],
        }
    }

    /// The columns by which a row of a line stands further right than the line.
    pub fn hanging_columns(&self, line: usize, row: usize) -> usize {
        self.wrap_columns
            .filter(|_| row > 0)
            .map_or(0, |columns| hanging_columns(self.line_text(line), columns))
    }

    /// Returns which of the rows of its line holds `offset`.
    pub fn row_in_line(&self, offset: usize) -> usize {
        let rows = self.rows_of_line(self.line_at(offset));
        rows.partition_point(|row| row.start <= offset).saturating_sub(1)
    }

    /// The column of `offset` on screen, in characters from 0.
    pub fn column_in_row(&self, offset: usize) -> usize {
        let line = self.line_at(offset);
        let row = self.row_in_line(offset);
        let start = self.rows_of_line(line)[row].start;
        let before = self.text().get(start..offset).map_or(0, |before| before.chars().count());
        self.hanging_columns(line, row) + before
    }

    /// The place at a column on screen of a row of a line, or the row's last place if it is shorter.
    pub fn offset_in_row(&self, line: usize, row: usize, column: usize) -> usize {
        let rows = self.rows_of_line(line);
        let row = row.min(rows.len() - 1);
        let column = column.saturating_sub(self.hanging_columns(line, row));
        let text = &self.text()[rows[row].clone()];
        let found = text.char_indices().nth(column).map(|(at, _)| rows[row].start + at);
        found.unwrap_or_else(|| self.last_place(&rows, row))
    }

    /// The last place in a row: the end of its line, or in front of what the row ends with.
    pub(crate) fn last_place(&self, rows: &[Range<usize>], row: usize) -> usize {
        let Range { start, end } = rows[row];
        if row + 1 == rows.len() {
            return end;
        }
        end - self.text()[start..end].graphemes(true).next_back().map_or(0, str::len)
    }

    /// The line and the row in it so many rows above or below another; the first or the last one if there are fewer.
    pub(crate) fn row_away(&self, line: usize, row: usize, steps: usize, down: bool) -> (usize, usize) {
        let (mut line, mut row) = (line, row as isize);
        let mut left = steps as isize;
        if down {
            loop {
                let count = self.rows_of_line(line).len() as isize;
                if row + left < count {
                    return (line, (row + left) as usize);
                }
                if line + 1 == self.line_count() {
                    return (line, (count - 1) as usize);
                }
                left -= count - row;
                (line, row) = (line + 1, 0);
            }
        }
        while row < left {
            if line == 0 {
                return (0, 0);
            }
            left -= row + 1;
            line -= 1;
            row = self.rows_of_line(line).len() as isize - 1;
        }
        (line, (row - left) as usize)
    }
}

/// Which row of which line is in which row of the view, where lines are broken into rows. All count from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WrappedRows {
    /// The first row of each line, and after the last one how many there are. What is folded away has none.
    first_rows: Vec<usize>,
}

impl WrappedRows {
    /// The rows of a document, some lines of which are folded away.
    pub fn new(document: &Document, folded: &Rows) -> Self {
        let mut first_rows = Vec::with_capacity(document.line_count() + 1);
        let (mut row, mut line) = (0, 0);
        while line < document.line_count() {
            if let Some(hidden) = folded.hiding(line) {
                first_rows.extend(hidden.clone().map(|_| row));
                line = hidden.end;
            } else {
                first_rows.push(row);
                row += document.rows_of_line(line).len();
                line += 1;
            }
        }
        first_rows.truncate(document.line_count());
        first_rows.push(row);
        Self { first_rows }
    }

    /// The first row of a line; for a line that is folded away, the row before it.
    pub fn row_of(&self, line: usize) -> usize {
        let at = |line: usize| self.first_rows.get(line).copied();
        match (at(line), at(line + 1)) {
            (Some(row), Some(next)) if row == next => row.saturating_sub(1),
            (Some(row), _) => row,
            (None, _) => self.count(),
        }
    }

    /// The line in a row, and which of its rows that is.
    pub fn place_of(&self, row: usize) -> (usize, usize) {
        let line = self.first_rows.partition_point(|&first| first <= row).saturating_sub(1);
        let line = line.min(self.first_rows.len().saturating_sub(2));
        (line, row.saturating_sub(self.first_rows.get(line).copied().unwrap_or_default()))
    }

    /// Returns how many rows there are.
    pub fn count(&self) -> usize {
        self.first_rows.last().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Caret, Motion, TextCommand};

    fn broken(text: &str, columns: usize) -> Vec<&str> {
        break_line(text, columns).into_iter().map(|row| &text[row]).collect()
    }

    #[test]
    fn rows_end_behind_blanks_and_signs_and_within_words_that_are_longer_than_a_row() {
        assert_eq!(broken("short", 20), ["short"]);
        assert_eq!(broken("", 20), [""]);
        assert_eq!(
            broken("Drive(Rover1,Base); Drive(Rover1,Rim)", 20),
            ["Drive(Rover1,Base); ", "Drive(Rover1,Rim)"]
        );
        assert_eq!(
            broken("aaaaaaaaaabbbbbbbbbbccccccccccdddddddddd", 20),
            ["aaaaaaaaaabbbbbbbbbb", "ccccccccccdddddddd", "dd"]
        );
        // The rows after the first stand two columns further right than the line.
        assert_eq!(broken("    one two three four five six", 20), ["    one two three ", "four five six"]);
        assert_eq!(hanging_columns("    one", 20), 6);
    }

    #[test]
    fn whatever_a_line_holds_its_rows_follow_each_other_and_fit_but_for_a_blank() {
        for text in [
            "x".repeat(500),
            " ".repeat(500),
            "één mañana ∞ 漢字漢字漢字漢字漢字漢字漢字 e\u{301}e\u{301} 👩‍🚀👩‍🚀👩‍🚀".repeat(5),
            "\t\tA(),\tB()".repeat(9),
            "a, b; c) d} ".repeat(40),
        ] {
            for columns in [0, 20, 21, 37, 80] {
                let rows = break_line(&text, columns);
                let columns = columns.max(MIN_WRAP_COLUMNS);
                assert_eq!(rows.iter().map(|row| &text[row.clone()]).collect::<String>(), text);
                for (index, row) in rows.iter().enumerate() {
                    assert!(rows.len() == 1 || !row.is_empty(), "{text:?} {columns}");
                    let width: usize = text[row.clone()].graphemes(true).map(columns_of).sum();
                    let room = columns - if index == 0 { 0 } else { hanging_columns(&text, columns) };
                    let hangs = text[row.clone()].ends_with(char::is_whitespace);
                    assert!(
                        width <= room + if hangs { TAB_COLUMNS } else { 0 },
                        "{text:?} {columns} {row:?}"
                    );
                }
            }
        }
    }

    fn wrapped() -> Document {
        let mut document =
            Document::new("one two three four five six seven\nend\n\nlast line of this text here");
        document.wrap_at(Some(20));
        document
    }

    /// "one two three four " / "  five six seven" / "end" / "" / "last line of this " / "  text here".
    #[test]
    fn rows_have_their_places_and_what_is_folded_has_none() {
        let document = wrapped();
        let rows = WrappedRows::new(&document, &Rows::default());
        let places: Vec<_> = (0..rows.count()).map(|row| rows.place_of(row)).collect();
        assert_eq!(places, [(0, 0), (0, 1), (1, 0), (2, 0), (3, 0), (3, 1)]);
        assert_eq!((0..4).map(|line| rows.row_of(line)).collect::<Vec<_>>(), [0, 2, 3, 4]);
        let folded = WrappedRows::new(&document, &Rows::new(vec![Range { start: 1, end: 3 }]));
        let places: Vec<_> = (0..folded.count()).map(|row| folded.place_of(row)).collect();
        assert_eq!(places, [(0, 0), (0, 1), (3, 0), (3, 1)]);
        assert_eq!((0..4).map(|line| folded.row_of(line)).collect::<Vec<_>>(), [0, 1, 1, 2]);
        let unbroken = Document::new("a\nb");
        assert_eq!(WrappedRows::new(&unbroken, &Rows::default()).count(), 2);
    }

    fn heads(document: &mut Document, motions: &[Motion]) -> Vec<usize> {
        let moved = motions.iter().map(|&motion| {
            TextCommand::Move { motion, select: false }.apply(document);
            document.caret().head
        });
        moved.collect()
    }

    #[test]
    fn up_and_down_go_from_row_to_row_and_keep_their_column_on_screen() {
        let mut document = wrapped();
        document.set_caret(Caret::at(10));
        // Column 10 of the second row is its eighth character, for it stands two columns further right.
        let down = heads(&mut document, &[Motion::Down(1); 7]);
        assert_eq!(down, [27, 37, 38, 49, 65, 66, 66]);
        document.set_caret(Caret::at(27));
        assert_eq!(heads(&mut document, &[Motion::Up(1); 2]), [10, 0]);
        document.set_caret(Caret::at(66));
        assert_eq!(heads(&mut document, &[Motion::Up(4), Motion::Up(9)]), [28, 11]);
        assert_eq!(heads(&mut document, &[Motion::Down(99), Motion::Down(1)]), [66, 66]);
    }

    #[test]
    fn home_and_end_go_to_the_ends_of_the_row_and_then_of_the_line() {
        let mut document = wrapped();
        document.set_caret(Caret::at(25));
        assert_eq!(heads(&mut document, &[Motion::LineStart, Motion::LineStart]), [19, 0]);
        // In front of the blank that ends the row: after it the next row begins.
        assert_eq!(heads(&mut document, &[Motion::LineEnd, Motion::LineEnd, Motion::LineEnd]), [18, 33, 33]);
    }

    #[test]
    fn carets_above_and_below_stand_in_the_next_rows() {
        let mut document = wrapped();
        document.set_caret(Caret::at(4));
        for _ in 0..3 {
            TextCommand::AddCaretBelow.apply(&mut document);
        }
        let carets: Vec<_> = document.carets().iter().map(|caret| caret.head).collect();
        assert_eq!(carets, [4, 21, 37, 38]);
    }
}
