//! The gutter: line numbers, signs of what is wrong, and where something can be folded.

use std::collections::BTreeMap;

use egui::{Align2, Pos2, Rect, Ui};
use theme::icon::{self, Icon};
use theme::space;

use crate::geometry::{Geometry, ShownRows};
use crate::{EditorView, LanguageService, Severity};

pub(crate) fn paint(
    ui: &Ui,
    view: &EditorView<'_>,
    language: &mut dyn LanguageService,
    geometry: &Geometry<'_>,
    shown: &ShownRows,
) {
    let tokens = view.tokens;
    let document = view.document;
    let clip = ui.clip_rect();
    let gutter = geometry.gutter(clip);
    // What can be folded is looked for only while the pointer is in the gutter.
    let is_pointed = ui.input(|input| input.pointer.hover_pos()).is_some_and(|at| gutter.contains(at));
    let foldable = if is_pointed { language.foldable_lines() } else { &[] };
    let visible = gutter.with_max_x(gutter.right() - 1.0);
    let painter = ui.painter().with_clip_rect(visible);
    painter.rect_filled(visible, 0.0, tokens.surface);
    let current = document.line_at(document.caret().head);
    let worst = worst_by_line(view);
    let signs = geometry.fold_signs(clip);
    // Of a line that is broken into rows only the first one has a number.
    for shown in shown.each().filter(|shown| shown.nth == 0) {
        let line = shown.line;
        let row = geometry.rect_of(shown.row, clip.left()..signs.min);
        let color = if line == current { tokens.text } else { tokens.text_faint };
        let number = match document.line_in_file(line) {
            0 => String::new(),
            number => number.to_string(),
        };
        painter.text(row.right_center(), Align2::RIGHT_CENTER, number, geometry.font.clone(), color);
        let sign_at = |x: f32| Rect::from_center_size(Pos2::new(x, row.center().y), egui::Vec2::ZERO);
        let is_folded = geometry.folded.is_folded_at(line);
        if is_folded || foldable.binary_search(&line).is_ok() {
            let sign = if is_folded { Icon::ChevronRight } else { Icon::ChevronDown };
            icon::paint(&painter, sign, sign_at(signs.center()), 10.0, tokens.text_faint);
        }
        if let Some(severity) = worst.get(&line) {
            let (sign, color) = severity.sign(tokens);
            icon::paint(&painter, sign, sign_at(clip.left() + space::M + 2.0), 12.0, color);
        }
    }
}

/// Returns how bad the worst thing is that begins in a line.
fn worst_by_line(view: &EditorView<'_>) -> BTreeMap<usize, Severity> {
    let mut worst = BTreeMap::new();
    for diagnostic in view.diagnostics {
        let line = view.document.line_at(diagnostic.bytes.start);
        let entry = worst.entry(line).or_insert(diagnostic.severity);
        *entry = (*entry).min(diagnostic.severity);
    }
    worst
}
