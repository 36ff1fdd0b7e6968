//! The constraints of a theory that are still to be looked at.

use super::literal::Side;

/// Which constraints the bound of each side concerns, and which of them wait, each once. The last to come is looked at
/// first.
#[derive(Clone, Debug, Default)]
pub(crate) struct PropagationQueue {
    /// By side.
    concerned: Vec<Vec<u32>>,
    is_waiting: Vec<bool>,
    waiting: Vec<u32>,
}

impl PropagationQueue {
    pub(crate) fn resize(&mut self, num_variables: usize) {
        self.concerned.resize(num_variables * 2, Vec::new());
    }

    /// Adds the next constraint, which the bounds of these sides concern, and lets it wait.
    pub(crate) fn add(&mut self, sides: impl IntoIterator<Item = Side>) {
        let id = self.is_waiting.len() as u32;
        for side in sides {
            self.concerned[side.index()].push(id);
        }
        self.is_waiting.push(true);
        self.waiting.push(id);
    }

    /// The bound of a side has moved.
    pub(crate) fn moved(&mut self, side: Side) {
        for &id in &self.concerned[side.index()] {
            if !self.is_waiting[id as usize] {
                self.is_waiting[id as usize] = true;
                self.waiting.push(id);
            }
        }
    }

    /// Drops what waits: the events that it waits for are being taken back.
    pub(crate) fn forget(&mut self) {
        for id in self.waiting.drain(..) {
            self.is_waiting[id as usize] = false;
        }
    }

    /// Takes a constraint that waits, by its number in the order in which they were added.
    pub(crate) fn pop(&mut self) -> Option<u32> {
        let id = self.waiting.pop()?;
        self.is_waiting[id as usize] = false;
        Some(id)
    }
}
