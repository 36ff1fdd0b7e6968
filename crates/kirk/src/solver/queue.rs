//! The constraints of a theory that are still to be looked at.

use typed_index_collections::TiVec;

use super::lists::Lists;
use super::literal::Side;

/// Which constraints, by their ids, the bound of each side concerns, and which of them wait, each once. The last to
/// come is looked at first.
#[derive(Clone, Debug)]
pub(crate) struct PropagationQueue<Id: From<usize>> {
    concerned: Lists<Side, Id>,
    is_waiting: TiVec<Id, bool>,
    waiting: Vec<Id>,
}

impl<Id: From<usize>> Default for PropagationQueue<Id> {
    fn default() -> Self {
        Self { concerned: Lists::default(), is_waiting: TiVec::new(), waiting: Vec::new() }
    }
}

impl<Id> PropagationQueue<Id>
where
    Id: Copy + From<usize>,
    usize: From<Id>,
{
    pub(crate) fn resize(&mut self, num_variables: usize) {
        self.concerned.resize(num_variables * 2);
    }

    /// Adds the next constraint, which the bounds of these sides concern, and lets it wait.
    pub(crate) fn add(&mut self, sides: impl IntoIterator<Item = Side>) {
        let id = self.is_waiting.push_and_get_key(true);
        for side in sides {
            self.concerned.push(side, id);
        }
        self.waiting.push(id);
    }

    /// The bound of a side has moved.
    pub(crate) fn moved(&mut self, side: Side) {
        for id in self.concerned.iter(side) {
            if !self.is_waiting[id] {
                self.is_waiting[id] = true;
                self.waiting.push(id);
            }
        }
    }

    /// A constraint itself has changed.
    pub(crate) fn push(&mut self, id: Id) {
        if !self.is_waiting[id] {
            self.is_waiting[id] = true;
            self.waiting.push(id);
        }
    }

    /// Lets all constraints wait.
    pub(crate) fn push_all(&mut self) {
        for id in (0..self.is_waiting.len()).map(Id::from) {
            self.push(id);
        }
    }

    /// Drops what waits: the events that it waits for are being taken back.
    pub(crate) fn forget(&mut self) {
        for id in self.waiting.drain(..) {
            self.is_waiting[id] = false;
        }
    }

    /// Takes a constraint that waits.
    pub(crate) fn pop(&mut self) -> Option<Id> {
        let id = self.waiting.pop()?;
        self.is_waiting[id] = false;
        Some(id)
    }
}
