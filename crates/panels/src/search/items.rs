//! The states of a search tree for assistive technology: items with their level, place, and result.
//!
//! They are no stops of the Tab key: arrow keys walk the tree (`keys`), and a click by assistive technology goes to the state.

use egui::accesskit::{self, Action, Role};
use egui::{Rect, Response, Sense, Ui, UiBuilder, vec2};
use kirk::{TreeNodeId, TreeStatus};
use workbench::state::search::wording;

use super::canvas::Tree;

/// Of larger trees only the way to the step, and the states beside it, are items.
const MAX_ITEMS: usize = 300;

/// Adds the items to the tree whose drawing is `response`, and answers which state assistive technology goes to.
pub(super) fn show(
    ui: &mut Ui,
    response: &Response,
    tree: &Tree<'_>,
    path: &[TreeNodeId],
    at: impl Fn(TreeNodeId) -> Option<egui::Pos2>,
) -> Option<TreeNodeId> {
    if !ui.ctx().has_accesskit_node(response.id) {
        return None;
    }
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_role(Role::Tree));
    let inside = ui.new_child(
        UiBuilder::new()
            .max_rect(response.rect)
            .id_salt(("items", tree.name))
            .accessibility_parent(response.id),
    );
    let mut chosen = None;
    for item in items(tree, path) {
        let id = item.state;
        let place = at(id).unwrap_or(response.rect.center()).clamp(response.rect.min, response.rect.max);
        let rect = Rect::from_center_size(place, vec2(16.0, 16.0)).intersect(response.rect);
        let widget = inside.interact(rect, inside.scope_id().with(id), Sense::hover());
        inside.ctx().accesskit_node_builder(widget.id, |node| {
            node.set_role(Role::TreeItem);
            // What only hears the pointer gets none by itself.
            let [x0, y0, x1, y1] = [rect.min.x, rect.min.y, rect.max.x, rect.max.y].map(f64::from);
            node.set_bounds(accesskit::Rect { x0, y0, x1, y1 });
            node.set_label(name(tree, id));
            node.set_level(item.level);
            node.set_position_in_set(item.position);
            node.set_size_of_set(item.size);
            node.set_selected(tree.at_step().contains(&Some(id)));
            if let Some(is_expanded) = item.is_expanded {
                node.set_expanded(is_expanded);
            }
            node.add_action(Action::Click);
        });
        if ui.input(|input| input.has_accesskit_action_request(widget.id, Action::Click)) {
            chosen = Some(id);
        }
    }
    chosen
}

/// A state as an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Item {
    state: TreeNodeId,
    /// From 1, which is the root.
    level: usize,
    /// Its place among the known states below the same state, from 0, and how many these are.
    position: usize,
    size: usize,
    /// Whether what is below it is drawn; nothing if nothing known is below it.
    is_expanded: Option<bool>,
}

/// The known states that are drawn, each before those below it.
fn items(tree: &Tree<'_>, path: &[TreeNodeId]) -> Vec<Item> {
    let all = listed(tree, None);
    if all.len() <= MAX_ITEMS {
        return all;
    }
    let mut near = listed(tree, Some(path));
    near.truncate(MAX_ITEMS);
    near
}

/// The same; with a path, only those that are on it or beside one of its states.
fn listed(tree: &Tree<'_>, path: Option<&[TreeNodeId]>) -> Vec<Item> {
    let mut found = Vec::new();
    let mut pending = vec![Item { state: 0, level: 1, position: 0, size: 1, is_expanded: None }];
    while let Some(mut item) = pending.pop() {
        if !tree.is_known(item.state) || found.len() > 4 * MAX_ITEMS {
            continue;
        }
        let known = tree.index.children(item.state).iter().copied().filter(|&child| tree.is_known(child));
        let known: Vec<TreeNodeId> = known.collect();
        let is_drawn =
            |child: &TreeNodeId| tree.drawing.places.get(*child as usize).is_some_and(Option::is_some);
        let goes_on = path.is_none_or(|path| path.binary_search(&item.state).is_ok());
        item.is_expanded = known.first().map(|child| goes_on && is_drawn(child));
        found.push(item);
        if item.is_expanded == Some(true) {
            let (level, size) = (item.level + 1, known.len());
            let below = known.into_iter().enumerate();
            pending.extend(below.rev().map(|(position, state)| Item {
                state,
                level,
                position,
                size,
                is_expanded: None,
            }));
        }
    }
    found
}

/// The choice that leads to a state, and the result: `D1: Survey#1, failed: …`.
fn name(tree: &Tree<'_>, id: TreeNodeId) -> String {
    let trace = tree.trace;
    let chosen = wording::choice(tree.network, trace.tree.get(id as usize).and_then(|node| node.choice));
    let result = match tree.status(id) {
        TreeStatus::Unexplored => "not explored".to_owned(),
        TreeStatus::Decision => "explored".to_owned(),
        TreeStatus::Solution => "plan".to_owned(),
        TreeStatus::Excluded => tree.learned(id).map_or_else(
            || "excluded".to_owned(),
            |it| format!("excluded: {}", wording::never(tree.network, it)),
        ),
        TreeStatus::Failed => {
            let event = tree.index.failure(trace, id).map(|event| wording::event(tree.network, trace, event));
            let reason = event.as_deref().and_then(|it| it.strip_prefix("Failure: "));
            let reason = reason.map(|it| it.trim_end_matches('.'));
            reason.map_or_else(|| "failed".to_owned(), |reason| format!("failed: {reason}"))
        }
    };
    format!("{chosen}, {result}")
}
