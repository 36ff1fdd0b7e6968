//! A plan over time: the chart that the timeline shows, with the earliest schedule written beside it, in sheets of rows
//! under an axis each.

use std::collections::BTreeSet;
use std::ops::Range;

use display::{Rect, Theme};
use layout::list::timeline::{
    LinkCurve, ROW_HEIGHT, Standing, TOP_MARGIN, TimelineState, Track, axis_list, timeline_list,
};
use layout::timeline::before::Before;
use layout::timeline::rule::{RuleBand, RuleStanding, RuleTrack};
use layout::timeline::{Bar, Chart, ChartOptions, Grouping, RowKind};
use review::compare::Side;
use review::record::Subject;
use review::{Review, Stretch};
use rmpl::program::TimeUnit;
use smol_str::{SmolStr, format_smolstr};
use snapshot::Snapshot;
use tpn::{Network, Plan};

use super::sheet::{Figure, HEIGHT, Medium, WIDTH};

/// Lengths in units of the drawing.
const NAMES_WIDTH: f64 = 190.0;
const TIMES_WIDTH: f64 = 132.0;
const AXIS_HEIGHT: f64 = 24.0;
/// Rows of a sheet: as many as fit.
const SHEET_ROWS: usize = ((HEIGHT - AXIS_HEIGHT - TOP_MARGIN) / ROW_HEIGHT) as usize;
/// Sheets that are printed: of more, the first and the last, where flight rules and resources are.
const MAX_SHEETS: [usize; 2] = [4, 2];

/// What the report's timeline shows: everything, by activity.
pub(super) const OPTIONS: ChartOptions = ChartOptions {
    conditions: true,
    states: true,
    resources: true,
    delays: false,
    grouping: Grouping::Structure,
};

/// The timeline of the snapshot's plan; nothing without one.
pub(crate) fn timeline(snapshot: &Snapshot, review: &Review) -> Vec<Figure> {
    let (Some(network), Some(plan)) = (snapshot.network.as_deref(), snapshot.plan()) else {
        return Vec::new();
    };
    let mut chart = Chart::new(&snapshot.program, (network, plan), &[], OPTIONS, &BTreeSet::new());
    chart.add_rules(rule_tracks(review), &BTreeSet::new());
    let caption = "Bars: the earliest schedule. Lines below a bar: from the earliest to the latest start and end. Hatched: an \
                   uncontrolled duration. Flight rules: a thin line where the rule applies, a filled part where the plan \
                   breaks it.";
    sheets(snapshot, &chart, (network, plan), ("Timeline of the plan", caption))
}

/// The timeline of the snapshot's plan with that of an approved one laid over it; nothing without one of them.
pub(crate) fn timeline_since(snapshot: &Snapshot, approved: &Subject) -> Vec<Figure> {
    let (Some(network), Some(plan), Some(before)) =
        (snapshot.network.as_deref(), snapshot.plan(), windows_before(approved))
    else {
        return Vec::new();
    };
    let options = ChartOptions { states: false, resources: false, ..OPTIONS };
    let mut chart = Chart::new(&snapshot.program, (network, plan), &[], options, &BTreeSet::new());
    chart.compare_with(&before, network, plan);
    let caption = "Dashed: times in the approved plan. “new”: not in the approved plan. Only dashed: no longer in the plan.";
    sheets(snapshot, &chart, (network, plan), ("Timeline of the plan over the approved one", caption))
}

/// When the events of an approved plan could be; `None` where it was not kept.
pub fn windows_before(approved: &Subject) -> Option<Before> {
    let side = Side::of_json("approved", &approved.plan).ok()?;
    let times = side.items.iter().map(|(name, item)| {
        (name.as_str().into(), item.windows.map(|it| [it.earliest.to_f64(), it.latest.to_f64()]))
    });
    Some(Before::new(times))
}

/// The rows of a chart in sheets, of which the first has the caption.
fn sheets(
    snapshot: &Snapshot,
    chart: &Chart,
    plan: (&Network, &Plan),
    (title, caption): (&str, &str),
) -> Vec<Figure> {
    let sheets = ranges(chart);
    let [first, last] = MAX_SHEETS;
    let is_printed =
        |sheet: usize| sheets.len() <= first + last || sheet < first || sheet >= sheets.len() - last;
    let figure = |(sheet, rows): (usize, &Range<usize>)| Figure {
        drawing: drawn(snapshot, chart, plan, rows.clone(), title),
        caption: if sheets.len() > 1 {
            format!("Rows {} to {} of {}.", rows.start + 1, rows.end, chart.rows.len())
        } else {
            String::new()
        },
        medium: if is_printed(sheet) { Medium::Everywhere } else { Medium::Screen },
    };
    let mut figures: Vec<Figure> = sheets.iter().enumerate().map(figure).collect();
    let left_out = sheets.iter().enumerate().filter(|&(sheet, _)| !is_printed(sheet));
    let left_out: usize = left_out.map(|(_, rows)| rows.len()).sum();
    let Some(Figure { caption: words, .. }) = figures.first_mut() else { return figures };
    if left_out > 0 {
        words.push_str(&format!(" {left_out} rows are not printed. Open this file on a screen to see them."));
    }
    words.insert_str(0, &format!("{caption} "));
    figures
}

/// The rows of each sheet: none is cut within the profile of a resource, or below a heading.
fn ranges(chart: &Chart) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut start = 0;
    while start < chart.rows.len() {
        let full = (start + SHEET_ROWS).min(chart.rows.len());
        let is_cut = |row: usize| {
            let kind = |row: usize| chart.rows.get(row).map(|row| row.kind);
            let is_in_profile = matches!(kind(row), Some(RowKind::Profile(part)) if part.part > 0);
            is_in_profile || kind(row - 1) == Some(RowKind::Heading)
        };
        let end = (start + 1..=full).rev().find(|&row| !is_cut(row)).unwrap_or(full);
        ranges.push(start..end);
        start = end;
    }
    ranges
}

/// Some rows of a chart under an axis.
fn drawn(
    snapshot: &Snapshot,
    chart: &Chart,
    (network, plan): (&Network, &Plan),
    range: Range<usize>,
    title: &str,
) -> String {
    let height = AXIS_HEIGHT + TOP_MARGIN + ROW_HEIGHT * range.len() as f64 + 6.0;
    let (left, right) = (NAMES_WIDTH, WIDTH - TIMES_WIDTH);
    let track = Track {
        frame: Rect::new(0.0, 0.0, WIDTH, height),
        left,
        right,
        top: AXIS_HEIGHT - ROW_HEIGHT * range.start as f64,
        start: 0.0,
        scale: (right - left) / chart.horizon,
        visible: Rect::new(left, AXIS_HEIGHT, right, height),
    };
    let unit = match snapshot.program.options.time_unit {
        TimeUnit::Minute => "min",
        TimeUnit::Second => "s",
    };
    let axis = axis_list(&track, Rect::new(left, 0.0, right, AXIS_HEIGHT), unit, None);
    let earliest = |index: usize| -> SmolStr {
        let row = &chart.rows[index];
        let bar = chart.bars.get(row.bars.clone()).and_then(<[Bar]>::first);
        let Some(bar) = bar.filter(|_| row.kind == RowKind::Single) else { return SmolStr::default() };
        let times = bar.events.map(|event| {
            let window = plan.windows.get(event.index()).copied().flatten();
            window.map_or_else(String::new, |window| window.earliest.readable())
        });
        format_smolstr!("{}–{}", times[0], times[1])
    };
    // Of the links those that begin or end on this sheet.
    let is_here =
        |curve: &LinkCurve<'_>| [curve.link.from, curve.link.to].iter().any(|(row, _)| range.contains(row));
    let links: Vec<_> = track.links(chart).into_iter().filter(is_here).map(|curve| (curve, false)).collect();
    let state = TimelineState {
        now: None,
        is_executing: false,
        range: None,
        row: &|_| Standing::default(),
        bar: &|_| Standing::default(),
        links: &links,
        note: Some(&earliest),
    };
    let rows = timeline_list(chart, (network, plan), &track, range, &state);
    display::svg(&[&axis, &rows], Theme::Light, title)
}

/// The rules of the mission that a review has held its plan against, as the timeline draws them.
pub fn rule_tracks(review: &Review) -> Vec<RuleTrack> {
    let lines = review.rules.rules.iter().zip(&review.mission_rules);
    let track = |(rule, line): (&review::MissionRule, &review::Line)| {
        let finding = review.findings.iter().find(|it| it.rule == rule.rule)?;
        let bands = |stretches: &[Stretch], standing: RuleStanding| {
            let band = |it: &Stretch| RuleBand { times: [it.from.to_f64(), it.to.to_f64()], standing };
            stretches.iter().map(band).collect::<Vec<_>>()
        };
        let bands = [
            bands(&finding.applies, RuleStanding::Applies),
            bands(&finding.open, RuleStanding::Open),
            bands(&finding.breaks, RuleStanding::Broken),
        ];
        let name = rule.name.trim();
        let words =
            line.text.strip_prefix(name).map_or(line.text.as_str(), |rest| rest.trim_start_matches(": "));
        Some(RuleTrack { name: name.into(), words: words.to_owned(), bands: bands.concat() })
    };
    lines.filter_map(track).collect()
}
