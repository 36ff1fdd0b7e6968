//! Which successors of a state can hold together at all, and what part of the drawn ones that is (SPEC3 17.1).
//!
//! Components move independently, but modes that contradict each other cannot occur: the simulated plant draws again. The
//! probability of a successor is therefore taken among those that can hold together. In most plants all can; an island's
//! *core* are the components whose modes may rule each other out.

use std::collections::{BTreeMap, BTreeSet};

use num_bigint::{BigInt, BigUint};
use num_rational::BigRational;
use num_traits::{One as _, Zero as _};

use crate::belief::Belief;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::formula::{Formula, Truth};
use crate::island::Island;
use crate::model::{Model, Observation};
use crate::observe::values;
use crate::successor::{Choices, EstimateError};

/// A constraint whose symbols have more combinations of values than this is taken to rule modes out.
const MAX_COMBINATIONS: u64 = 4096;
/// Successors of a core are told apart up to this many choices per state and island.
const MAX_NODES: u64 = 200_000;

/// The places of an island's components whose modes may contradict each other.
///
/// A component is taken out as long as each of its modes can hold whatever values the symbols have that the components left
/// speak of too: then what these agree on can always be completed by it.
pub(crate) fn core(model: &Model, island: &Island) -> Vec<u32> {
    let mut left: Vec<u32> = (0..island.components.len() as u32).collect();
    let mut domains = model.full.clone();
    loop {
        let before = left.len();
        let mut at = 0;
        while at < left.len() {
            if completes(model, island, &left, at, &mut domains) {
                left.remove(at);
            } else {
                at += 1;
            }
        }
        if left.len() == before {
            return left;
        }
    }
}

/// Whether the component at a place among those `left` can complete whatever the others agree on.
fn completes(model: &Model, island: &Island, left: &[u32], at: usize, domains: &mut [u64]) -> bool {
    let place = left[at] as usize;
    let own = Model::mode_symbol(island.components[place]);
    let others = |symbol: u32| {
        left.iter().enumerate().filter(|(other, _)| *other != at).any(|(_, &other)| {
            island.sayings[other as usize].iter().any(|saying| saying.symbols.binary_search(&symbol).is_ok())
        })
    };
    if others(own) {
        return false;
    }
    let Some(component) = model.component(island.components[place]) else { return true };
    component.modes.iter().zip(&island.sayings[place]).zip(0_u8..).all(|((mode, saying), number)| {
        let (shared, private): (Vec<u32>, Vec<u32>) = saying
            .symbols
            .iter()
            .filter(|symbol| **symbol != own)
            .partition(|symbol| (**symbol as usize) < model.components.len() || others(**symbol));
        let of_symbol = |symbol: &u32| u64::from(model.full[*symbol as usize].count_ones());
        let all = shared.iter().chain(&private).map(of_symbol).fold(1_u64, u64::saturating_mul);
        if all > MAX_COMBINATIONS {
            return false;
        }
        domains[own as usize] = 1 << number;
        let result = for_all(&mode.constraint, &shared, &private, domains);
        domains[own as usize] = model.full[own as usize];
        result
    })
}

/// Whether for all values of `shared` some values of `private` satisfy a constraint.
fn for_all(constraint: &Formula, shared: &[u32], private: &[u32], domains: &mut [u64]) -> bool {
    match constraint.truth(domains) {
        Truth::True => return true,
        Truth::False => return false,
        Truth::Open => {}
    }
    let Some((&symbol, rest)) = shared.split_first() else { return for_some(constraint, private, domains) };
    let full = domains[symbol as usize];
    let result = values(full).all(|value| {
        domains[symbol as usize] = 1 << value;
        for_all(constraint, rest, private, domains)
    });
    domains[symbol as usize] = full;
    result
}

fn for_some(constraint: &Formula, private: &[u32], domains: &mut [u64]) -> bool {
    match constraint.truth(domains) {
        Truth::True => return true,
        Truth::False => return false,
        Truth::Open => {}
    }
    let Some((&symbol, rest)) = private.split_first() else { return false };
    let full = domains[symbol as usize];
    let result = values(full).any(|value| {
        domains[symbol as usize] = 1 << value;
        for_some(constraint, rest, domains)
    });
    domains[symbol as usize] = full;
    result
}

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

impl Normalization {
    /// The factors of the `rows` states that have these choices; exact ones may be long numbers.
    pub(crate) fn new(model: &Model, choices: &Choices, rows: usize, may_round: bool) -> Self {
        let cores: Vec<&Island> = model.islands.iter().filter(|island| !island.core.is_empty()).collect();
        if cores.is_empty() {
            let (factors, unit) = (vec![BigUint::one(); rows], BigUint::one());
            return Self { factors, unit, is_known: vec![true; rows], is_rounded: false };
        }
        let mut domains = Domains::observed(model, &Observation::default());
        let mut known: BTreeMap<(usize, Vec<(u8, u64)>), Option<BigRational>> = BTreeMap::new();
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
        if self.factors.iter().all(|factor| factor.is_zero()) {
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
