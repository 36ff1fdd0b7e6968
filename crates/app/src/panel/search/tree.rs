//! Coordinates for the search tree: the root on top, children in the order of their alternatives, leaves side by side.

use std::collections::BTreeSet;

use kirk::{Trace, TreeNodeId, TreeStatus};

/// The tree as it is drawn; distances are in cells.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeDrawing {
    /// Where each state stands: across and down; `None` for those inside a collapsed one.
    pub places: Vec<Option<[f32; 2]>>,
    /// Cells across.
    pub width: f32,
    /// Cells down.
    pub depth: f32,
    /// The children of each state, in order.
    pub children: Vec<Vec<TreeNodeId>>,
    /// The first step in which each state is entered.
    pub first_step: Vec<Option<usize>>,
    /// The last one.
    pub last_step: Vec<Option<usize>>,
    /// Whether there is a plan in or below each state.
    pub has_solution: Vec<bool>,
}

impl TreeDrawing {
    /// Lays `trace` out, with the states in `collapsed` drawn without what is below them. Linear in its size.
    pub fn new(trace: &Trace, collapsed: &BTreeSet<TreeNodeId>) -> Self {
        let count = trace.tree.len();
        let mut drawing = Self {
            places: vec![None; count],
            children: vec![Vec::new(); count],
            first_step: vec![None; count],
            last_step: vec![None; count],
            has_solution: trace.tree.iter().map(|node| node.status == TreeStatus::Solution).collect(),
            ..Self::default()
        };
        for (id, node) in (0..).zip(&trace.tree) {
            if let Some(siblings) = node.parent.and_then(|parent| drawing.children.get_mut(parent as usize)) {
                siblings.push(id);
            }
        }
        // Parents come before their children, so one pass from the end sees children first.
        for (id, node) in trace.tree.iter().enumerate().rev() {
            if let Some(parent) = node.parent {
                drawing.has_solution[parent as usize] |= drawing.has_solution[id];
            }
        }
        for (step, entry) in trace.events.iter().enumerate() {
            let id = entry.tree_node as usize;
            if id < count {
                drawing.first_step[id].get_or_insert(step);
                drawing.last_step[id] = Some(step);
            }
        }
        drawing.place(collapsed);
        drawing
    }

    fn place(&mut self, collapsed: &BTreeSet<TreeNodeId>) {
        if self.places.is_empty() {
            return;
        }
        let mut next_across = 0.0;
        let mut pending: Vec<(TreeNodeId, u32, bool)> = vec![(0, 0, false)];
        while let Some((id, down, is_done)) = pending.pop() {
            let is_leaf = self.children[id as usize].is_empty() || collapsed.contains(&id);
            self.depth = self.depth.max(down as f32);
            if is_leaf {
                self.places[id as usize] = Some([next_across, down as f32]);
                next_across += 1.0;
            } else if is_done {
                let across = |child: Option<&TreeNodeId>| {
                    child.and_then(|&child| self.places[child as usize]).map_or(0.0, |place| place[0])
                };
                let children = &self.children[id as usize];
                let middle = f32::midpoint(across(children.first()), across(children.last()));
                self.places[id as usize] = Some([middle, down as f32]);
            } else {
                pending.push((id, down, true));
                pending
                    .extend(self.children[id as usize].iter().rev().map(|&child| (child, down + 1, false)));
            }
        }
        self.width = (next_across - 1.0_f32).max(0.0);
    }

    /// The states below which every attempt failed: what is collapsed on request.
    pub fn failed_subtrees(&self, trace: &Trace) -> BTreeSet<TreeNodeId> {
        let is_failed =
            |id: TreeNodeId| !self.has_solution[id as usize] && self.first_step[id as usize].is_some();
        (0..trace.tree.len() as TreeNodeId)
            .filter(|&id| is_failed(id) && !self.children[id as usize].is_empty())
            .filter(|&id| trace.tree[id as usize].parent.is_none_or(|parent| !is_failed(parent)))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use kirk::{Search, Unlimited};

    use super::*;

    fn traced(source: &str) -> Trace {
        let program = rmpl::parse(source).program();
        let network = tpn::compile(&program, &tpn::Top::Scenario(None)).0.expect("it compiles");
        let options = kirk::Options {
            search: Search::Chronological,
            trace_events: Some(10_000),
            ..kirk::Options::default()
        };
        kirk::plan(&network, &options, &mut Unlimited).trace.expect("it was recorded")
    }

    #[test]
    fn no_two_states_share_a_place_and_parents_stand_above_their_children() {
        let trace = traced(include_str!("../../../../../assets/missions/backjump.rmpl"));
        let drawing = TreeDrawing::new(&trace, &BTreeSet::new());
        let mut seen = BTreeSet::new();
        for (id, node) in trace.tree.iter().enumerate() {
            let [across, down] = drawing.places[id].expect("nothing is collapsed");
            assert!(seen.insert(((across * 64.0) as i64, down as i64)), "{id} covers another");
            if let Some(parent) = node.parent {
                assert_eq!(drawing.places[parent as usize].map(|place| place[1] + 1.0), Some(down));
            }
        }
    }

    #[test]
    fn collapsing_failed_subtrees_leaves_the_solution_in_sight() {
        let trace = traced(include_str!("../../../../../assets/missions/backjump.rmpl"));
        let whole = TreeDrawing::new(&trace, &BTreeSet::new());
        let failed = whole.failed_subtrees(&trace);
        assert!(!failed.is_empty());
        let drawing = TreeDrawing::new(&trace, &failed);
        assert!(drawing.width < whole.width);
        let solution = trace.tree.iter().position(|node| node.status == TreeStatus::Solution);
        assert!(solution.is_some_and(|id| drawing.places[id].is_some()));
    }
}
