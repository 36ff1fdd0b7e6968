//! What is carried from one place of the drawings to another: an activity or a connection from it to another one, or a site to
//! a vehicle.
//!
//! What a drop would do to the text is shown beside the pointer before it is done.

use std::sync::Arc;

use egui::{
    Align2, Context as Egui, CursorIcon, DragAndDrop, FontId, Id, LayerId, Order, Pos2, Rect, Role, Sense,
    Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use rmpl::Span;
use smol_str::SmolStr;
use theme::size;
use workbench::command::{Command, CommandSender};
use workbench::state::drawing::{Change, DrawCommand, Place};

use crate::Context;

/// Something that is carried.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Carried {
    /// The activity that is written here.
    Activity(Span),
    /// A connection from the activity that is written here: what it is dropped on starts after it.
    Connection(Span),
    /// The location of this name.
    Site(SmolStr),
}

/// The height of the box of a vehicle without a lane.
const BOX_HEIGHT: f32 = 26.0;
/// The distance from an activity to its connector, and the connector's radius.
const CONNECTOR: (f32, f32) = (12.0, 5.0);

/// Carries something with the pointer until its button is released.
pub(crate) fn take(egui: &Egui, carried: Carried) {
    DragAndDrop::set_payload(egui, carried);
}

/// Stops carrying a site: the pointer is over the map again.
pub(crate) fn put_site_back(egui: &Egui) {
    if matches!(carried(egui), Some(Carried::Site(_))) {
        DragAndDrop::clear_payload(egui);
    }
}

/// Returns what is carried.
pub(crate) fn carried(egui: &Egui) -> Option<Carried> {
    DragAndDrop::payload::<Carried>(egui).map(|carried| (*carried).clone())
}

/// Shows the connector of the selected activity, whose drawing ends at `end` in its middle: a drag from it to another
/// activity lets that one start after this one.
pub(crate) fn connector(ui: &Ui, context: &Context<'_>, end: Pos2, area: Rect, (span, name): (Span, &str)) {
    if context.state.drawn_statement() != Some(span) {
        return;
    }
    let center = end + vec2(CONNECTOR.0, 0.0);
    let place = Rect::from_center_size(center, egui::Vec2::splat(2.0 * CONNECTOR.1 + 4.0));
    if !area.contains_rect(place) {
        return;
    }
    let id = ui.scope_id().with(("connector", span.start));
    let response = ui.interact(place, id, Sense::drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Connect {name}")));
    if response.drag_started() {
        take(ui.ctx(), Carried::Connection(span));
    }
    let tokens = context.tokens;
    let is_carried = carried(ui.ctx()) == Some(Carried::Connection(span));
    let fill = if is_carried || response.hovered() { tokens.accent } else { tokens.surface };
    let painter = ui.painter().with_clip_rect(area);
    painter.line_segment([end, center], Stroke::new(1.5, tokens.accent));
    painter.circle(center, CONNECTOR.1, fill, Stroke::new(1.5, tokens.accent));
    if let Some(pointer) = ui.input(|input| input.pointer.interact_pos()).filter(|_| is_carried) {
        let painter = ui.ctx().layer_painter(layer("connection"));
        painter.arrow(center, pointer - center, Stroke::new(2.0, tokens.accent));
    }
    let hint = format!("Drag to the activity that starts after {name}");
    response.on_hover_cursor(CursorIcon::Crosshair).on_hover_text(hint);
}

/// Carries an activity or a connection over another activity. An activity goes before it in its left half, after it in its
/// right half, and at the same time with Alt.
pub(crate) fn over_activity(
    ui: &Ui,
    context: &Context<'_>,
    other: Span,
    is_left: bool,
    commands: &mut CommandSender,
) {
    let what = match carried(ui.ctx()).filter(|_| !context.is_stale) {
        Some(Carried::Activity(what)) => what,
        Some(Carried::Connection(from)) if from != other => {
            return offer(ui, context, Change::Connect { from, to: other }, commands);
        }
        _ => return,
    };
    if what == other {
        return;
    }
    let at = match (ui.input(|input| input.modifiers.alt), is_left) {
        (true, _) => Place::Beside(other),
        (false, true) => Place::Before(other),
        (false, false) => Place::After(other),
    };
    offer(ui, context, Change::Move { what, at }, commands);
}

/// Carries a site over the timeline: each vehicle has its lane, or a box at the bottom if it has no lane. `lanes` is only
/// asked while a site is carried.
pub(crate) fn over_timeline(
    ui: &Ui,
    context: &Context<'_>,
    area: Rect,
    lanes: impl FnOnce() -> Vec<(SmolStr, Rect)>,
    commands: &mut CommandSender,
) {
    let Some(Carried::Site(location)) = carried(ui.ctx()).filter(|_| !context.is_stale) else { return };
    let Some(snapshot) = context.snapshot else { return };
    let lanes = lanes();
    let pointer = ui.input(|input| input.pointer.interact_pos());
    let painter = ui.ctx().layer_painter(layer("sites")).with_clip_rect(area);
    let mut bottom = area.bottom();
    for vehicle in &snapshot.program.world.vehicles {
        let name = &vehicle.name.text;
        let own = lanes.iter().filter(|(of, _)| of == name).map(|(_, rect)| *rect).reduce(Rect::union);
        let place = own.map(|rect| rect.intersect(area)).filter(Rect::is_positive).unwrap_or_else(|| {
            bottom -= BOX_HEIGHT;
            Rect::from_min_max(pos2(area.left(), bottom), pos2(area.right(), bottom + BOX_HEIGHT))
        });
        let is_over = pointer.is_some_and(|at| place.contains(at));
        let tokens = context.tokens;
        if own.is_none() || is_over {
            painter.rect_filled(place, 2.0, if is_over { tokens.accent_soft } else { tokens.raised });
        }
        painter.rect_stroke(place.shrink(1.0), 2.0, Stroke::new(1.0, tokens.accent), StrokeKind::Inside);
        let font = FontId::proportional(size::SMALL);
        let text = format!("Send {name} to {location}");
        let node = ui.interact(place, Id::unique(("send", name)), Sense::hover());
        node.widget_info(|| WidgetInfo::labeled(Role::Label, true, &text));
        painter.text(place.left_top() + vec2(8.0, 6.0), Align2::LEFT_TOP, text, font, tokens.text);
        if is_over {
            let change = Change::Visit { vehicle: name.to_string(), location: location.to_string() };
            offer(ui, context, change, commands);
        }
    }
}

/// Shows what a drop here would do to the text, and makes the change when the button is released.
fn offer(ui: &Ui, context: &Context<'_>, change: Change, commands: &mut CommandSender) {
    let (pointer, is_dropped) =
        ui.input(|input| (input.pointer.interact_pos(), input.pointer.any_released()));
    let preview = preview(ui.ctx(), context, &change);
    if let Some(at) = pointer {
        let text = preview.as_ref().as_ref().unwrap_or_else(|reason| reason);
        let color = if preview.is_ok() { context.tokens.accent } else { context.tokens.warning };
        let painter = ui.ctx().layer_painter(layer("preview"));
        let font = FontId::monospace(size::SMALL);
        let galley = painter.layout_no_wrap(text.clone(), font, context.tokens.text);
        let screen = ui.ctx().content_rect();
        let wanted = galley.size() + vec2(12.0, 8.0);
        let left = (at.x + 14.0).min(screen.right() - wanted.x).max(screen.left());
        let top = (at.y + 18.0).min(screen.bottom() - wanted.y).max(screen.top());
        let rect = Rect::from_min_size(pos2(left, top), wanted);
        painter.rect(rect, 4.0, context.tokens.raised, Stroke::new(1.0, color), StrokeKind::Inside);
        painter.galley(rect.min + vec2(6.0, 4.0), galley, context.tokens.text);
    }
    if is_dropped && preview.is_ok() {
        DragAndDrop::clear_payload(ui.ctx());
        commands.send(Command::Draw(DrawCommand::Make(change)));
    }
}

/// Returns what a change would do to the text, as [`workbench::state::AppState::drawing_preview`] says: asked once for
/// as long as text and change stay the same.
pub(crate) fn preview(egui: &Egui, context: &Context<'_>, change: &Change) -> Preview {
    #[derive(Clone)]
    struct Asked {
        text: (u64, u64, usize, bool),
        change: Change,
        answer: Preview,
    }
    let state = context.state;
    let text = (state.missions_opened, state.document.revision(), state.file_at_caret(), context.is_stale);
    let id = Id::unique("preview of a change");
    let asked = egui.data(|data| data.get_temp::<Asked>(id));
    if let Some(asked) = asked.filter(|asked| asked.text == text && asked.change == *change) {
        return asked.answer;
    }
    let answer = Preview::new(state.drawing_preview(change));
    let asked = Asked { text, change: change.clone(), answer: Preview::clone(&answer) };
    egui.data_mut(|data| data.insert_temp(id, asked));
    answer
}

/// The lines that a change changes, or why it cannot be made.
type Preview = Arc<Result<String, String>>;

fn layer(name: &'static str) -> LayerId {
    LayerId::new(Order::Tooltip, Id::unique(("dragged", name)))
}
