//! Durations during a search: taking an alternative, taking it back, and why a block has become impossible.

use tpn::{BlockId, Choice, DecisionId};

use super::{Duration, Shape, Structure, TreeState};
use crate::model::Alternatives;
use crate::unplannable::Unplannable;

impl Structure {
    /// Takes an alternative; `Err` names the block that has become impossible.
    pub(crate) fn decide(
        &self,
        state: &mut TreeState,
        chosen: &Alternatives,
        choice: Choice,
    ) -> Result<Result<(), BlockId>, Unplannable> {
        let mut id = self.decision_blocks[choice.decision];
        let child = self.child(id, choice.alternative);
        if state.durations[child].is_empty() {
            return Ok(Err(self.innermost_empty(state, child)));
        }
        let mut new = self.contribution(state, child)?;
        loop {
            let old = state.durations[id];
            if new == old {
                return Ok(Ok(()));
            }
            let before = self.contribution(state, id)?;
            state.trail.push((id, old));
            state.durations[id] = new;
            if new.is_empty() {
                return Ok(Err(id));
            }
            let after = self.contribution(state, id)?;
            let Some(parent) = self.blocks[id].parent else { return Ok(Ok(())) };
            let held = state.durations[parent];
            let overflow = || self.overflow(parent);
            new = match self.blocks[parent].shape {
                Shape::Leaf => held,
                Shape::Sequence | Shape::Guard => Duration {
                    lower: held.lower.checked_add(after.lower - before.lower).ok_or_else(overflow)?,
                    upper: held.upper.checked_add(after.upper).ok_or_else(overflow)? - before.upper,
                    unbounded: held.unbounded + after.unbounded - before.unbounded,
                },
                Shape::Intersection => {
                    Duration::new(held.lower.max(after.lower), held.upper().min(after.upper()))
                }
                Shape::Choice(outer) => {
                    debug_assert_eq!(chosen[outer], Some(self.blocks[id].position), "a chosen branch");
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
                state.durations[id] = duration;
            }
        }
    }

    /// Conflict analysis: calls `arrive` with every decision that the emptiness of `block` rests on, its own context among
    /// them.
    pub(crate) fn explain(
        &self,
        state: &TreeState,
        chosen: &Alternatives,
        block: BlockId,
        arrive: &mut impl FnMut(DecisionId),
    ) {
        let mut above = self.blocks[block].parent;
        while let Some(parent) = above {
            if let Shape::Choice(decision) = self.blocks[parent].shape {
                arrive(decision);
                break;
            }
            above = self.blocks[parent].parent;
        }
        let mut stack = vec![(block, true), (block, false)];
        while let Some((id, is_lower)) = stack.pop() {
            let block = &self.blocks[id];
            if !block.has_choices {
                continue;
            }
            match block.shape {
                Shape::Leaf => {}
                Shape::Sequence | Shape::Guard => {
                    stack.extend(self.children(id).iter().map(|&child| (child, is_lower)));
                }
                Shape::Choice(decision) => {
                    if let Some(alternative) = chosen[decision] {
                        arrive(decision);
                        stack.push((self.child(id, alternative), is_lower));
                    }
                }
                Shape::Intersection => {
                    let held = state.durations[id];
                    let is_tight = |&&child: &&BlockId| {
                        self.contribution(state, child).is_ok_and(|part| {
                            if is_lower { part.lower == held.lower } else { part.upper() == held.upper() }
                        })
                    };
                    let own_is_tight =
                        if is_lower { block.own.0 == held.lower } else { block.own.1 == held.upper() };
                    if !own_is_tight && let Some(&child) = self.children(id).iter().find(is_tight) {
                        stack.push((child, is_lower));
                    }
                }
            }
        }
    }

    fn innermost_empty(&self, state: &TreeState, block: BlockId) -> BlockId {
        let mut id = block;
        loop {
            let children = self.children(id);
            if matches!(self.blocks[id].shape, Shape::Choice(_)) {
                return id;
            }
            match children.iter().find(|&&child| state.durations[child].is_empty()) {
                Some(&child) => id = child,
                None => return id,
            }
        }
    }
}
