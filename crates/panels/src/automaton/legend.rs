//! What the signs on the drawing of an automaton mean.

use egui::{FontId, Rect, vec2};
use theme::{Tokens, size};

/// Writes along the lower edge what the signs mean, as much of it as there is room for.
pub(super) fn legend(painter: &egui::Painter, panel: Rect, tokens: &Tokens) {
    let parts = [
        "● active",
        "double border: initially active",
        "overbar: not known to hold",
        "dashed arrow: next part of a sequence",
    ];
    let font = FontId::proportional(size::SMALL);
    let color = tokens.text_faint;
    let mut at = panel.left_bottom() + vec2(8.0, -6.0);
    for part in parts {
        let galley = painter.layout_no_wrap(part.to_owned(), font.clone(), color);
        let size = galley.size();
        if at.x + size.x > panel.right() {
            break;
        }
        painter.galley(at - vec2(0.0, size.y), galley, color);
        at.x += size.x + 14.0;
    }
}
