//! In which lanes and rows the bars of a plan are: by vehicle or resource, by parallel branch, or one by one.

use std::collections::BTreeMap;

use rmpl::program::{LabelMode, Program};
use smol_str::{SmolStr, format_smolstr};
use tpn::{LabelId, Network, OccurrenceId, OccurrenceKind, Plan};

use super::chart::Past;
use super::owner::{Owner, Owners};
use super::profile::Profile;
use super::row::{Bar, BarKind, Item, RowKind, natures, times};
use super::{ChartOptions, Grouping, pack, profile, state};
use crate::text::activity_name;
use crate::threads::{thread_name, threads};

/// The rows of a plan from top to bottom, what can be closed before what is then hidden.
pub(super) fn items(
    program: &Program,
    (network, plan): (&Network, &Plan),
    past: &[Past],
    options: ChartOptions,
    profiles: &[Profile],
) -> Vec<Item> {
    let bars = bars(network, plan, past, options);
    let states = if options.states { state::items(network, plan) } else { Vec::new() };
    let mut items = match options.grouping {
        Grouping::Vehicle => by_owner(program, network, bars, states, profiles),
        Grouping::Thread | Grouping::Structure => {
            let mut items = match options.grouping {
                Grouping::Thread if network.root.is_some() => by_thread(network, bars),
                _ => by_structure(network, bars),
            };
            items.extend(below("States", states.into_iter().map(|(_, item)| item).collect()));
            let rows = profiles.iter().enumerate().flat_map(|(at, it)| profile::items(at, it));
            items.extend(below("Resources", rows.collect()));
            items
        }
    };
    if options.conditions {
        items.extend(below("Conditions", conditions(network, plan)));
    }
    items
}

/// The bars of the activities and delays, by occurrence, and of what is past.
fn bars(network: &Network, plan: &Plan, past: &[Past], options: ChartOptions) -> Vec<Bar> {
    let mut labels: Vec<Vec<LabelId>> = vec![Vec::new(); network.occurrences.len()];
    for (index, label) in network.labels.iter().enumerate() {
        if let Some(of_owner) = label.owner.and_then(|owner| labels.get_mut(owner.index())) {
            of_owner.push(LabelId::from_index(index));
        }
    }
    let of_plan = network.occurrences.iter().enumerate().filter_map(|(index, occurrence)| {
        let kind = match occurrence.kind {
            OccurrenceKind::Activity => BarKind::Composite,
            OccurrenceKind::Primitive => BarKind::Activity,
            OccurrenceKind::Delay if options.delays => BarKind::Delay,
            _ => return None,
        };
        let [start, end] = times(plan, [occurrence.start, occurrence.end])?;
        Some((index, kind, [start, end]))
    });
    let of_past = past.iter().filter(|it| it.occurrence.index() < network.occurrences.len()).map(|it| {
        let kind = if it.is_aborted { BarKind::Aborted } else { BarKind::Past };
        (it.occurrence.index(), kind, it.times.map(|time| [time, time]))
    });
    let bar = |(index, kind, [start, end]): (usize, BarKind, [[f64; 2]; 2])| {
        let occurrence = &network.occurrences[index];
        Bar {
            kind,
            occurrence: Some(OccurrenceId::from_index(index)),
            label: None,
            events: [occurrence.start, occurrence.end],
            name: activity_name(occurrence),
            category: None,
            start,
            end,
            free: [start, end],
            natures: natures(network, occurrence.arc),
            labels: std::mem::take(&mut labels[index]),
        }
    };
    of_plan.chain(of_past).map(bar).collect()
}

fn heading(name: &'static str, key: SmolStr) -> Item {
    Item { kind: RowKind::Heading, name: name.into(), key: Some(key), depth: 0, bars: Vec::new() }
}

/// Rows below their heading; nothing without any.
fn below(name: &'static str, rows: Vec<Item>) -> Vec<Item> {
    let heading = (!rows.is_empty()).then(|| heading(name, name.to_lowercase().into()));
    heading.into_iter().chain(rows).collect()
}

/// What a lane has, from top to bottom.
#[derive(Default)]
struct Lane {
    bars: Vec<Bar>,
    states: Vec<Item>,
    profiles: Vec<Item>,
}

impl Lane {
    /// Its rows, the first of which has the name of the lane.
    fn items(self, name: SmolStr, key: SmolStr) -> Vec<Item> {
        let activities = packed(self.bars).into_iter().map(|bars| Item {
            kind: RowKind::Packed,
            name: SmolStr::default(),
            key: None,
            depth: 1,
            bars,
        });
        let mut items: Vec<Item> = activities.chain(self.states).chain(self.profiles).collect();
        let has_more = items.len() > 1;
        if let Some(first) = items.first_mut() {
            first.depth = 0;
            first.key = has_more.then_some(key);
            if first.kind == RowKind::Packed {
                first.name = name;
            }
        }
        items
    }
}

/// For each occurrence whether it has a bar.
fn shown(network: &Network, bars: &[Bar]) -> Vec<bool> {
    let mut is_shown = vec![false; network.occurrences.len()];
    for occurrence in bars.iter().filter_map(|bar| bar.occurrence) {
        is_shown[occurrence.index()] = true;
    }
    is_shown
}

/// A lane for each owner: its activities, its states, and its resources.
fn by_owner(
    program: &Program,
    network: &Network,
    bars: Vec<Bar>,
    states: Vec<(usize, Item)>,
    profiles: &[Profile],
) -> Vec<Item> {
    let is_shown = shown(network, &bars);
    let owners = Owners::new(program, network, &|occurrence| is_shown[occurrence.index()]);
    let mut lanes: BTreeMap<Owner, Lane> = BTreeMap::new();
    for bar in bars {
        let owner = bar.occurrence.map(|it| owners.occurrences[it.index()].clone());
        lanes.entry(owner.unwrap_or(Owner::Mission)).or_default().bars.push(bar);
    }
    for (variable, item) in states {
        lanes.entry(owners.variables[variable].clone()).or_default().states.push(item);
    }
    for (number, profile) in profiles.iter().enumerate() {
        let owner = owners.resources[profile.resource].clone();
        lanes.entry(owner).or_default().profiles.extend(profile::items(number, profile));
    }
    let items = lanes.into_iter().flat_map(|(owner, lane)| {
        let name = owner.name(program, network);
        let key = format_smolstr!("lane {name}");
        lane.items(name, key)
    });
    items.collect()
}

/// A lane for each parallel branch.
fn by_thread(network: &Network, bars: Vec<Bar>) -> Vec<Item> {
    let mut threads = threads(network);
    let mut lane_of = vec![0; network.occurrences.len()];
    let is_shown = shown(network, &bars);
    for (at, thread) in threads.iter_mut().enumerate() {
        thread.occurrences.retain(|it| is_shown[it.index()]);
        thread.occurrences.iter().for_each(|it| lane_of[it.index()] = at);
    }
    let mut lanes: Vec<Lane> = threads.iter().map(|_| Lane::default()).collect();
    for bar in bars {
        let lane = bar.occurrence.map_or(0, |it| lane_of[it.index()]);
        lanes[lane].bars.push(bar);
    }
    let items = lanes.into_iter().enumerate().flat_map(|(at, lane)| {
        let name = thread_name(network, &threads[at..]).unwrap_or(SmolStr::new_static("Main thread"));
        lane.items(name, format_smolstr!("thread {}", threads[at].number()))
    });
    items.collect()
}

/// A row for each bar, below that of the activity that it is part of, in the order of time.
fn by_structure(network: &Network, bars: Vec<Bar>) -> Vec<Item> {
    let mut bar_of = vec![None; network.occurrences.len()];
    for (at, bar) in bars.iter().enumerate().filter(|(_, bar)| bar.kind == BarKind::Composite) {
        if let Some(occurrence) = bar.occurrence {
            bar_of[occurrence.index()] = Some(at);
        }
    }
    // By bar, what is inside; last, what is in no other.
    let mut inside: Vec<Vec<usize>> = vec![Vec::new(); bars.len() + 1];
    let above = |bar: &Bar| {
        let mut next = network.occurrences.get(bar.occurrence?.index())?.parent;
        while let Some(parent) = next {
            if let Some(at) = bar_of[parent.index()] {
                return Some(at);
            }
            next = network.occurrences[parent.index()].parent.filter(|&it| it < parent);
        }
        None
    };
    for (at, bar) in bars.iter().enumerate() {
        inside[above(bar).unwrap_or(bars.len())].push(at);
    }
    for siblings in &mut inside {
        siblings.sort_by(|&left, &right| bars[left].start[0].total_cmp(&bars[right].start[0]));
    }
    let mut items = Vec::with_capacity(bars.len());
    let mut waiting: Vec<(usize, u32)> = inside[bars.len()].iter().rev().map(|&at| (at, 0)).collect();
    let mut bars: Vec<Option<Bar>> = bars.into_iter().map(Some).collect();
    while let Some((at, depth)) = waiting.pop() {
        let Some(bar) = bars[at].take() else { continue };
        waiting.extend(inside[at].iter().rev().map(|&at| (at, depth + 1)));
        let identifier = bar.occurrence.and_then(|it| network.occurrences.get(it.index()));
        let key = identifier.filter(|_| !inside[at].is_empty()).map(|it| it.name.clone());
        items.push(Item { kind: RowKind::Single, name: bar.name.clone(), key, depth, bars: vec![bar] });
    }
    items
}

/// A track for each variable that the plan speaks of and that does not keep its value: its assertions above, what is
/// required of it below, as many rows as it takes for none to lie over another.
fn conditions(network: &Network, plan: &Plan) -> Vec<Item> {
    let mut tracks: Vec<Vec<Bar>> = vec![Vec::new(); network.variables.len()];
    for (index, label) in network.labels.iter().enumerate() {
        let is_lasting = network.is_lasting(LabelId::from_index(index));
        let is_selected = !is_lasting && plan.selected_arcs.get(label.arc.index()) == Some(&true);
        let arc = &network.arcs[label.arc.index()];
        let Some([start, end]) = times(plan, [arc.from, arc.to]).filter(|_| is_selected) else { continue };
        let kind = if label.mode == LabelMode::Tell { BarKind::Tell } else { BarKind::Ask };
        tracks[label.literal.variable.index()].push(Bar {
            kind,
            occurrence: label.owner,
            label: Some(LabelId::from_index(index)),
            events: [arc.from, arc.to],
            name: label.text.clone(),
            category: None,
            start,
            end,
            free: [start, end],
            natures: natures(network, Some(label.arc)),
            labels: Vec::new(),
        });
    }
    let mut items = Vec::new();
    for (variable, bars) in network.variables.iter().zip(tracks) {
        let (tells, asks): (Vec<Bar>, Vec<Bar>) = bars.into_iter().partition(|bar| bar.kind == BarKind::Tell);
        let rows = packed(tells).into_iter().chain(packed(asks));
        items.extend(rows.enumerate().map(|(at, bars)| Item {
            kind: RowKind::Track,
            name: if at == 0 { variable.name.clone() } else { SmolStr::default() },
            key: None,
            depth: 1,
            bars,
        }));
    }
    items
}

/// Bars in as few rows as keep them apart as they are scheduled, in the order of their starts.
fn packed(bars: Vec<Bar>) -> Vec<Vec<Bar>> {
    let spans: Vec<[f64; 2]> = bars.iter().map(Bar::scheduled).collect();
    let places = pack::first_fit(&spans);
    let mut rows: Vec<Vec<Bar>> = vec![Vec::new(); places.iter().map(|row| row + 1).max().unwrap_or(0)];
    for (bar, row) in bars.into_iter().zip(places) {
        rows[row].push(bar);
    }
    rows
}
