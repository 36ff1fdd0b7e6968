//! Where a component goes in one step: its nominal target, and its faults (SPEC 9.1).

use num_integer::lcm;
use thiserror::Error;

use crate::belief::State;
use crate::domains::Domains;
use crate::formula::{Formula, Truth};
use crate::knowledge::is_entailed_by_search;
use crate::model::{Choice, CommandVariableId, Commands, Component, ComponentId, Mode, Model, Observation};
use crate::value_set::ValueSet;

/// What can go wrong in a step of estimation or simulation.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EstimateError {
    /// The model is not deterministic there.
    #[error("`{component}` in mode {from} has two enabled transitions, to {first} and to {second}")]
    Ambiguous {
        component: String,
        from: String,
        /// The target of the first enabled transition.
        first: String,
        /// The target of the second.
        second: String,
    },
    /// No state of the belief can lead to the observation.
    #[error("no tracked state explains the observations")]
    Unexplained,
    /// There are more states than can be kept.
    #[error("more than {0} states are possible: limit the number of tracked states")]
    TooMany(usize),
    /// The modes that were asked for contradict each other.
    #[error("these modes are inconsistent: {0}")]
    Impossible(String),
}

/// The mode that `component` nominally enters from `state` under `commands`: of several outcomes the likeliest that leaves
/// its mode.
pub fn successor(
    model: &Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
) -> Result<u8, EstimateError> {
    let enabled = enabled(model, component, state, commands)?;
    Ok(enabled.map_or_else(|| state.mode(component), |choice| choice.nominal))
}

/// The choice whose guard is true in `state` under `commands`; `None` if no guard is.
fn enabled<'model>(
    model: &'model Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
) -> Result<Option<&'model Choice>, EstimateError> {
    let Some(mode) = mode_of(model, component, state) else { return Ok(None) };
    let mut enabled: Option<&Choice> = None;
    for choice in &mode.choices {
        if !is_entailed(model, &choice.guard, state, commands) {
            continue;
        }
        match enabled {
            None => enabled = Some(choice),
            Some(first) if first.differs(choice) => {
                return Err(EstimateError::Ambiguous {
                    component: model
                        .component(component)
                        .map(|data| data.name.to_string())
                        .unwrap_or_default(),
                    from: mode.name.to_string(),
                    first: model.mode_name(component, first.nominal).to_owned(),
                    second: model.mode_name(component, choice.nominal).to_owned(),
                });
            }
            Some(_) => {}
        }
    }
    Ok(enabled)
}

fn mode_of<'model>(model: &'model Model, component: ComponentId, state: &State) -> Option<&'model Mode> {
    model.component(component)?.modes.get(state.mode(component) as usize)
}

impl Choice {
    /// Returns whether another choice of the same mode leads elsewhere, or with other probabilities.
    pub(crate) fn differs(&self, other: &Self) -> bool {
        let is_same = |left: &(u8, u64)| {
            other.outcomes.iter().any(|right| {
                let scaled = |weight: u64, denominator: u64| u128::from(weight) * u128::from(denominator);
                left.0 == right.0 && scaled(left.1, other.denominator) == scaled(right.1, self.denominator)
            })
        };
        self.outcomes.len() != other.outcomes.len() || !self.outcomes.iter().all(is_same)
    }
}

/// The modes that a component may enter without a fault.
pub fn intended(
    model: &Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
) -> Result<ValueSet, EstimateError> {
    let enabled = enabled(model, component, state, commands)?;
    Ok(enabled.map_or_else(
        || ValueSet::one(state.mode(component)),
        |choice| choice.outcomes.iter().map(|(to, _)| *to).collect(),
    ))
}

/// All components' nominal targets.
pub fn nominal(model: &Model, state: &State, commands: &Commands) -> Result<State, EstimateError> {
    model
        .component_ids()
        .map(|component| successor(model, component, state, commands))
        .collect::<Result<Vec<u8>, _>>()
        .map(State)
}

/// The modes that a component may enter, each with its numerator over the returned denominator; zero numerators left out.
pub(crate) fn distribution(
    model: &Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
) -> Result<(Vec<(u8, u64)>, u64), EstimateError> {
    let mut weights = Vec::new();
    let denominator = distribute(model, component, state, commands, &mut weights)?;
    Ok((weights, denominator))
}

/// The same, with the modes added to `into`.
fn distribute(
    model: &Model,
    component: ComponentId,
    state: &State,
    commands: &Commands,
    into: &mut Vec<(u8, u64)>,
) -> Result<u64, EstimateError> {
    let choice = enabled(model, component, state, commands)?;
    let stay = [(state.mode(component), 1)];
    let (outcomes, scale) =
        choice.map_or((&stay[..], 1), |choice| (choice.outcomes.as_slice(), choice.denominator));
    let Some(mode) = mode_of(model, component, state).filter(|mode| !mode.faults.is_empty()) else {
        into.extend_from_slice(outcomes);
        return Ok(scale);
    };
    let start = into.len();
    into.extend_from_slice(outcomes);
    let mut faulty = 0;
    for fault in &mode.faults {
        if !is_entailed(model, &fault.guard, state, commands) {
            continue;
        }
        faulty += fault.numerator;
        match into[start + outcomes.len()..].iter_mut().find(|(to, _)| *to == fault.to) {
            Some((_, weight)) => *weight += fault.numerator * scale,
            None => into.push((fault.to, fault.numerator * scale)),
        }
    }
    // Outcomes share what the faults leave.
    for (_, weight) in &mut into[start..start + outcomes.len()] {
        *weight *= mode.denominator.saturating_sub(faulty);
    }
    join(into, start);
    Ok(mode.denominator * scale)
}

/// Joins the weights of each mode, and removes modes without weight.
fn join(into: &mut Vec<(u8, u64)>, start: usize) {
    let mut kept = start;
    for at in start..into.len() {
        let (to, weight) = into[at];
        if let Some((_, known)) = into[start..kept].iter_mut().find(|(known, _)| *known == to) {
            *known += weight;
        } else if weight > 0 {
            into[kept] = (to, weight);
            kept += 1;
        }
    }
    into.truncate(kept);
}

/// Where components may go next from each of some states, over denominators that the states have in common.
pub(crate) struct Choices {
    components: usize,
    /// By state, then component, where its choices start and end; what is the same is in the same place.
    ranges: Vec<(u32, u32)>,
    /// Modes with their weights.
    weights: Vec<(u8, u64)>,
}

impl Choices {
    /// The modes that a component may enter from a state, each with its weight.
    pub(crate) fn of(&self, state: usize, component: usize) -> &[(u8, u64)] {
        let range = self.ranges.get(state * self.components + component);
        range.map_or(&[], |(start, end)| &self.weights[*start as usize..*end as usize])
    }

    /// Returns whether a component may do from a state just what it may do from the one before.
    pub(crate) fn is_repeated(&self, state: usize, component: usize) -> bool {
        let at = state * self.components + component;
        at.checked_sub(self.components).is_some_and(|before| self.ranges[at] == self.ranges[before])
    }

    /// Returns how many components there are.
    pub(crate) const fn components(&self) -> usize {
        self.components
    }
}

/// The distributions of all components over denominators that are common to all `states`.
pub(crate) fn distributions(
    model: &Model,
    states: &[&State],
    commands: &Commands,
) -> Result<Choices, EstimateError> {
    let components = model.components.len();
    let mut ranges: Vec<(u32, u32)> = Vec::with_capacity(states.len() * components);
    let mut weights = Vec::with_capacity(4 * components);
    // Per component and range, the denominator of its weights.
    let mut denominators = Vec::with_capacity(2 * components);
    let mut common = vec![1_u64; components];
    for (row, state) in states.iter().enumerate() {
        for (component, common) in model.component_ids().zip(&mut common) {
            let mode = state.mode(component);
            // States that are believed at once differ in few components.
            if row > 0 && states[row - 1].mode(component) == mode && model.is_led_by_commands(component, mode)
            {
                ranges.push(ranges[ranges.len() - components]);
                continue;
            }
            let start = weights.len() as u32;
            let denominator = distribute(model, component, state, commands, &mut weights)?;
            ranges.push((start, weights.len() as u32));
            denominators.push((component.0 as usize, start, denominator));
            if *common != denominator {
                *common = lcm(*common, denominator);
            }
        }
    }
    let mut end = weights.len();
    for (component, start, denominator) in denominators.into_iter().rev() {
        let scale = common[component] / denominator;
        if scale > 1 {
            weights[start as usize..end].iter_mut().for_each(|(_, weight)| *weight *= scale);
        }
        end = start as usize;
    }
    Ok(Choices { components, ranges, weights })
}

/// Per component the modes in which only commands decide where it goes; called once per model.
pub(crate) fn led_by_commands(model: &Model) -> Vec<ValueSet> {
    let asks_only_commands = |mode: &Mode| {
        let mut result = true;
        for guard in mode.guards() {
            guard.symbols(&mut |symbol| result &= model.symbol_command(symbol).is_some());
        }
        result
    };
    let modes_of = |component: &Component| {
        let modes = (0..=u8::MAX).zip(&component.modes).filter(|(_, mode)| asks_only_commands(mode));
        modes.map(|(at, _)| at).collect()
    };
    model.components.iter().map(modes_of).collect()
}

/// Returns whether a guard is true whatever the state and the commands leave open.
pub(crate) fn is_entailed(model: &Model, guard: &Formula, state: &State, commands: &Commands) -> bool {
    match direct(model, guard, state, commands) {
        Truth::True => true,
        Truth::False => false,
        Truth::Open => is_entailed_with(model, guard, state, commands),
    }
}

fn direct(model: &Model, guard: &Formula, state: &State, commands: &Commands) -> Truth {
    let joined = |parts: &[Formula], deciding: Truth, neutral: Truth| {
        let mut result = neutral;
        for part in parts {
            match direct(model, part, state, commands) {
                truth if truth == deciding => return deciding,
                Truth::Open => result = Truth::Open,
                _ => {}
            }
        }
        result
    };
    match guard {
        Formula::Constant(value) => {
            if *value {
                Truth::True
            } else {
                Truth::False
            }
        }
        Formula::Member { symbol, set } => {
            let at = *symbol as usize;
            let value = match state.0.get(at) {
                Some(mode) => Some(*mode),
                None => model
                    .symbol_command(*symbol)
                    .map(|CommandVariableId(command)| commands.0.get(command as usize).copied().unwrap_or(0)),
            };
            match value {
                Some(value) if set.contains(value) => Truth::True,
                Some(_) => Truth::False,
                None => Truth::Open,
            }
        }
        Formula::All(parts) => joined(parts, Truth::False, Truth::True),
        Formula::Any(parts) => joined(parts, Truth::True, Truth::False),
    }
}

/// For guards over plant variables: no way to hold the modes without the guard.
fn is_entailed_with(model: &Model, guard: &Formula, state: &State, commands: &Commands) -> bool {
    let mut start = Domains::observed(model, &Observation::default());
    for (at, &command) in commands.0.iter().enumerate() {
        let symbol = model.command_symbol(CommandVariableId(at as u32)) as usize;
        if let Some(set) = start.sets.get_mut(symbol) {
            *set &= ValueSet::one(command);
        }
    }
    for component in model.component_ids() {
        if let Some(set) = start.sets.get_mut(component.0 as usize) {
            *set = ValueSet::one(state.mode(component));
        }
    }
    is_entailed_by_search(model, guard, state, &start)
}
