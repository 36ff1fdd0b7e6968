//! What resources leave room for in all, priced: a goal's sum with as much of their limits as makes its least value greatest
//! (Lagrangian relaxation, Geoffrion 1974; the prices are those of the linear relaxation).
//!
//! A resource gives rows, sums of choices that are never more than a limit: all that is consumed and produced, and of
//! activities that share a capacity the work between two times. Any multiple of such rows added to a goal that has to be
//! below a limit gives a sum that has to be, too; with the right multiples its least value alone often is not, or would
//! not be with one choice more.

use std::collections::{BTreeMap, BTreeSet};

use num_integer::Integer as _;
use rmpl::program::Change;

use super::interval::Interval;
use super::literal::{Literal, Variable};
use super::resources::Task;
use super::simplex::{self, Optimum};
use super::trail::Trail;
use crate::demands::ModelSupply;

/// `Σ weight · value ≤ most`, of Booleans.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) terms: BTreeMap<Variable, i64>,
    pub(super) most: i64,
}

/// Rows with their prices, and what of everything would be best if it could be taken in parts.
#[derive(Clone, Debug, Default)]
pub(super) struct Relaxation {
    pub(super) rows: Vec<(i64, Row)>,
    pub(super) taken: BTreeMap<Variable, f64>,
}

/// Prices are told in so many parts of a goal's unit.
pub(super) const SCALE: i64 = 1 << 16;
/// Greater weights are not multiplied.
const MAX_WEIGHT: i64 = 1 << 40;
/// Times that are looked at as starts, and as ends, of what is shared.
const MAX_TIMES: usize = 64;
/// Rows are looked for so many times, so many of each resource.
const ROUNDS: usize = 12;
const ROWS_PER_ROUND: usize = 3;
/// Of more choices nothing is said.
const MAX_COLUMNS: usize = 2_000;

/// The rows that bound the sum of `terms` from below, with their prices.
pub(super) fn relax(
    trail: &Trail,
    terms: &[(i64, Variable)],
    supplies: &[(ModelSupply, Vec<Task>)],
    turns: &[Vec<Interval>],
) -> Relaxation {
    let of_resources = supplies.iter().filter_map(|(supply, tasks)| Share::new(trail, *supply, tasks));
    let of_states = turns.iter().map(|turns| Share::taking_turns(trail, turns));
    let shares: Vec<Share> = of_resources.chain(of_states).collect();
    let mut rows: Vec<Row> = supplies
        .iter()
        .flat_map(|(supply, tasks)| amounts(trail, *supply, tasks).into_iter().flatten())
        .collect();
    let gains: BTreeMap<Variable, i64> = terms
        .iter()
        .filter(|&&(weight, variable)| weight != 0 && is_open(trail, variable))
        .map(|&(weight, variable)| (variable, -weight))
        .collect();
    let shared = shares.iter().flat_map(|share| share.works.iter().filter_map(|work| work.variable));
    let columns: BTreeSet<Variable> = rows
        .iter()
        .flat_map(|row| row.terms.keys().copied())
        .chain(shared)
        .chain(gains.keys().copied())
        .collect();
    let is_told = gains.values().any(|&gain| gain > 0) && gains.values().all(|gain| gain.abs() < MAX_WEIGHT);
    if !is_told || columns.len() > MAX_COLUMNS {
        return Relaxation::default();
    }
    let columns: Vec<Variable> = columns.into_iter().collect();
    let column_gains: Vec<f64> =
        columns.iter().map(|variable| gains.get(variable).map_or(0.0, |&gain| gain as f64)).collect();
    let mut optimum = Optimum { values: Vec::new(), prices: Vec::new() };
    for _ in 0..ROUNDS {
        let dense: Vec<(Vec<f64>, f64)> = rows.iter().map(|row| row.dense(&columns)).collect();
        optimum = simplex::maximize(&column_gains, &dense);
        let taken: BTreeMap<Variable, f64> =
            columns.iter().copied().zip(optimum.values.iter().copied()).collect();
        let before = rows.len();
        for row in shares.iter().flat_map(|share| share.broken(&taken)) {
            if !rows.contains(&row) {
                rows.push(row);
            }
        }
        if rows.len() == before {
            break;
        }
    }
    let price = |price: &f64| (price * SCALE as f64).round() as i64;
    let rows = rows.into_iter().zip(&optimum.prices).map(|(row, found)| (price(found), row));
    Relaxation {
        rows: rows.filter(|&(price, _)| price > 0 && price < MAX_WEIGHT).collect(),
        taken: columns.into_iter().zip(optimum.values).collect(),
    }
}

/// Returns whether a variable is a Boolean that nothing has decided.
fn is_open(trail: &Trail, variable: Variable) -> bool {
    (trail.least(variable), trail.most(variable)) == (0, 1)
}

impl Row {
    /// The row of what exists by these literals; nothing of it is told where it is negative with nothing taken.
    fn new(trail: &Trail, parts: impl IntoIterator<Item = (Literal, i64)>, most: i64) -> Option<Self> {
        let mut row = Self { terms: BTreeMap::new(), most };
        for (presence, weight) in parts {
            match open_variable(trail, presence) {
                Some(variable) => *row.terms.entry(variable).or_default() += weight,
                None if trail.holds(presence) => row.most = row.most.checked_sub(weight)?,
                None => {}
            }
        }
        row.terms.retain(|_, weight| *weight != 0);
        let sum: i128 = row.terms.values().map(|&weight| i128::from(weight.max(0))).sum();
        (row.most >= 0 && sum > i128::from(row.most)).then_some(row)
    }

    /// The same divided by what all its weights have in common.
    fn rounded(self) -> Self {
        let common = self.terms.values().fold(0, |common, &weight| weight.unsigned_abs().gcd(&common));
        match i64::try_from(common) {
            Ok(common) if common > 1 => Self {
                terms: self.terms.into_iter().map(|(variable, weight)| (variable, weight / common)).collect(),
                most: self.most.div_euclid(common),
            },
            _ => self,
        }
    }

    fn dense(&self, columns: &[Variable]) -> (Vec<f64>, f64) {
        let weight = |variable: &Variable| self.terms.get(variable).map_or(0.0, |&weight| weight as f64);
        (columns.iter().map(weight).collect(), self.most as f64)
    }
}

/// The Boolean that an open literal is.
fn open_variable(trail: &Trail, literal: Literal) -> Option<Variable> {
    let variable = literal.side.variable();
    (literal == variable.holds() && is_open(trail, variable)).then_some(variable)
}

/// Returns what a reservoir can give, and take, in all.
pub(super) fn amounts(trail: &Trail, supply: ModelSupply, tasks: &[Task]) -> [Option<Row>; 2] {
    let ModelSupply::Reservoir { least, greatest, level } = supply else { return [None, None] };
    // What is not active only gives.
    let parts = |taking: Change| {
        tasks.iter().filter_map(move |task| {
            let is_taking = task.change == taking;
            let amount = if is_taking { task.amount } else { -task.at_least };
            (task.is_active || !is_taking).then_some((task.interval.presence, amount))
        })
    };
    let used = level.checked_sub(least).and_then(|most| Row::new(trail, parts(Change::Consumes), most));
    let filled = greatest.checked_sub(level).and_then(|most| Row::new(trail, parts(Change::Produces), most));
    [used, filled]
}

/// A capacity, and the work that it is taken for.
pub(super) struct Share {
    pub(super) capacity: i64,
    pub(super) works: Vec<Work>,
}

/// Work that is done at some time between two.
pub(super) struct Work {
    /// `None` if it is done for sure.
    pub(super) variable: Option<Variable>,
    earliest_start: i64,
    latest_end: i64,
    pub(super) duration: i64,
    pub(super) amount: i64,
}

impl Work {
    /// `None` if it takes no time, or is not done.
    fn new(trail: &Trail, interval: Interval, amount: i64) -> Option<Self> {
        let variable = open_variable(trail, interval.presence);
        let is_there = variable.is_some() || trail.holds(interval.presence);
        (is_there && interval.duration > 0).then(|| Self {
            variable,
            earliest_start: trail.least(interval.start),
            latest_end: trail.most(interval.end),
            duration: interval.duration,
            amount,
        })
    }

    /// Returns how long it takes at least between two times.
    fn min_within(&self, from: i64, to: i64) -> i64 {
        let begun = self.earliest_start + self.duration - from;
        let ended = to - (self.latest_end - self.duration);
        self.duration.min(to - from).min(begun).min(ended).max(0)
    }
}

impl Share {
    pub(super) fn new(trail: &Trail, supply: ModelSupply, tasks: &[Task]) -> Option<Self> {
        let ModelSupply::Reusable { capacity } = supply else { return None };
        let active = tasks.iter().filter(|task| task.is_active);
        let works = active.filter_map(|task| Work::new(trail, task.interval, task.amount));
        Some(Self { capacity, works: works.collect() })
    }

    /// Returns what takes turns shares one place.
    pub(super) fn taking_turns(trail: &Trail, turns: &[Interval]) -> Self {
        let works = turns.iter().filter_map(|&interval| Work::new(trail, interval, 1));
        Self { capacity: 1, works: works.collect() }
    }

    /// The times between which more work would be done than there is room for, the worst first, as rows.
    fn broken(&self, taken: &BTreeMap<Variable, f64>) -> Vec<Row> {
        let share_of =
            |work: &Work| work.variable.map_or(1.0, |variable| taken.get(&variable).copied().unwrap_or(0.0));
        let mut found: Vec<(f64, i64, i64)> = Vec::new();
        let ends = some_of(self.works.iter().map(|work| work.latest_end));
        for from in some_of(self.works.iter().map(|work| work.earliest_start)) {
            for &to in ends.iter().filter(|&&to| to > from) {
                let work =
                    |work: &Work| (work.min_within(from, to) as f64) * work.amount as f64 * share_of(work);
                let room = self.capacity as f64 * (to - from) as f64;
                let excess = self.works.iter().map(work).sum::<f64>() / room;
                if excess > 1.0 + 1e-6 {
                    found.push((excess, from, to));
                }
            }
        }
        found.sort_by(|one, other| other.0.total_cmp(&one.0).then((one.1, one.2).cmp(&(other.1, other.2))));
        let rows = found.into_iter().take(ROWS_PER_ROUND);
        rows.filter_map(|(_, from, to)| self.row(from, to)).collect()
    }

    /// The work between two times, and how much there is room for; nothing if that does not fit.
    pub(super) fn row(&self, from: i64, to: i64) -> Option<Row> {
        let mut row = Row { terms: BTreeMap::new(), most: self.capacity.checked_mul(to - from)? };
        for work in &self.works {
            let taken = work.min_within(from, to).checked_mul(work.amount)?;
            match work.variable {
                Some(variable) if taken > 0 => *row.terms.entry(variable).or_default() += taken,
                Some(_) => {}
                None => row.most = row.most.checked_sub(taken)?,
            }
        }
        (row.most >= 0).then(|| row.rounded())
    }
}

/// Different times in order, some of them if there are too many.
fn some_of(times: impl Iterator<Item = i64>) -> Vec<i64> {
    let times: Vec<i64> = times.collect::<BTreeSet<i64>>().into_iter().collect();
    let step = times.len().div_ceil(MAX_TIMES).max(1);
    let last = times.last().copied();
    let mut some: Vec<i64> = times.into_iter().step_by(step).collect();
    some.extend(last);
    some.dedup();
    some
}
