//! Where a plant may start: the prior of its components, as far as their modes can hold together (SPEC3 17.5).

use num_bigint::BigUint;
use num_traits::{One as _, Zero as _};

use crate::belief::{Belief, State};
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::factored::FactoredBelief;
use crate::group::Group;
use crate::island::Island;
use crate::model::{Component, ComponentId, Model, Observation};
use crate::simulate::Random;

/// Modes that contradict each other are drawn again at most this often.
const MAX_DRAWS: u32 = 1000;

impl Component {
    /// Returns whether it may start in several modes.
    pub fn has_prior(&self) -> bool {
        self.prior.len() > 1
    }

    /// Returns what its weights sum to.
    fn prior_total(&self) -> u64 {
        self.prior.iter().map(|(_, weight)| weight).sum()
    }
}

impl Belief {
    /// Returns what is believed of a plant before the first step, with at most `most` states: components start
    /// independently, in modes that can hold together. `None` if no such modes can.
    ///
    /// A plant whose components each start in one mode is certain to be there.
    pub fn initial(model: &Model, most: usize) -> Option<Self> {
        if !model.components.iter().any(Component::has_prior) {
            return Some(Self::certain(model.initial_state()));
        }
        let most = most.max(1);
        let mut beginnings = Beginnings::new(model);
        for component in 0..model.components.len() {
            beginnings.extend(component);
            beginnings.keep(most);
        }
        let Beginnings { mut entries, dropped, .. } = beginnings;
        if entries.is_empty() && !dropped.is_zero() {
            // What was kept led nowhere: of the rest one state is found by search.
            let state = first_possible(model)?;
            let weight = weight_of(model, &state);
            entries.push((state, weight));
        }
        Self::measured(entries, dropped, most)
    }
}

impl FactoredBelief {
    /// Returns what is believed of a plant before the first step, with at most `most` states for each group.
    ///
    /// Groups whose first modes contradict each other, which compilation reports, are taken to start in them.
    pub fn initial(groups: &[Group], most: usize) -> Self {
        let belief = |group: &Group| {
            let initial = Belief::initial(&group.model, most);
            std::sync::Arc::new(initial.unwrap_or_else(|| Belief::certain(group.model.initial_state())))
        };
        Self::new(groups, groups.iter().map(belief).collect())
    }
}

/// Draws a state in which the plant starts, each with its probability.
///
/// Modes that contradict each other are drawn again; where that does not end, components are as in `likeliest`.
pub fn draw_initial(model: &Model, likeliest: &State, random: &mut Random) -> State {
    let mut state = likeliest.clone();
    let mut domains = Domains::observed(model, &Observation::default());
    let has_prior = |id: &ComponentId| model.component(*id).is_some_and(Component::has_prior);
    for island in model.islands.iter().filter(|island| island.components.iter().any(has_prior)) {
        for _ in 0..MAX_DRAWS {
            let mut drawn = state.clone();
            for (id, component) in
                island.components.iter().filter_map(|id| Some((*id, model.component(*id)?)))
            {
                drawn.set_mode(id, random.weighted(&component.prior, component.prior_total()));
            }
            if Assumed::all(model, island, &drawn.0).check(&mut domains).is_ok() {
                state = drawn;
                break;
            }
        }
    }
    state
}

/// The modes of the first components, most likely first as far as they were cut.
struct Beginnings<'model> {
    model: &'model Model,
    /// Per component its island, and its place there.
    places: Vec<(&'model Island, usize)>,
    free: Domains,
    /// Components that follow are in mode 0.
    entries: Vec<(State, BigUint)>,
    dropped: BigUint,
}

impl<'model> Beginnings<'model> {
    fn new(model: &'model Model) -> Self {
        let each = model.islands.iter().flat_map(|island| {
            let places = island.components.iter().enumerate();
            places.map(move |(place, component)| (component.0, (island, place)))
        });
        let mut places: Vec<_> = each.collect();
        places.sort_by_key(|(component, _)| *component);
        let start = (State(vec![0; model.components.len()]), BigUint::one());
        Self {
            model,
            places: places.into_iter().map(|(_, place)| place).collect(),
            free: Domains::observed(model, &Observation::default()),
            entries: vec![start],
            dropped: BigUint::zero(),
        }
    }

    /// Lets the next component start in its modes, as far as they can hold together with those before.
    fn extend(&mut self, component: usize) {
        let (Some(data), Some(&(island, place))) =
            (self.model.components.get(component), self.places.get(component))
        else {
            return;
        };
        let is_single = data.prior.len() == 1;
        let mut extended = Vec::with_capacity(self.entries.len() * data.prior.len());
        for (state, weight) in std::mem::take(&mut self.entries) {
            for &(mode, part) in &data.prior {
                let mut next = state.clone();
                next.0[component] = mode;
                let mut modes = Assumed::all(self.model, island, &next.0).modes;
                modes[place + 1..].fill(None);
                let assumed = Assumed { model: self.model, island, modes };
                if assumed.check(&mut self.free).is_ok() {
                    let weight = if is_single { weight.clone() } else { &weight * part };
                    extended.push((next, weight));
                }
            }
        }
        self.entries = extended;
        if !is_single {
            self.dropped *= data.prior_total();
        }
    }

    /// Drops all but the `most` heaviest.
    fn keep(&mut self, most: usize) {
        if self.entries.len() > most {
            self.entries.sort_by(|left, right| right.1.cmp(&left.1).then_with(|| left.0.cmp(&right.0)));
            self.dropped += self.entries.drain(most..).map(|(_, weight)| weight).sum::<BigUint>();
        }
    }
}

/// The weight of a state in which the plant may start.
fn weight_of(model: &Model, state: &State) -> BigUint {
    let parts = model.components.iter().zip(&state.0).filter(|(component, _)| component.has_prior());
    let weight = |(component, mode): (&Component, &u8)| {
        component.prior.iter().find(|(known, _)| known == mode).map_or(0, |(_, weight)| *weight)
    };
    parts.map(weight).fold(BigUint::one(), |product, weight| product * weight)
}

/// Some state in which the plant may start, likely modes tried first. Exponential at worst.
fn first_possible(model: &Model) -> Option<State> {
    let mut state = model.initial_state();
    let mut free = Domains::observed(model, &Observation::default());
    for island in &model.islands {
        let mut assumed = Assumed { model, island, modes: vec![None; island.components.len()] };
        if !complete(&mut assumed, 0, &mut free) {
            return None;
        }
        for (component, mode) in island.components.iter().zip(&assumed.modes) {
            state.set_mode(*component, mode.unwrap_or(0));
        }
    }
    Some(state)
}

fn complete(assumed: &mut Assumed<'_>, place: usize, free: &mut Domains) -> bool {
    let Some(component) = assumed.island.components.get(place).and_then(|id| assumed.model.component(*id))
    else {
        return true;
    };
    let mut prior: Vec<&(u8, u64)> = component.prior.iter().collect();
    prior.sort_by_key(|(_, weight)| std::cmp::Reverse(*weight));
    for (mode, _) in prior {
        assumed.modes[place] = Some(*mode);
        if assumed.check(free).is_ok() && complete(assumed, place + 1, free) {
            return true;
        }
    }
    assumed.modes[place] = None;
    false
}
