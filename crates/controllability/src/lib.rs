//! Plans as simple temporal networks with uncertainty (SPEC 13.1): what a plan asks of the executive, and what it leaves
//! to the environment, with the way back from every constraint to the arc or precedence that it represents.
//!
//! Planner, executive and reviews share this one reading; whether a network is controllable is `stnu`'s to say. The
//! checker of plans has a reading of its own.

mod failing_run;

use exact::{Overflow, Scale};
use rmpl::program::Controllability;
use stnu::{Conflict, EdgeId, Link, LinkId, Part, PointId, StrongVerdict, Undecided, Verdict};
use tpn::{Arc, ArcId, Network, NodeId, Precedence};

pub use failing_run::{Broken, FailingRun, RunEvent, failing_run};

/// One side of an arc's bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// The least duration.
    Lower,
    /// The greatest duration.
    Upper,
}

/// What a constraint of the network represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// A bound of an arc; of one whose duration nature chooses, that nature may go as far as this bound.
    Arc(ArcId, Side),
    /// One of the precedences, by its place among them.
    Precedence(usize),
    /// That a contingent duration ends at the event where it ends: of two that end at one event, the later one has an
    /// end of its own, at the same instant.
    Tie(ArcId),
}

/// A plan's events as time points, with its constraints and contingent links in ticks. Ties are not constraints here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlanNetwork {
    pub network: stnu::Network,
    /// The ticks of its times.
    pub scale: Scale,
    /// The point of the start of everything.
    pub origin: PointId,
    points: Vec<Option<PointId>>,
    /// By point; none for an end of a link's own.
    nodes: Vec<Vec<NodeId>>,
    edges: Vec<Source>,
    links: Vec<ArcId>,
}

/// Why a plan does not withstand the environment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refutation {
    /// What it depends on, in order and without repeats. A contingent arc is there with the sides that nature goes to.
    pub sources: Vec<Source>,
    /// The semi-reducible negative cycle; `None` where the plan is only not strongly controllable.
    pub conflict: Option<Conflict>,
}

/// The network of the arcs in `selected_arcs` (indexed by arc) and of `precedences`, in ticks of `scale`, which must
/// count all of their times. The events are those that these arcs and precedences connect, and the start; those that
/// `[0,0]` ties to one instant are one point, and the environment's if one of them is (SPEC 13.1). Time is nearly
/// linear, but for chains of contingent durations, along which each one looks back.
///
/// Durations that the environment chooses are contingent links unless the mission reads them as ordinary
/// ([`Network::is_uncertain`]). A range that is none, and one without a greatest duration, are read as ordinary bounds.
pub fn plan_network(
    network: &Network,
    selected_arcs: &[bool],
    precedences: &[Precedence],
    scale: Scale,
) -> Result<PlanNetwork, Overflow> {
    let mut is_selected = vec![false; network.nodes.len()];
    is_selected[network.start.index()] = true;
    let arcs = || {
        let all = network.arcs.iter().enumerate().zip(selected_arcs);
        all.filter(|(_, is_selected)| **is_selected).map(|((index, arc), _)| (ArcId::from_index(index), arc))
    };
    for (_, arc) in arcs() {
        is_selected[arc.from.index()] = true;
        is_selected[arc.to.index()] = true;
    }
    for precedence in precedences {
        is_selected[precedence.earlier.index()] = true;
        is_selected[precedence.later.index()] = true;
    }
    let first = network.instants(arcs().map(|(_, arc)| arc).filter(|arc| arc.is_tie()));
    let mut points = vec![None; network.nodes.len()];
    let mut nodes: Vec<Vec<NodeId>> = Vec::new();
    for index in (0..is_selected.len()).filter(|&index| is_selected[index]) {
        // The first of those at one instant comes first, and is selected if one of them is.
        let point = *points[first[index].index()].get_or_insert(PointId(nodes.len() as u32));
        points[index] = Some(point);
        match nodes.get_mut(point.index()) {
            Some(at_once) => at_once.push(NodeId::from_index(index)),
            None => nodes.push(vec![NodeId::from_index(index)]),
        }
    }
    let mut made = PlanNetwork {
        network: stnu::Network::new(nodes.len()),
        scale,
        // The start is selected.
        origin: points[network.start.index()].unwrap_or(PointId(0)),
        points,
        nodes,
        edges: Vec::new(),
        links: Vec::new(),
    };
    for (id, arc) in arcs() {
        made.add_arc(id, arc, network.is_uncertain(id))?;
    }
    for (place, precedence) in precedences.iter().enumerate() {
        made.at_least(
            precedence.earlier,
            precedence.later,
            scale.ticks(precedence.least)?,
            Source::Precedence(place),
        )?;
    }
    Ok(made)
}

/// The coarsest ticks that count all bounds of a network and its gap.
pub fn scale(network: &Network) -> Result<Scale, Overflow> {
    let uppers = network.arcs.iter().filter_map(|arc| arc.upper.finite());
    let lowers = network.arcs.iter().map(|arc| arc.lower);
    Scale::common(lowers.chain(uppers).chain([network.threat_gap]))
}

impl PlanNetwork {
    fn add_arc(&mut self, id: ArcId, arc: &Arc, is_uncertain: bool) -> Result<(), Overflow> {
        let lower = self.scale.ticks(arc.lower)?;
        let upper = self.scale.bound_ticks(arc.upper)?;
        if let Some(upper) = upper
            && is_uncertain
            && lower >= 0
            && lower <= upper
        {
            self.add_link(id, arc, lower, upper);
            return Ok(());
        }
        self.at_least(arc.from, arc.to, lower, Source::Arc(id, Side::Lower))?;
        if let Some(upper) = upper {
            self.add_edge(
                self.point_of(arc.from),
                self.point_of(arc.to),
                upper,
                Source::Arc(id, Side::Upper),
            );
        }
        Ok(())
    }

    fn add_link(&mut self, id: ArcId, arc: &Arc, lower: i64, upper: i64) {
        let (activation, end) = (self.point_of(arc.from), self.point_of(arc.to));
        self.links.push(id);
        if self.network.add_link(Link { activation, end, lower, upper }).is_ok() {
            return;
        }
        // Another one ends there already.
        let own = self.network.add_point();
        self.nodes.push(Vec::new());
        // Its range was looked at, and its end is new.
        let added = self.network.add_link(Link { activation, end: own, lower, upper });
        debug_assert!(added.is_ok(), "a link with an end of its own");
        self.add_edge(own, end, 0, Source::Tie(id));
        self.add_edge(end, own, 0, Source::Tie(id));
    }

    /// `later − earlier ≥ least`.
    fn at_least(
        &mut self,
        earlier: NodeId,
        later: NodeId,
        least: i64,
        source: Source,
    ) -> Result<(), Overflow> {
        let weight = least.checked_neg().ok_or(Overflow)?;
        self.add_edge(self.point_of(later), self.point_of(earlier), weight, source);
        Ok(())
    }

    fn add_edge(&mut self, from: PointId, to: PointId, weight: i64, source: Source) {
        // Between events at one instant only what contradicts it says anything.
        if from == to && weight >= 0 {
            return;
        }
        self.network.add_edge(from, to, weight);
        self.edges.push(source);
    }

    /// The point of an event that is known to have one.
    fn point_of(&self, node: NodeId) -> PointId {
        self.point(node).unwrap_or(self.origin)
    }

    /// The point of an event, if it is one of the network's.
    pub fn point(&self, node: NodeId) -> Option<PointId> {
        self.points.get(node.index()).copied().flatten()
    }

    /// The events of a point, all at one instant, in their order; none for an end that a contingent duration has of its
    /// own.
    pub fn nodes(&self, point: PointId) -> &[NodeId] {
        &self.nodes[point.index()]
    }

    /// The arc whose duration a link is.
    pub fn arc(&self, link: LinkId) -> ArcId {
        self.links[link.index()]
    }

    /// The link of an arc whose duration the environment chooses.
    pub fn link(&self, arc: ArcId) -> Option<LinkId> {
        self.links.iter().position(|&of| of == arc).map(|index| LinkId(index as u32))
    }

    /// Returns whether the environment chooses nothing.
    pub const fn is_certain(&self) -> bool {
        self.links.is_empty()
    }

    /// Returns what a part of a conflict represents.
    pub fn source(&self, part: Part) -> Source {
        match part {
            Part::Edge(id) => self.edges[id.index()],
            Part::Lower(id) => Source::Arc(self.arc(id), Side::Lower),
            Part::Upper(id) => Source::Arc(self.arc(id), Side::Upper),
        }
    }

    /// Returns what a cycle of constraints represents, in order and without repeats.
    pub fn sources(&self, parts: impl IntoIterator<Item = Part>) -> Vec<Source> {
        let mut sources: Vec<Source> = parts.into_iter().map(|part| self.source(part)).collect();
        sources.sort_unstable();
        sources.dedup();
        sources
    }

    /// Returns why the plan does not withstand the environment as far as the mission asks, if it does not; time as
    /// `stnu` takes it.
    pub fn refute(
        &self,
        asked: Controllability,
        stop: stnu::Stop<'_>,
    ) -> Result<Option<Refutation>, Undecided> {
        if asked == Controllability::Strong {
            let StrongVerdict::Uncontrollable(edges) = stnu::check_strong(&self.network)? else {
                return Ok(None);
            };
            let sources = self.sources(edges.into_iter().flat_map(|edge| self.worst_case(edge)));
            return Ok(Some(Refutation { sources, conflict: None }));
        }
        match stnu::check(&self.network, stop)? {
            Verdict::Controllable => Ok(None),
            Verdict::Uncontrollable(conflict) => {
                let sources = self.sources(conflict.members.iter().map(|member| member.part));
                Ok(Some(Refutation { sources, conflict: Some(conflict) }))
            }
        }
    }

    /// A constraint with the durations that are worst for it: those before its ends but for what both follow.
    fn worst_case(&self, edge: EdgeId) -> Vec<Part> {
        let (from, to) = (self.network.edge(edge).from, self.network.edge(edge).to);
        let (mut before_from, mut before_to) = (self.links_before(from), self.links_before(to));
        while before_from.last().is_some() && before_from.last() == before_to.last() {
            before_from.pop();
            before_to.pop();
        }
        let shortest = before_from.into_iter().map(Part::Lower);
        let longest = before_to.into_iter().map(Part::Upper);
        std::iter::once(Part::Edge(edge)).chain(shortest).chain(longest).collect()
    }

    /// The links whose durations lie before a point of the environment's, the latest first.
    fn links_before(&self, point: PointId) -> Vec<LinkId> {
        let ending = |point| self.network.link_ending_at(point);
        std::iter::successors(ending(point), |&link| ending(self.network.link(link).activation)).collect()
    }
}
