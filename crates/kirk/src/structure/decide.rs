//! Durations during a search: taking an alternative, taking it back, and why a block has become impossible.

use stn::Overflow;

use super::{Duration, Shape, Structure, TreeState};
use crate::model::NONE;

impl Structure {
    /// Takes an alternative; `Err` names the block that has become impossible.
    pub(crate) fn decide(
        &self,
        state: &mut TreeState,
        chosen: &[u32],
        decision: u32,
        alternative: u32,
    ) -> Result<Result<(), u32>, Overflow> {
        let mut id = self.decision_blocks[decision as usize];
        let child = self.child(id as usize, alternative);
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
                    stack.extend(self.children(id as usize).iter().map(|&child| (child, is_lower)));
                }
                Shape::Choice(decision) => {
                    let alternative = chosen[decision as usize];
                    if alternative != NONE {
                        blame(decision);
                        stack.push((self.child(id as usize, alternative), is_lower));
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
                    if !own_is_tight && let Some(&child) = self.children(id as usize).iter().find(is_tight) {
                        stack.push((child, is_lower));
                    }
                }
            }
        }
    }

    fn innermost_empty(&self, state: &TreeState, block: u32) -> u32 {
        let mut id = block;
        loop {
            let children = self.children(id as usize);
            if matches!(self.blocks[id as usize].shape, Shape::Choice(_)) {
                return id;
            }
            match children.iter().find(|&&child| state.durations[child as usize].is_empty()) {
                Some(&child) => id = child,
                None => return id,
            }
        }
    }
}
