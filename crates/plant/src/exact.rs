//! The exact belief update: all states that any believed state can lead to (SPEC 9.1).

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_integer::Integer as _;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::likelihood::Likelihoods;
use crate::model::{Commands, Model, Observation};
use crate::successor::{EstimateError, distributions};

/// The belief after `commands` were given and `observation` was made.
///
/// Exponential in the number of components that may fail; for larger models see [`crate::update_best`].
pub fn update_exact(
    model: &Model,
    belief: &Belief,
    commands: &Commands,
    observation: &Observation,
) -> Result<Belief, EstimateError> {
    let prior: Vec<&State> = belief.entries().iter().map(|(state, _)| state).collect();
    let distributions = distributions(model, &prior, commands)?;
    let mut predicted: BTreeMap<State, BigUint> = BTreeMap::new();
    for ((_, weight), distribution) in belief.entries().iter().zip(&distributions) {
        let mut reached: Vec<(Vec<u8>, BigUint)> =
            vec![(Vec::with_capacity(distribution.len()), weight.clone())];
        for choices in distribution {
            reached = reached
                .iter()
                .flat_map(|(modes, weight)| {
                    choices.iter().map(move |&(mode, numerator)| {
                        let mut modes = modes.clone();
                        modes.push(mode);
                        (modes, weight * numerator)
                    })
                })
                .collect();
        }
        for (modes, weight) in reached {
            *predicted.entry(State(modes)).or_insert_with(BigUint::zero) += weight;
        }
    }
    weigh(model, predicted.into_iter().collect(), &mut Likelihoods::new(model, observation))
}

/// Divides each predicted weight by the number of observations that its state admits.
pub(crate) fn weigh(
    model: &Model,
    predicted: Vec<(State, BigUint)>,
    likelihoods: &mut Likelihoods<'_>,
) -> Result<Belief, EstimateError> {
    let mut found: Vec<(State, BigUint, BigUint)> = Vec::with_capacity(predicted.len());
    let mut common = BigUint::one();
    for (state, weight) in predicted {
        let mut divisor = BigUint::one();
        for at in 0..model.islands.len() {
            divisor *= likelihoods.divisor(at, &state.0);
            if divisor.is_zero() {
                break;
            }
        }
        if !divisor.is_zero() {
            common = common.lcm(&divisor);
            found.push((state, weight, divisor));
        }
    }
    let weights =
        found.into_iter().map(|(state, weight, divisor)| (state, weight * (&common / divisor))).collect();
    Belief::from_weights(weights).ok_or(EstimateError::Unexplained)
}
