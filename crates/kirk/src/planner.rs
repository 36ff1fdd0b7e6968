//! Planning again and again while bounds change: what does not depend on them is kept.

use std::collections::BTreeMap;

use exact::{Bound, Time};
use tpn::{ArcId, Network, Plan};

use crate::model::Model;
use crate::options::{Options, Outcome, Search, Termination};
use crate::search::Choices;
use crate::unplannable::Unplannable;
use crate::{answer, demanding};

/// Plans one network repeatedly.
///
/// A conflict-directed search keeps what the last plan chose as long as that still is a plan, so that a small change
/// changes little: it may be another plan than [`crate::plan`] finds. A chronological search answers as [`crate::plan`]
/// does, whatever was asked before: while no bound is wider than when the network was last searched, all that failed then
/// still fails, and the choices of the plan found then need only be checked. Where that does not hold, or where gaps alone
/// made something fail, the network is searched again.
#[derive(Clone, Debug)]
pub struct Planner {
    network: Network,
    threat_gap: Option<Time>,
    /// The network prepared, if times fit.
    model: Result<Model, Unplannable>,
    last: Option<Searched>,
}

/// What the last search proved.
#[derive(Clone, Debug)]
struct Searched {
    search: Search,
    /// What the first plan chose.
    choices: Choices,
    /// Times that fitted the plan found last, by node; empty before.
    schedule: Vec<i64>,
    /// The bounds it was searched with, where they are others now.
    changed: BTreeMap<ArcId, (i64, i64)>,
}

impl Searched {
    /// Whether all bounds are within those that were searched with.
    fn covers(&self, model: &Model) -> bool {
        self.changed.iter().all(|(&arc, &(lower, upper))| {
            let now = &model.arcs[arc];
            now.lower >= lower && now.upper <= upper
        })
    }
}

impl Planner {
    /// Prepares `network`.
    pub fn new(network: Network, threat_gap: Option<Time>) -> Self {
        let model = Model::new(&network, threat_gap);
        Self { network, threat_gap, model, last: None }
    }

    /// The network as it is now.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Changes the bounds of an arc. Cheap if the new ones are whole numbers of the network's common unit; otherwise
    /// the network is prepared again. Unknown arcs are ignored.
    pub fn set_bounds(&mut self, arc: ArcId, lower: Time, upper: Bound) {
        let Some(changed) = self.network.arcs.get_mut(arc.index()) else { return };
        let is_structural = crate::wording::is_structural(changed.kind);
        (changed.lower, changed.upper) = (lower, upper);
        let is_kept = !is_structural && self.keep_model(arc, lower, upper).is_ok_and(|is_kept| is_kept);
        if !is_kept {
            self.model = Model::new(&self.network, self.threat_gap);
            self.last = None;
        }
    }

    /// Plans the network as it is now. `options.threat_gap` is that of the planner.
    pub fn plan(&mut self, options: &Options, termination: &mut dyn Termination) -> Outcome {
        let model = match &self.model {
            Ok(model) => model,
            Err(overflow) => return Outcome::of_size(*overflow),
        };
        let is_repeatable = !options.all && options.trace_events.is_none();
        if is_repeatable
            && let Some(last) = &mut self.last
            && last.search == options.search
            && (options.search.learns() || last.covers(model))
            && let Ok(Some(outcome)) =
                answer::with_choices(model, &last.choices, &mut last.schedule, termination)
        {
            return outcome;
        }
        let (outcome, has_doubts) = match answer::answer(&self.network, model, options, &[], termination) {
            Ok(answer) => answer,
            Err(overflow) => {
                self.last = None;
                return Outcome::of_size(overflow);
            }
        };
        let can_be_kept = if options.search.learns() { !demanding::has_demands(model) } else { !has_doubts };
        self.last = outcome.plans.first().filter(|_| is_repeatable && can_be_kept).map(|plan| {
            let choices = choices_of(model, plan, options.search);
            let schedule = choices.times.clone();
            Searched { search: options.search, choices, schedule, changed: BTreeMap::new() }
        });
        outcome
    }

    /// Changes the prepared network in place, if it can be.
    fn keep_model(&mut self, arc: ArcId, lower: Time, upper: Bound) -> Result<bool, Unplannable> {
        let Ok(model) = &mut self.model else { return Ok(false) };
        let (Ok(lower), Ok(upper)) = (model.units(lower), model.bound_units(upper)) else { return Ok(false) };
        if lower < 0 {
            return Ok(false);
        }
        if let Some(last) = &mut self.last {
            let before = &model.arcs[arc];
            last.changed.entry(arc).or_insert((before.lower, before.upper));
        }
        model.set_bounds(&self.network, arc, lower, upper);
        let Some(mut structure) = model.structure.take() else { return Ok(true) };
        let is_kept = structure.set_arc(model, arc)?;
        model.structure = Some(structure);
        Ok(is_kept)
    }
}

/// What a plan chose. A search that tries orders in their textual order is not told how the plan orders them.
fn choices_of(model: &Model, plan: &Plan, search: Search) -> Choices {
    let mut choices = Choices {
        alternatives: vec![None; model.decisions.len()].into(),
        carriers: vec![None; model.conditions.labels.len()].into(),
        times: Vec::new(),
    };
    for choice in &plan.choices {
        choices.alternatives[choice.decision] = Some(choice.alternative);
    }
    for link in &plan.causal_links {
        choices.carriers[link.ask] = Some(link.tell);
    }
    if search.learns() {
        let earliest =
            plan.windows.iter().map(|window| window.as_ref().map_or(Time::ZERO, |window| window.earliest));
        let times: Result<Vec<i64>, _> = earliest.map(|time| model.units(time)).collect();
        choices.times = times.unwrap_or_default();
    }
    choices
}
