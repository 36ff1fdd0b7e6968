//! One row of text as a galley, with its colors and with what an input method is composing in it.

use std::ops::Range;
use std::sync::Arc;

use egui::text::{CCursor, LayoutJob, TextFormat};
use egui::{FontId, Galley, Stroke, Ui};

use crate::{EditorView, Highlight};

/// A laid-out line, or one of the rows that it is broken into.
pub(crate) struct LineLayout {
    galley: Arc<Galley>,
    /// The bytes of the document that the row shows.
    bytes: Range<usize>,
    /// Whether the line ends here: then the place behind the last byte belongs to the row.
    is_last: bool,
    /// How far right of the line's start the row begins.
    left: f32,
    /// Where composed text is inserted, in bytes of the document, and how long it is.
    composed: Option<(usize, usize)>,
}

impl LineLayout {
    /// Lays out the row that covers `bytes`. `highlights` are in textual order.
    pub(crate) fn new(
        ui: &Ui,
        view: &EditorView<'_>,
        font: &FontId,
        bytes: Range<usize>,
        is_last: bool,
        left: f32,
        highlights: &[Highlight],
    ) -> Self {
        let document = view.document;
        let text = document.text().get(bytes.clone()).unwrap_or_default();
        let plain = |color| TextFormat::simple(font.clone(), color);
        // A heading's mark is a blank of the same length.
        let heading = document.heading(document.line_at(bytes.start)).map(|name| format!(" {name}"));
        let mut job = LayoutJob::default();
        let mut done = bytes.start;
        let mut append = |range: Range<usize>, format: TextFormat| {
            if let Some(part) = document.text().get(range.clone()).filter(|part| !part.is_empty()) {
                job.append(part, 0.0, format);
            }
        };
        let first = highlights.partition_point(|highlight| highlight.bytes.end <= bytes.start);
        for highlight in highlights[first..].iter().take_while(|it| it.bytes.start < bytes.end) {
            let start = highlight.bytes.start.max(done);
            let end = highlight.bytes.end.min(bytes.end);
            if start < end {
                append(done..start, plain(view.tokens.text));
                append(start..end, plain(highlight.color));
                done = end;
            }
        }
        append(done..bytes.end, plain(view.tokens.text));
        if let Some(heading) = heading {
            job = LayoutJob::default();
            job.append(&heading, 0.0, plain(view.tokens.accent));
        }
        let composed = Self::compose(view, &bytes, is_last, &mut job, font);
        if job.text.is_empty() {
            job.append("", 0.0, plain(view.tokens.text));
        }
        job.keep_trailing_whitespace = true;
        debug_assert!(job.text.len() >= text.len());
        Self { galley: ui.fonts_mut(|fonts| fonts.layout_job(job)), bytes, is_last, left, composed }
    }

    /// Inserts composed text at the caret, if it is in this row.
    fn compose(
        view: &EditorView<'_>,
        bytes: &Range<usize>,
        is_last: bool,
        job: &mut LayoutJob,
        font: &FontId,
    ) -> Option<(usize, usize)> {
        let text = view.composition;
        let head = view.document.caret().head;
        if text.is_empty() || !holds(bytes, is_last, head) {
            return None;
        }
        let before = std::mem::take(job);
        let at = head - bytes.start;
        let mut format = TextFormat::simple(font.clone(), view.tokens.text);
        format.underline = Stroke::new(1.0, view.tokens.accent);
        let mut inserted = false;
        for section in &before.sections {
            let range = section.byte_range.start.0..section.byte_range.end.0;
            let split = at.clamp(range.start, range.end);
            job.append(&before.text[range.start..split], 0.0, section.format.clone());
            if !inserted && at <= range.end {
                job.append(text, 0.0, format.clone());
                inserted = true;
            }
            job.append(&before.text[split..range.end], 0.0, section.format.clone());
        }
        if !inserted {
            job.append(text, 0.0, format);
        }
        Some((head, text.len()))
    }

    pub(crate) fn galley(&self) -> &Arc<Galley> {
        &self.galley
    }

    /// The bytes of the document that the row shows.
    pub(crate) fn bytes(&self) -> Range<usize> {
        self.bytes.clone()
    }

    /// Returns whether the line ends in this row.
    pub(crate) fn is_last(&self) -> bool {
        self.is_last
    }

    /// Returns how far right of the line's start the row begins.
    pub(crate) fn left(&self) -> f32 {
        self.left
    }

    /// Returns how far right of the line's start the row ends.
    pub(crate) fn right(&self) -> f32 {
        self.left + self.galley.size().x
    }

    /// Returns whether a caret at this place is in this row.
    pub(crate) fn holds(&self, offset: usize) -> bool {
        holds(&self.bytes, self.is_last, offset)
    }

    /// Returns how far right of the line's start a byte of the document stands; behind composed text at its place.
    pub(crate) fn x_of(&self, view: &EditorView<'_>, offset: usize) -> f32 {
        let offset = offset.clamp(self.bytes.start, self.bytes.end);
        let text = view.document.text();
        let mut characters = text.get(self.bytes.start..offset).map_or(0, |before| before.chars().count());
        if self.composed.is_some_and(|(at, _)| offset >= at) {
            characters += view.composition.chars().count();
        }
        self.left + self.galley.pos_from_cursor(CCursor::new(characters)).left()
    }

    /// The byte of the document nearest to `x`, measured from the line's start.
    pub(crate) fn offset_at(&self, view: &EditorView<'_>, x: f32) -> usize {
        let cursor = self.galley.cursor_from_pos(egui::vec2(x - self.left, 1.0));
        let mut character = cursor.index.0;
        let text = view.document.text().get(self.bytes.clone()).unwrap_or_default();
        if let Some((at, _)) = self.composed {
            let before = view.document.text().get(self.bytes.start..at);
            let before = before.map_or(0, |before| before.chars().count());
            let composed = view.composition.chars().count();
            if character > before {
                character = character.saturating_sub(composed).max(before);
            }
        }
        let found = text.char_indices().nth(character).map(|(at, _)| at);
        // Behind the last character of such a row the next row begins.
        let last = text.char_indices().next_back().map_or(0, |(at, _)| at);
        self.bytes.start + found.unwrap_or(if self.is_last { text.len() } else { last })
    }
}

fn holds(bytes: &Range<usize>, is_last: bool, offset: usize) -> bool {
    bytes.contains(&offset) || is_last && offset == bytes.end
}
