//! How likely an observation is in a state (SPEC 9.1): the true values of observed variables that the state admits are equally
//! likely, and each is observed as it is, or with an error.

use std::collections::BTreeMap;

use num_bigint::BigUint;
use num_rational::BigRational;
use num_traits::{One as _, ToPrimitive as _, Zero as _};

use crate::consistency::Assumed;
use crate::diagnosis::shrink;
use crate::domains::{Domains, Settled};
use crate::island::{Island, Places};
use crate::model::{ComponentId, Model, Observation, VariableId};
use crate::value_set::ValueSet;

/// Of islands with at most so many combinations of modes all are looked at for the one that admits the fewest observations.
const MAX_COMBINATIONS: usize = 4096;
/// In larger islands a combination that admits what is observed is looked for among so many.
const MAX_NODES: usize = 20_000;

/// An observed value of a variable with errors, with its weight for each true value, in units that all states share.
struct Sensor {
    observed: u8,
    /// The weight if the observed value is the true one.
    right: BigUint,
    /// The weight if another value is the true one.
    wrong: BigUint,
    /// The weight of a probability of 1.
    unit: BigUint,
}

impl Sensor {
    /// The weight of all true values in a set.
    fn weight(&self, set: ValueSet) -> BigUint {
        let is_possible = set.contains(self.observed);
        let others = u64::from(set.len()) - u64::from(is_possible);
        let wrong = &self.wrong * others;
        if is_possible { wrong + &self.right } else { wrong }
    }
}

/// By symbol, what is observed with errors.
type Sensors = BTreeMap<u32, Sensor>;

/// No errors: each true value weighs one.
const WITHOUT_ERRORS: &Sensors = &Sensors::new();

/// How likely an observation is in some modes of an island, as a fraction in units that all states have in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Likelihood {
    /// The weight of what the modes admit and the observation leaves; zero if the observation contradicts the modes.
    pub(crate) weight: BigUint,
    /// How many combinations of true values of what is observed the modes admit.
    pub(crate) divisor: BigUint,
}

impl Likelihood {
    fn zero() -> Self {
        Self { weight: BigUint::zero(), divisor: BigUint::one() }
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.weight.is_zero()
    }

    /// Returns whether it is greater than another one.
    fn exceeds(&self, other: &Self) -> bool {
        &self.weight * &other.divisor > &other.weight * &self.divisor
    }
}

/// The weight of all combinations of true values of variables that no constraint connects.
fn product_of_values(observed: &[u32], domains: &Domains, sensors: &Sensors) -> BigUint {
    // Gathered in a machine word before it meets the long number.
    let mut product = BigUint::one();
    let mut gathered = 1_u64;
    for symbol in observed {
        let set = domains.sets.get(*symbol as usize).copied().unwrap_or_default();
        if let Some(sensor) = sensors.get(symbol) {
            product *= sensor.weight(set);
            continue;
        }
        let values = u64::from(set.len());
        gathered = gathered.checked_mul(values).unwrap_or_else(|| {
            product *= gathered;
            values
        });
    }
    if gathered != 1 {
        product *= gathered;
    }
    product
}

/// The same where constraints are still open: counted part by part, exponentially in the largest of them at worst.
fn product_over_parts(
    assumed: &Assumed<'_>,
    settled: &Settled,
    domains: &mut Domains,
    observed: &[u32],
    sensors: &Sensors,
) -> BigUint {
    let mut outside = observed.to_vec();
    let mut product = BigUint::one();
    for part in parts(assumed, settled, domains) {
        let inside: Vec<u32> = observed.iter().copied().filter(|symbol| part.contains(symbol)).collect();
        product *= count(assumed, domains, &inside, sensors);
        if product.is_zero() {
            return product;
        }
        outside.retain(|symbol| !part.contains(symbol));
    }
    product * product_of_values(&outside, domains, sensors)
}

/// The undetermined symbols of constraints that are still open, joined where they share one.
fn parts(assumed: &Assumed<'_>, settled: &Settled, domains: &Domains) -> Vec<Vec<u32>> {
    let mut parts: Vec<Vec<u32>> = Vec::new();
    let is_open = |symbol: &u32| domains.sets.get(*symbol as usize).is_some_and(|set| set.len() > 1);
    for symbols in assumed.open_symbols(settled) {
        let mut mine: Vec<u32> = symbols.iter().copied().filter(is_open).collect();
        for at in (0..parts.len()).rev() {
            if parts[at].iter().any(|symbol| mine.contains(symbol)) {
                mine.extend(parts.swap_remove(at));
            }
        }
        mine.sort_unstable();
        mine.dedup();
        parts.push(mine);
    }
    parts
}

/// The number of combinations of true values of the observed variables; all consequences of the modes were drawn.
pub(crate) fn combinations(assumed: &Assumed<'_>, domains: &mut Domains, observed: &[u32]) -> BigUint {
    count(assumed, domains, observed, WITHOUT_ERRORS)
}

/// The weight of all combinations of true values of the observed variables; all consequences of the modes were drawn.
fn count(assumed: &Assumed<'_>, domains: &mut Domains, observed: &[u32], sensors: &Sensors) -> BigUint {
    let point = domains.point();
    let open =
        observed.iter().find(|&&symbol| domains.sets.get(symbol as usize).is_some_and(|set| set.len() > 1));
    let Some(&symbol) = open else {
        let is_possible = assumed.search(domains).is_ok();
        domains.return_to(&point);
        return if is_possible { product_of_values(observed, domains, sensors) } else { BigUint::zero() };
    };
    let mut sum = BigUint::zero();
    for value in domains.sets.get(symbol as usize).copied().unwrap_or_default().values() {
        match assumed.restrict([(symbol, ValueSet::one(value))], domains) {
            Ok(true) => sum += product_of_values(observed, domains, sensors),
            Ok(false) => sum += count(assumed, domains, observed, sensors),
            Err(_) => {}
        }
        domains.return_to(&point);
    }
    sum
}

/// Returns whether some modes of the components from a place on admit what is observed; if there are too many, it is
/// taken for granted.
fn explains(assumed: &mut Assumed<'_>, place: usize, domains: &mut Domains, nodes: &mut usize) -> bool {
    *nodes += 1;
    if *nodes > MAX_NODES {
        return true;
    }
    let point = domains.point();
    let Some(component) = assumed.island.components.get(place).and_then(|id| assumed.model.component(*id))
    else {
        let is_possible = assumed.search(domains).is_ok();
        domains.return_to(&point);
        return is_possible;
    };
    for (mode, _) in (0..=u8::MAX).zip(&component.modes) {
        let found = assumed.add(place, mode, domains).is_ok() && explains(assumed, place + 1, domains, nodes);
        assumed.modes[place] = None;
        domains.return_to(&point);
        if found {
            return true;
        }
    }
    false
}

/// Returns what is observed of a variable with errors.
fn sensor(model: &Model, id: VariableId, observed: u8) -> Option<(u32, Sensor)> {
    let data = model.variables.get(id.0 as usize)?;
    let (part, whole) = data.error?;
    let others = (data.values.len() as u64).saturating_sub(1);
    let sensor = Sensor {
        observed,
        right: BigUint::from(whole - part) * others,
        wrong: BigUint::from(part),
        unit: BigUint::from(whole) * others,
    };
    Some((model.variable_symbol(id), sensor))
}

/// Likelihoods computed once per island and modes.
pub(crate) struct Likelihoods<'model> {
    model: &'model Model,
    /// What modes may be, given what is observed.
    observed: Domains,
    /// What they may be without that, given the modes that were judged last.
    free: Domains,
    /// By island, which modes these were.
    settled: Vec<Settled>,
    /// By island, its observed variables.
    symbols: Vec<Vec<u32>>,
    /// By island, those that are observed with errors.
    sensors: Vec<Sensors>,
    /// Per mode of components that are islands by themselves.
    alone: Vec<Option<Likelihood>>,
    /// By island, where the modes of its component start there.
    alone_starts: Vec<usize>,
    /// By other island and the modes of its components.
    known: Vec<BTreeMap<Vec<u8>, Likelihood>>,
    zero: Likelihood,
    /// The modes that were asked for last.
    modes: Vec<u8>,
}

impl<'model> Likelihoods<'model> {
    pub(crate) fn new(model: &'model Model, observation: &Observation) -> Self {
        let observed_of = |island: &Island| {
            let variables = island.variables.iter().filter(|variable| observation.0.contains_key(variable));
            variables.map(|variable| model.variable_symbol(*variable)).collect()
        };
        let mut alone = 0;
        let start_of = |island: &Island| {
            let start = alone;
            if let [component] = island.components.as_slice() {
                alone += model.component(*component).map_or(0, |component| component.modes.len());
            }
            start
        };
        let alone_starts = model.islands.iter().map(start_of).collect();
        let sensors = |island: &Island| {
            let variables = island.variables.iter();
            variables.filter_map(|id| sensor(model, *id, *observation.0.get(id)?)).collect()
        };
        let sensors: Vec<Sensors> = model.islands.iter().map(sensors).collect();
        let mut observed = Domains::observed(model, observation);
        // A sensor that is always wrong never shows the true value.
        for (symbol, sensor) in sensors.iter().flatten().filter(|(_, sensor)| sensor.right.is_zero()) {
            observed.sets[*symbol as usize] &= !ValueSet::one(sensor.observed);
        }
        Self {
            model,
            observed,
            sensors,
            free: Domains::observed(model, &Observation::default()),
            settled: vec![Settled::default(); model.islands.len()],
            symbols: model.islands.iter().map(observed_of).collect(),
            alone: vec![None; alone],
            alone_starts,
            zero: Likelihood::zero(),
            known: vec![BTreeMap::new(); model.islands.len()],
            modes: Vec::new(),
        }
    }

    /// Returns how likely the observation is in the island's modes.
    pub(crate) fn of(&mut self, at: usize, state: &[u8]) -> &Likelihood {
        let island = &self.model.islands[at];
        let judge = |likelihoods: &mut Self| {
            let judged = likelihoods.judge(at, &Assumed::all(likelihoods.model, island, state));
            judged.unwrap_or_else(|_| Likelihood::zero())
        };
        if let [component] = island.components.as_slice() {
            let place = self.alone_starts[at] + usize::from(state[component.0 as usize]);
            if self.alone[place].is_none() {
                self.alone[place] = Some(judge(self));
            }
            return self.alone[place].as_ref().unwrap_or(&self.zero);
        }
        self.ask(at, state);
        if !self.known[at].contains_key(&self.modes) {
            let likelihood = judge(self);
            self.known[at].insert(self.modes.clone(), likelihood);
        }
        &self.known[at][&self.modes]
    }

    /// The same likelihood as a floating-point number, at most 1.
    pub(crate) fn chance(&mut self, at: usize, state: &[u8]) -> f64 {
        if self.sensors[at].is_empty() {
            let likelihood = self.of(at, state);
            let divisor = likelihood.divisor.to_f64().unwrap_or(f64::MAX);
            return if likelihood.is_zero() { 0.0 } else { 1.0 / divisor };
        }
        let unit = self.sensors[at].values().fold(BigUint::one(), |unit, sensor| unit * &sensor.unit);
        let likelihood = self.of(at, state);
        let unit = &likelihood.divisor * unit;
        BigRational::new(likelihood.weight.clone().into(), unit.into()).to_f64().unwrap_or(0.0)
    }

    /// The greatest likelihood in any modes of an island, if some admit the observation.
    ///
    /// Where an island has more combinations of modes than are looked at, an upper bound, if some combination may admit the
    /// observation: the likeliest true value of each observed one.
    fn greatest(&mut self, at: usize) -> Option<Likelihood> {
        let island = &self.model.islands[at];
        if self.symbols[at].is_empty() && island.core.is_empty() {
            return Some(Likelihood { weight: BigUint::one(), divisor: BigUint::one() });
        }
        let components = &self.model.components;
        let modes_of = |id: &ComponentId| components.get(id.0 as usize).map_or(0, |data| data.modes.len());
        let all = island.components.iter().map(modes_of).fold(1_usize, usize::saturating_mul);
        if all > MAX_COMBINATIONS {
            let mut assumed =
                Assumed { model: self.model, island, modes: vec![None; island.components.len()] };
            let start = self.observed.mark();
            assumed.begin(&mut self.observed);
            let explains = explains(&mut assumed, 0, &mut self.observed, &mut 0);
            self.observed.undo(start);
            let likeliest = |sensor: &Sensor| sensor.right.clone().max(sensor.wrong.clone());
            let weight = self.sensors[at].values().map(likeliest).product();
            return explains.then(|| Likelihood { weight, divisor: BigUint::one() });
        }
        let mut state = vec![0; self.model.components.len()];
        let mut greatest: Option<Likelihood> = None;
        for number in 0..all {
            let mut rest = number;
            for id in &island.components {
                let count = modes_of(id).max(1);
                state[id.0 as usize] = (rest % count) as u8;
                rest /= count;
            }
            let likelihood = self.of(at, &state);
            if !likelihood.is_zero() && greatest.as_ref().is_none_or(|greatest| likelihood.exceeds(greatest))
            {
                greatest = Some(likelihood.clone());
            }
        }
        greatest
    }

    /// The greatest likelihood in any state, or an upper bound of that; `None` if no state admits the observation.
    pub(crate) fn max_of_all(&mut self) -> Option<Likelihood> {
        let one = Likelihood { weight: BigUint::one(), divisor: BigUint::one() };
        (0..self.model.islands.len()).map(|at| self.greatest(at)).try_fold(one, |all, one| {
            let one = one?;
            Some(Likelihood { weight: all.weight * one.weight, divisor: all.divisor * one.divisor })
        })
    }

    /// Returns whether an observation made in an island, or modes that contradict each other there, can rule states
    /// out.
    pub(crate) fn can_exclude(&self, at: usize) -> bool {
        !self.symbols[at].is_empty() || !self.model.islands[at].core.is_empty()
    }

    /// Returns what symbols may be, given what is observed and nothing else.
    pub(crate) fn observed_domains(&self) -> Domains {
        self.observed.clone()
    }

    /// Notes the modes of an island that are asked for.
    fn ask(&mut self, at: usize, state: &[u8]) {
        self.modes.clear();
        let components = self.model.islands[at].components.iter();
        self.modes.extend(components.filter_map(|component| state.get(component.0 as usize)));
    }

    /// Returns how likely the observation is in the assumed modes of an island; the error names components that cannot
    /// be in theirs.
    ///
    /// Where the modes leave no constraint open, what they say without the observation tells whether they admit it.
    fn judge(&mut self, at: usize, assumed: &Assumed<'_>) -> Result<Likelihood, Places> {
        let (observed, sensors) = (&self.symbols[at], &self.sensors[at]);
        let is_settled = assumed.propagate_from(&mut self.settled[at], &mut self.free)?;
        let contradicts = |symbol: &&u32| {
            let sets = self.free.sets.get(**symbol as usize).zip(self.observed.sets.get(**symbol as usize));
            sets.is_some_and(|(left, right)| (*left & *right).is_empty())
        };
        if let Some(contradicted) = observed.iter().find(contradicts) {
            return Err(self.free.reason_of(*contradicted));
        }
        if is_settled {
            let divisor = product_of_values(observed, &self.free, WITHOUT_ERRORS);
            let erroneous: Vec<u32> = sensors.keys().copied().collect();
            return Ok(Likelihood { weight: product_of_values(&erroneous, &self.free, sensors), divisor });
        }
        let point = self.free.resume(&self.settled[at]);
        let given = observed.iter().map(|symbol| (*symbol, self.observed.sets[*symbol as usize]));
        let is_settled = assumed.restrict(given, &mut self.free);
        let restricted = self.free.point();
        let result =
            is_settled.and_then(|is_true| if is_true { Ok(()) } else { assumed.search(&mut self.free) });
        self.free.return_to(&restricted);
        let weight = match result {
            Ok(()) if sensors.is_empty() => Ok(BigUint::one()),
            Ok(()) => {
                let settled = Settled { standing: self.free.standing.clone(), ..Settled::default() };
                Ok(product_over_parts(assumed, &settled, &mut self.free, observed, sensors))
            }
            Err(places) => Err(places),
        };
        self.free.return_to(&point);
        let weight = weight?;
        let divisor =
            product_over_parts(assumed, &self.settled[at], &mut self.free, observed, WITHOUT_ERRORS);
        Ok(Likelihood { weight, divisor })
    }

    /// Returns why the modes of an island do not admit the observation, if they do not: components of which none can be
    /// left out.
    ///
    /// Components that are not free are in their modes anyhow; they are not tried to be left out.
    pub(crate) fn conflict(
        &mut self,
        at: usize,
        state: &[u8],
        is_free: impl Fn(ComponentId) -> bool,
    ) -> Option<Vec<ComponentId>> {
        let island = self.model.islands.get(at)?;
        let mut assumed = Assumed::all(self.model, island, state);
        match self.judge(at, &assumed) {
            Ok(likelihood) => {
                self.ask(at, state);
                self.known[at].entry(self.modes.clone()).or_insert(likelihood);
                None
            }
            Err(places) => {
                let may_go = |place: usize| island.components.get(place).is_some_and(|id| is_free(*id));
                shrink(&mut assumed, &mut self.observed, places, may_go);
                let involved = island.components.iter().zip(&assumed.modes);
                Some(involved.filter(|(_, mode)| mode.is_some()).map(|(component, _)| *component).collect())
            }
        }
    }
}
