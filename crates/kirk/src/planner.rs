//! Planning again and again while bounds change: what does not depend on them is kept.

use rmpl::{Bound, Rational};
use stn::Overflow;
use tpn::{ArcId, Network};

use crate::model::Model;
use crate::options::{Options, Outcome, Termination};

/// Plans one network repeatedly. Answers are those of [`crate::plan`] on the changed network.
#[derive(Clone, Debug)]
pub struct Planner {
    network: Network,
    threat_gap: Option<Rational>,
    /// `None` where times do not fit.
    model: Option<Model>,
}

impl Planner {
    /// Prepares `network`.
    pub fn new(network: Network, threat_gap: Option<Rational>) -> Self {
        let model = Model::new(&network, threat_gap).ok();
        Self { network, threat_gap, model }
    }

    /// The network as it is now.
    pub fn network(&self) -> &Network {
        &self.network
    }

    /// Changes the bounds of an arc. Cheap if the new ones are whole numbers of the network's common unit; otherwise
    /// the network is prepared anew. Unknown arcs are ignored.
    pub fn set_bounds(&mut self, arc: ArcId, lower: Rational, upper: Bound) {
        let Some(changed) = self.network.arcs.get_mut(arc.index()) else { return };
        let is_structural = crate::wording::is_structural(changed.kind);
        (changed.lower, changed.upper) = (lower, upper);
        let is_kept = !is_structural && self.keep_model(arc, lower, upper).is_ok_and(|is_kept| is_kept);
        if !is_kept {
            self.model = Model::new(&self.network, self.threat_gap).ok();
        }
    }

    /// Plans the network as it is now. `options.threat_gap` is that of the planner.
    pub fn plan(&mut self, options: &Options, termination: &mut dyn Termination) -> Outcome {
        let answer = match &self.model {
            Some(model) => crate::answer(&self.network, model, options, termination),
            None => Err(Overflow),
        };
        answer.unwrap_or_else(|Overflow| Outcome::overflow())
    }

    /// Changes the prepared network in place, if it can be.
    fn keep_model(&mut self, arc: ArcId, lower: Rational, upper: Bound) -> Result<bool, Overflow> {
        let Some(model) = &mut self.model else { return Ok(false) };
        let (lower, upper) = (model.units(lower)?, model.bound_units(upper)?);
        if lower < 0 {
            return Ok(false);
        }
        model.set_bounds(&self.network, arc.0, lower, upper);
        let Some(mut structure) = model.structure.take() else { return Ok(true) };
        let is_kept = structure.set_arc(&self.network, model, arc.0)?;
        model.structure = Some(structure);
        Ok(is_kept)
    }
}
