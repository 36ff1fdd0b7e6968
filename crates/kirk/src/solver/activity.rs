//! Which choice point has had most to do with conflicts lately: a binary heap by activity.

use typed_index_collections::TiVec;

use crate::ids::ChoicePointId;

#[derive(Clone, Debug)]
pub(crate) struct Activity {
    scores: TiVec<ChoicePointId, f64>,
    increment: f64,
    heap: Vec<ChoicePointId>,
    /// Where each choice point is in the heap, if it does.
    position: TiVec<ChoicePointId, Option<u32>>,
}

impl Activity {
    pub(crate) fn new() -> Self {
        Self { scores: TiVec::new(), increment: 1.0, heap: Vec::new(), position: TiVec::new() }
    }

    /// Adds the next choice point, with as much activity as `initial` times what a conflict gives.
    pub(crate) fn add(&mut self, initial: f64) {
        self.scores.push(initial * self.increment);
        self.position.push(None);
    }

    /// Puts a choice point among those to be decided, if it is not there.
    pub(crate) fn insert(&mut self, choice_point: ChoicePointId) {
        if self.position[choice_point].is_none() {
            self.position[choice_point] = Some(self.heap.len() as u32);
            self.heap.push(choice_point);
            self.rise(self.heap.len() - 1);
        }
    }

    /// Takes out the most active one; the first of several.
    pub(crate) fn pop(&mut self) -> Option<ChoicePointId> {
        let top = *self.heap.first()?;
        let last = self.heap.pop()?;
        self.position[top] = None;
        if last != top {
            self.heap[0] = last;
            self.position[last] = Some(0);
            self.sink(0);
        }
        Some(top)
    }

    pub(crate) fn bump(&mut self, choice_point: ChoicePointId) {
        self.scores[choice_point] += self.increment;
        if self.scores[choice_point] > 1e100 {
            for score in &mut self.scores {
                *score *= 1e-100;
            }
            self.increment *= 1e-100;
        }
        if let Some(position) = self.position[choice_point] {
            self.rise(position as usize);
        }
    }

    pub(crate) fn decay(&mut self) {
        self.increment /= 0.95;
    }

    fn is_before(&self, left: ChoicePointId, right: ChoicePointId) -> bool {
        let (a, b) = (self.scores[left], self.scores[right]);
        a > b || (a == b && left < right)
    }

    fn rise(&mut self, mut at: usize) {
        let choice_point = self.heap[at];
        while at > 0 {
            let above = (at - 1) / 2;
            if !self.is_before(choice_point, self.heap[above]) {
                break;
            }
            self.heap[at] = self.heap[above];
            self.position[self.heap[at]] = Some(at as u32);
            at = above;
        }
        self.heap[at] = choice_point;
        self.position[choice_point] = Some(at as u32);
    }

    fn sink(&mut self, mut at: usize) {
        let choice_point = self.heap[at];
        loop {
            let mut below = at * 2 + 1;
            if below >= self.heap.len() {
                break;
            }
            if below + 1 < self.heap.len() && self.is_before(self.heap[below + 1], self.heap[below]) {
                below += 1;
            }
            if !self.is_before(self.heap[below], choice_point) {
                break;
            }
            self.heap[at] = self.heap[below];
            self.position[self.heap[at]] = Some(at as u32);
            at = below;
        }
        self.heap[at] = choice_point;
        self.position[choice_point] = Some(at as u32);
    }
}
