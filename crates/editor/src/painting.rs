//! What is painted onto the lines: marks, selections, brackets, wavy lines.

use std::ops::Range;

use egui::{Align2, Pos2, Rect, Stroke, StrokeKind};

use crate::geometry::{Geometry, ShownRow, ShownRows};
use crate::{EditorView, brackets};

/// What is painted onto the lines of one frame.
pub(crate) struct Painting<'a> {
    pub(crate) view: &'a EditorView<'a>,
    pub(crate) geometry: &'a Geometry<'a>,
    pub(crate) shown: &'a ShownRows,
    pub(crate) painter: &'a egui::Painter,
    pub(crate) right: f32,
}

impl Painting<'_> {
    /// The rectangles that bytes cover on screen, one per row; a line break counts as one character.
    fn rects(&self, bytes: Range<usize>) -> Vec<Rect> {
        let mut rects = Vec::new();
        for ShownRow { row, layout, .. } in self.shown.each() {
            let of_row = layout.bytes();
            if bytes.end < of_row.start || bytes.start > of_row.end {
                continue;
            }
            let left = layout.x_of(self.view, bytes.start.max(of_row.start));
            let mut right = layout.x_of(self.view, bytes.end.min(of_row.end));
            if bytes.end > of_row.end && layout.is_last() {
                right += self.geometry.character_width;
            }
            if right > left {
                let x = self.geometry.origin.x;
                rects.push(self.geometry.rect_of(*row, x + left..x + right));
            }
        }
        rects
    }

    pub(crate) fn current_line(&self, left: f32) {
        let document = self.view.document;
        if document.caret().is_empty() {
            let line = document.line_at(document.caret().head);
            for row in self.shown.each().filter(|row| row.line == line) {
                let rect = self.geometry.rect_of(row.row, left..self.right);
                self.painter.rect_filled(rect, 0.0, self.view.tokens.raised);
            }
        }
    }

    /// Bands behind the names of files.
    pub(crate) fn headings(&self) {
        let tokens = self.view.tokens;
        let left = self.painter.clip_rect().left();
        for row in self.shown.each().filter(|row| self.view.document.heading(row.line).is_some()) {
            let row = self.geometry.rect_of(row.row, left..self.right);
            self.painter.rect_filled(row, 0.0, tokens.pressed);
            self.painter.hline(row.x_range(), row.top(), Stroke::new(1.0, tokens.line_strong));
        }
    }

    /// A sign behind a line whose rest is folded away.
    pub(crate) fn folded(&self, shown: &ShownRow) {
        let left = self.geometry.origin.x + shown.layout.right() + self.geometry.character_width * 0.6;
        let width = self.geometry.character_width * 2.6;
        let plate = self.geometry.rect_of(shown.row, left..left + width).shrink2(egui::vec2(0.0, 3.0));
        self.painter.rect_filled(plate, 3.0, self.view.tokens.pressed);
        let color = self.view.tokens.text_faint;
        self.painter.text(plate.center(), Align2::CENTER_CENTER, "…", self.geometry.font.clone(), color);
    }

    /// The places that are marked.
    pub(crate) fn marks(&self) {
        for mark in self.view.marks {
            for rect in self.rects(mark.bytes.clone()) {
                self.painter.rect_filled(rect, 3.0, mark.fill);
                if let Some(color) = mark.underline {
                    self.painter.hline(rect.x_range(), rect.bottom() - 1.0, Stroke::new(2.0, color));
                }
            }
        }
    }

    pub(crate) fn matches_of_find(&self) {
        let Some(find) = self.view.find else { return };
        let Ok(pattern) = find.pattern() else { return };
        let document = self.view.document;
        let Range { start, end } = self.shown.bytes(document);
        let visible = document.text().get(start..end).unwrap_or_default();
        let stroke = Stroke::new(1.0, self.view.tokens.warning);
        for found in pattern.matches(visible) {
            for rect in self.rects(start + found.start..start + found.end) {
                self.painter.rect_filled(rect, 2.0, self.view.tokens.soft[1]);
                self.painter.rect_stroke(rect, 2.0, stroke, StrokeKind::Inside);
            }
        }
    }

    pub(crate) fn selected_text(&self, has_focus: bool) {
        let tokens = self.view.tokens;
        let color = if has_focus { tokens.selection } else { tokens.pressed };
        for caret in self.view.document.carets().iter().filter(|caret| !caret.is_empty()) {
            for rect in self.rects(caret.range()) {
                self.painter.rect_filled(rect, 2.0, color);
            }
        }
    }

    pub(crate) fn brackets(&self) {
        let document = self.view.document;
        let Some((one, other)) = brackets::matching(document.text(), document.caret().head) else { return };
        let stroke = Stroke::new(1.0, self.view.tokens.line_strong);
        for at in [one, other] {
            for rect in self.rects(at..at + 1) {
                self.painter.rect(rect, 2.0, self.view.tokens.pressed, stroke, StrokeKind::Inside);
            }
        }
    }

    /// Wavy lines under what is wrong.
    pub(crate) fn diagnostics(&self) {
        let length = self.view.document.text().len();
        for diagnostic in self.view.diagnostics {
            let (_, color) = diagnostic.severity.sign(self.view.tokens);
            let Range { start, end } = diagnostic.bytes;
            // What is wrong at a single point still needs something to see.
            let mut rects = self.rects(start..end.max(start + 1).min(length.max(start)));
            if rects.is_empty() {
                rects.extend(self.rects(start.saturating_sub(1)..start));
            }
            for rect in rects {
                self.wave(rect, color);
            }
        }
    }

    fn wave(&self, rect: Rect, color: egui::Color32) {
        let (step, height) = (2.5, 1.6);
        let middle = rect.bottom() - 2.5;
        let count = ((rect.width() / step).ceil() as usize).clamp(2, 400);
        let points = (0..=count).map(|index| {
            let up = if index % 2 == 0 { -height } else { height };
            Pos2::new((rect.left() + index as f32 * step).min(rect.right()), middle + up / 2.0)
        });
        self.painter.line(points.collect(), Stroke::new(1.2, color));
    }
}
