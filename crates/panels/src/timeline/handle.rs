//! Handles of events: dragging one pins its event inside its window, and everything else moves along.

use std::collections::BTreeMap;

use egui::{
    CursorIcon, EventFilter, Key, Rect, Response, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2, vec2,
};
use exact::Time;
use layout::timeline::Bar;
use tpn::{EventEnd, EventRef, NodeId};
use workbench::command::{Command, CommandSender};
use workbench::state::PinCommand;
use workbench::state::pins::event_name;
use workbench::state::playback::{bound, number};
use workbench::time_text;

use super::bar;
use super::paint::{Painting, note};
use super::view::TimeView;
use crate::Context;

/// The pinned events of a frame.
pub(super) type Pinned = BTreeMap<NodeId, Time>;

/// How far a handle reaches into its bar, and out of it, in points: outside there may be the next bar.
const REACH: (f32, f32) = (7.0, 3.0);
/// The upper part of a row belongs to the handles of bounds.
const TOP: f32 = 8.0;

/// Shows the handles of a bar's two events. `is_prominent` draws them before the pointer is over one.
pub(super) fn show(
    ui: &Ui,
    painting: &Painting<'_>,
    pinned: &Pinned,
    (row_index, bar): (usize, &Bar),
    is_prominent: bool,
    commands: &mut CommandSender,
) {
    if !bar.is_complete(painting.network) {
        return;
    }
    let row = painting.row(row_index);
    let windows = [bar.start, bar.end];
    let [start_x, end_x] = windows.map(|window| painting.x(window[0]));
    let between = f32::midpoint(start_x, end_x);
    for (side, &node) in bar.events.iter().enumerate() {
        let is_pinned = pinned.contains_key(&node);
        let is_free = bar.free[side][1] > bar.free[side][0];
        if !is_free || !(is_pinned || windows[side][1] > windows[side][0]) {
            continue;
        }
        let x = [start_x, end_x][side];
        // Where the bar is too narrow for both handles, each reaches out as far as it cannot reach in.
        let inside = REACH.0.min((end_x - start_x).abs() / 2.0);
        let outside = (REACH.0 - inside).max(REACH.1);
        let (left, right) = match side {
            0 => (x - outside, (x + inside).min(between)),
            _ => ((x - inside).max(between), x + outside),
        };
        let area = Rect::from_min_max(pos2(left, row.top() + TOP), pos2(right, row.bottom()));
        let area = area.intersect(painting.visible.expand2(vec2(REACH.0, 0.0)));
        if !area.is_positive() {
            continue;
        }
        // The row may change, and a node may be the event of several.
        let id = ui.scope_id().with(("event", bar.occurrence, side));
        let response = ui.interact(area, id, Sense::click_and_drag());
        let name = name_of(painting, bar, side);
        response.widget_info(|| {
            let label = format!("Move {name} on the timeline");
            WidgetInfo::slider(true, windows[side][0], label)
        });
        follow(ui, &response, painting, node, windows[side][0], commands);
        // The handles of a narrow bar cover all of it.
        if response.clicked() {
            commands.send(Command::Select(bar::selection(bar, painting.network)));
        }
        let is_held = painting.context.state.pins.held().is_some_and(|(held, _)| held == node);
        if is_pinned || is_prominent || is_held || response.hovered() || response.has_focus() {
            paint(ui, painting, x, row, is_pinned, is_held || response.hovered() || response.has_focus());
        }
        let is_natures = bar.natures.is_some() && side == 1;
        let hint = match (is_pinned, is_natures) {
            (true, _) => "Double-click to unpin.",
            (false, true) => "Uncontrolled. Drag to choose its duration and see how the executive reacts.",
            (false, false) => "Drag to see which events move with it.",
        };
        response.on_hover_cursor(CursorIcon::ResizeHorizontal).on_hover_ui_at_pointer(|ui| {
            ui.label(theme::strong(name));
            ui.label(in_words(windows[side], is_pinned));
            ui.label(hint);
        });
    }
}

/// Over everything, while an event is held: its window, and where it is.
pub(super) fn show_held(ui: &Ui, painting: &Painting<'_>, pinned: &Pinned) {
    let Some((node, window)) = painting.context.state.pins.held() else { return };
    let Some(&time) = pinned.get(&node) else { return };
    let tokens = painting.context.tokens;
    let painter = painting.on_track(ui);
    let (from, to) = (painting.x(number(window.earliest)), painting.x(bound(window.latest)));
    let band = Rect::from_x_y_ranges(from..=to, painting.visible.y_range());
    painter.rect_filled(band, 0.0, tokens.accent.gamma_multiply(0.07));
    for x in [from, to] {
        painter.vline(x, band.y_range(), Stroke::new(1.0, tokens.accent.gamma_multiply(0.5)));
    }
    let x = painting.x(number(time));
    painter.vline(x, band.y_range(), Stroke::new(1.5, tokens.accent));
    let text = format!(
        "{} at {}, window {}",
        painting.network.readable(&event_name(painting.network, node)),
        time_text::time(time),
        time_text::interval(window.earliest, window.latest)
    );
    let pointer = ui.input(|input| input.pointer.hover_pos()).unwrap_or(band.center_top());
    note(&painter, painting.context, pos2(x + 10.0, pointer.y - 34.0), &text, tokens.accent);
}

/// A time in the view as a round number: no finer than what a point of the screen can tell apart.
pub(super) fn round_time(view: &TimeView, time: f64) -> Time {
    let exponent = (1.0 / view.scale).log10().floor().clamp(-3.0, 9.0) as i32;
    if exponent >= 0 {
        let step = 10_f64.powi(exponent);
        let round = (time / step).round() * step;
        return Time::from_f64_nearest(round.clamp(-1e15, 1e15), 1).unwrap_or_default();
    }
    Time::from_f64_nearest(time.clamp(-1e12, 1e12), 10_u32.pow(exponent.unsigned_abs())).unwrap_or_default()
}

fn in_words(window: [f64; 2], is_pinned: bool) -> String {
    let [from, to] =
        window.map(|time| if time.is_finite() { format!("{}", round3(time)) } else { "∞".to_owned() });
    if is_pinned { format!("pinned at {from}") } else { format!("window {from} to {to}") }
}

fn round3(time: f64) -> f64 {
    (time * 1000.0).round() / 1000.0
}

/// The name of an event as its bar's: a node may be the event of several.
fn name_of(painting: &Painting<'_>, bar: &Bar, side: usize) -> String {
    match bar.occurrence {
        Some(occurrence) => {
            let end = if side == 0 { EventEnd::Start } else { EventEnd::End };
            painting.network.readable(&painting.network.event_name(EventRef { occurrence, end }))
        }
        None => painting.network.readable(&event_name(painting.network, bar.events[side])),
    }
}

/// Drags and keys.
fn follow(
    ui: &Ui,
    response: &Response,
    painting: &Painting<'_>,
    node: NodeId,
    now: f64,
    commands: &mut CommandSender,
) {
    let mut send = |command| commands.send(Command::Pins(command));
    let is_held = painting.context.state.pins.held().is_some_and(|(held, _)| held == node);
    if response.drag_started() {
        send(PinCommand::Grab(node));
    }
    if response.dragged()
        && is_held
        && let Some(pointer) = response.interact_pointer_pos()
    {
        send(PinCommand::MoveTo(round_time(painting.view, painting.view.time(painting.track, pointer.x))));
    }
    if response.drag_stopped() && is_held {
        send(PinCommand::Drop);
    }
    if response.double_clicked() {
        send(PinCommand::Release(node));
    }
    if response.clicked() {
        response.request_focus();
    }
    if !response.has_focus() {
        return;
    }
    let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let (steps, is_released) = ui.input(|input| {
        let large = if input.modifiers.shift { 10.0 } else { 1.0 };
        let pressed = |key| f64::from(u8::from(input.key_pressed(key)));
        let steps = (pressed(Key::ArrowRight) - pressed(Key::ArrowLeft)) * large;
        (steps, input.key_pressed(Key::Delete) || input.key_pressed(Key::Backspace))
    });
    if steps != 0.0 {
        // Eight points are far enough to be seen, and near enough to aim.
        send(PinCommand::Pin(node, round_time(painting.view, now + steps * 8.0 / painting.view.scale)));
    }
    if is_released {
        send(PinCommand::Release(node));
    }
}

fn paint(ui: &Ui, painting: &Painting<'_>, x: f32, row: Rect, is_pinned: bool, is_strong: bool) {
    let tokens = painting.context.tokens;
    let painter = painting.on_track(ui);
    let middle = row.center().y - 2.0;
    if is_pinned {
        // A pin: a head above a needle, so that color is not the only sign.
        painter.vline(x, row.top() + 2.0..=row.bottom() - 1.0, Stroke::new(2.0, tokens.accent));
        painter.circle(pos2(x, row.top() + 5.0), 4.5, tokens.accent, Stroke::new(1.0, tokens.surface));
        return;
    }
    let grip = Rect::from_center_size(pos2(x, middle), vec2(5.0, 15.0));
    let line = Stroke::new(if is_strong { 2.0 } else { 1.2 }, tokens.accent);
    painter.rect(grip, 2.5, tokens.surface, line, StrokeKind::Middle);
}

/// Returns what the timeline says of the pins: how many there are, or which event is held.
pub(super) fn summary(context: &Context<'_>) -> Option<String> {
    match context.state.pins.all().len() {
        0 if !context.state.pins.is_empty() => Some("controllability run in progress".to_owned()),
        0 => None,
        1 => Some("1 event pinned".to_owned()),
        count => Some(format!("{count} events pinned")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dragged_times_are_as_round_as_the_zoom_allows() {
        let at = |scale: f64, time: f64| round_time(&TimeView { start: 0.0, scale }, time);
        assert_eq!(at(0.9, 432.4), Time::from(432));
        assert_eq!(at(0.04, 1_234.5), Time::from(1_230));
        assert_eq!(at(20.0, 12.345), Time::new(1_235, 100).unwrap());
        assert_eq!(at(3.0, 12.345), Time::new(123, 10).unwrap());
    }
}
