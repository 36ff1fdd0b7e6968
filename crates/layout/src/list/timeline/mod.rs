//! A plan over time as a display list: an axis, rows with their names, bars with what is certain of them, and links.
//!
//! A bar is the activity as it is scheduled now; lines below it say when else it can start and end. What variables keep and
//! how far resources are used is drawn for the same schedule. The caller decides on the frame: a [`Track`] says
//! where times and rows lie in it.

mod before;
mod label;
mod legend;
mod profile;
mod rule;
mod state;

use std::ops::Range;

use display::{
    Anchor, Color, ColorRole, Dash, DisplayList, Fill, Fit, Group, Measure, PathEnd, Piece, Point, Rect,
    Stroke, TargetKind, Text, Weight, approximate_text_width,
};
use smol_str::SmolStr;
use tpn::{Network, Plan};

use crate::timeline::{Bar, BarKind, Chart, Link, LinkKind, Row, RowKind, Ticks};

pub use self::legend::{LEGEND_HEIGHT, legend_list};

/// The height of a bar's row.
pub const ROW_HEIGHT: f64 = 22.0;
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
/// From the upper edge of a row to the upper and the lower edge of a bar.
const BAR_EDGES: [f64; 2] = [2.0, 16.0];
/// From the upper edge of a row to the lines that say when a bar can start and end.
const WHISKERS: [f64; 2] = [18.0, 20.5];
/// In a row with more bars than this, what may vary is drawn only of those that stand out.
const MAX_WHISKERS: usize = 60;
/// How strong the color of a bar's body is.
const BODY: f32 = 0.42;
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
    /// Whether a run is shown, so that what continues is marked.
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
    /// Returns where a time is; infinity is beyond the right edge.
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

    /// The rectangle of a bar, as it is scheduled now.
    pub fn bar(&self, bar: &Bar, row: Rect) -> Rect {
        let [from, to] = bar.scheduled();
        if bar.kind == BarKind::Need {
            let (from, to) = (self.x(from), self.x(to));
            let [top, bottom] = NEED_EDGES.map(|edge| row.max.y - edge);
            return Rect::new(from, top, to.max(from + MIN_WIDTH), bottom);
        }
        self.slot(row, from, to)
    }

    /// Returns where the sign is that opens and closes a row.
    pub fn sign(&self, shown: &Row, row: Rect) -> Rect {
        let left = row.min.x + SIGN.1 + f64::from(shown.depth) * INDENT;
        Rect::new(left, row.min.y, left + SIGN.0, row.min.y + BAR_EDGES.iter().sum::<f64>())
    }

    /// The place of a bar between two times.
    fn slot(&self, row: Rect, from: f64, to: f64) -> Rect {
        let (from, to) = (self.x(from), self.x(to));
        let [top, bottom] = BAR_EDGES.map(|edge| row.min.y + edge);
        Rect::new(from, top, to.max(from), bottom)
    }

    /// The lines below a bar that say when it can start and when it can end, of those that have a length.
    fn whiskers(&self, bar: &Bar, row: Rect) -> [Option<[Point; 2]>; 2] {
        let line = |[from, to]: [f64; 2], edge: f64| {
            let [from, to] = [from, to].map(|time| Point::new(self.x(time), row.min.y + edge));
            (to.x - from.x >= 1.0).then_some([from, to])
        };
        [line(bar.start, WHISKERS[0]), line(bar.end, WHISKERS[1])]
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
        let middle = |row: usize| self.row(row).min.y + BAR_EDGES.iter().sum::<f64>() / 2.0;
        let [from, to] = [link.from, link.to].map(|(row, bar)| (middle(row), &chart.bars[bar]));
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
    let measure = &approximate_text_width;
    let mut builder = Builder { list, chart, network, plan, track, state, measure, texts: Vec::new() };
    let on_track = Group { clip: Some(track.visible), ..Group::default() };
    builder.list.begin(Group::default());
    for index in rows.clone() {
        builder.ground(index);
    }
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
    for index in rows.clone() {
        builder.below_bars(index);
    }
    for index in rows.clone() {
        builder.bars(index);
    }
    builder.links(on_track);
    builder.list.begin(on_track);
    for index in rows {
        builder.chosen_whiskers(index);
    }
    if let Some(x) = state.now.map(|now| track.x(now)) {
        let line = Stroke::solid(ColorRole::Now, 1.5);
        builder.list.line(Point::new(x, top), Point::new(x, bottom), line);
    }
    // Nothing covers what is to be read.
    for text in std::mem::take(&mut builder.texts) {
        builder.list.write(text);
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
    /// What is written on the track, over everything else.
    texts: Vec<Text>,
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

    /// The ground of a row, which differs from lane to lane, and the line above a lane.
    fn ground(&mut self, index: usize) {
        let shown = &self.chart.rows[index];
        let row = self.track.row(index);
        if shown.lane.is_multiple_of(2) && shown.kind != RowKind::Single {
            self.list.rectangle(row, 0.0, Some(ColorRole::Sunken.faint(0.55).into()), None);
        }
        if shown.depth == 0 && index > 0 && shown.kind != RowKind::Single {
            let ends = [row.min, Point::new(row.max.x, row.min.y)];
            self.list.line(ends[0], ends[1], Stroke::solid(ColorRole::Line, 1.0));
        }
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
    }

    /// The name of a row, and what is noted beside it.
    fn row(&mut self, index: usize) {
        let shown = &self.chart.rows[index];
        let row = self.track.row(index);
        let standing = (self.state.row)(index);
        let sign = self.track.sign(shown, row);
        let first = self.chart.bars.get(shown.bars.clone()).and_then(<[Bar]>::first);
        if shown.key.is_none()
            && shown.kind == RowKind::Single
            && let Some(bar) = first
        {
            let center = sign.center();
            let mark = Rect::new(center.x - 3.0, center.y - 5.0, center.x + 3.0, center.y + 5.0);
            self.list.rectangle(mark, 1.0, Some(bar_role(bar).into()), None);
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
        let is_strong = matches!(shown.kind, RowKind::Heading | RowKind::Packed);
        let weight = if is_strong { Weight::Strong } else { Weight::Regular };
        let bottom = row.min.y + BAR_EDGES.iter().sum::<f64>();
        let place = Rect::new(sign.max.x + 2.0, row.min.y, self.track.left - SIGN.1, bottom);
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

    /// The bars of a row that are drawn, with their places: those that fall onto the same point are drawn once.
    fn drawn_bars(&self, index: usize) -> Vec<(usize, Rect)> {
        let row = self.track.row(index);
        let shown = &self.chart.rows[index];
        let seen = self.track.visible.expanded(40.0);
        let mut drawn_to = f64::MIN;
        let places = shown.bars.clone().filter_map(|at| {
            let bar = &self.chart.bars[at];
            let place = self.track.bar(bar, row);
            let is_merged = !bar.kind.is_of_state() && place.width() < 1.0 && place.max.x < drawn_to + 1.0;
            // Whatever may vary of it lies before its latest end.
            let last = self.track.x(bar.end[1].max(bar.free[1][1])).max(place.max.x);
            let first = self.track.x(bar.free[0][0]).min(place.min.x);
            let reach = Rect::new(first, row.min.y, last, row.max.y);
            if is_merged || !reach.touches(seen) {
                return None;
            }
            drawn_to = drawn_to.max(place.max.x);
            Some((at, place))
        });
        places.collect()
    }

    /// What lies below the bars of a row: what may vary, and where bars were in another plan or without pins.
    fn below_bars(&mut self, index: usize) {
        let row = self.track.row(index);
        if self.chart.rows[index].is_closed && self.chart.rows[index].kind != RowKind::Single {
            return;
        }
        let is_alone = self.chart.rows[index].kind == RowKind::Single;
        let drawn = self.drawn_bars(index);
        let is_crowded = drawn.len() > MAX_WHISKERS;
        for (at, place) in drawn {
            let bar = &self.chart.bars[at];
            if bar.kind.is_of_state() {
                continue;
            }
            self.change(at, place, row, is_alone);
            let role = bar_role(bar);
            if bar.is_narrowed() {
                let free = self.track.slot(row, bar.free[0][0], bar.free[1][0].max(bar.free[0][0]));
                let line = Stroke::solid(role.mixed(0.6), 1.0).dashed(Dash::Dashed);
                self.list.rectangle(free.expanded(-0.5), 3.0, None, Some(line));
            }
            if let Some([_, maximum]) = bar.contingent() {
                let [_, until] = bar.scheduled();
                let part = self.track.slot(row, until, maximum);
                self.list.rectangle(part, 0.0, Some(ColorRole::Nature.mixed(0.10).into()), None);
                self.list.rectangle(part, 0.0, Some(Fill::Hatched(ColorRole::Nature.mixed(0.55))), None);
            }
            for ends in self.track.whiskers(bar, row).into_iter().flatten().filter(|_| !is_crowded) {
                whisker(&mut self.list, ends, Stroke::solid(role.mixed(0.4), 1.0));
            }
        }
    }

    /// What may vary of the bars of a row that are selected or pointed at.
    fn chosen_whiskers(&mut self, index: usize) {
        let row = self.track.row(index);
        for (at, _) in self.drawn_bars(index) {
            let bar = &self.chart.bars[at];
            let standing = (self.state.bar)(at);
            if bar.kind.is_of_state() || !(standing.is_selected || standing.is_hovered) {
                continue;
            }
            let [start, end] = self.track.whiskers(bar, row);
            let ends = if bar.contingent().is_some() { ColorRole::Nature } else { ColorRole::Accent };
            for (ends, role) in [(start, ColorRole::Accent), (end, ends)] {
                if let Some(ends) = ends {
                    whisker(&mut self.list, ends, Stroke::solid(role, 2.0));
                }
            }
        }
    }

    fn bars(&mut self, index: usize) {
        let row = self.track.row(index);
        let shown = &self.chart.rows[index];
        match shown.kind {
            RowKind::Rule(rule) => self.rule(rule, row),
            RowKind::Gone(gone) => self.gone(gone, row),
            _ => {}
        }
        let drawn = self.drawn_bars(index);
        // Names lie between bars that are apart: not where the bars of many rows are gathered, nor beside their own row's.
        let is_named = !shown.is_closed && matches!(shown.kind, RowKind::Packed | RowKind::Track);
        for (number, &(at, place)) in drawn.iter().enumerate() {
            let bar = &self.chart.bars[at];
            if bar.kind.is_of_state() && shown.kind == RowKind::State {
                self.state_bar(at, bar, row, &shown.bars);
                continue;
            }
            let body = self.bar(at, bar, place);
            if is_named {
                let next = drawn.get(number + 1).map_or(f64::INFINITY, |next| next.1.min.x);
                self.name(at, bar, body, next);
            }
        }
    }

    /// The body of a bar, and where it is.
    fn bar(&mut self, at: usize, bar: &Bar, place: Rect) -> Rect {
        let role = bar_role(bar);
        let (kind, id) = match (bar.label, bar.occurrence) {
            (Some(label), _) => (TargetKind::Label, label.0),
            (None, occurrence) => (TargetKind::Occurrence, occurrence.map_or(u32::MAX, |it| it.0)),
        };
        let (color, width) = self.outline(at, bar, role);
        let body = if place.width() < MIN_WIDTH {
            let middle = place.center().x;
            Rect::new(middle - MIN_WIDTH / 2.0, place.min.y, middle + MIN_WIDTH / 2.0, place.max.y)
        } else {
            place
        };
        if place.width() < MIN_WIDTH {
            self.list.rectangle(body, 1.0, Some(color.into()), None).stands_for(kind, id);
        } else {
            let fill: Option<Fill> = match bar.kind {
                BarKind::Ask => None,
                BarKind::Composite | BarKind::Delay => Some(role.mixed(0.14).into()),
                _ => Some(role.mixed(BODY).into()),
            };
            let line = Some(Stroke::solid(color, width));
            if bar.kind == BarKind::Aborted {
                self.list.rectangle(body, 0.0, Some(ColorRole::Surface.into()), None);
                self.list.rectangle(body, 0.0, Some(Fill::Hatched(role.mixed(0.5))), None);
            } else if fill.is_some() {
                self.list.rectangle(body, 3.0, fill, None);
            }
            self.list.rectangle(body.expanded(-width / 2.0), 3.0, None, line).stands_for(kind, id);
        }
        let identifier = bar.occurrence.filter(|_| bar.label.is_none());
        if let Some(occurrence) = identifier.and_then(|it| self.network.occurrences.get(it.index())) {
            self.list.entitle(self.network.readable(&occurrence.name));
        }
        body
    }

    fn outline(&self, at: usize, bar: &Bar, role: ColorRole) -> (Color, f64) {
        let standing = (self.state.bar)(at);
        // What runs at the time shown: its start has happened, its end has not.
        let last = if bar.kind.is_of_state() { bar.end[0] } else { bar.end[1] };
        let is_running = self.state.is_executing
            && !matches!(bar.kind, BarKind::Ask | BarKind::Need)
            && !bar.kind.is_past()
            && bar.start[0] >= bar.start[1]
            && self.state.now.is_some_and(|now| (bar.start[0]..last).contains(&now));
        match (standing.is_selected, standing.is_hovered) {
            (false, _) if is_running => (ColorRole::Now.into(), 1.5),
            (true, _) => (ColorRole::Accent.into(), 2.0),
            (_, true) => (ColorRole::Text.into(), 1.2),
            _ if bar.kind == BarKind::Composite => (role.mixed(0.5), 1.0),
            _ => (role.mixed(0.85), 1.0),
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

/// The color of a bar: of its site or value, or of what it is.
fn bar_role(bar: &Bar) -> ColorRole {
    match bar.kind {
        BarKind::Aborted => ColorRole::Error,
        BarKind::Need => ColorRole::Ask,
        _ if bar.category.is_some() => category_role(bar.category.unwrap_or_default()),
        BarKind::Composite => ColorRole::TextMuted,
        BarKind::Activity | BarKind::Past => ColorRole::Slack,
        BarKind::Tell | BarKind::Value | BarKind::Changing => ColorRole::Tell,
        BarKind::Ask => ColorRole::Ask,
        BarKind::Delay => ColorRole::TextFaint,
    }
}

/// The color of the site or value of this number in the legend.
fn category_role(category: usize) -> ColorRole {
    // The first is that of activities without a site.
    ColorRole::Series((1 + category % 7) as u8)
}

/// A line with a mark at each end.
fn whisker(list: &mut DisplayList, [from, to]: [Point; 2], stroke: Stroke) {
    list.line(from, to, stroke);
    for end in [from, to] {
        list.line(end.shifted(0.0, -2.0), end.shifted(0.0, 2.0), stroke);
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
/// color is needed to tell them apart. Rows begin at the top of the track; names after `indent`.
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

/// A bar of a comparison: pale where it may continue, strong where it continues for certain.
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
