//! The most likely states after a step, best first, with conflicts to skip what cannot be (SPEC 9.1).
//!
//! Conflict-directed A* (Williams and Ragno 2007) over sets of modes: a node holds the modes that each component may
//! have, its bound is the most that any of its states can weigh, and a node is split around its most promising state
//! (as Murty's 1968 ranking of assignments does), or around the conflict that rules that state out.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use num_bigint::BigUint;
use num_integer::Integer as _;
use num_traits::{ToPrimitive as _, Zero as _};

use crate::belief::{Belief, State};
use crate::exact::weigh;
use crate::likelihood::Likelihoods;
use crate::model::{Commands, Model, Observation};
use crate::observe::values;
use crate::successor::{Choices, EstimateError, distributions};

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
    let choices = distributions(model, &prior, commands)?;
    let mut likelihoods = Likelihoods::new(model, observation);
    let mut search = Search::new(model, belief, &choices, &mut likelihoods);
    let found = search.run(most.max(1), limit, &mut likelihoods);
    let statistics = search.statistics;
    let weights = exact_weights(belief, &choices, &found);
    let states = found.into_iter().zip(weights).collect();
    Ok((weigh(model, states, &mut likelihoods, most)?, statistics))
}

/// How likely each state is before it is observed, as long numbers in proportion.
///
/// What all weights of a component have in common is left out: most components do the same in all likely states, so
/// that the numbers stay short.
fn exact_weights(belief: &Belief, choices: &Choices, states: &[State]) -> Vec<BigUint> {
    let rows = belief.len();
    let mut common = vec![1_u64; choices.components()];
    let mut relevant: Vec<usize> = Vec::new();
    for (component, common) in common.iter_mut().enumerate() {
        let modes = states.iter().fold(0_u64, |modes, state| modes | 1 << state.0[component]);
        let mut divisor = 0;
        let mut is_same = true;
        for row in 0..rows {
            let mut missing = modes;
            for &(mode, weight) in choices.of(row, component) {
                if modes >> mode & 1 == 1 && weight != divisor {
                    is_same &= divisor == 0;
                    divisor = divisor.gcd(&weight);
                }
                missing &= !(1 << mode);
            }
            is_same &= missing == 0;
        }
        *common = divisor.max(1);
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
    states.iter().map(weight).collect()
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

/// Only components that may enter several modes are searched over; they are counted by `free` below.
struct Search<'model> {
    model: &'model Model,
    /// The free components.
    free: Vec<usize>,
    /// Per free component, the modes it may enter.
    options: Vec<Vec<u8>>,
    /// Per free component, where its options start in a row of `table`.
    starts: Vec<usize>,
    /// How long a row of `table` is.
    width: usize,
    /// Per prior state and option, its probability and, for components that share nothing, its likelihood.
    table: Vec<f64>,
    /// Per prior state, its probability and that of what its other components do.
    prior: Vec<f64>,
    /// The modes of the components that are not free.
    template: State,
    /// Islands of several components, whose modes have to be checked together.
    joint: Vec<usize>,
    /// Free components and options that cannot be together.
    known: Vec<Vec<(u32, u8)>>,
    nodes: Nodes,
    trial: Trial,
    queue: BinaryHeap<Waiting>,
    age: u32,
    statistics: SearchStatistics,
}

/// Nodes whose most promising state has been looked at.
#[derive(Default)]
struct Nodes {
    /// Per node and free component, the options that it may have.
    sets: Vec<u64>,
    /// Per node and free component, the option of the state looked at.
    chosen: Vec<u8>,
    /// Per node, where its split starts and ends.
    ends: Vec<(u32, u32)>,
    /// The free components around which nodes are split, in order.
    split: Vec<u32>,
}

/// What is worked out of the node under expansion.
#[derive(Default)]
struct Trial {
    /// Per prior state and free component, the best entry of the table and its option.
    best: Vec<(f64, u8)>,
    /// Per prior state, the product of the best entries; zero where one is zero.
    products: Vec<f64>,
    is_split: Vec<bool>,
    suffix: Vec<f64>,
    bounds: Vec<f64>,
}

const fn full_set(options: &[u8]) -> u64 {
    if options.len() >= 64 { u64::MAX } else { (1 << options.len()) - 1 }
}

impl<'model> Search<'model> {
    fn new(
        model: &'model Model,
        belief: &Belief,
        choices: &Choices,
        likelihoods: &mut Likelihoods<'_>,
    ) -> Self {
        let (count, rows) = (model.components.len(), belief.len());
        let mut template = State(vec![0; count]);
        let mut is_alone = vec![None; count];
        for (at, island) in model.islands.iter().enumerate() {
            if let [component] = island.components.as_slice() {
                is_alone[component.0 as usize] = Some(at);
            }
        }
        let (mut free, mut options, mut starts) = (Vec::new(), Vec::new(), Vec::new());
        let mut width = 0;
        let mut prior = belief.approximate();
        let mut factors: Vec<f64> = Vec::new();
        for (component, island) in is_alone.into_iter().enumerate() {
            let entered = (0..rows).flat_map(|row| choices.of(row, component));
            let modes = entered.fold(0_u64, |modes, (mode, _)| modes | 1 << mode);
            let first = factors.len();
            for mode in values(modes) {
                template.0[component] = mode;
                let factor = island.map_or(1.0, |island| {
                    let divisor = likelihoods.divisor(island, &template.0).to_f64().unwrap_or(f64::MAX);
                    if divisor > 0.0 { 1.0 / divisor } else { 0.0 }
                });
                factors.push(factor);
            }
            if modes.count_ones() > 1 {
                free.push(component);
                options.push(values(modes).collect::<Vec<u8>>());
                starts.push(width);
                width += modes.count_ones() as usize;
            } else {
                let factor = factors.get(first).copied().unwrap_or(0.0);
                for prior in &mut prior {
                    *prior *= factor;
                }
                factors.truncate(first);
            }
        }
        let mut table = vec![0.0; rows * width];
        for row in 0..rows {
            for ((&component, options), &start) in free.iter().zip(&options).zip(&starts) {
                let entered = choices.of(row, component);
                let total: u64 = entered.iter().map(|(_, weight)| weight).sum();
                for (mode, weight) in entered {
                    let option = start + options.binary_search(mode).unwrap_or(0);
                    table[row * width + option] = *weight as f64 / total as f64 * factors[option];
                }
            }
        }
        Self {
            model,
            free,
            options,
            starts,
            width,
            table,
            prior,
            template,
            joint: (0..model.islands.len()).filter(|&at| model.islands[at].components.len() > 1).collect(),
            known: Vec::new(),
            nodes: Nodes::default(),
            trial: Trial::default(),
            queue: BinaryHeap::new(),
            age: 0,
            statistics: SearchStatistics::default(),
        }
    }

    fn run(&mut self, most: usize, limit: u32, likelihoods: &mut Likelihoods<'_>) -> Vec<State> {
        self.push(f64::INFINITY, None);
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

    /// Adds the options of a new node: those of its parent, without what the parts before it hold.
    fn add_sets(&mut self, part: Option<(u32, u32)>) {
        let Some((parent, place)) = part else {
            self.nodes.sets.extend(self.options.iter().map(|options| full_set(options)));
            return;
        };
        let count = self.free.len();
        let (start, _) = self.nodes.ends[parent as usize];
        let (parent, new) = (parent as usize * count, self.nodes.sets.len());
        self.nodes.sets.extend_from_within(parent..parent + count);
        for at in start..=start + place {
            let component = self.nodes.split[at as usize] as usize;
            let option = 1_u64 << self.nodes.chosen[parent + component];
            let set = &mut self.nodes.sets[new + component];
            *set = if at == start + place { *set & !option } else { option };
        }
    }

    fn expand(
        &mut self,
        part: Option<(u32, u32)>,
        found: &mut Vec<(f64, State)>,
        likelihoods: &mut Likelihoods<'_>,
    ) {
        let new = self.nodes.sets.len();
        self.add_sets(part);
        let (product, row) = self.find_best(new);
        if product == 0.0 && part.is_some() {
            // Too unlikely for machine numbers.
            self.nodes.sets.truncate(new);
            return;
        }
        let count = self.free.len();
        let chosen = self.trial.best[row * count..(row + 1) * count].iter().map(|(_, option)| *option);
        self.nodes.chosen.extend(chosen);
        let mut state = self.template.clone();
        for (at, &component) in self.free.iter().enumerate() {
            state.0[component] = self.options[at][self.nodes.chosen[new + at] as usize];
        }
        let start = self.nodes.split.len();
        if let Some(conflict) = self.conflict(new, &state, likelihoods) {
            let components = self.known[conflict].iter().map(|(component, _)| *component);
            self.nodes
                .split
                .extend(components.filter(|&at| self.nodes.sets[new + at as usize].count_ones() > 1));
        } else {
            let mut value: f64 = (0..self.prior.len())
                .map(|row| {
                    let table = &self.table[row * self.width..(row + 1) * self.width];
                    let chosen = &self.nodes.chosen[new..new + count];
                    chosen.iter().zip(&self.starts).fold(self.prior[row], |product, (option, start)| {
                        product * table[start + *option as usize]
                    })
                })
                .sum();
            for &at in &self.joint {
                let divisor = likelihoods.divisor(at, &state.0);
                value /= divisor.to_f64().unwrap_or(f64::MAX).max(1.0);
            }
            if value > 0.0 {
                found.push((value, state));
            }
            let several = |at: &u32| self.nodes.sets[new + *at as usize].count_ones() > 1;
            self.nodes.split.extend((0..count as u32).filter(several));
        }
        let end = self.nodes.split.len();
        self.nodes.ends.push((start as u32, end as u32));
        self.divide(new, start..end);
    }

    /// Works out the best entries of the node whose sets start at `new`; answers the largest product and its prior state.
    fn find_best(&mut self, new: usize) -> (f64, usize) {
        let sets = &self.nodes.sets[new..];
        self.trial.best.clear();
        self.trial.best.resize(self.prior.len() * sets.len(), (0.0, 0));
        self.trial.products.clear();
        let mut best = (0.0, 0);
        for row in 0..self.prior.len() {
            let table = &self.table[row * self.width..(row + 1) * self.width];
            let mut product = self.prior[row];
            let entries = self.trial.best[row * sets.len()..].iter_mut();
            for ((entry, &set), &start) in entries.zip(sets).zip(&self.starts) {
                *entry = best_of(&table[start..], set);
                product *= entry.0;
                if product == 0.0 {
                    break;
                }
            }
            self.trial.products.push(product);
            if product > best.0 {
                best = (product, row);
            }
        }
        best
    }

    /// Queues the parts of a node that are left when the chosen state, or the conflict in it, is taken out.
    fn divide(&mut self, new: usize, split: std::ops::Range<usize>) {
        let count = self.free.len();
        let Trial { best, products, is_split, suffix, bounds } = &mut self.trial;
        let split = &self.nodes.split[split];
        is_split.clear();
        is_split.resize(count, false);
        for &at in split {
            is_split[at as usize] = true;
        }
        bounds.clear();
        bounds.resize(split.len(), 0.0);
        suffix.clear();
        suffix.resize(split.len() + 1, 1.0);
        for (row, &product) in products.iter().enumerate() {
            if product == 0.0 {
                continue;
            }
            let table = &self.table[row * self.width..(row + 1) * self.width];
            let best = &best[row * count..(row + 1) * count];
            let mut fixed = self.prior[row];
            for ((value, _), _) in best.iter().zip(&*is_split).filter(|(_, is_split)| !**is_split) {
                fixed *= value;
            }
            for (place, &at) in split.iter().enumerate().rev() {
                suffix[place] = suffix[place + 1] * best[at as usize].0;
            }
            for (place, &at) in split.iter().enumerate() {
                let at = at as usize;
                let chosen = self.nodes.chosen[new + at];
                let others = self.nodes.sets[new + at] & !(1 << chosen);
                bounds[place] += fixed * best_of(&table[self.starts[at]..], others).0 * suffix[place + 1];
                fixed *= table[self.starts[at] + chosen as usize];
            }
        }
        let parent = self.nodes.ends.len() as u32 - 1;
        for place in 0..self.trial.bounds.len() {
            self.push(self.trial.bounds[place], Some((parent, place as u32)));
        }
    }

    /// Why the state is impossible, if it is: which of the known sets of modes that cannot be together it holds.
    fn conflict(&mut self, new: usize, state: &State, likelihoods: &mut Likelihoods<'_>) -> Option<usize> {
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
            let island = &self.model.islands[at];
            let Some(assumed) = likelihoods.conflict(at, &state.0) else { continue };
            let involved = island.components.iter().zip(&assumed.modes).filter(|(_, mode)| mode.is_some());
            let conflict = involved.filter_map(|(component, _)| {
                let at = self.free.binary_search(&(component.0 as usize)).ok()?;
                Some((at as u32, chosen[at]))
            });
            self.statistics.conflicts += 1;
            self.known.push(conflict.collect());
            return Some(self.known.len() - 1);
        }
        None
    }
}

/// The largest of a component's entries among the options in `set`, and which it is; zero for an empty set.
fn best_of(entries: &[f64], mut set: u64) -> (f64, u8) {
    let mut best = (0.0, set.trailing_zeros().min(63) as u8);
    while set != 0 {
        let option = set.trailing_zeros();
        set &= set - 1;
        let value = entries[option as usize];
        if value > best.0 {
            best = (value, option as u8);
        }
    }
    best
}
