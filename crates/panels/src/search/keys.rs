//! Walking the search tree by keyboard: arrows go to parent, child and siblings, Shift with arrows goes in the order
//! in which states were discovered, and R goes to the root (DESIGN 1).

use egui::{Key, Modifiers};
use kirk::{Trace, TreeNodeId};
use workbench::PanelKind;
use workbench::command::{Command, CommandSender};
use workbench::state::search::focus::selection_of;
use workbench::state::search::{Recording, SearchCommand};

use super::tree::TreeIndex;
use crate::Context;

/// Follows the keys that were pressed, if they are meant for this panel: it is active, and no widget but the tree has the
/// keyboard.
pub fn follow(
    ui: &egui::Ui,
    context: &Context<'_>,
    (recording, index): (&Recording, &TreeIndex),
    tree_has_focus: bool,
    commands: &mut CommandSender,
) {
    let trace = recording.trace();
    let is_meant = context.state.window.active_panel == PanelKind::Search
        && context.state.window.dialog.is_none()
        && (tree_has_focus || !crate::keyboard_navigation::has_focus(ui));
    if !is_meant {
        return;
    }
    let current = context.state.search.step().map(|step| step.tree_node);
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    let mut target = None;
    for (modifiers, key, find) in WALKS {
        if pressed(modifiers, key) {
            // Without a step to start from, every way leads to the root.
            target = current.map_or(Some(0), |current| find(trace, index, current));
        }
    }
    if let Some(node) = target {
        commands.send(Command::Search(SearchCommand::GoToNode(node)));
        let choice = trace.tree.get(node as usize).and_then(|node| node.choice);
        commands.send(Command::Select(selection_of(recording.network(), choice)));
    }
}

/// Finds the state that a key leads to from the present one.
type Walk = fn(&Trace, &TreeIndex, TreeNodeId) -> Option<TreeNodeId>;

/// Keys with Shift come first: without it they mean something else.
const WALKS: [(Modifiers, Key, Walk); 9] = [
    (Modifiers::SHIFT, Key::ArrowRight, |_, index, node| discovered(index, node, true)),
    (Modifiers::SHIFT, Key::ArrowLeft, |_, index, node| discovered(index, node, false)),
    (Modifiers::SHIFT, Key::ArrowDown, |_, index, node| discovered(index, node, true)),
    (Modifiers::SHIFT, Key::ArrowUp, |_, index, node| discovered(index, node, false)),
    (Modifiers::NONE, Key::ArrowUp, |trace, _, node| trace.tree.get(node as usize)?.parent),
    (Modifiers::NONE, Key::ArrowDown, |_, index, node| {
        let is_entered = |child: &&TreeNodeId| index.first_step[**child as usize].is_some();
        index.children(node).iter().find(is_entered).copied()
    }),
    (Modifiers::NONE, Key::ArrowRight, |trace, index, node| sibling(trace, index, node, true)),
    (Modifiers::NONE, Key::ArrowLeft, |trace, index, node| sibling(trace, index, node, false)),
    (Modifiers::NONE, Key::R, |_, _, _| Some(0)),
];

fn sibling(trace: &Trace, index: &TreeIndex, node: TreeNodeId, forwards: bool) -> Option<TreeNodeId> {
    let parent = trace.tree.get(node as usize)?.parent?;
    let is_entered = |id: &TreeNodeId| index.first_step[*id as usize].is_some();
    let mut entered = index.children(parent).iter().copied().filter(is_entered);
    if forwards { entered.find(|&it| it > node) } else { entered.take_while(|&it| it < node).last() }
}

/// The state that was first entered just after, or just before, this one.
fn discovered(index: &TreeIndex, node: TreeNodeId, forwards: bool) -> Option<TreeNodeId> {
    let here = index.first_step[node as usize]?;
    let at = index.entered.partition_point(|&id| index.first_step[id as usize] < Some(here));
    index.entered.get(if forwards { at + 1 } else { at.checked_sub(1)? }).copied()
}
