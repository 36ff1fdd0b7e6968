//! Blocks among each other: the arcs around them, and those whose conditions conflict only within.

use super::{Shape, Structure, TreeBlock, arc_between};
use crate::enclosed::Enclosed;
use crate::model::{Model, NONE};

/// Parts of more blocks are not looked at for enclosed conditions.
const MAX_ENCLOSED_BLOCKS: usize = 64;

impl Structure {
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
