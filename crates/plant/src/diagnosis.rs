//! Why a diagnosis is what it is: which observations contradict which mode assumptions.

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::island::{Island, Places, place_bit};
use crate::model::{Commands, ComponentId, Model, Observation, VariableId};
use crate::successor::{EstimateError, nominal};
use serde::{Deserialize, Serialize};

/// Mode assumptions and observations that cannot hold together, none of which can be left out.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Conflict {
    /// The assumed modes.
    pub modes: Vec<(ComponentId, u8)>,
    /// The observations that contradict them.
    pub observations: Vec<(VariableId, u8)>,
}

impl Conflict {
    /// The conflict in words: `EngineA=Firing contradicts EngineA.thrust=zero`.
    pub fn describe(&self, model: &Model) -> String {
        let modes: Vec<String> = self
            .modes
            .iter()
            .filter_map(|(id, mode)| {
                Some(format!("{}={}", model.component(*id)?.name, model.mode_name(*id, *mode)))
            })
            .collect();
        let observations: Vec<String> = self
            .observations
            .iter()
            .filter_map(|(id, value)| {
                let variable = model.variables.get(id.0 as usize)?;
                Some(format!("{}={}", variable.name, variable.values.get(*value as usize)?))
            })
            .collect();
        let verb = if modes.len() == 1 { "contradicts" } else { "contradict" };
        if observations.is_empty() {
            return format!("{} are inconsistent", modes.join(" and "));
        }
        format!("{} {verb} {}", modes.join(" and "), observations.join(" and "))
    }
}

/// The minimal conflicts between what `state` should nominally have become under `commands`, and `observation`.
///
/// At most `most` are looked for, by Reiter's hitting-set tree (1987). Empty when all goes as expected.
pub fn conflicts(
    model: &Model,
    state: &State,
    commands: &Commands,
    observation: &Observation,
    most: usize,
) -> Result<Vec<Conflict>, EstimateError> {
    let expected = nominal(model, state, commands)?;
    Ok(conflicts_of(model, &expected, observation, most))
}

/// The minimal conflicts between the modes of `state` and `observation`.
pub fn conflicts_of(model: &Model, state: &State, observation: &Observation, most: usize) -> Vec<Conflict> {
    let mut found: Vec<Conflict> = Vec::new();
    for island in &model.islands {
        let mut waiting: Vec<Vec<ComponentId>> = vec![Vec::new()];
        let mut at = 0;
        while let Some(without) = waiting.get(at).cloned() {
            at += 1;
            if found.len() >= most || at > 16 * most.max(1) {
                break;
            }
            let Some(conflict) = minimal(model, island, state, observation, &without) else { continue };
            for (component, _) in &conflict.modes {
                let mut more = without.clone();
                more.push(*component);
                more.sort_unstable();
                if !waiting.contains(&more) {
                    waiting.push(more);
                }
            }
            if !found.contains(&conflict) {
                found.push(conflict);
            }
        }
    }
    found.sort();
    found
}

/// A minimal conflict between the modes of `state` and `observation` that assumes nothing of the components in `without`;
/// nothing if the other assumptions can hold together.
pub fn conflict_without(
    model: &Model,
    state: &State,
    observation: &Observation,
    without: &[ComponentId],
) -> Option<Conflict> {
    model.islands.iter().find_map(|island| minimal(model, island, state, observation, without))
}

/// The same within an island.
fn minimal(
    model: &Model,
    island: &Island,
    state: &State,
    observation: &Observation,
    without: &[ComponentId],
) -> Option<Conflict> {
    let mut assumed = Assumed::all(model, island, &state.0);
    for (place, component) in island.components.iter().enumerate() {
        if without.contains(component) {
            assumed.modes[place] = None;
        }
    }
    let mut observed = Domains::observed(model, observation);
    let places = assumed.check(&mut observed).err()?;
    shrink(&mut assumed, &mut observed, places, |_| true);
    let mut needed = observation.clone();
    for variable in observation.0.keys() {
        let mut fewer = needed.clone();
        fewer.0.remove(variable);
        if assumed.satisfy(&mut Domains::observed(model, &fewer)).is_err() {
            needed = fewer;
        }
    }
    let modes = island
        .components
        .iter()
        .zip(&assumed.modes)
        .filter_map(|(component, mode)| Some((*component, (*mode)?)));
    Some(Conflict { modes: modes.collect(), observations: needed.0.into_iter().collect() })
}

/// Drops assumptions until every one that is left, and may go, is needed for the contradiction.
pub(crate) fn shrink(
    assumed: &mut Assumed<'_>,
    observed: &mut Domains,
    mut places: Places,
    may_go: impl Fn(usize) -> bool,
) {
    let keep = |assumed: &mut Assumed<'_>, places: Places| {
        for (place, mode) in assumed.modes.iter_mut().enumerate() {
            if places & place_bit(place) == 0 {
                *mode = None;
            }
        }
    };
    keep(assumed, places);
    debug_assert!(assumed.check(observed).is_err(), "the modes responsible contradict each other");
    for place in 0..assumed.modes.len() {
        if assumed.modes[place].is_none() || !may_go(place) {
            continue;
        }
        let mode = assumed.modes[place].take();
        match assumed.check(observed) {
            Ok(()) => assumed.modes[place] = mode,
            Err(fewer) => {
                places &= fewer;
                if places == fewer {
                    keep(assumed, fewer);
                }
            }
        }
    }
}
