//! Which choice point has had most to do with conflicts lately: a binary heap by activity.

#[derive(Clone, Debug)]
pub(crate) struct Activity {
    scores: Vec<f64>,
    increment: f64,
    heap: Vec<u32>,
    /// Where each choice point stands in the heap, or `ABSENT`.
    position: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

impl Activity {
    pub(crate) fn new() -> Self {
        Self { scores: Vec::new(), increment: 1.0, heap: Vec::new(), position: Vec::new() }
    }

    /// Adds the next choice point, with as much activity as `initial` times what a conflict gives.
    pub(crate) fn add(&mut self, initial: f64) {
        self.scores.push(initial * self.increment);
        self.position.push(ABSENT);
    }

    /// Puts a choice point among those to be decided, if it is not there.
    pub(crate) fn insert(&mut self, item: u32) {
        if self.position[item as usize] == ABSENT {
            self.position[item as usize] = self.heap.len() as u32;
            self.heap.push(item);
            self.rise(self.heap.len() - 1);
        }
    }

    /// Takes out the most active one; the first of several.
    pub(crate) fn pop(&mut self) -> Option<u32> {
        let top = *self.heap.first()?;
        let last = self.heap.pop()?;
        self.position[top as usize] = ABSENT;
        if last != top {
            self.heap[0] = last;
            self.position[last as usize] = 0;
            self.sink(0);
        }
        Some(top)
    }

    pub(crate) fn bump(&mut self, item: u32) {
        self.scores[item as usize] += self.increment;
        if self.scores[item as usize] > 1e100 {
            for score in &mut self.scores {
                *score *= 1e-100;
            }
            self.increment *= 1e-100;
        }
        let position = self.position[item as usize];
        if position != ABSENT {
            self.rise(position as usize);
        }
    }

    pub(crate) fn decay(&mut self) {
        self.increment /= 0.95;
    }

    fn is_before(&self, left: u32, right: u32) -> bool {
        let (a, b) = (self.scores[left as usize], self.scores[right as usize]);
        a > b || (a == b && left < right)
    }

    fn rise(&mut self, mut at: usize) {
        let item = self.heap[at];
        while at > 0 {
            let above = (at - 1) / 2;
            if !self.is_before(item, self.heap[above]) {
                break;
            }
            self.heap[at] = self.heap[above];
            self.position[self.heap[at] as usize] = at as u32;
            at = above;
        }
        self.heap[at] = item;
        self.position[item as usize] = at as u32;
    }

    fn sink(&mut self, mut at: usize) {
        let item = self.heap[at];
        loop {
            let mut below = at * 2 + 1;
            if below >= self.heap.len() {
                break;
            }
            if below + 1 < self.heap.len() && self.is_before(self.heap[below + 1], self.heap[below]) {
                below += 1;
            }
            if !self.is_before(self.heap[below], item) {
                break;
            }
            self.heap[at] = self.heap[below];
            self.position[self.heap[at] as usize] = at as u32;
            at = below;
        }
        self.heap[at] = item;
        self.position[item as usize] = at as u32;
    }
}
