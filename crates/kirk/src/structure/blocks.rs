//! The tree from a network's blocks: their arcs, those around them, and blocks whose conditions conflict only within.

use tpn::{ArcId, BlockId, BlockKind, Network, NodeId};
use typed_index_collections::TiVec;

use super::{Shape, Structure, TreeBlock};
use crate::model::{INFINITE, Model};
use crate::unplannable::Unplannable;

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
        self.blocks.push(TreeBlock {
            parent: None,
            position: 0,
            depth: 0,
            shape,
            children: (first_child as u32, children.len() as u32),
            own_arcs: (first_arc as u32, arcs.len() as u32),
            around: (0, 0),
            own: (0, INFINITE),
            ends: (block.start, block.end),
            around_arcs: (None, None),
        });
        true
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
