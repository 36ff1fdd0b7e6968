//! Walking the search tree by keyboard: arrows go to parent, child and siblings, Shift with arrows goes in the order
//! in which states were discovered, and R goes to the root (DESIGN 1).

use egui::{Key, Modifiers};
use kirk::TreeNodeId;

use super::Shown;
use super::tree::TreeDrawing;
use crate::command::{Command, CommandSender};
use crate::panel::{Context, PanelKind};
use crate::state::search::SearchCommand;

/// Follows the keys that were pressed, if they are meant for this panel.
pub fn follow(
    ui: &egui::Ui,
    context: &Context<'_>,
    shown: &Shown<'_>,
    drawing: &TreeDrawing,
    commands: &mut CommandSender,
) {
    let is_meant =
        context.state.active_panel == PanelKind::Search && ui.memory(|memory| memory.focused().is_none());
    if !is_meant {
        return;
    }
    let current = shown.step.map_or(0, |step| step.tree_node);
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    let mut target = None;
    for (modifiers, key, find) in WALKS {
        if pressed(modifiers, key) {
            target = find(shown, drawing, current);
        }
    }
    if let Some(node) = target {
        commands.send(Command::Search(SearchCommand::GoToNode(node)));
    }
}

/// Finds the state that a key leads to from the present one.
type Walk = fn(&Shown<'_>, &TreeDrawing, TreeNodeId) -> Option<TreeNodeId>;

/// Keys with Shift come first: without it they mean something else.
const WALKS: [(Modifiers, Key, Walk); 7] = [
    (Modifiers::SHIFT, Key::ArrowRight, |_, drawing, node| discovered(drawing, node, true)),
    (Modifiers::SHIFT, Key::ArrowLeft, |_, drawing, node| discovered(drawing, node, false)),
    (Modifiers::NONE, Key::ArrowUp, |shown, _, node| shown.trace.tree.get(node as usize)?.parent),
    (Modifiers::NONE, Key::ArrowDown, |_, drawing, node| {
        let entered = |child: &&TreeNodeId| drawing.first_step[**child as usize].is_some();
        drawing.children.get(node as usize)?.iter().find(entered).copied()
    }),
    (Modifiers::NONE, Key::ArrowRight, |shown, drawing, node| sibling(shown, drawing, node, true)),
    (Modifiers::NONE, Key::ArrowLeft, |shown, drawing, node| sibling(shown, drawing, node, false)),
    (Modifiers::NONE, Key::R, |_, _, _| Some(0)),
];

fn sibling(shown: &Shown<'_>, drawing: &TreeDrawing, node: TreeNodeId, forwards: bool) -> Option<TreeNodeId> {
    let parent = shown.trace.tree.get(node as usize)?.parent?;
    let siblings = drawing.children.get(parent as usize)?;
    let entered: Vec<TreeNodeId> =
        siblings.iter().copied().filter(|&it| drawing.first_step[it as usize].is_some()).collect();
    let at = entered.iter().position(|&it| it == node)?;
    let next = if forwards { at + 1 } else { at.checked_sub(1)? };
    entered.get(next).copied()
}

/// The state that was first entered just after, or just before, this one.
fn discovered(drawing: &TreeDrawing, node: TreeNodeId, forwards: bool) -> Option<TreeNodeId> {
    let here = drawing.first_step[node as usize]?;
    let others =
        (0..).zip(&drawing.first_step).filter_map(|(id, step): (TreeNodeId, _)| Some((id, (*step)?)));
    if forwards {
        others.filter(|&(_, step)| step > here).min_by_key(|&(_, step)| step).map(|(id, _)| id)
    } else {
        others.filter(|&(_, step)| step < here).max_by_key(|&(_, step)| step).map(|(id, _)| id)
    }
}
