//! The exact belief update: all states that any believed state can lead to (SPEC 9.1).

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_integer::Integer as _;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::likelihood::Likelihoods;
use crate::model::{Commands, Model, Observation};
use crate::normalization::Normalization;
use crate::successor::{EstimateError, distributions};

/// States that an exact update keeps at most, about a hundred megabytes.
const MAX_STATES: usize = 300_000;

/// The belief after `commands` were given and `observation` was made.
///
/// Exponential in the number of components that may fail; for larger models see [`crate::update_best`].
///
/// ```
/// let text = "(DEFCLASS Valve () (VAR flow {no yes} OBSERVABLE) (COMMAND cmd {none open})
///     (MODE Closed (flow = no)) (MODE Open (flow = yes)) (MODE Stuck (flow = no))
///     (TRANSITION Closed Open (cmd = open)) (FAULT Closed Stuck 0.01))
///   (DEFINSTANCE V Valve INIT Closed)";
/// let (model, _diagnostics) = plant::compile(&rmpl::control::parse(text).file);
/// let model = model.expect("nothing in it is an error");
/// let before = plant::Belief::certain(model.initial_state());
/// let commands = model.commands_from_names([("V", "open")])?;
/// let observation = model.observation_from_names([("V.flow", "no")])?;
/// // It was to open and nothing flows: only a fault explains that.
/// let after = plant::update_exact(&model, &before, &commands, &observation).expect("some state explains it");
/// assert_eq!(model.state_names(after.most_likely())["V"], "Stuck");
/// # Ok::<(), String>(())
/// ```
pub fn update_exact(
    model: &Model,
    belief: &Belief,
    commands: &Commands,
    observation: &Observation,
) -> Result<Belief, EstimateError> {
    let prior: Vec<&State> = belief.entries().iter().map(|(state, _)| state).collect();
    let distributions = distributions(model, &prior, commands)?;
    let normalized = Normalization::new(model, &distributions, prior.len(), false).applied(belief)?;
    let belief = normalized.as_ref().unwrap_or(belief);
    let of_row = |row: usize| {
        let choices = (0..distributions.components()).map(|component| distributions.of(row, component).len());
        choices.fold(1_usize, usize::saturating_mul)
    };
    let possible = (0..prior.len()).map(of_row).fold(0, usize::saturating_add);
    if possible > MAX_STATES {
        return Err(EstimateError::TooMany(MAX_STATES));
    }
    let mut predicted: BTreeMap<State, BigUint> = BTreeMap::new();
    for (row, (_, weight)) in belief.entries().iter().enumerate() {
        let mut reached: Vec<(Vec<u8>, BigUint)> =
            vec![(Vec::with_capacity(distributions.components()), weight.clone())];
        for component in 0..distributions.components() {
            let choices = distributions.of(row, component);
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
    let mut likelihoods = Likelihoods::new(model, observation);
    let (weights, _) = weighed(model, predicted.into_iter().collect(), &mut likelihoods);
    Belief::from_weights(weights).ok_or(EstimateError::Unexplained)
}

/// The predicted weights times the likelihoods of the observation, in a common unit; and the factor by which it is smaller.
pub(crate) fn weighed(
    model: &Model,
    predicted: Vec<(State, BigUint)>,
    likelihoods: &mut Likelihoods<'_>,
) -> (Vec<(State, BigUint)>, BigUint) {
    let mut found: Vec<(State, BigUint, BigUint)> = Vec::with_capacity(predicted.len());
    let mut common = BigUint::one();
    for (state, mut weight) in predicted {
        let mut divisor = BigUint::one();
        for at in 0..model.islands.len() {
            let one = likelihoods.of(at, &state.0);
            if !one.divisor.is_one() {
                divisor *= &one.divisor;
            }
            if !one.weight.is_one() {
                weight *= &one.weight;
            }
            if weight.is_zero() {
                break;
            }
        }
        if !weight.is_zero() {
            if divisor != common {
                common = common.lcm(&divisor);
            }
            found.push((state, weight, divisor));
        }
    }
    let scaled = |weight: BigUint, divisor: BigUint| {
        if divisor == common { weight } else { weight * (&common / divisor) }
    };
    let weights =
        found.into_iter().map(|(state, weight, divisor)| (state, scaled(weight, divisor))).collect();
    (weights, common)
}
