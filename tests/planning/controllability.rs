//! The checker and the solver of networks with uncertainty, which share no code, agree on what the environment can break.

use acceptance::mission::network;
use controllability::{plan_network, scale};
use exact::{Bound, Time};
use rmpl::program::Controllability;
use stnu::generate::{Kind, Shape};
use stnu::{StrongVerdict, Verdict};
use tpn::generate::{Recipe, Rng, Tightness};
use tpn::{Arc, ArcId, ArcKind, Network, Node, NodeId, OccurrenceKind, Plan, Quality};
use verify::{Rule, check_plan};

/// Longer than anything in a generated network.
const FREE: i64 = 1 << 30;

/// A network of events without names, with a plan that selects everything.
fn as_plan(of: &stnu::Network) -> (Network, Plan) {
    let mut made = network("scenario S = { delay[0,0] }");
    made.nodes = vec![Node::default(); of.num_points()];
    made.arcs.clear();
    made.labels.clear();
    made.occurrences.clear();
    made.blocks.clear();
    made.root = None;
    made.start = NodeId(0);
    made.end = NodeId::from_index(of.num_points() - 1);
    // The start leads to everything, and says nothing about it.
    for point in 1..of.num_points() {
        add_arc(&mut made, 0, point, (-FREE, FREE), false);
    }
    for edge in of.edges() {
        add_arc(&mut made, edge.from.index(), edge.to.index(), (-FREE, edge.weight), false);
    }
    for link in of.links() {
        add_arc(&mut made, link.activation.index(), link.end.index(), (link.lower, link.upper), true);
    }
    let plan = Plan {
        choices: Vec::new(),
        selected_nodes: vec![true; made.nodes.len()],
        selected_arcs: vec![true; made.arcs.len()],
        causal_links: Vec::new(),
        conflict_order: Vec::new(),
        conflict_order_omitted: 0,
        state_order: Vec::new(),
        orderings_added: Vec::new(),
        uses_ordered: Vec::new(),
        levels: Vec::new(),
        quality: Quality::default(),
        windows: vec![None; made.nodes.len()],
    };
    (made, plan)
}

fn add_arc(network: &mut Network, from: usize, to: usize, (lower, upper): (i64, i64), is_contingent: bool) {
    let id = ArcId::from_index(network.arcs.len());
    network.arcs.push(Arc {
        from: NodeId::from_index(from),
        to: NodeId::from_index(to),
        lower: Time::from(lower),
        upper: Bound::Finite(Time::from(upper)),
        is_contingent,
        kind: ArcKind::Span,
        labels: Vec::new(),
        occurrence: None,
        choice: None,
        span: None,
    });
    network.nodes[from].out_arcs.push(id);
    network.nodes[to].in_arcs.push(id);
}

/// Returns whether nothing that can happen breaks the plan, whatever else is wrong with it.
fn is_kept(network: &Network, plan: &Plan) -> bool {
    let verdict = check_plan(network, plan);
    !verdict.violations.iter().any(|it| matches!(it.rule, Rule::Temporal | Rule::Controllability))
}

#[test]
fn networks_of_all_kinds_are_judged_alike() {
    for kind in [Kind::Workflow, Kind::JobShop, Kind::Tree, Kind::Scattered] {
        let (mut kept, mut broken, mut strong) = (0, 0, 0);
        for seed in 0..120_u64 {
            let slack_percent = [-50, -25, -10, 6][seed as usize % 4];
            let points = 20 + seed as usize % 5 * 20;
            let shape = Shape { kind, points, links: points / 5, slack_percent };
            let uncertain = stnu::generate::network(shape, seed);
            let (mut network, plan) = as_plan(&uncertain);
            let verdict = stnu::check(&uncertain, &mut || false).expect("small times");
            let is_controllable = verdict == Verdict::Controllable;
            assert_eq!(is_kept(&network, &plan), is_controllable, "{kind:?} {seed}");
            *(if is_controllable { &mut kept } else { &mut broken }) += 1;
            network.controllability = Controllability::Strong;
            let verdict = stnu::check_strong(&uncertain).expect("small times");
            let is_strong = matches!(verdict, StrongVerdict::Controllable(_));
            assert_eq!(is_kept(&network, &plan), is_strong, "{kind:?} {seed}");
            strong += i32::from(is_strong);
        }
        assert!(kept > 10 && broken > 10, "{kind:?}: {kept} kept, {broken} broken, {strong} by one schedule");
    }
}

#[test]
fn plans_are_read_alike() {
    let (mut kept, mut broken) = (0, 0);
    for seed in 0..200 {
        let source = tpn::generate::mission(Recipe { nodes: 40, tightness: Tightness::Feasible, seed });
        let mut network = network(&source);
        let outcome = kirk::plan(&network, &kirk::Options::default(), &mut kirk::Unlimited);
        let Some(plan) = outcome.plans.into_iter().next() else { continue };
        let mut rng = Rng::new(seed);
        for occurrence in network.occurrences.clone() {
            let is_duration = matches!(occurrence.kind, OccurrenceKind::Primitive | OccurrenceKind::Delay);
            if let Some(arc) = occurrence.arc.filter(|_| is_duration && rng.chance(15)) {
                let arc = &mut network.arcs[arc.index()];
                arc.is_contingent = arc.upper != Bound::Infinite;
            }
        }
        let made = plan_network(
            &network,
            &plan.selected_arcs,
            &plan.precedences(&network),
            scale(&network).expect("small times"),
        );
        let made = made.expect("small times");
        if made.is_certain() {
            continue;
        }
        for asked in [Controllability::Dynamic, Controllability::Strong] {
            network.controllability = asked;
            let refutation = made.refute(asked, &mut || false).expect("small times");
            assert_eq!(is_kept(&network, &plan), refutation.is_none(), "{asked:?} {seed}: {refutation:?}");
            *(if refutation.is_none() { &mut kept } else { &mut broken }) += 1;
        }
    }
    assert!(kept > 20 && broken > 20, "{kept} kept, {broken} broken");
}
