//! The order of events within one instant (SPEC 10.4): which come at one time in every schedule, and which of those happen
//! before which.

use std::collections::BTreeSet;

use tpn::NodeId;

use crate::distance::Distances;

/// One event is before another at one instant, with the index of what says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Step {
    pub(crate) from: NodeId,
    pub(crate) to: NodeId,
    pub(crate) reason: u32,
}

/// The transitive closure of some steps among events that come at one time in every schedule.
#[derive(Clone, Debug)]
pub(crate) struct InstantOrder {
    /// Per node: its instant.
    instants: Vec<u32>,
    /// Per node: its place among those of its instant.
    places: Vec<u32>,
    /// Per instant: row by row, by place, a bit for each event that comes after.
    after: Vec<Vec<u64>>,
    /// Per instant: the words of a row.
    words: Vec<usize>,
}

impl InstantOrder {
    /// Fails with a cycle of steps. All steps must be constraints of the distances. O(nodes + edges + n · steps / 64) for
    /// instants of n events.
    pub(crate) fn new(distances: &Distances, steps: &[Step]) -> Result<Self, Vec<Step>> {
        let instants = distances.instants();
        let sequence = sequence(instants.len(), steps)?;
        let mut places = vec![0; instants.len()];
        let mut counts = vec![0_u32; instants.len()];
        for &node in &sequence {
            let count = &mut counts[instants[node] as usize];
            places[node] = *count;
            *count += 1;
        }
        let words: Vec<usize> = counts.iter().map(|count| count.div_ceil(64) as usize).collect();
        let mut after: Vec<Vec<u64>> =
            counts.iter().zip(&words).map(|(&count, words)| vec![0; count as usize * words]).collect();
        let mut later: Vec<Vec<usize>> = vec![Vec::new(); instants.len()];
        // What lies between two events of one instant is of that instant.
        for step in steps.iter().filter(|it| instants[it.from.index()] == instants[it.to.index()]) {
            later[step.from.index()].push(step.to.index());
        }
        for &node in sequence.iter().rev() {
            let instant = instants[node] as usize;
            let words = words[instant];
            let mut row = vec![0_u64; words];
            for &then in &later[node] {
                let place = places[then] as usize;
                row[place / 64] |= 1 << (place % 64);
                let others = &after[instant][place * words..][..words];
                row.iter_mut().zip(others).for_each(|(word, more)| *word |= more);
            }
            after[instant][places[node] as usize * words..][..words].copy_from_slice(&row);
        }
        Ok(Self { instants, places, after, words })
    }

    /// Of two events that come at one time in every schedule, whether the first happens before the second; `None` for
    /// others. An event happens before itself.
    pub(crate) fn is_before(&self, one: NodeId, other: NodeId) -> Option<bool> {
        let instant = self.instants[one.index()];
        if instant != self.instants[other.index()] {
            return None;
        }
        let (instant, place) = (instant as usize, self.places[other.index()] as usize);
        let row = self.places[one.index()] as usize * self.words[instant];
        Some(one == other || self.after[instant][row + place / 64] >> (place % 64) & 1 == 1)
    }
}

/// All nodes, each after those that steps put before it; or the steps of a cycle, in its order.
fn sequence(count: usize, steps: &[Step]) -> Result<Vec<usize>, Vec<Step>> {
    let mut leaving: Vec<Vec<usize>> = vec![Vec::new(); count];
    let mut awaited = vec![0_u32; count];
    for step in steps {
        leaving[step.from.index()].push(step.to.index());
        awaited[step.to.index()] += 1;
    }
    let mut sequence: Vec<usize> = (0..count).filter(|&node| awaited[node] == 0).collect();
    let mut at = 0;
    while let Some(&node) = sequence.get(at) {
        at += 1;
        for &then in &leaving[node] {
            awaited[then] -= 1;
            if awaited[then] == 0 {
                sequence.push(then);
            }
        }
    }
    match steps.iter().find(|step| awaited[step.to.index()] > 0) {
        None => Ok(sequence),
        Some(step) => Err(cycle(steps, &awaited, step.to)),
    }
}

/// A cycle among the nodes that still wait for others, from one of them backwards.
fn cycle(steps: &[Step], awaited: &[u32], from: NodeId) -> Vec<Step> {
    let mut seen = BTreeSet::new();
    let mut path: Vec<Step> = Vec::new();
    let mut node = from;
    while seen.insert(node) {
        // An event that waits has a predecessor that also waits.
        let Some(&step) = steps.iter().find(|step| step.to == node && awaited[step.from.index()] > 0) else {
            break;
        };
        path.push(step);
        node = step.from;
    }
    let start = path.iter().position(|step| step.to == node).unwrap_or(0);
    path.drain(..start);
    path.reverse();
    path
}
