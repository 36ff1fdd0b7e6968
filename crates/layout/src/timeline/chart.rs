//! The timeline as data: its rows, the links between their bars, and what is laid over them. Prepared once for a plan and
//! its grouping; when only windows change, [`Chart::retime`] is enough. Nothing is drawn here.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::program::Program;
use smol_str::SmolStr;
use tpn::{CausalLink, LabelId, Network, OccurrenceId, Ordering, Plan, UseOrdering};

use super::before::{BarChange, Gone, Origin};
use super::category::{Category, categories};
use super::profile::{Profile, profiles};
use super::row::{Bar, BarKind, Item, Row};
use super::rule::RuleTrack;
use super::{ChartOptions, lane, rule};

/// Rows of bars, and the links between them.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// From top to bottom.
    pub rows: Vec<Row>,
    /// In the order of rows.
    pub bars: Vec<Bar>,
    /// Causal links and orderings between bars.
    pub links: Vec<Link>,
    /// The profiles of resources, each with rows of its own.
    pub profiles: Vec<Profile>,
    /// The flight rules, each with a row.
    pub rules: Vec<RuleTrack>,
    /// What another plan is that is laid over it.
    pub origin: Origin,
    /// What differs from that plan, by the number of the bar.
    pub changes: BTreeMap<usize, BarChange>,
    /// What only the other plan has, each with a row.
    pub gone: Vec<Gone>,
    /// What the colors of bars mean.
    pub legend: Vec<Category>,
    /// The last time that is certain to matter: every finite bound of every bar.
    pub horizon: f64,
    /// When the last bar ends as it is scheduled, with pinned events or without.
    pub end: f64,
}

/// An activity that had started when the plan followed was replaced by one that does not have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Past {
    pub occurrence: OccurrenceId,
    /// When it started and ended, in mission units.
    pub times: [f64; 2],
    /// Whether it was ended early.
    pub is_aborted: bool,
}

/// A line between two bars.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// What it represents.
    pub kind: LinkKind,
    /// The row and the bar that it comes from.
    pub from: (usize, usize),
    /// The row and the bar that it leads to.
    pub to: (usize, usize),
}

/// What a line between bars represents.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkKind {
    /// An assertion carries a requirement.
    Causal(CausalLink),
    /// One interval was put before another.
    Ordering(Ordering),
    /// One use of a resource was put before another.
    UseOrdering(UseOrdering),
}

impl Chart {
    /// The chart of a plan, with the rows below those of these keys closed. `past` is what a run has left behind.
    /// Near-linear in network and plan.
    pub fn new(
        program: &Program,
        (network, plan): (&Network, &Plan),
        past: &[Past],
        options: ChartOptions,
        closed: &BTreeSet<SmolStr>,
    ) -> Self {
        let mut chart = Self::default();
        let mut hidden_from: Option<(u32, usize)> = None;
        let mut gathered: Vec<Vec<Bar>> = Vec::new();
        if options.resources {
            chart.profiles = profiles(network, plan);
        }
        let mut items = lane::items(program, (network, plan), past, options, &chart.profiles);
        chart.legend = categories(program, network, &mut items);
        let mut lanes = 0;
        for item in items {
            if let Some((_, row)) = hidden_from.filter(|&(depth, _)| item.depth > depth) {
                let is_gathered =
                    |bar: &Bar| !matches!(bar.kind, BarKind::Composite | BarKind::Value | BarKind::Need);
                gathered[row].extend(item.bars.into_iter().filter(is_gathered));
                continue;
            }
            let is_closed = item.key.as_ref().is_some_and(|key| closed.contains(key));
            hidden_from = is_closed.then_some((item.depth, chart.rows.len()));
            let Item { kind, name, key, depth, bars } = item;
            lanes += usize::from(depth == 0);
            chart.rows.push(Row { kind, name, depth, key, is_closed, lane: lanes, bars: 0..0 });
            gathered.push(bars);
        }
        for (row, mut bars) in chart.rows.iter_mut().zip(gathered) {
            bars.sort_by(|left, right| left.start[0].total_cmp(&right.start[0]));
            let first = chart.bars.len();
            chart.bars.append(&mut bars);
            row.bars = first..chart.bars.len();
        }
        chart.horizon = horizon(&chart.bars);
        chart.end = end(&chart.bars);
        chart.links = chart.links_of(network, plan);
        chart
    }

    /// Adds flight rules below everything else.
    pub fn add_rules(&mut self, rules: Vec<RuleTrack>, closed: &BTreeSet<SmolStr>) {
        for item in rule::items(&rules) {
            let Item { kind, name, key, depth, .. } = item;
            let is_closed = key.as_ref().is_some_and(|key| closed.contains(key));
            let end = self.bars.len();
            let lane = self.next_lane(depth);
            self.rows.push(Row { kind, name, depth, key, is_closed, lane, bars: end..end });
            if is_closed {
                break;
            }
        }
        self.rules = rules;
    }

    /// Remembers the windows of `plan`, which selects the same and has no pinned events.
    pub fn compare_with_free(&mut self, plan: &Plan) {
        for bar in &mut self.bars {
            if let Some(free) = bar.times_in(plan) {
                bar.free = free;
            }
        }
        self.horizon = self.horizon.max(horizon(&self.bars));
        self.end = self.end.max(end(&self.bars));
    }

    /// Puts all windows to those of `plan`, which selects the same, and leaves rows as they are; in time linear in the bars.
    pub fn retime(&mut self, plan: &Plan) {
        for bar in &mut self.bars {
            if let Some([start, end]) = bar.times_in(plan) {
                (bar.start, bar.end) = (start, end);
            }
        }
        for profile in &mut self.profiles {
            profile.retime(plan);
        }
    }

    /// The lane of a row that is added below all others.
    pub(super) fn next_lane(&self, depth: u32) -> usize {
        self.rows.last().map_or(0, |row| row.lane) + usize::from(depth == 0)
    }

    fn links_of(&self, network: &Network, plan: &Plan) -> Vec<Link> {
        // Where the bar of a condition is, and, failing that, the bar of its owner. A change has two: while it
        // continues, and with what has come of it, which carries requirements.
        let mut of_label = vec![None; network.labels.len()];
        let mut of_change = vec![None; network.labels.len()];
        let mut of_owner = vec![None; network.occurrences.len()];
        for (row, shown) in self.rows.iter().enumerate() {
            for at in shown.bars.clone() {
                match (self.bars[at].label, self.bars[at].occurrence) {
                    (Some(label), _) if self.bars[at].kind == BarKind::Changing => {
                        of_change[label.index()] = Some((row, at));
                    }
                    (Some(label), _) => of_label[label.index()] = Some((row, at)),
                    (None, Some(owner)) if of_owner[owner.index()].is_none() => {
                        of_owner[owner.index()] = Some((row, at));
                    }
                    _ => {}
                }
            }
        }
        let place_of_owner = |label: LabelId| {
            let owner = network.labels.get(label.index())?.owner?;
            of_owner.get(owner.index()).copied().flatten()
        };
        let on_track = |label: LabelId| of_label.get(label.index()).copied().flatten();
        let from_track = |label: LabelId| on_track(label).or_else(|| place_of_owner(label));
        let to_owner = |label: LabelId| place_of_owner(label).or_else(|| on_track(label));
        let causal = plan.causal_links.iter().filter_map(|&link| {
            let (from, to) = (from_track(link.tell)?, to_owner(link.ask)?);
            Some(Link { kind: LinkKind::Causal(link), from, to })
        });
        let interval =
            |label: LabelId| of_change.get(label.index()).copied().flatten().or_else(|| from_track(label));
        let orderings = plan.orderings_added.iter().filter_map(|&ordering| {
            let (from, to) = (interval(ordering.first)?, interval(ordering.then)?);
            Some(Link { kind: LinkKind::Ordering(ordering), from, to })
        });
        let place_of_use = |used: tpn::UseId| {
            let owner = network.uses.get(used.index())?.owner?;
            of_owner.get(owner.index()).copied().flatten()
        };
        let uses = plan.uses_ordered.iter().filter_map(|&ordering| {
            let (from, to) = (place_of_use(ordering.first)?, place_of_use(ordering.then)?);
            Some(Link { kind: LinkKind::UseOrdering(ordering), from, to })
        });
        causal.chain(orderings).chain(uses).filter(|link| link.from != link.to).collect()
    }
}

fn horizon(bars: &[Bar]) -> f64 {
    bars.iter()
        .filter(|bar| bar.kind != BarKind::Value)
        .flat_map(|bar| {
            [bar.start[1], bar.end[0], bar.end[1], bar.free[0][1], bar.free[1][0], bar.free[1][1]]
        })
        .filter(|time| time.is_finite())
        .fold(1.0, f64::max)
}

fn end(bars: &[Bar]) -> f64 {
    let ends = bars.iter().flat_map(|bar| [bar.scheduled()[1], bar.free[1][0]]);
    ends.filter(|time| time.is_finite()).fold(1.0, f64::max)
}
