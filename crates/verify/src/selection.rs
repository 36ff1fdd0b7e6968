//! Which nodes and arcs a plan's choices select, computed from the closure rule of SPEC 3.1 alone.

use tpn::{ArcId, ArcKind, Network, NodeId, Plan, UseId};

use crate::{Rule, Verdict, Violation, node_name};

/// Checks sizes and ids, so that later checks can index; `Err` holds the verdict if they are wrong.
pub(crate) fn check_form(network: &Network, plan: &Plan) -> Result<(), Verdict> {
    let mut violations = Vec::new();
    let mut expect = |is_right: bool, message: &str| {
        if !is_right {
            violations.push(Violation::new(Rule::Form, message));
        }
    };
    expect(
        plan.selected_nodes.len() == network.nodes.len(),
        "the plan belongs to a different network: its nodes differ",
    );
    expect(
        plan.selected_arcs.len() == network.arcs.len(),
        "the plan belongs to a different network: its arcs differ",
    );
    expect(plan.windows.len() == network.nodes.len(), "the plan must have one window for each node");
    let orderings = plan.conflict_order.iter().chain(&plan.orderings_added);
    let labels = orderings.flat_map(|ordering| [ordering.first, ordering.then]);
    let labels = labels.chain(plan.causal_links.iter().flat_map(|link| [link.ask, link.tell]));
    let labels = labels.chain(plan.state_order.iter().flat_map(|order| order.producers.iter().copied()));
    expect(
        labels.into_iter().all(|label| label.index() < network.labels.len()),
        "the plan names an unknown interval",
    );
    expect(
        plan.choices.iter().all(|choice| choice.decision.index() < network.decisions.len()),
        "the plan names an unknown decision",
    );
    expect(
        plan.state_order.iter().all(|order| order.variable.index() < network.variables.len()),
        "the plan names an unknown variable",
    );
    let is_known_use = |used: UseId| used.index() < network.uses.len();
    expect(
        plan.uses_ordered.iter().all(|it| is_known_use(it.first) && is_known_use(it.then)),
        "the plan names an unknown use of a resource",
    );
    expect(
        network.uses.iter().all(|it| {
            it.resource.index() < network.resources.len()
                && it.arc.index() < network.arcs.len()
                && it.start.index().max(it.end.index()) < network.nodes.len()
        }) && network.worths.iter().all(|it| it.arc.index() < network.arcs.len()),
        "the network has a resource use or an objective with an unknown reference",
    );
    expect(
        network.departures.iter().all(|it| it.arrival.index() < network.labels.len()),
        "the network has a departure with an unknown reference",
    );
    if violations.is_empty() { Ok(()) } else { Err(Verdict::new(violations)) }
}

/// Compares the plan's selection with the closure of the start under its choices.
pub(crate) fn check_selection(network: &Network, plan: &Plan, violations: &mut Vec<Violation>) {
    let taken = choices(network, plan, violations);
    let mut nodes = vec![false; network.nodes.len()];
    let mut arcs = vec![false; network.arcs.len()];
    let mut open = vec![network.start];
    nodes[network.start.index()] = true;
    while let Some(node) = open.pop() {
        for arc in selected_out_arcs(network, node, &taken, violations) {
            arcs[arc.index()] = true;
            let to = network.arcs[arc.index()].to;
            if !std::mem::replace(&mut nodes[to.index()], true) {
                open.push(to);
            }
        }
    }
    for (index, arc) in network.arcs.iter().enumerate() {
        if arc.kind == ArcKind::Constraint {
            arcs[index] = nodes[arc.from.index()] && nodes[arc.to.index()];
        }
    }
    compare(network, plan, &nodes, &arcs, violations);
    if !nodes[network.end.index()] {
        let message = format!("the end {} is not selected", node_name(network, network.end));
        violations.push(Violation::new(Rule::Selection, message));
    }
    for (index, decision) in network.decisions.iter().enumerate() {
        if taken[index].is_some() && !nodes[decision.node.index()] {
            let name = Network::decision_name(tpn::DecisionId::from_index(index));
            let message = format!("the plan decides {name}, but never reaches it");
            violations.push(Violation::new(Rule::Selection, message));
        }
    }
    check_expansion(network, &arcs, violations);
}

fn choices(network: &Network, plan: &Plan, violations: &mut Vec<Violation>) -> Vec<Option<u32>> {
    let mut taken = vec![None; network.decisions.len()];
    for choice in &plan.choices {
        let name = Network::decision_name(choice.decision);
        if taken[choice.decision.index()].replace(choice.alternative).is_some() {
            violations.push(Violation::new(Rule::Selection, format!("the plan decides {name} twice")));
        }
        if choice.alternative as usize >= network.decisions[choice.decision.index()].alternatives.len() {
            let message = format!("{name} has no alternative {}", choice.alternative);
            violations.push(Violation::new(Rule::Selection, message));
        }
    }
    taken
}

fn selected_out_arcs(
    network: &Network,
    node: NodeId,
    taken: &[Option<u32>],
    violations: &mut Vec<Violation>,
) -> Vec<ArcId> {
    let out = &network.nodes[node.index()].out_arcs;
    let Some(decision) = network.nodes[node.index()].decision else { return out.clone() };
    let name = Network::decision_name(decision);
    let Some(alternative) = taken[decision.index()] else {
        violations.push(Violation::new(
            Rule::Selection,
            format!("the plan reaches {name}, but does not decide it"),
        ));
        return Vec::new();
    };
    let is_taken = |arc: &&ArcId| network.arcs[arc.index()].choice == Some((decision, alternative));
    out.iter().filter(is_taken).copied().collect()
}

fn compare(network: &Network, plan: &Plan, nodes: &[bool], arcs: &[bool], violations: &mut Vec<Violation>) {
    for (index, (&expected, &selected)) in nodes.iter().zip(&plan.selected_nodes).enumerate() {
        if expected != selected {
            let name = node_name(network, NodeId::from_index(index));
            let message = if expected {
                format!("{name} follows from the plan's choices, but is not selected")
            } else {
                format!("{name} is selected, but no selected arc leads to it")
            };
            violations.push(Violation::new(Rule::Selection, message).with_events(vec![name]));
        }
    }
    for (index, (&expected, &selected)) in arcs.iter().zip(&plan.selected_arcs).enumerate() {
        if expected != selected {
            let arc = &network.arcs[index];
            let events = vec![node_name(network, arc.from), node_name(network, arc.to)];
            let message = if expected {
                format!(
                    "the arc from {} to {} follows from the plan's choices, but is not selected",
                    events[0], events[1]
                )
            } else {
                format!(
                    "the arc from {} to {} is selected, but does not follow from the plan's choices",
                    events[0], events[1]
                )
            };
            violations.push(Violation::new(Rule::Selection, message).with_events(events));
        }
    }
}

/// Only primitives, assertions, delays and structure remain: below every selected activity instance there is its body.
fn check_expansion(network: &Network, arcs: &[bool], violations: &mut Vec<Violation>) {
    for (index, arc) in network.arcs.iter().enumerate() {
        if !arcs[index] || arc.kind != ArcKind::Composite {
            continue;
        }
        let has_body = network.nodes[arc.from.index()].out_arcs.iter().any(|&other| {
            other.index() != index
                && network.arcs[other.index()].kind != ArcKind::Composite
                && arcs[other.index()]
        });
        if !has_body {
            let name = node_name(network, arc.from);
            let message = format!("the activity that starts at {name} is not expanded");
            violations.push(Violation::new(Rule::Selection, message).with_events(vec![name]));
        }
    }
}
