//! The list at the caret, and the signature of the call around it.

use egui::{
    Align2, Area, Frame, Id, Margin, Order, Pos2, Rect, Role, ScrollArea, Sense, TextStyle, Ui, WidgetInfo,
};
use rmpl::editor::CompletionKind;
use theme::{Tokens, space};
use workbench::command::{Command, CommandSender, EditorCommand};
use workbench::state::editor::{Popup, PopupItem, PopupKind};

use crate::Context;

const WIDTH: f32 = 380.0;
const ROWS: usize = 9;

/// Shows the list below `caret`, the caret's rectangle on screen.
pub(crate) fn show(ui: &Ui, context: &Context<'_>, caret: Rect, commands: &mut CommandSender) {
    let Some(popup) = &context.state.editor.popup else { return };
    let row = space::ROW - 1.0;
    let height = popup.items.len().min(ROWS) as f32 * row + 8.0;
    let screen = ui.ctx().content_rect();
    let is_below = caret.bottom() + height + 12.0 < screen.bottom();
    let y = if is_below { caret.bottom() + 3.0 } else { caret.top() - height - 5.0 };
    let x = (caret.left() - 26.0).min(screen.right() - WIDTH - 12.0).max(screen.left() + 4.0);
    Area::new(Id::unique("editor popup")).order(Order::Foreground).fixed_pos(Pos2::new(x, y)).show(
        ui.ctx(),
        |ui| {
            Frame::popup(ui.style()).inner_margin(Margin::same(4)).show(ui, |ui| {
                ui.set_width(WIDTH);
                ui.spacing_mut().item_spacing.y = 0.0;
                ScrollArea::vertical().max_height(ROWS as f32 * row).show(ui, |ui| {
                    for (index, item) in popup.items.iter().enumerate() {
                        let response = show_item(ui, context, popup, item, index == popup.chosen, row);
                        if index == popup.chosen && !ui.clip_rect().contains_rect(response.rect) {
                            response.scroll_to_me(None);
                        }
                        if response.clicked() {
                            commands.send(Command::Editor(EditorCommand::TakeFromPopup(Some(index))));
                        }
                    }
                });
            });
        },
    );
}

fn show_item(
    ui: &mut Ui,
    context: &Context<'_>,
    popup: &Popup,
    item: &PopupItem,
    is_chosen: bool,
    row: f32,
) -> egui::Response {
    let tokens = context.tokens;
    let (rect, response) = ui.allocate_exact_size(egui::vec2(ui.available_width(), row), Sense::click());
    let name = match popup.kind {
        PopupKind::Fixes => format!("Fix: {}", item.label),
        PopupKind::Completion | PopupKind::References => item.label.clone(),
    };
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, is_chosen, &name));
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
    if let Some(kind) = item.kind {
        let (sign, color) = kind_sign(tokens, kind);
        let middle = Pos2::new(x + 6.0, rect.center().y);
        ui.painter().text(middle, Align2::CENTER_CENTER, sign, small.clone(), color);
        x += 18.0;
    }
    let font = if popup.kind == PopupKind::Fixes { body } else { mono };
    let detail = ui.painter().layout_no_wrap(item.detail.clone(), small, tokens.text_muted);
    let detail_width = detail.size().x.min(rect.width() * 0.55);
    let label = ui.painter().with_clip_rect(rect.with_max_x(rect.right() - detail_width - 14.0));
    label.text(Pos2::new(x, rect.center().y), Align2::LEFT_CENTER, &item.label, font, tokens.text);
    let detail_rect = rect.with_min_x(rect.right() - detail_width - space::S);
    let at = Pos2::new(detail_rect.left(), rect.center().y - detail.size().y / 2.0);
    ui.painter().with_clip_rect(detail_rect).galley(at, detail, tokens.text_muted);
    response
}

/// A letter and a colour for a kind of completion.
fn kind_sign(tokens: &Tokens, kind: CompletionKind) -> (&'static str, egui::Color32) {
    let syntax = &tokens.syntax;
    match kind {
        CompletionKind::Keyword => ("k", syntax.keyword),
        CompletionKind::Activity => ("A", syntax.activity),
        CompletionKind::Primitive => ("P", syntax.activity),
        CompletionKind::Variable => ("x", syntax.variable),
        CompletionKind::Value => ("=", syntax.value),
        CompletionKind::Parameter => ("p", syntax.parameter),
        CompletionKind::BoundName => ("b", syntax.parameter),
        CompletionKind::Constant => ("c", syntax.parameter),
        CompletionKind::Location => ("@", syntax.place),
        CompletionKind::Vehicle => ("v", syntax.place),
        CompletionKind::Option => ("o", syntax.keyword),
    }
}

/// Shows the signature of the call around the caret above it, while its arguments are being written.
pub(crate) fn show_signature(ui: &Ui, context: &Context<'_>, caret: Rect) {
    let state = context.state;
    if state.editor.popup.is_some() || !state.document.caret().is_empty() {
        return;
    }
    let head = state.document.caret().head as u32;
    let signature = state.language.parse().and_then(|parse| rmpl::editor::signature_at(parse, head));
    let Some(signature) = signature else { return };
    let tokens = context.tokens;
    let font = TextStyle::Monospace.resolve(ui.style());
    let mut job = egui::text::LayoutJob::default();
    let mut done = 0;
    let plain = egui::TextFormat::simple(font.clone(), tokens.text_muted);
    let active = signature.parameters.get(signature.active as usize);
    if let Some(active) = active {
        let text = &signature.label;
        job.append(text.get(..active.start as usize).unwrap_or_default(), 0.0, plain.clone());
        let mut strong = egui::TextFormat::simple(font, tokens.accent);
        strong.underline = egui::Stroke::new(1.0, tokens.accent);
        job.append(text.get(active.range()).unwrap_or_default(), 0.0, strong);
        done = active.end as usize;
    }
    job.append(signature.label.get(done..).unwrap_or_default(), 0.0, plain);
    let at = Pos2::new(caret.left(), caret.top() - 6.0);
    Area::new(Id::unique("signature"))
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
