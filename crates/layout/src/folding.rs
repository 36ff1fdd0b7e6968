//! Which blocks a drawing hides behind boxes: those that the caller names, and whatever is finer than the level of detail.

use std::collections::BinaryHeap;

use tpn::{BlockId, BlockKind, Network, NodeId};

use crate::contents::{Contents, Ends};
use crate::options::Options;
use crate::tree::{block_children, path_chain};

/// One block, or neighbors in a sequence or among branches, behind one box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fold {
    pub(crate) first: BlockId,
    pub(crate) last: BlockId,
    /// The event before the box.
    pub(crate) start: NodeId,
    /// The event after it.
    pub(crate) end: NodeId,
    /// How many steps of the program it hides.
    pub(crate) steps: u32,
    /// The first and the last activity among them.
    pub(crate) named: Ends,
}

/// The boxes of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Folding {
    pub(crate) folds: Vec<Fold>,
    /// The blocks that are drawn, if only as part of a box; what a block holds comes before it.
    pub(crate) shown: Vec<BlockId>,
    /// Of each block that is drawn behind a box together with its neighbors or alone, which one.
    pub(crate) fold_of: Vec<Option<u32>>,
}

/// A run of blocks takes one box only if each is at most this part of what a box may hold.
const SMALL_SHARE: u32 = 4;
/// Fewer steps than this are drawn rather than put behind a box, of an activity and of others.
const MIN_ACTIVITY: u32 = 2;
const MIN_RUN: u32 = 3;

impl Folding {
    /// Returns what is folded of a network with blocks under `root`. Takes the time of what is drawn.
    pub(crate) fn new(network: &Network, contents: &Contents, options: &Options, root: BlockId) -> Self {
        let folder = Folder { network, contents, options };
        let mut folding =
            Self { folds: Vec::new(), shown: Vec::new(), fold_of: vec![None; network.blocks.len()] };
        let mut open = BinaryHeap::new();
        if options.collapsed.contains(&root) {
            folding.fold(&folder, &[root], None);
        } else {
            open.push(root);
        }
        while let Some(id) = open.pop() {
            folding.shown.push(id);
            let kind = &network.blocks[id.index()].kind;
            let mut left = block_children(kind);
            while let Some(&child) = left.first().filter(|child| **child < id) {
                let run = folder.run(left);
                let (members, rest) = left.split_at(run);
                if run > 1 {
                    let parent = (!matches!(kind, BlockKind::Sequence { .. })).then_some(id);
                    folding.fold(&folder, members, parent);
                } else if folder.is_folded(child) {
                    folding.fold(&folder, members, None);
                } else {
                    open.push(child);
                }
                left = rest;
            }
        }
        folding.shown.sort_unstable();
        folding
    }

    /// Puts neighbors behind one box, between the ends of `parent` if they are branches of it.
    fn fold(&mut self, folder: &Folder<'_>, members: &[BlockId], parent: Option<BlockId>) {
        let (Some(&first), Some(&last)) = (members.first(), members.last()) else { return };
        let blocks = &folder.network.blocks;
        let (start, end) = match parent.map(|parent| &blocks[parent.index()]) {
            Some(parent) => (parent.start, parent.end),
            None => (blocks[first.index()].start, blocks[last.index()].end),
        };
        for member in members {
            self.shown.push(*member);
            self.fold_of[member.index()] = Some(self.folds.len() as u32);
        }
        let steps = members.iter().map(|&member| folder.contents.steps(member)).sum();
        self.folds.push(Fold { first, last, start, end, steps, named: folder.contents.named(members) });
    }

    /// Of each node, the box that hides it.
    pub(crate) fn hidden_nodes(&self, network: &Network, contents: &Contents) -> Vec<Option<u32>> {
        let mut hidden = vec![None; network.nodes.len()];
        for (fold, ends) in self.folds.iter().enumerate() {
            let mut hide = |node: NodeId| {
                if node != ends.start && node != ends.end {
                    hidden[node.index()] = Some(fold as u32);
                }
            };
            for block in &network.blocks[contents.first_inside(ends.first).index()..=ends.last.index()] {
                hide(block.start);
                hide(block.end);
                if let BlockKind::Leaf { arc } = &block.kind {
                    for piece in path_chain(network, *arc) {
                        hide(network.arcs[piece.index()].to);
                    }
                }
            }
        }
        hidden
    }
}

/// Decides what is behind a box.
struct Folder<'a> {
    network: &'a Network,
    contents: &'a Contents,
    options: &'a Options,
}

impl Folder<'_> {
    /// Returns which of the places in more detail a block lies in, if any; `Err` if it is one or holds one, so that it
    /// is open.
    fn zone(&self, block: BlockId) -> Result<Option<usize>, ()> {
        let (low, high) = (self.contents.first_inside(block), block);
        for (at, finer) in self.options.detail.finer.iter().enumerate().rev() {
            let (begin, end) = (self.contents.first_inside(finer.first), finer.last);
            if high < begin || low > end {
                continue;
            }
            let is_inside = low >= begin && high <= end && (low, high) != (begin, end);
            return if is_inside { Ok(Some(at)) } else { Err(()) };
        }
        Ok(None)
    }

    fn is_folded(&self, block: BlockId) -> bool {
        let (count, ends) = (self.contents.steps(block), &self.network.blocks[block.index()]);
        let is_activity = matches!(ends.kind, BlockKind::Scope { occurrence: Some(_), .. });
        let least = if is_activity { MIN_ACTIVITY } else { MIN_RUN };
        let is_fine = count >= least && self.zone(block).is_ok_and(|zone| count <= self.grain(zone));
        ends.start != ends.end && (is_fine || self.options.collapsed.contains(&block))
    }

    /// Returns how many blocks from the first of `children` on take one box together, or 1.
    fn run(&self, children: &[BlockId]) -> usize {
        let Some(Ok(zone)) = children.first().map(|&child| self.zone(child)) else { return 1 };
        let grain = self.grain(zone);
        let (mut count, mut length) = (0, 0);
        for &child in children {
            let steps = self.contents.steps(child);
            let fits = steps * SMALL_SHARE <= grain && count + steps <= grain;
            if !fits || self.zone(child) != Ok(zone) || self.options.collapsed.contains(&child) {
                break;
            }
            count += steps;
            length += 1;
        }
        if count >= MIN_RUN { length.max(1) } else { 1 }
    }

    /// Returns how many steps a box may hold in a place in more detail, or elsewhere.
    fn grain(&self, zone: Option<usize>) -> u32 {
        let detail = &self.options.detail;
        zone.and_then(|at| detail.finer.get(at)).map_or(detail.grain, |finer| finer.grain)
    }
}
