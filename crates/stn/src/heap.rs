//! A binary heap of points by key, least key first, with stale entries left to the caller.

/// Entries are `(key, point)`; equal keys come out by point, so that everything built on it is deterministic.
#[derive(Clone, Debug, Default)]
pub(crate) struct Heap {
    entries: Vec<(i64, u32)>,
}

impl Heap {
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
    }

    pub(crate) fn push(&mut self, key: i64, point: u32) {
        let mut hole = self.entries.len();
        self.entries.push((key, point));
        while hole > 0 {
            let parent = (hole - 1) / 2;
            if self.entries[parent] <= (key, point) {
                break;
            }
            self.entries[hole] = self.entries[parent];
            hole = parent;
        }
        self.entries[hole] = (key, point);
    }

    pub(crate) fn pop(&mut self) -> Option<(i64, u32)> {
        let last = self.entries.pop()?;
        let Some(&top) = self.entries.first() else { return Some(last) };
        let len = self.entries.len();
        let mut hole = 0;
        loop {
            let mut child = 2 * hole + 1;
            if child >= len {
                break;
            }
            if child + 1 < len && self.entries[child + 1] < self.entries[child] {
                child += 1;
            }
            if self.entries[child] >= last {
                break;
            }
            self.entries[hole] = self.entries[child];
            hole = child;
        }
        self.entries[hole] = last;
        Some(top)
    }
}
