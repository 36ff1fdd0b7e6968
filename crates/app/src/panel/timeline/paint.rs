//! Draws the timeline.

use egui::{Align2, Color32, Pos2, Rect, Shape, Stroke, StrokeKind, TextStyle, Ui};
use tpn::{LabelId, Network, Plan};

use crate::panel::Context;
use crate::panel::timeline::ROW_HEIGHT;
use crate::panel::timeline::bars::{Bar, BarKind, ticks};
use crate::panel::timeline::view::TimeView;
use crate::state::Selection;
use crate::theme::space;

/// Points per labelled mark of the axis.
const TICK_POINTS: f32 = 84.0;

/// The axis with its numbers and the time's handle.
pub(crate) fn axis(ui: &Ui, context: &Context<'_>, rect: Rect, view: &TimeView) {
    let tokens = context.tokens;
    let painter = ui.painter().with_clip_rect(rect.expand2(egui::vec2(12.0, 0.0)));
    let font = TextStyle::Small.resolve(ui.style());
    let (from, to) = (view.time(rect, rect.left()), view.time(rect, rect.right()));
    let (marks, minor) = ticks(from, to, rect.width(), TICK_POINTS);
    let step = match marks.as_slice() {
        [first, second, ..] => second - first,
        _ => to - from,
    };
    for mark in marks.iter().copied().chain(marks.first().map(|first| first - step)) {
        for part in 1..minor {
            let x = view.x(rect, mark + step * f64::from(part) / f64::from(minor));
            if rect.x_range().contains(x) {
                painter.vline(x, rect.bottom() - 3.0..=rect.bottom(), Stroke::new(1.0, tokens.line));
            }
        }
        let x = view.x(rect, mark);
        if mark >= 0.0 && rect.x_range().contains(x) {
            painter.vline(x, rect.bottom() - 6.0..=rect.bottom(), Stroke::new(1.0, tokens.line_strong));
            let text = round_number(mark, step);
            painter.text(
                Pos2::new(x, rect.top() + 3.0),
                Align2::CENTER_TOP,
                text,
                font.clone(),
                tokens.text_muted,
            );
        }
    }
    ui.painter().hline(rect.x_range(), rect.bottom(), Stroke::new(1.0, tokens.line));
    let x = view.x(rect, context.state.playback.time);
    if rect.x_range().contains(x) {
        let bottom = rect.bottom();
        let points = vec![
            Pos2::new(x - 5.0, bottom - 9.0),
            Pos2::new(x + 5.0, bottom - 9.0),
            Pos2::new(x + 5.0, bottom - 5.0),
            Pos2::new(x, bottom),
            Pos2::new(x - 5.0, bottom - 5.0),
        ];
        painter.add(Shape::convex_polygon(points, tokens.now, Stroke::NONE));
    }
}

/// A mark's number with as many decimals as its step needs.
fn round_number(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.decimals$}")
}

/// What all parts of one frame need.
pub(crate) struct Painting<'a> {
    pub(crate) context: &'a Context<'a>,
    pub(crate) network: &'a Network,
    pub(crate) view: &'a TimeView,
    /// Where the bars are.
    pub(crate) track: Rect,
    /// The left edge of the names.
    pub(crate) names_left: f32,
}

impl Painting<'_> {
    /// The row of a bar, name included.
    pub(crate) fn row(&self, index: usize) -> Rect {
        let top = self.track.top() + 3.0 + index as f32 * ROW_HEIGHT;
        Rect::from_min_max(Pos2::new(self.names_left, top), Pos2::new(self.track.right(), top + ROW_HEIGHT))
    }

    fn x(&self, time: f64) -> f32 {
        self.view.x(self.track, time)
    }

    /// Lines down from the marks of the axis.
    pub(crate) fn grid(&self, ui: &Ui) {
        let clip = self.track.intersect(ui.clip_rect());
        let painter = ui.painter().with_clip_rect(clip);
        let (from, to) = (self.view.time(self.track, clip.left()), self.view.time(self.track, clip.right()));
        let line = Stroke::new(1.0, self.context.tokens.raised);
        for mark in ticks(from, to, self.track.width(), TICK_POINTS).0 {
            painter.vline(self.x(mark), clip.y_range(), line);
        }
        let left = Pos2::new(self.track.left(), clip.top());
        ui.painter().vline(left.x, clip.y_range(), Stroke::new(1.0, self.context.tokens.line));
    }

    /// A bar with its name: solid where it goes on for certain, hatched where it may.
    pub(crate) fn bar(&self, ui: &Ui, bar: &Bar, row: Rect, is_selected: bool, is_hovered: bool) {
        let tokens = self.context.tokens;
        if is_selected || is_hovered {
            let fill = if is_selected { tokens.accent_soft } else { tokens.raised };
            ui.painter().rect_filled(row, 3.0, fill);
        }
        self.name(ui, bar, row, is_selected);
        let painter = ui.painter().with_clip_rect(self.track.intersect(ui.clip_rect()));
        let color = self.color(bar);
        let height = if bar.kind == BarKind::Composite { 5.0 } else { 14.0 };
        let middle = row.center().y;
        let slot = |from: f64, to: f64| {
            let to = if to.is_finite() { self.x(to) } else { self.track.right() };
            Rect::from_min_max(
                Pos2::new(self.x(from), middle - height / 2.0),
                Pos2::new(to, middle + height / 2.0),
            )
        };
        let whole = slot(bar.start[0], bar.end[1]);
        painter.rect_filled(whole, 3.0, tokens.mixed(color, 0.16));
        match bar.certain() {
            Some([from, to]) => {
                self.hatch(&painter, slot(bar.start[0], from), color);
                self.hatch(&painter, slot(to, bar.end[1]), color);
                painter.rect_filled(slot(from, to), 2.0, tokens.mixed(color, 0.85));
            }
            None => self.hatch(&painter, whole, color),
        }
        let outline = if is_selected {
            Stroke::new(1.5, tokens.accent)
        } else {
            Stroke::new(1.0, tokens.mixed(color, 0.6))
        };
        painter.rect_stroke(whole, 3.0, outline, StrokeKind::Inside);
        // The earliest schedule, which playing follows.
        let earliest = slot(bar.start[0], bar.end[0].max(bar.start[0]));
        let y = earliest.bottom() + 2.0;
        painter.hline(earliest.x_range(), y, Stroke::new(2.0, color));
        for time in [bar.start[0], bar.end[0]] {
            painter.vline(self.x(time), y - 2.0..=y + 2.0, Stroke::new(1.0, color));
        }
        self.conditions(&painter, bar, whole);
    }

    fn name(&self, ui: &Ui, bar: &Bar, row: Rect, is_selected: bool) {
        let tokens = self.context.tokens;
        let names = Rect::from_min_max(row.min, Pos2::new(self.track.left() - space::S, row.bottom()));
        let painter = ui.painter().with_clip_rect(names.intersect(ui.clip_rect()));
        let indent = space::M + bar.depth as f32 * 12.0;
        let color = if is_selected { tokens.accent } else { tokens.text };
        let font = TextStyle::Body.resolve(ui.style());
        let mark = Rect::from_center_size(
            Pos2::new(names.left() + indent + 3.0, names.center().y),
            egui::vec2(6.0, if bar.kind == BarKind::Condition { 6.0 } else { 10.0 }),
        );
        painter.rect_filled(mark, if bar.kind == BarKind::Condition { 3.0 } else { 1.0 }, self.color(bar));
        let at = Pos2::new(names.left() + indent + 12.0, names.center().y);
        painter.text(at, Align2::LEFT_CENTER, &bar.name, font, color);
    }

    /// Required conditions as a line above the bar, named where there is room.
    fn conditions(&self, painter: &egui::Painter, bar: &Bar, whole: Rect) {
        let tokens = self.context.tokens;
        if bar.kind == BarKind::Condition {
            return;
        }
        let font = egui::FontId::proportional(crate::theme::size::SMALL - 1.0);
        let mut x = whole.left() + 6.0;
        for &label in bar.asks.iter().chain(&bar.tells) {
            let Some(label) = self.network.labels.get(label.index()) else { continue };
            let (verb, color) = match label.mode {
                rmpl::program::LabelMode::Ask => ("needs", tokens.ask),
                rmpl::program::LabelMode::Tell => ("sets", tokens.tell),
            };
            let text = painter.layout_no_wrap(format!("{verb} {}", label.text), font.clone(), color);
            let width = text.size().x;
            if x + width + 8.0 < whole.right() && whole.height() > 10.0 {
                let at = Pos2::new(x, whole.center().y - text.size().y / 2.0);
                let back = Rect::from_min_size(at, text.size()).expand2(egui::vec2(4.0, 0.0));
                painter.rect_filled(back, 3.0, tokens.surface);
                painter.galley(at, text, color);
                x += width + 14.0;
            }
        }
    }

    fn color(&self, bar: &Bar) -> Color32 {
        let tokens = self.context.tokens;
        match bar.kind {
            BarKind::Composite => tokens.text_muted,
            BarKind::Activity => tokens.slack,
            BarKind::Condition => tokens.tell,
            BarKind::Delay => tokens.text_faint,
        }
    }

    /// Slanted lines: time that may or may not be used.
    fn hatch(&self, painter: &egui::Painter, rect: Rect, color: Color32) {
        let visible = rect.intersect(painter.clip_rect());
        if !visible.is_positive() {
            return;
        }
        let painter = painter.with_clip_rect(visible);
        let stroke = Stroke::new(1.0, self.context.tokens.mixed(color, 0.45));
        let (step, height) = (6.0, rect.height());
        let first = ((visible.left() - rect.left() - height) / step).floor().max(0.0) as usize;
        let count = ((visible.width() + 2.0 * height) / step).ceil() as usize + 1;
        for index in first..first + count {
            let x = rect.left() + index as f32 * step - height / 2.0;
            painter.line_segment([Pos2::new(x, rect.bottom()), Pos2::new(x + height, rect.top())], stroke);
        }
    }

    /// Causal links and added orderings between the bars.
    pub(crate) fn links(&self, ui: &Ui, plan: &Plan, bars: &[Bar]) {
        let painter = ui.painter().with_clip_rect(self.track.intersect(ui.clip_rect()));
        let row_of = |label: LabelId| {
            let owner = self.network.labels.get(label.index())?.owner?;
            let index = bars.iter().position(|bar| bar.occurrence == owner)?;
            Some((self.row(index).center().y, bars.get(index)?))
        };
        let tokens = self.context.tokens;
        for &link in &plan.causal_links {
            let Some(((from_y, _), (to_y, to))) = row_of(link.tell).zip(row_of(link.ask)) else { continue };
            let x = self.x(to.start[0]) + 3.0;
            let is_selected = self.context.state.selection == Selection::Link(link);
            let stroke = Stroke::new(if is_selected { 2.5 } else { 1.4 }, tokens.link);
            curve(&painter, Pos2::new(x, from_y), Pos2::new(x, to_y), stroke, [5.0, 3.0]);
        }
        for &ordering in &plan.orderings_added {
            let ends = row_of(ordering.first).zip(row_of(ordering.then));
            let Some(((from_y, from), (to_y, to))) = ends else { continue };
            let is_selected = self.context.state.selection == Selection::Ordering(ordering);
            let stroke = Stroke::new(if is_selected { 2.5 } else { 1.4 }, tokens.ordering);
            let start = Pos2::new(self.x(from.end[0]), from_y);
            curve(&painter, start, Pos2::new(self.x(to.start[0]), to_y), stroke, [2.0, 3.0]);
        }
    }

    /// The present moment.
    pub(crate) fn now(&self, ui: &Ui) {
        let clip = self.track.intersect(ui.clip_rect());
        let x = self.x(self.context.state.playback.time);
        ui.painter().with_clip_rect(clip).vline(x, clip.y_range(), Stroke::new(1.5, self.context.tokens.now));
    }
}

/// A dashed curve that leaves and arrives sideways, with a head.
fn curve(painter: &egui::Painter, from: Pos2, to: Pos2, stroke: Stroke, [dash, gap]: [f32; 2]) {
    let bow = egui::vec2(((to.y - from.y).abs() * 0.3).clamp(14.0, 46.0), 0.0);
    let control = if (to.x - from.x).abs() < 40.0 { [from - bow, to - bow] } else { [from + bow, to - bow] };
    let curve = egui::epaint::CubicBezierShape::from_points_stroke(
        [from, control[0], control[1], to],
        false,
        Color32::TRANSPARENT,
        stroke,
    );
    let points = curve.flatten(Some(0.3));
    painter.extend(Shape::dashed_line(&points, stroke, dash, gap));
    let head = vec![to, to + egui::vec2(-6.0, -3.5), to + egui::vec2(-6.0, 3.5)];
    painter.add(Shape::convex_polygon(head, stroke.color, Stroke::NONE));
}
