//! The distance matrix of the selected events: the least upper bound from each to each, found in their distance graph.

use std::collections::BTreeMap;

use egui::RichText;
use exact::{Bound, Scale};
use kirk::Constraint;
use stn::{INFINITE, PointId, Stn};
use theme::{size, space};
use tpn::NodeId;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;
use workbench::state::selection::node_name;

use super::graph::{Selected, bounds};
use crate::Context;

/// Larger networks are not shown as a matrix: no one could read it.
const MAX_EVENTS: usize = 32;

/// Shows the matrix.
pub fn show(ui: &mut egui::Ui, context: &Context<'_>, selected: &Selected<'_>, commands: &mut CommandSender) {
    let tokens = context.tokens;
    let network = selected.network;
    let is_named = |node: &&NodeId| {
        network.nodes.get(node.index()).is_some_and(|node| {
            let is_point = |event: &tpn::EventRef| matches!(event.end, tpn::EventEnd::PathVertex { .. });
            !node.events.is_empty() && !node.events.iter().all(is_point)
        })
    };
    let named: Vec<NodeId> = selected.nodes.iter().filter(is_named).copied().collect();
    if named.is_empty() || named.len() > MAX_EVENTS {
        let text = format!(
            "{} events are selected. The matrix shows at most {MAX_EVENTS}; use the graph instead.",
            named.len()
        );
        crate::show_empty(ui, context, &text);
        return;
    }
    let distances = distances(selected, &named).unwrap_or_default();
    let in_cycle: Vec<NodeId> = selected.cycle.iter().map(|member| member.from).collect();
    egui::ScrollArea::both().id_salt("distances").auto_shrink(false).show(ui, |ui| {
        ui.add_space(space::XS);
        if !selected.cycle.is_empty() {
            let text = "Shown without the bound that closes the negative cycle; with it, no shortest \
                        distances exist.";
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
                let row = distances.get(index);
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
                for (place, &to) in named.iter().enumerate() {
                    let distance = row.map_or(Bound::Infinite, |row| row[place]);
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

/// The distances from each of `named`, which are selected, to each, by row; `None` where a time does not fit. Of a
/// contradiction, the bound that closed it is left out.
fn distances(selected: &Selected<'_>, named: &[NodeId]) -> Option<Vec<Vec<Bound>>> {
    let closing = closing(selected);
    let mut bounds = bounds(selected);
    bounds.retain(|bound| closing != Some(bound.constraint));
    let scale = Scale::common(bounds.iter().map(|bound| bound.weight)).ok()?;
    let position: BTreeMap<NodeId, PointId> =
        selected.nodes.iter().zip((0..).map(PointId)).map(|(&node, point)| (node, point)).collect();
    let mut stn = Stn::new(selected.nodes.len());
    for bound in bounds {
        if let (Some(&from), Some(&to)) = (position.get(&bound.from), position.get(&bound.to)) {
            stn.push(from, to, scale.ticks(bound.weight).ok()?, 0);
        }
    }
    stn.settle(&position.values().copied().collect::<Vec<_>>()).ok()?;
    let mut row = Vec::new();
    let rows = named.iter().map(|from| -> Option<Vec<Bound>> {
        stn.distances_from(*position.get(from)?, &mut row).ok()?;
        let to = named.iter().map(|to| match row[position.get(to)?.index()] {
            INFINITE => Some(Bound::Infinite),
            ticks => Some(Bound::Finite(scale.time(ticks))),
        });
        to.collect()
    });
    rows.collect()
}

/// The bound that was added last of those that contradict each other: the others are consistent by themselves.
fn closing(selected: &Selected<'_>) -> Option<Constraint> {
    let added = |constraint: &Constraint| match constraint {
        Constraint::Lower(arc) | Constraint::Upper(arc) => {
            (0, selected.arcs.iter().position(|it| it == arc).unwrap_or_default())
        }
        Constraint::Link(link) => {
            (1, selected.plan.causal_links.iter().position(|it| it == link).unwrap_or_default())
        }
        Constraint::Order(order) => {
            (2, selected.plan.orderings_added.iter().position(|it| it == order).unwrap_or_default())
        }
        Constraint::UseOrder(order) => {
            (3, selected.plan.uses_ordered.iter().position(|it| it == order).unwrap_or_default())
        }
        Constraint::Departure(_) => (0, 0),
    };
    selected.cycle.iter().map(|member| member.constraint).max_by_key(added)
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
        let (nodes, arcs) = (step.nodes.as_slice(), step.arcs.as_slice());
        let selected = Selected { network: &network, nodes, arcs, plan, cycle: &[] };
        let distances = distances(&selected, nodes).expect("its times fit");
        let node = |name: &str| {
            let found = network
                .nodes
                .iter()
                .position(|node| node.events.iter().any(|&it| network.event_name(it) == name));
            let found = NodeId::from_index(found.expect("the event exists"));
            nodes.iter().position(|&node| node == found).expect("it is selected")
        };
        let bounds = |from: &str, to: &str| {
            let back = distances[node(to)][node(from)].finite().and_then(Time::checked_neg);
            (back, distances[node(from)][node(to)])
        };
        let expected = |low: i64, high: i64| (Some(Time::from(low)), Bound::Finite(Time::from(high)));
        assert_eq!(bounds("Group-Traverse-Path#1.start", "Group-Traverse-Path#1.end"), expected(405, 450));
        assert_eq!(bounds("Group-Wait#1.end", "Tell(PROCEED=OK)#1.start"), expected(1, 185));
        assert_eq!(bounds("Group-Enroute#1.end", "scenario#1.end"), expected(66, 340));
    }
}
