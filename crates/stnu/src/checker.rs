//! Dynamic controllability, incrementally and with undo.
//!
//! The algorithm is RUL⁻ in its faster form (Cairo, Hunsberger and Rizzi, 2018; Hunsberger and Posenato, 2022): per
//! contingent link one search back from its end (`reduction`), which yields ordinary edges that bypass its upper case,
//! where a link whose activation the search meets comes first. Such waiting in a cycle is a semi-reducible negative
//! cycle, as is a negative cycle of ordinary and lower-case edges; without either the network is dynamically
//! controllable with instantaneous reaction. `O(mn + k²n + kn log n)` for `n` points, `m` edges and `k` links.
//!
//! What the searches found is kept. An insertion repeats only those that it can change, and undo brings back the
//! earlier ones. A network without contingent links costs what an incremental STN costs.

use std::fmt;

use stn::Inconsistency;

use crate::conflict::{self, Conflict, CyclePart};
use crate::graph::{Graph, Origin};
use crate::network::{Edge, Link, LinkError, LinkId, Network, NetworkSize, PointId};
use crate::reduction::{Found, NONE, Node, Search};

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Undecided {
    /// A time does not fit into 64 bits.
    Overflow,
    /// The caller stopped it.
    Stopped,
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Overflow => "a time is too large to represent exactly",
            Self::Stopped => "stopped",
        })
    }
}

impl std::error::Error for Undecided {}

/// Why something was not inserted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The network would not be controllable.
    Uncontrollable(Conflict),
    /// It is not a contingent link of this network.
    Link(LinkError),
    /// It is not known.
    Undecided(Undecided),
}

impl From<Undecided> for Refusal {
    fn from(reason: Undecided) -> Self {
        Self::Undecided(reason)
    }
}

/// The answer to [`check`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Whatever the environment chooses, execution can continue to the end.
    Controllable,
    /// It cannot, for this reason.
    Uncontrollable(Conflict),
}

/// Asked now and then: whether to give up.
pub type Stop<'a> = &'a mut dyn FnMut() -> bool;

/// Whether a network is dynamically controllable, from scratch.
pub fn check(network: &Network, stop: Stop<'_>) -> Result<Verdict, Undecided> {
    match Checker::build(network.clone(), stop) {
        // The links of a network are not refused.
        Ok(_) | Err(Refusal::Link(_)) => Ok(Verdict::Controllable),
        Err(Refusal::Uncontrollable(conflict)) => Ok(Verdict::Uncontrollable(conflict)),
        Err(Refusal::Undecided(reason)) => Err(reason),
    }
}

/// What the search back from a link's end found.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    /// The distance to the end, by point; points that are at least the link's spread away are its outside.
    pub(crate) reached: Vec<(u32, i64)>,
    /// The links whose activations are inside, and where the path from there starts; by link.
    pub(crate) awaited: Vec<(u32, u32)>,
    is_stale: bool,
}

impl Row {
    fn distance(&self, point: u32) -> Option<i64> {
        let at = self.reached.binary_search_by_key(&point, |&(point, _)| point).ok()?;
        Some(self.reached[at].1)
    }
}

/// A place to come back to with [`Checker::rollback`].
#[derive(Clone, Copy, Debug)]
pub struct Checkpoint {
    size: NetworkSize,
    arcs: stn::Checkpoint,
    nodes: usize,
    trail: usize,
}

/// How far an update has come with a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Visit {
    Not,
    /// It is under way: what it awaits comes first.
    Open,
    /// It is up to date, and so is everything that it awaits.
    Done,
}

/// A link being brought up to date.
struct Frame {
    link: u32,
    /// What the last search found to come first, each with where the path from its activation to the link's end starts.
    awaited: Vec<(u32, u32)>,
    /// How many of them have been looked at.
    seen: usize,
    /// The path from the activation of the one that was looked at last.
    met: u32,
}

/// A network that is dynamically controllable at all times.
#[derive(Clone, Debug, Default)]
pub struct Checker {
    network: Network,
    graph: Graph,
    rows: Vec<Row>,
    /// By point, the links that it activates.
    activated: Vec<Vec<u32>>,
    /// Paths, as a forest: each node's path goes along its arc and then its next node's path.
    nodes: Vec<Node>,
    /// Rows as they were before they were found again.
    trail: Vec<(u32, Row)>,
    search: Search,
    visits: Vec<Visit>,
}

impl Checker {
    /// A network of `points` time points without constraints.
    pub fn new(points: usize) -> Self {
        let mut checker = Self { network: Network::new(points), ..Self::default() };
        checker.graph.resize(points);
        checker.activated.resize(points, Vec::new());
        checker
    }

    /// Checks a network and keeps what is found for what is inserted later.
    pub fn build(network: Network, stop: Stop<'_>) -> Result<Self, Refusal> {
        let mut checker = Self::new(network.num_points());
        for (id, edge) in (0..).zip(network.edges()) {
            checker.graph.push(edge.from, edge.to, edge.weight, Origin::Edge(id));
        }
        for (id, link) in (0..).zip(network.links()) {
            checker.graph.push(link.activation, link.end, link.lower, Origin::Lower(id));
            checker.activated[link.activation.index()].push(id);
            checker.rows.push(Row { is_stale: true, ..Row::default() });
        }
        checker.network = network;
        if let Err(reason) = checker.graph.settle() {
            return Err(checker.refusal(reason));
        }
        checker.update(stop)?;
        Ok(checker)
    }

    /// The network so far.
    pub const fn network(&self) -> &Network {
        &self.network
    }

    /// A schedule that keeps all ordinary constraints if every contingent link is as short as it can be.
    pub fn schedule(&self) -> &[i64] {
        self.graph.potential()
    }

    /// A place to come back to.
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            size: self.network.size(),
            arcs: self.graph.checkpoint(),
            nodes: self.nodes.len(),
            trail: self.trail.len(),
        }
    }

    /// Takes back everything since `checkpoint`, in time linear in what changed since.
    pub fn rollback(&mut self, checkpoint: Checkpoint) {
        while self.trail.len() > checkpoint.trail {
            if let Some((link, row)) = self.trail.pop() {
                self.rows[link as usize] = row;
            }
        }
        while self.rows.len() > checkpoint.size.links {
            self.rows.pop();
            let link = self.network.links()[self.rows.len()];
            self.activated[link.activation.index()].pop();
        }
        // What is up to date at a checkpoint may only have been marked since.
        self.rows.iter_mut().for_each(|row| row.is_stale = false);
        self.graph.rollback(checkpoint.arcs);
        self.nodes.truncate(checkpoint.nodes);
        if checkpoint.size.points < self.network.num_points() {
            self.graph.resize(checkpoint.size.points);
            self.activated.truncate(checkpoint.size.points);
        }
        self.network.rollback(checkpoint.size);
    }

    /// Adds a time point.
    pub fn add_point(&mut self) -> PointId {
        let point = self.network.add_point();
        self.graph.resize(self.network.num_points());
        self.activated.push(Vec::new());
        point
    }

    /// Adds `edges`, or, if the network would not be controllable with them, none of them. The conflict names them by
    /// the ids that they would have had.
    pub fn insert(&mut self, edges: &[Edge], stop: Stop<'_>) -> Result<(), Refusal> {
        let checkpoint = self.checkpoint();
        let result = edges.iter().try_for_each(|&edge| {
            let id = self.network.add_edge(edge.from, edge.to, edge.weight);
            self.extend(edge, Origin::Edge(id.0))
        });
        let result = result.and_then(|()| self.update(stop));
        if result.is_err() {
            self.rollback(checkpoint);
        }
        result
    }

    /// Adds a contingent link, unless the network would not be controllable with it.
    pub fn insert_link(&mut self, link: Link, stop: Stop<'_>) -> Result<LinkId, Refusal> {
        let checkpoint = self.checkpoint();
        let id = self.network.add_link(link).map_err(Refusal::Link)?;
        self.rows.push(Row { is_stale: true, ..Row::default() });
        self.activated[link.activation.index()].push(id.0);
        for (row, other) in self.rows.iter_mut().zip(self.network.links()) {
            // What reaches the activation must from now on come after the new link.
            row.is_stale |= row.distance(link.activation.0).is_some_and(|distance| distance < other.spread());
        }
        let edge = Edge { from: link.activation, to: link.end, weight: link.lower };
        let result = self.extend(edge, Origin::Lower(id.0)).and_then(|()| self.update(stop));
        if result.is_err() {
            self.rollback(checkpoint);
        }
        result.map(|()| id)
    }

    /// Adds an arc, repairs the potential and marks the rows that it may change.
    fn extend(&mut self, edge: Edge, origin: Origin) -> Result<(), Refusal> {
        let inserted = self.graph.insert(edge.to, std::iter::once((edge.from, edge.weight, origin)));
        inserted.map_err(|reason| self.refusal(reason))?;
        for (row, link) in self.rows.iter_mut().zip(self.network.links()) {
            row.is_stale |= changes(row, link, edge.from.0, edge.to.0, edge.weight);
        }
        Ok(())
    }

    /// Brings all rows up to date.
    fn update(&mut self, stop: Stop<'_>) -> Result<(), Refusal> {
        self.visits.clear();
        self.visits.resize(self.rows.len(), Visit::Not);
        let is_stale = |&link: &u32, rows: &[Row]| rows[link as usize].is_stale;
        let mut stale: Vec<u32> =
            (0..self.rows.len() as u32).filter(|link| is_stale(link, &self.rows)).collect();
        // What a link awaits mostly begins after it, and is best there first.
        stale.sort_by_key(|&link| {
            std::cmp::Reverse(self.graph.potential()[self.network.links()[link as usize].activation.index()])
        });
        // A visit may outdate links that await the visited one; one that is done stays so.
        while !stale.is_empty() {
            for link in stale {
                if self.rows[link as usize].is_stale {
                    self.visit(link, stop)?;
                }
            }
            stale = (0..self.rows.len() as u32).filter(|link| is_stale(link, &self.rows)).collect();
        }
        Ok(())
    }

    /// Brings a link's row up to date, after those of all links that it awaits.
    fn visit(&mut self, link: u32, stop: Stop<'_>) -> Result<(), Refusal> {
        let mut stack = Vec::new();
        self.open(link, &mut stack);
        while let Some(frame) = stack.last_mut() {
            let frame: &mut Frame = frame;
            if let Some(&(awaited, met)) = frame.awaited.get(frame.seen) {
                frame.seen += 1;
                frame.met = met;
                match self.visits[awaited as usize] {
                    Visit::Done => {}
                    Visit::Open => return Err(self.cycle(&stack, awaited)),
                    Visit::Not => self.open(awaited, &mut stack),
                }
            } else if self.rows[frame.link as usize].is_stale {
                if stop() {
                    return Err(Undecided::Stopped.into());
                }
                let link = frame.link;
                frame.seen = 0;
                frame.awaited = self.search(link)?;
            } else {
                self.visits[frame.link as usize] = Visit::Done;
                stack.pop();
            }
        }
        Ok(())
    }

    fn open(&mut self, link: u32, stack: &mut Vec<Frame>) {
        self.visits[link as usize] = Visit::Open;
        let row = &self.rows[link as usize];
        let awaited = if row.is_stale { Vec::new() } else { row.awaited.clone() };
        stack.push(Frame { link, awaited, seen: 0, met: NONE });
    }

    /// Finds a link's row again and bypasses its upper case, or says which links come first and where the paths from their
    /// activations start.
    fn search(&mut self, link: u32) -> Result<Vec<(u32, u32)>, Refusal> {
        let is_done = |other: u32| self.visits[other as usize] == Visit::Done;
        let found = self.search.run(
            link,
            &self.network.links()[link as usize],
            &self.graph,
            &self.activated,
            &is_done,
            &mut self.nodes,
        );
        match found.ok_or(Undecided::Overflow)? {
            Found::Awaits(first) => return Ok(first),
            Found::Cycle(node) => {
                let mut cycle = self.path(node);
                cycle.push(CyclePart::Upper(link));
                return Err(self.conflict(&cycle));
            }
            Found::Done => {}
        }
        let mut row = Row::default();
        self.search.row(&mut row);
        let old = std::mem::replace(&mut self.rows[link as usize], row);
        self.trail.push((link, Row { is_stale: false, ..old }));
        self.search.leave_out_known(&self.network.links()[link as usize], &self.graph);

        let activation = self.network.links()[link as usize].activation;
        let bypasses = &self.search.bypasses;
        let arcs = bypasses
            .iter()
            .map(|&(point, weight, node)| (PointId(point), weight, Origin::Bypass { link, node }));
        let inserted = self.graph.insert(activation, arcs);
        inserted.map_err(|reason| self.refusal(reason))?;
        for other in 0..self.rows.len() {
            let row = &mut self.rows[other];
            if row.is_stale || row.awaited.binary_search_by_key(&link, |&(awaited, _)| awaited).is_err() {
                continue;
            }
            let of = &self.network.links()[other];
            row.is_stale =
                bypasses.iter().any(|&(point, weight, _)| changes(row, of, point, activation.0, weight));
        }
        Ok(Vec::new())
    }

    /// Links that await each other, the last of `stack` awaiting `awaited` further down.
    fn cycle(&self, stack: &[Frame], awaited: u32) -> Refusal {
        let mut cycle = Vec::new();
        for frame in stack.iter().rev() {
            cycle.extend(self.path(frame.met));
            cycle.push(CyclePart::Upper(frame.link));
            if frame.link == awaited {
                break;
            }
        }
        self.conflict(&cycle)
    }

    fn path(&self, node: u32) -> Vec<CyclePart> {
        path(&self.nodes, node).map(CyclePart::Arc).collect()
    }

    fn refusal(&self, reason: Inconsistency) -> Refusal {
        match reason {
            Inconsistency::NegativeCycle => {
                self.conflict(&self.graph.negative_cycle().map(CyclePart::Arc).collect::<Vec<_>>())
            }
            Inconsistency::Overflow(_) => Undecided::Overflow.into(),
        }
    }

    fn conflict(&self, cycle: &[CyclePart]) -> Refusal {
        Refusal::Uncontrollable(conflict::unfold(&self.network, &self.graph, &self.nodes, cycle))
    }
}

/// The arcs of the path that starts at a node.
pub(crate) fn path(nodes: &[Node], mut node: u32) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let Node { arc, next } = *nodes.get(node as usize)?;
        node = next;
        Some(arc)
    })
}

/// Returns whether an arc makes a point come closer to a link's end.
fn changes(row: &Row, link: &Link, from: u32, to: u32, weight: i64) -> bool {
    match row.distance(to) {
        Some(distance) if distance < link.spread() => {
            // What overflows is found by the search.
            row.distance(from).is_none_or(|old| distance.checked_add(weight).is_none_or(|new| new < old))
        }
        _ => false,
    }
}
