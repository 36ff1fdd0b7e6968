//! The caret: where it is on screen, and how it blinks.

use egui::{Painter, Rect, Response, Stroke, Ui};

use crate::EditorView;
use crate::geometry::{Geometry, ShownRows};

/// A caret is shown for this part of each period, and then not for the rest of it.
const SHOWN_SECS: f64 = 0.65;
const PERIOD_SECS: f64 = 1.1;

/// A caret that has not moved for so long stops blinking, and the app can rest.
const BLINKING_SECS: f64 = 30.0;

/// Returns where the caret is on screen, if its row is visible.
pub(crate) fn rect(view: &EditorView<'_>, geometry: &Geometry<'_>, shown: &ShownRows) -> Option<Rect> {
    rect_at(view, geometry, shown, view.document.caret().head)
}

fn rect_at(view: &EditorView<'_>, geometry: &Geometry<'_>, shown: &ShownRows, head: usize) -> Option<Rect> {
    let row = shown.row_at(head)?;
    let x = geometry.origin.x + row.layout.x_of(view, head);
    Some(geometry.rect_of(row.row, x..x + 1.0))
}

/// Paints the caret while the text has the focus, and tells input methods where it is.
pub(crate) fn paint(
    ui: &Ui,
    view: &EditorView<'_>,
    geometry: &Geometry<'_>,
    shown: &ShownRows,
    painter: &Painter,
    response: &Response,
) {
    if response.has_focus() {
        // The others do not blink: they say where typing goes, too.
        for caret in view.document.other_carets() {
            let row = rect_at(view, geometry, shown, caret.head).map(|row| row.shrink2(egui::vec2(0.0, 1.5)));
            if let Some(row) = row {
                painter.vline(row.left(), row.y_range(), Stroke::new(1.5, view.tokens.accent));
            }
        }
    }
    let Some(row) = rect(view, geometry, shown).filter(|_| response.has_focus()) else { return };
    let row = row.shrink2(egui::vec2(0.0, 1.5));
    let since = view.now_secs - view.active_secs;
    let phase = since.rem_euclid(PERIOD_SECS);
    let is_window_focused = ui.input(|input| input.focused);
    if !is_window_focused || phase < SHOWN_SECS || since > BLINKING_SECS {
        painter.vline(row.left(), row.y_range(), Stroke::new(1.5, view.tokens.accent));
    }
    if is_window_focused && since <= BLINKING_SECS {
        let next = if phase < SHOWN_SECS { SHOWN_SECS - phase } else { PERIOD_SECS - phase };
        ui.ctx().request_repaint_after_secs(next as f32 + 0.01);
    }
    let to_global = ui.ctx().layer_transform_to_global(ui.layer_id()).unwrap_or_default();
    ui.output_mut(|output| {
        output.mutable_text_under_cursor |= response.hovered();
        output.ime = Some(egui::output::IMEOutput {
            purpose: egui::IMEPurpose::Normal,
            rect: to_global * response.rect,
            cursor_rect: to_global * row,
            should_interrupt_composition: false,
        });
    });
}
