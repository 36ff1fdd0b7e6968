//! A plan over time as a display list: an axis, rows with their names, bars with what is certain of them, and links.
//!
//! Bars are solid where they go on for certain and hatched where they may, with the earliest schedule under them. What
//! variables keep and how far resources are used is drawn for the earliest schedule alone. The frame is that of whoever shows the chart: a [`Track`] says where times and rows lie in it.

mod before;
mod profile;
mod rule;
mod state;

use std::ops::Range;

use display::{
    Anchor, Color, ColorRole, Dash, DisplayList, Fill, Fit, Group, Measure, PathEnd, Piece, Point, Rect,
    Stroke, TargetKind, Text, Weight, approximate_text_width, text_width_at,
};
use rmpl::program::LabelMode;
use smol_str::{SmolStr, format_smolstr};
use tpn::{Extent, Network, Plan};

use crate::timeline::{Bar, BarKind, Chart, Link, LinkKind, Row, RowKind, Ticks};

/// The height of a bar's row.
pub const ROW_HEIGHT: f64 = 24.0;
/// From the top of the track to its first row.
pub const TOP_MARGIN: f64 = 3.0;
/// Indentation of a row per level.
const INDENT: f64 = 12.0;
/// The sign that opens and closes a row is so wide, after such a margin.
const SIGN: (f64, f64) = (14.0, 4.0);
/// A bar narrower than this is only a stroke.
const MIN_WIDTH: f64 = 3.0;
/// Sizes of names, and of the numbers on the axis and of what is written in bars.
const SIZES: [f64; 2] = [13.0, 11.0];
/// Between words in a bar, and how much wider than measured they may be.
const WORDS_GAP: f64 = 16.0;
/// See [`WORDS_GAP`].
const WORDS_SPARE: f64 = 1.06;
/// The width of a number of words that are left out.
const MORE_WIDTH: f64 = 18.0;
/// A bar with less room than this has nothing written in it.
const MIN_ROOM: f64 = 44.0;
/// From the lower edge of a row to the upper and the lower edge of what needs a value.
const NEED_EDGES: [f64; 2] = [5.0, 2.0];
/// With more links in view than this, they are drawn thin and faint, but for those that are chosen.
const MAX_LINKS: u32 = 60;
/// With more than this, only those that are chosen are drawn.
const MAX_FAINT_LINKS: usize = 1500;
/// Beyond the ends of the track by this much, a place is not told from others.
const FAR: f64 = 1e5;

/// Where times and rows lie in the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// The frame of the drawing; names begin at its left edge, notes lie right of time.
    pub frame: Rect,
    /// The left and right edges of time.
    pub left: f64,
    /// See [`Track::left`].
    pub right: f64,
    /// The upper edge of the rows.
    pub top: f64,
    /// The time at the left edge, in mission units.
    pub start: f64,
    /// Drawing units per mission unit.
    pub scale: f64,
    /// The part of the track that is seen.
    pub visible: Rect,
}

/// What stands out in a row or a bar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Standing {
    pub is_selected: bool,
    /// It is pointed at.
    pub is_hovered: bool,
}

/// How things stand with a timeline.
#[derive(Clone, Copy)]
pub struct TimelineState<'a> {
    /// The time that is shown, if one is.
    pub now: Option<f64>,
    /// Whether a run is shown, so that what goes on is marked.
    pub is_executing: bool,
    /// The range of times that is selected.
    pub range: Option<[f64; 2]>,
    /// What stands out of the rows.
    pub row: &'a dyn Fn(usize) -> Standing,
    /// What stands out of the bars.
    pub bar: &'a dyn Fn(usize) -> Standing,
    /// The links in view, and whether each is chosen.
    pub links: &'a [(LinkCurve<'a>, bool)],
    /// What is written right of each row, if anything is.
    pub note: Option<&'a dyn Fn(usize) -> SmolStr>,
}

/// A link as a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkCurve<'a> {
    pub link: &'a Link,
    /// Where the curve begins.
    pub start: Point,
    pub piece: Piece,
}

impl Track {
    /// Where a time is; infinity is beyond the right edge.
    pub fn x(&self, time: f64) -> f64 {
        if !time.is_finite() {
            return self.right + 8.0;
        }
        (self.left + (time - self.start) * self.scale).clamp(self.left - FAR, self.right + FAR)
    }

    /// The time at a place.
    pub fn time(&self, x: f64) -> f64 {
        self.start + (x - self.left) / self.scale
    }

    /// The row of this number, name included.
    pub fn row(&self, index: usize) -> Rect {
        let top = self.top + TOP_MARGIN + index as f64 * ROW_HEIGHT;
        Rect::new(self.frame.min.x, top, self.right, top + ROW_HEIGHT)
    }

    /// The rectangle of a bar: from its earliest start to its latest end, or on the track of a variable that keeps its
    /// value to its earliest one.
    pub fn bar(&self, bar: &Bar, row: Rect) -> Rect {
        match bar.kind {
            BarKind::Need => {
                let (from, to) = (self.x(bar.start[0]), self.x(bar.end[0]));
                let [top, bottom] = NEED_EDGES.map(|edge| row.max.y - edge);
                Rect::new(from, top, to.max(from + MIN_WIDTH), bottom)
            }
            BarKind::Value | BarKind::Changing => {
                self.slot(bar, row, bar.start[0], bar.end[0].max(bar.start[0]))
            }
            _ => self.slot(bar, row, bar.start[0], bar.end[1]),
        }
    }

    /// Where the sign is that opens and closes a row.
    pub fn sign(&self, shown: &Row, row: Rect) -> Rect {
        let left = row.min.x + SIGN.1 + f64::from(shown.depth) * INDENT;
        Rect::new(left, row.min.y, left + SIGN.0, row.max.y)
    }

    fn slot(&self, bar: &Bar, row: Rect, from: f64, to: f64) -> Rect {
        let (height, lift) = match bar.kind {
            BarKind::Composite => (6.0, 0.0),
            BarKind::Ask => (8.0, 0.0),
            BarKind::Value | BarKind::Changing => (15.0, 2.5),
            _ => (14.0, 1.0),
        };
        let middle = row.center().y - lift;
        let (from, to) = (self.x(from), self.x(to));
        Rect::new(from, middle - height / 2.0, to.max(from), middle + height / 2.0)
    }

    /// The links of a chart that are in view.
    pub fn links<'c>(&self, chart: &'c Chart) -> Vec<LinkCurve<'c>> {
        let seen = self.visible;
        let first = ((seen.min.y - self.top) / ROW_HEIGHT).floor().max(0.0) as usize;
        let last = ((seen.max.y - self.top) / ROW_HEIGHT).ceil().max(0.0) as usize;
        let in_rows =
            |link: &&Link| link.from.0.max(link.to.0) >= first && link.from.0.min(link.to.0) <= last;
        let curves = chart.links.iter().filter(in_rows).map(|link| self.link(chart, link));
        curves
            .filter(|curve| {
                let bounds = display::geometry::curve_bounds(curve.start, &[curve.piece]);
                bounds.max.x >= seen.min.x && bounds.min.x <= seen.max.x
            })
            .collect()
    }

    /// From the bar that carries or comes first to the other, sideways out and in.
    fn link<'c>(&self, chart: &'c Chart, link: &'c Link) -> LinkCurve<'c> {
        let [from, to] = [link.from, link.to].map(|(row, bar)| (self.row(row).center().y, &chart.bars[bar]));
        let (from, to) = match link.kind {
            LinkKind::Causal(_) => {
                let x = self.x(to.1.start[0]) + 3.0;
                (Point::new(x, from.0), Point::new(x, to.0))
            }
            LinkKind::Ordering(_) | LinkKind::UseOrdering(_) => {
                (Point::new(self.x(from.1.end[0]), from.0), Point::new(self.x(to.1.start[0]), to.0))
            }
        };
        let bow = ((to.y - from.y).abs() * 0.3).clamp(14.0, 46.0);
        let out = if (to.x - from.x).abs() < 40.0 { -bow } else { bow };
        // A curve comes three quarters of the way out: no further than to the left edge, where it would be cut.
        let edge = self.visible.min.x + 1.0;
        let inside = |end: Point, out: f64| end.shifted(out.max((edge - end.x).min(0.0) / 0.75), 0.0);
        let piece = Piece::Cubic(inside(from, out), inside(to, -bow), to);
        LinkCurve { link, start: from, piece }
    }
}

/// The axis with its numbers above a track, in `rect`; `now` has a handle.
pub fn axis_list(track: &Track, rect: Rect, unit: &str, now: Option<f64>) -> DisplayList {
    let mut list = DisplayList::new(track.frame);
    list.begin(Group {
        clip: Some(Rect::new(rect.min.x - 14.0, rect.min.y, rect.max.x + 14.0, rect.max.y)),
        ..Group::default()
    });
    let ticks = Ticks::new(track.time(rect.min.x), track.time(rect.max.x), rect.width() as f32);
    let is_seen = |x: f64| rect.min.x <= x && x <= rect.max.x;
    let mut mark = |x: f64, height: f64, role: ColorRole| {
        let (from, to) = (Point::new(x, rect.max.y - height), Point::new(x, rect.max.y));
        list.line(from, to, Stroke::solid(role, 1.0));
    };
    let before = ticks.marks.first().map(|first| first - ticks.step);
    for &time in before.iter().chain(&ticks.marks) {
        for part in 1..ticks.parts {
            let x = track.x(time + ticks.step * f64::from(part) / f64::from(ticks.parts));
            if is_seen(x) {
                mark(x, 3.0, ColorRole::LineStrong);
            }
        }
        let x = track.x(time);
        if is_seen(x) && time >= -ticks.step * 0.5 {
            mark(x, 6.0, ColorRole::TextFaint);
        }
    }
    for &time in &ticks.marks {
        let x = track.x(time);
        if is_seen(x) {
            let place = Rect::new(x - 40.0, rect.min.y + 2.0, x + 40.0, rect.min.y + 16.0);
            list.write(note(ticks.label(time), place, Anchor::Middle, ColorRole::TextMuted));
        }
    }
    if let Some(x) = now.map(|now| track.x(now)).filter(|&x| is_seen(x)) {
        let corner = |dx: f64, dy: f64| Point::new(x + dx, rect.max.y + dy);
        let corners =
            [corner(-5.0, -9.0), corner(5.0, -9.0), corner(5.0, -5.0), corner(0.0, 0.0), corner(-5.0, -5.0)];
        list.polygon(&corners, Some(ColorRole::Now.into()), None);
    }
    list.begin(Group::default());
    let place = Rect::new(track.frame.min.x, rect.min.y + 2.0, rect.min.x - 10.0, rect.min.y + 16.0);
    list.write(note(unit, place, Anchor::End, ColorRole::TextFaint));
    let line = Stroke::solid(ColorRole::Line, 1.0);
    list.line(Point::new(rect.min.x, rect.max.y), rect.max, line);
    list
}

/// Some rows of a plan's chart. Linear in what is in view.
pub fn timeline_list(
    chart: &Chart,
    (network, plan): (&Network, &Plan),
    track: &Track,
    rows: Range<usize>,
    state: &TimelineState<'_>,
) -> DisplayList {
    let list = DisplayList::new(track.frame);
    let mut builder = Builder { list, chart, network, plan, track, state, measure: &approximate_text_width };
    let on_track = Group { clip: Some(track.visible), ..Group::default() };
    builder.list.begin(on_track);
    builder.grid();
    builder.list.begin(Group::default());
    let (top, bottom) = (track.visible.min.y, track.visible.max.y);
    let edge = [top, bottom].map(|y| Point::new(track.visible.min.x, y));
    builder.list.line(edge[0], edge[1], Stroke::solid(ColorRole::Line, 1.0));
    for index in rows.clone() {
        builder.row(index);
    }
    for index in rows.clone() {
        // A profile is drawn whole with the first of its rows that is in view.
        if let RowKind::Profile(part) = chart.rows[index].kind
            && (part.part == 0 || index == rows.start)
        {
            builder.plot(index, part, on_track);
        }
    }
    builder.list.begin(on_track);
    for index in rows {
        builder.bars(index);
    }
    builder.links(on_track);
    builder.list.begin(on_track);
    if let Some(x) = state.now.map(|now| track.x(now)) {
        let line = Stroke::solid(ColorRole::Now, 1.5);
        builder.list.line(Point::new(x, top), Point::new(x, bottom), line);
    }
    builder.list
}

struct Builder<'a> {
    list: DisplayList,
    chart: &'a Chart,
    network: &'a Network,
    plan: &'a Plan,
    track: &'a Track,
    state: &'a TimelineState<'a>,
    measure: &'a dyn Measure,
}

impl Builder<'_> {
    /// Lines down from the marks of the axis, and the selected range.
    fn grid(&mut self) {
        let seen = self.track.visible;
        let times = [seen.min.x, seen.max.x].map(|x| self.track.time(x));
        for time in Ticks::new(times[0], times[1], seen.width() as f32).marks {
            self.upright(self.track.x(time), ColorRole::Raised.into());
        }
        if let Some(range) = self.state.range {
            let [from, to] = range.map(|time| self.track.x(time));
            let band = Rect::new(from, seen.min.y, to, seen.max.y);
            self.list.rectangle(band, 0.0, Some(ColorRole::Accent.faint(0.10).into()), None);
            for x in [from, to] {
                self.upright(x, ColorRole::Accent.faint(0.7));
            }
        }
    }

    fn upright(&mut self, x: f64, color: Color) {
        let seen = self.track.visible;
        let ends = [seen.min.y, seen.max.y].map(|y| Point::new(x, y));
        self.list.line(ends[0], ends[1], Stroke::solid(color, 1.0));
    }

    /// The ground of a row that is selected, pointed at, or a heading; and its name.
    fn row(&mut self, index: usize) {
        let shown = &self.chart.rows[index];
        let row = self.track.row(index);
        let standing = (self.state.row)(index);
        let fill: Option<Color> = match (standing.is_selected, standing.is_hovered, shown.kind) {
            (true, ..) => Some(ColorRole::AccentSoft.into()),
            (_, true, _) => Some(ColorRole::Raised.into()),
            (.., RowKind::Heading) => Some(ColorRole::Raised.faint(0.6)),
            _ => None,
        };
        if let Some(fill) = fill {
            self.list.rectangle(row, 3.0, Some(fill.into()), None);
        }
        let sign = self.track.sign(shown, row);
        let first = self.chart.bars.get(shown.bars.clone()).and_then(<[Bar]>::first);
        if shown.key.is_none()
            && shown.kind == RowKind::Single
            && let Some(bar) = first
        {
            let center = sign.center();
            let mark = Rect::new(center.x - 3.0, center.y - 5.0, center.x + 3.0, center.y + 5.0);
            self.list.rectangle(mark, 1.0, Some(bar_role(bar.kind).into()), None);
        }
        if let RowKind::Profile(part) = shown.kind {
            self.profile_name(part, row, sign.max.x + 2.0);
            return;
        }
        let role = match (standing.is_selected, shown.kind) {
            (true, _) => ColorRole::Accent,
            (_, RowKind::Track | RowKind::State) => ColorRole::Tell,
            _ => ColorRole::Text,
        };
        let weight = if shown.kind == RowKind::Heading { Weight::Strong } else { Weight::Regular };
        let place = Rect::new(sign.max.x + 2.0, row.min.y, self.track.left - SIGN.1, row.max.y);
        let text = Text::new(shown.name.clone(), SIZES[0], place).anchored(Anchor::Start, Fit::Cut);
        let item = self.list.write(Text { weight, ..text.colored(role) });
        if let Some(occurrence) = first.and_then(|bar| bar.occurrence) {
            item.stands_for(TargetKind::Occurrence, occurrence.0);
        }
        if let Some(words) = self.state.note {
            let place = Rect::new(self.track.right + 8.0, row.min.y, self.track.frame.max.x, row.max.y);
            self.list.write(note(words(index), place, Anchor::Start, ColorRole::TextMuted));
        }
    }

    fn bars(&mut self, index: usize) {
        let row = self.track.row(index);
        match self.chart.rows[index].kind {
            RowKind::Rule(rule) => self.rule(rule, row),
            RowKind::Gone(gone) => self.gone(gone, row),
            _ => {}
        }
        let mut drawn_to = f64::MIN;
        let seen = self.track.visible.expanded(40.0);
        for at in self.chart.rows[index].bars.clone() {
            let bar = &self.chart.bars[at];
            let place = self.track.bar(bar, row);
            // Bars that fall onto the same point are drawn once.
            let is_merged = place.width() < 1.0 && place.max.x < drawn_to + 1.0;
            if bar.kind.is_of_state() && self.chart.rows[index].kind == RowKind::State {
                if place.touches(seen) {
                    self.state_bar(at, bar, row, &self.chart.rows[index].bars);
                }
                continue;
            }
            if (place.touches(seen) || bar.is_narrowed()) && !is_merged {
                drawn_to = drawn_to.max(place.max.x);
                self.bar(at, bar, row);
                self.change(at, place, row);
            }
        }
    }

    fn bar(&mut self, at: usize, bar: &Bar, row: Rect) {
        let role = bar_role(bar.kind);
        let whole = self.track.bar(bar, row);
        let corner = if bar.kind == BarKind::Ask { 4.0 } else { 3.0 };
        if bar.is_narrowed() {
            let ghost = self.track.slot(bar, row, bar.free[0][0], bar.free[1][1]);
            let line = Stroke::solid(role.mixed(0.35), 1.0);
            let fill = Some(role.mixed(0.07).into());
            self.list.rectangle(ghost.expanded(-0.5), corner, fill, Some(line));
        }
        let (kind, id) = match (bar.label, bar.occurrence) {
            (Some(label), _) => (TargetKind::Label, label.0),
            (None, occurrence) => (TargetKind::Occurrence, occurrence.map_or(u32::MAX, |it| it.0)),
        };
        if whole.width() < MIN_WIDTH {
            let middle = whole.center().x;
            let stroke =
                Rect::new(middle - MIN_WIDTH / 2.0, whole.min.y, middle + MIN_WIDTH / 2.0, whole.max.y);
            self.list.rectangle(stroke, 1.0, Some(role.mixed(0.75).into()), None).stands_for(kind, id);
            return;
        }
        self.list.rectangle(whole, corner, Some(role.mixed(0.16).into()), None);
        let hatched = Some(Fill::Hatched(role.mixed(0.5)));
        if let Some([from, to]) = bar.certain() {
            // When it ends nature says.
            let ends = if bar.natures.is_some() { ColorRole::Nature } else { role };
            for (from, to, role) in [(bar.start[0], from, role), (to, bar.end[1], ends)] {
                let slot = self.track.slot(bar, row, from, to);
                if slot.width() > 0.0 {
                    self.list.rectangle(slot, 0.0, Some(Fill::Hatched(role.mixed(0.5))), None);
                }
            }
            let slot = self.track.slot(bar, row, from, to);
            self.list.rectangle(slot, 2.0, Some(role.mixed(0.85).into()), None);
        } else {
            self.list.rectangle(whole, 0.0, hatched, None);
        }
        let (color, width) = self.outline(at, bar, role);
        self.list
            .rectangle(whole.expanded(-width / 2.0), corner, None, Some(Stroke::solid(color, width)))
            .stands_for(kind, id);
        if bar.kind != BarKind::Ask {
            self.earliest(bar, row, role);
        }
        self.words(bar, whole);
    }

    fn outline(&self, at: usize, bar: &Bar, role: ColorRole) -> (Color, f64) {
        let standing = (self.state.bar)(at);
        let last = if bar.kind.is_of_state() { bar.end[0] } else { bar.end[1] };
        // What runs at the time shown: its start has happened, its end has not.
        let is_running = self.state.is_executing
            && !matches!(bar.kind, BarKind::Ask | BarKind::Need)
            && bar.start[0] >= bar.start[1]
            && self.state.now.is_some_and(|now| (bar.start[0]..last).contains(&now));
        match (standing.is_selected, standing.is_hovered) {
            (false, _) if is_running => (ColorRole::Now.into(), 1.5),
            (true, _) => (ColorRole::Accent.into(), 1.5),
            (_, true) => (ColorRole::TextMuted.into(), 1.0),
            _ => (role.mixed(0.6), 1.0),
        }
    }

    /// The earliest schedule, which playing follows, and how much longer nature may take then.
    fn earliest(&mut self, bar: &Bar, row: Rect, role: ColorRole) {
        let earliest = self.track.slot(bar, row, bar.start[0], bar.end[0].max(bar.start[0]));
        let y = earliest.max.y + 2.0;
        let ends = [earliest.min.x, earliest.max.x];
        self.list.line(Point::new(ends[0], y), Point::new(ends[1], y), Stroke::solid(role, 2.0));
        for x in ends {
            self.list.line(Point::new(x, y - 2.0), Point::new(x, y + 2.0), Stroke::solid(role, 1.0));
        }
        if let Some([least, greatest]) = bar.natures {
            let range = self.track.slot(bar, row, bar.start[0] + least, bar.start[0] + greatest);
            let stroke = Stroke::solid(ColorRole::Nature, 2.0);
            self.list.line(
                Point::new(range.min.x, y),
                Point::new(range.max.x, y),
                stroke.dashed(Dash::Dashed),
            );
            for x in [range.min.x, range.max.x] {
                self.list.line(Point::new(x, y - 3.0), Point::new(x, y + 3.0), stroke);
            }
        }
    }

    /// What a bar requires and asserts, or which condition it is, where there is room.
    fn words(&mut self, bar: &Bar, whole: Rect) {
        let seen = self.track.visible;
        let (left, right) = (whole.min.x.max(seen.min.x), whole.max.x.min(seen.max.x));
        if right - left < MIN_ROOM || bar.kind == BarKind::Composite {
            return;
        }
        let own = bar.label.map(|_| match bar.kind {
            BarKind::Ask => (format_smolstr!("requires {}", bar.name), ColorRole::Ask),
            _ => (bar.name.clone(), ColorRole::Tell),
        });
        let labels = bar.labels.iter().filter_map(|label| self.network.labels.get(label.index()));
        let labels = labels.map(|label| match label.mode {
            LabelMode::Ask if label.extent == Extent::Start => {
                (format_smolstr!("requires {} at start", label.text), ColorRole::Ask)
            }
            LabelMode::Ask => (format_smolstr!("requires {}", label.text), ColorRole::Ask),
            LabelMode::Tell => (format_smolstr!("sets {}", label.text), ColorRole::Tell),
        });
        let size = SIZES[1];
        let middle = whole.center().y;
        let width_of = |words: &SmolStr| (text_width_at(words, size, self.measure) * WORDS_SPARE).ceil();
        let words: Vec<_> =
            own.into_iter().chain(labels).map(|(words, role)| (width_of(&words), words, role)).collect();
        let fitting = |from: f64| {
            let ends = words.iter().scan(from, |x, (width, ..)| {
                *x += width + WORDS_GAP;
                Some(*x)
            });
            ends.take_while(|&end| end <= right).count()
        };
        // Behind the earliest end, where the bar is only hatched and no handle is, or from the latest start on, so that
        // the hatching before it is seen; at the beginning where those have room for fewer.
        let places = [bar.end[0], bar.start[1]].map(|time| self.track.x(time).max(left));
        let from = places.into_iter().find(|&from| fitting(from) == fitting(left)).unwrap_or(left);
        let shown = fitting(from);
        let mut x = from + WORDS_GAP / 2.0;
        let mut write = |words: SmolStr, width: f64, role: ColorRole| {
            let place = Rect::new(x, middle - size / 2.0, x + width, middle + size / 2.0);
            let text = Text::new(words, size, place).anchored(Anchor::Start, Fit::Overflow);
            self.list.write(Text { plate: Some(ColorRole::Surface.into()), ..text.colored(role) });
            x += width + WORDS_GAP;
            x
        };
        let rest = words.len() - shown;
        let mut end = from;
        for (width, words, role) in words.into_iter().take(shown) {
            end = write(words, width, role);
        }
        if shown > 0 && rest > 0 && end + MORE_WIDTH <= right {
            write(format_smolstr!("+{rest}"), MORE_WIDTH, ColorRole::TextMuted);
        }
    }

    fn links(&mut self, on_track: Group) {
        let is_drawn = self.state.links.len() <= MAX_FAINT_LINKS;
        for is_chosen in [false, true] {
            let crowd = (!is_chosen).then_some(MAX_LINKS);
            self.list.begin(Group { crowd, ..on_track });
            let of_these = self.state.links.iter().filter(|(_, chosen)| *chosen == is_chosen);
            for (curve, _) in of_these.filter(|_| is_drawn || is_chosen) {
                let (role, dash) = match curve.link.kind {
                    LinkKind::Causal(_) => (ColorRole::Link, Dash::Dashed),
                    LinkKind::Ordering(_) | LinkKind::UseOrdering(_) => (ColorRole::Ordering, Dash::Dotted),
                };
                let stroke = Stroke::solid(role, if is_chosen { 2.5 } else { 1.4 }).dashed(dash);
                self.list.path(curve.start, &[curve.piece], PathEnd::Head, stroke);
            }
        }
    }
}

/// The colour of a kind of bar.
pub const fn bar_role(kind: BarKind) -> ColorRole {
    match kind {
        BarKind::Composite => ColorRole::TextMuted,
        BarKind::Activity => ColorRole::Slack,
        BarKind::Tell | BarKind::Value | BarKind::Changing => ColorRole::Tell,
        BarKind::Ask | BarKind::Need => ColorRole::Ask,
        BarKind::Delay => ColorRole::TextFaint,
    }
}

fn note(text: impl Into<SmolStr>, place: Rect, anchor: Anchor, role: ColorRole) -> Text {
    Text::new(text, SIZES[1], place).anchored(anchor, Fit::Overflow).colored(role)
}

/// A row in which two plans are compared: the windows of start and end in each, in mission units, latest times perhaps
/// infinite.
#[derive(Clone, Debug, PartialEq)]
pub struct PairRow {
    pub name: SmolStr,
    /// Whether the plans differ in it.
    pub is_different: bool,
    /// In the first plan: earliest and latest start, earliest and latest end.
    pub before: Option<[[f64; 2]; 2]>,
    /// In the second.
    pub after: Option<[[f64; 2]; 2]>,
}

/// The height of a row of a comparison, and of a bar in it.
pub const PAIR_HEIGHTS: (f64, f64) = (28.0, 9.0);

/// Two plans over one time axis: the first as outlines with lines across, the second as filled bars below, so that no
/// colour is needed to tell them apart. Rows begin at the top of the track; names after `indent`.
pub fn pair_list(rows: &[PairRow], track: &Track, indent: f64) -> DisplayList {
    let (row_height, bar_height) = PAIR_HEIGHTS;
    let bottom = track.top + rows.len() as f64 * row_height;
    let mut list = DisplayList::new(track.frame);
    list.begin(Group::default());
    let times = [track.left, track.right].map(|x| track.time(x));
    let ticks = Ticks::new(times[0], times[1], (track.right - track.left) as f32);
    for &time in ticks.marks.iter().filter(|&&time| time >= 0.0) {
        let x = track.x(time);
        list.line(Point::new(x, track.top), Point::new(x, bottom), Stroke::solid(ColorRole::Line, 1.0));
        let place = Rect::new(x - 40.0, track.top - 18.0, x + 40.0, track.top - 4.0);
        list.write(note(ticks.label(time), place, Anchor::Middle, ColorRole::TextMuted));
    }
    for (index, row) in rows.iter().enumerate() {
        let top = track.top + index as f64 * row_height;
        let place = Rect::new(track.frame.min.x + indent, top, track.left - SIGN.1, top + row_height);
        let role = if row.is_different { ColorRole::Text } else { ColorRole::TextMuted };
        let text = Text::new(row.name.clone(), SIZES[0], place).anchored(Anchor::Start, Fit::Cut);
        list.write(text.colored(role));
    }
    list.begin(Group { clip: Some(track.visible), ..Group::default() });
    for (index, row) in rows.iter().enumerate() {
        let middle = track.top + (index as f64 + 0.5) * row_height;
        for (windows, side, is_after) in [(row.before, -1.0, false), (row.after, 1.0, true)] {
            let Some([start, end]) = windows else { continue };
            let y = middle + side * (bar_height / 2.0 + 1.0);
            let slot = |from: f64, to: f64| {
                let from = track.x(from);
                let to = track.x(to).max(from + 2.0);
                Rect::new(from, y - bar_height / 2.0, to, y + bar_height / 2.0)
            };
            let certain = (start[1] < end[0]).then(|| slot(start[1], end[0]));
            pair_bar(&mut list, slot(start[0], end[1]), certain, is_after);
        }
    }
    list
}

/// A bar of a comparison: pale where it may go on, strong where it goes on for certain.
pub fn pair_bar(list: &mut DisplayList, whole: Rect, certain: Option<Rect>, is_after: bool) {
    if is_after {
        list.rectangle(whole, 2.0, Some(ColorRole::Slack.mixed(0.35).into()), None);
        if let Some(certain) = certain {
            list.rectangle(certain, 2.0, Some(ColorRole::Slack.into()), None);
        }
        return;
    }
    if let Some(certain) = certain {
        list.rectangle(certain, 0.0, Some(Fill::Hatched(ColorRole::TextMuted.into())), None);
    }
    let line = Stroke::solid(ColorRole::TextMuted, 1.0);
    list.rectangle(whole.expanded(-0.5), 2.0, None, Some(line));
}
