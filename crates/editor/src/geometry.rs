//! Where lines stand on screen.

use std::ops::Range;

use egui::{FontId, Pos2, Rangef, Rect, Ui};
use text_editing::{Document, Rows};

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
    /// Which line stands in which row.
    pub(crate) rows: &'a Rows,
}

impl Geometry<'_> {
    pub(crate) fn top_of(&self, line: usize) -> f32 {
        self.origin.y + self.rows.row_of(line) as f32 * self.row_height
    }

    /// The line at a height, whether there is text or not.
    pub(crate) fn line_at(&self, y: f32) -> Option<usize> {
        let row = ((y - self.origin.y) / self.row_height).floor();
        (row >= 0.0).then(|| self.rows.line_of(row as usize))
    }

    pub(crate) fn row(&self, line: usize, x: Range<f32>) -> Rect {
        let top = self.top_of(line);
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

/// The lines on screen, laid out, in order; what is folded is left out.
pub(crate) struct ShownLines {
    pub(crate) lines: Vec<usize>,
    layouts: Vec<LineLayout>,
}

impl ShownLines {
    /// Lays out `lines`.
    pub(crate) fn new(
        ui: &Ui,
        view: &EditorView<'_>,
        language: &mut dyn LanguageService,
        geometry: &Geometry<'_>,
        lines: Vec<usize>,
    ) -> Self {
        let mut shown = Self { lines, layouts: Vec::new() };
        let highlights = language.highlights(shown.bytes(view.document));
        let layouts = shown.lines.iter().map(|&line| {
            LineLayout::new(ui, view, &geometry.font, view.document.line_range(line), &highlights)
        });
        shown.layouts = layouts.collect();
        shown
    }

    pub(crate) fn each(&self) -> impl Iterator<Item = (usize, &LineLayout)> {
        self.lines.iter().copied().zip(&self.layouts)
    }

    pub(crate) fn layout_of(&self, line: usize) -> Option<&LineLayout> {
        self.layouts.get(self.lines.binary_search(&line).ok()?)
    }

    /// From the first line to the last, those between that are folded included.
    pub(crate) fn bytes(&self, document: &Document) -> Range<usize> {
        match (self.lines.first(), self.lines.last()) {
            (Some(&first), Some(&last)) => document.line_range(first).start..document.line_range(last).end,
            _ => 0..0,
        }
    }
}
