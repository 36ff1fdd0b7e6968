//! What each block of a network holds, whatever of it is drawn.

use tpn::{ArcKind, BlockId, BlockKind, Network, NodeId, OccurrenceId, OccurrenceKind};

use crate::folding::Fold;
use crate::tree::{block_children, path_chain};

/// The first and the last of some occurrences, in textual order.
pub(crate) type Ends = Option<(OccurrenceId, OccurrenceId)>;

/// What each block of a network holds.
pub(crate) struct Contents {
    /// How many steps of the program.
    steps: Vec<u32>,
    /// The first block inside; all up to the block itself are inside.
    first: Vec<u32>,
    /// The outermost activities, and what is asserted if there are none.
    named: [Vec<Ends>; 2],
    /// Of each node, the first block that begins, ends or passes there, if any does.
    homes: Vec<Option<BlockId>>,
    /// How many nodes have their home before each block.
    homed: Vec<u32>,
}

impl Contents {
    /// Linear in the network.
    pub(crate) fn new(network: &Network) -> Self {
        let count = network.blocks.len();
        let mut contents = Self {
            steps: Vec::with_capacity(count),
            first: Vec::with_capacity(count),
            named: [Vec::with_capacity(count), Vec::with_capacity(count)],
            homes: vec![None; network.nodes.len()],
            homed: Vec::with_capacity(count + 1),
        };
        let mut homed = 0;
        for at in 0..count {
            contents.homed.push(homed);
            homed += contents.add(network, BlockId::from_index(at));
        }
        contents.homed.push(homed);
        contents
    }

    /// Adds the next block, and answers of how many nodes it is the home.
    fn add(&mut self, network: &Network, id: BlockId) -> u32 {
        let block = &network.blocks[id.index()];
        let arc = match &block.kind {
            BlockKind::Leaf { arc } => Some(&network.arcs[arc.index()]),
            _ => None,
        };
        let inside =
            || block_children(&block.kind).iter().filter(|child| **child < id).map(|child| child.index());
        let is_step = arc.is_some_and(|arc| arc.kind != ArcKind::Glue);
        let steps = inside().map(|child| self.steps[child]).sum::<u32>() + u32::from(is_step);
        self.steps.push(steps);
        self.first.push(inside().map(|child| self.first[child]).min().unwrap_or(id.0));

        let occurrence = match &block.kind {
            BlockKind::Scope { occurrence, .. } => *occurrence,
            _ => arc.and_then(|arc| arc.occurrence),
        };
        let kind = occurrence.map(|occurrence| network.occurrences[occurrence.index()].kind);
        let is_activity = matches!(kind, Some(OccurrenceKind::Primitive | OccurrenceKind::Activity));
        for (named, is_wanted) in
            self.named.iter_mut().zip([is_activity, kind == Some(OccurrenceKind::Assertion)])
        {
            let own = occurrence.filter(|_| is_wanted).map(|occurrence| (occurrence, occurrence));
            let all = inside().filter_map(|child| named[child]).reduce(|all, next| (all.0, next.1));
            named.push(own.or(all));
        }

        let mut count = 0;
        let mut visit = |node: NodeId| {
            let home = &mut self.homes[node.index()];
            count += u32::from(home.is_none());
            home.get_or_insert(id);
        };
        visit(block.start);
        visit(block.end);
        if let BlockKind::Leaf { arc } = &block.kind {
            for piece in path_chain(network, *arc) {
                visit(network.arcs[piece.index()].to);
            }
        }
        count
    }

    pub(crate) fn steps(&self, block: BlockId) -> u32 {
        self.steps[block.index()]
    }

    /// The first of the blocks inside of a block; they end with the block itself.
    pub(crate) fn first_inside(&self, block: BlockId) -> BlockId {
        BlockId(self.first.get(block.index()).copied().unwrap_or(block.0))
    }

    /// The first and the last outermost activity in neighbors, or what is asserted there if there is none. What an
    /// activity does inside is its own.
    pub(crate) fn named(&self, members: &[BlockId]) -> Ends {
        let among = |named: &Vec<Ends>| {
            members.iter().filter_map(|member| named[member.index()]).reduce(|all, next| (all.0, next.1))
        };
        self.named.iter().find_map(among)
    }

    /// Returns how many events a box hides.
    pub(crate) fn events(&self, fold: &Fold) -> u32 {
        let (first, last) = (self.first_inside(fold.first), fold.last);
        let ends = if fold.start == fold.end { vec![fold.start] } else { vec![fold.start, fold.end] };
        let ends = ends.into_iter().filter(|end| self.is_home(fold, *end)).count() as u32;
        self.homed[last.index() + 1] - self.homed[first.index()] - ends
    }

    /// Returns which of the boxes hides a node.
    pub(crate) fn hider<'a>(&self, node: NodeId, folds: &'a [Fold]) -> Option<&'a Fold> {
        folds.iter().find(|fold| node != fold.start && node != fold.end && self.is_home(fold, node))
    }

    /// The first block that begins, ends or passes at a node.
    pub(crate) fn home(&self, node: NodeId) -> Option<BlockId> {
        self.homes[node.index()]
    }

    /// Returns whether a block is the home of a node, or holds it.
    pub(crate) fn holds(&self, block: BlockId, node: NodeId) -> bool {
        self.home(node).is_some_and(|home| home >= self.first_inside(block) && home <= block)
    }

    /// Returns whether the home of a node is behind a box.
    fn is_home(&self, fold: &Fold, node: NodeId) -> bool {
        self.home(node).is_some_and(|home| home >= self.first_inside(fold.first) && home <= fold.last)
    }
}
