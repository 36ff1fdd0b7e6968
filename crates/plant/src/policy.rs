//! Precompiled reactive policies: for every component and pair of modes, what to do first (SPEC 9.2).

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::belief::State;
use crate::consistency::Assumed;
use crate::domains::Domains;
use crate::model::{CommandVariableId, Commands, ComponentId, Model, Observation};
use crate::order::CausalOrder;
use crate::successor::successor;
use crate::value_set::ValueSet;

/// A guard with more alternatives than this is not planned with.
const MAX_ALTERNATIVES: usize = 256;

/// One way to take a transition: the commands to give while the conditions hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedStep {
    /// The mode entered.
    pub to: u8,
    /// Command variables and the values that will do.
    pub commands: Vec<(CommandVariableId, ValueSet)>,
    /// Other components and the modes that will do.
    pub conditions: Vec<(ComponentId, ValueSet)>,
}

/// The policies of a model, and its causal order.
#[derive(Clone, Debug)]
pub struct Planner {
    pub(crate) model: Arc<Model>,
    pub(crate) order: CausalOrder,
    /// Per component and mode, the ways to leave it.
    pub(crate) steps: Vec<Vec<Vec<PlannedStep>>>,
    /// Per component, mode and target mode, the first step of a shortest path, as an index into `steps`.
    policy: Vec<Vec<Vec<Option<u32>>>>,
    /// Whether `steps` holds every way there is; then what it cannot reach is unreachable.
    pub(crate) is_complete: bool,
    /// Per component, others that its guards may hang on although no mode of one component alone makes them true.
    joint_causes: Vec<Vec<ComponentId>>,
}

impl Planner {
    /// Compiles the policies; takes time in proportion to components times squared modes.
    pub fn new(model: &Arc<Model>) -> Self {
        let mut is_complete = true;
        let mut joint_causes = vec![Vec::new(); model.components.len()];
        let steps: Vec<Vec<Vec<PlannedStep>>> = model
            .component_ids()
            .zip(&mut joint_causes)
            .map(|(component, joint)| {
                let steps = steps_of(model, component, &mut is_complete, joint);
                joint.sort_unstable();
                joint.dedup();
                steps
            })
            .collect();
        let all = |_: &PlannedStep| true;
        let policy = steps
            .iter()
            .map(|modes| (0..=u8::MAX).zip(modes).map(|(from, _)| first_steps(modes, from, &all)).collect())
            .collect();
        let (order, model) = (CausalOrder::new(model), Arc::clone(model));
        Self { model, order, steps, policy, is_complete, joint_causes }
    }

    /// A component and all others that may have to move before it can, in their order.
    pub(crate) fn upstream(&self, component: ComponentId) -> Vec<ComponentId> {
        let mut found = vec![component];
        let mut at = 0;
        while let Some(next) = found.get(at).map(|component| component.0 as usize) {
            at += 1;
            let causes = self.order.causes.get(next).into_iter().chain(self.joint_causes.get(next)).flatten();
            for cause in causes {
                if !found.contains(cause) {
                    found.push(*cause);
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// The causal order that the policies follow.
    pub const fn order(&self) -> &CausalOrder {
        &self.order
    }

    /// The model that the policies are for.
    pub const fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The components that may take commands when these ones are brought into other modes: what their transitions ask of
    /// others has to be brought about first.
    pub fn commanded_for(&self, components: impl IntoIterator<Item = ComponentId>) -> BTreeSet<ComponentId> {
        let mut commanded = BTreeSet::new();
        let mut open: Vec<ComponentId> = components.into_iter().collect();
        while let Some(component) = open.pop() {
            if !commanded.insert(component) {
                continue;
            }
            let steps = self.steps.get(component.0 as usize).into_iter().flatten().flatten();
            for step in steps {
                let command = |&(id, _): &(CommandVariableId, ValueSet)| {
                    self.model.command_variables.get(id.0 as usize).map(|command| command.component)
                };
                open.extend(step.commands.iter().filter_map(command));
                open.extend(step.conditions.iter().map(|&(other, _)| other));
            }
            open.extend(self.joint_causes.get(component.0 as usize).into_iter().flatten());
        }
        commanded
    }

    /// The first step of a shortest path of a component from one mode to another, were all conditions to hold.
    pub fn policy(&self, component: ComponentId, from: u8, to: u8) -> Option<&PlannedStep> {
        let at = component.0 as usize;
        let step = (*self.policy.get(at)?.get(from as usize)?.get(to as usize)?)?;
        self.steps.get(at)?.get(from as usize)?.get(step as usize)
    }

    /// The modes of a variable's component that by themselves keep the variable within a set of values.
    pub fn modes_ensuring(&self, variable: crate::VariableId, set: ValueSet) -> (ComponentId, ValueSet) {
        let owner =
            self.model.variables.get(variable.0 as usize).map_or(ComponentId(0), |data| data.component);
        (owner, ensuring(&self.model, owner, self.model.variable_symbol(variable), set))
    }

    /// Returns whether a goal is in reach as far as its component and what it depends on tell.
    pub fn may_reach(&self, state: &State, goal: &crate::Goal) -> bool {
        self.reach(state)
            .get(goal.component.0 as usize)
            .is_some_and(|reach| !(*reach & goal.modes).is_empty())
    }

    /// For every component the modes it can get to if everything it depends on is as helpful as it can be.
    pub(crate) fn reach(&self, state: &State) -> Vec<ValueSet> {
        let mut reach: Vec<ValueSet> =
            self.model.component_ids().map(|id| ValueSet::one(state.mode(id))).collect();
        let mut order: Vec<usize> = (0..reach.len()).collect();
        // Causes first, so that one round is enough where there is no cycle.
        order.sort_by_key(|&at| std::cmp::Reverse(self.order.numbers[at]));
        loop {
            let before = reach.clone();
            for &at in &order {
                let mut grown = reach[at];
                loop {
                    let mut more = grown;
                    for from in grown.values() {
                        for step in self.steps[at].get(from as usize).into_iter().flatten() {
                            if is_feasible(step, &reach) {
                                more |= ValueSet::one(step.to);
                            }
                        }
                    }
                    if more == grown {
                        break;
                    }
                    grown = more;
                }
                reach[at] = grown;
            }
            if !self.order.is_cyclic || reach == before {
                return reach;
            }
        }
    }

    /// The first step of a component toward any of `goal`, over steps whose conditions can be brought about.
    pub(crate) fn toward(
        &self,
        component: ComponentId,
        from: u8,
        goal: ValueSet,
        reach: &[ValueSet],
    ) -> Option<&PlannedStep> {
        let modes = self.steps.get(component.0 as usize)?;
        if let Some(only) = goal.only()
            && self.follows_policy(component, from, only, reach)
        {
            return self.policy(component, from, only);
        }
        let first = first_step(modes, from, goal, &|step| is_feasible(step, reach))?;
        modes.get(from as usize)?.get(first as usize)
    }

    /// Returns whether the precompiled path can be taken as things are.
    fn follows_policy(&self, component: ComponentId, mut from: u8, to: u8, reach: &[ValueSet]) -> bool {
        for _ in 0..ValueSet::MOST {
            if from == to {
                return true;
            }
            match self.policy(component, from, to) {
                Some(step) if is_feasible(step, reach) => from = step.to,
                _ => return false,
            }
        }
        false
    }

    /// Commands that make a component take a step now, all others idle; `None` if no values do.
    pub(crate) fn commands_for(
        &self,
        component: ComponentId,
        step: &PlannedStep,
        state: &State,
    ) -> Option<Commands> {
        let mut commands = self.model.idle();
        for (variable, set) in &step.commands {
            *commands.0.get_mut(variable.0 as usize)? = set.values().next()?;
        }
        let does = |commands: &Commands| successor(&self.model, component, state, commands) == Ok(step.to);
        if does(&commands) {
            return Some(commands);
        }
        for (variable, set) in &step.commands {
            for value in set.values() {
                let mut other = commands.clone();
                *other.0.get_mut(variable.0 as usize)? = value;
                if does(&other) {
                    return Some(other);
                }
            }
        }
        None
    }
}

fn is_feasible(step: &PlannedStep, reach: &[ValueSet]) -> bool {
    step.conditions
        .iter()
        .all(|(cause, modes)| reach.get(cause.0 as usize).is_some_and(|reach| !(*reach & *modes).is_empty()))
}

/// The first step of a shortest path from a mode to any of `goal`.
fn first_step(
    modes: &[Vec<PlannedStep>],
    from: u8,
    goal: ValueSet,
    usable: &dyn Fn(&PlannedStep) -> bool,
) -> Option<u32> {
    let mut found = None;
    visit_reached(modes, from, usable, &mut |mode, first| {
        let is_goal = goal.contains(mode);
        found = if is_goal { first } else { None };
        !is_goal
    });
    found
}

/// For each mode, the first step of a shortest path there.
fn first_steps(
    modes: &[Vec<PlannedStep>],
    from: u8,
    usable: &dyn Fn(&PlannedStep) -> bool,
) -> Vec<Option<u32>> {
    let mut steps = vec![None; modes.len()];
    visit_reached(modes, from, usable, &mut |mode, first| {
        if let Some(step) = steps.get_mut(usize::from(mode)) {
            *step = first;
        }
        true
    });
    steps
}

/// Breadth first over a component's own modes, until `visit` returns false; ties go to the transition declared first.
fn visit_reached(
    modes: &[Vec<PlannedStep>],
    from: u8,
    usable: &dyn Fn(&PlannedStep) -> bool,
    visit: &mut dyn FnMut(u8, Option<u32>) -> bool,
) {
    let mut seen = ValueSet::one(from);
    let mut waiting: Vec<(u8, Option<u32>)> = vec![(from, None)];
    let mut at = 0;
    while let Some(&(mode, first)) = waiting.get(at) {
        at += 1;
        if !visit(mode, first) {
            return;
        }
        for (number, step) in modes.get(mode as usize).into_iter().flatten().enumerate() {
            if !seen.contains(step.to) && usable(step) {
                seen |= ValueSet::one(step.to);
                waiting.push((step.to, first.or(Some(number as u32))));
            }
        }
    }
}

/// The ways to leave each mode of a component. Where an alternative of a guard needs modes of several components together,
/// these are added to `joint`: whole states have to be searched for it.
fn steps_of(
    model: &Model,
    component: ComponentId,
    is_complete: &mut bool,
    joint: &mut Vec<ComponentId>,
) -> Vec<Vec<PlannedStep>> {
    let modes = model.component(component).map_or(&[][..], |data| data.modes.as_slice());
    let leave = |(from, mode): (usize, &crate::Mode)| {
        let mut steps = Vec::new();
        for choice in mode.choices.iter().filter(|choice| choice.nominal as usize != from) {
            let Some(alternatives) = choice.guard.alternatives(MAX_ALTERNATIVES) else {
                *is_complete = false;
                continue;
            };
            for alternative in alternatives {
                match planned(model, component, from as u8, choice.nominal, &alternative, is_complete) {
                    Some(step) if steps.contains(&step) => {}
                    Some(step) => steps.push(step),
                    None => joint.extend(components_behind(model, &alternative)),
                }
            }
        }
        steps
    };
    modes.iter().enumerate().map(leave).collect()
}

fn planned(
    model: &Model,
    component: ComponentId,
    from: u8,
    to: u8,
    alternative: &[(u32, ValueSet)],
    is_complete: &mut bool,
) -> Option<PlannedStep> {
    let mut step = PlannedStep { to, commands: Vec::new(), conditions: Vec::new() };
    for &(symbol, set) in alternative {
        let (owner, modes) = if let Some(command) = model.symbol_command(symbol) {
            step.commands.push((command, set));
            continue;
        } else if let Some(variable) = model.symbol_variable(symbol) {
            // Other components may force the variable too; only what its own one ensures is planned with.
            *is_complete = false;
            let owner = model.variables.get(variable.0 as usize)?.component;
            (owner, ensuring(model, owner, symbol, set))
        } else {
            (ComponentId(symbol), set)
        };
        if owner == component {
            if !modes.contains(from) {
                return None;
            }
        } else {
            match step.conditions.iter_mut().find(|(known, _)| *known == owner) {
                Some((_, known)) => *known &= modes,
                None => step.conditions.push((owner, modes)),
            }
        }
    }
    step.conditions.iter().all(|(_, modes)| !modes.is_empty()).then_some(step)
}

/// The components whose modes together may decide the variables of a guard's alternative.
fn components_behind<'model>(
    model: &'model Model,
    alternative: &'model [(u32, ValueSet)],
) -> impl Iterator<Item = ComponentId> + 'model {
    let variables = alternative.iter().filter_map(|(symbol, _)| model.symbol_variable(*symbol));
    let islands = variables.filter_map(|variable| {
        model.islands.iter().find(|island| island.variables.binary_search(&variable).is_ok())
    });
    islands.flat_map(|island| island.components.iter().copied())
}

/// The modes of a component that by themselves keep a symbol within a set.
fn ensuring(model: &Model, component: ComponentId, symbol: u32, set: ValueSet) -> ValueSet {
    let Some(island) = model.islands.iter().find(|island| island.components.contains(&component)) else {
        return ValueSet::EMPTY;
    };
    let modes = model.component(component).map_or(&[][..], |data| data.modes.as_slice());
    (0..=u8::MAX)
        .zip(modes)
        .map(|(mode, _)| mode)
        .filter(|mode| {
            let mut domains = Domains::observed(model, &Observation::default());
            let Some(domain) = domains.sets.get_mut(symbol as usize) else { return false };
            *domain &= !set;
            let is_empty = domain.is_empty();
            let alone = |other: &ComponentId| (*other == component).then_some(*mode);
            let assumed = Assumed { model, island, modes: island.components.iter().map(alone).collect() };
            is_empty || assumed.satisfy(&mut domains).is_err()
        })
        .collect()
}
