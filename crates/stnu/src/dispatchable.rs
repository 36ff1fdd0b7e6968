//! The dispatchable form (Morris, 2014): constraints and waits that a dispatcher needs only look at from one executed
//! event to its neighbors, and never comes to a dead end.
//!
//! Each link is split where its end becomes uncertain: a point a fixed `lower` after the activation, and from there an
//! uncertain part. From each point that must come after another, back along edges that are not negative, every pair of
//! such an edge with a negative path is bypassed, until every shortest path of every projection is negative first and
//! then not (a *vee*). This decides controllability as well, by other means than `checker`.

use std::collections::BTreeMap;

use stn::Heap;

use crate::checker::{Stop, Undecided};
use crate::network::{Edge, LinkId, Network, PointId};

/// `point` must not happen before `link` ends or this long after its activation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Wait {
    /// The point that waits.
    pub point: PointId,
    /// For the end of which link.
    pub link: LinkId,
    /// How long after the link's activation at most.
    pub until: i64,
}

/// A network that can be dispatched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispatchable {
    /// The network that it was made from.
    pub network: Network,
    /// Its constraints and derived ones, one for each pair of points, by their ends.
    pub edges: Vec<Edge>,
    /// The waits, by point and link.
    pub waits: Vec<Wait>,
}

/// What an arc that is not negative is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Case {
    Ordinary,
    Lower(u32),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Visit {
    Not,
    Open,
    Done,
}

struct Reduction<'a> {
    network: &'a Network,
    /// By node, the arcs into it that are not negative: points first, then where the links' uncertain parts begin.
    rising: Vec<Vec<(u32, i64, Case)>>,
    /// By node, the negative arcs into it.
    falling: Vec<Vec<(u32, i64)>>,
    visits: Vec<Visit>,
    derived: Vec<(u32, u32, i64)>,
    waits: Vec<Wait>,
    distance: Vec<Option<i64>>,
    is_settled: Vec<bool>,
    touched: Vec<u32>,
    heap: Heap,
}

enum Outcome {
    Done,
    /// This node comes first.
    Needs(u32),
    NegativeCycle,
}

impl Dispatchable {
    /// The dispatchable form of a network, `None` if it is not dynamically controllable. `O(n³)` for `n` points.
    pub fn new(network: &Network, stop: Stop<'_>) -> Result<Option<Self>, Undecided> {
        let mut reduction = Reduction::new(network)?;
        for node in 0..reduction.rising.len() as u32 {
            if !reduction.visit(node, stop)? {
                return Ok(None);
            }
        }
        Ok(Some(reduction.finish()?))
    }
}

impl<'a> Reduction<'a> {
    fn new(network: &'a Network) -> Result<Self, Undecided> {
        let nodes = network.num_points() + network.links().len();
        let mut reduction = Self {
            network,
            rising: vec![Vec::new(); nodes],
            falling: vec![Vec::new(); nodes],
            visits: vec![Visit::Not; nodes],
            derived: Vec::new(),
            waits: Vec::new(),
            distance: vec![None; nodes],
            is_settled: vec![false; nodes],
            touched: Vec::new(),
            heap: Heap::default(),
        };
        for edge in network.edges() {
            reduction.add(edge.from.0, edge.to.0, edge.weight);
        }
        for (id, link) in (0..).zip(network.links()) {
            let split = network.num_points() as u32 + id;
            reduction.add(link.activation.0, split, link.lower);
            reduction.add(split, link.activation.0, link.lower.checked_neg().ok_or(Undecided::Overflow)?);
            if link.spread() == 0 {
                reduction.add(split, link.end.0, 0);
                reduction.add(link.end.0, split, 0);
            } else {
                reduction.rising[link.end.index()].push((split, 0, Case::Lower(id)));
                // The upper case.
                reduction.falling[split as usize].push((link.end.0, -link.spread()));
            }
        }
        Ok(reduction)
    }

    fn add(&mut self, from: u32, to: u32, weight: i64) {
        if weight < 0 {
            self.falling[to as usize].push((from, weight));
        } else {
            self.rising[to as usize].push((from, weight, Case::Ordinary));
        }
    }

    /// Reduces all that ends at a node, after the nodes that this needs. Whether there is no negative cycle.
    fn visit(&mut self, node: u32, stop: Stop<'_>) -> Result<bool, Undecided> {
        if self.visits[node as usize] == Visit::Done {
            return Ok(true);
        }
        let mut stack = vec![node];
        self.visits[node as usize] = Visit::Open;
        while let Some(&node) = stack.last() {
            if stop() {
                return Err(Undecided::Stopped);
            }
            match self.reduce(node)? {
                Outcome::Done => {
                    self.visits[node as usize] = Visit::Done;
                    stack.pop();
                }
                Outcome::Needs(other) => {
                    self.visits[other as usize] = Visit::Open;
                    stack.push(other);
                }
                Outcome::NegativeCycle => return Ok(false),
            }
        }
        Ok(true)
    }

    /// The link whose upper case ends at a node.
    fn link_of(&self, node: u32) -> Option<u32> {
        let link = (node as usize).checked_sub(self.network.num_points())?;
        (self.network.links()[link].spread() > 0).then_some(link as u32)
    }

    fn reduce(&mut self, source: u32) -> Result<Outcome, Undecided> {
        for node in self.touched.drain(..) {
            self.distance[node as usize] = None;
            self.is_settled[node as usize] = false;
        }
        self.heap.clear();
        let link = self.link_of(source);
        let (first_derived, first_wait) = (self.derived.len(), self.waits.len());
        let mut rising = Vec::new();
        for at in 0..self.falling[source as usize].len() {
            let (from, weight) = self.falling[source as usize][at];
            self.relax(from, weight);
        }
        let outcome = loop {
            let Some((distance, node)) = self.heap.pop() else { break Outcome::Done };
            if std::mem::replace(&mut self.is_settled[node as usize], true) {
                continue;
            }
            if node == source {
                if distance < 0 {
                    break Outcome::NegativeCycle;
                }
                continue;
            }
            if distance >= 0 {
                rising.push((node, distance, Case::Ordinary));
                self.derived.push((node, source, distance));
                continue;
            }
            self.record(node, source, link, distance)?;
            if !self.falling[node as usize].is_empty() {
                match self.visits[node as usize] {
                    Visit::Done => {}
                    Visit::Open => break Outcome::NegativeCycle,
                    Visit::Not => break Outcome::Needs(node),
                }
            }
            for at in 0..self.rising[node as usize].len() {
                let (from, weight, case) = self.rising[node as usize][at];
                if link.is_some_and(|link| case == Case::Lower(link)) {
                    continue;
                }
                // A negative number and one that is not: no overflow.
                self.relax(from, distance + weight);
            }
        };
        if let Outcome::Done = outcome {
            self.rising[source as usize].extend(rising);
        } else {
            self.derived.truncate(first_derived);
            self.waits.truncate(first_wait);
        }
        Ok(outcome)
    }

    fn relax(&mut self, node: u32, distance: i64) {
        let known = &mut self.distance[node as usize];
        if known.is_none_or(|known| distance < known) {
            if known.is_none() {
                self.touched.push(node);
            }
            *known = Some(distance);
            self.heap.push(distance, node);
        }
    }

    /// Keeps a negative path: to a link's split it is a wait, unless it is the upper case itself.
    fn record(&mut self, node: u32, source: u32, link: Option<u32>, distance: i64) -> Result<(), Undecided> {
        let Some(link) = link else {
            self.derived.push((node, source, distance));
            return Ok(());
        };
        // Another link's split waits a fixed time after its activation, which has a wait of its own.
        if node == self.link(link).end || node >= self.network.num_points() as u32 {
            return Ok(());
        }
        let until = self.link(link).lower.checked_sub(distance).ok_or(Undecided::Overflow)?;
        self.waits.push(Wait { point: PointId(node), link: LinkId(link), until });
        // In any case for the shortest duration.
        self.derived.push((node, source, 0));
        Ok(())
    }

    fn link(&self, id: u32) -> Link {
        let link = &self.network.links()[id as usize];
        Link { end: link.end.0, activation: link.activation.0, lower: link.lower }
    }

    /// Back from splits to activations, one constraint for each pair.
    fn finish(mut self) -> Result<Dispatchable, Undecided> {
        let points = self.network.num_points() as u32;
        let mut best: BTreeMap<(u32, u32), i64> = BTreeMap::new();
        let edges = self.network.edges().iter().map(|edge| (edge.from.0, edge.to.0, edge.weight));
        for (mut from, mut to, mut weight) in edges.chain(std::mem::take(&mut self.derived)) {
            if to >= points {
                let link = self.link(to - points);
                weight = weight.checked_sub(link.lower).ok_or(Undecided::Overflow)?;
                to = link.activation;
            }
            if from >= points {
                let link = self.link(from - points);
                weight = weight.checked_add(link.lower).ok_or(Undecided::Overflow)?;
                from = link.activation;
            }
            if from != to {
                let known = best.entry((from, to)).or_insert(weight);
                *known = weight.min(*known);
            }
        }
        let edges = best.into_iter().map(|((from, to), weight)| Edge {
            from: PointId(from),
            to: PointId(to),
            weight,
        });
        let mut waits = self.waits;
        waits.sort_unstable();
        // The longest wait of a point for a link is the last one.
        waits.dedup_by(|later, earlier| {
            let is_same = (later.point, later.link) == (earlier.point, earlier.link);
            earlier.until = if is_same { later.until } else { earlier.until };
            is_same
        });
        Ok(Dispatchable { network: self.network.clone(), edges: edges.collect(), waits })
    }
}

/// What is needed of a link here.
struct Link {
    end: u32,
    activation: u32,
    lower: i64,
}
