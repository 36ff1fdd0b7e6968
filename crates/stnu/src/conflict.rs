//! Why a network is not controllable: a semi-reducible negative cycle in terms of the original constraints.
//!
//! Every derived edge keeps the path that it represents, so that a cycle unfolds into what it depends on (Bhargava,
//! Vaquero and Williams, 2017). Such cycles can be exponentially long; multiplicities are counted without unfolding
//! them.

use std::collections::BTreeMap;

use crate::checker::{Stop, Undecided, Verdict, check, path};
use crate::graph::{Graph, Origin};
use crate::network::{Edge, EdgeId, LinkId, Network, PointId};
use crate::reduction::Node;

/// One thing that a conflict depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Part {
    /// An ordinary constraint.
    Edge(EdgeId),
    /// That the environment may be as quick as a link's lower bound: an edge from activation to end of that weight.
    Lower(LinkId),
    /// That nature may take as long as a link's upper bound: an edge from end to activation of that weight, negated.
    Upper(LinkId),
}

/// A part and how often the cycle goes along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    pub part: Part,
    /// How often, at most [`u64::MAX`].
    pub multiplicity: u64,
}

/// One edge of the cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Where it starts.
    pub from: PointId,
    /// Where it ends: where the next one starts.
    pub to: PointId,
    /// What it adds to the cycle's weight.
    pub weight: i64,
    /// What it represents.
    pub part: Part,
}

/// A semi-reducible negative cycle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// What it depends on, in the order of parts.
    pub members: Vec<Member>,
    /// The cycle edge by edge; `None` if it has more than [`MAX_STEPS`].
    pub cycle: Option<Vec<Step>>,
    /// By how much the cycle's weight is below 0, at most [`i64::MAX`].
    pub deficit: i64,
}

/// The longest cycle that is told edge by edge.
pub const MAX_STEPS: usize = 10_000;

/// A part of a cycle before it is unfolded.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CyclePart {
    Arc(u32),
    /// The upper case of a link.
    Upper(u32),
}

impl Conflict {
    /// Returns how often the cycle goes along a part.
    pub fn multiplicity(&self, part: Part) -> u64 {
        self.members.iter().find(|member| member.part == part).map_or(0, |member| member.multiplicity)
    }
}

/// The edge that a part is in the distance graph.
pub fn part_edge(network: &Network, part: Part) -> Edge {
    match part {
        Part::Edge(id) => *network.edge(id),
        Part::Lower(id) => {
            let link = network.link(id);
            Edge { from: link.activation, to: link.end, weight: link.lower }
        }
        Part::Upper(id) => {
            let link = network.link(id);
            Edge { from: link.end, to: link.activation, weight: -link.upper }
        }
    }
}

/// Unfolds a cycle into original parts.
///
/// The constraint of a point that waits at least for a link's shortest duration unfolds into its path and the link's
/// upper case as well: that is less than the constraint's weight, so that the cycle only becomes more negative.
pub(crate) fn unfold(network: &Network, graph: &Graph, nodes: &[Node], cycle: &[CyclePart]) -> Conflict {
    let members = count(graph, nodes, cycle);
    let weight = members.iter().fold(0_i128, |sum, member| {
        let weight = i128::from(part_edge(network, member.part).weight);
        sum.saturating_add(weight.saturating_mul(i128::from(member.multiplicity)))
    });
    let deficit = i64::try_from(weight.saturating_neg()).unwrap_or(i64::MAX);
    Conflict { members, cycle: steps(network, graph, nodes, cycle), deficit }
}

/// Derived arcs represent earlier ones only, so that counting goes from the latest to the earliest.
fn count(graph: &Graph, nodes: &[Node], cycle: &[CyclePart]) -> Vec<Member> {
    let mut arcs: BTreeMap<u32, u64> = BTreeMap::new();
    let mut parts: BTreeMap<Part, u64> = BTreeMap::new();
    let add = |count: &mut u64, by: u64| *count = count.saturating_add(by);
    for part in cycle {
        match *part {
            CyclePart::Arc(arc) => add(arcs.entry(arc).or_default(), 1),
            CyclePart::Upper(link) => add(parts.entry(Part::Upper(LinkId(link))).or_default(), 1),
        }
    }
    while let Some((arc, times)) = arcs.pop_last() {
        match graph.origin(arc) {
            Origin::Edge(id) => add(parts.entry(Part::Edge(EdgeId(id))).or_default(), times),
            Origin::Lower(id) => add(parts.entry(Part::Lower(LinkId(id))).or_default(), times),
            Origin::Bypass { link, node } => {
                add(parts.entry(Part::Upper(LinkId(link))).or_default(), times);
                for earlier in path(nodes, node) {
                    add(arcs.entry(earlier).or_default(), times);
                }
            }
        }
    }
    parts.into_iter().map(|(part, multiplicity)| Member { part, multiplicity }).collect()
}

fn steps(network: &Network, graph: &Graph, nodes: &[Node], cycle: &[CyclePart]) -> Option<Vec<Step>> {
    let mut steps = Vec::new();
    let mut open: Vec<CyclePart> = cycle.iter().rev().copied().collect();
    while let Some(part) = open.pop() {
        if steps.len() == MAX_STEPS {
            return None;
        }
        let part = match part {
            CyclePart::Upper(link) => Part::Upper(LinkId(link)),
            CyclePart::Arc(arc) => match graph.origin(arc) {
                Origin::Edge(id) => Part::Edge(EdgeId(id)),
                Origin::Lower(id) => Part::Lower(LinkId(id)),
                Origin::Bypass { link, node } => {
                    open.push(CyclePart::Upper(link));
                    let first = open.len();
                    open.extend(path(nodes, node).map(CyclePart::Arc));
                    open[first..].reverse();
                    continue;
                }
            },
        };
        let edge = part_edge(network, part);
        steps.push(Step { from: edge.from, to: edge.to, weight: edge.weight, part });
    }
    Some(steps)
}

/// A network of some parts of another: a link with one side only is an ordinary edge.
struct PartNetwork {
    network: Network,
    edges: Vec<Part>,
    links: Vec<LinkId>,
}

impl PartNetwork {
    fn new(of: &Network, parts: &[Part]) -> Self {
        let mut points: Vec<PointId> = parts
            .iter()
            .flat_map(|&part| {
                let edge = part_edge(of, part);
                [edge.from, edge.to]
            })
            .collect();
        points.sort_unstable();
        points.dedup();
        let place = |point: PointId| PointId(points.binary_search(&point).map_or(0, |at| at as u32));
        let mut network = Network::new(points.len());
        let (mut edges, mut links) = (Vec::new(), Vec::new());
        for &part in parts {
            let other = match part {
                Part::Edge(_) => None,
                Part::Lower(id) => Some(Part::Upper(id)),
                Part::Upper(id) => Some(Part::Lower(id)),
            };
            if other.is_none_or(|other| parts.binary_search(&other).is_err()) {
                let edge = part_edge(of, part);
                network.add_edge(place(edge.from), place(edge.to), edge.weight);
                edges.push(part);
            } else if let Part::Lower(id) = part {
                let mut link = *of.link(id);
                (link.activation, link.end) = (place(link.activation), place(link.end));
                // A link of a network is a link of any part of it.
                if network.add_link(link).is_ok() {
                    links.push(id);
                }
            }
        }
        Self { network, edges, links }
    }

    /// The part of the other network that a part of this one is.
    fn original(&self, part: Part) -> Part {
        match part {
            Part::Edge(id) => self.edges[id.index()],
            Part::Lower(id) => Part::Lower(self.links[id.index()]),
            Part::Upper(id) => Part::Upper(self.links[id.index()]),
        }
    }

    fn conflict(&self, of: &Network, stop: Stop<'_>) -> Result<Option<Conflict>, Undecided> {
        let Verdict::Uncontrollable(mut conflict) = check(&self.network, stop)? else { return Ok(None) };
        for member in &mut conflict.members {
            member.part = self.original(member.part);
        }
        conflict.members.sort_unstable_by_key(|member| member.part);
        for step in conflict.cycle.iter_mut().flatten() {
            step.part = self.original(step.part);
            let edge = part_edge(of, step.part);
            (step.from, step.to) = (edge.from, edge.to);
        }
        Ok(Some(conflict))
    }
}

/// The conflict among some parts of a network, each link's sides for themselves, if there is one.
pub fn conflict_among(
    network: &Network,
    parts: &[Part],
    stop: Stop<'_>,
) -> Result<Option<Conflict>, Undecided> {
    let mut parts = parts.to_vec();
    parts.sort_unstable();
    parts.dedup();
    PartNetwork::new(network, &parts).conflict(network, stop)
}

/// A conflict among members of `conflict` that needs every one of its own: without any one part, the others are
/// controllable. Takes a check of the conflict's own network for each member.
pub fn minimal(network: &Network, conflict: &Conflict, stop: Stop<'_>) -> Result<Conflict, Undecided> {
    let mut best = conflict.clone();
    let mut parts: Vec<Part> = conflict.members.iter().map(|member| member.part).collect();
    let mut at = 0;
    while at < parts.len() {
        let removed = parts.remove(at);
        if let Some(smaller) = PartNetwork::new(network, &parts).conflict(network, stop)? {
            // All parts before `at` are in every conflict that is left.
            parts = smaller.members.iter().map(|member| member.part).collect();
            best = smaller;
        } else {
            parts.insert(at, removed);
            at += 1;
        }
    }
    Ok(best)
}
