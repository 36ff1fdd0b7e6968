//! Names that are like another one: how far apart two are, and which of many are worth a comparison.

use std::cmp::Ordering;

use super::names::{Names, Symbol};

/// Longer names are not compared.
pub(super) const MAX_LETTERS: usize = 64;

/// How many names are compared on each side of where a written one would stand in an order.
const NEIGHBORS: usize = 32;

/// Names ordered by how they begin, and by how they end: a slip of the pen leaves one of the two as it is.
#[derive(Clone, Debug)]
pub(super) struct Alphabet {
    forwards: Vec<Symbol>,
    backwards: Vec<Symbol>,
}

impl Alphabet {
    pub(super) fn new(names: &Names, symbols: impl Iterator<Item = Symbol>) -> Self {
        let mut forwards: Vec<Symbol> = symbols.collect();
        let mut backwards = forwards.clone();
        forwards.sort_unstable_by(|&one, &other| by_start(names.text(one), names.text(other)));
        backwards.sort_unstable_by(|&one, &other| by_end(names.text(one), names.text(other)));
        Self { forwards, backwards }
    }

    /// The names that begin or end like `text`, at most eight times [`NEIGHBORS`]; some may come twice.
    pub(super) fn around(&self, names: &Names, text: &str) -> impl Iterator<Item = Symbol> {
        let near = |order: &[Symbol], compare: fn(&str, &str) -> Ordering, text: &str| -> Vec<Symbol> {
            let at = order.partition_point(|&other| compare(names.text(other), text).is_lt());
            let from = at.saturating_sub(NEIGHBORS);
            order.iter().skip(from).take(at - from + NEIGHBORS).copied().collect()
        };
        // A letter too much, at the end that is looked at last, must not lead past the name without it.
        let (mut shorter, mut from_second) = (text.chars(), text.chars());
        shorter.next_back();
        from_second.next();
        [
            near(&self.forwards, by_start, text),
            near(&self.forwards, by_start, shorter.as_str()),
            near(&self.backwards, by_end, text),
            near(&self.backwards, by_end, from_second.as_str()),
        ]
        .into_iter()
        .flatten()
    }
}

/// By letters whatever their case, then by case: a total order.
fn by_start(one: &str, other: &str) -> Ordering {
    let letters = |name| str::bytes(name).map(|byte| byte.to_ascii_lowercase());
    letters(one).cmp(letters(other)).then_with(|| one.cmp(other))
}

/// The same from the last letter on.
fn by_end(one: &str, other: &str) -> Ordering {
    let letters = |name| str::bytes(name).rev().map(|byte| byte.to_ascii_lowercase());
    letters(one).cmp(letters(other)).then_with(|| one.cmp(other))
}

/// The number of insertions, deletions, replacements and swaps of neighbors from one name to the other, ignoring
/// case, if it is at most `limit`. Names that differ only in digits at the same places are different on purpose.
pub(crate) fn edit_distance_at_most(left: &str, right: &str, limit: usize) -> Option<usize> {
    let (left, right) = (left.as_bytes(), right.as_bytes());
    // Names of very different lengths are most of all pairs, and need no closer look.
    let is_far = left.len().abs_diff(right.len()) > limit || left.len().max(right.len()) > MAX_LETTERS;
    if is_far || differ_in_digits_only(left, right) {
        return None;
    }
    // Rows of the table of distances between beginnings: two before, one before, this one.
    let mut rows = [[0_usize; MAX_LETTERS + 1]; 3];
    let [before, last, row] = &mut rows;
    for (column, distance) in last.iter_mut().enumerate().take(right.len() + 1) {
        *distance = column;
    }
    let same = |one: u8, other: u8| one.eq_ignore_ascii_case(&other);
    for (at, &letter) in left.iter().enumerate() {
        row[0] = at + 1;
        let mut least = at + 1;
        for (to, &other) in right.iter().enumerate() {
            let replaced = last[to] + usize::from(!same(letter, other));
            let mut distance = replaced.min(last[to + 1] + 1).min(row[to] + 1);
            if at > 0 && to > 0 && same(letter, right[to - 1]) && same(left[at - 1], other) {
                distance = distance.min(before[to - 1] + 1);
            }
            row[to + 1] = distance;
            least = least.min(distance);
        }
        // A swap goes back two rows, so one row alone does not decide; its neighbor may be one less.
        if least > limit + 1 {
            return None;
        }
        std::mem::swap(before, last);
        std::mem::swap(last, row);
    }
    let distance = last[right.len()];
    (distance <= limit).then_some(distance)
}

/// `PATH1` and `PATH2` are not misspellings of each other.
fn differ_in_digits_only(left: &[u8], right: &[u8]) -> bool {
    let has_digit = left.iter().chain(right).any(u8::is_ascii_digit);
    let is_letter = |byte: &&u8| !byte.is_ascii_digit();
    left != right && has_digit && left.iter().filter(is_letter).eq(right.iter().filter(is_letter))
}

#[cfg(test)]
mod tests {
    use smol_str::SmolStr;

    use super::*;

    #[test]
    fn a_swap_of_neighbors_counts_as_one_mistake() {
        assert_eq!(edit_distance_at_most("Drvie", "Drive", 2), Some(1));
        assert_eq!(edit_distance_at_most("Drive", "Dive", 2), Some(1));
        assert_eq!(edit_distance_at_most("Drive", "Sample", 2), None);
    }

    #[test]
    fn names_that_differ_in_their_number_are_not_alike() {
        assert_eq!(edit_distance_at_most("PATH1", "PATH2", 2), None);
        assert_eq!(edit_distance_at_most("PTAH1", "PATH1", 2), Some(1));
    }

    #[test]
    fn distances_are_those_of_the_textbook() {
        let mut seed = 7_u64;
        let mut below = |limit: u64| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) % limit
        };
        for _ in 0..20_000 {
            let mut word = || -> String {
                let length = below(9);
                (0..length).map(|_| char::from(b"abCd"[below(4) as usize])).collect()
            };
            let (one, other) = (word(), word());
            let whole = strsim::osa_distance(&one.to_lowercase(), &other.to_lowercase());
            for limit in 1..=3 {
                let expected = (whole <= limit).then_some(whole);
                assert_eq!(edit_distance_at_most(&one, &other, limit), expected, "{one} {other}");
            }
        }
    }

    #[test]
    fn of_many_names_those_that_begin_or_end_alike_are_compared_and_no_others() {
        let mut names = Names::default();
        let known: Vec<Symbol> =
            (0..10_000).map(|at| names.intern(&SmolStr::from(format!("Activity{at}")))).collect();
        let alphabet = Alphabet::new(&names, known.iter().copied());
        let around: Vec<Symbol> = alphabet.around(&names, "Activty1234").collect();
        assert!(around.len() <= 8 * NEIGHBORS);
        assert!(around.contains(&known[1234]));
        assert!(alphabet.around(&names, "ctivity77").any(|found| found == known[77]));
        assert!(alphabet.around(&names, "Activity77x").any(|found| found == known[77]));
    }
}
