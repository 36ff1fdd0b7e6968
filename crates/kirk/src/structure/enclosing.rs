//! Which blocks nothing leads out of but their first and their last event, and what is in one.

use std::collections::BTreeMap;

use tpn::{ArcId, BlockId, DecisionId, NodeId};
use typed_index_collections::TiVec;

use super::{Shape, Structure, TreeBlock};

/// The blocks with what leads from one into another beside the tree: causal links that there may be, and bounds between
/// threads.
#[derive(Clone, Debug)]
pub(crate) struct Enclosing {
    /// The first and the last of the blocks in each block, in an order in which each comes before those in it.
    ranges: TiVec<BlockId, (u32, u32)>,
    /// Whether something leads out of it.
    is_crossed: TiVec<BlockId, bool>,
    /// Whether something may begin or end in it.
    has_links: TiVec<BlockId, bool>,
}

/// What is in a block where some choices have been made.
#[derive(Clone, Debug, Default)]
pub(crate) struct Within {
    pub(crate) arcs: Vec<ArcId>,
    /// Choices that have not been made, without those inside of others.
    pub(crate) open: Vec<DecisionId>,
}

impl Enclosing {
    /// `partners` are the blocks that something may lead between.
    pub(crate) fn new(structure: &Structure, partners: &[(BlockId, BlockId)]) -> Self {
        let blocks = &structure.blocks;
        let mut sizes: TiVec<BlockId, u32> = vec![1; blocks.len()].into();
        for id in blocks.keys() {
            sizes[id] += structure.children(id).iter().map(|&child| sizes[child]).sum::<u32>();
        }
        let mut ranges: TiVec<BlockId, (u32, u32)> = vec![(0, 0); blocks.len()].into();
        // Children come before their parents.
        let mut next_root = 0;
        for id in blocks.keys().rev() {
            if blocks[id].parent.is_none() {
                ranges[id] = (next_root, next_root + sizes[id] - 1);
                next_root += sizes[id];
            }
            let mut first = ranges[id].0 + 1;
            for &child in structure.children(id) {
                ranges[child] = (first, first + sizes[child] - 1);
                first += sizes[child];
            }
        }
        // How far what leads out of a block leads.
        let mut reach: TiVec<BlockId, Option<(u32, u32)>> = vec![None; blocks.len()].into();
        let extend = |reach: &mut Option<(u32, u32)>, (least, most): (u32, u32)| {
            let (known_min, known_most) = reach.unwrap_or((least, most));
            *reach = Some((known_min.min(least), known_most.max(most)));
        };
        for &(one, other) in partners {
            for (from, to) in [(one, other), (other, one)] {
                extend(&mut reach[from], (ranges[to].0, ranges[to].0));
            }
        }
        for id in blocks.keys() {
            if let (Some(parent), Some(reached)) = (blocks[id].parent, reach[id]) {
                extend(&mut reach[parent], reached);
            }
        }
        let is_crossed = |(reach, &(first, last)): (&Option<(u32, u32)>, &(u32, u32))| {
            reach.is_some_and(|(least, most)| least < first || most > last)
        };
        Self {
            is_crossed: reach.iter().zip(&ranges).map(is_crossed).collect(),
            has_links: reach.iter().map(Option::is_some).collect(),
            ranges,
        }
    }

    pub(crate) fn has_links(&self, block: BlockId) -> bool {
        self.has_links[block]
    }

    /// Returns whether a block is another one or in it.
    pub(crate) fn has(&self, block: BlockId, inner: BlockId) -> bool {
        let ((first, last), (at, _)) = (self.ranges[block], self.ranges[inner]);
        (first..=last).contains(&at)
    }
}

impl Structure {
    /// Returns whether the tree has all arcs, less so many.
    pub(crate) fn has_all_but(&self, num_constraints: usize) -> bool {
        let mut is_there = vec![false; self.arc_blocks.len()];
        let around = self.blocks.iter().flat_map(|block| [block.around_arcs.0, block.around_arcs.1]);
        for arc in around.flatten().chain(self.own_arcs.iter().copied()) {
            is_there[arc.index()] = true;
        }
        is_there.iter().filter(|&&is_there| !is_there).count() == num_constraints
    }

    /// The block that an arc is a leaf or a spanning arc of.
    pub(crate) fn block_of(&self, arc: ArcId) -> Option<BlockId> {
        self.arc_blocks[arc]
    }

    /// A block that begins or ends at each node.
    pub(crate) fn blocks_at_ends(&self) -> BTreeMap<NodeId, BlockId> {
        let ends = |(id, block): (BlockId, &TreeBlock)| [(block.ends.0, id), (block.ends.1, id)];
        self.blocks.iter_enumerated().flat_map(ends).collect()
    }

    pub(crate) fn ends(&self, block: BlockId) -> (NodeId, NodeId) {
        self.blocks[block].ends
    }

    pub(crate) fn is_root(&self, block: BlockId) -> bool {
        self.blocks[block].parent.is_none()
    }

    /// Returns whether a choice is inside of a block.
    pub(crate) fn is_inside(&self, enclosing: &Enclosing, decision: DecisionId, block: BlockId) -> bool {
        enclosing.has(block, self.decision_blocks[decision])
    }

    /// The smallest block that has two arcs in it and out of which nothing leads, with the bounds around it.
    pub(crate) fn smallest_around(
        &self,
        enclosing: &Enclosing,
        left: ArcId,
        right: ArcId,
    ) -> Option<BlockId> {
        let (mut block, right) = (self.arc_blocks[left]?, self.arc_blocks[right]?);
        while !enclosing.has(block, right) || enclosing.is_crossed[block] {
            block = self.blocks[block].parent?;
        }
        // What spans a block is the most that is known of how long it lasts.
        while let Some(parent) = self.blocks[block].parent
            && self.blocks[parent].shape == Shape::Intersection
            && self.blocks[parent].children.1 == 1
            && !enclosing.is_crossed[parent]
        {
            block = parent;
        }
        Some(block)
    }

    /// Returns what is in a block, of choices that have been made only what was chosen.
    pub(crate) fn within(&self, block: BlockId, chosen: &BTreeMap<DecisionId, u32>) -> Within {
        let mut within = Within::default();
        let mut left = vec![block];
        while let Some(id) = left.pop() {
            within.arcs.extend_from_slice(self.own_arcs(id));
            let mut enter = |child: BlockId| {
                let (before, after) = self.blocks[child].around_arcs;
                within.arcs.extend(before.into_iter().chain(after));
                left.push(child);
            };
            match self.blocks[id].shape {
                Shape::Choice(decision) => match chosen.get(&decision) {
                    Some(&alternative) => enter(self.child(id, alternative)),
                    None => within.open.push(decision),
                },
                _ => self.children(id).iter().copied().for_each(&mut enter),
            }
        }
        within
    }
}
