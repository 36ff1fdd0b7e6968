//! The most likely states after a step, best first, with conflicts to skip what cannot be (SPEC 9.1).
//!
//! Conflict-directed A* (Williams and Ragno 2007) over sets of modes: a node holds the modes that each component may
//! have, its bound is the most that any of its states can weigh, and a node is split around its most promising state
//! (as Murty's 1968 ranking of assignments does), or around the conflict that rules that state out.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use num_bigint::BigUint;
use num_traits::{ToPrimitive as _, Zero as _};

use crate::belief::{Belief, State};
use crate::consistency::Assumed;
use crate::diagnosis::shrink;
use crate::exact::weigh;
use crate::likelihood::{Likelihoods, admits};
use crate::model::{Commands, Model, Observation};
use crate::successor::{EstimateError, distributions};

/// How many states as likely as the last one wanted are looked at, to list the first of them in the order of modes.
const MOST_TIES: usize = 16;

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
}

/// The `most` most likely states after `commands` and `observation`; all of them for `usize::MAX`.
///
/// Ranks exactly with respect to the given belief, which itself may have been truncated. At most `limit` nodes are
/// expanded; each costs time in proportion to components times states of the belief.
pub fn update_best(
    model: &Model,
    belief: &Belief,
    commands: &Commands,
    observation: &Observation,
    most: usize,
    limit: u32,
) -> Result<(Belief, SearchStatistics), EstimateError> {
    let prior: Vec<&State> = belief.entries().iter().map(|(state, _)| state).collect();
    let weights = distributions(model, &prior, commands)?;
    let mut likelihoods = Likelihoods::new(model, observation);
    let mut search = Search::new(model, belief, &weights, &mut likelihoods);
    let found = search.run(most.max(1), limit, &mut likelihoods);
    let statistics = search.statistics;
    let states: Vec<(State, BigUint)> = found
        .into_iter()
        .map(|state| {
            let weight = exact_weight(belief, &weights, &state);
            (state, weight)
        })
        .collect();
    let updated = weigh(model, states, &mut likelihoods)?;
    let updated = if updated.len() > most { updated.truncated(most) } else { updated };
    Ok((updated, statistics))
}

fn exact_weight(belief: &Belief, weights: &[Vec<Vec<(u8, u64)>>], state: &State) -> BigUint {
    let mut sum = BigUint::zero();
    'prior: for ((_, weight), components) in belief.entries().iter().zip(weights) {
        // Small factors are gathered in a machine word before they meet the long number.
        let mut product = weight.clone();
        let mut gathered = 1_u64;
        for (choices, &mode) in components.iter().zip(&state.0) {
            let Some((_, numerator)) = choices.iter().find(|(known, _)| *known == mode) else {
                continue 'prior;
            };
            gathered = gathered.checked_mul(*numerator).unwrap_or_else(|| {
                product *= gathered;
                *numerator
            });
        }
        sum += product * gathered;
    }
    sum
}

/// A node whose most promising state has been looked at.
struct Expanded {
    /// Per component, the options it may have.
    sets: Vec<u64>,
    /// Per component, the option of the state looked at.
    chosen: Vec<u8>,
    /// The components around which the node is split, in order.
    split: Vec<u32>,
}

/// A part of an expanded node not looked at yet.
struct Waiting {
    bound: f64,
    /// Ties are broken by age, so that results do not depend on the queue's insides.
    age: u32,
    /// The expanded node and the place in its split; `None` for the root.
    part: Option<(u32, u32)>,
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
        self.bound.total_cmp(&other.bound).then(other.age.cmp(&self.age))
    }
}

struct Search<'model> {
    model: &'model Model,
    /// Per component, the modes it may enter.
    options: Vec<Vec<u8>>,
    /// Per component, where its options start in a row of `table`.
    starts: Vec<usize>,
    /// Per prior state and option, its probability and, for components that share nothing, its likelihood.
    table: Vec<Vec<f64>>,
    prior: Vec<f64>,
    /// Islands of several components, whose modes have to be checked together.
    joint: Vec<usize>,
    /// Components and options that cannot be together.
    known: Vec<Vec<(u32, u8)>>,
    expanded: Vec<Expanded>,
    queue: BinaryHeap<Waiting>,
    age: u32,
    statistics: SearchStatistics,
}

impl<'model> Search<'model> {
    fn new(
        model: &'model Model,
        belief: &Belief,
        weights: &[Vec<Vec<(u8, u64)>>],
        likelihoods: &mut Likelihoods<'_>,
    ) -> Self {
        let count = model.components.len();
        let mut options: Vec<Vec<u8>> = vec![Vec::new(); count];
        for components in weights {
            for (options, choices) in options.iter_mut().zip(components) {
                options.extend(choices.iter().map(|(mode, _)| *mode));
            }
        }
        let mut starts = Vec::with_capacity(count);
        let mut width = 0;
        for options in &mut options {
            options.sort_unstable();
            options.dedup();
            starts.push(width);
            width += options.len();
        }
        let mut factors = vec![1.0; width];
        for (at, island) in
            model.islands.iter().enumerate().filter(|(_, island)| island.components.len() == 1)
        {
            for component in &island.components {
                let place = component.0 as usize;
                let mut state = vec![0; count];
                for (option, mode) in options[place].iter().enumerate() {
                    state[place] = *mode;
                    let divisor = likelihoods.divisor(at, &state).to_f64().unwrap_or(f64::MAX);
                    factors[starts[place] + option] = if divisor > 0.0 { 1.0 / divisor } else { 0.0 };
                }
            }
        }
        let mut table = Vec::with_capacity(weights.len());
        for components in weights {
            let mut row = vec![0.0; width];
            for (place, choices) in components.iter().enumerate() {
                let total: u64 = choices.iter().map(|(_, weight)| weight).sum();
                for (mode, weight) in choices {
                    let option = options[place].binary_search(mode).unwrap_or(0);
                    row[starts[place] + option] =
                        *weight as f64 / total as f64 * factors[starts[place] + option];
                }
            }
            table.push(row);
        }
        let joint = (0..model.islands.len()).filter(|&at| model.islands[at].components.len() > 1).collect();
        Self {
            model,
            options,
            starts,
            table,
            prior: belief.approximate(),
            joint,
            known: Vec::new(),
            expanded: Vec::new(),
            queue: BinaryHeap::new(),
            age: 0,
            statistics: SearchStatistics::default(),
        }
    }

    fn run(&mut self, most: usize, limit: u32, likelihoods: &mut Likelihoods<'_>) -> Vec<State> {
        let all: Vec<u64> =
            self.options.iter().map(|options| u64::MAX >> (64 - options.len().clamp(1, 64))).collect();
        let bound = (0..self.prior.len()).map(|row| self.prior[row] * self.product(row, &all)).sum();
        self.push(bound, None);
        let mut found: Vec<(f64, State)> = Vec::new();
        while let Some(waiting) = self.queue.pop() {
            // Machine numbers order the search; a margin keeps rounding from dropping a state that the exact
            // weights, which decide, put among the first.
            if found.len() >= most {
                found.sort_by(|left, right| right.0.total_cmp(&left.0).then_with(|| left.1.cmp(&right.1)));
                let last = found.get(most - 1).map_or(0.0, |(value, _)| *value);
                if waiting.bound < last * (1.0 - 1e-9) || found.len() > most.saturating_add(MOST_TIES) {
                    break;
                }
            }
            if self.statistics.expanded == limit {
                self.statistics.limit_reached = true;
                break;
            }
            self.statistics.expanded += 1;
            self.expand(waiting.part, &mut found, likelihoods);
        }
        found.into_iter().map(|(_, state)| state).collect()
    }

    fn push(&mut self, bound: f64, part: Option<(u32, u32)>) {
        if bound > 0.0 {
            self.age += 1;
            self.queue.push(Waiting { bound, age: self.age, part });
        }
    }

    fn sets_of(&self, part: Option<(u32, u32)>) -> Vec<u64> {
        let Some((parent, place)) = part else {
            return self
                .options
                .iter()
                .map(|options| u64::MAX >> (64 - options.len().clamp(1, 64)))
                .collect();
        };
        let Some(parent) = self.expanded.get(parent as usize) else { return Vec::new() };
        let mut sets = parent.sets.clone();
        for &component in parent.split.iter().take(place as usize) {
            sets[component as usize] = 1 << parent.chosen[component as usize];
        }
        if let Some(&component) = parent.split.get(place as usize) {
            sets[component as usize] &= !(1 << parent.chosen[component as usize]);
        }
        sets
    }

    fn expand(
        &mut self,
        part: Option<(u32, u32)>,
        found: &mut Vec<(f64, State)>,
        likelihoods: &mut Likelihoods<'_>,
    ) {
        let sets = self.sets_of(part);
        let row = (0..self.prior.len())
            .map(|row| (self.prior[row] * self.product(row, &sets), row))
            .reduce(|best, next| if next.0 > best.0 { next } else { best })
            .map_or(0, |(_, row)| row);
        let chosen: Vec<u8> =
            (0..sets.len()).map(|component| self.best(row, component, sets[component]).1).collect();
        let state = State((0..sets.len()).map(|at| self.options[at][chosen[at] as usize]).collect());
        let split = if let Some(conflict) = self.conflict(&chosen, &state, likelihoods) {
            conflict.into_iter().map(|(component, _)| component).collect()
        } else {
            let mut value: f64 = (0..self.prior.len())
                .map(|row| {
                    let table = &self.table[row];
                    chosen.iter().zip(&self.starts).fold(self.prior[row], |product, (option, start)| {
                        product * table[start + *option as usize]
                    })
                })
                .sum();
            for &at in &self.joint {
                value /= likelihoods.divisor(at, &state.0).to_f64().unwrap_or(f64::MAX).max(1.0);
            }
            if value > 0.0 {
                found.push((value, state));
            }
            (0..sets.len() as u32).collect::<Vec<u32>>()
        };
        let split: Vec<u32> = split.into_iter().filter(|&at| sets[at as usize].count_ones() > 1).collect();
        self.divide(sets, chosen, split);
    }

    /// Queues the parts of a node that are left when the chosen state, or the conflict in it, is taken out.
    fn divide(&mut self, sets: Vec<u64>, chosen: Vec<u8>, split: Vec<u32>) {
        let mut bounds = vec![0.0; split.len()];
        let mut suffix = vec![1.0; split.len() + 1];
        for row in 0..self.prior.len() {
            let mut fixed = self.prior[row];
            let mut inside = vec![false; sets.len()];
            for &at in &split {
                inside[at as usize] = true;
            }
            for (at, &set) in sets.iter().enumerate() {
                if !inside[at] {
                    fixed *= self.best(row, at, set).0;
                }
            }
            if fixed == 0.0 {
                continue;
            }
            for (place, &at) in split.iter().enumerate().rev() {
                suffix[place] = suffix[place + 1] * self.best(row, at as usize, sets[at as usize]).0;
            }
            for (place, &at) in split.iter().enumerate() {
                let at = at as usize;
                let others = sets[at] & !(1 << chosen[at]);
                bounds[place] += fixed * self.best(row, at, others).0 * suffix[place + 1];
                fixed *= self.table[row][self.starts[at] + chosen[at] as usize];
            }
        }
        let parent = self.expanded.len() as u32;
        self.expanded.push(Expanded { sets, chosen, split });
        for (place, bound) in bounds.into_iter().enumerate() {
            self.push(bound, Some((parent, place as u32)));
        }
    }

    /// The largest entry of a row among a component's options in `set`, and which it is; zero for an empty set.
    fn best(&self, row: usize, component: usize, mut set: u64) -> (f64, u8) {
        let start = self.starts[component];
        let mut best = (0.0, set.trailing_zeros().min(63) as u8);
        while set != 0 {
            let option = set.trailing_zeros() as u8;
            set &= set - 1;
            let value = self.table[row][start + option as usize];
            if value > best.0 {
                best = (value, option);
            }
        }
        best
    }

    fn product(&self, row: usize, sets: &[u64]) -> f64 {
        sets.iter()
            .enumerate()
            .fold(1.0, |product, (component, &set)| product * self.best(row, component, set).0)
    }

    /// Why the state is impossible, if it is: some of its modes that cannot be together under the observation.
    fn conflict(
        &mut self,
        chosen: &[u8],
        state: &State,
        likelihoods: &Likelihoods<'_>,
    ) -> Option<Vec<(u32, u8)>> {
        let holds = |conflict: &&Vec<(u32, u8)>| {
            conflict.iter().all(|&(component, option)| chosen.get(component as usize) == Some(&option))
        };
        if let Some(known) = self.known.iter().find(holds) {
            return Some(known.clone());
        }
        if self.joint.is_empty() {
            return None;
        }
        self.statistics.checked += 1;
        for &at in &self.joint {
            let island = &self.model.islands[at];
            let Err(places) = admits(self.model, island, &state.0, likelihoods.observed()) else { continue };
            let mut assumed = Assumed::all(self.model, island, &state.0);
            shrink(&mut assumed, likelihoods.observed(), places);
            let conflict: Vec<(u32, u8)> = island
                .components
                .iter()
                .zip(&assumed.modes)
                .filter(|(_, mode)| mode.is_some())
                .map(|(component, _)| (component.0, chosen[component.0 as usize]))
                .collect();
            self.statistics.conflicts += 1;
            self.known.push(conflict.clone());
            return Some(conflict);
        }
        None
    }
}
