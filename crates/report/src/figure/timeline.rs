//! A plan over time: one row for each activity and condition. The solid bar is the earliest schedule; the pale one
//! behind it is all the time in which it may happen.

use mission::Snapshot;
use mission::review::schedule::{Scheduled, scheduled};
use mission::review::short_time;
use rmpl::{Bound, Rational};
use tpn::{Network, OccurrenceKind};

use super::{number, round_step};
use crate::escape::escaped;

/// Lengths in user units of the drawing; on paper one is about a point.
const WIDTH: f64 = 940.0;
const NAMES_WIDTH: f64 = 240.0;
const TIMES_WIDTH: f64 = 110.0;
const ROW_HEIGHT: f64 = 18.0;
const AXIS_HEIGHT: f64 = 26.0;
/// About so many marks along the time axis.
const MARKS: f64 = 8.0;
/// Longer names are cut.
const LONGEST_NAME: usize = 38;

/// Where times lie on the drawing.
struct Axis {
    horizon: f64,
}

impl Axis {
    fn x(&self, time: f64) -> f64 {
        NAMES_WIDTH + time / self.horizon * (WIDTH - NAMES_WIDTH - TIMES_WIDTH)
    }
}

/// The timeline of the snapshot's plan; `None` without one.
pub(crate) fn timeline(snapshot: &Snapshot) -> Option<String> {
    let network = snapshot.network.as_deref()?;
    let plan = snapshot.plan()?;
    let rows: Vec<Scheduled> = scheduled(network, plan)
        .into_iter()
        .filter(|row| network.occurrences[row.occurrence.index()].kind != OccurrenceKind::Delay)
        .collect();
    let axis = Axis { horizon: units(mission::planning::horizon(plan)).max(1e-9) };
    let height = AXIS_HEIGHT + ROW_HEIGHT * rows.len() as f64 + 6.0;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{0}\" viewBox=\"0 0 {WIDTH} {0}\" \
         role=\"img\" font-family=\"Ubuntu, Inter, Arial, sans-serif\" font-size=\"11\">\n\
         <title>Timeline of the plan</title>\n",
        number(height)
    );
    write_marks(&axis, height, &mut out);
    for (index, row) in rows.iter().enumerate() {
        write_row(network, row, &axis, AXIS_HEIGHT + ROW_HEIGHT * index as f64, &mut out);
    }
    out.push_str("</svg>\n");
    Some(out)
}

fn write_marks(axis: &Axis, height: f64, out: &mut String) {
    let step = round_step(axis.horizon, MARKS);
    let count = (axis.horizon / step + 1e-9).floor() as u32;
    for mark in 0..=count {
        let time = f64::from(mark) * step;
        let x = number(axis.x(time));
        out.push_str(&format!(
            "<path d=\"M{x} {}V{}\" stroke=\"#d9dfe6\"/>\
             <text x=\"{x}\" y=\"13\" fill=\"#4e5b6a\" text-anchor=\"middle\">{}</text>\n",
            number(AXIS_HEIGHT - 8.0),
            number(height),
            number(time)
        ));
    }
}

fn write_row(network: &Network, row: &Scheduled, axis: &Axis, top: f64, out: &mut String) {
    let occurrence = &network.occurrences[row.occurrence.index()];
    let color = match occurrence.kind {
        OccurrenceKind::Primitive => "#0068a8",
        OccurrenceKind::Assertion => "#007555",
        _ => "#6a7684",
    };
    let latest = match row.end.latest {
        Bound::Finite(latest) => units(latest),
        Bound::Infinite => axis.horizon,
    };
    let (start, end) = (axis.x(units(row.start.earliest)), axis.x(units(row.end.earliest)));
    let mut bar = |until: f64, height: f64, opacity: &str| {
        out.push_str(&format!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"2\" fill=\"{color}\" opacity=\"{opacity}\"/>",
            number(start),
            number(top + (ROW_HEIGHT - height) / 2.0),
            number((until - start).max(1.5)),
            number(height)
        ));
    };
    bar(axis.x(latest), 12.0, ".22");
    bar(end, 7.0, "1");
    let baseline = number(top + ROW_HEIGHT / 2.0 + 4.0);
    out.push_str(&format!(
        "<text x=\"0\" y=\"{baseline}\" fill=\"#161d26\">{}</text>\
         <text x=\"{WIDTH}\" y=\"{baseline}\" fill=\"#4e5b6a\" text-anchor=\"end\">{}–{}</text>\n",
        escaped(&shortened(&occurrence.name)),
        escaped(&short_time(Bound::Finite(row.start.earliest))),
        escaped(&short_time(Bound::Finite(row.end.earliest))),
    ));
}

fn shortened(name: &str) -> String {
    if name.chars().count() <= LONGEST_NAME {
        return name.to_owned();
    }
    let beginning: String = name.chars().take(LONGEST_NAME - 1).collect();
    format!("{beginning}…")
}

fn units(time: Rational) -> f64 {
    *time.numer() as f64 / *time.denom() as f64
}
