//! The update of a belief whose dropped measure stays known (SPEC3 17.1 and 17.2).
//!
//! The successors of each state are enumerated component by component. A set of them that measures less than a threshold is
//! dropped as a whole, and what it measures is added to ε; sets that contradict the observation measure nothing. The
//! threshold starts low where that is cheap, and is lowered, and more states are kept, until ε is small enough.

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::exact::weighed;
use crate::interval::Interval;
use crate::likelihood::Likelihoods;
use crate::merged::{Moving, move_all};
use crate::model::{Commands, Model, Observation};
use crate::normalization::Normalization;
use crate::successor::{Choices, EstimateError, distributions};

/// A belief keeps at most this many states.
pub const MAX_STATES: usize = 100_000;
/// Thresholds that are tried first, with the number of sets that each may take: the first that suffices is used.
const FIRST: [(f64, u64); 4] = [(0.0, 30_000), (1e-10, 40_000), (1e-7, 60_000), (1e-5, 100_000)];
/// The threshold with which no update takes long.
const COARSE: f64 = 1e-3;
/// Thresholds that follow while ε is too large.
const FINER: [f64; 10] = [1e-4, 3e-5, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 0.0];
/// What an update does that is to keep as much as the limits allow.
const MAX_SETS_BY_CUT: [(f64, u64); 4] =
    [(0.0, 500_000), (1e-9, 1_000_000), (1e-7, MAX_SETS), (1e-5, u64::MAX)];
/// Thresholds with which equal successors are joined as they are found, if enumeration leaves too much out.
const MERGED: [f64; 3] = [0.0, 1e-8, 1e-6];
/// How many sets an update may take at most while ε is too large.
const MAX_SETS: u64 = 2_000_000;

/// What an update came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoundedUpdate {
    /// The belief; `None` if no state that was kept explains the observation.
    pub belief: Option<Belief>,
    /// Whether something was dropped that might explain it, if no belief is left.
    pub is_open: bool,
    /// Whether limits kept ε from becoming small enough.
    pub is_uncertain: bool,
}

/// How much an update may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// As much as makes ε small enough.
    AsNeeded,
    /// All that the limits allow, as when a history is expanded again.
    Most,
}

/// The belief after `commands` and `observation`, with at most `most` states. More states are kept until `decides` holds
/// of it, too: whether it decides what is asked of it.
pub fn update_bounded(
    model: &Model,
    belief: &Belief,
    commands: &Commands,
    observation: &Observation,
    most: usize,
    effort: Effort,
    decides: &dyn Fn(&Belief) -> bool,
) -> Result<BoundedUpdate, EstimateError> {
    let prior: Vec<&State> = belief.entries().iter().map(|(state, _)| state).collect();
    let choices = distributions(model, &prior, commands)?;
    let likelihoods = Likelihoods::new(model, observation);
    let mut step = Step::new(model, belief, commands, &choices, likelihoods, most);
    let tried = match effort {
        Effort::AsNeeded => &FIRST,
        Effort::Most => &MAX_SETS_BY_CUT,
    };
    let found = tried.iter().find_map(|&(threshold, sets)| Some((threshold, step.expand(threshold, sets)?)));
    let (threshold, mut best) =
        found.unwrap_or_else(|| (COARSE, step.expand(COARSE, u64::MAX).unwrap_or_default()));
    if threshold == 0.0 || effort == Effort::AsNeeded && best.is_settled(decides) {
        return Ok(best.into_update(decides));
    }
    let mut merged = None;
    for threshold in MERGED {
        merged = step.merge(threshold)?;
        if merged.is_some() {
            break;
        }
    }
    if let Some(merged) = merged {
        if merged.share_dropped() < best.share_dropped() {
            best = merged;
        }
    } else if effort == Effort::AsNeeded {
        for &finer in FINER.iter().filter(|finer| **finer < threshold) {
            // Where as many states are kept as may be, only heavier ones could take the place of others.
            if best.is_settled(decides) || best.belief.as_ref().is_some_and(|belief| belief.len() >= most) {
                break;
            }
            let Some(expansion) = step.expand(finer, MAX_SETS) else { break };
            best = expansion;
        }
    }
    Ok(best.into_update(decides))
}

/// What the enumeration with one threshold came to.
#[derive(Default)]
struct Expansion {
    belief: Option<Belief>,
    /// ε, if no state is left.
    dropped: BigUint,
}

impl Expansion {
    fn is_settled(&self, decides: &dyn Fn(&Belief) -> bool) -> bool {
        let is_enough = |belief: &Belief| belief.is_settled() && (belief.is_exact() || decides(belief));
        self.belief.as_ref().map_or(self.dropped.is_zero(), is_enough)
    }

    /// ε as a part of all, roughly.
    fn share_dropped(&self) -> f64 {
        let Some(belief) = &self.belief else { return if self.dropped.is_zero() { 0.0 } else { 1.0 } };
        1.0 - Interval::certain(belief.kept()).to_f64().0
    }

    fn into_update(self, decides: &dyn Fn(&Belief) -> bool) -> BoundedUpdate {
        let is_uncertain = !self.is_settled(decides);
        let is_open = self.belief.is_none() && !self.dropped.is_zero();
        BoundedUpdate { belief: self.belief, is_open, is_uncertain }
    }
}

/// One update, whatever its threshold.
struct Step<'step> {
    model: &'step Model,
    belief: &'step Belief,
    commands: &'step Commands,
    choices: &'step Choices,
    likelihoods: Likelihoods<'step>,
    normalization: Normalization,
    most: usize,
    /// The components that may enter several modes from some state.
    free: Vec<usize>,
    /// Per free component the weight of all its choices, and the product of these from there on.
    denominators: Vec<u64>,
    rest: Vec<BigUint>,
    /// Per component the joint island that it is checked in, and its place there.
    places: Vec<Option<(usize, usize)>>,
    joint: Vec<(Assumed<'step>, Domains)>,
    /// The components of joint islands that go one way from each state.
    fixed: Vec<usize>,
    /// Per component, whether the modes that contradict the observation by themselves have to be looked for.
    alone: Vec<Option<usize>>,
}

/// What is known while the successors of one state are enumerated.
struct Row {
    number: usize,
    state: State,
    /// What is dropped, in the unit of the weights of successors.
    dropped: BigUint,
    found: Vec<(State, BigUint)>,
}

/// How far an enumeration may go.
struct Limits {
    threshold: f64,
    sets: u64,
}

impl<'step> Step<'step> {
    fn new(
        model: &'step Model,
        belief: &'step Belief,
        commands: &'step Commands,
        choices: &'step Choices,
        likelihoods: Likelihoods<'step>,
        most: usize,
    ) -> Self {
        let rows = belief.len();
        let count = model.components.len();
        let is_free = |component: &usize| (0..rows).any(|row| choices.of(row, *component).len() > 1);
        let free: Vec<usize> = (0..count).filter(is_free).collect();
        let weight_of = |component: &usize| choices.of(0, *component).iter().map(|(_, weight)| weight).sum();
        let denominators: Vec<u64> = free.iter().map(weight_of).collect();
        let mut rest = vec![BigUint::one(); free.len() + 1];
        for at in (0..free.len()).rev() {
            rest[at] = &rest[at + 1] * denominators[at];
        }
        let mut step = Self {
            model,
            belief,
            commands,
            choices,
            normalization: Normalization::new(model, choices, rows, true),
            most,
            denominators,
            rest,
            places: vec![None; count],
            joint: Vec::new(),
            fixed: Vec::new(),
            alone: vec![None; count],
            free,
            likelihoods,
        };
        for (at, island) in model.islands.iter().enumerate() {
            if !step.likelihoods.can_exclude(at) {
                continue;
            }
            if let [component] = island.components.as_slice() {
                step.alone[component.0 as usize] = Some(at);
                continue;
            }
            for (place, component) in island.components.iter().enumerate() {
                step.places[component.0 as usize] = Some((step.joint.len(), place));
            }
            let assumed = Assumed { model, island, modes: vec![None; island.components.len()] };
            step.joint.push((assumed, step.likelihoods.observed_domains()));
        }
        let is_fixed = |component: &usize| step.free.binary_search(component).is_err();
        step.fixed = (0..count).filter(is_fixed).filter(|at| step.places[*at].is_some()).collect();
        step
    }

    /// The belief where sets of successors that measure less than `threshold` of all are dropped; `None` if more than `sets`
    /// would have to be looked at, or too many states kept.
    fn expand(&mut self, threshold: f64, sets: u64) -> Option<Expansion> {
        let approximate = self.belief.approximate();
        let unit = &self.normalization.unit * &self.rest[0];
        let mut limits = Limits { threshold, sets };
        let mut dropped = self.belief.dropped() * &unit;
        let mut predicted: BTreeMap<State, BigUint> = BTreeMap::new();
        for (number, (state, weight)) in self.belief.entries().iter().enumerate() {
            if !self.normalization.is_known[number] {
                dropped += weight * &unit;
                continue;
            }
            if self.normalization.is_rounded {
                dropped += weight * &self.rest[0];
            }
            let factor = weight * &self.normalization.factors[number];
            if factor.is_zero() {
                continue;
            }
            let mut row = Row { number, state: state.clone(), dropped: BigUint::zero(), found: Vec::new() };
            if self.begin_row(&mut row) {
                self.visit(&mut row, 0, &BigUint::one(), approximate[number], &mut limits)?;
            }
            if !row.dropped.is_zero() {
                dropped += row.dropped * &factor;
            }
            for (state, weight) in row.found {
                *predicted.entry(state).or_insert_with(BigUint::zero) += weight * &factor;
            }
        }
        Some(self.observed(predicted.into_iter().collect(), dropped))
    }

    /// The belief where successors are joined as they are found; `None` if that is not possible, or too many are held.
    fn merge(&mut self, threshold: f64) -> Result<Option<Expansion>, EstimateError> {
        let approximate = self.belief.approximate();
        let normalization = &self.normalization;
        let mut dropped = self.belief.dropped() * &normalization.unit;
        let mut states = Vec::with_capacity(self.belief.len());
        for (number, (state, weight)) in self.belief.entries().iter().enumerate() {
            if !normalization.is_known[number] {
                dropped += weight * &normalization.unit;
                continue;
            }
            if normalization.is_rounded {
                dropped += weight;
            }
            let weight = weight * &normalization.factors[number];
            if !weight.is_zero() {
                states.push(Moving { state: state.clone(), weight, measure: approximate[number] });
            }
        }
        let moved =
            move_all(self.model, self.commands, states, threshold, &self.alone, &mut self.likelihoods)?;
        Ok(moved.map(|moved| {
            let dropped = dropped * moved.unit + moved.dropped;
            let states = moved.states.into_iter().map(|moving| (moving.state, moving.weight));
            self.observed(states.collect(), dropped)
        }))
    }

    /// Returns what is left of predicted states, and of what was dropped of them, when the observation is taken into
    /// account.
    fn observed(&mut self, predicted: Vec<(State, BigUint)>, mut dropped: BigUint) -> Expansion {
        let (weights, common) = weighed(self.model, predicted, &mut self.likelihoods);
        if !dropped.is_zero() {
            dropped = match self.likelihoods.max_of_all() {
                Some(greatest) => {
                    let weight = dropped * common * greatest.weight;
                    num_integer::Integer::div_ceil(&weight, &greatest.divisor)
                }
                None => BigUint::zero(),
            };
        }
        let is_empty = weights.is_empty();
        let left = if is_empty { dropped.clone() } else { BigUint::zero() };
        Expansion { belief: Belief::measured(weights, dropped, self.most), dropped: left }
    }

    /// Assumes what the components do that go one way; returns whether the observation leaves that possible.
    fn begin_row(&mut self, row: &mut Row) -> bool {
        for (assumed, domains) in &mut self.joint {
            domains.undo(0);
            assumed.modes.fill(None);
            assumed.begin(domains);
        }
        for component in 0..self.alone.len() {
            if let [(mode, _)] = self.choices.of(row.number, component) {
                row.state.0[component] = *mode;
            }
        }
        let fixed = &self.fixed;
        fixed.iter().all(|&component| {
            let Some((island, place)) = self.places[component] else { return true };
            let (assumed, domains) = &mut self.joint[island];
            assumed.add(place, row.state.0[component], domains).is_ok()
        })
    }

    /// Enumerates the successors that agree with a row on the free components before a place; `None` at the limit.
    fn visit(
        &mut self,
        row: &mut Row,
        at: usize,
        weight: &BigUint,
        measure: f64,
        limits: &mut Limits,
    ) -> Option<()> {
        limits.sets = limits.sets.checked_sub(1)?;
        if measure < limits.threshold {
            row.dropped += weight * &self.rest[at];
            return Some(());
        }
        let Some(&component) = self.free.get(at) else {
            row.found.push((row.state.clone(), weight.clone()));
            return Some(());
        };
        let choices = self.choices;
        for &(mode, part) in choices.of(row.number, component) {
            row.state.0[component] = mode;
            if let Some(island) = self.alone[component]
                && self.likelihoods.of(island, &row.state.0).is_zero()
            {
                continue;
            }
            let weight = weight * part;
            let measure = measure * (part as f64 / self.denominators[at] as f64);
            let Some((island, place)) = self.places[component] else {
                self.visit(row, at + 1, &weight, measure, limits)?;
                continue;
            };
            let (assumed, domains) = &mut self.joint[island];
            let point = domains.point();
            let is_possible = assumed.add(place, mode, domains).is_ok();
            if is_possible {
                self.visit(row, at + 1, &weight, measure, limits)?;
            }
            let (assumed, domains) = &mut self.joint[island];
            assumed.modes[place] = None;
            domains.return_to(&point);
        }
        Some(())
    }
}
