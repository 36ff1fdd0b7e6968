//! What is told of a breach: the events that say when it is, and a sentence.

use exact::Bound;
use tpn::{NodeId, OccurrenceKind};

use super::super::Stretch;
use super::super::cut::Edge;
use super::Meaning;
use super::breach::Breach;

/// How many events a sentence names on each side.
const MAX_NAMED: usize = 3;

impl Meaning<'_> {
    /// The events of a case that say when it is, without those that others imply, and whether they have come.
    pub(super) fn decisive(&mut self, breach: &Breach) -> Vec<(NodeId, bool)> {
        let case = &breach.case;
        let (start, end) = (self.network.start, self.network.end);
        let by = breach.level.iter().flat_map(|level| level.by.iter().copied());
        let past = case.past.iter().map(|it| it.node).chain(by).filter(|&node| node != start);
        let past: Vec<NodeId> = past.collect();
        // Before the end is everything that does not happen at it.
        let future = case.future.iter().map(|it| it.node);
        let future = future.filter(|node| *node != start && (*node != end || past.contains(node)));
        let future: Vec<NodeId> = future.collect();
        let mut decisive = Vec::new();
        for (nodes, is_past) in [(past, true), (future, false)] {
            for (at, &node) in nodes.iter().enumerate() {
                let mut is_implied = decisive.contains(&(node, is_past));
                for (other_at, &other) in nodes.iter().enumerate() {
                    // Of what comes first and then, the later one says more of the past, the earlier one of the future.
                    let (first, then) = if is_past { (node, other) } else { (other, node) };
                    let is_ordered =
                        other != node && !self.times.fits(Edge::past(then, true), Edge::future(first, false));
                    let is_tied =
                        is_ordered && !self.times.fits(Edge::past(first, true), Edge::future(then, false));
                    is_implied |= is_ordered && (!is_tied || other_at < at);
                }
                if !is_implied {
                    decisive.push((node, is_past));
                }
            }
        }
        decisive
    }

    /// The event by which people know a node: that of an activity or an assertion rather than that of a delay.
    fn event(&self, node: NodeId) -> Option<&tpn::EventRef> {
        let events = &self.network.nodes.get(node.index())?.events;
        let is_telling = |event: &&tpn::EventRef| {
            let kind = self.network.occurrences.get(event.occurrence.index()).map(|it| it.kind);
            matches!(kind, Some(OccurrenceKind::Primitive | OccurrenceKind::Assertion))
        };
        events.iter().find(is_telling).or(events.first())
    }

    pub(super) fn owner(&self, node: NodeId) -> Option<String> {
        let event = self.event(node)?;
        Some(self.network.occurrences.get(event.occurrence.index())?.name.to_string())
    }

    /// When a breach is, and between what.
    pub(super) fn words(&self, stretch: Stretch, breach: &Breach, decisive: &[(NodeId, bool)]) -> String {
        let Stretch { from, to } = stretch;
        let mut words = match to {
            Bound::Finite(to) if to == from => format!("at {}", from.readable()),
            Bound::Finite(to) => format!("from {} to {}", from.readable(), to.readable()),
            Bound::Infinite => format!("from {} on", from.readable()),
        };
        let name = |node: NodeId| Some(self.network.event_name(*self.event(node)?));
        // The event of an instant bounds it from both sides.
        let is_at = |node: NodeId| [true, false].iter().all(|&side| decisive.contains(&(node, side)));
        let at = decisive.iter().find(|it| is_at(it.0)).and_then(|it| name(it.0));
        if let Some(at) = at {
            words.push_str(&format!(", with {at}"));
        }
        for (word, is_past) in [("after", true), ("before", false)] {
            let events = decisive.iter().filter(|it| it.1 == is_past && !is_at(it.0));
            let events: Vec<String> = events.filter_map(|it| name(it.0)).take(MAX_NAMED).collect();
            if !events.is_empty() {
                words.push_str(&format!(", {word} {}", events.join(" and ")));
            }
        }
        if let Some(level) = &breach.level {
            let name = &self.network.resources[level.resource].name;
            words.push_str(&format!(": {name} is {}", level.amount.readable()));
        }
        words
    }
}
