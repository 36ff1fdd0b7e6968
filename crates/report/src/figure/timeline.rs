//! A plan over time: the chart that the timeline shows, with the earliest schedule written beside it.

use std::collections::BTreeSet;

use display::{Rect, Theme};
use layout::list::timeline::{
    ROW_HEIGHT, Standing, TOP_MARGIN, TimelineState, Track, axis_list, timeline_list,
};
use layout::timeline::before::Before;
use layout::timeline::rule::{RuleBand, RuleStanding, RuleTrack};
use layout::timeline::{Bar, Chart, ChartOptions, Grouping, RowKind};
use mission::Snapshot;
use mission::compare::Side;
use mission::review::record::Subject;
use mission::review::{Review, Stretch};
use rmpl::program::TimeUnit;
use smol_str::{SmolStr, format_smolstr};
use tpn::{Network, Plan};

/// Lengths in user units of the drawing; on paper one is about a point.
const WIDTH: f64 = 940.0;
const NAMES_WIDTH: f64 = 230.0;
const TIMES_WIDTH: f64 = 110.0;
const AXIS_HEIGHT: f64 = 24.0;

/// What the report's timeline shows: everything, by activity.
pub(super) const OPTIONS: ChartOptions = ChartOptions {
    conditions: true,
    states: true,
    resources: true,
    delays: false,
    grouping: Grouping::Structure,
};

/// The timeline of the snapshot's plan; `None` without one.
pub(crate) fn timeline(snapshot: &Snapshot, review: &Review) -> Option<String> {
    let (network, plan) = (snapshot.network.as_deref()?, snapshot.plan()?);
    let mut chart = Chart::new(&snapshot.program, network, plan, OPTIONS, &BTreeSet::new());
    chart.add_rules(rule_tracks(review), &BTreeSet::new());
    Some(drawn(snapshot, &chart, (network, plan), "Timeline of the plan"))
}

/// The timeline of the snapshot's plan with that of an approved one laid over it; `None` without one of them.
pub(crate) fn timeline_since(snapshot: &Snapshot, approved: &Subject) -> Option<String> {
    let (network, plan) = (snapshot.network.as_deref()?, snapshot.plan()?);
    let before = windows_before(approved)?;
    let options = ChartOptions { states: false, resources: false, ..OPTIONS };
    let mut chart = Chart::new(&snapshot.program, network, plan, options, &BTreeSet::new());
    chart.compare_with(&before, network, plan);
    Some(drawn(snapshot, &chart, (network, plan), "Timeline of the plan over the approved one"))
}

/// When the events of an approved plan could be; `None` where it was not kept.
pub fn windows_before(approved: &Subject) -> Option<Before> {
    let side = Side::of_json("approved", &approved.plan).ok()?;
    let times = side.items.iter().map(|(name, item)| {
        (name.as_str().into(), item.windows.map(|it| [it.earliest.to_f64(), it.latest.to_f64()]))
    });
    Some(Before::new(times))
}

fn drawn(snapshot: &Snapshot, chart: &Chart, (network, plan): (&Network, &Plan), title: &str) -> String {
    let height = AXIS_HEIGHT + TOP_MARGIN + ROW_HEIGHT * chart.rows.len() as f64 + 6.0;
    let (left, right) = (NAMES_WIDTH, WIDTH - TIMES_WIDTH);
    let track = Track {
        frame: Rect::new(0.0, 0.0, WIDTH, height),
        left,
        right,
        top: AXIS_HEIGHT,
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
    let links: Vec<_> = track.links(chart).into_iter().map(|curve| (curve, false)).collect();
    let state = TimelineState {
        now: None,
        is_executing: false,
        range: None,
        row: &|_| Standing::default(),
        bar: &|_| Standing::default(),
        links: &links,
        note: Some(&earliest),
    };
    let rows = timeline_list(chart, (network, plan), &track, 0..chart.rows.len(), &state);
    display::svg(&[&axis, &rows], Theme::Light, title)
}

/// The rules of the mission that a review has held its plan against, as the timeline draws them.
pub fn rule_tracks(review: &Review) -> Vec<RuleTrack> {
    let lines = review.rules.rules.iter().zip(&review.mission_rules);
    let track = |(rule, line): (&mission::review::MissionRule, &mission::review::Line)| {
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
