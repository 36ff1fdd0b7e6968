//! Which of two intervals comes first, of many pairs: what follows from two others need not be looked at.

use std::collections::BTreeMap;

use tpn::LabelId;

/// Pairs of intervals, the first of which ends before the second one starts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Before {
    /// Where each interval is found.
    positions: BTreeMap<LabelId, usize>,
    /// By position: how many come before.
    ranks: Vec<usize>,
    /// By position of the first: those that come after, as bits by position.
    after: Vec<Vec<u64>>,
    /// By position: those that come after right away, so that nothing lies between.
    next: Vec<Vec<usize>>,
}

impl Before {
    /// Of pairs without circles.
    pub(crate) fn new(pairs: &[(LabelId, LabelId)]) -> Self {
        let mut labels: Vec<LabelId> = pairs.iter().flat_map(|&(first, then)| [first, then]).collect();
        labels.sort_unstable();
        labels.dedup();
        let positions: BTreeMap<LabelId, usize> = labels.iter().copied().zip(0..).collect();
        let mut before = Self {
            ranks: vec![0; labels.len()],
            after: vec![vec![0; labels.len().div_ceil(64)]; labels.len()],
            next: vec![Vec::new(); labels.len()],
            positions,
        };
        for &(first, then) in pairs {
            let [first, then] = [first, then].map(|label| before.positions[&label]);
            before.ranks[then] += 1;
            before.after[first][then / 64] |= 1 << (then % 64);
        }
        let mut by_rank: Vec<usize> = (0..labels.len()).collect();
        by_rank.sort_by_key(|&position| (before.ranks[position], position));
        for first in 0..labels.len() {
            let mut next: Vec<usize> = Vec::new();
            for &then in &by_rank {
                if before.has(first, then) && !next.iter().any(|&between| before.has(between, then)) {
                    next.push(then);
                }
            }
            before.next[first] = next;
        }
        before
    }

    fn has(&self, first: usize, then: usize) -> bool {
        self.after[first][then / 64] >> (then % 64) & 1 == 1
    }

    /// Whether a pair is among them.
    pub(crate) fn holds(&self, first: LabelId, then: LabelId) -> bool {
        match (self.positions.get(&first), self.positions.get(&then)) {
            (Some(&first), Some(&then)) => self.has(first, then),
            _ => false,
        }
    }

    /// How many come before an interval: what comes after another one has more.
    pub(crate) fn rank(&self, label: LabelId) -> usize {
        self.positions.get(&label).map_or(0, |&position| self.ranks[position])
    }

    /// Whether a pair follows from two others, because something lies between.
    pub(crate) fn is_implied(&self, first: LabelId, then: LabelId) -> bool {
        match (self.positions.get(&first), self.positions.get(&then)) {
            (Some(&first), Some(then)) => !self.next[first].contains(then),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(index: u32) -> LabelId {
        LabelId(index)
    }

    #[test]
    fn of_a_chain_only_neighbours_are_left() {
        let all = (0..9).flat_map(|first| (first + 1..9).map(move |then| (label(first), label(then))));
        let pairs: Vec<(LabelId, LabelId)> = all.collect();
        let before = Before::new(&pairs);
        let left: Vec<_> = pairs.iter().filter(|&&(first, then)| !before.is_implied(first, then)).collect();
        assert_eq!(left.len(), 8);
        assert!(left.iter().all(|(first, then)| first.0 + 1 == then.0));
        assert!(before.holds(label(0), label(8)) && !before.holds(label(8), label(0)));
        assert_eq!(before.rank(label(5)), 5);
    }

    #[test]
    fn what_is_not_ordered_with_what_lies_between_is_kept() {
        // 0 before 1 and 2, which are not ordered; 1 before 3, and 0 before 3 follows from that.
        let pairs = [(0, 1), (0, 2), (1, 3), (0, 3)].map(|(first, then)| (label(first), label(then)));
        let before = Before::new(&pairs);
        let implied: Vec<bool> = pairs.iter().map(|&(first, then)| before.is_implied(first, then)).collect();
        assert_eq!(implied, [false, false, false, true]);
    }
}
