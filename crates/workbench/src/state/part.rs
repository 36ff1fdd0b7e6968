//! A part of the state that counts its changes, so that what is computed from it knows when it is due.

use std::ops::{Deref, DerefMut};

/// A part of the state. Each access that may change it increments its count.
#[derive(Debug, Default)]
pub struct Part<T> {
    value: T,
    changes: u64,
}

impl<T> Part<T> {
    /// A part that has not changed yet.
    pub const fn new(value: T) -> Self {
        Self { value, changes: 0 }
    }

    /// Returns how often it may have changed.
    pub const fn changes(&self) -> u64 {
        self.changes
    }
}

impl<T> Deref for Part<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Part<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.changes += 1;
        &mut self.value
    }
}

impl<T: PartialEq> PartialEq<T> for Part<T> {
    fn eq(&self, other: &T) -> bool {
        self.value == *other
    }
}
