//! Where in the network a line of the checklist is: what comes before and after what it is about.
//!
//! The names of a line say what it is about, and a `delay` has none that lasts: moved to another place, it is written with
//! the same words. So its place counts, with what it precedes. A line about what the world does is about all delays and choices of
//! its branch, whether it lists them or not: each one's place counts, with its bounds and the alternatives that it is in.

use std::collections::{BTreeMap, BTreeSet};

use rmpl::Span;
use snapshot::Snapshot;
use tpn::{ArcKind, BlockKind, EventEnd, EventRef, Network, NodeId, OccurrenceId, OccurrenceKind};

use super::hash::sha256;
use super::{Line, Review};

/// How the lines begin of what the world would have to do as it suits the plan.
pub(super) const ASSUMES: &str = "assumes favorable ";

/// Longer places are known by their digest.
const MAX_PLACE_BYTES: usize = 400;

/// Finds the place of each line that someone may have to acknowledge: of all but the windows of events.
pub(super) fn find_places(review: &mut Review, snapshot: &Snapshot) {
    let Some(network) = snapshot.network.as_deref() else { return };
    let mut surroundings = Surroundings::new(network);
    let is_assumption = |line: &Line| line.text.starts_with(ASSUMES);
    let has_assumptions = review.plan.iter().any(is_assumption);
    let assumptions = if has_assumptions { tpn::assumptions(&snapshot.program) } else { Vec::new() };
    let events = std::mem::take(&mut review.events);
    for line in review.every_line() {
        line.place = surroundings.place(line);
    }
    for line in review.plan.iter_mut().filter(|line| is_assumption(line)) {
        let about = assumptions.iter().filter(|it| line.span == Some(it.warning));
        let about: BTreeSet<OccurrenceId> = about
            .flat_map(|assumption| &assumption.statements)
            .flat_map(|statement| surroundings.written_within(*statement))
            .collect();
        if !about.is_empty() {
            line.place = surroundings.place_with_bounds(&about);
        }
    }
    review.events = events;
}

/// Returns the place of a flight rule in a network: those of all activities that it names, and of all that assert, require,
/// use or move what it names, with their bounds.
pub(super) fn place_of_rule(network: &Network, rule: &str) -> String {
    let is_part = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '-' | '.');
    let words: BTreeSet<&str> =
        rule.split(|letter| !is_part(letter)).filter(|word| !word.is_empty()).collect();
    let activities = network.occurrences.iter().enumerate();
    let activities = activities.filter(|(_, it)| words.contains(it.activity.as_str()));
    let labels = network.labels.iter().filter(|label| {
        let variable = &network.variables[label.literal.variable.index()];
        words.contains(variable.name.as_str())
    });
    let uses = network.uses.iter().filter(|used| {
        let resource = &network.resources[used.resource.index()];
        words.contains(resource.name.as_str())
    });
    let owners = labels.filter_map(|label| label.owner).chain(uses.filter_map(|used| used.owner));
    let about: BTreeSet<OccurrenceId> =
        activities.map(|(index, _)| OccurrenceId::from_index(index)).chain(owners).collect();
    Surroundings::new(network).place_with_bounds(&about)
}

/// What is around the events of a network.
struct Surroundings<'n> {
    network: &'n Network,
    occurrences: BTreeMap<&'n str, OccurrenceId>,
    /// What is written where, in textual order.
    written: Vec<(Span, OccurrenceId)>,
    alternatives: Alternatives,
    /// In how many parallel branches each activity is, one within the other, by its arc.
    branches: BTreeMap<usize, usize>,
    /// What was found of an event, backwards or forwards.
    known: BTreeMap<(NodeId, bool), String>,
}

impl<'n> Surroundings<'n> {
    fn new(network: &'n Network) -> Self {
        let ids =
            || (network.occurrences.iter().enumerate()).map(|(at, it)| (OccurrenceId::from_index(at), it));
        let occurrences = ids().map(|(id, it)| (it.name.as_str(), id)).collect();
        let mut written: Vec<(Span, OccurrenceId)> =
            ids().filter_map(|(id, it)| Some((it.span?, id))).collect();
        written.sort_by_key(|(span, id)| (span.start, span.end, *id));
        let alternatives = Alternatives::new(network);
        let branches = branches(network);
        Self { network, occurrences, written, alternatives, branches, known: BTreeMap::new() }
    }

    fn place(&mut self, line: &Line) -> String {
        let found = self.about(line);
        if found.is_empty() {
            let parts = line.nodes.iter().map(|&node| self.between("", node, node));
            return bounded(&parts.collect::<Vec<_>>());
        }
        let parts = found.iter().map(|&id| self.place_of(id));
        bounded(&parts.collect::<Vec<_>>())
    }

    /// The places of occurrences, with how long each may take and in which alternatives it is.
    fn place_with_bounds(&mut self, about: &BTreeSet<OccurrenceId>) -> String {
        let part = |&id: &OccurrenceId| {
            let arc = self.network.occurrences[id.index()].arc;
            let bounds = arc.map_or_else(String::new, |arc| {
                let arc = &self.network.arcs[arc.index()];
                format!("[{},{}] ", arc.lower, arc.upper)
            });
            let alternatives = self.alternatives_of(id);
            let numbers = alternatives.iter().map(|number| format!("in alternative {number}, "));
            format!("{bounds}{}{}", numbers.collect::<String>(), self.place_of(id))
        };
        bounded(&about.iter().map(part).collect::<Vec<_>>())
    }

    fn place_of(&mut self, id: OccurrenceId) -> String {
        let occurrence = &self.network.occurrences[id.index()];
        let parent = occurrence.parent;
        let parent = parent.map_or("", |parent| self.network.occurrences[parent.index()].name.as_str());
        let parent = match occurrence.arc.and_then(|arc| self.branches.get(&arc.index())) {
            None => parent.to_owned(),
            Some(1) => format!("a branch of {parent}"),
            Some(depth) => format!("{depth} branches of {parent}"),
        };
        self.between(&parent, occurrence.start, occurrence.end)
    }

    fn between(&mut self, parent: &str, start: NodeId, end: NodeId) -> String {
        let (before, after) = (self.next_to(start, false), self.next_to(end, true));
        format!("in {parent}, after {before}, before {after}")
    }

    /// Returns which alternatives an occurrence is in, from the inside out, by their numbers from 1.
    fn alternatives_of(&self, id: OccurrenceId) -> Vec<usize> {
        let parent = |id: &OccurrenceId| self.network.occurrences[id.index()].parent;
        let callers = std::iter::successors(Some(id), parent);
        let spans = callers.filter_map(|id| self.network.occurrences[id.index()].span);
        spans.flat_map(|span| self.alternatives.around(span)).collect()
    }

    /// Returns what a line is about: the occurrences that it names, otherwise those that are written where it leads.
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

    /// The occurrences that are written within `span`.
    fn written_within(&self, span: Span) -> Vec<OccurrenceId> {
        let first = self.written.partition_point(|(at, _)| at.start < span.start);
        let within = self.written[first..].iter().take_while(|(at, _)| at.start <= span.end);
        within.filter(|(at, _)| at.end <= span.end).map(|(_, id)| *id).collect()
    }

    /// The occurrences that are written within `span`, otherwise the closest ones around it.
    fn written_at(&self, span: Span) -> BTreeSet<OccurrenceId> {
        let within = self.written_within(span);
        if !within.is_empty() {
            return within.into_iter().collect();
        }
        let is_around = |at: &Span| at.start <= span.start && span.end <= at.end;
        let around = || self.written.iter().filter(|(at, _)| is_around(at));
        let closest = around().map(|(at, _)| at.end - at.start).min();
        around().filter(|(at, _)| Some(at.end - at.start) == closest).map(|(_, id)| *id).collect()
    }

    /// The activities and assertions that come next to an event.
    fn next_to(&mut self, node: NodeId, is_forward: bool) -> String {
        let mut names = BTreeSet::new();
        let (mut seen, mut open) = (BTreeSet::from([node]), vec![node]);
        // The events from here on without a branch: what is next to one of them is next to all before it.
        let mut chain = Vec::new();
        let mut is_chain = true;
        while let Some(node) = open.pop() {
            if is_chain {
                if let Some(known) = self.known.get(&(node, is_forward)).cloned() {
                    self.remember(chain, is_forward, &known);
                    return known;
                }
                chain.push(node);
            }
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
            is_chain &= open.len() == 1;
        }
        let found = names.into_iter().collect::<Vec<_>>().join(" and ");
        self.remember(chain, is_forward, &found);
        found
    }

    fn remember(&mut self, chain: Vec<NodeId>, is_forward: bool, found: &str) {
        self.known.extend(chain.into_iter().map(|node| ((node, is_forward), found.to_owned())));
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

/// In how many parallel branches each arc is, one within the other, if it is in any.
fn branches(network: &Network) -> BTreeMap<usize, usize> {
    let mut found = BTreeMap::new();
    let mut around = vec![0; network.blocks.len()];
    // Blocks come after what is in them.
    for (index, block) in network.blocks.iter().enumerate().rev() {
        let own = around[index];
        let (parts, is_parallel) = match &block.kind {
            BlockKind::Leaf { arc } => {
                if own > 0 {
                    found.insert(arc.index(), own);
                }
                continue;
            }
            BlockKind::Parallel { branches } => (branches.as_slice(), true),
            BlockKind::Sequence { children: parts } | BlockKind::Choose { alternatives: parts, .. } => {
                (parts.as_slice(), false)
            }
            BlockKind::Scope { child, .. } | BlockKind::Guard { child, .. } => {
                (std::slice::from_ref(child), false)
            }
        };
        for part in parts {
            around[part.index()] = own + usize::from(is_parallel && parts.len() > 1);
        }
    }
    found
}

/// A place, by its digest if it is long.
fn bounded(parts: &[String]) -> String {
    let place = parts.join("; ");
    if place.len() > MAX_PLACE_BYTES { sha256(place.as_bytes()) } else { place }
}

/// The alternatives of all choices, where they are written, in textual order. One is within another, or apart from it.
struct Alternatives(Vec<Written>);

struct Written {
    span: Span,
    /// The number of the alternative, from 1.
    number: usize,
    /// The closest alternative around it.
    around: Option<usize>,
}

impl Alternatives {
    fn new(network: &Network) -> Self {
        let spans = network.decisions.iter().flat_map(|decision| decision.alternative_spans.iter().zip(1..));
        let mut all: Vec<(Span, usize)> = spans.map(|(span, number)| (*span, number)).collect();
        all.sort_by_key(|(span, number)| (span.start, std::cmp::Reverse(span.end), *number));
        all.dedup_by_key(|(span, _)| *span);
        let mut found: Vec<Written> = Vec::new();
        let mut open: Vec<usize> = Vec::new();
        for (span, number) in all {
            while open.pop_if(|last| found[*last].span.end < span.end).is_some() {}
            let around = open.last().copied();
            open.push(found.len());
            found.push(Written { span, number, around });
        }
        Self(found)
    }

    /// The numbers of the alternatives around `span`, from the inside out.
    fn around(&self, span: Span) -> impl Iterator<Item = usize> {
        let before = self.0.partition_point(|it| it.span.start <= span.start);
        let outward = std::iter::successors(before.checked_sub(1), |&at| self.0[at].around);
        outward.map(|at| &self.0[at]).filter(move |it| span.end <= it.span.end).map(|it| it.number)
    }
}
