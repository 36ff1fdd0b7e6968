//! The tree from a network's blocks: their arcs, those around them, and blocks whose conditions conflict only within.

use stn::Overflow;
use tpn::{BlockKind, Network};

use super::{Shape, Structure, TreeBlock};
use crate::enclosed::Enclosed;
use crate::model::{INFINITE, Model, NONE};

/// Parts of more blocks are not looked at for enclosed conditions.
const MAX_ENCLOSED_BLOCKS: usize = 64;

impl Structure {
    /// `None` if the blocks do not account for their own arcs, as in networks changed by other tools.
    pub(crate) fn new(network: &Network, model: &Model) -> Result<Option<Self>, Overflow> {
        let Some(root) = network.root else { return Ok(None) };
        let mut structure = Self {
            blocks: Vec::with_capacity(network.blocks.len()),
            children: Vec::with_capacity(network.blocks.len()),
            own_arcs: Vec::with_capacity(network.arcs.len()),
            initial: Vec::new(),
            decision_blocks: vec![NONE; network.decisions.len()],
            arc_blocks: vec![NONE; network.arcs.len()],
            root: root.0,
            enclosed: Vec::new(),
        };
        for block in &network.blocks {
            if !structure.add_block(block, model) {
                return Ok(None);
            }
        }
        for id in (0..structure.blocks.len()).rev() {
            let depth = structure.blocks[id].depth + 1;
            for position in 0..structure.blocks[id].children.1 {
                let child = structure.child(id, position) as usize;
                let child = &mut structure.blocks[child];
                (child.parent, child.position, child.depth) = (id as u32, position, depth);
            }
            if !structure.find_around_arcs(model, id) {
                return Ok(None);
            }
        }
        structure.find_enclosed(model);
        structure.refresh(model)?;
        Ok(Some(structure))
    }

    /// Adds the next block, whose children are there. `false` if it is not what the model makes of it.
    fn add_block(&mut self, block: &tpn::Block, model: &Model) -> bool {
        let id = self.blocks.len() as u32;
        let (first_child, first_arc) = (self.children.len(), self.own_arcs.len());
        let mut adopt = |blocks: &[tpn::BlockId]| self.children.extend(blocks.iter().map(|block| block.0));
        let shape = match &block.kind {
            BlockKind::Leaf { arc } => {
                self.own_arcs.push(arc.0);
                Shape::Leaf
            }
            BlockKind::Sequence { children } => {
                adopt(children);
                if children.is_empty() && block.start != block.end {
                    return false;
                }
                Shape::Sequence
            }
            BlockKind::Parallel { branches } => {
                adopt(branches);
                Shape::Intersection
            }
            BlockKind::Choose { decision, alternatives } => {
                adopt(alternatives);
                self.decision_blocks[decision.index()] = id;
                if alternatives.len() != model.decisions[decision.index()].alternatives.len() {
                    return false;
                }
                Shape::Choice(decision.0)
            }
            BlockKind::Scope { child, arcs, .. } => {
                adopt(std::slice::from_ref(child));
                self.own_arcs.extend(arcs.iter().map(|arc| arc.0));
                Shape::Intersection
            }
            BlockKind::Guard { arc, child } => {
                adopt(std::slice::from_ref(child));
                self.own_arcs.push(arc.0);
                Shape::Guard
            }
        };
        let (children, arcs) = (&self.children[first_child..], &self.own_arcs[first_arc..]);
        if children.iter().any(|&child| child >= id) {
            return false;
        }
        for &arc in arcs {
            self.arc_blocks[arc as usize] = id;
        }
        let inside =
            |test: fn(&TreeBlock) -> bool| children.iter().any(|&at| test(&self.blocks[at as usize]));
        let has_choices = matches!(shape, Shape::Choice(_)) || inside(|child| child.has_choices);
        let has_labels = arcs.iter().any(|&arc| !model.conditions.labels_of(arc).is_empty())
            || inside(|child| child.has_labels);
        self.blocks.push(TreeBlock {
            parent: NONE,
            position: 0,
            depth: 0,
            shape,
            children: (first_child as u32, children.len() as u32),
            own_arcs: (first_arc as u32, arcs.len() as u32),
            around: (0, 0),
            own: (0, INFINITE),
            has_choices,
            has_labels,
            enclosed: NONE,
            is_inside_enclosed: false,
            ends: (block.start.0, block.end.0),
            around_arcs: (NONE, NONE),
        });
        true
    }

    /// Finds, for each variable, the smallest block with all its labels, and keeps those that are enclosed.
    pub(super) fn find_enclosed(&mut self, model: &Model) {
        let conditions = &model.conditions;
        for variable in &conditions.variables {
            let mut blocks = variable
                .labels
                .iter()
                .map(|&label| self.arc_blocks[conditions.labels[label as usize].arc as usize]);
            let Some(first) = blocks.next() else { continue };
            let common = blocks.fold(first, |common, block| self.common_ancestor(common, block));
            if common == NONE {
                continue;
            }
            let block = &self.blocks[common as usize];
            if block.has_choices || block.enclosed != NONE || block.is_inside_enclosed {
                continue;
            }
            let Some(inside) = self.blocks_inside(common) else { continue };
            let mut arcs = self.own_arcs(common as usize).to_vec();
            for &id in &inside {
                let (enter, leave) = self.blocks[id as usize].around_arcs;
                arcs.extend([enter, leave].into_iter().filter(|&arc| arc != NONE));
                arcs.extend_from_slice(self.own_arcs(id as usize));
            }
            let Some(enclosed) = Enclosed::new(model, block.ends, arcs) else { continue };
            self.blocks[common as usize].enclosed = self.enclosed.len() as u32;
            self.enclosed.push(enclosed);
            for id in inside {
                self.blocks[id as usize].is_inside_enclosed = true;
            }
        }
    }

    /// The blocks inside another; `None` if there are many.
    fn blocks_inside(&self, id: u32) -> Option<Vec<u32>> {
        let mut inside = self.children(id as usize).to_vec();
        let mut next = 0;
        while let Some(&id) = inside.get(next) {
            inside.extend_from_slice(self.children(id as usize));
            next += 1;
            if inside.len() > MAX_ENCLOSED_BLOCKS {
                return None;
            }
        }
        Some(inside)
    }

    /// The smallest block that holds two others, or [`NONE`].
    fn common_ancestor(&self, mut left: u32, mut right: u32) -> u32 {
        while left != right && left != NONE && right != NONE {
            if self.blocks[left as usize].depth >= self.blocks[right as usize].depth {
                left = self.blocks[left as usize].parent;
            } else {
                right = self.blocks[right as usize].parent;
            }
        }
        if left == right { left } else { NONE }
    }

    /// Finds the arcs around the children of a block; `false` if one is missing.
    pub(super) fn find_around_arcs(&mut self, model: &Model, id: usize) -> bool {
        let TreeBlock { ends: (start, end), shape, children: (_, num_children), .. } = self.blocks[id];
        let inside_guard = self.own_arcs(id).first().map_or(start, |&arc| model.arcs[arc as usize].to);
        for position in 0..num_children {
            let child = self.child(id, position) as usize;
            let (child_start, child_end) = self.blocks[child].ends;
            let enter = match shape {
                Shape::Guard => arc_between(model, inside_guard, child_start),
                Shape::Sequence if position > 0 => Some(NONE),
                Shape::Choice(decision) => {
                    let arc = model.decisions[decision as usize].alternatives[position as usize];
                    (model.arcs[arc as usize].to == child_start).then_some(arc)
                }
                _ => arc_between(model, start, child_start),
            };
            let to = if shape == Shape::Sequence && position + 1 < num_children {
                self.blocks[self.child(id, position + 1) as usize].ends.0
            } else {
                end
            };
            let (Some(enter), Some(leave)) = (enter, arc_between(model, child_end, to)) else { return false };
            self.blocks[child].around_arcs = (enter, leave);
        }
        true
    }
}

/// An arc that leads from one node to another, the first of several: the bounds of any of them are sound. [`NONE`] for the
/// same node, `None` if there is none.
fn arc_between(model: &Model, from: u32, to: u32) -> Option<u32> {
    if from == to {
        return Some(NONE);
    }
    model.out_arcs(from).iter().copied().find(|&arc| model.arcs[arc as usize].to == to)
}
