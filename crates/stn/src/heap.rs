//! A binary heap of points by key, least key first, with stale entries left to the caller.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Entries are `(key, point)`, the key above the point in one number, which compares in one step; equal keys come out by
/// point, so that everything built on it is deterministic.
#[derive(Clone, Debug, Default)]
pub struct Heap(BinaryHeap<Reverse<i128>>);

impl Heap {
    /// Takes out all entries.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an entry.
    pub fn push(&mut self, key: i64, point: u32) {
        self.0.push(Reverse((i128::from(key) << u32::BITS) | i128::from(point)));
    }

    /// Takes out the least entry.
    pub fn pop(&mut self) -> Option<(i64, u32)> {
        self.0.pop().map(|Reverse(entry)| ((entry >> u32::BITS) as i64, entry as u32))
    }
}
