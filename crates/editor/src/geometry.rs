//! Where rows of the text stand on screen. A line has one row, unless long lines are broken into several.

use std::ops::Range;

use egui::{FontId, Pos2, Rangef, Rect, Ui};
use text_editing::{Document, Rows, WrappedRows};

use crate::line::LineLayout;
use crate::{EditorView, LanguageService};

/// Sizes and places that hold for one frame.
pub(crate) struct Geometry<'a> {
    pub(crate) font: FontId,
    pub(crate) row_height: f32,
    pub(crate) character_width: f32,
    pub(crate) gutter_width: f32,
    /// The top left corner of the first line's text.
    pub(crate) origin: Pos2,
    /// Which lines are folded away.
    pub(crate) folded: &'a Rows,
    /// Which row of which line stands where, if lines are broken into rows.
    pub(crate) wrapped: Option<&'a WrappedRows>,
}

impl Geometry<'_> {
    /// The first row of a line.
    pub(crate) fn row_of(&self, line: usize) -> usize {
        self.wrapped.map_or_else(|| self.folded.row_of(line), |wrapped| wrapped.row_of(line))
    }

    /// The line in a row, and which of its rows that is.
    pub(crate) fn place_of(&self, row: usize) -> (usize, usize) {
        self.wrapped.map_or_else(|| (self.folded.line_of(row), 0), |wrapped| wrapped.place_of(row))
    }

    /// Returns how many rows there are.
    pub(crate) fn num_rows(&self, document: &Document) -> usize {
        self.wrapped.map_or_else(|| self.folded.count(document.line_count()), WrappedRows::count)
    }

    /// The row that holds a place.
    pub(crate) fn row_at(&self, document: &Document, offset: usize) -> usize {
        self.row_of(document.line_at(offset)) + document.row_in_line(offset)
    }

    pub(crate) fn top_of(&self, row: usize) -> f32 {
        self.origin.y + row as f32 * self.row_height
    }

    /// The row at a height, whether there is text or not.
    pub(crate) fn row_at_height(&self, y: f32) -> Option<usize> {
        let row = ((y - self.origin.y) / self.row_height).floor();
        (row >= 0.0).then_some(row as usize)
    }

    pub(crate) fn rect_of(&self, row: usize, x: Range<f32>) -> Rect {
        let top = self.top_of(row);
        Rect::from_min_max(Pos2::new(x.start, top), Pos2::new(x.end, top + self.row_height))
    }

    /// The gutter of a text that is clipped to `clip`.
    pub(crate) fn gutter(&self, clip: Rect) -> Rect {
        Rect::from_min_max(clip.min, Pos2::new(clip.left() + self.gutter_width, clip.bottom()))
    }

    /// The column of the gutter in which folds are opened and closed.
    pub(crate) fn fold_signs(&self, clip: Rect) -> Rangef {
        let right = clip.left() + self.gutter_width;
        Rangef::new(right - 1.5 * self.character_width, right)
    }
}

/// Lines of more bytes are broken into rows, whatever is wanted: a row is laid out and drawn as a whole.
pub(crate) const LONGEST_ROW_BYTES: usize = 5000;

/// A row on screen, laid out.
pub(crate) struct ShownRow {
    /// Counted from the first row of the text.
    pub(crate) row: usize,
    pub(crate) line: usize,
    /// Which of its line's rows it is.
    pub(crate) nth: usize,
    pub(crate) layout: LineLayout,
}

/// The rows on screen, in order; what is folded is left out.
pub(crate) struct ShownRows {
    rows: Vec<ShownRow>,
}

impl ShownRows {
    /// Lays out `rows`.
    pub(crate) fn new(
        ui: &Ui,
        view: &EditorView<'_>,
        language: &mut dyn LanguageService,
        geometry: &Geometry<'_>,
        rows: Range<usize>,
    ) -> Self {
        let document = view.document;
        // Of the rows of one line that are on screen only the first asks where it breaks.
        let mut of_line: (usize, Vec<Range<usize>>) = (usize::MAX, Vec::new());
        let placed = rows.filter_map(|row| {
            let (line, nth) = geometry.place_of(row);
            if of_line.0 != line {
                of_line = (line, document.rows_of_line(line));
            }
            let bytes = of_line.1.get(nth)?.clone();
            let is_last = nth + 1 == of_line.1.len();
            // A row that is to be broken from the next frame on is not laid out as a whole.
            let is_cut = bytes.len() > LONGEST_ROW_BYTES;
            let end =
                if is_cut { document.boundary_before(bytes.start + LONGEST_ROW_BYTES) } else { bytes.end };
            Some((row, line, nth, bytes.start..end, is_last && !is_cut))
        });
        let placed: Vec<_> = placed.collect();
        let highlights = match (placed.first(), placed.last()) {
            (Some(first), Some(last)) => language.highlights(first.3.start..last.3.end),
            _ => Vec::new(),
        };
        let laid_out = placed.into_iter().map(|(row, line, nth, bytes, is_last)| {
            let left = document.hanging_columns(line, nth) as f32 * geometry.character_width;
            let layout = LineLayout::new(ui, view, &geometry.font, bytes, is_last, left, &highlights);
            ShownRow { row, line, nth, layout }
        });
        Self { rows: laid_out.collect() }
    }

    pub(crate) fn each(&self) -> impl Iterator<Item = &ShownRow> {
        self.rows.iter()
    }

    /// A row, counted from the first one of the text.
    pub(crate) fn row(&self, row: usize) -> Option<&ShownRow> {
        self.rows.get(self.rows.binary_search_by_key(&row, |shown| shown.row).ok()?)
    }

    /// The row that holds a place.
    pub(crate) fn row_at(&self, offset: usize) -> Option<&ShownRow> {
        let after = self.rows.partition_point(|shown| shown.layout.bytes().start <= offset);
        self.rows[..after].last().filter(|shown| shown.layout.holds(offset))
    }

    /// From the first line on screen to the last, both whole, what is folded between them included.
    pub(crate) fn bytes(&self, document: &Document) -> Range<usize> {
        match (self.rows.first(), self.rows.last()) {
            (Some(first), Some(last)) => {
                document.line_range(first.line).start..document.line_range(last.line).end
            }
            _ => 0..0,
        }
    }
}
