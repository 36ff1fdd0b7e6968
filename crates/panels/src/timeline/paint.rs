//! Draws the axis, the names and the bars. Links are drawn in [`super::link`].

use std::sync::Arc;

use egui::text::LayoutJob;
use egui::{
    Align2, Color32, FontId, Galley, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};
use theme::icon::{self, Icon};
use theme::{size, space};
use tpn::Network;

use super::chart::{Bar, BarKind, Chart, Row, RowKind};
use super::hatch;
use super::ticks::Ticks;
use super::view::TimeView;
use crate::Context;

/// The height of a bar's row.
pub(super) const ROW_HEIGHT: f32 = 24.0;
/// Indentation per level.
const INDENT: f32 = 12.0;
/// A bar narrower than this is only a stroke.
const LEAST_WIDTH: f32 = 3.0;

/// What all parts of one frame need.
pub(super) struct Painting<'a> {
    /// The state.
    pub(super) context: &'a Context<'a>,
    /// The network.
    pub(super) network: &'a Network,
    /// The rows and bars.
    pub(super) chart: &'a Chart,
    /// Where times are.
    pub(super) view: &'a TimeView,
    /// Where the bars are, all rows.
    pub(super) track: Rect,
    /// The part of it that is seen.
    pub(super) visible: Rect,
    /// The left edge of the names.
    pub(super) names_left: f32,
}

/// The axis with its numbers, the selected range and the time's handle.
pub(super) fn axis(ui: &Ui, context: &Context<'_>, rect: Rect, view: &TimeView, unit: &str) {
    let tokens = context.tokens;
    let painter = ui.painter().with_clip_rect(rect.expand2(vec2(14.0, 0.0)));
    let font = FontId::proportional(size::SMALL);
    let ticks = Ticks::new(view.time(rect, rect.left()), view.time(rect, rect.right()), rect.width());
    let before = ticks.marks.first().map(|first| first - ticks.step);
    for &mark in before.iter().chain(&ticks.marks) {
        for part in 1..ticks.parts {
            let x = view.x(rect, mark + ticks.step * f64::from(part) / f64::from(ticks.parts));
            if rect.x_range().contains(x) {
                painter.vline(x, rect.bottom() - 3.0..=rect.bottom(), Stroke::new(1.0, tokens.line_strong));
            }
        }
        let x = view.x(rect, mark);
        if rect.x_range().contains(x) && mark >= -ticks.step * 0.5 {
            painter.vline(x, rect.bottom() - 6.0..=rect.bottom(), Stroke::new(1.0, tokens.text_faint));
            let at = pos2(x, rect.top() + 3.0);
            painter.text(at, Align2::CENTER_TOP, ticks.label(mark), font.clone(), tokens.text_muted);
        }
    }
    let at = pos2(rect.left() - 10.0, rect.top() + 3.0);
    ui.painter().text(at, Align2::RIGHT_TOP, unit, font, tokens.text_faint);
    ui.painter().hline(rect.x_range(), rect.bottom(), Stroke::new(1.0, tokens.line));
    let x = view.x(rect, context.state.playback.time);
    if rect.x_range().contains(x) {
        let bottom = rect.bottom();
        let corner = |dx: f32, dy: f32| pos2(x + dx, bottom + dy);
        let points = vec![
            corner(-5.0, -9.0),
            corner(5.0, -9.0),
            corner(5.0, -5.0),
            corner(0.0, 0.0),
            corner(-5.0, -5.0),
        ];
        painter.add(Shape::convex_polygon(points, tokens.now, Stroke::NONE));
    }
}

impl Painting<'_> {
    /// The row of this number, name included.
    pub(super) fn row(&self, index: usize) -> Rect {
        let top = self.track.top() + 3.0 + index as f32 * ROW_HEIGHT;
        Rect::from_min_max(pos2(self.names_left, top), pos2(self.track.right(), top + ROW_HEIGHT))
    }

    /// Where a time is.
    pub(super) fn x(&self, time: f64) -> f32 {
        if time.is_finite() { self.view.x(self.track, time) } else { self.track.right() + 8.0 }
    }

    /// A painter for what lies along time.
    pub(super) fn on_track(&self, ui: &Ui) -> Painter {
        ui.painter().with_clip_rect(self.visible)
    }

    /// The rectangle of a bar: from its earliest start to its latest end.
    pub(super) fn bar_rect(&self, bar: &Bar, row: Rect) -> Rect {
        self.slot(bar, row, bar.start[0], bar.end[1])
    }

    fn slot(&self, bar: &Bar, row: Rect, from: f64, to: f64) -> Rect {
        let (height, lift) = match bar.kind {
            BarKind::Composite => (6.0, 0.0),
            BarKind::Ask => (8.0, 0.0),
            _ => (14.0, 1.0),
        };
        let middle = row.center().y - lift;
        let (from, to) = (self.x(from), self.x(to));
        Rect::from_min_max(pos2(from, middle - height / 2.0), pos2(to.max(from), middle + height / 2.0))
    }

    /// Lines down from the marks of the axis, and the selected range.
    pub(super) fn grid(&self, ui: &Ui) {
        let tokens = self.context.tokens;
        let painter = self.on_track(ui);
        let (left, right) = (self.visible.left(), self.visible.right());
        let ticks =
            Ticks::new(self.view.time(self.track, left), self.view.time(self.track, right), right - left);
        for mark in ticks.marks {
            painter.vline(self.x(mark), self.visible.y_range(), Stroke::new(1.0, tokens.raised));
        }
        if let Some([from, to]) = self.context.state.time_range {
            let band = Rect::from_x_y_ranges(self.x(from)..=self.x(to), self.visible.y_range());
            painter.rect_filled(band, 0.0, tokens.accent.gamma_multiply(0.10));
            for x in [band.left(), band.right()] {
                painter.vline(x, band.y_range(), Stroke::new(1.0, tokens.accent.gamma_multiply(0.7)));
            }
        }
        ui.painter().vline(left, self.visible.y_range(), Stroke::new(1.0, tokens.line));
    }

    /// The background of a row that is selected, pointed at, or a heading.
    pub(super) fn row_ground(&self, ui: &Ui, shown: &Row, row: Rect, is_selected: bool, is_hovered: bool) {
        let tokens = self.context.tokens;
        let fill = match (is_selected, is_hovered, shown.kind) {
            (true, ..) => tokens.accent_soft,
            (_, true, _) => tokens.raised,
            (.., RowKind::Heading) => tokens.raised.gamma_multiply(0.6),
            _ => return,
        };
        ui.painter().rect_filled(row, 3.0, fill);
    }

    /// The name of a row, shortened to the room there is, and the sign that opens and closes it.
    pub(super) fn name(&self, ui: &Ui, shown: &Row, row: Rect, is_selected: bool) {
        let tokens = self.context.tokens;
        let arrow = arrow_rect(shown, row);
        if shown.key.is_some() {
            let sign = if shown.is_closed { Icon::ChevronRight } else { Icon::ChevronDown };
            icon::paint(ui.painter(), sign, arrow, 10.0, tokens.text_muted);
        } else if let Some(bar) = self.chart.bars.get(shown.bars.clone()).and_then(<[Bar]>::first)
            && shown.kind == RowKind::Single
        {
            let mark = Rect::from_center_size(arrow.center(), vec2(6.0, 10.0));
            ui.painter().rect_filled(mark, 1.0, self.color(bar.kind));
        }
        let at = pos2(arrow.right() + 2.0, row.center().y);
        let width = self.track.left() - space::S - at.x;
        let color = match (is_selected, shown.kind) {
            (true, _) => tokens.accent,
            (_, RowKind::Track) => tokens.tell,
            _ => tokens.text,
        };
        let family = if shown.kind == RowKind::Heading {
            theme::strong_family()
        } else {
            egui::FontFamily::Proportional
        };
        let galley = elided(ui.painter(), &shown.name, FontId::new(size::BODY, family), color, width);
        ui.painter().galley(at - vec2(0.0, galley.size().y / 2.0), galley, color);
    }

    /// A bar: solid where it goes on for certain, hatched where it may, with the earliest schedule under it.
    pub(super) fn bar(&self, painter: &Painter, bar: &Bar, row: Rect, is_selected: bool, is_hovered: bool) {
        let tokens = self.context.tokens;
        let color = self.color(bar.kind);
        let whole = self.bar_rect(bar, row);
        let rounding = if bar.kind == BarKind::Ask { 4.0 } else { 3.0 };
        if bar.is_narrowed() {
            let ghost = self.slot(bar, row, bar.free[0][0], bar.free[1][1]);
            painter.rect_filled(ghost, rounding, tokens.mixed(color, 0.07));
            let line = Stroke::new(1.0, tokens.mixed(color, 0.35));
            painter.rect_stroke(ghost, rounding, line, StrokeKind::Inside);
        }
        if whole.width() < LEAST_WIDTH {
            let stroke = Rect::from_center_size(whole.center(), vec2(LEAST_WIDTH, whole.height()));
            painter.rect_filled(stroke, 1.0, tokens.mixed(color, 0.75));
            return;
        }
        painter.rect_filled(whole, rounding, tokens.mixed(color, 0.16));
        let mut mesh = Mesh::default();
        let ink = tokens.mixed(color, 0.5);
        if let Some([from, to]) = bar.certain() {
            hatch::add(&mut mesh, self.slot(bar, row, bar.start[0], from), self.visible, ink);
            hatch::add(&mut mesh, self.slot(bar, row, to, bar.end[1]), self.visible, ink);
            painter.add(Shape::mesh(mesh));
            painter.rect_filled(self.slot(bar, row, from, to), 2.0, tokens.mixed(color, 0.85));
        } else {
            hatch::add(&mut mesh, whole, self.visible, ink);
            painter.add(Shape::mesh(mesh));
        }
        let now = self.context.state.playback.time;
        // What runs at the time shown: its start has happened, its end has not.
        let is_running = self.context.state.is_executing()
            && bar.kind != BarKind::Ask
            && bar.start[0] >= bar.start[1]
            && (bar.start[0]..bar.end[1]).contains(&now);
        let outline = match (is_selected, is_hovered) {
            _ if is_running && !is_selected => Stroke::new(1.5, tokens.now),
            (true, _) => Stroke::new(1.5, tokens.accent),
            (_, true) => Stroke::new(1.0, tokens.text_muted),
            _ => Stroke::new(1.0, tokens.mixed(color, 0.6)),
        };
        painter.rect_stroke(whole, rounding, outline, StrokeKind::Inside);
        if !matches!(bar.kind, BarKind::Ask) {
            self.earliest(painter, bar, row, color);
        }
        self.words(painter, bar, whole);
    }

    /// The earliest schedule, which playing follows.
    fn earliest(&self, painter: &Painter, bar: &Bar, row: Rect, color: Color32) {
        let earliest = self.slot(bar, row, bar.start[0], bar.end[0].max(bar.start[0]));
        let y = earliest.bottom() + 2.0;
        painter.hline(earliest.x_range(), y, Stroke::new(2.0, color));
        for x in [earliest.left(), earliest.right()] {
            painter.vline(x, y - 2.0..=y + 2.0, Stroke::new(1.0, color));
        }
    }

    /// What a bar requires and asserts, or which condition it is, where there is room.
    fn words(&self, painter: &Painter, bar: &Bar, whole: Rect) {
        let tokens = self.context.tokens;
        let visible = whole.intersect(self.visible);
        if visible.width() < 44.0 || bar.kind == BarKind::Composite {
            return;
        }
        let font = FontId::proportional(size::SMALL - 1.0);
        let mut x = visible.left() + 6.0;
        let own = bar.label.map(|_| {
            if bar.kind == BarKind::Ask {
                (format!("needs {}", bar.name), tokens.ask)
            } else {
                (bar.name.to_string(), tokens.tell)
            }
        });
        let labels = bar.labels.iter().filter_map(|label| self.network.labels.get(label.index()));
        let labels = labels.map(|label| match label.mode {
            rmpl::program::LabelMode::Ask => (format!("needs {}", label.text), tokens.ask),
            rmpl::program::LabelMode::Tell => (format!("sets {}", label.text), tokens.tell),
        });
        for (text, color) in own.into_iter().chain(labels) {
            let galley = painter.layout_no_wrap(text, font.clone(), color);
            let width = galley.size().x;
            if x + width + 8.0 > visible.right() {
                return;
            }
            let at = pos2(x, whole.center().y - galley.size().y / 2.0);
            let back = Rect::from_min_size(at, galley.size()).expand2(vec2(4.0, -0.5));
            painter.rect_filled(back, 3.0, tokens.surface);
            painter.galley(at, galley, color);
            x += width + 14.0;
        }
    }

    /// The colour of a kind of bar.
    pub(super) fn color(&self, kind: BarKind) -> Color32 {
        let tokens = self.context.tokens;
        match kind {
            BarKind::Composite => tokens.text_muted,
            BarKind::Activity => tokens.slack,
            BarKind::Tell => tokens.tell,
            BarKind::Ask => tokens.ask,
            BarKind::Delay => tokens.text_faint,
        }
    }

    /// The present moment.
    pub(super) fn now(&self, ui: &Ui) {
        let x = self.x(self.context.state.playback.time);
        self.on_track(ui).vline(x, self.visible.y_range(), Stroke::new(1.5, self.context.tokens.now));
    }
}

/// Where the sign is that opens and closes a row.
pub(super) fn arrow_rect(shown: &Row, row: Rect) -> Rect {
    let left = row.left() + space::S + shown.depth as f32 * INDENT;
    Rect::from_min_size(pos2(left, row.top()), vec2(14.0, row.height()))
}

/// A text on one line, shortened to `width`.
pub(super) fn elided(painter: &Painter, text: &str, font: FontId, color: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, color);
    job.wrap.max_width = width.max(12.0);
    job.wrap.max_rows = 1;
    job.wrap.break_anywhere = true;
    painter.layout_job(job)
}

/// A note at a place of the track, kept inside it.
pub(super) fn note(painter: &Painter, context: &Context<'_>, at: Pos2, text: &str, color: Color32) {
    let galley =
        painter.layout_no_wrap(text.to_owned(), FontId::proportional(size::SMALL), context.tokens.text);
    let clip = painter.clip_rect();
    let size = galley.size() + vec2(12.0, 6.0);
    let left = at.x.min(clip.right() - size.x - 2.0).max(clip.left() + 2.0);
    let top = at.y.min(clip.bottom() - size.y - 2.0).max(clip.top() + 2.0);
    let rect = Rect::from_min_size(pos2(left, top), size);
    painter.rect(rect, 4.0, context.tokens.raised, Stroke::new(1.0, color), StrokeKind::Inside);
    painter.galley(rect.min + vec2(6.0, 3.0), galley, color);
}
