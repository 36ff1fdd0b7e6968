//! What is believed of a whole plant: a belief for each group of components, whose product it is (SPEC3 17.2).

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

use num_bigint::BigUint;
use num_traits::{One as _, ToPrimitive as _};
use serde::{Deserialize, Serialize};

use crate::belief::{Belief, State};
use crate::group::Group;
use crate::interval::{Interval, product};
use crate::model::{ComponentId, Model};
use crate::probability::Probability;

/// The product of the beliefs of groups that nothing ties together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FactoredBelief {
    parts: Vec<BelievedGroup>,
    /// In which each group is in its most likely state.
    most_likely: State,
}

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct BelievedGroup {
    components: Arc<[ComponentId]>,
    belief: Arc<Belief>,
}

impl FactoredBelief {
    /// Certainty of one state.
    pub fn certain(groups: &[Group], state: &State) -> Self {
        Self::new(groups, groups.iter().map(|group| Arc::new(Belief::certain(group.state(state)))).collect())
    }

    /// Certainty of another state: what is believed of groups that are in the same state in it is shared.
    #[must_use]
    pub fn certain_of(&self, groups: &[Group], state: &State) -> Self {
        let beliefs = groups.iter().zip(&self.parts).map(|(group, part)| {
            let own = group.state(state);
            if part.belief.is_certain_of(&own) {
                Arc::clone(&part.belief)
            } else {
                Arc::new(Belief::certain(own))
            }
        });
        Self::new(groups, beliefs.collect())
    }

    /// The product of these beliefs, one for each group.
    pub fn new(groups: &[Group], beliefs: Vec<Arc<Belief>>) -> Self {
        let count = groups.iter().map(|group| group.components.len()).sum();
        let mut most_likely = State(vec![0; count]);
        for (group, belief) in groups.iter().zip(&beliefs) {
            place(&group.components, belief.most_likely(), &mut most_likely);
        }
        let parts = groups.iter().zip(beliefs);
        let parts =
            parts.map(|(group, belief)| BelievedGroup { components: Arc::clone(&group.components), belief });
        Self { parts: parts.collect(), most_likely }
    }

    /// The beliefs of the groups.
    pub fn beliefs(&self) -> impl ExactSizeIterator<Item = &Arc<Belief>> {
        self.parts.iter().map(|part| &part.belief)
    }

    /// The most likely state.
    pub const fn most_likely(&self) -> &State {
        &self.most_likely
    }

    /// Returns how many states are believed possible; the largest number where there are more.
    pub fn len(&self) -> usize {
        self.parts.iter().fold(1, |all, part| all.saturating_mul(part.belief.len()))
    }

    /// Never: a belief holds at least one state.
    pub fn is_empty(&self) -> bool {
        self.parts.iter().any(|part| part.belief.is_empty())
    }

    /// Returns whether nothing was dropped, so that all probabilities are exact.
    pub fn is_exact(&self) -> bool {
        self.parts.iter().all(|part| part.belief.is_exact())
    }

    /// Returns which share of what explains all observations was dropped at most.
    pub fn dropped(&self) -> Probability {
        let kept = self.parts.iter().filter(|part| !part.belief.is_exact()).map(|part| part.belief.kept());
        Probability::one() - kept.fold(Probability::one(), |all, kept| all * kept)
    }

    /// The probability of the most likely state.
    pub fn highest_probability(&self) -> Interval {
        self.probability(&vec![0; self.parts.len()])
    }

    /// The states that differ from the most likely one only in some groups, with their weights, in the same order.
    pub(crate) fn states_of(&self, groups: &[usize]) -> impl Iterator<Item = (State, BigUint)> + use<'_> {
        let mut ranking = Ranking::new(self, groups.to_vec());
        std::iter::from_fn(move || ranking.next().map(|next| (next.state, next.weight)))
    }

    /// The same states, at most so many, each with its share in what they weigh together, as a machine number.
    pub fn shares_of(&self, groups: &[usize], most: usize) -> Vec<(State, f64)> {
        let states: Vec<(State, BigUint)> = self.states_of(groups).take(most).collect();
        let total: BigUint = states.iter().map(|(_, weight)| weight).sum();
        // Long numbers are cut to what a machine number can hold.
        let excess = total.bits().saturating_sub(900);
        let number = |weight: &BigUint| (weight >> excess).to_f64().unwrap_or(0.0);
        let whole = number(&total);
        states.into_iter().map(|(state, weight)| (state, number(&weight) / whole)).collect()
    }

    /// The same beliefs, but for one group.
    #[must_use]
    pub fn with(&self, groups: &[Group], at: usize, belief: Arc<Belief>) -> Self {
        let mut beliefs: Vec<Arc<Belief>> = self.beliefs().cloned().collect();
        if let Some(slot) = beliefs.get_mut(at) {
            *slot = belief;
        }
        Self::new(groups, beliefs)
    }

    /// The states with their probabilities, most likely first; equally likely ones in the order of their modes.
    pub fn states(&self) -> impl Iterator<Item = (State, Interval)> + '_ {
        let mut ranking = Ranking::new(self, (0..self.parts.len()).collect());
        std::iter::from_fn(move || {
            let next = ranking.next()?;
            Some((next.state, self.probability(&next.ranks)))
        })
    }

    /// The probabilities of a component's modes, by mode.
    pub fn marginal(&self, model: &Model, component: ComponentId) -> Vec<Interval> {
        let modes = model.component(component).map_or(0, |component| component.modes.len());
        let part = self.parts.iter().find_map(|part| {
            let place = part.components.binary_search(&component).ok()?;
            Some((part, ComponentId(place as u32)))
        });
        part.map_or_else(Vec::new, |(part, component)| part.belief.marginal_of(modes, component))
    }

    /// The probability of the state in which each group is in its state of this rank.
    fn probability(&self, ranks: &[usize]) -> Interval {
        let each: Vec<_> = self
            .parts
            .iter()
            .zip(ranks)
            .map(|(part, rank)| (part.belief.fraction(part.belief.weight(*rank)), part.belief.kept()))
            .collect();
        product(each.iter().map(|(low, kept)| (low, kept)))
    }
}

/// Puts the modes of a group's state into that of the whole plant.
fn place(components: &[ComponentId], own: &State, whole: &mut State) {
    for (component, mode) in components.iter().zip(&own.0) {
        whole.set_mode(*component, *mode);
    }
}

/// A state of the whole plant that is waiting for its turn.
#[derive(PartialEq, Eq)]
struct Ranked {
    /// The product of its groups' weights.
    weight: BigUint,
    state: State,
    /// Of each group, which of its states it is.
    ranks: Vec<usize>,
    /// The place of the last group that is not in its most likely state; only from there on others follow it.
    last: usize,
}

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.weight.cmp(&other.weight).then_with(|| other.state.cmp(&self.state))
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The states of a product in order, each found when it is asked for.
///
/// A state is followed by those in which one group, its last that is not in its most likely state or a later one, is in the
/// next of its states. They come later in the order of modes where they are as likely.
struct Ranking<'belief> {
    belief: &'belief FactoredBelief,
    /// The groups that may be in other states than their most likely ones, in order.
    groups: Vec<usize>,
    waiting: BinaryHeap<Ranked>,
}

impl<'belief> Ranking<'belief> {
    fn new(belief: &'belief FactoredBelief, groups: Vec<usize>) -> Self {
        let ranks = vec![0; belief.parts.len()];
        let mut ranking = Self { belief, groups, waiting: BinaryHeap::new() };
        let first = ranking.ranked(ranks, 0);
        ranking.waiting.push(first);
        ranking
    }

    fn next(&mut self) -> Option<Ranked> {
        let next = self.waiting.pop()?;
        for place in next.last..self.groups.len() {
            let at = self.groups[place];
            if next.ranks[at] + 1 < self.belief.parts[at].belief.len() {
                let mut ranks = next.ranks.clone();
                ranks[at] += 1;
                let following = self.ranked(ranks, place);
                self.waiting.push(following);
            }
        }
        Some(next)
    }

    fn ranked(&self, ranks: Vec<usize>, last: usize) -> Ranked {
        let mut state = self.belief.most_likely.clone();
        let mut weight = BigUint::one();
        for (part, rank) in self.belief.parts.iter().zip(&ranks) {
            place(&part.components, part.belief.state(*rank), &mut state);
            // What is certain weighs one.
            if !part.belief.weight(*rank).is_one() {
                weight *= part.belief.weight(*rank);
            }
        }
        Ranked { weight, state, ranks, last }
    }
}
