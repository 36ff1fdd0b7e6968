//! How likely each mode of each component is after a step, as machine numbers: they order a search and decide nothing.
//!
//! Numbers of one component and mode, one per prior state, stand side by side: a search takes products over components
//! for all prior states at once.

use crate::belief::{Belief, State};
use crate::likelihood::Likelihoods;
use crate::model::{ComponentId, Model};
use crate::successor::Choices;
use crate::value_set::ValueSet;

/// Probabilities of the modes that the free components, which may enter several, may enter.
#[derive(Default)]
pub(crate) struct Odds {
    /// The free components, in order.
    pub(crate) free: Vec<usize>,
    /// Per prior state, its probability and that of what its other components do.
    pub(crate) prior: Vec<f64>,
    /// Per free component, where its options start; one more at the end.
    starts: Vec<usize>,
    /// Per option, its mode.
    modes: Vec<u8>,
    /// Per option and prior state, its probability and, for components that share nothing, its likelihood.
    table: Vec<f64>,
    /// Per free component and prior state the same with the options, best first, of equally good ones the first.
    ranked: Vec<(f64, u8)>,
}

impl Odds {
    /// The odds after a step from `belief`, and a state in which the components that are not free are as they will be.
    pub(crate) fn new(
        model: &Model,
        belief: &Belief,
        choices: &Choices,
        likelihoods: &mut Likelihoods<'_>,
    ) -> (Self, State) {
        let (count, rows) = (model.components.len(), belief.len());
        let mut state = State(vec![0; count]);
        let mut islands = vec![None; count];
        for (at, island) in model.islands.iter().enumerate() {
            if let [component] = island.components.as_slice() {
                islands[component.0 as usize] = Some(at);
            }
        }
        let mut odds = Self {
            free: Vec::with_capacity(count),
            prior: belief.approximate(),
            starts: Vec::with_capacity(count + 1),
            modes: Vec::with_capacity(2 * count),
            ..Self::default()
        };
        let mut factors: Vec<f64> = Vec::with_capacity(2 * count);
        for (component, island) in islands.into_iter().enumerate() {
            let rows = (0..rows).filter(|row| !choices.is_repeated(*row, component));
            let entered = rows.flat_map(|row| choices.of(row, component));
            let modes: ValueSet = entered.map(|(mode, _)| *mode).collect();
            let first = odds.modes.len();
            for mode in modes.values() {
                state.0[component] = mode;
                factors.push(island.map_or(1.0, |island| likelihoods.chance(island, &state.0)));
            }
            if modes.len() > 1 {
                odds.free.push(component);
                odds.starts.push(first);
                odds.modes.extend(modes.values());
            } else {
                let factor = factors.pop().unwrap_or(0.0);
                odds.prior.iter_mut().for_each(|prior| *prior *= factor);
            }
        }
        odds.starts.push(odds.modes.len());
        odds.fill(choices, &factors);
        (odds, state)
    }

    fn fill(&mut self, choices: &Choices, factors: &[f64]) {
        let rows = self.rows();
        self.table.resize(self.modes.len() * rows, 0.0);
        self.ranked.reserve(self.table.len());
        for (at, &component) in self.free.iter().enumerate() {
            let (start, end) = (self.starts[at], self.starts[at + 1]);
            for row in 0..rows {
                let first = self.ranked.len();
                if choices.is_repeated(row, component) {
                    for option in start..end {
                        self.table[option * rows + row] = self.table[option * rows + row - 1];
                    }
                    self.ranked.extend_from_within(first - (end - start)..);
                    continue;
                }
                let entered = choices.of(row, component);
                let total = entered.iter().map(|(_, weight)| weight).sum::<u64>() as f64;
                for (mode, weight) in entered {
                    let Ok(option) = self.modes[start..end].binary_search(mode) else { continue };
                    let option = start + option;
                    self.table[option * rows + row] = *weight as f64 / total * factors[option];
                }
                self.ranked
                    .extend((start..end).map(|option| self.table[option * rows + row]).zip(0..=u8::MAX));
                self.ranked[first..].sort_by(|left, right| right.0.total_cmp(&left.0));
            }
        }
    }

    /// Returns how many prior states there are.
    pub(crate) const fn rows(&self) -> usize {
        self.prior.len()
    }

    /// Returns whether a component may enter several modes.
    pub(crate) fn is_free(&self, component: ComponentId) -> bool {
        self.free.binary_search(&(component.0 as usize)).is_ok()
    }

    /// The mode of a free component's option.
    #[inline]
    pub(crate) fn mode(&self, at: usize, option: u8) -> u8 {
        self.modes[self.starts[at] + option as usize]
    }

    /// All options of a free component.
    pub(crate) fn full_set(&self, at: usize) -> ValueSet {
        ValueSet::first_values(self.starts[at + 1] - self.starts[at])
    }

    /// By prior state, the probability of a free component's option.
    #[inline]
    pub(crate) fn entries(&self, at: usize, option: u8) -> &[f64] {
        let rows = self.rows();
        &self.table[(self.starts[at] + option as usize) * rows..][..rows]
    }

    /// By prior state, a free component's options with their probabilities, best first.
    #[inline]
    pub(crate) fn ranked(&self, at: usize) -> std::slice::ChunksExact<'_, (f64, u8)> {
        let (start, end, rows) = (self.starts[at], self.starts[at + 1], self.rows());
        self.ranked[start * rows..end * rows].chunks_exact(end - start)
    }

    /// By prior state, the probability that the free components enter these options.
    pub(crate) fn products<'odds>(&'odds self, chosen: &'odds [u8]) -> impl Iterator<Item = f64> + 'odds {
        (0..self.rows()).map(|row| {
            let options = chosen.iter().zip(&self.starts).map(|(option, start)| start + *option as usize);
            options.fold(self.prior[row], |product, option| product * self.table[option * self.rows() + row])
        })
    }
}

/// The best options within the sets of a node, kept so that the next node takes over what it has in common with it.
#[derive(Default)]
pub(crate) struct Bests {
    /// The sets for which the following holds.
    sets: Vec<ValueSet>,
    /// Per free component and prior state, the largest entry.
    values: Vec<f64>,
    /// The same, its option.
    options: Vec<u8>,
    /// Per prior state, the product of the largest entries.
    products: Vec<f64>,
}

impl Bests {
    /// Works out the best entries within `sets`; answers the largest product and its prior state.
    pub(crate) fn update(&mut self, odds: &Odds, sets: &[ValueSet]) -> (f64, usize) {
        let rows = odds.rows();
        self.sets.resize(sets.len(), ValueSet::EMPTY);
        self.values.resize(sets.len() * rows, 0.0);
        self.options.resize(sets.len() * rows, 0);
        for (at, (before, &set)) in self.sets.iter_mut().zip(sets).enumerate() {
            if *before == set {
                continue;
            }
            *before = set;
            let values = &mut self.values[at * rows..][..rows];
            let options = &mut self.options[at * rows..][..rows];
            for ((value, option), ranked) in values.iter_mut().zip(options).zip(odds.ranked(at)) {
                (*value, *option) = best_of(ranked, set);
            }
        }
        self.products.clone_from(&odds.prior);
        for values in self.values.chunks_exact(rows) {
            multiply(&mut self.products, values);
        }
        let mut best = (0.0, 0);
        for (row, &product) in self.products.iter().enumerate() {
            if product > best.0 {
                best = (product, row);
            }
        }
        best
    }

    /// By prior state, a free component's largest entry.
    #[inline]
    pub(crate) fn component(&self, at: usize, rows: usize) -> &[f64] {
        &self.values[at * rows..][..rows]
    }

    /// The same for all free components.
    pub(crate) fn components(&self, rows: usize) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(rows)
    }

    /// The best options of all free components from one prior state.
    pub(crate) fn options(&self, row: usize, rows: usize) -> impl Iterator<Item = u8> {
        self.options.iter().copied().skip(row).step_by(rows)
    }
}

/// The best of a component's ranked entries whose option is in `set`; zero for an empty set.
#[inline]
pub(crate) fn best_of(ranked: &[(f64, u8)], set: ValueSet) -> (f64, u8) {
    ranked.iter().copied().find(|(_, option)| set.contains(*option)).unwrap_or((0.0, 0))
}

/// Multiplies number by number.
#[inline]
pub(crate) fn multiply(products: &mut [f64], factors: &[f64]) {
    for (product, factor) in products.iter_mut().zip(factors) {
        *product *= factor;
    }
}
