//! Drawings of networks that come without a program: their structure is found again, or they are drawn in columns.

use crate::drawings::{
    assert_nothing_overlaps, crossings, draw, enroute, network_of, random_mission, without_blocks,
};
use exact::{Bound, Time};
use layout::{NetworkDrawing, Route};
use tpn::generate::{Recipe, Rng, Tightness, mission};
use tpn::{Arc, ArcId, ArcKind, Network, Node, NodeId, Role};

/// A network of bare nodes and arcs; arcs are (from, to, kind). Node 0 is the start, the last one the end.
fn bare(node_count: usize, arcs: &[(u32, u32, ArcKind)]) -> Network {
    let role = Role::Event;
    let mut nodes = vec![Node { role, ..Node::default() }; node_count];
    let arcs = arcs.iter().enumerate().map(|(at, &(from, to, kind))| {
        nodes[from as usize].out_arcs.push(ArcId::from_index(at));
        nodes[to as usize].in_arcs.push(ArcId::from_index(at));
        let lower = Time::from(at as i64);
        let upper = Bound::Finite(Time::from(10 * at as i64));
        Arc::bare(NodeId(from), NodeId(to), (lower, upper), kind)
    });
    let arcs = arcs.collect();
    Network {
        nodes,
        arcs,
        labels: Vec::new(),
        decisions: Vec::new(),
        occurrences: Vec::new(),
        variables: Vec::new(),
        resources: Vec::new(),
        uses: Vec::new(),
        worths: Vec::new(),
        sights: Vec::new(),
        objective: Vec::new(),
        departures: Vec::new(),
        distances: Vec::new(),
        blocks: Vec::new(),
        root: None,
        start: NodeId(0),
        end: NodeId(node_count as u32 - 1),
        threat_gap: Time::ONE,
        controllability: rmpl::program::Controllability::default(),
        exchangeable: tpn::exchange::Exchangeable::default(),
        names: tpn::call_names::NamesOnDemand::default(),
    }
}

fn assert_complete(drawing: &NetworkDrawing, network: &Network, what: &str) {
    assert_eq!(drawing.nodes.len(), network.nodes.len(), "{what}: nodes");
    assert_eq!(drawing.arcs.len(), network.arcs.len(), "{what}: arcs");
}

#[test]
fn a_program_s_structure_is_found_again_in_its_graph() {
    for seed in 0..40 {
        let network = without_blocks(network_of(&random_mission(seed, 60)));
        let drawing = draw(&network);
        let what = format!("seed {seed}");
        assert_complete(&drawing, &network, &what);
        assert_nothing_overlaps(&drawing, &what);
        assert_eq!(crossings(&drawing), 0, "{what}");
        assert!(drawing.arcs.iter().all(|arc| arc.route != Route::Across), "{what}");
    }
}

#[test]
fn recovered_structure_looks_like_the_program_s() {
    let network = enroute();
    let (with, without) = (draw(&network), draw(&without_blocks(network.clone())));
    let rows = |drawing: &NetworkDrawing| {
        let mut order: Vec<_> = drawing.nodes.iter().map(|node| (node.center.x as i64, node.id)).collect();
        order.sort_unstable();
        order.into_iter().map(|(_, id)| id).collect::<Vec<_>>()
    };
    assert_eq!(rows(&with), rows(&without), "the events follow each other in the same order");
    let arches =
        |drawing: &NetworkDrawing| drawing.arcs.iter().filter(|arc| arc.route == Route::Arch).count();
    assert_eq!(arches(&with), arches(&without));
}

#[test]
fn generated_missions_of_some_size_need_no_crossings_without_their_program() {
    for seed in 0..4 {
        let recipe = Recipe { nodes: 400, tightness: Tightness::Feasible, seed };
        let network = without_blocks(network_of(&mission(recipe)));
        let drawing = draw(&network);
        assert_complete(&drawing, &network, "generated");
        assert_eq!(crossings(&drawing), 0, "seed {seed}");
        assert_nothing_overlaps(&drawing, "generated");
    }
}

#[test]
fn a_graph_that_is_neither_series_nor_parallel_is_drawn_in_columns() {
    use ArcKind::Activity as A;
    // The smallest such graph, with a bridge from one branch to the other.
    let network = bare(4, &[(0, 1, A), (0, 2, A), (1, 2, A), (1, 3, A), (2, 3, A)]);
    let drawing = draw(&network);
    assert_complete(&drawing, &network, "bridge");
    assert_nothing_overlaps(&drawing, "bridge");
    assert_eq!(crossings(&drawing), 0);
    for arc in &network.arcs {
        assert!(drawing.anchor(arc.from).x < drawing.anchor(arc.to).x, "time flows to the right");
    }
}

#[test]
fn a_bound_between_branches_does_not_spoil_the_structure_around_it() {
    use ArcKind::{Activity as A, Span as S};
    let network = bare(6, &[(0, 1, A), (1, 2, A), (2, 5, A), (0, 3, A), (3, 4, A), (4, 5, A), (1, 4, S)]);
    let drawing = draw(&network);
    assert_complete(&drawing, &network, "bound");
    assert_nothing_overlaps(&drawing, "bound");
    let across: Vec<_> =
        drawing.arcs.iter().filter(|arc| arc.route == Route::Across).map(|arc| arc.id).collect();
    assert_eq!(across, [ArcId(6)]);
    assert_eq!(drawing.anchor(NodeId(1)).y, drawing.anchor(NodeId(2)).y, "branches stay on their lines");
}

#[test]
fn any_graph_is_drawn_with_nothing_over_anything_else() {
    for seed in 0..60 {
        let mut rng = Rng::new(seed);
        let node_count = 2 + rng.below(25) as usize;
        let arc_count = rng.below(40);
        let kinds = [ArcKind::Activity, ArcKind::Span, ArcKind::Glue];
        let arcs = (0..arc_count).map(|_| {
            let ends = (rng.below(node_count as u64) as u32, rng.below(node_count as u64) as u32);
            (ends.0, ends.1, kinds[rng.below(3) as usize])
        });
        let network = bare(node_count, &arcs.collect::<Vec<_>>());
        let drawing = draw(&network);
        assert_complete(&drawing, &network, &format!("seed {seed}"));
        assert_nothing_overlaps(&drawing, &format!("seed {seed}"));
    }
}

#[test]
fn a_long_chain_and_a_wide_bundle_are_recovered() {
    let chain: Vec<_> = (0..5000).map(|at| (at, at + 1, ArcKind::Activity)).collect();
    let network = bare(5001, &chain);
    let drawing = draw(&network);
    assert!(drawing.nodes.iter().all(|node| node.center.y == 0.0));
    let bundle: Vec<_> =
        (1..3000).flat_map(|at| [(0, at, ArcKind::Activity), (at, 3000, ArcKind::Activity)]).collect();
    let network = bare(3001, &bundle);
    let drawing = draw(&network);
    assert_complete(&drawing, &network, "bundle");
    assert_nothing_overlaps(&drawing, "bundle");
}
