//! Which part of a distance graph is drawn where no one could read the whole: the contradiction with what lies next to
//! it, or what lies around what is selected. A contradiction of too many bounds is drawn in stretches.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use exact::Time;
use tpn::NodeId;
use workbench::state::selection::node_name;

use super::graph::{DistanceGraph, Edge, Selected, Vertex, bounds};

/// Graphs with more vertices than this are drawn in part.
pub const MAX_VERTICES: usize = 60;
/// Of more events than this no graph is made, to find how many vertices it would have.
const MAX_EVENTS: usize = 2_000;
/// Events beside a contradiction that are drawn with it.
const BESIDE: usize = 12;

/// A graph, and how much of what is selected it shows.
pub struct Shown {
    pub graph: DistanceGraph,
    /// How many events it leaves out.
    pub left_out: usize,
    /// How many bounds each edge of a contradiction represents at most.
    pub stretch: usize,
}

/// The graph of all that is selected if it can be read, and otherwise of the part around the contradiction or the `seeds`.
pub fn shown(all: &Selected<'_>, seeds: &[NodeId]) -> Shown {
    if all.nodes.len() <= MAX_EVENTS {
        let graph = DistanceGraph::new(all);
        if graph.vertices.len() <= MAX_VERTICES {
            return Shown { graph, left_out: 0, stretch: 1 };
        }
    }
    if all.cycle.len() > MAX_VERTICES {
        return in_stretches(all);
    }
    let cycle: Vec<NodeId> = all.cycle.iter().map(|member| member.from).collect();
    let beginning = all.nodes.get(..1).unwrap_or_default();
    let is_here: BTreeSet<NodeId> = all.nodes.iter().copied().collect();
    let seeds: Vec<NodeId> = seeds.iter().copied().filter(|node| is_here.contains(node)).collect();
    let (seeds, mut most) = match (cycle.as_slice(), seeds.as_slice()) {
        ([], []) => (beginning, 2 * MAX_VERTICES),
        ([], seeds) => (seeds, 2 * MAX_VERTICES),
        (cycle, _) => (cycle, cycle.len() + BESIDE),
    };
    loop {
        let nodes = around(all, seeds, most);
        let graph = DistanceGraph::new(&Selected { nodes: &nodes, ..*all });
        if graph.vertices.len() <= MAX_VERTICES || most <= seeds.len() {
            return Shown { graph, left_out: all.nodes.len() - nodes.len(), stretch: 1 };
        }
        most = (most * 3 / 4).max(seeds.len());
    }
}

/// At most so many events, the seeds first, then what is next to them by a bound, and so on; in the order of the network.
fn around(all: &Selected<'_>, seeds: &[NodeId], most: usize) -> Vec<NodeId> {
    let is_here: BTreeSet<NodeId> = all.nodes.iter().copied().collect();
    let mut beside: BTreeMap<NodeId, Vec<NodeId>> = BTreeMap::new();
    for bound in bounds(all) {
        beside.entry(bound.from).or_default().push(bound.to);
        beside.entry(bound.to).or_default().push(bound.from);
    }
    let mut found: BTreeSet<NodeId> = BTreeSet::new();
    let mut waiting: VecDeque<NodeId> = seeds.iter().copied().collect();
    while let Some(node) = waiting.pop_front() {
        if found.len() >= most.max(seeds.len()) {
            break;
        }
        if is_here.contains(&node) && found.insert(node) {
            waiting.extend(beside.get(&node).into_iter().flatten());
        }
    }
    all.nodes.iter().copied().filter(|node| found.contains(node)).collect()
}

/// The contradiction alone: each edge represents so many bounds after each other that all of it can be read.
fn in_stretches(all: &Selected<'_>) -> Shown {
    let cycle = all.cycle;
    let stretch = cycle.len().div_ceil(MAX_VERTICES / 2);
    let parts: Vec<_> = cycle.chunks(stretch).collect();
    let vertex = |node: NodeId| Vertex { nodes: vec![node], names: vec![node_name(all.network, node)] };
    let vertices: Vec<Vertex> = parts.iter().filter_map(|part| Some(vertex(part.first()?.from))).collect();
    let edges = parts.iter().enumerate().filter_map(|(at, part)| {
        let weight = Time::checked_sum(part.iter().map(|member| member.weight))?;
        let constraint = part.first()?.constraint;
        Some(Edge { from: at, to: (at + 1) % parts.len(), weight, constraint, is_in_cycle: true })
    });
    let edges = edges.collect();
    let left_out = all.nodes.len().saturating_sub(vertices.len());
    Shown { graph: DistanceGraph { vertices, edges }, left_out, stretch }
}

#[cfg(test)]
mod tests {
    use kirk::{Event, Options, Unlimited};
    use rmpl::parse;
    use tpn::{Network, Plan, Top, compile};

    use super::*;
    use crate::distances::of_plan;

    fn network(text: &str) -> Network {
        let program = parse(text).program();
        compile(&program, &Top::Scenario(None)).0.expect("it compiles")
    }

    /// So many activities of 1 to 2 in a sequence, within a bound.
    fn sequence(count: usize, most: usize) -> String {
        let calls = vec!["A()"; count].join("; ");
        format!("primitive A()[1,2]; scenario S[0,{most}] = {{ {calls} }}")
    }

    #[test]
    fn a_large_plan_is_drawn_around_what_is_selected() {
        let network = network(&sequence(500, 1000));
        let outcome = kirk::plan(&network, &Options::default(), &mut Unlimited);
        let plan: &Plan = &outcome.plans[0];
        let (nodes, arcs) = of_plan(plan);
        let all = Selected { network: &network, nodes: &nodes, arcs: &arcs, plan, cycle: &[] };
        let middle = network.occurrences.iter().find(|it| it.name == "A#250").expect("it is there");
        for seeds in [vec![middle.start, middle.end], Vec::new()] {
            let Shown { graph, left_out, .. } = shown(&all, &seeds);
            assert!((20..=MAX_VERTICES).contains(&graph.vertices.len()), "{}", graph.vertices.len());
            assert!(left_out > 300 && graph.edges.len() > 20);
            let has = |node: &NodeId| graph.vertices.iter().any(|vertex| vertex.nodes.contains(node));
            assert!(seeds.iter().all(has), "what is selected is there");
        }
    }

    #[test]
    fn a_contradiction_of_any_length_is_drawn_with_all_of_its_sum() {
        // The whole must be over one minute sooner than its parts can be; 20, 100 and 1,500 bounds in a circle.
        for count in [20, 100, 1_500] {
            let network = network(&sequence(count, count - 1));
            let options = Options { trace_events: Some(1_000_000), ..Options::default() };
            let trace = kirk::plan(&network, &options, &mut Unlimited).trace.expect("it is recorded");
            let cycle = trace.events.iter().find_map(|entry| match &entry.event {
                Event::Inconsistent { cycle } => Some(cycle.clone()),
                _ => None,
            });
            let cycle = cycle.expect("it contradicts itself");
            let nodes: Vec<NodeId> = (0..network.nodes.len()).map(NodeId::from_index).collect();
            let arcs: Vec<tpn::ArcId> = (0..network.arcs.len()).map(tpn::ArcId::from_index).collect();
            // Nothing but the text's bounds is in force: a plan of the same text with more time has no more either.
            let relaxed = self::network(&sequence(count, 2 * count));
            let plan = &kirk::plan(&relaxed, &Options::default(), &mut Unlimited).plans[0];
            let all = Selected { network: &network, nodes: &nodes, arcs: &arcs, plan, cycle: &cycle };
            let Shown { graph, stretch, .. } = shown(&all, &[]);
            assert!(graph.vertices.len() <= MAX_VERTICES, "{count}: {}", graph.vertices.len());
            let edges = graph.edges.iter().filter(|edge| edge.is_in_cycle);
            let total = Time::checked_sum(edges.map(|edge| edge.weight)).expect("it fits");
            assert_eq!(total, Time::from(-1), "{count}: once around one comes back a minute too early");
            assert_eq!(stretch > 1, cycle.len() > MAX_VERTICES, "{count}");
        }
    }
}
