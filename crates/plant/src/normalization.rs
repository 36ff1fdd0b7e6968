//! Which successors of a state can hold together at all, and what part of the drawn ones that is (SPEC3 17.1).
//!
//! Components move independently, but modes that contradict each other cannot occur: the simulated plant draws again. The
//! probability of a successor is therefore taken among those that can hold together. In most plants all can; an island's
//! *core* are the components whose modes may rule each other out.

use std::collections::{BTreeMap, BTreeSet};

use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::{One as _, Zero};

use crate::belief::Belief;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::island::Island;
use crate::model::{Model, Observation};
use crate::successor::{Choices, EstimateError};

/// Successors of a core are told apart up to this many choices per state and island.
const MAX_NODES: u64 = 200_000;

/// What the weights of the successors of some states have to be multiplied with, to be probabilities in one unit.
pub(crate) struct Normalization {
    /// Per state; zero where no successor is possible, or where it is not known which are.
    pub(crate) factors: Vec<BigUint>,
    /// What every factor would be if all successors were possible.
    pub(crate) unit: BigUint,
    /// Whether it is known, per state, which successors are possible.
    pub(crate) is_known: Vec<bool>,
    /// Whether factors are rounded down, each by less than one.
    pub(crate) is_rounded: bool,
}

/// Factors that would have a longer unit than this, in bits, are rounded to one of this length.
const UNIT_BITS: u64 = 512;

/// What states share that have one part: an island, and the choices of what takes part in it.
type Shared = (usize, Vec<(u8, u64)>);

impl Normalization {
    /// The factors of the `rows` states that have these choices; exact ones may be long numbers.
    pub(crate) fn new(model: &Model, choices: &Choices, rows: usize, may_round: bool) -> Self {
        let cores: Vec<&Island> = model.islands.iter().filter(|island| !island.core.is_empty()).collect();
        if cores.is_empty() {
            let (factors, unit) = (vec![BigUint::one(); rows], BigUint::one());
            return Self { factors, unit, is_known: vec![true; rows], is_rounded: false };
        }
        let mut domains = Domains::observed(model, &Observation::default());
        let mut known: BTreeMap<Shared, Option<BigRational>> = BTreeMap::new();
        let mut shares: Vec<Option<BigRational>> = Vec::with_capacity(rows);
        for row in 0..rows {
            let mut share = Some(BigRational::one());
            for (at, island) in cores.iter().enumerate() {
                let mut key = Vec::new();
                for &place in &island.core {
                    key.extend_from_slice(choices.of(row, island.components[place as usize].0 as usize));
                    key.push((u8::MAX, 0));
                }
                let one = known
                    .entry((at, key))
                    .or_insert_with(|| share_of(model, island, choices, row, &mut domains));
                share = share.zip(one.as_ref()).map(|(share, one)| share * one);
            }
            shares.push(share);
        }
        let numerators: BTreeSet<&BigInt> = shares
            .iter()
            .flatten()
            .map(BigRational::numer)
            .filter(|numerator| !numerator.is_zero())
            .collect();
        let mut common = BigInt::one();
        let mut is_rounded = false;
        for numerator in numerators {
            common = num_integer::lcm(common, numerator.clone());
            if may_round && common.bits() > UNIT_BITS {
                (common, is_rounded) = (BigInt::one() << UNIT_BITS, true);
                break;
            }
        }
        let factor = |share: &Option<BigRational>| match share {
            Some(share) if !share.is_zero() => {
                (share.recip() * &common).to_integer().to_biguint().unwrap_or_default()
            }
            _ => BigUint::zero(),
        };
        Self {
            factors: shares.iter().map(factor).collect(),
            unit: common.to_biguint().unwrap_or_default(),
            is_known: shares.iter().map(Option::is_some).collect(),
            is_rounded,
        }
    }

    /// The belief with its states weighted so that successors are taken among the possible ones.
    pub(crate) fn applied(&self, belief: &Belief) -> Result<Option<Belief>, EstimateError> {
        if self.is_known.contains(&false) {
            return Err(EstimateError::TooMany(MAX_NODES as usize));
        }
        if self.factors.iter().all(Zero::is_zero) {
            return Err(EstimateError::Unexplained);
        }
        Ok(self.factors.iter().any(|factor| !factor.is_one()).then(|| belief.rescaled(&self.factors)))
    }
}

/// What part of the successors of a state can hold together in an island; `None` if there are too many to tell.
fn share_of(
    model: &Model,
    island: &Island,
    choices: &Choices,
    row: usize,
    domains: &mut Domains,
) -> Option<BigRational> {
    let mut assumed = Assumed { model, island, modes: vec![None; island.components.len()] };
    let mut all = BigUint::one();
    for &place in &island.core {
        let weights = choices.of(row, island.components[place as usize].0 as usize);
        all *= weights.iter().map(|(_, weight)| weight).sum::<u64>();
    }
    let start = domains.mark();
    assumed.begin(domains);
    let mut nodes = 0;
    let possible = possible(&mut assumed, &island.core, choices, row, domains, &mut nodes);
    domains.undo(start);
    Some(BigRational::new(possible?.into(), all.into()))
}

/// The weight of the choices at these places that can hold together.
fn possible(
    assumed: &mut Assumed<'_>,
    places: &[u32],
    choices: &Choices,
    row: usize,
    domains: &mut Domains,
    nodes: &mut u64,
) -> Option<BigUint> {
    *nodes += 1;
    if *nodes > MAX_NODES {
        return None;
    }
    let Some((&place, rest)) = places.split_first() else {
        let point = domains.point();
        let is_possible = assumed.search(domains).is_ok();
        domains.return_to(&point);
        return Some(if is_possible { BigUint::one() } else { BigUint::zero() });
    };
    let mut sum = BigUint::zero();
    let point = domains.point();
    for &(mode, weight) in choices.of(row, assumed.island.components[place as usize].0 as usize) {
        if assumed.add(place as usize, mode, domains).is_ok() {
            sum += possible(assumed, rest, choices, row, domains, nodes)? * weight;
        }
        assumed.modes[place as usize] = None;
        domains.return_to(&point);
    }
    Some(sum)
}
