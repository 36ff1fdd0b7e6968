//! The distance matrix of the events that the search has selected: the least upper bound from each to each.

use std::collections::BTreeMap;

use rmpl::Bound;
use tpn::{Network, NodeId};

use super::Shown;
use crate::panel::Context;
use crate::state::selection::node_name;
use crate::theme::size;

/// Larger networks are not shown as a matrix: nobody could read it.
const MOST_EVENTS: usize = 24;

/// Shows the matrix of the step that is looked at.
pub fn show(ui: &mut egui::Ui, context: &Context<'_>, shown: &Shown<'_>) {
    let tokens = context.tokens;
    let Some(step) = shown.step else {
        ui.label(
            egui::RichText::new("Distances are shown while a step is looked at.").color(tokens.text_muted),
        );
        return;
    };
    let named: Vec<NodeId> = step
        .nodes
        .iter()
        .copied()
        .filter(|node| !shown.network.nodes[node.index()].events.is_empty())
        .filter(|node| {
            !shown.network.nodes[node.index()]
                .events
                .iter()
                .all(|event| matches!(event.end, tpn::EventEnd::PathVertex { .. }))
        })
        .collect();
    if named.is_empty() || named.len() > MOST_EVENTS {
        let text = format!("{} events are selected; a matrix shows up to {MOST_EVENTS}.", named.len());
        ui.label(egui::RichText::new(text).color(tokens.text_muted));
        return;
    }
    let distances = distances(shown.network, step);
    egui::ScrollArea::both().id_salt("distances").max_height(220.0).show(ui, |ui| {
        egui::Grid::new("distance-matrix").striped(true).spacing([8.0, 2.0]).show(ui, |ui| {
            let text = |text: String| egui::RichText::new(text).monospace().size(size::SMALL);
            ui.label(text("from \\ to".into()).color(tokens.text_muted));
            for (index, &node) in named.iter().enumerate() {
                ui.label(text(format!("{}", index + 1))).on_hover_text(node_name(shown.network, node));
            }
            ui.end_row();
            for (index, &from) in named.iter().enumerate() {
                ui.label(text(format!("{} {}", index + 1, node_name(shown.network, from))));
                for &to in &named {
                    let distance = distances.get(&(from, to)).copied().unwrap_or(Bound::Infinite);
                    let color = match distance {
                        Bound::Infinite => tokens.text_faint,
                        Bound::Finite(_) => tokens.text,
                    };
                    let shown =
                        if distance == Bound::Infinite { "∞".to_owned() } else { distance.to_string() };
                    ui.label(text(shown).color(color));
                }
                ui.end_row();
            }
        });
    });
}

/// All distances between the selected nodes, by Floyd and Warshall.
fn distances(network: &Network, step: &kirk::ReplayStep) -> BTreeMap<(NodeId, NodeId), Bound> {
    let nodes = &step.nodes;
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
    for arc in step.arcs.iter().map(|arc| &network.arcs[arc.index()]) {
        shorten(arc.from, arc.to, arc.upper);
        shorten(arc.to, arc.from, Bound::Finite(-arc.lower));
    }
    let ends = |label: tpn::LabelId| {
        let arc = &network.arcs[network.labels[label.index()].arc.index()];
        (arc.from, arc.to)
    };
    for link in &step.links {
        let ((tell_start, tell_end), (ask_start, ask_end)) = (ends(link.tell), ends(link.ask));
        shorten(ask_start, tell_start, Bound::ZERO);
        shorten(tell_end, ask_end, Bound::ZERO);
    }
    for order in &step.orders {
        shorten(ends(order.then).0, ends(order.first).1, Bound::Finite(-network.threat_gap));
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

#[cfg(test)]
mod tests {
    use rmpl::Rational;

    use super::*;

    #[test]
    fn distances_of_a_finished_search_are_those_of_the_paper() {
        let source = include_str!("../../../../../tests/conformance/t01_enroute_scenario.rmpl");
        let program = rmpl::parse(source).program();
        let network = tpn::compile(&program, &tpn::Top::Scenario(None)).0.expect("it compiles");
        let options = kirk::Options { trace_events: Some(10_000), ..kirk::Options::default() };
        let trace = kirk::plan(&network, &options, &mut kirk::Unlimited).trace.expect("it was recorded");
        let solution =
            trace.events.iter().position(|entry| matches!(entry.event, kirk::Event::Solution { .. }));
        let replay = kirk::Replay::new(&network, None, &trace).expect("its times fit");
        let distances = distances(&network, &replay.at(solution.expect("there is a plan")));
        let node = |name: &str| {
            let found = network
                .nodes
                .iter()
                .position(|node| node.events.iter().any(|&it| network.event_name(it) == name));
            NodeId::from_index(found.expect("the event exists"))
        };
        let bounds = |from: &str, to: &str| {
            let back = distances[&(node(to), node(from))].finite().map(|back| -back);
            (back, distances[&(node(from), node(to))])
        };
        let expected = |low: i64, high: i64| (Some(Rational::from(low)), Bound::Finite(Rational::from(high)));
        assert_eq!(bounds("Group-Traverse-Path#1.start", "Group-Traverse-Path#1.end"), expected(405, 450));
        assert_eq!(bounds("Group-Wait#1.end", "Tell(PROCEED=OK)#1.start"), expected(1, 185));
        assert_eq!(bounds("Group-Enroute#1.end", "scenario#1.end"), expected(66, 340));
    }
}
