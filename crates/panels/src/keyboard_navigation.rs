//! Keyboard navigation by the arrow keys: from what is selected to its neighbor in the panel that the user is in.
//!
//! Lists go through their rows, the network along its arcs, the timeline through its activities, and the terrain through
//! what is on it. The search tree has keys of its own.

use egui::{Key, Modifiers, Ui};
use tpn::{EventEnd, Network, NodeId, OccurrenceId, OccurrenceKind, Plan};
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::Selection;

use crate::Context;

/// A direction on a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Left,
    Right,
    Up,
    Down,
}

/// How many rows the arrow keys go down (or up, if negative) in a list, if they are meant for `panel`.
pub fn arrows(ui: &Ui, context: &Context<'_>, panel: PanelKind) -> Option<isize> {
    if context.state.window.active_panel != panel || !is_free(ui, context) {
        return None;
    }
    match pressed(ui)? {
        Direction::Down | Direction::Right => Some(1),
        Direction::Up | Direction::Left => Some(-1),
    }
}

/// Follows the arrow keys in the network, the timeline and the terrain.
pub fn follow(ui: &Ui, context: &Context<'_>, commands: &mut CommandSender) {
    let panel = context.state.window.active_panel;
    if !is_free(ui, context) {
        return;
    }
    crate::draw_menu::clipboard(ui, context, commands);
    let navigates = matches!(panel, PanelKind::Network | PanelKind::Timeline | PanelKind::Terrain);
    let is_shown = context.state.window.panels_on_screen.contains(&panel);
    if !navigates || !is_shown || context.state.selection.is_none() && has_focus(ui) {
        return;
    }
    let Some(direction) = pressed(ui) else { return };
    let selection = &*context.state.selection;
    let found = match panel {
        PanelKind::Terrain => {
            context.snapshot.and_then(|it| next_thing(&it.program.world, selection, direction))
        }
        PanelKind::Timeline => {
            context.plan().and_then(|(network, plan)| next_activity(network, plan, selection, direction))
        }
        _ => {
            let network = context.snapshot.and_then(|snapshot| snapshot.network.as_deref());
            let plan = context.plan().map(|(_, plan)| plan);
            network.and_then(|network| next_node(network, plan, selection, direction))
        }
    };
    if let Some(found) = found {
        commands.send(Command::Select(found));
    }
}

/// Returns whether something has the keyboard other than a panel as a whole.
pub(crate) fn has_focus(ui: &Ui) -> bool {
    ui.memory(|memory| memory.focused().is_some()) && !crate::is_region_focused(ui.ctx())
}

/// Returns whether plain keys belong to the panel: no one types, and no dialog is open.
fn is_free(ui: &Ui, context: &Context<'_>) -> bool {
    context.state.window.dialog.is_none() && !ui.ctx().text_edit_focused() && {
        let is_editor = ui.memory(|memory| memory.focused() == Some(super::editor_id()));
        !is_editor
    }
}

fn pressed(ui: &Ui) -> Option<Direction> {
    let keys = [
        (Key::ArrowLeft, Direction::Left),
        (Key::ArrowRight, Direction::Right),
        (Key::ArrowUp, Direction::Up),
        (Key::ArrowDown, Direction::Down),
    ];
    let is_pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
    keys.into_iter().find(|(key, _)| is_pressed(*key)).map(|(_, direction)| direction)
}

/// The vehicle, place or obstacle before or after the selected one.
fn next_thing(
    world: &rmpl::program::World,
    selection: &Selection,
    direction: Direction,
) -> Option<Selection> {
    let vehicles = world.vehicles.iter().map(|it| Selection::Vehicle(it.name.text.clone()));
    let locations = world.locations.iter().map(|it| Selection::Location(it.name.text.clone()));
    let obstacles = world.obstacles.iter().map(|it| Selection::Obstacle(it.name.text.clone()));
    let all: Vec<Selection> = vehicles.chain(locations).chain(obstacles).collect();
    neighbor(&all, selection, direction)
}

/// The activity before or after the selected one, in the order in which they are scheduled to start.
fn next_activity(
    network: &Network,
    plan: &Plan,
    selection: &Selection,
    direction: Direction,
) -> Option<Selection> {
    let window = |node: NodeId| plan.windows.get(node.index()).copied().flatten();
    let listed = network.occurrences.iter().enumerate().filter_map(|(id, it)| {
        let is_listed = matches!(
            it.kind,
            OccurrenceKind::Activity | OccurrenceKind::Primitive | OccurrenceKind::Assertion
        );
        let (start, _) = (window(it.start)?, window(it.end)?);
        is_listed.then_some((start.earliest, OccurrenceId::from_index(id)))
    });
    let mut listed: Vec<_> = listed.collect();
    listed.sort_unstable();
    let all: Vec<Selection> = listed.into_iter().map(|(_, id)| Selection::Occurrence(id)).collect();
    let here = selection.occurrence(network).map_or(Selection::None, Selection::Occurrence);
    neighbor(&all, &here, direction)
}

fn neighbor(all: &[Selection], selection: &Selection, direction: Direction) -> Option<Selection> {
    let here = all.iter().position(|it| it == selection);
    let next = match (here, direction) {
        (None, _) => 0,
        (Some(here), Direction::Right | Direction::Down) => here + 1,
        (Some(here), Direction::Left | Direction::Up) => here.checked_sub(1)?,
    };
    all.get(next).cloned()
}

/// The event that an arc leads to or comes from, or the one beside it; what the plan selects goes first.
fn next_node(
    network: &Network,
    plan: Option<&Plan>,
    selection: &Selection,
    direction: Direction,
) -> Option<Selection> {
    let Some(here) = node_of(network, selection, direction) else {
        return Some(Selection::Node(network.start));
    };
    let found = match direction {
        Direction::Right => onwards(network, plan, here, true),
        Direction::Left => onwards(network, plan, here, false),
        Direction::Up | Direction::Down => beside(network, here, direction == Direction::Down),
    }?;
    let decision = network.nodes.get(found.index()).and_then(|node| node.decision);
    Some(decision.map_or(Selection::Node(found), Selection::Decision))
}

fn node_of(network: &Network, selection: &Selection, direction: Direction) -> Option<NodeId> {
    match selection {
        Selection::Node(node) => Some(*node),
        Selection::Decision(id) => Some(network.decisions.get(id.index())?.node),
        Selection::Arc(arc) => {
            let arc = network.arcs.get(arc.index())?;
            Some(if direction == Direction::Right { arc.from } else { arc.to })
        }
        Selection::Alternative(id, alternative) => {
            let arc = network.decisions.get(id.index())?.alternatives.get(*alternative as usize)?;
            Some(network.arcs.get(arc.index())?.to)
        }
        _ => {
            let occurrence = network.occurrences.get(selection.occurrence(network)?.index())?;
            Some(if direction == Direction::Right { occurrence.end } else { occurrence.start })
        }
    }
}

/// Along arcs until an event that has a name, or a decision.
fn onwards(network: &Network, plan: Option<&Plan>, from: NodeId, forwards: bool) -> Option<NodeId> {
    let mut at = from;
    for _ in 0..network.nodes.len() {
        let node = network.nodes.get(at.index())?;
        let arcs = if forwards { &node.out_arcs } else { &node.in_arcs };
        let is_selected =
            |arc: &&tpn::ArcId| plan.is_none_or(|plan| plan.selected_arcs.get(arc.index()) == Some(&true));
        // The arc over a whole activity would leave out everything in it.
        let is_short = |arc: &&tpn::ArcId| {
            network
                .arcs
                .get(arc.index())
                .is_some_and(|arc| arc.occurrence.is_none_or(|it| is_primitive(network, it)))
        };
        let mut short = arcs.iter().filter(is_short);
        let arc = short.clone().find(is_selected).or_else(|| short.next()).or(arcs.first())?;
        let arc = network.arcs.get(arc.index())?;
        at = if forwards { arc.to } else { arc.from };
        if is_named(network, at) {
            return Some(at);
        }
    }
    None
}

/// The next or the previous end of the arcs out of the node before.
fn beside(network: &Network, here: NodeId, forwards: bool) -> Option<NodeId> {
    let before = network.nodes.get(here.index())?.in_arcs.first()?;
    let before = network.nodes.get(network.arcs.get(before.index())?.from.index())?;
    let ends: Vec<NodeId> =
        before.out_arcs.iter().filter_map(|arc| Some(network.arcs.get(arc.index())?.to)).collect();
    let at = ends.iter().position(|&end| end == here)?;
    let next = if forwards { at + 1 } else { at.checked_sub(1)? };
    ends.get(next).copied()
}

fn is_primitive(network: &Network, id: OccurrenceId) -> bool {
    let kind = network.occurrences.get(id.index()).map(|occurrence| occurrence.kind);
    !matches!(kind, Some(OccurrenceKind::Activity | OccurrenceKind::Scenario))
}

fn is_named(network: &Network, id: NodeId) -> bool {
    network.nodes.get(id.index()).is_some_and(|node| {
        let is_point = |event: &tpn::EventRef| matches!(event.end, EventEnd::PathVertex { .. });
        node.decision.is_some() || node.events.iter().any(|event| !is_point(event))
    })
}
