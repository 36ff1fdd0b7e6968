//! The stack of choice points, sets of them as reasons of failures, and the conflicts learned from them.

use stn::Checkpoint;

use crate::trace::TreeNodeId;

/// A point of the search where alternatives are tried one after the other.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) kind: Kind,
    /// The alternative to try next.
    pub(crate) next: u32,
    /// The first one not to try.
    pub(crate) end: u32,
    /// Levels below that failures of alternatives so far rest on.
    pub(crate) conflict: LevelSet,
    pub(crate) checkpoint: Checkpoint,
    pub(crate) tree_mark: usize,
    pub(crate) num_selected_nodes: u32,
    pub(crate) num_selected_arcs: u32,
    /// The state in which the choice is made, and the first of its alternatives' states.
    pub(crate) tree_node: TreeNodeId,
    pub(crate) first_child: TreeNodeId,
}

/// What is chosen at a level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Decision {
        decision: u32,
    },
    /// `position` among the requirements of the leaf; `tells` are the candidates.
    Link {
        position: u32,
        ask: u32,
        tells: Vec<u32>,
    },
    /// `position` among the conflicting pairs of the leaf.
    Threat {
        position: u32,
        left: u32,
        right: u32,
    },
}

/// A set of levels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct LevelSet {
    words: Vec<u64>,
}

impl LevelSet {
    pub(crate) fn clear(&mut self) {
        self.words.clear();
    }

    pub(crate) fn insert(&mut self, level: u32) {
        let word = level as usize / 64;
        if word >= self.words.len() {
            self.words.resize(word + 1, 0);
        }
        self.words[word] |= 1 << (level % 64);
    }

    pub(crate) fn insert_all_below(&mut self, level: u32) {
        for below in 0..level {
            self.insert(below);
        }
    }

    pub(crate) fn remove(&mut self, level: u32) {
        if let Some(word) = self.words.get_mut(level as usize / 64) {
            *word &= !(1 << (level % 64));
        }
    }

    pub(crate) fn union(&mut self, other: &Self) {
        if other.words.len() > self.words.len() {
            self.words.resize(other.words.len(), 0);
        }
        for (word, other) in self.words.iter_mut().zip(&other.words) {
            *word |= other;
        }
    }

    pub(crate) fn highest(&self) -> Option<u32> {
        let word = self.words.iter().rposition(|&word| word != 0)?;
        Some(word as u32 * 64 + 63 - self.words[word].leading_zeros())
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = u32> + '_ {
        (0..).zip(&self.words).flat_map(|(word, &bits)| {
            (0..64_u32).filter(move |bit| bits >> bit & 1 == 1).map(move |bit| word * 64 + bit)
        })
    }
}

/// Choices that cannot stand together, kept with the last of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nogoods {
    by_last: Vec<Vec<Nogood>>,
}

#[derive(Clone, Debug)]
struct Nogood {
    alternative: u32,
    others: Vec<(u32, u32)>,
}

/// Longer conflicts seldom recur.
const MAX_CHOICES: usize = 12;
/// More per decision cost more to look through than they save.
const MAX_PER_DECISION: usize = 64;

impl Nogoods {
    pub(crate) fn new(num_decisions: usize) -> Self {
        Self { by_last: vec![Vec::new(); num_decisions] }
    }

    /// Learns that `choices` fail together; the last one is the one made last. `false` if it is not worth keeping.
    pub(crate) fn learn(&mut self, choices: &[(u32, u32)]) -> bool {
        let Some((&(decision, alternative), others)) = choices.split_last() else { return false };
        let known = &mut self.by_last[decision as usize];
        if others.len() >= MAX_CHOICES || known.len() >= MAX_PER_DECISION {
            return false;
        }
        known.push(Nogood { alternative, others: others.to_vec() });
        true
    }

    /// The other choices of a conflict that taking `alternative` would complete.
    pub(crate) fn find(&self, chosen: &[u32], decision: u32, alternative: u32) -> Option<&[(u32, u32)]> {
        let completes = |nogood: &&Nogood| {
            nogood.alternative == alternative
                && nogood
                    .others
                    .iter()
                    .all(|&(decision, alternative)| chosen[decision as usize] == alternative)
        };
        self.by_last[decision as usize].iter().find(completes).map(|nogood| nogood.others.as_slice())
    }
}
