//! Successors of all states at once, component by component, with equal ones joined after each.
//!
//! Where many states lead to the same ones, this takes as many steps as there are states, not pairs of states. A component
//! moves while all components that its guards ask for are still in their modes of before: effects before causes.

use num_bigint::BigUint;
use num_integer::lcm;
use num_traits::{One as _, Zero as _};

use crate::belief::State;
use crate::likelihood::Likelihoods;
use crate::model::{Commands, ComponentId, Mode, Model};
use crate::successor::{EstimateError, distribution};
use crate::value_set::ValueSet;

/// At most this many states are held at once.
const MAX_HELD: usize = 300_000;

/// A state on its way: some components have moved.
pub(crate) struct Moving {
    pub(crate) state: State,
    pub(crate) weight: BigUint,
    /// Its measure as a part of all, for the threshold.
    pub(crate) measure: f64,
}

/// Where all have moved.
pub(crate) struct Moved {
    pub(crate) states: Vec<Moving>,
    /// What was dropped, in the unit of the weights.
    pub(crate) dropped: BigUint,
    /// By what all weights have grown.
    pub(crate) unit: BigUint,
}

/// Moves all components of some states. States that measure less than `threshold` are dropped.
///
/// `None` if components depend on each other in a cycle or on variables, or if there are too many states.
pub(crate) fn move_all(
    model: &Model,
    commands: &Commands,
    mut states: Vec<Moving>,
    threshold: f64,
    alone: &[Option<usize>],
    likelihoods: &mut Likelihoods<'_>,
) -> Result<Option<Moved>, EstimateError> {
    let Some(order) = effects_first(model) else { return Ok(None) };
    let mut dropped = BigUint::zero();
    let mut unit = BigUint::one();
    for component in order {
        let common = denominator(model, component, &states);
        dropped *= common;
        unit *= common;
        let mut next: Vec<Moving> = Vec::with_capacity(2 * states.len());
        for Moving { state, weight, measure } in states {
            if measure < threshold {
                dropped += weight * common;
                continue;
            }
            let (choices, own) = distribution(model, component, &state, commands)?;
            for (mode, part) in choices {
                let part = part * (common / own);
                let mut state = state.clone();
                state.set_mode(component, mode);
                if let Some(island) = alone[component.0 as usize]
                    && likelihoods.of(island, &state.0).is_zero()
                {
                    continue;
                }
                next.push(Moving {
                    state,
                    weight: if part == 1 { weight.clone() } else { &weight * part },
                    measure: measure * (part as f64 / common as f64),
                });
            }
        }
        states = joined(next);
        if states.len() > MAX_HELD {
            return Ok(None);
        }
    }
    Ok(Some(Moved { states, dropped, unit }))
}

/// The common denominator of what a component may do in any of some states.
fn denominator(model: &Model, component: ComponentId, states: &[Moving]) -> u64 {
    let Some(data) = model.component(component) else { return 1 };
    let present: ValueSet = states.iter().map(|moving| moving.state.mode(component)).collect();
    let modes = (0..=u8::MAX).zip(&data.modes).filter(|(at, _)| present.contains(*at));
    let each = modes.flat_map(|(_, mode)| {
        let choices = mode.choices.iter().map(|choice| choice.denominator);
        choices.chain([1]).map(|denominator| denominator * mode.denominator)
    });
    each.fold(1, lcm)
}

/// Equal states as one, in the order of their modes.
fn joined(mut states: Vec<Moving>) -> Vec<Moving> {
    states.sort_by(|left, right| left.state.cmp(&right.state));
    let mut joined: Vec<Moving> = Vec::with_capacity(states.len());
    for moving in states {
        match joined.last_mut() {
            Some(last) if last.state == moving.state => {
                last.weight += moving.weight;
                last.measure += moving.measure;
            }
            _ => joined.push(moving),
        }
    }
    joined
}

/// The components, each before those whose modes its guards ask for; `None` if there is no such order, or guards ask for
/// variables, which all modes decide together.
fn effects_first(model: &Model) -> Option<Vec<ComponentId>> {
    let mut asked: Vec<Vec<u32>> = Vec::with_capacity(model.components.len());
    for (id, component) in model.component_ids().zip(&model.components) {
        let mut mine = Vec::new();
        let mut asks_for_variables = false;
        for guard in component.modes.iter().flat_map(Mode::guards) {
            guard.symbols(&mut |symbol| {
                asks_for_variables |= model.symbol_variable(symbol).is_some();
                if (symbol as usize) < model.components.len() && symbol != id.0 {
                    mine.push(symbol);
                }
            });
        }
        if asks_for_variables {
            return None;
        }
        mine.sort_unstable();
        mine.dedup();
        asked.push(mine);
    }
    let mut waiting_for = vec![0_u32; asked.len()];
    asked.iter().flatten().for_each(|cause| waiting_for[*cause as usize] += 1);
    let mut ready: std::collections::BTreeSet<u32> =
        (0..asked.len() as u32).filter(|at| waiting_for[*at as usize] == 0).collect();
    let mut order = Vec::with_capacity(asked.len());
    while let Some(next) = ready.pop_first() {
        order.push(ComponentId(next));
        for &cause in &asked[next as usize] {
            waiting_for[cause as usize] -= 1;
            if waiting_for[cause as usize] == 0 {
                ready.insert(cause);
            }
        }
    }
    (order.len() == asked.len()).then_some(order)
}
