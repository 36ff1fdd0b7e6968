//! The program's structure as a tree of durations: the fast half of phase 1.
//!
//! A block touches the rest of its network only in its first and its last event, so all that its inside demands is
//! one interval for its duration. Intervals of a sequence add up, those of parallel branches and spanning bounds
//! intersect, and a choice that is still open has the hull of its alternatives. An empty interval on the way up means
//! that no completion of the choices made so far is consistent; this is exact once all are made, and finds most dead
//! ends long before. One choice costs time proportional to the depth of its block.

use stn::Overflow;
use tpn::{BlockKind, Network};

use crate::enclosed::{Durations, Enclosed};
use crate::model::{INFINITE, Model, NONE};

/// The tree, with the duration of each block before any choice.
#[derive(Clone, Debug)]
pub(crate) struct Structure {
    blocks: Vec<TreeBlock>,
    initial: Vec<Duration>,
    /// The block of each decision.
    decision_blocks: Vec<u32>,
    /// The block that each arc is a leaf or a spanning arc of.
    arc_blocks: Vec<u32>,
    root: u32,
    /// Blocks without choices whose assertions conflict only with each other.
    enclosed: Vec<Enclosed>,
}

#[derive(Clone, Debug)]
struct TreeBlock {
    parent: u32,
    /// Where it stands among its siblings.
    position: u32,
    depth: u32,
    shape: Shape,
    children: Vec<u32>,
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
    /// Its own arcs.
    own_arcs: Vec<u32>,
    /// The arcs from the parent's first event and to its last or the next sibling's first, [`NONE`] where these are
    /// the block's own.
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

/// Parts of more blocks are not looked at for enclosed conditions.
const MAX_ENCLOSED_BLOCKS: usize = 64;

impl Structure {
    /// `None` if the blocks do not account for their own arcs, as in networks changed by other tools.
    pub(crate) fn new(network: &Network, model: &Model) -> Result<Option<Self>, Overflow> {
        let Some(root) = network.root else { return Ok(None) };
        let mut structure = Self {
            blocks: Vec::with_capacity(network.blocks.len()),
            initial: Vec::new(),
            decision_blocks: vec![NONE; network.decisions.len()],
            arc_blocks: vec![NONE; network.arcs.len()],
            root: root.0,
            enclosed: Vec::new(),
        };
        for (id, block) in (0..).zip(&network.blocks) {
            let (shape, children, arcs) = match &block.kind {
                BlockKind::Leaf { arc } => (Shape::Leaf, Vec::new(), vec![arc.0]),
                BlockKind::Sequence { children } => (Shape::Sequence, ids(children), Vec::new()),
                BlockKind::Parallel { branches } => (Shape::Intersection, ids(branches), Vec::new()),
                BlockKind::Choose { decision, alternatives } => {
                    structure.decision_blocks[decision.index()] = id;
                    (Shape::Choice(decision.0), ids(alternatives), Vec::new())
                }
                BlockKind::Scope { child, arcs, .. } => {
                    (Shape::Intersection, vec![child.0], arcs.iter().map(|arc| arc.0).collect())
                }
                BlockKind::Guard { arc, child } => (Shape::Guard, vec![child.0], vec![arc.0]),
            };
            let is_complete = match &block.kind {
                BlockKind::Choose { decision, alternatives } => {
                    alternatives.len() == network.decisions[decision.index()].alternatives.len()
                }
                BlockKind::Sequence { children } => !children.is_empty() || block.start == block.end,
                _ => true,
            };
            if !is_complete || children.iter().any(|&child| child >= id) {
                return Ok(None);
            }
            for &arc in &arcs {
                structure.arc_blocks[arc as usize] = id;
            }
            let own = (0, INFINITE);
            let has_choices = matches!(shape, Shape::Choice(_))
                || children.iter().any(|&child| structure.blocks[child as usize].has_choices);
            let has_labels = arcs.iter().any(|&arc| !model.conditions.labels_of(arc).is_empty())
                || children.iter().any(|&child| structure.blocks[child as usize].has_labels);
            structure.blocks.push(TreeBlock {
                parent: NONE,
                position: 0,
                depth: 0,
                shape,
                children,
                around: (0, 0),
                own,
                has_choices,
                has_labels,
                enclosed: NONE,
                is_inside_enclosed: false,
                ends: (block.start.0, block.end.0),
                own_arcs: arcs,
                around_arcs: (NONE, NONE),
            });
        }
        for id in (0..structure.blocks.len()).rev() {
            let depth = structure.blocks[id].depth + 1;
            for position in 0..structure.blocks[id].children.len() {
                let child = structure.blocks[id].children[position] as usize;
                let child = &mut structure.blocks[child];
                (child.parent, child.position, child.depth) = (id as u32, position as u32, depth);
            }
        }
        for id in 0..structure.blocks.len() {
            structure.find_around_arcs(model, id);
        }
        structure.find_enclosed(model);
        if structure.refresh(network, model)? { Ok(Some(structure)) } else { Ok(None) }
    }

    /// Computes all durations anew from the model's bounds; `false` if an arc that the structure needs is missing.
    pub(crate) fn refresh(&mut self, network: &Network, model: &Model) -> Result<bool, Overflow> {
        self.initial.clear();
        self.initial.resize(self.blocks.len(), Duration::NEVER);
        for id in 0..self.blocks.len() {
            let block = &network.blocks[id];
            let own = match &block.kind {
                BlockKind::Leaf { arc } | BlockKind::Guard { arc, .. } => bounds(model, arc.0),
                BlockKind::Scope { arcs, .. } => {
                    arcs.iter().fold((0, INFINITE), |own, arc| intersect(own, bounds(model, arc.0)))
                }
                _ => (0, INFINITE),
            };
            self.blocks[id].own = own;
            for position in 0..self.blocks[id].children.len() {
                let Some(around) = self.around(network, model, id, position)? else { return Ok(false) };
                let child = self.blocks[id].children[position];
                self.blocks[child as usize].around = around;
            }
            self.initial[id] = self.initial_duration(model, id)?;
        }
        Ok(true)
    }

    /// Changes one arc's bounds in the tree, where only its own block and its ancestors depend on it. `false` if the
    /// arc is structural and everything must be refreshed.
    pub(crate) fn set_arc(&mut self, network: &Network, model: &Model, arc: u32) -> Result<bool, Overflow> {
        let mut id = self.arc_blocks[arc as usize];
        if id == NONE {
            return Ok(false);
        }
        self.blocks[id as usize].own = match &network.blocks[id as usize].kind {
            BlockKind::Scope { arcs, .. } => {
                arcs.iter().fold((0, INFINITE), |own, arc| intersect(own, bounds(model, arc.0)))
            }
            _ => bounds(model, arc),
        };
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

    /// The node where a decision is made.
    pub(crate) fn decision_node(&self, decision: u32) -> u32 {
        self.blocks[self.decision_blocks[decision as usize] as usize].ends.0
    }

    /// The duration of a choice if its first possible alternative is taken.
    pub(crate) fn first_alternative(&self, decision: u32) -> Result<Option<(i64, i64)>, Overflow> {
        let block = &self.blocks[self.decision_blocks[decision as usize] as usize];
        let first = block.children.iter().find(|&&child| !self.initial[child as usize].is_empty());
        let duration =
            first.map(|&child| add(self.initial[child as usize], self.blocks[child as usize].around));
        Ok(duration.transpose()?.map(|duration| (duration.lower, duration.upper())))
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
        let block = &self.blocks[self.decision_blocks[decision as usize] as usize];
        let child = block.children[alternative as usize];
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
        for &arc in &block.own_arcs {
            arrive(arc);
        }
        for &child in &block.children {
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

    /// Finds, for each variable, the smallest block with all its labels, and keeps those that are enclosed.
    fn find_enclosed(&mut self, model: &Model) {
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

    fn find_around_arcs(&mut self, model: &Model, id: usize) {
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

    /// Takes an alternative; `Err` names the block that has become impossible.
    pub(crate) fn decide(
        &self,
        state: &mut TreeState,
        chosen: &[u32],
        decision: u32,
        alternative: u32,
    ) -> Result<Result<(), u32>, Overflow> {
        let mut id = self.decision_blocks[decision as usize];
        let child = self.blocks[id as usize].children[alternative as usize];
        if state.durations[child as usize].is_empty() {
            return Ok(Err(self.innermost_empty(state, child)));
        }
        let mut new = self.contribution(state, child)?;
        loop {
            let old = state.durations[id as usize];
            if new == old {
                return Ok(Ok(()));
            }
            let before = self.contribution(state, id)?;
            state.trail.push((id, old));
            state.durations[id as usize] = new;
            if new.is_empty() {
                return Ok(Err(id));
            }
            let after = self.contribution(state, id)?;
            let parent = self.blocks[id as usize].parent;
            if parent == NONE {
                return Ok(Ok(()));
            }
            let held = state.durations[parent as usize];
            new = match self.blocks[parent as usize].shape {
                Shape::Leaf => held,
                Shape::Sequence | Shape::Guard => Duration {
                    lower: held.lower.checked_add(after.lower - before.lower).ok_or(Overflow)?,
                    upper: held.upper.checked_add(after.upper).ok_or(Overflow)? - before.upper,
                    unbounded: held.unbounded + after.unbounded - before.unbounded,
                },
                Shape::Intersection => {
                    Duration::new(held.lower.max(after.lower), held.upper().min(after.upper()))
                }
                Shape::Choice(outer) => {
                    debug_assert_eq!(
                        chosen[outer as usize], self.blocks[id as usize].position,
                        "a chosen branch"
                    );
                    after
                }
            };
            id = parent;
        }
    }

    /// A place for [`Structure::undo`].
    pub(crate) fn mark(state: &TreeState) -> usize {
        state.trail.len()
    }

    /// Takes back all decisions since `mark`.
    pub(crate) fn undo(state: &mut TreeState, mark: usize) {
        while state.trail.len() > mark {
            if let Some((id, duration)) = state.trail.pop() {
                state.durations[id as usize] = duration;
            }
        }
    }

    /// Calls `blame` with every decision that the emptiness of `block` rests on, and with the block's own context.
    pub(crate) fn explain(&self, state: &TreeState, chosen: &[u32], block: u32, blame: &mut impl FnMut(u32)) {
        let mut above = block;
        while above != NONE {
            let parent = self.blocks[above as usize].parent;
            if parent != NONE
                && let Shape::Choice(decision) = self.blocks[parent as usize].shape
            {
                blame(decision);
                break;
            }
            above = parent;
        }
        let mut stack = vec![(block, true), (block, false)];
        while let Some((id, is_lower)) = stack.pop() {
            let block = &self.blocks[id as usize];
            if !block.has_choices {
                continue;
            }
            match block.shape {
                Shape::Leaf => {}
                Shape::Sequence | Shape::Guard => {
                    stack.extend(block.children.iter().map(|&child| (child, is_lower)));
                }
                Shape::Choice(decision) => {
                    let alternative = chosen[decision as usize];
                    if alternative != NONE {
                        blame(decision);
                        stack.push((block.children[alternative as usize], is_lower));
                    }
                }
                Shape::Intersection => {
                    let held = state.durations[id as usize];
                    let is_tight = |&&child: &&u32| {
                        self.contribution(state, child).is_ok_and(|part| {
                            if is_lower { part.lower == held.lower } else { part.upper() == held.upper() }
                        })
                    };
                    let own_is_tight =
                        if is_lower { block.own.0 == held.lower } else { block.own.1 == held.upper() };
                    if !own_is_tight && let Some(&child) = block.children.iter().find(is_tight) {
                        stack.push((child, is_lower));
                    }
                }
            }
        }
    }

    fn innermost_empty(&self, state: &TreeState, block: u32) -> u32 {
        let mut id = block;
        loop {
            let children = &self.blocks[id as usize].children;
            if matches!(self.blocks[id as usize].shape, Shape::Choice(_)) {
                return id;
            }
            match children.iter().find(|&&child| state.durations[child as usize].is_empty()) {
                Some(&child) => id = child,
                None => return id,
            }
        }
    }

    /// What a block's duration and the arcs around it come to.
    fn contribution(&self, state: &TreeState, id: u32) -> Result<Duration, Overflow> {
        add(state.durations[id as usize], self.blocks[id as usize].around)
    }

    fn initial_duration(&self, model: &Model, id: usize) -> Result<Duration, Overflow> {
        let duration = self.nested_duration(id)?;
        let enclosed = self.blocks[id].enclosed;
        if enclosed == NONE || duration.is_empty() {
            return Ok(duration);
        }
        Ok(match self.enclosed[enclosed as usize].durations(model) {
            Durations::Never => Duration::NEVER,
            Durations::Unknown => duration,
            Durations::Between(lower, upper) => {
                let (lower, upper) = intersect((duration.lower, duration.upper()), (lower, upper));
                Duration::new(lower, upper)
            }
        })
    }

    fn nested_duration(&self, id: usize) -> Result<Duration, Overflow> {
        let block = &self.blocks[id];
        let parts = block.children.iter().map(|&child| {
            let inside = self.initial[child as usize];
            if inside.is_empty() {
                Ok(None)
            } else {
                add(inside, self.blocks[child as usize].around).map(Some)
            }
        });
        Ok(match block.shape {
            Shape::Leaf => Duration::new(block.own.0, block.own.1),
            Shape::Sequence => {
                let mut sum = Duration::new(0, 0);
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part)?;
                }
                sum
            }
            Shape::Guard => {
                let mut sum = Duration::new(block.own.0, block.own.1);
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    sum = sum_of(sum, part)?;
                }
                sum
            }
            Shape::Intersection => {
                let mut common = block.own;
                for part in parts {
                    let Some(part) = part? else { return Ok(Duration::NEVER) };
                    common = intersect(common, (part.lower, part.upper()));
                }
                Duration::new(common.0, common.1)
            }
            Shape::Choice(_) => {
                let mut hull: Option<(i64, i64)> = None;
                for part in parts {
                    let Some(part) = part? else { continue };
                    let (lower, upper) = hull.unwrap_or((part.lower, part.upper()));
                    hull = Some((lower.min(part.lower), upper.max(part.upper())));
                }
                hull.map_or(Duration::NEVER, |(lower, upper)| Duration::new(lower, upper))
            }
        })
    }

    /// What the structural arcs around a child add; `None` if there are none where there must be.
    fn around(
        &self,
        network: &Network,
        model: &Model,
        id: usize,
        position: usize,
    ) -> Result<Option<(i64, i64)>, Overflow> {
        let block = &network.blocks[id];
        let children = &self.blocks[id].children;
        let child = &network.blocks[children[position] as usize];
        let (enter, leave) = match self.blocks[id].shape {
            Shape::Leaf => return Ok(Some((0, 0))),
            Shape::Sequence => {
                let next =
                    children.get(position + 1).map_or(block.end, |&next| network.blocks[next as usize].start);
                let enter =
                    if position == 0 { between(model, block.start.0, child.start.0) } else { Some((0, 0)) };
                (enter, between(model, child.end.0, next.0))
            }
            Shape::Guard => {
                let BlockKind::Guard { arc, .. } = &block.kind else { return Ok(None) };
                let inside = network.arcs[arc.index()].to.0;
                (between(model, inside, child.start.0), between(model, child.end.0, block.end.0))
            }
            Shape::Choice(decision) => {
                let arc = model.decisions[decision as usize].alternatives.get(position).copied();
                let enter = arc.and_then(|arc| {
                    let after = between(model, model.arcs[arc as usize].to, child.start.0)?;
                    let choice = bounds(model, arc);
                    Some((choice.0.checked_add(after.0)?, saturating_upper(choice.1, after.1)))
                });
                (enter, between(model, child.end.0, block.end.0))
            }
            Shape::Intersection => {
                (between(model, block.start.0, child.start.0), between(model, child.end.0, block.end.0))
            }
        };
        let (Some(enter), Some(leave)) = (enter, leave) else { return Ok(None) };
        let lower = enter.0.checked_add(leave.0).ok_or(Overflow)?;
        let upper = match (enter.1, leave.1) {
            (INFINITE, _) | (_, INFINITE) => INFINITE,
            (enter, leave) => enter.checked_add(leave).ok_or(Overflow)?,
        };
        Ok(Some((lower, upper)))
    }
}

fn ids(blocks: &[tpn::BlockId]) -> Vec<u32> {
    blocks.iter().map(|block| block.0).collect()
}

fn bounds(model: &Model, arc: u32) -> (i64, i64) {
    let arc = &model.arcs[arc as usize];
    (arc.lower, arc.upper)
}

fn intersect(left: (i64, i64), right: (i64, i64)) -> (i64, i64) {
    (left.0.max(right.0), left.1.min(right.1))
}

fn saturating_upper(left: i64, right: i64) -> i64 {
    if left == INFINITE || right == INFINITE { INFINITE } else { left.saturating_add(right) }
}

/// The bounds of an arc that leads from one node to another; zero for the same node.
///
/// Of several arcs the first structural one counts: any of them gives a sound interval.
fn between(model: &Model, from: u32, to: u32) -> Option<(i64, i64)> {
    if from == to {
        return Some((0, 0));
    }
    let arc = model.out_arcs(from).iter().find(|&&arc| model.arcs[arc as usize].to == to)?;
    Some(bounds(model, *arc))
}

fn arc_between(model: &Model, from: u32, to: u32) -> Option<u32> {
    if from == to {
        return None;
    }
    model.out_arcs(from).iter().copied().find(|&arc| model.arcs[arc as usize].to == to)
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
