//! The estimator: belief updates and the commands that follow, remembered so that many runs share them.

use std::collections::BTreeMap;
use std::sync::Arc;

use plant::{
    Belief, Commands, Conflict, EstimateError, Goal, Model, NextCommands, Observation, Planner, State,
    conflicts, update_best, update_exact,
};

/// How the belief is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimation {
    /// All possible states.
    Exact,
    /// This many of the most likely states.
    Best(usize),
}

impl Estimation {
    /// Exact where there are few states, otherwise the 64 most likely.
    pub fn for_model(model: &Model) -> Self {
        let states = model.components.iter().try_fold(1_usize, |product, component| {
            product.checked_mul(component.modes.len()).filter(|product| *product <= 4096)
        });
        if states.is_some() { Self::Exact } else { Self::Best(64) }
    }
}

/// The search for likely states gives up after this many nodes.
const MAX_NODES: u32 = 50_000;
/// Remembered updates are thrown away when there are more than this many.
const MAX_REMEMBERED: usize = 20_000;
/// A diagnosis names at most this many conflicts.
const MAX_CONFLICTS: usize = 8;

/// A belief after a step, and what it took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct BeliefUpdate {
    pub(super) belief: Belief,
    /// Whether nothing that was believed possible explains the observation, which was then left out of account.
    pub(super) is_unexplained: bool,
    pub(super) conflicts: Vec<Conflict>,
}

/// Estimates and plans for one model.
#[derive(Clone, Debug)]
pub struct Estimator {
    planner: Arc<Planner>,
    estimation: Estimation,
    updates: BTreeMap<(Belief, Commands, Observation), BeliefUpdate>,
    plans: BTreeMap<(State, Vec<Goal>), NextCommands>,
}

impl Estimator {
    /// Remembers nothing yet; the planner has the model.
    pub fn new(planner: Arc<Planner>, estimation: Estimation) -> Self {
        Self { planner, estimation, updates: BTreeMap::new(), plans: BTreeMap::new() }
    }

    /// The reactive planner.
    pub const fn planner(&self) -> &Arc<Planner> {
        &self.planner
    }

    pub(super) fn estimate(
        &mut self,
        belief: &Belief,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<BeliefUpdate, EstimateError> {
        let key = (belief.clone(), commands.clone(), observation.clone());
        if let Some(known) = self.updates.get(&key) {
            return Ok(known.clone());
        }
        let (updated, is_unexplained) = match self.update(belief, commands, observation) {
            Err(EstimateError::Unexplained) => {
                (self.update(belief, commands, &Observation::default())?, true)
            }
            updated => (updated?, false),
        };
        let conflicts =
            conflicts(self.planner.model(), belief.most_likely(), commands, observation, MAX_CONFLICTS)?;
        let update = BeliefUpdate { belief: updated, is_unexplained, conflicts };
        if self.updates.len() >= MAX_REMEMBERED {
            self.updates.clear();
        }
        self.updates.insert(key, update.clone());
        Ok(update)
    }

    fn update(
        &self,
        belief: &Belief,
        commands: &Commands,
        observation: &Observation,
    ) -> Result<Belief, EstimateError> {
        match self.estimation {
            Estimation::Exact => update_exact(self.planner.model(), belief, commands, observation),
            Estimation::Best(most) => {
                update_best(self.planner.model(), belief, commands, observation, most, MAX_NODES)
                    .map(|(belief, _)| belief)
            }
        }
    }

    pub(super) fn plan(&mut self, state: &State, goals: &[Goal]) -> NextCommands {
        let key = (state.clone(), goals.to_vec());
        if let Some(known) = self.plans.get(&key) {
            return known.clone();
        }
        let next = self.planner.next_commands(state, goals);
        if self.plans.len() >= MAX_REMEMBERED {
            self.plans.clear();
        }
        self.plans.insert(key, next.clone());
        next
    }
}
