//! Which parts of a program come one after the other whatever is chosen, by its blocks alone (SPEC 3.3).

use tpn::{ArcId, BlockId, BlockKind, Network};

use crate::structure::Relation;

/// The tree of a program's blocks, and which block each arc belongs to.
#[derive(Clone, Debug)]
pub(crate) struct Nesting {
    /// Indexed by arc.
    block_of: Vec<Option<BlockId>>,
    /// Indexed by block.
    places: Vec<Place>,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    parent: Option<BlockId>,
    /// Where it stands among its siblings.
    position: u32,
    depth: u32,
    is_sequence: bool,
}

impl Nesting {
    /// `None` if the network came without a program's structure. Linear in its size.
    pub(crate) fn new(network: &Network) -> Option<Self> {
        let root = network.root?;
        let unknown = Place { parent: None, position: 0, depth: 0, is_sequence: false };
        let mut nesting =
            Self { block_of: vec![None; network.arcs.len()], places: vec![unknown; network.blocks.len()] };
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            let depth = nesting.places[id.index()].depth + 1;
            let (arcs, children): (&[ArcId], &[BlockId]) = match &network.blocks[id.index()].kind {
                BlockKind::Leaf { arc } => (std::slice::from_ref(arc), &[]),
                BlockKind::Sequence { children } => (&[], children),
                BlockKind::Parallel { branches } => (&[], branches),
                BlockKind::Choose { alternatives, .. } => (&[], alternatives),
                BlockKind::Scope { child, arcs, .. } => (arcs, std::slice::from_ref(child)),
                // What is asked first is over when the rest begins.
                BlockKind::Guard { arc, child } => (std::slice::from_ref(arc), std::slice::from_ref(child)),
            };
            nesting.places[id.index()].is_sequence =
                matches!(network.blocks[id.index()].kind, BlockKind::Sequence { .. });
            for arc in arcs {
                nesting.block_of[arc.index()] = Some(id);
            }
            for (position, child) in (0..).zip(children) {
                let place = &mut nesting.places[child.index()];
                (place.parent, place.position, place.depth) = (Some(id), position, depth);
                open.push(*child);
            }
        }
        Some(nesting)
    }

    /// Returns which of two arcs is over when the other begins, if the program says so. Takes time linear in their
    /// depth.
    pub(crate) fn relation(&self, left: ArcId, right: ArcId) -> Relation {
        let block_of = |arc: ArcId| self.block_of.get(arc.index()).copied().flatten();
        let (Some(own), Some(others)) = (block_of(left), block_of(right)) else { return Relation::Open };
        let (mut one, mut other) = (own, others);
        let place = |block: BlockId| self.places[block.index()];
        let mut positions = (0, 0);
        while one != other {
            let (depth, other_depth) = (place(one).depth, place(other).depth);
            if depth >= other_depth {
                positions.0 = place(one).position;
                let Some(parent) = place(one).parent else { return Relation::Open };
                one = parent;
            }
            if other_depth >= depth {
                positions.1 = place(other).position;
                let Some(parent) = place(other).parent else { return Relation::Open };
                other = parent;
            }
        }
        let is_inside = own == one || others == one;
        match positions.0.cmp(&positions.1) {
            _ if is_inside || !place(one).is_sequence => Relation::Open,
            std::cmp::Ordering::Less => Relation::Before,
            std::cmp::Ordering::Greater => Relation::After,
            std::cmp::Ordering::Equal => Relation::Open,
        }
    }
}
