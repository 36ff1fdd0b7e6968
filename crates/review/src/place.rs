//! Where in the network a line of the checklist is: what comes before and after what it is about.
//!
//! The names of a line say what it is about, and a `delay` has none that lasts: moved to another place, it is written with
//! the same words. So its place counts, with what it precedes.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::Span;
use snapshot::Snapshot;
use tpn::{ArcKind, EventEnd, EventRef, Network, NodeId, OccurrenceId, OccurrenceKind};

use super::hash::sha256;
use super::{Line, Review};

/// Longer places are known by their digest.
const MAX_PLACE_BYTES: usize = 400;

/// Finds the place of each line that someone may have to acknowledge: of all but the windows of events.
pub(super) fn find_places(review: &mut Review, snapshot: &Snapshot) {
    let Some(network) = snapshot.network.as_deref() else { return };
    let mut surroundings = Surroundings::new(network);
    let events = std::mem::take(&mut review.events);
    for line in review.every_line() {
        line.place = surroundings.place(line);
    }
    review.events = events;
}

/// What is around the events of a network.
struct Surroundings<'n> {
    network: &'n Network,
    occurrences: BTreeMap<&'n str, OccurrenceId>,
    /// What was found of an event, backwards or forwards.
    known: BTreeMap<(NodeId, bool), String>,
}

impl<'n> Surroundings<'n> {
    fn new(network: &'n Network) -> Self {
        let named = network.occurrences.iter().enumerate();
        let occurrences =
            named.map(|(index, it)| (it.name.as_str(), OccurrenceId::from_index(index))).collect();
        Self { network, occurrences, known: BTreeMap::new() }
    }

    fn place(&mut self, line: &Line) -> String {
        let found = self.about(line);
        let ends: Vec<(Option<OccurrenceId>, NodeId, NodeId)> = if found.is_empty() {
            line.nodes.iter().map(|&node| (None, node, node)).collect()
        } else {
            let ends = |id: &OccurrenceId| {
                let occurrence = &self.network.occurrences[id.index()];
                (Some(*id), occurrence.start, occurrence.end)
            };
            found.iter().map(ends).collect()
        };
        let mut parts = Vec::new();
        for (id, start, end) in ends {
            let parent = id.and_then(|id| self.network.occurrences[id.index()].parent);
            let parent = parent.map_or("", |parent| self.network.occurrences[parent.index()].name.as_str());
            let (before, after) = (self.next_to(start, false), self.next_to(end, true));
            parts.push(format!("in {parent}, after {before}, before {after}"));
        }
        let place = parts.join("; ");
        if place.len() > MAX_PLACE_BYTES { sha256(place.as_bytes()) } else { place }
    }

    /// What a line is about: the occurrences that it names, otherwise those that are written where it leads.
    fn about(&self, line: &Line) -> BTreeSet<OccurrenceId> {
        let named = line.names.iter().filter_map(|name| {
            let name = name.rsplit_once('@').map_or(name.as_str(), |(_, owner)| owner);
            let event = name.strip_suffix(".start").or_else(|| name.strip_suffix(".end"));
            self.occurrences.get(event.unwrap_or(name)).copied()
        });
        let named: BTreeSet<OccurrenceId> = named.collect();
        match line.span.filter(|_| named.is_empty()) {
            Some(span) => self.written_at(span),
            None => named,
        }
    }

    /// The occurrences that are written within `span`, otherwise the closest ones around it.
    fn written_at(&self, span: Span) -> BTreeSet<OccurrenceId> {
        let is_within = |inner: Span, outer: Span| outer.start <= inner.start && inner.end <= outer.end;
        let written = || {
            let all = self.network.occurrences.iter().enumerate();
            all.filter_map(|(index, it)| Some((OccurrenceId::from_index(index), it.span?)))
        };
        let within: BTreeSet<OccurrenceId> =
            written().filter(|(_, at)| is_within(*at, span)).map(|(id, _)| id).collect();
        if !within.is_empty() {
            return within;
        }
        let around: Vec<(OccurrenceId, u32)> = written()
            .filter(|(_, at)| is_within(span, *at))
            .map(|(id, at)| (id, at.end - at.start))
            .collect();
        let closest = around.iter().map(|(_, length)| *length).min();
        around.iter().filter(|(_, length)| Some(*length) == closest).map(|(id, _)| *id).collect()
    }

    /// The activities and assertions that come next to an event.
    fn next_to(&mut self, node: NodeId, is_forward: bool) -> String {
        if let Some(known) = self.known.get(&(node, is_forward)) {
            return known.clone();
        }
        let mut names = BTreeSet::new();
        let (mut seen, mut open) = (BTreeSet::from([node]), vec![node]);
        while let Some(node) = open.pop() {
            let here = self.names_at(node, is_forward);
            if !here.is_empty() {
                names.extend(here);
                continue;
            }
            let at = &self.network.nodes[node.index()];
            let arcs = if is_forward { &at.out_arcs } else { &at.in_arcs };
            if arcs.is_empty() {
                names.insert(if is_forward { "the end" } else { "the start" });
            }
            for arc in arcs.iter().map(|arc| &self.network.arcs[arc.index()]) {
                let next = if is_forward { arc.to } else { arc.from };
                // What spans other things says nothing of what is next.
                if !matches!(arc.kind, ArcKind::Composite | ArcKind::Span) && seen.insert(next) {
                    open.push(next);
                }
            }
        }
        let found = names.into_iter().collect::<Vec<_>>().join(" and ");
        self.known.insert((node, is_forward), found.clone());
        found
    }

    /// The activities and assertions that start at an event, or end there.
    fn names_at(&self, node: NodeId, is_forward: bool) -> Vec<&'n str> {
        let wanted = if is_forward { EventEnd::Start } else { EventEnd::End };
        let events = self.network.nodes[node.index()].events.iter();
        let found = events.filter(|EventRef { end, .. }| *end == wanted).filter_map(|event| {
            let occurrence = &self.network.occurrences[event.occurrence.index()];
            let is_named = matches!(
                occurrence.kind,
                OccurrenceKind::Primitive | OccurrenceKind::Activity | OccurrenceKind::Assertion
            );
            is_named.then_some(occurrence.name.as_str())
        });
        found.collect()
    }
}
