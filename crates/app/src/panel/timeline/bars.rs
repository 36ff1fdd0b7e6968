//! The timeline as data: which bars there are, in which order, and when they can be. Nothing is drawn here.

use rmpl::program::LabelMode;
use tpn::{LabelId, Network, NodeId, OccurrenceId, OccurrenceKind, Plan, Window};

use crate::state::playback::{bound, number};
use crate::state::settings::TimelineView;

/// An activity, condition or delay over time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Bar {
    /// Whose bar it is.
    pub(crate) occurrence: OccurrenceId,
    /// What it is.
    pub(crate) kind: BarKind,
    /// How deep it is nested in activities.
    pub(crate) depth: usize,
    /// Its name on screen.
    pub(crate) name: String,
    /// When it can start, earliest and latest, in mission units.
    pub(crate) start: [f64; 2],
    /// When it can end; the latest may be infinite.
    pub(crate) end: [f64; 2],
    /// What it requires.
    pub(crate) asks: Vec<LabelId>,
    /// What it asserts.
    pub(crate) tells: Vec<LabelId>,
    /// Its windows in words.
    pub(crate) words: String,
}

/// What a bar is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BarKind {
    /// Has others inside.
    Composite,
    /// A primitive activity.
    Activity,
    /// An asserted condition.
    Condition,
    /// A delay.
    Delay,
}

impl Bar {
    /// The part in which it is going on for certain, if there is one.
    pub(crate) fn certain(&self) -> Option<[f64; 2]> {
        (self.start[1] < self.end[0]).then_some([self.start[1], self.end[0]])
    }
}

/// The bars of a plan, activities nested in textual order.
pub(crate) fn bars(network: &Network, plan: &Plan, view: &TimelineView) -> Vec<Bar> {
    let window = |node: NodeId| plan.windows.get(node.index()).copied().flatten();
    let mut bars = Vec::new();
    for (index, occurrence) in network.occurrences.iter().enumerate() {
        let id = OccurrenceId::from_index(index);
        let kind = match occurrence.kind {
            OccurrenceKind::Activity => BarKind::Composite,
            OccurrenceKind::Primitive => BarKind::Activity,
            OccurrenceKind::Assertion if view.conditions => BarKind::Condition,
            OccurrenceKind::Delay if view.delays => BarKind::Delay,
            _ => continue,
        };
        let Some((start, end)) = window(occurrence.start).zip(window(occurrence.end)) else { continue };
        let labels = |mode: LabelMode| {
            network
                .labels
                .iter()
                .enumerate()
                .filter(|(_, label)| label.owner == Some(id) && label.mode == mode)
                .map(|(index, _)| LabelId::from_index(index))
                .collect::<Vec<_>>()
        };
        bars.push(Bar {
            occurrence: id,
            kind,
            depth: depth(network, id),
            name: occurrence.name.to_string(),
            start: [number(start.earliest), bound(start.latest)],
            end: [number(end.earliest), bound(end.latest)],
            asks: labels(LabelMode::Ask),
            tells: labels(LabelMode::Tell),
            words: words(start, end),
        });
    }
    bars
}

/// The last time that is certain to matter: every finite bound of every bar.
pub(crate) fn horizon(bars: &[Bar]) -> f64 {
    bars.iter()
        .flat_map(|bar| [bar.start[1], bar.end[0], bar.end[1]])
        .filter(|time| time.is_finite())
        .fold(1.0, f64::max)
}

fn words(start: Window, end: Window) -> String {
    let interval = |window: Window| crate::time_text::interval(window.earliest, window.latest);
    format!("starts {}, ends {}", interval(start), interval(end))
}

fn depth(network: &Network, id: OccurrenceId) -> usize {
    let parent = |id: OccurrenceId| network.occurrences.get(id.index()).and_then(|it| it.parent);
    std::iter::successors(parent(id), |&above| parent(above))
        .filter(|above| {
            network.occurrences.get(above.index()).is_some_and(|it| it.kind == OccurrenceKind::Activity)
        })
        .take(network.occurrences.len())
        .count()
}

/// Times for the marks of an axis from `from` to `to` with room for about one mark per `points` of `width`, and how
/// many small marks stand between two.
pub(crate) fn ticks(from: f64, to: f64, width: f32, points: f32) -> (Vec<f64>, u32) {
    let count = f64::from((width / points).max(1.0));
    let rough = ((to - from) / count).max(f64::MIN_POSITIVE);
    let magnitude = 10_f64.powf(rough.log10().floor());
    let (step, minor) = [(1.0, 5), (2.0, 4), (5.0, 5), (10.0, 5)]
        .into_iter()
        .map(|(factor, minor)| (factor * magnitude, minor))
        .find(|&(step, _)| step >= rough)
        .unwrap_or((10.0 * magnitude, 5));
    let first = (from / step).ceil() as i64;
    let last = (to / step).floor() as i64;
    ((first..=last.min(first + 1000)).map(|index| index as f64 * step).collect(), minor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_numbers_that_fit() {
        assert_eq!(ticks(0.0, 660.0, 660.0, 90.0).0, vec![0.0, 100.0, 200.0, 300.0, 400.0, 500.0, 600.0]);
        assert_eq!(ticks(12.0, 31.0, 400.0, 80.0).0, vec![15.0, 20.0, 25.0, 30.0]);
        assert_eq!(ticks(0.0, 0.5, 300.0, 60.0).0.len(), 6);
    }
}
