//! How what was believed before a step became what is believed after it: which states the likely ones come from, and which
//! trajectories the observation ended. It explains an update, and takes no part in one.

use std::collections::BTreeMap;

use num_traits::{One as _, Zero as _};
use serde::{Deserialize, Serialize};

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::factored::FactoredBelief;
use crate::interval::Interval;
use crate::model::{Commands, Model, Observation, VariableId};
use crate::possible::{Target, targets};
use crate::probability::Probability;
use crate::successor::EstimateError;

/// So many of the most likely states after a step are looked at, and before it of those that trajectories ended from.
const MAX_SHOWN: usize = 6;
/// So many of the most likely states before a step are looked at as predecessors.
const MAX_BEFORE: usize = 64;
/// Of a state with more successors, only those are looked at in which at most two components do not do what is nominal.
const MAX_SUCCESSORS: usize = 256;
/// So many of the likeliest successors of a state are compared with the observation.
const MAX_COMPARED: usize = 64;

/// How a belief came from the one before.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepBranches {
    /// Of each of the most likely states after the step, in their order, where it comes from.
    pub kept: Vec<KeptBranch>,
    /// The likeliest of the trajectories that the observation ended.
    pub ruled_out: Vec<RuledOut>,
    /// Which share of the trajectories that explain all observations was dropped: from zero to the most that it can be.
    pub dropped: Interval,
}

/// Where a state comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptBranch {
    /// The rank of the state before the step that it most likely comes from.
    pub from: Option<usize>,
    /// From how many other states it may come as well.
    pub others: usize,
}

/// A trajectory that an observation ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RuledOut {
    /// The rank of the state before the step.
    pub from: usize,
    /// The state after the step that was possible.
    pub state: State,
    /// Its probability before the observation; `None` if the state has too many successors to tell.
    pub probability: Option<Interval>,
    /// The observed variables that contradict it; if none does alone, those that do together.
    pub by: Vec<VariableId>,
}

/// Explains a step: the beliefs before and after it, what was commanded and what was observed. After an observation that
/// nothing explains there is no belief.
pub fn step_branches(
    model: &Model,
    before: &FactoredBelief,
    commands: &Commands,
    observation: &Observation,
    after: Option<&FactoredBelief>,
) -> Result<StepBranches, EstimateError> {
    let states: Vec<(State, Interval)> = before.states().take(MAX_BEFORE).collect();
    let each: Vec<Vec<Vec<Target>>> = states
        .iter()
        .map(|(state, _)| model.component_ids().map(|id| targets(model, id, state, commands)).collect())
        .collect::<Result<_, _>>()?;
    let mut kept = Vec::new();
    for (state, _) in after.into_iter().flat_map(FactoredBelief::states).take(MAX_SHOWN) {
        let mut best: Option<(usize, f64)> = None;
        let mut count = 0;
        for (rank, ((_, prior), targets)) in states.iter().zip(&each).enumerate() {
            let share = prior.to_f64().0 * chance(targets, &state);
            count += usize::from(share > 0.0);
            if share > best.map_or(0.0, |(_, best)| best) {
                best = Some((rank, share));
            }
        }
        kept.push(KeptBranch { from: best.map(|(rank, _)| rank), others: count.saturating_sub(1) });
    }
    let mut ended: Vec<(f64, RuledOut)> = Vec::new();
    for (from, ((_, prior), targets)) in states.iter().zip(&each).enumerate().take(MAX_SHOWN) {
        ended.extend(ruled_out(model, from, prior, targets, observation));
    }
    ended.sort_by(|left, right| right.0.total_cmp(&left.0));
    ended.truncate(MAX_SHOWN);
    let ruled_out = ended.into_iter().map(|(_, ended)| ended).collect();
    let high = after.map_or_else(Probability::zero, FactoredBelief::dropped);
    Ok(StepBranches { kept, ruled_out, dropped: Interval { low: Probability::zero(), high } })
}

/// The part of a target in all targets of its component.
fn part(targets: &[Target], target: &Target) -> Probability {
    let all: u64 = targets.iter().map(|target| target.weight).sum();
    Probability::new(target.weight.into(), all.into())
}

/// Returns how likely a state is to come next, as far as its components are independent.
fn chance(each: &[Vec<Target>], state: &State) -> f64 {
    let of = |(targets, mode): (&Vec<Target>, &u8)| {
        let all: u64 = targets.iter().map(|target| target.weight).sum();
        let own = targets.iter().find(|target| target.mode == *mode).map_or(0, |target| target.weight);
        own as f64 / all as f64
    };
    each.iter().zip(&state.0).map(of).product()
}

/// The successors of a state that the observation contradicts, each with its probability as a machine number.
fn ruled_out(
    model: &Model,
    from: usize,
    prior: &Interval,
    each: &[Vec<Target>],
    observation: &Observation,
) -> Vec<(f64, RuledOut)> {
    let all = each.iter().map(Vec::len).fold(1, usize::saturating_mul);
    let is_whole = all <= MAX_SUCCESSORS;
    let unusual = if is_whole { each.len() } else { 2 };
    let mut states: Vec<(f64, State)> = vec![(prior.to_f64().0, State(Vec::new()))];
    let mut deviations = vec![0];
    for targets in each {
        let mut next = Vec::new();
        let mut counts = Vec::new();
        for ((share, state), count) in states.iter().zip(&deviations) {
            for (at, target) in targets.iter().enumerate() {
                let count = count + usize::from(at > 0);
                if count > unusual {
                    break;
                }
                let mut state = state.clone();
                state.0.push(target.mode);
                let weight: u64 = targets.iter().map(|target| target.weight).sum();
                next.push((share * target.weight as f64 / weight as f64, state));
                counts.push(count);
            }
        }
        (states, deviations) = (next, counts);
    }
    // Modes that contradict each other do not occur together.
    let nothing = Observation::default();
    if is_whole {
        states.retain(|(_, state)| is_possible(model, state, &nothing));
    }
    let total: Option<Probability> =
        is_whole.then(|| states.iter().map(|(_, state)| exact(each, state)).sum());
    let total = total.filter(|total| !total.is_zero());
    states.sort_by(|left, right| right.0.total_cmp(&left.0));
    states.truncate(MAX_COMPARED);
    let ended = states.into_iter().filter(|(_, state)| {
        !is_possible(model, state, observation) && (is_whole || is_possible(model, state, &nothing))
    });
    ended
        .map(|(share, state)| {
            let by = contradicting(model, &state, observation);
            let probability = total.as_ref().map(|total| {
                let part = exact(each, &state) / total;
                Interval { low: &prior.low * &part, high: &prior.high * &part }
            });
            (share, RuledOut { from, state, probability, by })
        })
        .collect()
}

fn exact(each: &[Vec<Target>], state: &State) -> Probability {
    each.iter().zip(&state.0).fold(Probability::one(), |product, (targets, mode)| {
        targets
            .iter()
            .find(|target| target.mode == *mode)
            .map_or_else(Probability::zero, |target| product * part(targets, target))
    })
}

/// Returns whether the modes of a state can hold together with an observation.
fn is_possible(model: &Model, state: &State, observation: &Observation) -> bool {
    let mut free = Domains::observed(model, observation);
    model.islands.iter().all(|island| Assumed::all(model, island, &state.0).check(&mut free).is_ok())
}

/// The observed variables that contradict a state each; if there are none, those that do together.
fn contradicting(model: &Model, state: &State, observation: &Observation) -> Vec<VariableId> {
    let alone = |(id, value): (&VariableId, &u8)| {
        let only = Observation(BTreeMap::from([(*id, *value)]));
        (!is_possible(model, state, &only)).then_some(*id)
    };
    let found: Vec<VariableId> = observation.0.iter().filter_map(alone).collect();
    if !found.is_empty() {
        return found;
    }
    let mut rest = observation.clone();
    for id in observation.0.keys() {
        let mut fewer = rest.clone();
        fewer.0.remove(id);
        if !is_possible(model, state, &fewer) {
            rest = fewer;
        }
    }
    rest.0.into_keys().collect()
}

impl RuledOut {
    /// The components that are in other modes than in a state, with these modes: `EngineA=Failed`; `no change` if there
    /// are none.
    pub fn changes(&self, model: &Model, before: &State) -> String {
        let changes = model.differences(before, &self.state);
        if changes.is_empty() { "no change".to_owned() } else { changes }
    }

    /// The observations that contradict it: `EngineA.thrust=zero`.
    pub fn reasons(&self, model: &Model, observation: &Observation) -> String {
        let names = model.observation_names(observation);
        let of = |id: &VariableId| {
            let name = &model.variables.get(id.0 as usize)?.name;
            Some(format!("{name}={}", names.get(name.as_str())?))
        };
        self.by.iter().filter_map(of).collect::<Vec<_>>().join(", ")
    }
}
