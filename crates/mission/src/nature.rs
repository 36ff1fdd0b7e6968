//! What the environment chooses in a run (SPEC 13.2): durations drawn from their ranges by the run's seed.

use std::collections::BTreeMap;

use exact::{Overflow, Time};
use executive::world::{abort_name, natures_ranges};
use plant::Random;
use smol_str::SmolStr;
use snapshot::robustness::Distribution;
use tpn::{Network, Occurrence};

use crate::draws::draw;

/// How the environment chooses durations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Nature {
    Chance,
    /// Ends of ranges by chance, and what makes the plan fail where something does.
    Adversary,
}

/// Told from the seed of everything else by this.
const NATURE: u64 = 0x006e_6174_7572_6521;
/// And how long ending activities early takes, by this.
const ABORTS: u64 = 0x0061_626f_7274_7321;

/// Returns how long each duration of the environment's is in the run of `seed`, by occurrence. `named` are
/// distributions that are given; all others are uniform.
pub(crate) fn choose(
    network: &Network,
    seed: u64,
    nature: Nature,
    named: &dyn Fn(&Occurrence) -> Option<Distribution>,
) -> Result<BTreeMap<SmolStr, Time>, Overflow> {
    let mut random = Random::new(seed ^ NATURE);
    let mut aborting = Random::new(seed ^ ABORTS);
    let aborts: Vec<(SmolStr, Time)> = network
        .occurrences
        .iter()
        .filter_map(|occurrence| Some((abort_name(occurrence), occurrence.aborts?)))
        .map(|(name, [lower, upper])| {
            let takes = match nature {
                Nature::Adversary => upper,
                Nature::Chance => draw(Distribution::Uniform(lower, upper), &mut aborting)?,
            };
            Ok((name, takes))
        })
        .collect::<Result<_, Overflow>>()?;
    let durations = natures_ranges(network).map(|(occurrence, [lower, upper])| {
        let duration = match nature {
            Nature::Adversary => [lower, upper][random.below(2) as usize],
            Nature::Chance => {
                let distribution = named(occurrence).unwrap_or(Distribution::Uniform(lower, upper));
                draw(distribution, &mut random)?
            }
        };
        Ok((occurrence.name.clone(), duration))
    });
    durations.chain(aborts.into_iter().map(Ok)).collect()
}
