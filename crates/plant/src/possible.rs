//! All possible results of a step: the modes that components may enter, and the observations that may be made then.

use std::collections::BTreeSet;

use crate::belief::State;
use crate::island::Island;
use crate::model::{Commands, ComponentId, Model, Observation};
use crate::simulate::{observation_of, shown_values};
use crate::successor::{EstimateError, distribution, intended, successor};

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
    let intended = intended(model, component, state, commands)?;
    let (weights, _) = distribution(model, component, state, commands)?;
    let target = |(mode, weight): (u8, u64)| Target { mode, weight, is_fault: !intended.contains(mode) };
    let mut targets: Vec<Target> = weights.into_iter().map(target).collect();
    targets.sort_by_key(|target| (target.mode != nominal, target.mode));
    Ok(targets)
}

/// The observations that sensors without errors may make in a state, all equally likely; the first one is made without
/// chance. Only variables in the islands of `components` vary. `None` if there are more than `most`.
pub fn observations(
    model: &Model,
    state: &State,
    components: &BTreeSet<ComponentId>,
    most: usize,
) -> Option<Vec<Observation>> {
    let shown = observation_of(model, state);
    let mut all = vec![shown.clone()];
    let is_of = |island: &&Island| island.components.iter().any(|id| components.contains(id));
    for island in model.islands.iter().filter(is_of) {
        let open = shown_values(model, island, state, most / all.len().max(1))?;
        all = all
            .into_iter()
            .flat_map(|observation| {
                open.iter().map(move |values| {
                    let mut observation = observation.clone();
                    observation.0.extend(values.iter().copied());
                    observation
                })
            })
            .collect();
    }
    all.sort_by_key(|observation| *observation != shown);
    Some(all)
}
