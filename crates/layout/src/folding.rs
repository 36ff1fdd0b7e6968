//! Which blocks a drawing hides behind boxes: those that the caller names, and whatever is finer than the level of detail.

use tpn::{ArcKind, BlockId, BlockKind, Network, NodeId};

use crate::options::Options;
use crate::tree::{block_children, path_chain};

/// One block, or neighbours in a sequence or among branches, behind one box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Fold {
    /// The first of the blocks.
    pub(crate) first: BlockId,
    /// The last of them.
    pub(crate) last: BlockId,
    /// The event before the box.
    pub(crate) start: NodeId,
    /// The event after it.
    pub(crate) end: NodeId,
    /// How many steps of the program it hides.
    pub(crate) steps: u32,
}

/// The boxes of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Folding {
    pub(crate) folds: Vec<Fold>,
    /// Of each block, whether it is drawn, if only as part of a box.
    pub(crate) visible: Vec<bool>,
    /// Of each block that is behind a box together with its neighbours or alone, which one.
    pub(crate) fold_of: Vec<Option<u32>>,
    /// Of each node, the box that hides it.
    pub(crate) hidden_nodes: Vec<Option<u32>>,
}

/// A run of blocks takes one box only if each is at most this part of what a box may hold.
const SMALL_SHARE: u32 = 4;
/// Fewer steps than this are drawn rather than put behind a box, of an activity and of others.
const LEAST_ACTIVITY: u32 = 2;
const LEAST_RUN: u32 = 3;

impl Folding {
    /// What is folded of a network with blocks under `root`. Linear in the blocks.
    pub(crate) fn new(network: &Network, options: &Options, root: BlockId) -> Self {
        let steps = Steps::new(network);
        let count = network.blocks.len();
        let mut folding = Self {
            folds: Vec::new(),
            visible: vec![false; count],
            fold_of: vec![None; count],
            hidden_nodes: vec![None; network.nodes.len()],
        };
        folding.visible[root.index()] = true;
        if options.collapsed.contains(&root) {
            folding.fold(network, &[root], None, steps.counts[root.index()]);
        }
        for at in (0..count).rev() {
            if !folding.visible[at] || folding.fold_of[at].is_some() {
                continue;
            }
            let (id, kind) = (BlockId::from_index(at), &network.blocks[at].kind);
            let children = block_children(kind);
            let mut from = 0;
            while let Some(&child) = children.get(from).filter(|child| child.index() < at) {
                let run = steps.run(&children[from..], options);
                let members = &children[from..from + run];
                let count = members.iter().map(|member| steps.counts[member.index()]).sum();
                if run > 1 {
                    let parent = (!matches!(kind, BlockKind::Sequence { .. })).then_some(id);
                    folding.fold(network, members, parent, count);
                } else if steps.is_folded(network, child, options) {
                    folding.fold(network, members, None, count);
                } else {
                    folding.visible[child.index()] = true;
                }
                from += run;
            }
        }
        folding.hide(network);
        folding
    }

    /// Puts neighbours behind one box, between the ends of `parent` if they are branches of it.
    fn fold(&mut self, network: &Network, members: &[BlockId], parent: Option<BlockId>, steps: u32) {
        let (Some(&first), Some(&last)) = (members.first(), members.last()) else { return };
        let (start, end) = match parent.map(|parent| &network.blocks[parent.index()]) {
            Some(parent) => (parent.start, parent.end),
            None => (network.blocks[first.index()].start, network.blocks[last.index()].end),
        };
        for member in members {
            self.visible[member.index()] = true;
            self.fold_of[member.index()] = Some(self.folds.len() as u32);
        }
        self.folds.push(Fold { first, last, start, end, steps });
    }

    /// Tells the nodes that lie behind boxes, and the blocks inside of those, which box it is.
    fn hide(&mut self, network: &Network) {
        for at in (0..network.blocks.len()).rev() {
            let Some(fold) = self.fold_of[at] else { continue };
            let block = &network.blocks[at];
            let ends = self.folds[fold as usize];
            for node in [block.start, block.end] {
                if node != ends.start && node != ends.end {
                    self.hidden_nodes[node.index()] = Some(fold);
                }
            }
            if let BlockKind::Leaf { arc } = &block.kind {
                for piece in path_chain(network, *arc) {
                    let node = network.arcs[piece.index()].to;
                    if node != ends.end {
                        self.hidden_nodes[node.index()] = Some(fold);
                    }
                }
            }
            for child in block_children(&block.kind).iter().filter(|child| child.index() < at) {
                self.fold_of[child.index()] = Some(fold);
            }
        }
    }
}

/// How many steps of the program each block holds, and which blocks those are.
struct Steps {
    counts: Vec<u32>,
    /// The first block inside of each; all up to the block itself are inside.
    first: Vec<u32>,
}

impl Steps {
    fn new(network: &Network) -> Self {
        let mut steps = Self { counts: Vec::new(), first: Vec::new() };
        for (at, block) in network.blocks.iter().enumerate() {
            let is_step = match &block.kind {
                BlockKind::Leaf { arc } => network.arcs[arc.index()].kind != ArcKind::Glue,
                _ => false,
            };
            let inside = block_children(&block.kind).iter().filter(|child| child.index() < at);
            let (mut count, mut first) = (u32::from(is_step), at as u32);
            for child in inside {
                count += steps.counts[child.index()];
                first = first.min(steps.first[child.index()]);
            }
            steps.counts.push(count);
            steps.first.push(first);
        }
        steps
    }

    /// Which of the places in more detail a block lies in, if any; `Err` if it is one or holds one, so that it is open.
    fn zone(&self, block: BlockId, options: &Options) -> Result<Option<usize>, ()> {
        let (low, high) = (self.first[block.index()], block.0);
        for (at, finer) in options.detail.finer.iter().enumerate().rev() {
            let begin = self.first.get(finer.first.index()).copied().unwrap_or(finer.first.0);
            let end = finer.last.0;
            if high < begin || low > end {
                continue;
            }
            let is_inside = low >= begin && high <= end && (low, high) != (begin, end);
            return if is_inside { Ok(Some(at)) } else { Err(()) };
        }
        Ok(None)
    }

    fn is_folded(&self, network: &Network, block: BlockId, options: &Options) -> bool {
        let (count, ends) = (self.counts[block.index()], &network.blocks[block.index()]);
        let is_activity = matches!(ends.kind, BlockKind::Scope { occurrence: Some(_), .. });
        let least = if is_activity { LEAST_ACTIVITY } else { LEAST_RUN };
        let is_fine =
            count >= least && self.zone(block, options).is_ok_and(|zone| count <= grain(options, zone));
        ends.start != ends.end && (is_fine || options.collapsed.contains(&block))
    }

    /// How many blocks from the first of `children` on take one box together, or 1.
    fn run(&self, children: &[BlockId], options: &Options) -> usize {
        let Some(Ok(zone)) = children.first().map(|&child| self.zone(child, options)) else { return 1 };
        let grain = grain(options, zone);
        let (mut count, mut length) = (0, 0);
        for &child in children {
            let steps = self.counts[child.index()];
            let fits = steps * SMALL_SHARE <= grain && count + steps <= grain;
            if !fits || self.zone(child, options) != Ok(zone) || options.collapsed.contains(&child) {
                break;
            }
            count += steps;
            length += 1;
        }
        if count >= LEAST_RUN { length.max(1) } else { 1 }
    }
}

/// How many steps a box may hold in a place in more detail, or elsewhere.
fn grain(options: &Options, zone: Option<usize>) -> u32 {
    zone.and_then(|at| options.detail.finer.get(at)).map_or(options.detail.grain, |finer| finer.grain)
}
