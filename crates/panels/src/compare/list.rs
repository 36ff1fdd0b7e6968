//! What differs, one row each: the sign and the word of the change, the name, and what it was and is.

use egui::{Align2, Pos2, Rect, Role, Sense, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo};
use review::compare::{Comparison, Difference};
use theme::icon;
use theme::space;
use workbench::command::CommandSender;

use super::{change_look, select};
use crate::Context;

/// Differences that are listed at most.
const MAX_DIFFERENCES: usize = 400;
/// How wide the column of words is.
const WORD_WIDTH: f32 = 92.0;

/// Shows the list.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    comparison: &Comparison,
    commands: &mut CommandSender,
) {
    ui.add_space(space::S);
    for difference in comparison.differences.iter().take(MAX_DIFFERENCES) {
        row(ui, context, difference, commands);
    }
    let left_out = comparison.differences.len().saturating_sub(MAX_DIFFERENCES);
    if left_out > 0 {
        ui.label(format!("and {left_out} more (run enroute compare for the full list)"));
    }
}

fn row(ui: &mut Ui, context: &Context<'_>, difference: &Difference, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let (sign, color) = change_look(tokens, difference.change);
    let body = TextStyle::Body.resolve(ui.style());
    let small = TextStyle::Small.resolve(ui.style());
    let width = ui.available_width();
    let wrap = (width - WORD_WIDTH - space::M).max(80.0);
    let name = context.readable(&format!("{} {}", difference.subject.name(), difference.name));
    let name = ui.painter().layout(name, body, tokens.text, wrap);
    let detail = match (&difference.before, &difference.after) {
        (Some(before), Some(after)) => format!("{before}  →  {after}"),
        (Some(only), None) | (None, Some(only)) => only.clone(),
        (None, None) => String::new(),
    };
    let detail = ui.painter().layout(detail, small.clone(), tokens.text_muted, wrap);
    let height = name.size().y + detail.size().y + 7.0;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(width, height), Sense::click());
    response
        .widget_info(|| WidgetInfo::labeled(Role::Button, true, context.readable(&difference.sentence())));
    if ui.is_rect_visible(rect) {
        if response.hovered() || response.has_focus() {
            ui.painter().rect_filled(rect, 3.0, tokens.hover);
        }
        if response.has_focus() {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.0, tokens.accent), StrokeKind::Inside);
        }
        let painter = ui.painter();
        let sign_rect = Rect::from_min_size(rect.min + egui::vec2(2.0, 3.0), egui::vec2(14.0, 17.0));
        icon::paint(painter, sign, sign_rect, 13.0, color);
        let word_at = rect.min + egui::vec2(20.0, 5.0);
        painter.text(word_at, Align2::LEFT_TOP, difference.change.name(), small, color);
        let text_at = Pos2::new(rect.left() + WORD_WIDTH, rect.top() + 3.0);
        let below = text_at + egui::vec2(0.0, name.size().y + 1.0);
        painter.galley(text_at, name, tokens.text);
        painter.galley(below, detail, tokens.text_muted);
    }
    if response.clicked() {
        // A condition that something requires is known by its interval, which is a name too.
        select(context, &difference.name, commands);
    }
}
