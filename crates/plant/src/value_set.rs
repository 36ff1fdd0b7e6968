//! Sets of values, of modes and of commands, by their numbers.

use std::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign, Not};

use serde::{Deserialize, Serialize};

const WORDS: usize = 4;

/// A set of values, by their numbers from 0 to 255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct ValueSet {
    words: [u64; WORDS],
}

impl ValueSet {
    /// How many values a variable can have at most, and modes a class.
    pub const MOST: usize = 64 * WORDS;

    /// Of no value, as a condition that is never met has.
    pub const EMPTY: Self = Self { words: [0; WORDS] };

    /// Of all values, as no condition has.
    pub(crate) const FULL: Self = Self { words: [u64::MAX; WORDS] };

    /// Only this value.
    #[inline]
    pub const fn one(value: u8) -> Self {
        let mut set = Self::EMPTY;
        set.words[value as usize / 64] = 1 << (value % 64);
        set
    }

    /// The first `count` values; at most all.
    pub const fn first_values(count: usize) -> Self {
        let mut set = Self::EMPTY;
        let mut word = 0;
        while word < WORDS {
            let bits = count.saturating_sub(64 * word);
            set.words[word] = if bits >= 64 { u64::MAX } else { (1 << bits) - 1 };
            word += 1;
        }
        set
    }

    /// Returns whether a value is in the set.
    #[inline]
    pub const fn contains(&self, value: u8) -> bool {
        self.words[value as usize / 64] >> (value % 64) & 1 == 1
    }

    /// Returns whether no value is in the set.
    #[inline]
    pub const fn is_empty(&self) -> bool {
        self.words[0] | self.words[1] | self.words[2] | self.words[3] == 0
    }

    /// Returns how many values are in the set.
    #[inline]
    pub fn len(&self) -> u32 {
        self.words.iter().map(|word| word.count_ones()).sum()
    }

    /// The value, if there is only one.
    #[inline]
    pub fn only(&self) -> Option<u8> {
        if self.len() == 1 { self.values().next() } else { None }
    }

    /// The values, lowest first.
    #[inline]
    pub fn values(self) -> impl Iterator<Item = u8> {
        (0_u8..).zip(self.words).flat_map(|(at, mut word)| {
            std::iter::from_fn(move || {
                (word != 0).then(|| {
                    let value = word.trailing_zeros() as u8;
                    word &= word - 1;
                    64 * at + value
                })
            })
        })
    }

    #[inline]
    fn joined(self, other: Self, join: impl Fn(u64, u64) -> u64) -> Self {
        Self { words: std::array::from_fn(|at| join(self.words[at], other.words[at])) }
    }
}

impl FromIterator<u8> for ValueSet {
    fn from_iter<Values: IntoIterator<Item = u8>>(values: Values) -> Self {
        values.into_iter().fold(Self::EMPTY, |set, value| set | Self::one(value))
    }
}

impl BitAnd for ValueSet {
    type Output = Self;

    #[inline]
    fn bitand(self, other: Self) -> Self {
        self.joined(other, |left, right| left & right)
    }
}

impl BitOr for ValueSet {
    type Output = Self;

    #[inline]
    fn bitor(self, other: Self) -> Self {
        self.joined(other, |left, right| left | right)
    }
}

impl Not for ValueSet {
    type Output = Self;

    #[inline]
    fn not(self) -> Self {
        Self { words: self.words.map(|word| !word) }
    }
}

impl BitAndAssign for ValueSet {
    #[inline]
    fn bitand_assign(&mut self, other: Self) {
        *self = *self & other;
    }
}

impl BitOrAssign for ValueSet {
    #[inline]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_those_of_their_values_across_words() {
        let chosen = [0, 63, 64, 127, 200, 255];
        let set: ValueSet = chosen.into_iter().collect();
        assert_eq!(set.values().collect::<Vec<_>>(), chosen);
        assert_eq!((set.len(), set.only(), set.is_empty()), (6, None, false));
        assert_eq!(ValueSet::one(255).only(), Some(255));
        assert!((0..=u8::MAX).all(|value| set.contains(value) != (!set).contains(value)));
        assert!((set & !set).is_empty() && (set | !set) == ValueSet::FULL);
        for count in [0, 1, 63, 64, 65, 255, 256] {
            let expected: Vec<u8> = (0..count).map(|value| value as u8).collect();
            assert_eq!(ValueSet::first_values(count).values().collect::<Vec<_>>(), expected);
        }
    }
}
