//! Which lines have rows, and which are folded away.

use std::ops::Range;

/// Which line is in which row of the editor. Both count from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Rows {
    /// The lines that have no row: disjoint, in order.
    hidden: Vec<Range<usize>>,
}

impl Rows {
    /// The row of a line; for a line without one, the row before it.
    pub fn row_of(&self, line: usize) -> usize {
        let mut row = line;
        for hidden in self.hidden.iter().take_while(|hidden| hidden.start <= line) {
            row -= if line < hidden.end { line - hidden.start + 1 } else { hidden.len() };
        }
        row
    }

    /// The line in a row.
    pub fn line_of(&self, row: usize) -> usize {
        let mut line = row;
        for hidden in &self.hidden {
            if hidden.start > line {
                break;
            }
            line += hidden.len();
        }
        line
    }

    /// Returns how many rows so many lines take.
    pub fn count(&self, num_lines: usize) -> usize {
        num_lines - self.hidden.iter().map(Range::len).sum::<usize>()
    }

    /// The lines that are folded away around this one.
    pub fn hiding(&self, line: usize) -> Option<Range<usize>> {
        self.hidden.iter().find(|hidden| hidden.contains(&line)).cloned()
    }

    /// Returns whether the lines after this one are folded away.
    pub fn is_folded_at(&self, line: usize) -> bool {
        self.hidden.iter().any(|hidden| hidden.start == line + 1)
    }

    /// With these lines folded away, in any order.
    pub fn new(mut hidden: Vec<Range<usize>>) -> Self {
        hidden.sort_by_key(|range| (range.start, range.end));
        let mut joined: Vec<Range<usize>> = Vec::new();
        for range in hidden {
            match joined.last_mut() {
                Some(last) if range.start <= last.end => last.end = last.end.max(range.end),
                _ => joined.push(range),
            }
        }
        Self { hidden: joined }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_lines_are_each_other_s_inverse_but_for_what_is_hidden() {
        let rows = Rows::new(vec![7..9, 1..3, 2..5]);
        assert_eq!(rows.count(10), 4);
        assert_eq!((0..4).map(|row| rows.line_of(row)).collect::<Vec<_>>(), [0, 5, 6, 9]);
        assert_eq!((0..10).map(|line| rows.row_of(line)).collect::<Vec<_>>(), [0, 0, 0, 0, 0, 1, 2, 2, 2, 3]);
    }
}
