//! The program's structure as a tree of durations: the fast half of phase 1.
//!
//! A block touches the rest of its network only in its first and its last event, so all that its inside demands is
//! one interval for its duration. Intervals of a sequence add up, those of parallel branches and spanning bounds
//! intersect, and a choice that is still open has the hull of its alternatives. An empty interval on the way up means
//! that no completion of the choices made so far is consistent; this is exact once all are made, and finds most dead
//! ends long before. One choice costs time proportional to the depth of its block.

mod blocks;
mod decide;
mod duration;

use stn::Overflow;

use crate::enclosed::Enclosed;
use crate::model::{INFINITE, Model, NONE};

/// The tree, with the duration of each block before any choice.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    /// Children before their parents.
    blocks: Vec<TreeBlock>,
    /// The children of all blocks, and their own arcs; each block has its range of them.
    children: Vec<u32>,
    own_arcs: Vec<u32>,
    initial: Vec<Duration>,
    /// The block of each decision.
    decision_blocks: Vec<u32>,
    /// The block that each arc is a leaf or a spanning arc of.
    arc_blocks: Vec<u32>,
    root: u32,
    /// Blocks without choices whose assertions conflict only with each other.
    enclosed: Vec<Enclosed>,
}

#[derive(Clone, Copy, Debug)]
struct TreeBlock {
    parent: u32,
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
    /// Whether there is a choice in it.
    has_choices: bool,
    /// Whether a label is in it.
    has_labels: bool,
    /// Its position in `enclosed`, or [`NONE`].
    enclosed: u32,
    /// Whether it is inside a block that is in `enclosed`.
    is_inside_enclosed: bool,
    /// Its first and last event.
    ends: (u32, u32),
    /// The arcs that lead to it from the parent's first event and from it to the parent's last or the next sibling's
    /// first, [`NONE`] where these are the block's own.
    around_arcs: (u32, u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Leaf,
    Sequence,
    /// Parallel branches, or one child under spanning arcs.
    Intersection,
    /// Its own arc, then its child.
    Guard,
    Choice(u32),
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

/// A part of the network of which only the duration counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    pub(crate) from: u32,
    pub(crate) to: u32,
    pub(crate) lower: i64,
    pub(crate) upper: i64,
    /// The choice that it is, or [`NONE`].
    pub(crate) decision: u32,
}

/// The tree during a search.
#[derive(Clone, Debug)]
pub(crate) struct TreeState {
    durations: Vec<Duration>,
    trail: Vec<(u32, Duration)>,
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

impl Structure {
    /// Computes all durations anew from the model's bounds.
    pub(crate) fn refresh(&mut self, model: &Model) -> Result<(), Overflow> {
        self.initial.clear();
        self.initial.resize(self.blocks.len(), Duration::NEVER);
        for id in 0..self.blocks.len() {
            self.blocks[id].own = self.own_bounds(model, id);
            self.blocks[id].around = self.around(model, id)?;
            self.initial[id] = self.initial_duration(model, id)?;
        }
        Ok(())
    }

    /// Changes one arc's bounds in the tree, where only its own block and its ancestors depend on it. `false` if the
    /// arc is structural and everything must be refreshed.
    pub(crate) fn set_arc(&mut self, model: &Model, arc: u32) -> Result<bool, Overflow> {
        let mut id = self.arc_blocks[arc as usize];
        if id == NONE {
            return Ok(false);
        }
        self.blocks[id as usize].own = self.own_bounds(model, id as usize);
        while id != NONE {
            let duration = self.initial_duration(model, id as usize)?;
            let is_inside_enclosed = self.blocks[id as usize].is_inside_enclosed;
            if duration == self.initial[id as usize] && !is_inside_enclosed {
                break;
            }
            self.initial[id as usize] = duration;
            id = self.blocks[id as usize].parent;
        }
        Ok(true)
    }

    fn children(&self, id: usize) -> &[u32] {
        let (first, count) = self.blocks[id].children;
        &self.children[first as usize..(first + count) as usize]
    }

    fn child(&self, id: usize, position: u32) -> u32 {
        self.children[(self.blocks[id].children.0 + position) as usize]
    }

    fn own_arcs(&self, id: usize) -> &[u32] {
        let (first, count) = self.blocks[id].own_arcs;
        &self.own_arcs[first as usize..(first + count) as usize]
    }

    /// The node where a decision is made.
    pub(crate) fn decision_node(&self, decision: u32) -> u32 {
        self.blocks[self.decision_blocks[decision as usize] as usize].ends.0
    }

    /// The duration of a choice if its first possible alternative is taken.
    pub(crate) fn first_alternative(&self, decision: u32) -> Result<Option<(i64, i64)>, Overflow> {
        let children = self.children(self.decision_blocks[decision as usize] as usize);
        let first = children.iter().find(|&&child| !self.initial[child as usize].is_empty());
        let duration =
            first.map(|&child| add(self.initial[child as usize], self.blocks[child as usize].around));
        Ok(duration.transpose()?.map(|duration| (duration.lower, duration.upper())))
    }

    /// The first and last event of a choice, and how long it can take whatever is chosen.
    pub(crate) fn initial_bounds(&self, decision: u32) -> (u32, u32, i64, i64) {
        let block = self.decision_blocks[decision as usize] as usize;
        let (from, to) = self.blocks[block].ends;
        (from, to, self.initial[block].lower, self.initial[block].upper())
    }

    pub(crate) fn start(&self) -> TreeState {
        TreeState { durations: self.initial.clone(), trail: Vec::new() }
    }

    /// Whether the mission has no consistent selection at all, whatever is chosen.
    pub(crate) fn is_empty(&self) -> bool {
        self.initial[self.root as usize].is_empty()
    }

    /// Calls `arrive` with the arcs, and `hull` with the label-free parts and open choices, that an alternative brings.
    pub(crate) fn emit_alternative(
        &self,
        (decision, alternative): (u32, u32),
        arrive: &mut impl FnMut(u32),
        hull: &mut impl FnMut(Hull),
    ) {
        let child = self.child(self.decision_blocks[decision as usize] as usize, alternative);
        self.emit_around(child, arrive);
        self.emit(child, arrive, hull);
    }

    /// The same for what every plan has.
    pub(crate) fn emit_root(&self, arrive: &mut impl FnMut(u32), hull: &mut impl FnMut(Hull)) {
        self.emit(self.root, arrive, hull);
    }

    /// The part without labels that a decision belongs to, as large as possible, with its present duration; `None` if
    /// the decision has labels in its alternatives.
    pub(crate) fn label_free_part(&self, state: &TreeState, decision: u32) -> Option<(u32, Hull)> {
        let mut id = self.decision_blocks[decision as usize];
        if self.blocks[id as usize].has_labels {
            return None;
        }
        loop {
            let parent = self.blocks[id as usize].parent;
            if parent == NONE || self.blocks[parent as usize].has_labels {
                break;
            }
            id = parent;
        }
        let (from, to) = self.blocks[id as usize].ends;
        let duration = state.durations[id as usize];
        Some((id, Hull { from, to, lower: duration.lower, upper: duration.upper(), decision: NONE }))
    }

    fn emit(&self, id: u32, arrive: &mut impl FnMut(u32), hull: &mut impl FnMut(Hull)) {
        let block = &self.blocks[id as usize];
        let choice = if let Shape::Choice(decision) = block.shape { decision } else { NONE };
        if !block.has_labels || choice != NONE {
            let duration = self.initial[id as usize];
            let (from, to) = block.ends;
            hull(Hull { from, to, lower: duration.lower, upper: duration.upper(), decision: choice });
            return;
        }
        if block.enclosed != NONE {
            let duration = self.initial[id as usize];
            let (from, to) = block.ends;
            hull(Hull { from, to, lower: duration.lower, upper: duration.upper(), decision: NONE });
        }
        for &arc in self.own_arcs(id as usize) {
            arrive(arc);
        }
        for &child in self.children(id as usize) {
            self.emit_around(child, arrive);
            self.emit(child, arrive, hull);
        }
    }

    fn emit_around(&self, id: u32, arrive: &mut impl FnMut(u32)) {
        let (enter, leave) = self.blocks[id as usize].around_arcs;
        for arc in [enter, leave] {
            if arc != NONE {
                arrive(arc);
            }
        }
    }

    /// What the nesting alone says about two arcs.
    pub(crate) fn relation(&self, left_arc: u32, right_arc: u32) -> Relation {
        let (mut left, mut right) = (self.arc_blocks[left_arc as usize], self.arc_blocks[right_arc as usize]);
        if left == NONE || right == NONE || left == right {
            return Relation::Open;
        }
        let (mut left_position, mut right_position) = (NONE, NONE);
        while left != right {
            let (left_block, right_block) = (&self.blocks[left as usize], &self.blocks[right as usize]);
            if left_block.depth >= right_block.depth {
                (left, left_position) = (left_block.parent, left_block.position);
            }
            if right_block.depth >= left_block.depth {
                (right, right_position) = (right_block.parent, right_block.position);
            }
            if left == NONE || right == NONE {
                return Relation::Open;
            }
        }
        if self.blocks[left as usize].shape != Shape::Sequence
            || left_position == NONE
            || right_position == NONE
        {
            Relation::Open
        } else if left_position < right_position {
            Relation::Before
        } else {
            Relation::After
        }
    }

    /// What a block's duration and the arcs around it come to.
    fn contribution(&self, state: &TreeState, id: u32) -> Result<Duration, Overflow> {
        add(state.durations[id as usize], self.blocks[id as usize].around)
    }
}

fn bounds(model: &Model, arc: u32) -> (i64, i64) {
    let arc = &model.arcs[arc as usize];
    (arc.lower, arc.upper)
}

fn intersect(left: (i64, i64), right: (i64, i64)) -> (i64, i64) {
    (left.0.max(right.0), left.1.min(right.1))
}

fn add(inside: Duration, around: (i64, i64)) -> Result<Duration, Overflow> {
    Ok(if around.1 == INFINITE {
        Duration {
            lower: inside.lower.checked_add(around.0).ok_or(Overflow)?,
            upper: inside.upper,
            unbounded: inside.unbounded + 1,
        }
    } else {
        Duration {
            lower: inside.lower.checked_add(around.0).ok_or(Overflow)?,
            upper: inside.upper.checked_add(around.1).ok_or(Overflow)?,
            unbounded: inside.unbounded,
        }
    })
}

fn sum_of(left: Duration, right: Duration) -> Result<Duration, Overflow> {
    Ok(Duration {
        lower: left.lower.checked_add(right.lower).ok_or(Overflow)?,
        upper: left.upper.checked_add(right.upper).ok_or(Overflow)?,
        unbounded: left.unbounded + right.unbounded,
    })
}
