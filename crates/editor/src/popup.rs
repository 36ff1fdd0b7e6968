//! The list at the caret, and the signature of the call around it.

use egui::{
    Align2, Area, Frame, Margin, Order, Pos2, Rect, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo,
};
use theme::space;

use crate::{EditorAction, EditorView, LanguageService, Popup, PopupItem};

const WIDTH: f32 = 380.0;
const ROWS: usize = 9;

/// Shows the list below `caret`, the caret's rectangle on screen. Returns where the list is on screen, if it is open.
pub(crate) fn show(
    ui: &Ui,
    view: &EditorView<'_>,
    caret: Rect,
    actions: &mut Vec<EditorAction>,
) -> Option<Rect> {
    let popup = view.popup?;
    let row = space::ROW;
    let height = popup.items.len().min(ROWS) as f32 * row + 8.0;
    let screen = ui.ctx().content_rect();
    let is_below = caret.bottom() + height + 12.0 < screen.bottom();
    let y = if is_below { caret.bottom() + 3.0 } else { caret.top() - height - 5.0 };
    let x = (caret.left() - 26.0).min(screen.right() - WIDTH - 12.0).max(screen.left() + 4.0);
    let area = Area::new(view.id.with("popup")).order(Order::Foreground).fixed_pos(Pos2::new(x, y));
    let shown = area.show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(Margin::same(4)).show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.spacing_mut().item_spacing.y = 0.0;
            ScrollArea::vertical().max_height(ROWS as f32 * row).show(ui, |ui| {
                theme::structure::options(ui, "Suggestions");
                for (index, item) in popup.items.iter().enumerate() {
                    let response = show_item(ui, view, popup, item, index == popup.chosen, row);
                    if index == popup.chosen && !ui.clip_rect().contains_rect(response.rect) {
                        response.scroll_to_me(None);
                    }
                    if response.clicked() {
                        actions.push(EditorAction::TakeFromPopup(Some(index)));
                    }
                }
            });
        });
    });
    Some(shown.response.rect)
}

fn show_item(
    ui: &mut Ui,
    view: &EditorView<'_>,
    popup: &Popup<'_>,
    item: &PopupItem<'_>,
    is_chosen: bool,
    row: f32,
) -> egui::Response {
    let tokens = view.tokens;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(ui.available_width(), row), Sense::click());
    let name = format!("{}{}", popup.prefix, item.label);
    response.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_chosen, &name));
    let fill = match (is_chosen, response.hovered()) {
        (true, _) => Some(tokens.selection),
        (_, true) => Some(tokens.hover),
        _ => None,
    };
    if let Some(fill) = fill {
        ui.painter().rect_filled(rect, 3.0, fill);
    }
    let small = TextStyle::Small.resolve(ui.style());
    let mono = TextStyle::Monospace.resolve(ui.style());
    let body = TextStyle::Body.resolve(ui.style());
    let mut x = rect.left() + space::S;
    if let Some((sign, color)) = item.sign {
        let middle = Pos2::new(x + 6.0, rect.center().y);
        ui.painter().text(middle, Align2::CENTER_CENTER, sign, small.clone(), color);
        x += 18.0;
    }
    let font = if popup.is_code { mono } else { body };
    let detail = ui.painter().layout_no_wrap(item.detail.to_owned(), small, tokens.text_muted);
    let detail_width = detail.size().x.min(rect.width() * 0.55);
    let label = ui.painter().with_clip_rect(rect.with_max_x(rect.right() - detail_width - 14.0));
    label.text(Pos2::new(x, rect.center().y), Align2::LEFT_CENTER, item.label, font, tokens.text);
    let detail_rect = rect.with_min_x(rect.right() - detail_width - space::S);
    let at = Pos2::new(detail_rect.left(), rect.center().y - detail.size().y / 2.0);
    ui.painter().with_clip_rect(detail_rect).galley(at, detail, tokens.text_muted);
    response
}

/// Shows the signature of the call around the caret above it, while its arguments are being written.
pub(crate) fn show_signature(
    ui: &Ui,
    view: &EditorView<'_>,
    language: &mut dyn LanguageService,
    caret: Rect,
) {
    if view.popup.is_some() || !view.document.caret().is_empty() {
        return;
    }
    let Some(signature) = language.signature(view.document.caret().head) else { return };
    let tokens = view.tokens;
    let font = TextStyle::Monospace.resolve(ui.style());
    let mut job = egui::text::LayoutJob::default();
    let mut done = 0;
    let plain = egui::TextFormat::simple(font.clone(), tokens.text_muted);
    if let Some(active) = &signature.active {
        let text = &signature.label;
        job.append(text.get(..active.start).unwrap_or_default(), 0.0, plain.clone());
        let mut strong = egui::TextFormat::simple(font, tokens.accent);
        strong.underline = egui::Stroke::new(1.0, tokens.accent);
        job.append(text.get(active.clone()).unwrap_or_default(), 0.0, strong);
        done = active.end;
    }
    job.append(signature.label.get(done..).unwrap_or_default(), 0.0, plain);
    let at = Pos2::new(caret.left(), caret.top() - 6.0);
    Area::new(view.id.with("signature"))
        .order(Order::Foreground)
        .pivot(Align2::LEFT_BOTTOM)
        .fixed_pos(at)
        .interactable(false)
        .show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).inner_margin(Margin::symmetric(8, 4)).show(ui, |ui| {
                ui.set_max_width(520.0);
                ui.label(job);
                if !signature.documentation.is_empty() {
                    ui.label(egui::RichText::new(&signature.documentation).small().color(tokens.text_muted));
                }
            });
        });
}
