//! Which primitive locations are active, as a bit set.

use std::ops::Range;

use crate::automaton::LocationId;
use serde::{Deserialize, Serialize};

/// A set of primitive locations of one automaton.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Marking {
    words: Vec<u64>,
}

impl Marking {
    /// The empty marking of an automaton with `locations` locations.
    pub fn empty(locations: usize) -> Self {
        Self { words: vec![0; locations.div_ceil(64)] }
    }

    /// Returns whether no location is active: the program has ended.
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&word| word == 0)
    }

    /// Returns how many locations are active.
    pub fn len(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Returns whether a location is active.
    pub fn contains(&self, location: LocationId) -> bool {
        self.words.get(location.0 as usize / 64).is_some_and(|word| word >> (location.0 % 64) & 1 == 1)
    }

    /// Activates a location.
    #[inline]
    pub fn insert(&mut self, location: LocationId) {
        if let Some(word) = self.words.get_mut(location.0 as usize / 64) {
            *word |= 1 << (location.0 % 64);
        }
    }

    /// The active locations in their order.
    pub fn iter(&self) -> impl Iterator<Item = LocationId> + '_ {
        self.words
            .iter()
            .enumerate()
            .flat_map(|(at, &word)| bits(word).map(move |bit| LocationId(at as u32 * 64 + bit)))
    }

    /// Returns whether any location of a range is active.
    #[inline]
    pub(crate) fn intersects(&self, range: &Range<u32>) -> bool {
        masks(range).any(|(at, mask)| self.words.get(at).is_some_and(|word| word & mask != 0))
    }

    #[inline]
    pub(crate) fn remove_range(&mut self, range: &Range<u32>) {
        for (at, mask) in masks(range) {
            if let Some(word) = self.words.get_mut(at) {
                *word &= !mask;
            }
        }
    }

    /// The same without the locations of another set.
    #[must_use]
    pub fn without(&self, other: &Self) -> Self {
        Self { words: self.words.iter().zip(&other.words).map(|(word, other)| word & !other).collect() }
    }

    #[inline]
    pub(crate) fn clear(&mut self) {
        self.words.fill(0);
    }

    #[inline]
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.words.copy_from_slice(&other.words);
    }

    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }
}

/// The bits of a word that are set, lowest first.
pub(crate) fn bits(mut word: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        (word != 0).then(|| {
            let bit = word.trailing_zeros();
            word &= word - 1;
            bit
        })
    })
}

#[inline]
fn masks(range: &Range<u32>) -> impl Iterator<Item = (usize, u64)> + use<> {
    let (start, end) = (range.start, range.end);
    let words = if start < end { start / 64..(end - 1) / 64 + 1 } else { 0..0 };
    words.map(move |word| {
        let low = start.max(word * 64) - word * 64;
        let high = end.min(word * 64 + 64) - word * 64;
        (word as usize, (u64::MAX << low) & (u64::MAX >> (64 - high)))
    })
}
