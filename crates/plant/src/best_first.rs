//! The most likely states after a step, best first, with conflicts to skip what cannot be (SPEC 9.1).
//!
//! Conflict-directed A* (Williams and Ragno 2007) over sets of modes: a node holds the modes that each component may
//! have, its bound is the most that any of its states can weigh, and a node is split around its most promising state
//! (as Murty's 1968 ranking of assignments does), or around the conflict that rules that state out.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use num_bigint::BigUint;
use num_integer::Integer as _;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::exact::weighed;
use crate::likelihood::Likelihoods;
use crate::model::{Commands, Model, Observation};
use crate::normalization::Normalization;
use crate::odds::{Bests, Odds, best_of, multiply};
use crate::successor::{Choices, EstimateError, distributions};
use crate::value_set::ValueSet;

/// How many states as likely as the last one wanted are looked at, to list the first of them in the order of modes.
const MAX_TIES: usize = 16;

/// What a search did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SearchStatistics {
    /// Nodes taken off the queue.
    pub expanded: u32,
    /// States checked against the observation.
    pub checked: u32,
    /// Conflicts found.
    pub conflicts: u32,
    /// Whether the search stopped at its limit: then more likely states may have been missed.
    pub limit_reached: bool,
    /// Whether all states that the observation leaves were found.
    pub is_complete: bool,
}

/// The `most` most likely states after `commands` and `observation`; all of them for `usize::MAX`.
///
/// Ranks exactly with respect to the given belief; what is not kept is bounded. At most `limit` nodes are expanded; each
/// costs time in proportion to components times states of the belief.
pub fn update_best(
    model: &Model,
    belief: &Belief,
    commands: &Commands,
    observation: &Observation,
    most: usize,
    limit: u32,
) -> Result<(Belief, SearchStatistics), EstimateError> {
    let prior: Vec<&State> = belief.entries().iter().map(|(state, _)| state).collect();
    let choices = distributions(model, &prior, commands)?;
    let normalization = Normalization::new(model, &choices, prior.len(), false);
    let normalized = normalization.applied(belief)?;
    let rescaled = normalized.as_ref().unwrap_or(belief);
    let mut likelihoods = Likelihoods::new(model, observation);
    let mut search = Search::new(model, rescaled, &choices, &mut likelihoods);
    let found = search.run(most.max(1), limit, &mut likelihoods);
    let mut statistics = search.statistics;
    statistics.is_complete &= found.len() <= most;
    let (weights, unit) = exact_weights(rescaled, &choices, &found);
    let mut dropped = belief.dropped() * &normalization.unit * &unit.all;
    if !statistics.is_complete {
        // What was not found measures no more than it did before the observation.
        let all = belief.total() * &normalization.unit * &unit.all;
        let found: BigUint = weights.iter().sum::<BigUint>() * &unit.taken_out;
        dropped += if all > found { all - found } else { BigUint::zero() };
    }
    let (mut weights, common) = weighed(model, found.into_iter().zip(weights).collect(), &mut likelihoods);
    if !dropped.is_zero() {
        // In one unit, so that nothing is rounded.
        let greatest = likelihoods.max_of_all();
        let (weight, divisor) =
            greatest.map_or_else(|| (BigUint::zero(), BigUint::one()), |it| (it.weight, it.divisor));
        dropped = dropped * common * weight;
        let unit = unit.taken_out * divisor;
        for (_, weight) in &mut weights {
            *weight *= &unit;
        }
    }
    let updated = Belief::measured(weights, dropped, most).ok_or(EstimateError::Unexplained)?;
    Ok((updated, statistics))
}

/// What weights of states are in proportion to.
struct Unit {
    /// The weight of all that all components may do.
    all: BigUint,
    /// By what the weights of states are smaller.
    taken_out: BigUint,
}

/// Returns how likely each state is before it is observed, as long numbers in proportion.
///
/// What all weights of a component have in common is left out: most components do the same in all likely states, so
/// that the numbers stay short.
fn exact_weights(belief: &Belief, choices: &Choices, states: &[State]) -> (Vec<BigUint>, Unit) {
    let rows = belief.len();
    let mut unit = Unit { all: BigUint::one(), taken_out: BigUint::one() };
    let mut common = vec![1_u64; choices.components()];
    let mut relevant: Vec<usize> = Vec::new();
    for (component, common) in common.iter_mut().enumerate() {
        let modes: ValueSet = states.iter().map(|state| state.0[component]).collect();
        let mut divisor = 0;
        let mut is_same = true;
        for row in (0..rows).filter(|row| !choices.is_repeated(*row, component)) {
            let mut missing = modes;
            for &(mode, weight) in choices.of(row, component) {
                if modes.contains(mode) && weight != divisor {
                    is_same &= divisor == 0;
                    divisor = divisor.gcd(&weight);
                }
                missing &= !ValueSet::one(mode);
            }
            is_same &= missing.is_empty();
        }
        *common = divisor.max(1);
        let all: u64 = choices.of(0, component).iter().map(|(_, weight)| weight).sum();
        if all != *common {
            unit.all *= all;
            unit.taken_out *= *common;
        }
        if !is_same {
            relevant.push(component);
        }
    }
    let weight = |state: &State| {
        let mut sum = BigUint::zero();
        'prior: for (row, (_, weight)) in belief.entries().iter().enumerate() {
            // Small factors are gathered in a machine word before they meet the long number.
            let mut product = weight.clone();
            let mut gathered = 1_u64;
            for &component in &relevant {
                let mode = state.0[component];
                let found = choices.of(row, component).iter().find(|(known, _)| *known == mode);
                let Some((_, weight)) = found else { continue 'prior };
                let factor = weight / common[component];
                gathered = gathered.checked_mul(factor).unwrap_or_else(|| {
                    product *= gathered;
                    factor
                });
            }
            if gathered != 1 {
                product *= gathered;
            }
            sum += product;
        }
        sum
    };
    (states.iter().map(weight).collect(), unit)
}

/// The most promising part of an expanded node that was not looked at yet.
struct Waiting {
    bound: f64,
    /// `None` for the whole, where the search starts.
    part: Option<Part>,
}

/// What is left of an expanded node beside a place in its split.
///
/// Parts are in the order of their age, which breaks ties, so that results do not depend on the queue's insides.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Part {
    /// Where it is among the splits of all nodes.
    at: u32,
    /// The expanded node.
    node: u32,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound).then(other.part.cmp(&self.part))
    }
}

/// Only components that may enter several modes are searched over; they are counted by the odds' `free` below.
struct Search {
    odds: Odds,
    /// Islands of several components, whose modes have to be checked together.
    joint: Vec<usize>,
    /// Free components and options that cannot be together.
    known: Vec<Vec<(u32, u8)>>,
    nodes: Nodes,
    /// Of the node under expansion.
    bests: Bests,
    trial: Trial,
    /// The state looked at.
    state: State,
    /// At most one part of each node.
    queue: BinaryHeap<Waiting>,
    statistics: SearchStatistics,
}

/// Nodes whose most promising state has been looked at.
#[derive(Default)]
struct Nodes {
    /// Per node and free component, the options that it may have.
    sets: Vec<ValueSet>,
    /// Per node and free component, the option of the state looked at.
    chosen: Vec<u8>,
    /// Per node, where its split starts and ends.
    ends: Vec<(u32, u32)>,
    /// The free components around which nodes are split, in order.
    split: Vec<u32>,
    /// For each of them the bound of the part beside it; zero when that was looked at.
    bounds: Vec<f64>,
}

/// Room for the bounds of a node's parts.
#[derive(Default)]
struct Trial {
    is_split: Vec<bool>,
    /// Per prior state, the product over the components of which the part at hand leaves no choice.
    fixed: Vec<f64>,
    /// Per place in the split and prior state, the best product over the components from there on.
    suffix: Vec<f64>,
}

impl Search {
    fn new(model: &Model, belief: &Belief, choices: &Choices, likelihoods: &mut Likelihoods<'_>) -> Self {
        let (odds, state) = Odds::new(model, belief, choices, likelihoods);
        Self {
            joint: (0..model.islands.len()).filter(|&at| model.islands[at].components.len() > 1).collect(),
            known: Vec::new(),
            nodes: Nodes::with_room_for(odds.free.len()),
            bests: Bests::default(),
            trial: Trial::default(),
            odds,
            state,
            queue: BinaryHeap::with_capacity(64),
            statistics: SearchStatistics::default(),
        }
    }

    fn run(&mut self, most: usize, limit: u32, likelihoods: &mut Likelihoods<'_>) -> Vec<State> {
        self.queue.push(Waiting { bound: f64::INFINITY, part: None });
        // Once as many as wanted: most likely first, equally likely ones in the order of their modes.
        let mut found: Vec<(f64, State)> = Vec::new();
        self.statistics.is_complete = true;
        while let Some(waiting) = self.queue.pop() {
            // Machine numbers order the search; a margin keeps rounding from dropping a state that the exact
            // weights, which decide, put among the first.
            if found.len() >= most {
                let last = found.get(most - 1).map_or(0.0, |(value, _)| *value);
                if waiting.bound < last * (1.0 - 1e-9) || found.len() > most.saturating_add(MAX_TIES) {
                    self.statistics.is_complete = false;
                    break;
                }
            }
            if self.statistics.expanded == limit {
                self.statistics.limit_reached = true;
                self.statistics.is_complete = false;
                break;
            }
            self.statistics.expanded += 1;
            if let Some(part) = waiting.part {
                self.nodes.bounds[part.at as usize] = 0.0;
                self.offer(part.node);
            }
            if let Some(value) = self.expand(waiting.part, likelihoods) {
                let one = (value, self.state.clone());
                if found.len() >= most {
                    let at = found.partition_point(|other| rank(other, &one).is_lt());
                    found.insert(at, one);
                } else {
                    found.push(one);
                    if found.len() == most {
                        found.sort_by(rank);
                    }
                }
            }
        }
        found.into_iter().map(|(_, state)| state).collect()
    }

    /// Queues the most promising part of a node that is left.
    fn offer(&mut self, node: u32) {
        let (start, end) = self.nodes.ends[node as usize];
        let mut best = Waiting { bound: 0.0, part: None };
        for (at, &bound) in (start..end).zip(&self.nodes.bounds[start as usize..end as usize]) {
            if bound > best.bound {
                best = Waiting { bound, part: Some(Part { at, node }) };
            }
        }
        if best.part.is_some() {
            self.queue.push(best);
        }
    }

    /// Looks at the most promising state of a node and splits the node; answers how likely the state is, if possible.
    fn expand(&mut self, part: Option<Part>, likelihoods: &mut Likelihoods<'_>) -> Option<f64> {
        let new = self.nodes.sets.len();
        self.nodes.add_sets(part, &self.odds);
        let (product, row) = self.bests.update(&self.odds, &self.nodes.sets[new..]);
        if product == 0.0 && part.is_some() {
            // Too unlikely for machine numbers.
            self.nodes.sets.truncate(new);
            self.statistics.is_complete = false;
            return None;
        }
        let count = self.odds.free.len();
        for (at, option) in self.bests.options(row, self.odds.rows()).enumerate() {
            self.nodes.chosen.push(option);
            self.state.0[self.odds.free[at]] = self.odds.mode(at, option);
        }
        let start = self.nodes.split.len();
        let mut likelihood = None;
        if let Some(conflict) = self.conflict(new, likelihoods) {
            let components = self.known[conflict].iter().map(|(component, _)| *component);
            self.nodes.split.extend(components.filter(|&at| self.nodes.sets[new + at as usize].len() > 1));
        } else {
            let mut value: f64 = self.odds.products(&self.nodes.chosen[new..]).sum();
            for &at in &self.joint {
                value *= likelihoods.chance(at, &self.state.0);
            }
            likelihood = (value > 0.0).then_some(value);
            let several = |at: &u32| self.nodes.sets[new + *at as usize].len() > 1;
            self.nodes.split.extend((0..count as u32).filter(several));
        }
        let end = self.nodes.split.len();
        self.nodes.ends.push((start as u32, end as u32));
        self.divide(new, start..end);
        self.offer(self.nodes.ends.len() as u32 - 1);
        likelihood
    }

    /// Bounds the parts of a node that are left when the chosen state, or the conflict in it, is taken out.
    fn divide(&mut self, new: usize, split: std::ops::Range<usize>) {
        let (count, rows) = (self.odds.free.len(), self.odds.rows());
        let Trial { is_split, fixed, suffix } = &mut self.trial;
        let split = &self.nodes.split[split];
        is_split.clear();
        is_split.resize(count, false);
        for &at in split {
            is_split[at as usize] = true;
        }
        fixed.clone_from(&self.odds.prior);
        for (best, _) in self.bests.components(rows).zip(&*is_split).filter(|(_, is_split)| !**is_split) {
            multiply(fixed, best);
        }
        suffix.resize((split.len() + 1) * rows, 1.0);
        suffix[split.len() * rows..].fill(1.0);
        for (place, &at) in split.iter().enumerate().rev() {
            let (before, after) = suffix.split_at_mut((place + 1) * rows);
            let best = self.bests.component(at as usize, rows);
            let factors = after[..rows].iter().zip(best);
            for (product, (after, best)) in before[place * rows..].iter_mut().zip(factors) {
                *product = after * best;
            }
        }
        for (place, &at) in split.iter().enumerate() {
            let at = at as usize;
            let chosen = self.nodes.chosen[new + at];
            let others = self.nodes.sets[new + at] & !ValueSet::one(chosen);
            let after = &suffix[(place + 1) * rows..][..rows];
            let parts = fixed.iter().zip(self.odds.ranked(at)).zip(after);
            let bound = parts.map(|((fixed, ranked), after)| fixed * best_of(ranked, others).0 * after);
            self.nodes.bounds.push(bound.sum());
            multiply(fixed, self.odds.entries(at, chosen));
        }
    }

    /// Returns why the state is impossible, if it is: which of the known sets of modes that cannot be together it
    /// holds.
    fn conflict(&mut self, new: usize, likelihoods: &mut Likelihoods<'_>) -> Option<usize> {
        let chosen = &self.nodes.chosen[new..];
        let holds = |conflict: &Vec<(u32, u8)>| {
            conflict.iter().all(|&(component, option)| chosen[component as usize] == option)
        };
        let known = self.known.iter().position(holds);
        if known.is_some() || self.joint.is_empty() {
            return known;
        }
        self.statistics.checked += 1;
        for &at in &self.joint {
            let Some(involved) = likelihoods.conflict(at, &self.state.0, |id| self.odds.is_free(id)) else {
                continue;
            };
            let conflict = involved.into_iter().filter_map(|component| {
                let at = self.odds.free.binary_search(&(component.0 as usize)).ok()?;
                Some((at as u32, chosen[at]))
            });
            self.statistics.conflicts += 1;
            self.known.push(conflict.collect());
            return Some(self.known.len() - 1);
        }
        None
    }
}

/// The order of found states: most likely first, equally likely ones in the order of their modes.
fn rank(left: &(f64, State), right: &(f64, State)) -> Ordering {
    right.0.total_cmp(&left.0).then_with(|| left.1.cmp(&right.1))
}

impl Nodes {
    /// Room for as many nodes as a search of a usual model takes.
    fn with_room_for(count: usize) -> Self {
        const NODES: usize = 64;
        Self {
            sets: Vec::with_capacity(NODES * count),
            chosen: Vec::with_capacity(NODES * count),
            ends: Vec::with_capacity(NODES),
            split: Vec::with_capacity(4 * NODES),
            bounds: Vec::with_capacity(4 * NODES),
        }
    }

    /// Adds the options of a new node: those of its parent, without what the parts before it hold.
    fn add_sets(&mut self, part: Option<Part>, odds: &Odds) {
        let Some(part) = part else {
            self.sets.extend((0..odds.free.len()).map(|at| odds.full_set(at)));
            return;
        };
        let count = odds.free.len();
        let (start, _) = self.ends[part.node as usize];
        let (parent, new) = (part.node as usize * count, self.sets.len());
        self.sets.extend_from_within(parent..parent + count);
        for at in start..=part.at {
            let component = self.split[at as usize] as usize;
            let option = ValueSet::one(self.chosen[parent + component]);
            let set = &mut self.sets[new + component];
            *set = if at == part.at { *set & !option } else { option };
        }
    }
}
