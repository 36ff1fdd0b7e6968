//! A binary heap of points by key, least key first, with stale entries left to the caller.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Entries are `(key, point)`; equal keys come out by point, so that everything built on it is deterministic.
#[derive(Clone, Debug, Default)]
pub(crate) struct Heap(BinaryHeap<Reverse<(i64, u32)>>);

impl Heap {
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    pub(crate) fn push(&mut self, key: i64, point: u32) {
        self.0.push(Reverse((key, point)));
    }

    pub(crate) fn pop(&mut self) -> Option<(i64, u32)> {
        self.0.pop().map(|Reverse(entry)| entry)
    }
}
