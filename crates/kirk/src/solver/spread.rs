//! A first guess at alternatives that are equally short: those whose states and resources have the least to do so far, so
//! that work is spread over equal vehicles instead of piled on the first one (greedy list scheduling: Graham 1966).

use std::collections::BTreeMap;

use tpn::{Choice, DecisionId, VariableId};
use typed_index_collections::TiVec;

use super::Solver;
use super::encode::Problem;
use crate::demands::ModelSupply;
use crate::model::{Context, Model};

/// What does one thing at a time, or only so many.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Pool {
    State(VariableId),
    Resource(usize),
}

/// For how long something occupies each pool at least, in ticks; shares of a resource count in proportion.
type Work = BTreeMap<Pool, i64>;

/// The work of each alternative, with that of what is nested in it.
struct Works {
    always: Work,
    by_alternative: TiVec<DecisionId, Vec<Work>>,
}

impl Problem<'_> {
    /// Tries first the alternatives that can be over first, such as leaving out what is optional: they are the likeliest to
    /// fit where there is little time. Of several such, the one that leaves the busiest pool that it needs with the least
    /// work.
    pub(crate) fn prefer_short(&self, solver: &mut Solver) {
        self.spread(solver, |_| true);
    }

    /// The same of choices that take equally long whatever is chosen.
    pub(crate) fn prefer_spread(&self, solver: &mut Solver) {
        self.spread(solver, |(shortest, all)| shortest == all);
    }

    /// Of choices that count by how many of their alternatives are the shortest.
    fn spread(&self, solver: &mut Solver, counts: impl Fn((usize, usize)) -> bool) {
        let Some(structure) = &self.model.structure else { return };
        let Works { always: mut taken, by_alternative } = Works::new(self.model);
        for decision in self.model.decisions.keys() {
            let works = &by_alternative[decision];
            let busiest = |alternative: u32| {
                let work = works[alternative as usize].iter();
                work.map(|(pool, &work)| taken.get(pool).copied().unwrap_or(0).saturating_add(work)).max()
            };
            let shortest = structure.shortest(decision);
            if !counts((shortest.len(), works.len())) {
                continue;
            }
            let Some(alternative) = shortest.into_iter().min_by_key(|&it| (busiest(it), it)) else {
                continue;
            };
            self.prefer_option(solver, decision, alternative as usize);
            for (&pool, &work) in &works[alternative as usize] {
                let taken = taken.entry(pool).or_default();
                *taken = taken.saturating_add(work);
            }
        }
    }
}

impl Works {
    fn new(model: &Model) -> Self {
        let none = |count: usize| vec![Work::new(); count];
        let by_alternative = model.decisions.iter().map(|decision| none(decision.alternatives.len()));
        let mut works = Self { always: Work::new(), by_alternative: by_alternative.collect() };
        for label in &model.conditions.labels {
            let arc = &model.arcs[label.arc];
            works.add(model, arc.context, Pool::State(label.variable), arc.lower);
        }
        for (index, resource) in model.demands.resources.iter().enumerate() {
            let ModelSupply::Reusable { capacity } = resource.supply else { continue };
            for used in resource.uses.iter().filter(|used| used.level.is_none()) {
                let arc = &model.arcs[used.arc];
                let share = i128::from(arc.lower) * i128::from(used.amount) / i128::from(capacity.max(1));
                let share = i64::try_from(share).unwrap_or(i64::MAX);
                works.add(model, arc.context, Pool::Resource(index), share);
            }
        }
        works
    }

    fn add(&mut self, model: &Model, context: Context, pool: Pool, work: i64) {
        if work <= 0 {
            return;
        }
        let outer = |choice: &Choice| model.decisions[choice.decision].context;
        let add_to = |works: &mut Work| {
            let sum = works.entry(pool).or_default();
            *sum = sum.saturating_add(work);
        };
        if context.is_none() {
            add_to(&mut self.always);
        }
        for choice in std::iter::successors(context, outer) {
            add_to(&mut self.by_alternative[choice.decision][choice.alternative as usize]);
        }
    }
}
