//! The tab of a panel: its title, and a cross to close it.

use egui::{Align2, CursorIcon, Id, Rect, Response, Role, Sense, TextStyle, Ui, Vec2, WidgetInfo};
use egui_tiles::TabState;
use panels::Context;
use theme::icon::{self, Icon};
use workbench::PanelKind;

use crate::bar::tab_title;

/// A tab as it was shown.
pub struct Tab {
    /// The whole tab; it can be dragged.
    pub response: Response,
    /// Whether its cross was pressed.
    pub is_closed: bool,
}

const MARGIN: f32 = 10.0;
/// In a window narrower than this, only the active tab has room for a cross.
const ROOM_FOR_CROSSES: f32 = 1_400.0;
const CROSS: f32 = 16.0;
/// The cross is pressed within a square of this size.
const TARGET: f32 = 24.0;

/// Shows the tab of a panel, or of a group of panels if `kind` is none.
pub fn show(ui: &mut Ui, context: &Context<'_>, kind: Option<PanelKind>, id: Id, state: &TabState) -> Tab {
    let tokens = context.tokens;
    let title = kind.map_or_else(|| "Panels".to_owned(), |kind| tab_title(context, kind).text().to_owned());
    let font = TextStyle::Body.resolve(ui.style());
    let color = if state.active { tokens.text } else { tokens.text_muted };
    let galley = ui.painter().layout_no_wrap(title, font, color);
    let has_cross = state.active || ui.ctx().content_rect().width() >= ROOM_FOR_CROSSES;
    let cross_width = if kind.is_some() && has_cross { CROSS + 4.0 } else { 0.0 };
    let size = Vec2::new(galley.size().x + 2.0 * MARGIN + cross_width, ui.available_height());
    let (_, rect) = ui.allocate_space(size);
    let response = ui.interact(rect, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::Grab);
    response.widget_info(|| WidgetInfo::selected(Role::Tab, true, state.active, galley.text()));
    // A tab that is turned to is brought into view, where there are more than fit.
    let shown_id = id.with("shown");
    let was_active = ui.data_mut(|data| {
        let width = ui.clip_rect().width();
        data.get_temp_mut_or_default::<Option<f32>>(shown_id).replace(width)
    });
    if !state.active {
        ui.data_mut(|data| data.insert_temp::<Option<f32>>(shown_id, None));
    } else if was_active != Some(ui.clip_rect().width()) {
        ui.scroll_to_rect_animation(rect, None, egui::style::ScrollAnimation::none());
    }
    if state.is_being_dragged {
        return Tab { response, is_closed: false };
    }
    let fill = match (state.active, response.hovered()) {
        (true, _) => Some(tokens.surface),
        (false, true) => Some(tokens.hover),
        (false, false) => None,
    };
    if let Some(fill) = fill {
        let radius = egui::CornerRadius { nw: 5, ne: 5, sw: 0, se: 0 };
        ui.painter().rect_filled(rect, radius, fill);
    }
    if state.active {
        let line = Rect::from_min_size(rect.min, Vec2::new(rect.width(), 2.0));
        let is_used = kind == Some(context.state.window.active_panel);
        ui.painter().rect_filled(line, 1.0, if is_used { tokens.accent } else { tokens.line_strong });
    }
    let at = Align2::LEFT_CENTER.anchor_size(rect.left_center() + Vec2::new(MARGIN, 0.0), galley.size()).min;
    ui.painter().galley(at, galley, color);
    let is_closed = kind
        .filter(|_| has_cross)
        .is_some_and(|kind| cross(ui, context, kind, rect, id, &response, state.active))
        || response.clicked_by(egui::PointerButton::Middle);
    Tab { response, is_closed }
}

/// The cross; it is drawn on the active tab and under the pointer.
fn cross(
    ui: &Ui,
    context: &Context<'_>,
    kind: PanelKind,
    tab: Rect,
    id: Id,
    response: &Response,
    is_active: bool,
) -> bool {
    let tokens = context.tokens;
    let center = tab.right_center() - Vec2::new(MARGIN - 4.0 + CROSS / 2.0, 0.0);
    let rect = Rect::from_center_size(center, Vec2::splat(TARGET));
    let cross = ui.interact(rect, id.with("close"), Sense::click());
    let name = format!("Close {}", kind.title());
    cross.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
    if cross.hovered() {
        ui.painter().rect_filled(rect.shrink((TARGET - CROSS) / 2.0), 3.0, tokens.pressed);
    }
    if is_active || response.hovered() || cross.hovered() || cross.has_focus() {
        let color = if cross.hovered() { tokens.text } else { tokens.text_faint };
        icon::paint(ui.painter(), Icon::Close, rect, 13.0, color);
    }
    cross.clicked()
}
