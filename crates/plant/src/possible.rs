//! Everything that can happen in a step: the modes that components may enter, and what may be observed then.

use std::collections::BTreeSet;

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::formula::values;
use crate::island::Island;
use crate::model::{Commands, ComponentId, Model, Observation, VariableId};
use crate::simulate::observation_of;
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
    let target = |(mode, weight): (u8, u64)| Target { mode, weight, is_fault: intended >> mode & 1 == 0 };
    let mut targets: Vec<Target> = weights.into_iter().map(target).collect();
    targets.sort_by_key(|target| (target.mode != nominal, target.mode));
    Ok(targets)
}

/// What may be observed in a state by sensors without errors, all of it equally likely and what is shown without chance
/// first. Only the variables that some components have to do with vary. `None` if there is more than `most`.
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
        let open = open_values(model, island, state, &shown, most / all.len())?;
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

/// The combinations of values of an island's observable variables that its modes allow, where SHOWS does not decide.
fn open_values(
    model: &Model,
    island: &Island,
    state: &State,
    shown: &Observation,
    most: usize,
) -> Option<Vec<Vec<(VariableId, u8)>>> {
    let assumed = Assumed::all(model, island, &state.0);
    let mut domains = Domains::observed(model, &Observation::default());
    if assumed.propagate(&mut domains).is_err() {
        return Some(vec![Vec::new()]);
    }
    let mut found: Vec<(Vec<(VariableId, u8)>, Domains)> = vec![(Vec::new(), domains)];
    for &variable in &island.variables {
        let Some(data) = model.variables.get(variable.0 as usize).filter(|data| data.observable) else {
            continue;
        };
        let symbol = model.variable_symbol(variable) as usize;
        let mut next = Vec::new();
        for (chosen, domains) in &found {
            let set = domains.sets.get(symbol).copied().unwrap_or(0);
            // What is shown by rule does not vary.
            let fixed = data.shows.filter(|shows| shown.0.get(&variable) == Some(shows));
            for value in values(fixed.map_or(set, |value| set & 1 << value)) {
                let mut trial = domains.clone();
                trial.sets[symbol] = 1 << value;
                if assumed.settle_all(&mut trial).is_ok() && assumed.check(&mut trial).is_ok() {
                    let mut chosen = chosen.clone();
                    chosen.push((variable, value));
                    next.push((chosen, trial));
                }
            }
            if next.len() > most {
                return None;
            }
        }
        found = next;
    }
    Some(found.into_iter().map(|(chosen, _)| chosen).collect())
}
