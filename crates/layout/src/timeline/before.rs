//! Another plan of the same mission, the one that was approved or that a run began with, laid over a chart: where its bars
//! were, which are new, and which are gone.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;
use tpn::{Network, Occurrence, OccurrenceKind, Plan};

use super::chart::Chart;
use super::row::{Bar, BarKind, Row, RowKind, scheduled, times};

/// When things could start and end in another plan, by the names of their occurrences.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Before {
    origin: Origin,
    times: BTreeMap<SmolStr, [[f64; 2]; 2]>,
}

/// What another plan is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Origin {
    /// It was approved in a review: its windows count.
    #[default]
    Approved,
    /// A run began with it: what was scheduled counts, against what happened and is scheduled now.
    Planned,
}

impl Origin {
    /// Returns what its times are called.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Approved => "approved",
            Self::Planned => "planned",
        }
    }
}

/// What differs of a bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BarChange {
    /// The other plan has nothing of this name.
    New,
    /// When it could start and end there.
    Moved([[f64; 2]; 2]),
}

/// An activity that only the other plan has.
#[derive(Clone, Debug, PartialEq)]
pub struct Gone {
    pub name: SmolStr,
    /// When it could start and end.
    pub times: [[f64; 2]; 2],
}

/// Scheduled times that differ by less than this are equal: times of runs are rounded.
const MIN_MOVE: f64 = 1e-6;

/// Rows of what is gone, at most.
const MAX_GONE: usize = 100;

impl Before {
    /// The approved plan, in which each of these could start and end so.
    pub fn new(times: impl IntoIterator<Item = (SmolStr, [[f64; 2]; 2])>) -> Self {
        Self { origin: Origin::Approved, times: times.into_iter().collect() }
    }

    /// The plan that a run began with: its activities as they were scheduled.
    pub fn planned(network: &Network, plan: &Plan) -> Self {
        let activities = network.occurrences.iter().filter(|it| it.kind == OccurrenceKind::Primitive);
        let is_selected = |it: &&Occurrence| plan.selected_nodes.get(it.start.index()) == Some(&true);
        let planned = activities.filter(is_selected).filter_map(|it| {
            let [start, end] = scheduled(times(plan, [it.start, it.end])?);
            Some((it.name.clone(), [[start; 2], [end; 2]]))
        });
        Self { origin: Origin::Planned, times: planned.collect() }
    }

    /// Returns whether a bar is where it was, or is of a kind that is not compared.
    fn is_same(&self, bar: &Bar, [start, end]: [[f64; 2]; 2]) -> bool {
        match self.origin {
            Origin::Approved => [start, end] == [bar.start, bar.end],
            Origin::Planned => {
                let [from, to] = bar.scheduled();
                (from - start[0]).abs() < MIN_MOVE && (to - end[0]).abs() < MIN_MOVE
            }
        }
    }

    fn compares(&self, bar: &Bar, network: &Network) -> bool {
        let is_activity = bar.kind == BarKind::Activity;
        bar.is_complete(network) && !bar.kind.is_past() && (self.origin == Origin::Approved || is_activity)
    }

    /// When something could start and end, if the plan had it.
    pub fn times_of(&self, name: &str) -> Option<[[f64; 2]; 2]> {
        self.times.get(name).copied()
    }

    /// Returns what `plan` does not have, in order of time; delays are left out.
    pub fn gone(&self, network: &Network, plan: &Plan) -> Vec<Gone> {
        let is_selected = |it: &&Occurrence| plan.selected_nodes.get(it.start.index()) == Some(&true);
        let present: BTreeSet<&str> =
            network.occurrences.iter().filter(is_selected).map(|it| it.name.as_str()).collect();
        let gone = self.times.iter().filter(|(name, _)| !present.contains(name.as_str()));
        let gone = gone.filter(|(name, _)| !name.starts_with("delay#"));
        let gone = gone.map(|(name, &times)| Gone { name: name.clone(), times });
        let mut gone: Vec<Gone> = gone.take(MAX_GONE).collect();
        gone.sort_by(|left, right| left.times[0][0].total_cmp(&right.times[0][0]));
        gone
    }
}

impl Chart {
    /// Lays another plan over the chart of `plan`.
    pub fn compare_with(&mut self, before: &Before, network: &Network, plan: &Plan) {
        if before.times.is_empty() {
            return;
        }
        self.origin = before.origin;
        for (at, bar) in self.bars.iter().enumerate().filter(|(_, bar)| before.compares(bar, network)) {
            let Some(occurrence) = bar.occurrence.and_then(|id| network.occurrences.get(id.index())) else {
                continue;
            };
            match before.times.get(&occurrence.name).copied() {
                None => {
                    self.changes.insert(at, BarChange::New);
                }
                Some(times) if !before.is_same(bar, times) => {
                    self.changes.insert(at, BarChange::Moved(times));
                }
                Some(_) => {}
            }
        }
        self.gone = before.gone(network, plan);
        // What was executed of it has a bar.
        let of_bar = |bar: &Bar| Some(network.occurrences.get(bar.occurrence?.index())?.name.clone());
        let past: BTreeSet<SmolStr> =
            self.bars.iter().filter(|bar| bar.kind.is_past()).filter_map(of_bar).collect();
        self.gone.retain(|gone| !past.contains(&gone.name));
        let end = self.bars.len();
        let lane = self.next_lane(0);
        let row = |kind, name: SmolStr, depth| Row {
            kind,
            name,
            depth,
            key: None,
            is_closed: false,
            lane,
            bars: end..end,
        };
        if !self.gone.is_empty() {
            self.rows.push(row(RowKind::Heading, SmolStr::new_static("Removed from the plan"), 0));
        }
        let rows =
            self.gone.iter().enumerate().map(|(at, gone)| row(RowKind::Gone(at), gone.name.clone(), 1));
        self.rows.extend(rows);
        let ends = self.gone.iter().flat_map(|gone| gone.times.concat());
        let moved = self.changes.values().filter_map(|it| match it {
            BarChange::Moved(times) => Some(times.concat()),
            BarChange::New => None,
        });
        let scheduled = self.gone.iter().map(|gone| gone.times[1][0]);
        self.end = scheduled.filter(|time| time.is_finite()).fold(self.end, f64::max);
        let all = ends.chain(moved.flatten());
        self.horizon = all.filter(|time| time.is_finite()).fold(self.horizon, f64::max);
    }
}
