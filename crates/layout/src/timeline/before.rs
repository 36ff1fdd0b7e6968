//! Another plan of the same mission, such as the one that was approved, laid over a chart: where its bars were, which are
//! new, and which are gone.

use std::collections::{BTreeMap, BTreeSet};

use smol_str::SmolStr;
use tpn::{Network, Plan};

use super::chart::Chart;
use super::row::{Row, RowKind};

/// When things could start and end in another plan, by the names of their occurrences.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Before {
    times: BTreeMap<SmolStr, [[f64; 2]; 2]>,
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

/// Rows of what is gone, at most.
const MAX_GONE: usize = 100;

impl Before {
    /// The plan in which each of these could start and end so.
    pub fn new(times: impl IntoIterator<Item = (SmolStr, [[f64; 2]; 2])>) -> Self {
        Self { times: times.into_iter().collect() }
    }
}

impl Before {
    /// When something could start and end, if the plan had it.
    pub fn times_of(&self, name: &str) -> Option<[[f64; 2]; 2]> {
        self.times.get(name).copied()
    }

    /// What `plan` does not have, in order of time; delays are left out.
    pub fn gone(&self, network: &Network, plan: &Plan) -> Vec<Gone> {
        let is_selected = |it: &&tpn::Occurrence| plan.selected_nodes.get(it.start.index()) == Some(&true);
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
        for (at, bar) in
            self.bars.iter().enumerate().filter(|(_, bar)| bar.is_whole(network) && !bar.kind.is_past())
        {
            let Some(occurrence) = bar.occurrence.and_then(|id| network.occurrences.get(id.index())) else {
                continue;
            };
            match before.times.get(&occurrence.name).copied() {
                None => {
                    self.changes.insert(at, BarChange::New);
                }
                Some(times) if times != [bar.start, bar.end] => {
                    self.changes.insert(at, BarChange::Moved(times));
                }
                Some(_) => {}
            }
        }
        self.gone = before.gone(network, plan);
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
