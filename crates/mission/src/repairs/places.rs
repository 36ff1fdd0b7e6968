//! Where in a program's structure things stand.

use rmpl::Span;
use tpn::{ArcId, Block, BlockId, BlockKind, Network};

/// The structure of a network, with the way up.
pub(super) struct Places<'network> {
    network: &'network Network,
    parents: Vec<Option<BlockId>>,
}

impl<'network> Places<'network> {
    pub(super) fn new(network: &'network Network) -> Self {
        let mut parents = vec![None; network.blocks.len()];
        for (index, block) in network.blocks.iter().enumerate() {
            for child in children(block) {
                parents[child.index()] = Some(BlockId::from_index(index));
            }
        }
        Self { network, parents }
    }

    fn block(&self, block: BlockId) -> &'network Block {
        &self.network.blocks[block.index()]
    }

    /// The block that an arc belongs to.
    pub(super) fn of_arc(&self, arc: ArcId) -> Option<BlockId> {
        let has_arc = |block: &Block| match &block.kind {
            BlockKind::Leaf { arc: own } | BlockKind::Guard { arc: own, .. } => *own == arc,
            BlockKind::Scope { arcs, .. } => arcs.contains(&arc),
            BlockKind::Sequence { .. } | BlockKind::Parallel { .. } | BlockKind::Choose { .. } => false,
        };
        self.network.blocks.iter().position(has_arc).map(BlockId::from_index)
    }

    /// From a block up to the whole.
    fn upwards(&self, block: BlockId) -> impl Iterator<Item = BlockId> + '_ {
        std::iter::successors(Some(block), |block| self.parents[block.index()])
    }

    /// The parallel branches that two blocks are in, if they are in two.
    pub(super) fn branches(&self, one: BlockId, other: BlockId) -> Option<[BlockId; 2]> {
        let above: Vec<BlockId> = self.upwards(other).collect();
        let meeting = self.upwards(one).find(|block| above.contains(block))?;
        let BlockKind::Parallel { branches } = &self.block(meeting).kind else { return None };
        let branch_of = |block: BlockId| self.upwards(block).find(|it| branches.contains(it));
        Some([branch_of(one)?, branch_of(other)?])
    }

    /// Returns what an author takes for one thing: a block with the bounds and labels around it.
    pub(super) fn unit(&self, block: BlockId) -> BlockId {
        let is_around = |above: &BlockId| {
            matches!(
                self.block(*above).kind,
                BlockKind::Scope { occurrence: None, .. } | BlockKind::Guard { .. }
            )
        };
        self.upwards(block).skip(1).take_while(is_around).last().unwrap_or(block)
    }

    /// Returns whether a block is one of several that follow each other.
    pub(super) fn is_in_sequence(&self, block: BlockId) -> bool {
        let above = self.parents[block.index()];
        above.is_some_and(|above| matches!(self.block(above).kind, BlockKind::Sequence { .. }))
    }

    /// Returns where a block is written.
    pub(super) fn span(&self, block: BlockId) -> Option<Span> {
        self.block(block).span
    }
}

fn children(block: &Block) -> &[BlockId] {
    match &block.kind {
        BlockKind::Leaf { .. } => &[],
        BlockKind::Sequence { children } => children,
        BlockKind::Parallel { branches } => branches,
        BlockKind::Choose { alternatives, .. } => alternatives,
        BlockKind::Scope { child, .. } | BlockKind::Guard { child, .. } => std::slice::from_ref(child),
    }
}
