//! The structure that a drawing follows: arcs in series, fans of branches, and arcs that span what is below them.
//!
//! It is made from the blocks of a program here, and from a bare graph in [`crate::recover`].

use std::ops::Range;

use tpn::{ArcId, ArcKind, BlockId, BlockKind, Network, NodeId, OccurrenceId};

use crate::folding::Folding;

/// A part of the tree, by its position in [`Tree::parts`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct PartId(pub(crate) u32);

impl PartId {
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Parts, children before parents.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tree {
    pub(crate) parts: Vec<Part>,
    /// The children of series, each series a range.
    pub(crate) children: Vec<PartId>,
    /// The branches of fans, each fan a range.
    pub(crate) branches: Vec<Branch>,
    /// The arcs of spans, outermost first, and the pieces of paths, in order; each span and path a range.
    pub(crate) spanning: Vec<ArcId>,
    /// Irregular graphs between two nodes.
    pub(crate) cores: Vec<Core>,
    pub(crate) root: Option<PartId>,
    /// Arcs that the structure does not have; they are drawn across it.
    pub(crate) across: Vec<ArcId>,
    pub(crate) folding: Folding,
}

/// A piece of the network between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    pub(crate) kind: PartKind,
    pub(crate) start: NodeId,
    pub(crate) end: NodeId,
    pub(crate) block: Option<BlockId>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PartKind {
    Arc(ArcId),
    /// A node by itself, or nothing between two nodes.
    Nothing,
    /// One after the other, neighbors sharing a node.
    Series(Range<u32>),
    Fan {
        branches: Range<u32>,
        is_choice: bool,
    },
    /// Arcs above a child that has the same ends.
    Span {
        child: PartId,
        arcs: Range<u32>,
        occurrence: Option<OccurrenceId>,
    },
    /// An arc with the pieces of its path above it, as a string of beads.
    Beads {
        arc: ArcId,
        chain: Range<u32>,
    },
    /// A box that hides what is between the ends, by its position in [`Folding::folds`].
    Collapsed(u32),
    /// An irregular graph.
    Core(u32),
}

/// One branch of a fan: `fork`, then `child`, then `join`. Without child and join, `fork` goes all the way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Branch {
    pub(crate) fork: Option<ArcId>,
    pub(crate) child: Option<PartId>,
    pub(crate) join: Option<ArcId>,
    /// The block of the branch.
    pub(crate) block: Option<BlockId>,
}

/// A graph between two nodes that is not made of series and fans.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Core {
    /// Its nodes, in topological order; the first is the start, the last the end.
    pub(crate) nodes: Vec<NodeId>,
    /// Its edges: from and to as positions in `nodes`, and what is between.
    pub(crate) edges: Vec<(u32, u32, PartId)>,
}

impl Tree {
    pub(crate) fn push(
        &mut self,
        kind: PartKind,
        start: NodeId,
        end: NodeId,
        block: Option<BlockId>,
    ) -> PartId {
        self.parts.push(Part { kind, start, end, block });
        PartId(self.parts.len() as u32 - 1)
    }

    pub(crate) fn part(&self, id: PartId) -> &Part {
        &self.parts[id.index()]
    }

    pub(crate) fn push_arc(&mut self, network: &Network, arc: ArcId) -> PartId {
        let ends = &network.arcs[arc.index()];
        self.push(PartKind::Arc(arc), ends.from, ends.to, None)
    }

    pub(crate) fn push_series(&mut self, children: &[PartId], block: Option<BlockId>) -> Option<PartId> {
        let (&first, &last) = (children.first()?, children.last()?);
        if children.len() == 1 {
            let part = &mut self.parts[first.index()];
            part.block = part.block.or(block);
            return Some(first);
        }
        let begin = self.children.len() as u32;
        self.children.extend_from_slice(children);
        let kind = PartKind::Series(begin..self.children.len() as u32);
        Some(self.push(kind, self.part(first).start, self.part(last).end, block))
    }

    pub(crate) fn children(&self, range: &Range<u32>) -> &[PartId] {
        &self.children[range.start as usize..range.end as usize]
    }

    pub(crate) fn spanning(&self, range: &Range<u32>) -> &[ArcId] {
        &self.spanning[range.start as usize..range.end as usize]
    }

    /// The branch that consists of `part`, with the fork and join arcs that `known` has. Where it has none, the arc that
    /// the part begins or ends with takes the place, so that it runs all the way from the fork or to the join.
    pub(crate) fn peeled(&mut self, part: PartId, known: Branch) -> Branch {
        let arc_of = |tree: &Self, part: PartId| match tree.part(part).kind {
            PartKind::Arc(arc) => Some(arc),
            _ => None,
        };
        if let (Some(arc), None, None) = (arc_of(self, part), known.fork, known.join) {
            return Branch { fork: Some(arc), child: None, ..known };
        }
        let members = match &self.part(part).kind {
            PartKind::Series(range) => self.children(range).to_vec(),
            PartKind::Arc(_) => vec![part],
            _ => return Branch { child: Some(part), ..known },
        };
        let first = members.first().and_then(|&first| arc_of(self, first)).filter(|_| known.fork.is_none());
        let last = members.last().and_then(|&last| arc_of(self, last)).filter(|_| known.join.is_none());
        let (begin, end) = (usize::from(first.is_some()), members.len() - usize::from(last.is_some()));
        let middle = if first.is_some() { self.part(members[0]).end } else { self.part(part).start };
        let child = match members.get(begin..end) {
            Some(inner) if inner.len() == members.len() => Some(part),
            Some(inner) => self.push_series(inner, None),
            None => None,
        };
        let child = child.unwrap_or_else(|| self.push(PartKind::Nothing, middle, middle, None));
        Branch { fork: first.or(known.fork), child: Some(child), join: last.or(known.join), ..known }
    }

    /// Returns whether a part begins with a gap, so that no line leads into it.
    pub(crate) fn begins_with_nothing(&self, part: PartId) -> bool {
        match &self.part(part).kind {
            PartKind::Nothing => true,
            PartKind::Series(range) => {
                self.children(range).first().is_some_and(|&first| self.part(first).kind == PartKind::Nothing)
            }
            _ => false,
        }
    }

    /// Returns whether a part ends with a gap, so that no line leads out of it.
    pub(crate) fn ends_with_nothing(&self, part: PartId) -> bool {
        match &self.part(part).kind {
            PartKind::Nothing => true,
            PartKind::Series(range) => {
                self.children(range).last().is_some_and(|&last| self.part(last).kind == PartKind::Nothing)
            }
            _ => false,
        }
    }

    pub(crate) fn branches(&self, range: &Range<u32>) -> &[Branch] {
        &self.branches[range.start as usize..range.end as usize]
    }
}

/// The tree of a network whose blocks are known, as it is folded under `root`; `None` if the blocks do not hold together.
pub(crate) fn tree_from_blocks(network: &Network, root: BlockId, folding: Folding) -> Option<Tree> {
    let shown = folding.shown.clone();
    let mut builder = Builder {
        network,
        tree: Tree { folding, ..Tree::default() },
        part_of_block: vec![None; network.blocks.len()],
        arc_to: vec![None; network.nodes.len()],
        arc_from: vec![None; network.nodes.len()],
    };
    for block in shown {
        builder.part_of_block[block.index()] = builder.part(block);
    }
    builder.tree.root = builder.part_of_block[root.index()];
    builder.tree.root.is_some().then_some(builder.tree)
}

/// The blocks directly inside a block, in textual order.
pub fn block_children(kind: &BlockKind) -> &[BlockId] {
    match kind {
        BlockKind::Leaf { .. } => &[],
        BlockKind::Sequence { children } => children,
        BlockKind::Parallel { branches } => branches,
        BlockKind::Choose { alternatives, .. } => alternatives,
        BlockKind::Scope { child, .. } | BlockKind::Guard { child, .. } => std::slice::from_ref(child),
    }
}

/// The pieces of the path of a traverse (SPEC 7.3), in order; empty if `arc` has no path beside it.
pub(crate) fn path_chain(network: &Network, arc: ArcId) -> Vec<ArcId> {
    let (mut at, end) = (network.arcs[arc.index()].from, network.arcs[arc.index()].to);
    let mut chain = Vec::new();
    while at != end && chain.len() < network.nodes.len() {
        let outgoing = &network.nodes[at.index()].out_arcs;
        let Some(&piece) = outgoing.iter().find(|piece| network.arcs[piece.index()].kind == ArcKind::Path)
        else {
            return Vec::new();
        };
        chain.push(piece);
        at = network.arcs[piece.index()].to;
    }
    if at == end { chain } else { Vec::new() }
}

struct Builder<'a> {
    network: &'a Network,
    tree: Tree,
    part_of_block: Vec<Option<PartId>>,
    /// Scratch: of the node being looked at, the arc to each other node.
    arc_to: Vec<Option<ArcId>>,
    /// Scratch: of the node being looked at, the arc from each other node.
    arc_from: Vec<Option<ArcId>>,
}

impl Builder<'_> {
    /// The part of a block; of blocks that share a box, the first has it.
    fn part(&mut self, id: BlockId) -> Option<PartId> {
        let network = self.network;
        let block = &network.blocks[id.index()];
        if let Some(at) = self.tree.folding.fold_of[id.index()] {
            let fold = self.tree.folding.folds[at as usize];
            let kind = PartKind::Collapsed(at);
            return (fold.first == id).then(|| self.tree.push(kind, fold.start, fold.end, Some(id)));
        }
        match &block.kind {
            BlockKind::Leaf { arc } => Some(self.leaf(id, *arc)),
            BlockKind::Sequence { children } => self.sequence(id, children),
            BlockKind::Parallel { branches } => Some(self.fan(id, branches, false)),
            BlockKind::Choose { alternatives, .. } => Some(self.fan(id, alternatives, true)),
            BlockKind::Scope { child, arcs, occurrence } => {
                let child = self.between(block.start, *child, block.end)?;
                Some(self.span(child, arcs, *occurrence, Some(id)))
            }
            BlockKind::Guard { arc, child } => {
                let guard = self.tree.push_arc(network, *arc);
                let child = self.child(*child)?;
                let mut pieces = vec![guard, child];
                let end = self.tree.part(child).end;
                pieces.extend(self.glue(end, block.end));
                self.tree.push_series(&pieces, Some(id))
            }
        }
    }

    fn child(&self, id: BlockId) -> Option<PartId> {
        self.part_of_block.get(id.index()).copied().flatten()
    }

    fn leaf(&mut self, id: BlockId, arc: ArcId) -> PartId {
        let path = path_chain(self.network, arc);
        if !path.is_empty() {
            let begin = self.tree.spanning.len() as u32;
            self.tree.spanning.extend(path);
            let chain = begin..self.tree.spanning.len() as u32;
            let ends = &self.network.arcs[arc.index()];
            return self.tree.push(PartKind::Beads { arc, chain }, ends.from, ends.to, Some(id));
        }
        let part = self.tree.push_arc(self.network, arc);
        self.tree.parts[part.index()].block = Some(id);
        part
    }

    fn span(
        &mut self,
        child: PartId,
        arcs: &[ArcId],
        occurrence: Option<OccurrenceId>,
        block: Option<BlockId>,
    ) -> PartId {
        let begin = self.tree.spanning.len() as u32;
        self.tree.spanning.extend_from_slice(arcs);
        let (start, end) = (self.tree.part(child).start, self.tree.part(child).end);
        let arcs = begin..self.tree.spanning.len() as u32;
        self.tree.push(PartKind::Span { child, arcs, occurrence }, start, end, block)
    }

    fn sequence(&mut self, id: BlockId, children: &[BlockId]) -> Option<PartId> {
        let mut pieces: Vec<PartId> = Vec::with_capacity(children.len() * 2);
        for &child in children {
            let Some(child) = self.child(child) else { continue };
            if let Some(&last) = pieces.last() {
                let (from, to) = (self.tree.part(last).end, self.tree.part(child).start);
                pieces.extend(self.glue(from, to));
            }
            pieces.push(child);
        }
        self.tree.push_series(&pieces, Some(id))
    }

    /// The arc from one node to the next, as a part, if they are different.
    fn glue(&mut self, from: NodeId, to: NodeId) -> Option<PartId> {
        if from == to {
            return None;
        }
        let outgoing = &self.network.nodes[from.index()].out_arcs;
        match outgoing.iter().find(|arc| self.network.arcs[arc.index()].to == to) {
            Some(&arc) => Some(self.tree.push_arc(self.network, arc)),
            None => Some(self.tree.push(PartKind::Nothing, from, to, None)),
        }
    }

    /// The child with the arcs that tie it to `start` and `end`.
    fn between(&mut self, start: NodeId, child: BlockId, end: NodeId) -> Option<PartId> {
        let child = self.child(child)?;
        let (child_start, child_end) = (self.tree.part(child).start, self.tree.part(child).end);
        let mut pieces = Vec::with_capacity(3);
        pieces.extend(self.glue(start, child_start));
        pieces.push(child);
        pieces.extend(self.glue(child_end, end));
        self.tree.push_series(&pieces, None)
    }

    fn fan(&mut self, id: BlockId, blocks: &[BlockId], is_choice: bool) -> PartId {
        let network = self.network;
        let block = &network.blocks[id.index()];
        // One look at each arc of the fork and of the join keeps wide fans linear.
        for &arc in network.nodes[block.start.index()].out_arcs.iter().rev() {
            self.arc_to[network.arcs[arc.index()].to.index()] = Some(arc);
        }
        for &arc in network.nodes[block.end.index()].in_arcs.iter().rev() {
            self.arc_from[network.arcs[arc.index()].from.index()] = Some(arc);
        }
        let mut branches = Vec::with_capacity(blocks.len());
        for &branch in blocks {
            let Some(child) = self.child(branch) else { continue };
            let part = self.tree.part(child);
            let fork = if part.start == block.start { None } else { self.arc_to[part.start.index()] };
            let join = if part.end == block.end { None } else { self.arc_from[part.end.index()] };
            branches.push(self.tree.peeled(child, Branch { fork, child: None, join, block: Some(branch) }));
        }
        for &arc in &network.nodes[block.start.index()].out_arcs {
            self.arc_to[network.arcs[arc.index()].to.index()] = None;
        }
        for &arc in &network.nodes[block.end.index()].in_arcs {
            self.arc_from[network.arcs[arc.index()].from.index()] = None;
        }
        if branches.is_empty() {
            return self.tree.push(PartKind::Nothing, block.start, block.end, Some(id));
        }
        let begin = self.tree.branches.len() as u32;
        self.tree.branches.extend(branches);
        let branches = begin..self.tree.branches.len() as u32;
        self.tree.push(PartKind::Fan { branches, is_choice }, block.start, block.end, Some(id))
    }
}
