//! Both plans over one time axis: the first as outlines above, the second as filled bars below.

use display::DisplayList;
use egui::{Pos2, Rect, Role, Sense, Stroke, StrokeKind, Ui, WidgetInfo};
use layout::list::timeline::{PAIR_HEIGHTS, PairRow, Track, pair_bar, pair_list};
use review::compare::{Comparison, Row, Subject, windows_text};
use theme::icon;
use theme::space;
use tpn::Window;
use workbench::command::CommandSender;
use workbench::state::playback::{bound, number};

use super::{change_look, select};
use crate::Context;
use crate::painter::{DisplayPainter, Placement};
use crate::timeline::drawn;

/// The width of the names on the left.
const NAMES_WIDTH: f32 = 190.0;
/// The height of a row.
const ROW_HEIGHT: f32 = PAIR_HEIGHTS.0 as f32;
/// The height of the axis.
const AXIS_HEIGHT: f32 = 20.0;
/// From the left edge to the names.
const INDENT: f64 = 22.0;

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
    let left = rect.left() + names_width;
    let right = rect.right() - space::M;
    // Rows in view only: there may be thousands.
    let top = rect.top() + AXIS_HEIGHT;
    let clip = ui.clip_rect();
    let first = (((clip.top() - top) / ROW_HEIGHT).floor().max(0.0) as usize).min(rows.len());
    let last = (((clip.bottom() - top) / ROW_HEIGHT).ceil().max(0.0) as usize).clamp(first, rows.len());
    let place_of = |index: usize| {
        let top = top + index as f32 * ROW_HEIGHT;
        Rect::from_min_max(Pos2::new(rect.left(), top), Pos2::new(rect.right(), top + ROW_HEIGHT))
    };
    for (index, row) in rows.iter().enumerate() {
        show_row(ui, context, row, place_of(index), commands);
    }
    let time = horizon(comparison);
    let track = Track {
        frame: drawn(rect),
        left: f64::from(left),
        right: f64::from(right),
        top: f64::from(place_of(first).top()),
        start: 0.0,
        scale: f64::from(right - left) / time,
        visible: drawn(Rect::from_min_max(
            Pos2::new(left, rect.top()),
            Pos2::new(rect.right(), rect.bottom()),
        )),
    };
    let pairs: Vec<PairRow> = rows[first..last].iter().map(|row| pair(context, row)).collect();
    paint(ui.painter(), context, &pair_list(&pairs, &track, INDENT));
}

fn pair(context: &Context<'_>, row: &Row) -> PairRow {
    let times = |windows: Option<[Window; 2]>| {
        windows.map(|windows| windows.map(|it| [number(it.earliest), bound(it.latest)]))
    };
    PairRow {
        name: context.readable(&row.name).into(),
        is_different: row.change.is_some(),
        before: times(row.before),
        after: times(row.after),
    }
}

/// Shows a list whose frame is the screen.
fn paint(painter: &egui::Painter, context: &Context<'_>, list: &DisplayList) {
    DisplayPainter::new(painter, painter.clip_rect(), Placement::SCREEN, context.tokens)
        .paint(&[list], Vec::new());
}

/// A piece of a bar as the legend shows it.
pub(super) fn sample(ui: &Ui, context: &Context<'_>, rect: Rect, is_after: bool) {
    let mut list = DisplayList::new(drawn(rect));
    let (whole, certain) = (rect.shrink2(egui::vec2(0.0, 2.0)), rect.shrink2(egui::vec2(6.0, 2.0)));
    pair_bar(&mut list, drawn(whole), Some(drawn(certain)), is_after);
    paint(ui.painter(), context, &list);
}

/// The last finite time of either plan, with a little room behind it.
fn horizon(comparison: &Comparison) -> f64 {
    let times = comparison.rows.iter().flat_map(|row| row.before.iter().chain(&row.after));
    let times = times.flat_map(|[start, end]| [bound(start.latest), number(end.earliest), bound(end.latest)]);
    times.filter(|time| time.is_finite()).fold(1.0, f64::max) * 1.02
}

fn show_row(ui: &Ui, context: &Context<'_>, row: &Row, rect: Rect, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let response = ui.interact(rect, ui.scope_id().with(("row", &row.name)), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, context.readable(&words(row))));
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
    if response.clicked() {
        select(context, &row.name, commands);
    }
    response.on_hover_text(context.readable(&words(row)));
}

fn words(row: &Row) -> String {
    let text = |windows: Option<[Window; 2]>| windows.map(windows_text);
    let change = row.change.map_or("unchanged", review::compare::Change::name);
    let times = match (text(row.before), text(row.after)) {
        (Some(before), Some(after)) if before != after => format!("{before}, now {after}"),
        (_, Some(only)) | (Some(only), None) => only,
        (None, None) => String::new(),
    };
    format!("{}, {change}: {times}", row.name)
}
