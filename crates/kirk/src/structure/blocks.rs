//! The tree from a network's blocks: their arcs, those around them, and blocks whose conditions conflict only within.

use tpn::{ArcId, BlockId, BlockKind, Network, NodeId};
use typed_index_collections::TiVec;

use super::{Shape, Structure, TreeBlock};
use crate::enclosed::Enclosed;
use crate::model::{INFINITE, Model};
use crate::unplannable::Unplannable;

/// Parts of more blocks are not looked at for enclosed conditions.
const MAX_ENCLOSED_BLOCKS: usize = 64;

impl Structure {
    /// `None` if the blocks do not account for their own arcs, as in networks changed by other tools.
    pub(crate) fn new(network: &Network, model: &Model) -> Result<Option<Self>, Unplannable> {
        let Some(root) = network.root else { return Ok(None) };
        let mut structure = Self {
            blocks: TiVec::with_capacity(network.blocks.len()),
            children: Vec::with_capacity(network.blocks.len()),
            own_arcs: Vec::with_capacity(network.arcs.len()),
            initial: TiVec::new(),
            // Every decision has its block, or the model would have no contexts.
            decision_blocks: vec![root; network.decisions.len()].into(),
            arc_blocks: vec![None; network.arcs.len()].into(),
            root,
            enclosed: TiVec::new(),
        };
        for block in &network.blocks {
            if !structure.add_block(block, model) {
                return Ok(None);
            }
        }
        for id in structure.blocks.keys().rev() {
            let depth = structure.blocks[id].depth + 1;
            for position in 0..structure.blocks[id].children.1 {
                let child = structure.child(id, position);
                let child = &mut structure.blocks[child];
                (child.parent, child.position, child.depth) = (Some(id), position, depth);
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
        let id = self.blocks.next_key();
        let (first_child, first_arc) = (self.children.len(), self.own_arcs.len());
        let mut adopt = |blocks: &[tpn::BlockId]| self.children.extend_from_slice(blocks);
        let shape = match &block.kind {
            BlockKind::Leaf { arc } => {
                self.own_arcs.push(*arc);
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
                self.decision_blocks[*decision] = id;
                if alternatives.len() != model.decisions[*decision].alternatives.len() {
                    return false;
                }
                Shape::Choice(*decision)
            }
            BlockKind::Scope { child, arcs, .. } => {
                adopt(std::slice::from_ref(child));
                self.own_arcs.extend_from_slice(arcs);
                Shape::Intersection
            }
            BlockKind::Guard { arc, child } => {
                adopt(std::slice::from_ref(child));
                self.own_arcs.push(*arc);
                Shape::Guard
            }
        };
        let (children, arcs) = (&self.children[first_child..], &self.own_arcs[first_arc..]);
        if children.iter().any(|&child| child >= id) {
            return false;
        }
        for &arc in arcs {
            self.arc_blocks[arc] = Some(id);
        }
        let inside = |test: fn(&TreeBlock) -> bool| children.iter().any(|&at| test(&self.blocks[at]));
        let has_choices = matches!(shape, Shape::Choice(_)) || inside(|child| child.has_choices);
        let has_labels = arcs.iter().any(|&arc| !model.conditions.labels_of(arc).is_empty())
            || inside(|child| child.has_labels);
        self.blocks.push(TreeBlock {
            parent: None,
            position: 0,
            depth: 0,
            shape,
            children: (first_child as u32, children.len() as u32),
            own_arcs: (first_arc as u32, arcs.len() as u32),
            around: (0, 0),
            own: (0, INFINITE),
            has_choices,
            has_labels,
            enclosed: None,
            is_inside_enclosed: false,
            ends: (block.start, block.end),
            around_arcs: (None, None),
        });
        true
    }

    /// Finds, for each variable, the smallest block with all its labels, and keeps those that are enclosed.
    pub(super) fn find_enclosed(&mut self, model: &Model) {
        let conditions = &model.conditions;
        let mut num_arcs_at: TiVec<NodeId, u32> = vec![0; model.num_nodes].into();
        for arc in &model.arcs {
            num_arcs_at[arc.from] += 1;
            num_arcs_at[arc.to] += 1;
        }
        for variable in &conditions.variables {
            let mut blocks =
                variable.labels.iter().map(|&label| self.arc_blocks[conditions.labels[label].arc]);
            let Some(first) = blocks.next() else { continue };
            let common = blocks.fold(first, |common, block| self.common_ancestor(common?, block?));
            let Some(common) = common else { continue };
            let block = &self.blocks[common];
            // How long the whole mission may take is up to the search, which orders it only once.
            if self.is_whole(common)
                || block.has_choices
                || block.enclosed.is_some()
                || block.is_inside_enclosed
            {
                continue;
            }
            let Some(inside) = self.blocks_inside(common) else { continue };
            let mut arcs = self.own_arcs(common).to_vec();
            for &id in &inside {
                let (enter, leave) = self.blocks[id].around_arcs;
                arcs.extend([enter, leave].into_iter().flatten());
                arcs.extend_from_slice(self.own_arcs(id));
            }
            let Some(enclosed) = Enclosed::new(model, &num_arcs_at, block.ends, arcs) else { continue };
            self.blocks[common].enclosed = Some(self.enclosed.push_and_get_key(enclosed));
            for id in inside {
                self.blocks[id].is_inside_enclosed = true;
            }
        }
    }

    /// Whether a block is all there is, but for bounds around it.
    fn is_whole(&self, mut id: BlockId) -> bool {
        while let Some(parent) = self.blocks[id].parent {
            if self.children(parent).len() > 1 {
                return false;
            }
            id = parent;
        }
        true
    }

    /// The blocks inside another; `None` if there are many.
    fn blocks_inside(&self, id: BlockId) -> Option<Vec<BlockId>> {
        let mut inside = self.children(id).to_vec();
        let mut next = 0;
        while let Some(&id) = inside.get(next) {
            inside.extend_from_slice(self.children(id));
            next += 1;
            if inside.len() > MAX_ENCLOSED_BLOCKS {
                return None;
            }
        }
        Some(inside)
    }

    /// The smallest block that holds two others, if there is one.
    fn common_ancestor(&self, mut left: BlockId, mut right: BlockId) -> Option<BlockId> {
        while left != right {
            if self.blocks[left].depth >= self.blocks[right].depth {
                left = self.blocks[left].parent?;
            } else {
                right = self.blocks[right].parent?;
            }
        }
        Some(left)
    }

    /// Finds the arcs around the children of a block; `false` if one is missing.
    pub(super) fn find_around_arcs(&mut self, model: &Model, id: BlockId) -> bool {
        let TreeBlock { ends: (start, end), shape, children: (_, num_children), .. } = self.blocks[id];
        let inside_guard = self.own_arcs(id).first().map_or(start, |&arc| model.arcs[arc].to);
        for position in 0..num_children {
            let child = self.child(id, position);
            let (child_start, child_end) = self.blocks[child].ends;
            let enter = match shape {
                Shape::Guard => Passage::between(model, inside_guard, child_start),
                Shape::Sequence if position > 0 => Some(Passage::Same),
                Shape::Choice(decision) => {
                    let arc = model.decisions[decision].alternatives[position as usize];
                    (model.arcs[arc].to == child_start).then_some(Passage::Arc(arc))
                }
                _ => Passage::between(model, start, child_start),
            };
            let to = if shape == Shape::Sequence && position + 1 < num_children {
                self.blocks[self.child(id, position + 1)].ends.0
            } else {
                end
            };
            let (Some(enter), Some(leave)) = (enter, Passage::between(model, child_end, to)) else {
                return false;
            };
            self.blocks[child].around_arcs = (enter.arc(), leave.arc());
        }
        true
    }
}

/// How one node is reached from another.
#[derive(Clone, Copy)]
enum Passage {
    /// They are one node.
    Same,
    /// An arc leads there, the first of several: the bounds of any of them are sound.
    Arc(ArcId),
}

impl Passage {
    fn arc(self) -> Option<ArcId> {
        match self {
            Self::Same => None,
            Self::Arc(arc) => Some(arc),
        }
    }

    /// `None` if there is none.
    fn between(model: &Model, from: NodeId, to: NodeId) -> Option<Self> {
        if from == to {
            return Some(Self::Same);
        }
        let mut arcs = model.out_arcs(from).iter().copied();
        arcs.find(|&arc| model.arcs[arc].to == to).map(Self::Arc)
    }
}
