//! Names as small numbers, so that they compare and index quickly.

use rustc_hash::FxHashMap;
use smol_str::SmolStr;

/// Shorter names are alike by chance.
const SHORTEST_ALIKE: usize = 3;

/// A name, interned. The numbers depend on the history of edits: never order output by them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Symbol(u32);

impl Symbol {
    pub(crate) const fn index(self) -> usize {
        self.0 as usize
    }
}

/// All names that a file has ever held.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    symbols: FxHashMap<SmolStr, Symbol>,
    texts: Vec<SmolStr>,
    letters: Vec<u64>,
}

impl Names {
    pub(crate) fn intern(&mut self, text: &SmolStr) -> Symbol {
        if let Some(&symbol) = self.symbols.get(text.as_str()) {
            return symbol;
        }
        let symbol = Symbol(self.texts.len() as u32);
        self.letters.push(letters(text));
        self.texts.push(text.clone());
        self.symbols.insert(text.clone(), symbol);
        symbol
    }

    pub(crate) fn find(&self, text: &str) -> Option<Symbol> {
        self.symbols.get(text).copied()
    }

    pub(crate) fn text(&self, symbol: Symbol) -> &SmolStr {
        static NOTHING: SmolStr = SmolStr::new_static("");
        self.texts.get(symbol.index()).unwrap_or(&NOTHING)
    }

    pub(crate) fn len(&self) -> usize {
        self.texts.len()
    }

    /// The candidate that `written` was probably meant to be: the nearest within a third of its length, the first
    /// such in the alphabet.
    pub(crate) fn nearest(
        &self,
        written: Symbol,
        candidates: impl Iterator<Item = Symbol>,
    ) -> Option<SmolStr> {
        let text = self.text(written);
        let own_letters = letters(text);
        if text.len() < SHORTEST_ALIKE {
            return None;
        }
        let mut limit = (text.len() / 3).clamp(1, 3);
        let mut best: Option<&SmolStr> = None;
        for candidate in candidates {
            let their_letters = self.letters.get(candidate.index()).copied().unwrap_or(0);
            if candidate == written || (own_letters ^ their_letters).count_ones() as usize > 2 * limit {
                continue;
            }
            let other = self.text(candidate);
            let Some(distance) = edit_distance_at_most(text, other, limit) else { continue };
            if distance < limit || best.is_none_or(|best| other < best) {
                limit = distance;
                best = Some(other);
            }
        }
        best.cloned()
    }
}

/// Which letters a name has: one edit changes at most two of the bits.
fn letters(text: &str) -> u64 {
    text.bytes().fold(0, |letters, byte| letters | 1 << (byte.to_ascii_lowercase() & 63))
}

/// The number of insertions, deletions, replacements and swaps of neighbours from one name to the other, ignoring
/// case, if it is at most `limit`. Names that differ only in digits at the same places are different on purpose.
pub(crate) fn edit_distance_at_most(left: &str, right: &str, limit: usize) -> Option<usize> {
    let (left_bytes, right_bytes) = (left.as_bytes(), right.as_bytes());
    // Names of very different lengths are most of all pairs, and need no closer look.
    if left.len().abs_diff(right.len()) > limit || differ_in_digits_only(left_bytes, right_bytes) {
        return None;
    }
    let lowercase = |name: &str| name.chars().map(|c| c.to_ascii_lowercase()).collect::<SmolStr>();
    let distance = strsim::osa_distance(&lowercase(left), &lowercase(right));
    (distance <= limit).then_some(distance)
}

/// `PATH1` and `PATH2` are no misspellings of each other.
fn differ_in_digits_only(left: &[u8], right: &[u8]) -> bool {
    let letters =
        |name: &[u8]| -> Vec<u8> { name.iter().copied().filter(|byte| !byte.is_ascii_digit()).collect() };
    left != right && (left.iter().chain(right).any(u8::is_ascii_digit)) && letters(left) == letters(right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swap_of_neighbours_counts_as_one_mistake() {
        assert_eq!(edit_distance_at_most("Drvie", "Drive", 2), Some(1));
        assert_eq!(edit_distance_at_most("Drive", "Dive", 2), Some(1));
        assert_eq!(edit_distance_at_most("Drive", "Sample", 2), None);
    }

    #[test]
    fn names_that_differ_in_their_number_are_not_alike() {
        assert_eq!(edit_distance_at_most("PATH1", "PATH2", 2), None);
        assert_eq!(edit_distance_at_most("PTAH1", "PATH1", 2), Some(1));
    }
}
