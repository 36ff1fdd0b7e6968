//! In which rows the bars of a plan are: by activity, by parallel branch, or by vehicle, and conditions in tracks.

use std::collections::BTreeMap;

use rmpl::program::{LabelMode, Program};
use smol_str::{SmolStr, format_smolstr};
use tpn::{LabelId, Network, OccurrenceId, OccurrenceKind, Plan};

use super::row::{Bar, BarKind, Item, RowKind, natures, times};
use super::{ChartOptions, Grouping, state};
use crate::threads::{thread_name, threads};

/// The rows of a plan from top to bottom, parents before children.
pub(super) fn items(program: &Program, network: &Network, plan: &Plan, options: ChartOptions) -> Vec<Item> {
    let bars = Bars::new(network, plan, options);
    let mut items = match options.grouping {
        Grouping::Thread if network.root.is_some() => by_thread(network, &bars),
        Grouping::Vehicle => by_vehicle(program, network, &bars),
        Grouping::Structure | Grouping::Thread => by_structure(network, &bars),
    };
    if options.conditions {
        items.extend(conditions(network, plan));
    }
    if options.states {
        items.extend(state::items(network, plan));
    }
    items
}

/// The bars of the activities and delays, by occurrence.
struct Bars {
    bars: Vec<Option<Bar>>,
}

impl Bars {
    fn new(network: &Network, plan: &Plan, options: ChartOptions) -> Self {
        let mut labels: Vec<Vec<LabelId>> = vec![Vec::new(); network.occurrences.len()];
        for (index, label) in network.labels.iter().enumerate() {
            if let Some(of_owner) = label.owner.and_then(|owner| labels.get_mut(owner.index())) {
                of_owner.push(LabelId::from_index(index));
            }
        }
        let bars = network.occurrences.iter().zip(labels).enumerate().map(|(index, (occurrence, labels))| {
            let kind = match occurrence.kind {
                OccurrenceKind::Activity => BarKind::Composite,
                OccurrenceKind::Primitive => BarKind::Activity,
                OccurrenceKind::Delay if options.delays => BarKind::Delay,
                _ => return None,
            };
            let events = [occurrence.start, occurrence.end];
            let [start, end] = times(plan, events)?;
            Some(Bar {
                kind,
                occurrence: Some(OccurrenceId::from_index(index)),
                label: None,
                events,
                name: occurrence.name.clone(),
                start,
                end,
                free: [start, end],
                natures: natures(network, occurrence.arc),
                labels,
            })
        });
        Self { bars: bars.collect() }
    }

    fn get(&self, occurrence: OccurrenceId) -> Option<&Bar> {
        self.bars.get(occurrence.index())?.as_ref()
    }

    fn item(&self, occurrence: OccurrenceId, depth: u32) -> Option<Item> {
        let bar = self.get(occurrence)?.clone();
        Some(Item { kind: RowKind::Single, name: bar.name.clone(), key: None, depth, bars: vec![bar] })
    }
}

fn heading(name: impl Into<SmolStr>, key: SmolStr, depth: u32) -> Item {
    Item { kind: RowKind::Heading, name: name.into(), key: Some(key), depth, bars: Vec::new() }
}

fn by_structure(network: &Network, bars: &Bars) -> Vec<Item> {
    // Activities lie between occurrences that are no activities of their own; only those count.
    let mut depths = vec![0_u32; network.occurrences.len()];
    for (index, occurrence) in network.occurrences.iter().enumerate() {
        let Some(parent) = occurrence.parent.map(OccurrenceId::index).filter(|&parent| parent < index) else {
            continue;
        };
        let is_activity = network.occurrences[parent].kind == OccurrenceKind::Activity;
        depths[index] = depths[parent] + u32::from(is_activity);
    }
    let ids = (0..network.occurrences.len()).map(OccurrenceId::from_index);
    let mut items: Vec<Item> = ids.filter_map(|id| bars.item(id, depths[id.index()])).collect();
    for at in 1..items.len() {
        if items[at].depth > items[at - 1].depth {
            items[at - 1].key = Some(items[at - 1].name.clone());
        }
    }
    items
}

fn by_thread(network: &Network, bars: &Bars) -> Vec<Item> {
    let mut threads = threads(network);
    for thread in &mut threads {
        thread.occurrences.retain(|&it| bars.get(it).is_some());
    }
    let mut items = Vec::new();
    for (at, thread) in threads.iter().enumerate() {
        let Some(name) = thread_name(network, &threads[at..]) else { continue };
        let depth = thread.path.len().saturating_sub(1) as u32;
        if !thread.path.is_empty() || !thread.occurrences.is_empty() {
            items.push(heading(name, format_smolstr!("thread {}", thread.number()), depth));
        }
        items.extend(thread.occurrences.iter().filter_map(|&it| bars.item(it, depth + 1)));
    }
    items
}

fn by_vehicle(program: &Program, network: &Network, bars: &Bars) -> Vec<Item> {
    let vehicles = &program.world.vehicles;
    let at: BTreeMap<&str, usize> =
        vehicles.iter().enumerate().map(|(at, vehicle)| (vehicle.name.text.as_str(), at)).collect();
    let moved: BTreeMap<&str, Vec<usize>> = program
        .primitives
        .iter()
        .filter_map(|it| Some((it.name.text.as_str(), it.moves.as_ref()?)))
        .map(|(name, moves)| {
            (name, moves.vehicles.iter().filter_map(|it| at.get(it.text.as_str()).copied()).collect())
        })
        .collect();
    // What an activity is called with holds for everything in it.
    let mut occupied: Vec<Vec<usize>> = Vec::with_capacity(network.occurrences.len());
    for occurrence in &network.occurrences {
        let parent = occurrence.parent.and_then(|parent| occupied.get(parent.index()));
        let mut own: Vec<usize> = parent.cloned().unwrap_or_default();
        own.extend(occurrence.arguments.iter().filter_map(|argument| at.get(argument.as_str()).copied()));
        own.extend(moved.get(occurrence.activity.as_str()).into_iter().flatten());
        own.sort_unstable();
        own.dedup();
        occupied.push(own);
    }
    let of = |wanted: Option<usize>| {
        let ids = (0..network.occurrences.len()).map(OccurrenceId::from_index);
        ids.filter(|id| match wanted {
            Some(vehicle) => occupied[id.index()].contains(&vehicle),
            None => occupied[id.index()].is_empty(),
        })
        .filter_map(|id| bars.item(id, 1))
        .collect::<Vec<_>>()
    };
    let named = vehicles.iter().enumerate().map(|(at, it)| (it.name.text.clone(), Some(at)));
    let mut items = Vec::new();
    for (name, vehicle) in named.chain([(SmolStr::new_static("No vehicle"), None)]) {
        let members = of(vehicle);
        if !members.is_empty() {
            items.push(heading(name.clone(), format_smolstr!("vehicle {name}"), 0));
            items.extend(members);
        }
    }
    items
}

/// A track for each variable that the plan speaks of and that does not keep its value: its assertions above, what is required of it below, as many
/// rows as it takes for none to lie over another.
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
            start,
            end,
            free: [start, end],
            natures: natures(network, Some(label.arc)),
            labels: Vec::new(),
        });
    }
    let mut items = vec![heading("Conditions", SmolStr::new_static("conditions"), 0)];
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
    if items.len() > 1 { items } else { Vec::new() }
}

/// Puts bars into as few rows as keep them apart, in the order of their starts.
fn packed(mut bars: Vec<Bar>) -> Vec<Vec<Bar>> {
    bars.sort_by(|left, right| left.start[0].total_cmp(&right.start[0]));
    let mut rows: Vec<Vec<Bar>> = Vec::new();
    for bar in bars {
        let is_free = |row: &&mut Vec<Bar>| row.last().is_none_or(|last| last.end[1] <= bar.start[0]);
        match rows.iter_mut().find(is_free) {
            Some(row) => row.push(bar),
            None => rows.push(vec![bar]),
        }
    }
    rows
}
