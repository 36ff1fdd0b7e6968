//! Blocks among each other: the arcs around them, and those whose conditions conflict only within.

use super::{Shape, Structure, arc_between};
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
            let mut arcs = block.own_arcs.clone();
            for &id in &inside {
                let block = &self.blocks[id as usize];
                let (enter, leave) = block.around_arcs;
                arcs.extend([enter, leave].into_iter().filter(|&arc| arc != NONE));
                arcs.extend_from_slice(&block.own_arcs);
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
        let mut inside = self.blocks[id as usize].children.clone();
        let mut next = 0;
        while let Some(&id) = inside.get(next) {
            inside.extend_from_slice(&self.blocks[id as usize].children);
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

    pub(super) fn find_around_arcs(&mut self, model: &Model, id: usize) {
        let block = &self.blocks[id];
        let (start, end) = block.ends;
        let children = block.children.clone();
        for (position, &child) in children.iter().enumerate() {
            let (child_start, child_end) = self.blocks[child as usize].ends;
            let from = match self.blocks[id].shape {
                Shape::Guard => {
                    self.blocks[id].own_arcs.first().map_or(start, |&arc| model.arcs[arc as usize].to)
                }
                Shape::Sequence if position > 0 => child_start,
                _ => start,
            };
            let to = match self.blocks[id].shape {
                Shape::Sequence => {
                    children.get(position + 1).map_or(end, |&next| self.blocks[next as usize].ends.0)
                }
                _ => end,
            };
            let enter = arc_between(model, from, child_start).unwrap_or(NONE);
            let leave = arc_between(model, child_end, to).unwrap_or(NONE);
            self.blocks[child as usize].around_arcs = (enter, leave);
        }
    }
}
