//! The program's structure as a tree of durations.
//!
//! A block touches the rest of its network only in its first and its last event, so all that its inside demands is
//! one interval for its duration. Intervals of a sequence add up, those of parallel branches and spanning bounds
//! intersect, and a choice has a relaxation: the least interval that contains those of its alternatives.

mod blocks;
mod duration;
mod enclosing;

use tpn::{ArcId, BlockId, DecisionId, NodeId};
use typed_index_collections::TiVec;

use crate::model::{INFINITE, Model};
use crate::unplannable::Unplannable;

pub(crate) use enclosing::{Enclosing, Within};

/// The tree, with the duration of each block before any choice.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    /// Children before their parents.
    blocks: TiVec<BlockId, TreeBlock>,
    /// The children of all blocks, and their own arcs; each block has its range of them.
    children: Vec<BlockId>,
    own_arcs: Vec<ArcId>,
    initial: TiVec<BlockId, Duration>,
    /// The block of each decision.
    decision_blocks: TiVec<DecisionId, BlockId>,
    /// The block that each arc is a leaf or a spanning arc of; `None` for arcs between blocks.
    arc_blocks: TiVec<ArcId, Option<BlockId>>,
}

#[derive(Clone, Copy, Debug)]
struct TreeBlock {
    parent: Option<BlockId>,
    /// Where it stands among its siblings.
    position: u32,
    depth: u32,
    shape: Shape,
    /// Where its part of [`Structure::children`] begins, and how many there are.
    children: (u32, u32),
    /// The same of [`Structure::own_arcs`].
    own_arcs: (u32, u32),
    /// What the arcs from the parent's first event, and to its last or the next sibling's first, add to the duration.
    around: (i64, i64),
    /// The bounds of its own arcs.
    own: (i64, i64),
    /// Its first and last event.
    ends: (NodeId, NodeId),
    /// The arcs that lead to it from the parent's first event and from it to the parent's last or the next sibling's
    /// first; `None` where these are the block's own.
    around_arcs: (Option<ArcId>, Option<ArcId>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Leaf,
    Sequence,
    /// Parallel branches, or one child under spanning arcs.
    Intersection,
    /// Its own arc, then its child.
    Guard,
    Choice(DecisionId),
}

/// The least and greatest duration of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Duration {
    lower: i64,
    /// Of a sequence: the sum of what is finite.
    upper: i64,
    /// How many parts of the upper bound have none.
    unbounded: u32,
}

impl Duration {
    const NEVER: Self = Self { lower: 1, upper: 0, unbounded: 0 };

    fn upper(self) -> i64 {
        if self.unbounded > 0 { INFINITE } else { self.upper }
    }

    fn is_empty(self) -> bool {
        self.lower > self.upper()
    }

    fn new(lower: i64, upper: i64) -> Self {
        if upper == INFINITE {
            Self { lower, upper: 0, unbounded: 1 }
        } else {
            Self { lower, upper, unbounded: 0 }
        }
    }
}

/// How one of two blocks stands to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Relation {
    /// The first is over when the second begins, or before.
    Before,
    /// The other way round.
    After,
    /// The structure does not say.
    Open,
}

/// A choice that may take more different durations is not looked into.
const MAX_DURATIONS: usize = 16;

impl Structure {
    /// Computes all durations again from the model's bounds.
    pub(crate) fn refresh(&mut self, model: &Model) -> Result<(), Unplannable> {
        self.initial.clear();
        self.initial.resize(self.blocks.len(), Duration::NEVER);
        for id in self.blocks.keys() {
            self.blocks[id].own = self.own_bounds(model, id);
            self.blocks[id].around = self.around(model, id)?;
            self.initial[id] = self.initial_duration(id)?;
        }
        Ok(())
    }

    /// Changes one arc's bounds in the tree, where only its own block and its ancestors depend on it. `false` if the
    /// arc is structural and everything must be refreshed.
    pub(crate) fn set_arc(&mut self, model: &Model, arc: ArcId) -> Result<bool, Unplannable> {
        let Some(own) = self.arc_blocks[arc] else { return Ok(false) };
        self.blocks[own].own = self.own_bounds(model, own);
        let mut above = Some(own);
        while let Some(id) = above {
            let duration = self.initial_duration(id)?;
            if duration == self.initial[id] {
                break;
            }
            self.initial[id] = duration;
            above = self.blocks[id].parent;
        }
        Ok(true)
    }

    fn children(&self, id: BlockId) -> &[BlockId] {
        let (first, count) = self.blocks[id].children;
        &self.children[first as usize..(first + count) as usize]
    }

    fn child(&self, id: BlockId, position: u32) -> BlockId {
        self.children[(self.blocks[id].children.0 + position) as usize]
    }

    fn own_arcs(&self, id: BlockId) -> &[ArcId] {
        let (first, count) = self.blocks[id].own_arcs;
        &self.own_arcs[first as usize..(first + count) as usize]
    }

    /// The first and last event of a choice, and how long it can take whatever is chosen.
    pub(crate) fn initial_bounds(&self, decision: DecisionId) -> (NodeId, NodeId, i64, i64) {
        let block = self.decision_blocks[decision];
        let (from, to) = self.blocks[block].ends;
        (from, to, self.initial[block].lower, self.initial[block].upper())
    }

    /// The alternatives of a choice that can be over first: of several those that must be over first, then those with the
    /// fewest parts.
    pub(crate) fn shortest(&self, decision: DecisionId) -> Vec<u32> {
        let alternatives = (0..).zip(self.children(self.decision_blocks[decision]));
        let lasts = alternatives.filter_map(|(alternative, &child)| {
            let inside = self.initial[child];
            let duration = self.with_around(inside, child).ok().filter(|_| !inside.is_empty())?;
            Some(((duration.lower, duration.upper(), self.children(child).len()), alternative))
        });
        let lasts: Vec<_> = lasts.collect();
        let least = lasts.iter().map(|&(last, _)| last).min();
        lasts.into_iter().filter(|&(last, _)| Some(last) == least).map(|(_, it)| it).collect()
    }

    /// Least and greatest durations of which a choice has one, whichever alternatives are taken in it: one interval where
    /// they all have something in common. `None` if there are too many.
    pub(crate) fn durations(&self, decision: DecisionId) -> Option<Vec<(i64, i64)>> {
        self.durations_of(self.decision_blocks[decision])
    }

    fn durations_of(&self, id: BlockId) -> Option<Vec<(i64, i64)>> {
        let block = &self.blocks[id];
        let is_choice = matches!(block.shape, Shape::Choice(_));
        let mut all = match block.shape {
            Shape::Leaf | Shape::Guard | Shape::Intersection => vec![block.own],
            Shape::Sequence => vec![(0, 0)],
            Shape::Choice(_) => Vec::new(),
        };
        for &child in self.children(id) {
            let mut parts = Vec::new();
            for (lower, upper) in self.durations_of(child)? {
                let part = self.with_around(Duration::new(lower, upper), child).ok()?;
                parts.push((part.lower, part.upper()));
            }
            if is_choice {
                all.extend(parts);
                continue;
            }
            let mut combined = Vec::new();
            for &whole in &all {
                for &part in &parts {
                    combined.push(match block.shape {
                        Shape::Sequence | Shape::Guard => {
                            let sum = sum_of(Duration::new(whole.0, whole.1), Duration::new(part.0, part.1))?;
                            (sum.lower, sum.upper())
                        }
                        _ => intersect(whole, part),
                    });
                }
            }
            all = combined;
            if all.len() > MAX_DURATIONS {
                return None;
            }
        }
        // What is empty cannot be taken.
        all.retain(|&(lower, upper)| lower <= upper);
        if is_choice
            && let Some(common) = all.iter().copied().reduce(intersect)
            && common.0 <= common.1
        {
            all = vec![common];
        }
        (all.len() <= MAX_DURATIONS).then_some(all)
    }

    /// Returns what the nesting alone says about two arcs.
    pub(crate) fn relation(&self, left_arc: ArcId, right_arc: ArcId) -> Relation {
        let (Some(mut left), Some(mut right)) = (self.arc_blocks[left_arc], self.arc_blocks[right_arc])
        else {
            return Relation::Open;
        };
        let (mut left_position, mut right_position) = (None, None);
        while left != right {
            let (left_block, right_block) = (&self.blocks[left], &self.blocks[right]);
            if left_block.depth >= right_block.depth {
                let Some(parent) = left_block.parent else { return Relation::Open };
                (left, left_position) = (parent, Some(left_block.position));
            }
            if right_block.depth >= left_block.depth {
                let Some(parent) = right_block.parent else { return Relation::Open };
                (right, right_position) = (parent, Some(right_block.position));
            }
        }
        match (left_position, right_position) {
            (Some(left_position), Some(right_position)) if self.blocks[left].shape == Shape::Sequence => {
                if left_position < right_position {
                    Relation::Before
                } else {
                    Relation::After
                }
            }
            _ => Relation::Open,
        }
    }

    /// The duration of a block with that of the arcs around it.
    fn with_around(&self, duration: Duration, id: BlockId) -> Result<Duration, Unplannable> {
        add(duration, self.blocks[id].around).ok_or_else(|| self.overflow(id))
    }

    /// That the duration of a block does not fit.
    fn overflow(&self, id: BlockId) -> Unplannable {
        Unplannable::at(self.blocks[id].ends.1)
    }
}

fn bounds(model: &Model, arc: ArcId) -> (i64, i64) {
    let arc = &model.arcs[arc];
    (arc.lower, arc.upper)
}

fn intersect(left: (i64, i64), right: (i64, i64)) -> (i64, i64) {
    (left.0.max(right.0), left.1.min(right.1))
}

/// `None` if the sum does not fit.
fn add(inside: Duration, around: (i64, i64)) -> Option<Duration> {
    Some(if around.1 == INFINITE {
        Duration {
            lower: inside.lower.checked_add(around.0)?,
            upper: inside.upper,
            unbounded: inside.unbounded + 1,
        }
    } else {
        Duration {
            lower: inside.lower.checked_add(around.0)?,
            upper: inside.upper.checked_add(around.1)?,
            unbounded: inside.unbounded,
        }
    })
}

/// `None` if the sum does not fit.
fn sum_of(left: Duration, right: Duration) -> Option<Duration> {
    Some(Duration {
        lower: left.lower.checked_add(right.lower)?,
        upper: left.upper.checked_add(right.upper)?,
        unbounded: left.unbounded + right.unbounded,
    })
}
