//! The heaviest set of intervals of which no two are ordered: a weighted antichain, by Dilworth's theorem and a flow.

use crate::entailment::Precedence;

/// The greatest weight of a set of elements no two of which are ordered, and such a set.
///
/// By Dilworth's theorem the weight is that of the least cover by chains, the sum of all weights less a maximum flow
/// between each element and those that come directly after it (Fulkerson 1956). Elements that all others come before
/// or after divide the order, so that a sequence needs no flow; otherwise O(elements² · relations) at worst.
pub(crate) fn heaviest_antichain(weights: &[i128], order: &Precedence) -> (i128, Vec<usize>) {
    // Of intervals that are one event each precedes the other: then by position, which keeps the relation transitive.
    let precedes = |one: usize, other: usize| {
        order.is_before(one, other) && (one < other || !order.is_before(other, one))
    };
    let mut sequence: Vec<usize> = (0..weights.len()).filter(|&index| weights[index] > 0).collect();
    let counts: Vec<usize> = (0..weights.len())
        .map(|index| sequence.iter().filter(|&&other| precedes(other, index)).count())
        .collect();
    // What comes before has fewer before it.
    sequence.sort_by_key(|&index| (counts[index], index));
    // How many of the first elements of the sequence all come before an element, and before all from it on.
    let mut divided: Vec<usize> = (sequence.iter())
        .map(|&index| sequence.iter().take_while(|&&other| precedes(other, index)).count())
        .collect();
    for position in (1..divided.len()).rev() {
        divided[position - 1] = divided[position - 1].min(divided[position]);
    }
    let mut heaviest = (0, Vec::new());
    let mut from = 0;
    for to in 1..=sequence.len() {
        if to < sequence.len() && divided[to] < to {
            continue;
        }
        let found = heaviest_of(&sequence[from..to], weights, &precedes);
        if found.0 > heaviest.0 {
            heaviest = found;
        }
        from = to;
    }
    heaviest
}

/// The same of some elements, each after all that it comes after.
fn heaviest_of(
    elements: &[usize],
    weights: &[i128],
    precedes: &impl Fn(usize, usize) -> bool,
) -> (i128, Vec<usize>) {
    if let [only] = elements {
        return (weights[*only], vec![*only]);
    }
    // Each element stands once on either side. Flow from left to right is a step of a chain; what continues from the
    // right side to the left steps over the element.
    let count = elements.len();
    let (left, right) = (|index: usize| index, |index: usize| count + index);
    let mut flow = Flow { edges: Vec::new(), leaving: vec![Vec::new(); 2 * count + 2] };
    let (source, sink) = (2 * count, 2 * count + 1);
    for (position, &element) in elements.iter().enumerate() {
        flow.add(source, left(position), weights[element]);
        flow.add(right(position), sink, weights[element]);
        flow.add(right(position), left(position), i128::MAX);
        for (later, &other) in elements.iter().enumerate().skip(position + 1) {
            let is_direct = || {
                !elements[position + 1..later]
                    .iter()
                    .any(|&between| precedes(element, between) && precedes(between, other))
            };
            if precedes(element, other) && is_direct() {
                flow.add(left(position), right(later), i128::MAX);
            }
        }
    }
    flow.maximize(source, sink);
    // What the source still reaches on the left and not on the right is in no part of the least cut (Kőnig).
    let reached = flow.reach(source, sink).1;
    let chosen =
        (0..count).filter(|&index| reached[left(index)].is_some() && reached[right(index)].is_none());
    let chosen: Vec<usize> = chosen.map(|index| elements[index]).collect();
    (chosen.iter().map(|&element| weights[element]).sum(), chosen)
}

/// A flow network: an edge and its reverse stand side by side.
struct Flow {
    /// Where each edge leads, and how much more it can carry.
    edges: Vec<(usize, i128)>,
    leaving: Vec<Vec<usize>>,
}

impl Flow {
    fn add(&mut self, from: usize, to: usize, capacity: i128) {
        self.leaving[from].push(self.edges.len());
        self.edges.push((to, capacity));
        self.leaving[to].push(self.edges.len());
        self.edges.push((from, 0));
    }

    /// Augments by shortest paths (Edmonds and Karp 1972).
    fn maximize(&mut self, source: usize, sink: usize) {
        loop {
            let (is_reached, by) = self.reach(source, sink);
            if !is_reached {
                return;
            }
            let mut path = Vec::new();
            let mut at = sink;
            while at != source
                && let Some(edge) = by[at]
            {
                path.push(edge);
                at = self.edges[edge ^ 1].0;
            }
            let amount = path.iter().map(|&edge| self.edges[edge].1).min().unwrap_or_default();
            for edge in path {
                self.edges[edge].1 -= amount;
                let back = &mut self.edges[edge ^ 1].1;
                *back = back.saturating_add(amount);
            }
        }
    }

    /// Returns whether more can flow to the sink; and for each node an edge by which more can reach it.
    fn reach(&self, source: usize, sink: usize) -> (bool, Vec<Option<usize>>) {
        let mut by: Vec<Option<usize>> = vec![None; self.leaving.len()];
        let mut queue = std::collections::VecDeque::from([source]);
        while let Some(node) = queue.pop_front() {
            for &edge in &self.leaving[node] {
                let (to, capacity) = self.edges[edge];
                if capacity > 0 && to != source && by[to].is_none() {
                    by[to] = Some(edge);
                    if to == sink {
                        return (true, by);
                    }
                    queue.push_back(to);
                }
            }
        }
        (false, by)
    }
}
