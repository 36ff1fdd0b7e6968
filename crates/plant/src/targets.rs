//! Everything that a component may do in a step, with its probability.

use crate::belief::State;
use crate::model::{Commands, ComponentId, Model};
use crate::successor::{EstimateError, distribution, successor};

/// A mode that a component may enter in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    pub mode: u8,
    /// Its probability, in parts of what all targets of the component in this step sum to.
    pub weight: u64,
    /// Whether only a fault leads to it.
    pub is_fault: bool,
}

/// The modes that a component may enter from a state under commands, the nominal one first.
pub fn targets(
    model: &Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
) -> Result<Vec<Target>, EstimateError> {
    let nominal = successor(model, component, state, commands)?;
    let (weights, _) = distribution(model, component, state, commands)?;
    let target = |(mode, weight): (u8, u64)| Target { mode, weight, is_fault: mode != nominal };
    let mut targets: Vec<Target> = weights.into_iter().map(target).collect();
    targets.sort_by_key(|target| (target.mode != nominal, target.mode));
    Ok(targets)
}
