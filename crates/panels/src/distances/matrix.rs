//! The distance matrix of the selected events: the least upper bound from each to each, by Floyd and Warshall.

use std::collections::BTreeMap;

use egui::RichText;
use exact::Bound;
use kirk::{Constraint, CycleMember};
use theme::{size, space};
use tpn::{ArcId, Network, NodeId, Plan, Precedence};
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::selection::node_name;

use crate::Context;

/// Larger networks are not shown as a matrix: nobody could read it.
const MAX_EVENTS: usize = 32;

/// What the matrix is made of.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    pub network: &'a Network,
    /// Selected events.
    pub nodes: &'a [NodeId],
    /// Selected constraints.
    pub arcs: &'a [ArcId],
    /// The plan, or what the step had of it.
    pub plan: &'a Plan,
    /// The contradiction, if there is one.
    pub cycle: &'a [CycleMember],
}

/// Shows the matrix.
pub fn show(ui: &mut egui::Ui, context: &Context<'_>, parts: &Parts<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let network = parts.network;
    let is_named = |node: &&NodeId| {
        network.nodes.get(node.index()).is_some_and(|node| {
            let is_point = |event: &tpn::EventRef| matches!(event.end, tpn::EventEnd::PathVertex { .. });
            !node.events.is_empty() && !node.events.iter().all(is_point)
        })
    };
    let named: Vec<NodeId> = parts.nodes.iter().filter(is_named).copied().collect();
    if named.is_empty() || named.len() > MAX_EVENTS {
        let text = format!("{} events are selected; a matrix shows up to {MAX_EVENTS}.", named.len());
        crate::show_empty(ui, context, &text);
        return;
    }
    let distances = distances(parts);
    let in_cycle: Vec<NodeId> = parts.cycle.iter().map(|member| member.from).collect();
    egui::ScrollArea::both().id_salt("distances").auto_shrink(false).show(ui, |ui| {
        ui.add_space(space::XS);
        if !parts.cycle.is_empty() {
            let text = "  Without the bound that closes the negative cycle: with it there are no shortest distances.";
            ui.label(RichText::new(text).small().color(tokens.text_muted));
        }
        egui::Grid::new("distance-matrix").striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
            theme::structure::part(ui, egui::accesskit::Role::Table, "Distances");
            let text = |text: String| RichText::new(text).monospace().size(size::SMALL);
            ui.label(text(" from \\ to".into()).color(tokens.text_muted));
            for (index, &node) in named.iter().enumerate() {
                ui.label(text(format!("{}", index + 1))).on_hover_text(node_name(network, node));
            }
            ui.end_row();
            for (index, &from) in named.iter().enumerate() {
                let is_selected = context.state.selection == Selection::Node(from);
                let color = match (in_cycle.contains(&from), is_selected) {
                    (true, _) => tokens.threat,
                    (_, true) => tokens.accent,
                    _ => tokens.text,
                };
                let name = text(format!("{:>2} {}", index + 1, node_name(network, from))).color(color);
                if ui.add(egui::Button::selectable(is_selected, name)).clicked() {
                    commands.send(Command::Select(Selection::Node(from)));
                }
                for &to in &named {
                    let distance = distances.get(&(from, to)).copied().unwrap_or(Bound::Infinite);
                    let color = match distance {
                        Bound::Infinite => tokens.text_faint,
                        Bound::Finite(_) if from == to => tokens.text_faint,
                        Bound::Finite(_) => tokens.text,
                    };
                    ui.label(text(workbench::time_text::short_bound(distance)).color(color));
                }
                ui.end_row();
            }
        });
    });
}

/// All distances between the selected nodes. Of a contradiction, the bound that closed it is left out.
fn distances(parts: &Parts<'_>) -> BTreeMap<(NodeId, NodeId), Bound> {
    let (network, nodes) = (parts.network, parts.nodes);
    let position: BTreeMap<NodeId, usize> =
        nodes.iter().enumerate().map(|(index, &node)| (node, index)).collect();
    let count = nodes.len();
    let mut matrix = vec![Bound::Infinite; count * count];
    for index in 0..count {
        matrix[index * count + index] = Bound::ZERO;
    }
    let mut shorten = |from: NodeId, to: NodeId, weight: Bound| {
        if let (Some(&from), Some(&to)) = (position.get(&from), position.get(&to)) {
            let entry = &mut matrix[from * count + to];
            *entry = (*entry).min(weight);
        }
    };
    let closing = closing(parts);
    for &id in parts.arcs {
        let Some(arc) = network.arcs.get(id.index()) else { continue };
        if closing != Some(Constraint::Upper(id)) {
            shorten(arc.from, arc.to, arc.upper);
        }
        if let Some(weight) = arc.lower.checked_neg().filter(|_| closing != Some(Constraint::Lower(id))) {
            shorten(arc.to, arc.from, Bound::Finite(weight));
        }
    }
    let links = parts.plan.causal_links.iter();
    let links = links.filter(|&&link| closing != Some(Constraint::Link(link)));
    let orders = parts.plan.orderings_added.iter();
    let orders = orders.filter(|&&order| closing != Some(Constraint::Order(order)));
    let natures = network.natures_events(&parts.plan.selected_arcs);
    let added = links
        .flat_map(|link| link.precedences(network))
        .chain(orders.map(|order| parts.plan.ordering_precedence(network, order, &natures)))
        .chain(parts.plan.uses_ordered.iter().map(|order| order.precedence(network)));
    for Precedence { earlier, later, least } in added {
        if let Some(weight) = least.checked_neg() {
            shorten(later, earlier, Bound::Finite(weight));
        }
    }
    for middle in 0..count {
        for from in 0..count {
            for to in 0..count {
                let through = matrix[from * count + middle].checked_add(matrix[middle * count + to]);
                if let Some(through) = through.filter(|&through| through < matrix[from * count + to]) {
                    matrix[from * count + to] = through;
                }
            }
        }
    }
    let mut distances = BTreeMap::new();
    for (from, &from_node) in nodes.iter().enumerate() {
        for (to, &to_node) in nodes.iter().enumerate() {
            distances.insert((from_node, to_node), matrix[from * count + to]);
        }
    }
    distances
}

/// The bound that was added last of those that contradict each other: the others are consistent by themselves.
fn closing(parts: &Parts<'_>) -> Option<Constraint> {
    let added = |constraint: &Constraint| match constraint {
        Constraint::Lower(arc) | Constraint::Upper(arc) => {
            (0, parts.arcs.iter().position(|it| it == arc).unwrap_or_default())
        }
        Constraint::Link(link) => {
            (1, parts.plan.causal_links.iter().position(|it| it == link).unwrap_or_default())
        }
        Constraint::Order(order) => {
            (2, parts.plan.orderings_added.iter().position(|it| it == order).unwrap_or_default())
        }
        Constraint::UseOrder(order) => {
            (3, parts.plan.uses_ordered.iter().position(|it| it == order).unwrap_or_default())
        }
        Constraint::Departure(_) => (0, 0),
    };
    parts.cycle.iter().map(|member| member.constraint).max_by_key(added)
}

#[cfg(test)]
mod tests {
    use exact::Time;

    use super::*;

    #[test]
    fn distances_of_a_finished_search_are_those_of_the_paper() {
        let source = include_str!("../../../../tests/conformance/t01_enroute_scenario.rmpl");
        let program = rmpl::parse(source).program();
        let network = tpn::compile(&program, &tpn::Top::Scenario(None)).0.expect("it compiles");
        let options = kirk::Options { trace_events: Some(10_000), ..kirk::Options::default() };
        let mut outcome = kirk::plan(&network, &options, &mut kirk::Unlimited);
        let trace = outcome.trace.take().expect("it was recorded");
        let solution =
            trace.events.iter().position(|entry| matches!(entry.event, kirk::Event::Solution { .. }));
        let replay = kirk::Replay::new(&network, None, &trace).expect("its times fit");
        let step = replay.at(&trace, solution.expect("there is a plan"));
        let plan = &outcome.plans[0];
        let parts = Parts { network: &network, nodes: &step.nodes, arcs: &step.arcs, plan, cycle: &[] };
        let distances = distances(&parts);
        let node = |name: &str| {
            let found = network
                .nodes
                .iter()
                .position(|node| node.events.iter().any(|&it| network.event_name(it) == name));
            NodeId::from_index(found.expect("the event exists"))
        };
        let bounds = |from: &str, to: &str| {
            let back = distances[&(node(to), node(from))].finite().and_then(Time::checked_neg);
            (back, distances[&(node(from), node(to))])
        };
        let expected = |low: i64, high: i64| (Some(Time::from(low)), Bound::Finite(Time::from(high)));
        assert_eq!(bounds("Group-Traverse-Path#1.start", "Group-Traverse-Path#1.end"), expected(405, 450));
        assert_eq!(bounds("Group-Wait#1.end", "Tell(PROCEED=OK)#1.start"), expected(1, 185));
        assert_eq!(bounds("Group-Enroute#1.end", "scenario#1.end"), expected(66, 340));
    }
}
