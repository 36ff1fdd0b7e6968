//! A network with what has happened so far, for planning again (SPEC 6.2): executed events keep their times, all
//! others come later, and the world's news replace what the program said.

use exact::{Bound, Time};
use tpn::{Arc, ArcId, ArcKind, EventRef, Network, NodeId, OccurrenceId, Role};

/// What has happened and what is known at a moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Facts {
    /// The present.
    pub now: Time,
    /// Nodes of the program's network that have happened.
    pub happened: Vec<(NodeId, Time)>,
    /// Path vertices that were passed; they are appended to the network, so they are known by their event.
    pub passed: Vec<(EventRef, Time)>,
    /// Occurrences that take this long.
    pub durations: Vec<(OccurrenceId, Time)>,
    /// Conditions that begin at this time.
    pub begins: Vec<(OccurrenceId, Time)>,
}

/// A lower bound that binds nothing: no mission is longer.
const LONG: i64 = 1 << 40;

impl Facts {
    /// `network` with these facts. `num_program_nodes` is how many nodes the program's own network has.
    ///
    /// Facts are arcs from each node back to the start: only those of selected nodes count, so alternatives that are
    /// not taken stay open. A decision that was taken is settled by its alternative: the others would begin too late.
    pub fn apply(&self, network: &Network, num_program_nodes: usize) -> Network {
        let mut changed = network.clone();
        for &(occurrence, duration) in &self.durations {
            set_duration(&mut changed, occurrence, duration);
        }
        for &(occurrence, _) in &self.begins {
            free_start(&mut changed, occurrence);
        }
        let mut times = vec![None; network.nodes.len()];
        for &(node, time) in &self.happened {
            if let Some(slot) = times.get_mut(node.index()) {
                *slot = Some(time);
            }
        }
        for (index, node) in network.nodes.iter().enumerate() {
            for &(event, time) in &self.passed {
                if node.events.contains(&event) {
                    times[index] = Some(time);
                }
            }
        }
        for (index, (time, described)) in times.iter().zip(&network.nodes).enumerate() {
            let node = NodeId::from_index(index);
            let is_vertex = index >= num_program_nodes;
            if node == network.start || described.role == Role::Decision {
                continue;
            }
            match *time {
                Some(time) => add_back_arc(&mut changed, node, time, time),
                // A vertex that was not reported lies between others that are held.
                None if is_vertex => {}
                None => add_back_arc(&mut changed, node, self.now, Time::from(LONG)),
            }
        }
        for &(occurrence, time) in &self.begins {
            let start = changed.occurrences[occurrence.index()].start;
            if times[start.index()].is_none() {
                add_back_arc(&mut changed, start, time.max(self.now), time.max(self.now));
            }
        }
        changed
    }
}

/// Holds `node` to come between `earliest` and `latest` after the start.
fn add_back_arc(network: &mut Network, node: NodeId, earliest: Time, latest: Time) {
    // Nothing comes before the start, and what is not negative has an opposite that fits.
    let back = |time: Time| time.max(Time::ZERO).checked_neg().unwrap_or_default();
    let id = ArcId::from_index(network.arcs.len());
    let start = network.start;
    network.arcs.push(Arc {
        from: node,
        to: start,
        lower: back(latest),
        upper: Bound::Finite(back(earliest)),
        is_contingent: false,
        kind: ArcKind::Span,
        labels: Vec::new(),
        occurrence: None,
        choice: None,
        span: None,
    });
    network.nodes[node.index()].out_arcs.push(id);
    network.nodes[start.index()].in_arcs.push(id);
}

fn set_duration(network: &mut Network, occurrence: OccurrenceId, duration: Time) {
    if let Some(arc) = network.occurrences[occurrence.index()].arc {
        let arc = &mut network.arcs[arc.index()];
        (arc.lower, arc.upper) = (duration, Bound::Finite(duration));
    }
    // How it divides among the segments of a path is not known.
    for arc in network.arcs.iter_mut().filter(|arc| arc.kind == ArcKind::Path) {
        if arc.occurrence == Some(occurrence) {
            (arc.lower, arc.upper) = (Time::ZERO, Bound::Infinite);
        }
    }
}

/// Lets the delay before a condition be as long as the world makes it.
fn free_start(network: &mut Network, occurrence: OccurrenceId) {
    let mut pending = vec![network.occurrences[occurrence.index()].start];
    let mut seen = pending.clone();
    while let Some(node) = pending.pop() {
        for arc in network.nodes[node.index()].in_arcs.clone() {
            let arc = &mut network.arcs[arc.index()];
            match arc.kind {
                ArcKind::Delay => {
                    arc.lower = Time::ZERO;
                    arc.upper = Bound::Infinite;
                }
                ArcKind::Glue if !seen.contains(&arc.from) => {
                    seen.push(arc.from);
                    pending.push(arc.from);
                }
                _ => {}
            }
        }
    }
}
