//! Names as small numbers, so that they compare and index quickly.

use rustc_hash::FxHashMap;
use smol_str::SmolStr;

use super::alike::{MAX_LETTERS, edit_distance_at_most};

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
        if text.len() < SHORTEST_ALIKE || text.len() > MAX_LETTERS {
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

/// Returns which letters a name has: one edit changes at most two of the bits.
fn letters(text: &str) -> u64 {
    text.bytes().fold(0, |letters, byte| letters | 1 << (byte.to_ascii_lowercase() & 63))
}
