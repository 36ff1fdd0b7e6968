//! The timeline as data: its rows, the bars in them, and when they can be. Prepared once for a plan and its grouping;
//! when only windows change, [`Chart::retime`] is enough. Nothing is drawn here.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use rmpl::program::Program;
use smol_str::SmolStr;
use tpn::{
    ArcId, CausalLink, LabelId, Network, NodeId, OccurrenceId, OccurrenceKind, Ordering, Plan, UseOrdering,
    Window,
};

use super::before::{BarChange, Gone};
use super::profile::{Profile, ProfilePart, profiles};
use super::rule::RuleTrack;
use super::{ChartOptions, group, profile, rule};

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
    /// What differs from another plan, by the number of the bar.
    pub changes: BTreeMap<usize, BarChange>,
    /// What only the other plan has, each with a row.
    pub gone: Vec<Gone>,
    /// The last time that is certain to matter: every finite bound of every bar.
    pub horizon: f64,
}

/// A row of the timeline, with the bars in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub kind: RowKind,
    /// What is written on its left.
    pub name: SmolStr,
    /// How far that is indented.
    pub depth: u32,
    /// Under which name it can be closed, if it has rows below it.
    pub key: Option<SmolStr>,
    /// Whether the rows below it are hidden; their bars are then in this row.
    pub is_closed: bool,
    pub bars: Range<usize>,
}

/// What a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowKind {
    /// The heading of a thread, of a vehicle, or of the conditions.
    Heading,
    /// One activity or delay.
    Single,
    /// The assertions of a variable that is known only there, or what is required of it.
    Track,
    /// The values of a variable that keeps them.
    State,
    /// A part of the profile of a resource.
    Profile(ProfilePart),
    /// The flight rule of this number.
    Rule(usize),
    /// What is gone of another plan, by its number.
    Gone(usize),
}

/// An activity, condition or delay over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    pub kind: BarKind,
    /// Whose bar it is.
    pub occurrence: Option<OccurrenceId>,
    /// The condition that it is, on a track.
    pub label: Option<LabelId>,
    /// Its first and its last event.
    pub events: [NodeId; 2],
    /// Its name: of the occurrence, or of the condition.
    pub name: SmolStr,
    /// When it can start, earliest and latest, in mission units.
    pub start: [f64; 2],
    /// When it can end; the latest may be infinite.
    pub end: [f64; 2],
    /// The same without pinned events.
    pub free: [[f64; 2]; 2],
    /// The least and the greatest duration, where nature chooses it.
    pub natures: Option<[f64; 2]>,
    /// What it requires and asserts.
    pub labels: Vec<LabelId>,
}

/// What a bar is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BarKind {
    /// Has others inside.
    Composite,
    /// A primitive activity.
    Activity,
    Delay,
    /// An asserted condition.
    Tell,
    /// A required condition.
    Ask,
    /// A value that a variable keeps, in the earliest schedule.
    Value,
    /// A variable has no value while something changes it, in the earliest schedule.
    Changing,
    /// What is required of a variable that keeps its value, in the earliest schedule.
    Need,
}

impl BarKind {
    /// Whether it is part of the track of a variable that keeps its value.
    pub const fn is_of_state(self) -> bool {
        matches!(self, Self::Value | Self::Changing | Self::Need)
    }
}

/// A line between two bars.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// What it stands for.
    pub kind: LinkKind,
    /// The row and the bar that it comes from.
    pub from: (usize, usize),
    /// The row and the bar that it leads to.
    pub to: (usize, usize),
}

/// What a line between bars stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkKind {
    /// An assertion carries a requirement.
    Causal(CausalLink),
    /// One interval was put before another.
    Ordering(Ordering),
    /// One use of a resource was put before another.
    UseOrdering(UseOrdering),
}

/// A row before it is known which rows are closed.
#[derive(Clone, Debug)]
pub(super) struct Item {
    pub(super) kind: RowKind,
    /// What is written on its left.
    pub(super) name: SmolStr,
    /// Its name among the closed ones, if there are rows below it.
    pub(super) key: Option<SmolStr>,
    /// How deep it lies.
    pub(super) depth: u32,
    pub(super) bars: Vec<Bar>,
}

impl Bar {
    /// The part in which it is going on for certain, if there is one.
    pub fn certain(&self) -> Option<[f64; 2]> {
        (self.start[1] < self.end[0]).then_some([self.start[1], self.end[0]])
    }

    /// Whether pinned events have narrowed its windows.
    pub fn is_narrowed(&self) -> bool {
        self.free != [self.start, self.end]
    }

    /// Whether it stands for all of its occurrence, and not for a condition of an activity that has its own bar.
    pub fn is_whole(&self, network: &Network) -> bool {
        let occurrence = self.occurrence.and_then(|id| network.occurrences.get(id.index()));
        self.label.is_none() || occurrence.is_some_and(|it| it.kind == OccurrenceKind::Assertion)
    }

    /// Puts its windows to those of `plan`.
    fn retime(&mut self, plan: &Plan) {
        if let Some([start, end]) = times(plan, self.events) {
            (self.start, self.end) = (start, end);
        }
    }
}

impl Chart {
    /// The chart of a plan, with the rows below those of these keys closed. Linear in network and plan, but for sorting.
    pub fn new(
        program: &Program,
        network: &Network,
        plan: &Plan,
        options: ChartOptions,
        closed: &BTreeSet<SmolStr>,
    ) -> Self {
        let mut chart = Self::default();
        let mut hidden_from: Option<(u32, usize)> = None;
        let mut gathered: Vec<Vec<Bar>> = Vec::new();
        if options.resources {
            chart.profiles = profiles(network, plan);
        }
        let items = group::items(program, network, plan, options);
        for item in items.into_iter().chain(profile::items(&chart.profiles)) {
            if let Some((_, row)) = hidden_from.filter(|&(depth, _)| item.depth > depth) {
                let is_gathered =
                    |bar: &Bar| !matches!(bar.kind, BarKind::Composite | BarKind::Value | BarKind::Need);
                gathered[row].extend(item.bars.into_iter().filter(is_gathered));
                continue;
            }
            let is_closed = item.key.as_ref().is_some_and(|key| closed.contains(key));
            hidden_from = is_closed.then_some((item.depth, chart.rows.len()));
            let Item { kind, name, key, depth, bars } = item;
            chart.rows.push(Row { kind, name, depth, key, is_closed, bars: 0..0 });
            gathered.push(bars);
        }
        for (row, mut bars) in chart.rows.iter_mut().zip(gathered) {
            bars.sort_by(|left, right| left.start[0].total_cmp(&right.start[0]));
            let first = chart.bars.len();
            chart.bars.append(&mut bars);
            row.bars = first..chart.bars.len();
        }
        chart.horizon = horizon(&chart.bars);
        chart.links = chart.links_of(network, plan);
        chart
    }

    /// Adds flight rules below everything else.
    pub fn add_rules(&mut self, rules: Vec<RuleTrack>, closed: &BTreeSet<SmolStr>) {
        for item in rule::items(&rules) {
            let Item { kind, name, key, depth, .. } = item;
            let is_closed = key.as_ref().is_some_and(|key| closed.contains(key));
            let end = self.bars.len();
            self.rows.push(Row { kind, name, depth, key, is_closed, bars: end..end });
            if is_closed {
                break;
            }
        }
        self.rules = rules;
    }

    /// Puts all windows to those of `plan`, which selects the same; in time linear in the bars.
    pub fn retime(&mut self, plan: &Plan) {
        for bar in &mut self.bars {
            bar.retime(plan);
        }
        for profile in &mut self.profiles {
            profile.retime(plan);
        }
    }

    fn links_of(&self, network: &Network, plan: &Plan) -> Vec<Link> {
        // Where the bar of a condition is, and, failing that, the bar of its owner. A change has two: while it goes on, and
        // with what has come of it, which carries requirements.
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

/// The range of an arc's duration, in mission units, if nature chooses it.
pub(super) fn natures(network: &Network, arc: Option<ArcId>) -> Option<[f64; 2]> {
    let id = arc.filter(|&id| network.is_uncertain(id))?;
    let arc = &network.arcs[id.index()];
    Some([arc.lower.to_f64(), arc.upper.to_f64()])
}

/// The windows of two events, in mission units; `None` if the plan lacks one.
pub fn times(plan: &Plan, events: [NodeId; 2]) -> Option<[[f64; 2]; 2]> {
    let window = |node: NodeId| plan.windows.get(node.index()).copied().flatten();
    let pair = |window: Window| [window.earliest.to_f64(), window.latest.to_f64()];
    Some([pair(window(events[0])?), pair(window(events[1])?)])
}

fn horizon(bars: &[Bar]) -> f64 {
    bars.iter()
        .filter(|bar| bar.kind != BarKind::Value)
        .flat_map(|bar| [bar.start[1], bar.end[0], bar.end[1]])
        .filter(|time| time.is_finite())
        .fold(1.0, f64::max)
}
