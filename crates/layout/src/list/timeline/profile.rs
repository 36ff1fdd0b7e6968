//! The profile of a resource: what is used or left in the earliest schedule as an area under a line of steps, what is
//! possible as lines that it must not cross, how far it goes in any schedule as dashed lines with their numbers, and what
//! activities ask of a level as bars for as long as they ask it.

use display::{
    Anchor, ColorRole, Dash, Fit, Group, PathEnd, Piece, Point, Rect, Stroke, Text, Weight, text_width_at,
};
use exact::Rational;
use smol_str::{SmolStr, format_smolstr};
use tpn::{Levels, Supply};

use super::{Builder, SIGN, SIZES, Track};
use crate::timeline::ProfilePart;
use crate::timeline::profile::Profile;

/// From the edges of the rows to the plot, above and below, where the number of the lowest line stands.
const MARGINS: (f64, f64) = (9.0, 14.0);
/// The height of a line's number.
const NUMBER_HEIGHT: f64 = 12.0;
/// How wide a condition is drawn that is asked at one moment.
const MOMENT_WIDTH: f64 = 5.0;
/// Between the numbers of lines that are close together.
const NUMBER_GAP: f64 = 14.0;

impl Track {
    /// Returns where the plot of a profile of `rows` rows is, one of whose rows has this number.
    pub fn plot(&self, row: usize, part: ProfilePart, rows: usize) -> Rect {
        let first = row.saturating_sub(part.part);
        let (top, bottom) = (self.row(first).min.y, self.row(first + rows - 1).max.y);
        let margins = if rows == 1 { (3.0, 2.0) } else { MARGINS };
        Rect::new(self.left, top + margins.0, self.right, bottom - margins.1)
    }
}

impl Builder<'_> {
    /// What is written left of a profile: its name, and its numbers below.
    pub(super) fn profile_name(&mut self, part: ProfilePart, row: Rect, left: f64) {
        let Some(profile) = self.chart.profiles.get(part.profile) else { return };
        let [first, second] = profile.summary();
        let (words, size, role) = match part.part {
            0 => (profile.name.clone(), SIZES[0], ColorRole::Slack),
            1 => (first, SIZES[1], ColorRole::Text),
            _ => (second, SIZES[1], ColorRole::TextMuted),
        };
        let place = Rect::new(left, row.min.y, self.track.left - SIGN.1, row.max.y);
        let text = Text::new(words, size, place).anchored(Anchor::Start, Fit::Cut);
        let weight = if part.part == 0 { Weight::Strong } else { Weight::Regular };
        self.list.write(Text { weight, ..text.colored(role) });
    }

    /// The plot of a profile, one of whose rows has this number.
    pub(super) fn plot(&mut self, row: usize, part: ProfilePart, on_track: Group) {
        let Some(profile) = self.chart.profiles.get(part.profile) else { return };
        let rows = if self.chart.rows[row].is_closed { 1 } else { profile.num_rows() };
        let plot = Plot::new(profile, self.track.plot(row, part, rows));
        self.list.begin(on_track);
        self.area(profile, &plot);
        // In one row, what is used of all there is shows itself.
        if rows > 1 {
            self.lines(profile, &plot);
        }
    }

    /// The steps, filled down to what is nothing.
    fn area(&mut self, profile: &Profile, plot: &Plot) {
        let seen = self.track.visible;
        let ends = [self.track.time(seen.min.x), self.track.time(seen.max.x)];
        let first = profile.steps.partition_point(|step| step.time <= ends[0]);
        let steps = profile.steps[first..].iter().take_while(|step| step.time < ends[1]);
        let begin = [(ends[0].max(0.0), profile.level_at(ends[0].max(0.0)))];
        let steps: Vec<(f64, Rational)> = begin
            .into_iter()
            .chain(steps.map(|step| (step.time, step.level)).filter(|it| it.0 > 0.0))
            .collect();
        let next = steps.iter().skip(1).map(|step| step.0).chain([ends[1]]);
        let mut corners: Vec<Point> = Vec::new();
        let base = plot.y(plot.range[0]);
        for (&(from, level), to) in steps.iter().zip(next) {
            let (left, right, y) = (self.track.x(from), self.track.x(to), plot.y(level));
            corners.extend([Point::new(left, y), Point::new(right, y)]);
            let under = Rect::new(left, y, right, base);
            if under.height() > 0.0 {
                self.list.rectangle(under, 0.0, Some(ColorRole::Slack.mixed(0.22).into()), None);
                self.list.entitle(format!("{}: {}", profile.name, profile.words(from).join("; ")));
            }
        }
        if let [first, rest @ ..] = corners.as_slice() {
            let pieces: Vec<Piece> = rest.iter().map(|&corner| Piece::Line(corner)).collect();
            self.list.path(*first, &pieces, PathEnd::Open, Stroke::solid(ColorRole::Slack, 1.8));
        }
    }

    /// What is possible, and how far the plan goes in any schedule.
    fn lines(&mut self, profile: &Profile, plot: &Plot) {
        let limits = match profile.supply {
            Supply::Reusable { capacity } => vec![(capacity, "capacity")],
            Supply::Reservoir { least, greatest, .. } => vec![(greatest, "maximum"), (least, "minimum")],
        };
        let reached = match profile.levels {
            Some(Levels::Peak(peak)) => vec![(peak, "peak")],
            Some(Levels::Range { low, high }) => vec![(high, "high"), (low, "low")],
            None => Vec::new(),
        };
        let mut numbers = Vec::new();
        for &(level, word) in &limits {
            let is_reached = reached.iter().any(|it| it.0 == level);
            let reached = if is_reached { ", reached" } else { "" };
            let words = format_smolstr!("{word} {}{reached}", level.readable());
            self.level(plot, level, Stroke::solid(ColorRole::Threat, 1.0), words, &mut numbers);
        }
        // Where the plan uses all there is, both lines are one, and the limit's name says what it is.
        let is_apart =
            |level: Rational| limits.iter().all(|limit| (plot.y(limit.0) - plot.y(level)).abs() >= 1.0);
        for &(level, word) in reached.iter().filter(|it| is_apart(it.0)) {
            let stroke = Stroke::solid(ColorRole::Accent, 1.2).dashed(Dash::Dashed);
            let words = format_smolstr!("{word} {}", level.readable());
            self.level(plot, level, stroke, words, &mut numbers);
        }
        for (taker, condition) in profile.conditions() {
            let (left, right) = (self.track.x(taker.span[0]), self.track.x(taker.span[1]));
            let y = plot.y(condition.bound);
            let bar = Rect::new(left, y - 1.5, right.max(left + MOMENT_WIDTH), y + 1.5);
            self.list.rectangle(bar, 0.0, Some(ColorRole::Threat.into()), None);
            self.list.entitle(taker.words());
        }
    }

    /// A line across, with its number near the right end, left of the `numbers` of other lines that are too close.
    fn level(
        &mut self,
        plot: &Plot,
        level: Rational,
        stroke: Stroke,
        words: SmolStr,
        numbers: &mut Vec<Rect>,
    ) {
        let seen = self.track.visible;
        let (left, right) = (plot.rect.min.x.max(seen.min.x), plot.rect.max.x.min(seen.max.x));
        let y = plot.y(level);
        self.list.line(Point::new(left, y), Point::new(right, y), stroke);
        // Numbers stand on their lines; those of lines at the top and at the bottom hang from them.
        let hangs = y - NUMBER_HEIGHT < plot.rect.min.y || y >= plot.rect.max.y - 1.0;
        let top = if hangs { y + 1.0 } else { y - NUMBER_HEIGHT - 1.0 };
        let width = (text_width_at(&words, SIZES[1], self.measure) * 1.06).ceil();
        let at = |right: f64| Rect::new(right - width, top, right, top + NUMBER_HEIGHT);
        let mut place = at(right - 4.0);
        while let Some(other) = numbers.iter().find(|other| other.overlaps(place.expanded(1.0))) {
            place = at(other.min.x - NUMBER_GAP);
        }
        if place.min.x > left {
            numbers.push(place);
            let text = Text::new(words, SIZES[1], place).anchored(Anchor::End, Fit::Overflow);
            let plate = Some(ColorRole::Surface.faint(0.75));
            self.texts.push(Text { plate, ..text.colored(stroke.color.role) });
        }
    }
}

/// Where levels lie.
struct Plot {
    rect: Rect,
    range: [Rational; 2],
    low: f64,
    scale: f64,
}

impl Plot {
    fn new(profile: &Profile, rect: Rect) -> Self {
        let range = profile.range();
        let [low, high] = range.map(Rational::to_f64);
        let scale = if high > low { rect.height() / (high - low) } else { 0.0 };
        Self { rect, range, low, scale }
    }

    fn y(&self, level: Rational) -> f64 {
        self.rect.max.y - (level.to_f64() - self.low) * self.scale
    }
}
