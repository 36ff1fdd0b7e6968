//! Both plans over one time axis: the first as outlines above, the second as filled bars below.

use egui::{
    Align2, Color32, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, WidgetInfo,
};
use mission::compare::{Comparison, Row, Subject, windows_text};
use theme::icon;
use theme::space;
use tpn::Window;
use workbench::command::CommandSender;
use workbench::state::playback::{bound, number};

use super::{change_look, select};
use crate::Context;
use crate::timeline::ticks::Ticks;

/// The width of the names on the left.
const NAMES_WIDTH: f32 = 190.0;
/// The height of a row.
const ROW_HEIGHT: f32 = 28.0;
/// The height of the axis.
const AXIS_HEIGHT: f32 = 20.0;
/// The height of a bar.
const BAR_HEIGHT: f32 = 9.0;

/// Shows the rows of a comparison.
pub(super) fn show(
    ui: &mut Ui,
    context: &Context<'_>,
    comparison: &Comparison,
    only_differences: bool,
    commands: &mut CommandSender,
) {
    // Delays only fill the time between what happens.
    let is_shown = |row: &&Row| row.subject != Subject::Delay && (!only_differences || row.change.is_some());
    let rows: Vec<&Row> = comparison.rows.iter().filter(is_shown).collect();
    if rows.is_empty() {
        return;
    }
    let width = ui.available_width();
    let height = AXIS_HEIGHT + rows.len() as f32 * ROW_HEIGHT;
    let (rect, _) = ui.allocate_exact_size(egui::vec2(width, height), Sense::hover());
    let names_width = NAMES_WIDTH.min(width * 0.42);
    let track = Rect::from_min_max(
        Pos2::new(rect.left() + names_width, rect.top() + AXIS_HEIGHT),
        Pos2::new(rect.right() - space::M, rect.bottom()),
    );
    let scale = Scale { track, horizon: horizon(comparison) };
    axis(ui, context, &scale);
    for (index, row) in rows.iter().enumerate() {
        let top = track.top() + index as f32 * ROW_HEIGHT;
        let place =
            Rect::from_min_max(Pos2::new(rect.left(), top), Pos2::new(rect.right(), top + ROW_HEIGHT));
        show_row(ui, context, row, place, &scale, commands);
    }
}

/// A piece of a bar as the legend shows it.
pub(super) fn sample(ui: &Ui, context: &Context<'_>, rect: Rect, is_after: bool) {
    bar(
        ui.painter(),
        context,
        rect.shrink2(egui::vec2(0.0, 2.0)),
        rect.shrink2(egui::vec2(6.0, 2.0)),
        is_after,
    );
}

struct Scale {
    track: Rect,
    horizon: f64,
}

impl Scale {
    fn x(&self, time: f64) -> f32 {
        let part = (time / self.horizon).clamp(0.0, 1.0);
        self.track.left() + self.track.width() * part as f32
    }
}

/// The last finite time of either plan, with a little room behind it.
fn horizon(comparison: &Comparison) -> f64 {
    let times = comparison.rows.iter().flat_map(|row| row.before.iter().chain(&row.after));
    let times = times.flat_map(|[start, end]| [bound(start.latest), number(end.earliest), bound(end.latest)]);
    times.filter(|time| time.is_finite()).fold(1.0, f64::max) * 1.02
}

fn axis(ui: &Ui, context: &Context<'_>, scale: &Scale) {
    let tokens = context.tokens;
    let painter = ui.painter();
    let font = TextStyle::Small.resolve(ui.style());
    let ticks = Ticks::new(0.0, scale.horizon, scale.track.width());
    for &mark in &ticks.marks {
        let x = scale.x(mark);
        painter.vline(x, scale.track.y_range(), Stroke::new(1.0, tokens.line));
        let at = Pos2::new(x, scale.track.top() - 4.0);
        painter.text(at, Align2::CENTER_BOTTOM, ticks.label(mark), font.clone(), tokens.text_muted);
    }
}

fn show_row(
    ui: &Ui,
    context: &Context<'_>,
    row: &Row,
    rect: Rect,
    scale: &Scale,
    commands: &mut CommandSender,
) {
    let tokens = context.tokens;
    let response = ui.interact(rect, ui.scope_id().with(("row", &row.name)), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, words(row)));
    if !ui.is_rect_visible(rect) {
        return;
    }
    if response.hovered() || response.has_focus() {
        ui.painter().rect_filled(rect, 3.0, tokens.hover);
    }
    if response.has_focus() {
        ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.0, tokens.accent), StrokeKind::Inside);
    }
    let middle = rect.center().y;
    if let Some((sign, color)) = row.change.map(|change| change_look(tokens, change)) {
        let at = Rect::from_center_size(Pos2::new(rect.left() + 9.0, middle), egui::vec2(14.0, 14.0));
        icon::paint(ui.painter(), sign, at, 13.0, color);
    }
    let names = Rect::from_min_max(rect.min, Pos2::new(scale.track.left() - space::S, rect.bottom()));
    let painter = ui.painter().with_clip_rect(names.intersect(ui.clip_rect()));
    let color = if row.change.is_some() { tokens.text } else { tokens.text_muted };
    let font = TextStyle::Body.resolve(ui.style());
    painter.text(Pos2::new(rect.left() + 22.0, middle), Align2::LEFT_CENTER, &row.name, font, color);
    let clip = Rect::from_min_max(Pos2::new(scale.track.left(), rect.top()), rect.max);
    let painter = ui.painter().with_clip_rect(clip.intersect(ui.clip_rect()));
    for (windows, is_after) in [(row.before, false), (row.after, true)] {
        if let Some(windows) = windows {
            window_bar(&painter, context, windows, scale, middle, is_after);
        }
    }
    if response.clicked() {
        select(context, &row.name, commands);
    }
    response.on_hover_text(words(row));
}

fn window_bar(
    painter: &Painter,
    context: &Context<'_>,
    [start, end]: [Window; 2],
    scale: &Scale,
    middle: f32,
    is_after: bool,
) {
    let y = if is_after { middle + BAR_HEIGHT / 2.0 + 1.0 } else { middle - BAR_HEIGHT / 2.0 - 1.0 };
    let slot = |from: f64, to: f64| {
        let (from, to) = (scale.x(from), scale.x(to).max(scale.x(from) + 2.0));
        Rect::from_min_max(Pos2::new(from, y - BAR_HEIGHT / 2.0), Pos2::new(to, y + BAR_HEIGHT / 2.0))
    };
    let whole = slot(number(start.earliest), bound(end.latest));
    let (from, to) = (bound(start.latest), number(end.earliest));
    let certain = if from < to { slot(from, to) } else { Rect::NOTHING };
    bar(painter, context, whole, certain, is_after);
}

/// A bar: pale where it may go on, strong where it goes on for certain. The first plan's bars are outlines with lines
/// across, the second's are filled, so that no colour is needed to tell them apart.
fn bar(painter: &Painter, context: &Context<'_>, whole: Rect, certain: Rect, is_after: bool) {
    let tokens = context.tokens;
    let color: Color32 = if is_after { tokens.slack } else { tokens.text_muted };
    if is_after {
        painter.rect_filled(whole, 2.0, tokens.mixed(color, 0.35));
        if certain.is_positive() {
            painter.rect_filled(certain, 2.0, color);
        }
        return;
    }
    painter.rect_stroke(whole, 2.0, Stroke::new(1.0, color), StrokeKind::Inside);
    if certain.is_positive() {
        let painter = painter.with_clip_rect(certain.intersect(painter.clip_rect()));
        let visible = certain.intersect(painter.clip_rect());
        let first = ((visible.left() - certain.left()) / 4.0).floor().max(0.0) as usize;
        let count = (visible.width().max(0.0) / 4.0).ceil() as usize + 4;
        for index in first..first + count {
            let x = certain.left() + index as f32 * 4.0 - certain.height();
            let ends = [Pos2::new(x, certain.bottom()), Pos2::new(x + certain.height(), certain.top())];
            painter.add(Shape::line_segment(ends, Stroke::new(1.0, color)));
        }
    }
}

fn words(row: &Row) -> String {
    let text = |windows: Option<[Window; 2]>| windows.map(windows_text);
    let change = row.change.map_or("the same", mission::compare::Change::name);
    let times = match (text(row.before), text(row.after)) {
        (Some(before), Some(after)) if before != after => format!("{before}, now {after}"),
        (_, Some(only)) | (Some(only), None) => only,
        (None, None) => String::new(),
    };
    format!("{}, {change}: {times}", row.name)
}
