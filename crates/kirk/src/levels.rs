//! The stack of choice points, sets of them as reasons of failures, and the conflicts learned from them.

use fixedbitset::FixedBitSet;
use stn::Checkpoint;
use tpn::{Choice, DecisionId, LabelId};
use typed_index_collections::TiVec;

use crate::ids::LevelId;
use crate::model::Alternatives;
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
        decision: DecisionId,
    },
    /// `position` among the requirements of the leaf; `tells` are the candidates.
    Link {
        position: u32,
        ask: LabelId,
        tells: Vec<LabelId>,
    },
    /// `position` among the conflicting pairs of the leaf.
    Threat {
        position: u32,
        left: LabelId,
        right: LabelId,
    },
}

/// A set of levels.
#[derive(Clone, Debug, Default)]
pub(crate) struct LevelSet {
    levels: FixedBitSet,
}

impl LevelSet {
    pub(crate) fn clear(&mut self) {
        self.levels.clear();
    }

    pub(crate) fn insert(&mut self, level: LevelId) {
        self.levels.grow_and_insert(level.into());
    }

    pub(crate) fn insert_all_below(&mut self, level: LevelId) {
        let end = usize::from(level);
        self.levels.grow(end);
        self.levels.insert_range(..end);
    }

    pub(crate) fn remove(&mut self, level: LevelId) {
        if self.levels.contains(level.into()) {
            self.levels.remove(level.into());
        }
    }

    pub(crate) fn union(&mut self, other: &Self) {
        self.levels.union_with(&other.levels);
    }

    pub(crate) fn highest(&self) -> Option<LevelId> {
        self.levels.maximum().map(LevelId::from)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = LevelId> + '_ {
        self.levels.ones().map(LevelId::from)
    }
}

/// Choices that cannot stand together, kept with the last of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Nogoods {
    by_last: TiVec<DecisionId, Vec<Nogood>>,
}

#[derive(Clone, Debug)]
struct Nogood {
    alternative: u32,
    others: Vec<Choice>,
}

/// Longer conflicts seldom recur.
const MAX_CHOICES: usize = 12;
/// More per decision cost more to look through than they save.
const MAX_PER_DECISION: usize = 64;

impl Nogoods {
    pub(crate) fn new(num_decisions: usize) -> Self {
        Self { by_last: vec![Vec::new(); num_decisions].into() }
    }

    /// Learns that `choices` fail together; the last one is the one made last. `false` if it is not worth keeping.
    pub(crate) fn learn(&mut self, choices: &[Choice]) -> bool {
        let Some((&Choice { decision, alternative }, others)) = choices.split_last() else { return false };
        let known = &mut self.by_last[decision];
        if others.len() >= MAX_CHOICES || known.len() >= MAX_PER_DECISION {
            return false;
        }
        known.push(Nogood { alternative, others: others.to_vec() });
        true
    }

    /// The other choices of a conflict that taking an alternative would complete.
    pub(crate) fn find(&self, chosen: &Alternatives, choice: Choice) -> Option<&[Choice]> {
        let completes = |nogood: &&Nogood| {
            nogood.alternative == choice.alternative
                && nogood.others.iter().all(|other| chosen[other.decision] == Some(other.alternative))
        };
        self.by_last[choice.decision].iter().find(completes).map(|nogood| nogood.others.as_slice())
    }
}
