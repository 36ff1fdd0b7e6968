//! Planning again and again while bounds change: what does not depend on them is kept.

use exact::{Bound, Time};
use tpn::{ArcId, Network, Plan};

use crate::choices::Choices;
use crate::model::Model;
use crate::options::{Options, Outcome, Termination};
use crate::unplannable::Unplannable;
use crate::{answer, solver_search};

/// Plans one network repeatedly.
///
/// A conflict-directed search keeps what the last plan chose as long as that still is a plan, so that a small change
/// changes little: it may be another plan than [`crate::plan`] finds. A chronological search answers as [`crate::plan`]
/// does, whatever was asked before.
#[derive(Clone, Debug)]
pub struct Planner {
    network: Network,
    threat_gap: Option<Time>,
    /// The network prepared, if times fit.
    model: Result<Model, Unplannable>,
    /// What the last plan chose, where the next one is to choose the same.
    last: Option<Choices>,
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
        let is_repeatable = !options.all && options.best <= 1 && options.trace_events.is_none();
        let is_kept = is_repeatable && options.search.learns() && !solver_search::has_demands(model);
        if is_kept
            && let Some(last) = &self.last
            && let Ok(Some(outcome)) = solver_search::keep(&self.network, model, last, termination)
        {
            return outcome;
        }
        let outcome = match answer::answer(&self.network, model, options, &[], termination) {
            Ok(outcome) => outcome,
            Err(overflow) => {
                self.last = None;
                return Outcome::of_size(overflow);
            }
        };
        self.last = outcome.plans.first().filter(|_| is_kept).map(|plan| choices_of(model, plan));
        outcome
    }

    /// Changes the prepared network in place, if it can be.
    fn keep_model(&mut self, arc: ArcId, lower: Time, upper: Bound) -> Result<bool, Unplannable> {
        let Ok(model) = &mut self.model else { return Ok(false) };
        let (Ok(lower), Ok(upper)) = (model.units(lower), model.bound_units(upper)) else { return Ok(false) };
        if lower < 0 {
            return Ok(false);
        }
        model.set_bounds(&self.network, arc, lower, upper);
        let Some(mut structure) = model.structure.take() else { return Ok(true) };
        let is_kept = structure.set_arc(model, arc)?;
        model.structure = Some(structure);
        Ok(is_kept)
    }
}

/// Returns what a plan chose.
fn choices_of(model: &Model, plan: &Plan) -> Choices {
    let mut choices = Choices {
        alternatives: vec![None; model.decisions.len()].into(),
        carriers: vec![None; model.conditions.labels.len()].into(),
        times: (plan.windows.iter())
            .map(|window| window.as_ref().map_or(Ok(0), |window| model.units(window.earliest)))
            .collect::<Result<_, _>>()
            .unwrap_or_default(),
    };
    for choice in &plan.choices {
        choices.alternatives[choice.decision] = Some(choice.alternative);
    }
    for link in &plan.causal_links {
        choices.carriers[link.ask] = Some(link.tell);
    }
    choices
}
