//! From asserted constraints to goals that the reactive planner takes.

use plant::{ComponentId, Goal, Model, Planner, State, ValueSet};
use rmpl::control::{Constraint, ConstraintKind};

/// A constraint with more goal configurations is pursued by its first ones only.
const MAX_CONFIGURATIONS: usize = 64;

/// The configurations of modes in which an asserted constraint holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct GoalConfigurations {
    /// Each a conjunction of goals; empty for a constraint that can never hold.
    configurations: Vec<Vec<Goal>>,
}

impl GoalConfigurations {
    /// The components that it speaks of.
    pub(super) fn components(&self) -> impl Iterator<Item = ComponentId> + '_ {
        self.configurations.iter().flatten().map(|goal| goal.component)
    }

    /// The goals to pursue from a state: of the configurations already reached, then of those in reach, the first.
    ///
    /// `None` for a constraint that can never hold.
    pub(super) fn goals(&self, planner: &Planner, state: &State) -> Option<&[Goal]> {
        let met = |configuration: &&Vec<Goal>| {
            configuration.iter().all(|goal| goal.modes.contains(state.mode(goal.component)))
        };
        let reachable =
            |configuration: &&Vec<Goal>| configuration.iter().all(|goal| planner.may_reach(state, goal));
        let configuration = match self.configurations.as_slice() {
            [only] => Some(only),
            configurations => configurations
                .iter()
                .find(met)
                .or_else(|| configurations.iter().find(reachable))
                .or(configurations.first()),
        };
        configuration.map(Vec::as_slice)
    }
}

/// Reads a constraint once, when the program is compiled.
pub(super) fn goal_configurations(planner: &Planner, constraint: &Constraint) -> GoalConfigurations {
    GoalConfigurations { configurations: configurations(planner.model(), planner, constraint, true) }
}

fn configurations(model: &Model, planner: &Planner, constraint: &Constraint, wanted: bool) -> Vec<Vec<Goal>> {
    match &constraint.kind {
        ConstraintKind::Not(inner) => configurations(model, planner, inner, !wanted),
        ConstraintKind::And(parts) if wanted => all(model, planner, parts, wanted),
        ConstraintKind::Or(parts) if !wanted => all(model, planner, parts, wanted),
        ConstraintKind::And(parts) | ConstraintKind::Or(parts) => parts
            .iter()
            .flat_map(|part| configurations(model, planner, part, wanted))
            .take(MAX_CONFIGURATIONS)
            .collect(),
        ConstraintKind::Equals { variable, value } => {
            let goal = if let Some(component) = model.component_named(&variable.text) {
                let modes = model.component(component).map_or(0, |data| data.modes.len());
                let set = model.mode_named(component, &value.text).map_or(ValueSet::EMPTY, ValueSet::one);
                Goal { component, modes: chosen(set, modes, wanted) }
            } else if let Some(id) = model.variable_named(&variable.text) {
                let values =
                    model.variables.get(id.0 as usize).map_or(&[][..], |data| data.values.as_slice());
                let at = values.iter().position(|known| *known == value.text);
                let set = at.map_or(ValueSet::EMPTY, |at| ValueSet::one(at as u8));
                let (component, modes) = planner.modes_ensuring(id, chosen(set, values.len(), wanted));
                Goal { component, modes }
            } else {
                // A variable of the program's own comes true by being asserted.
                return vec![Vec::new()];
            };
            if goal.modes.is_empty() { Vec::new() } else { vec![vec![goal]] }
        }
        ConstraintKind::True => {
            if wanted {
                vec![Vec::new()]
            } else {
                Vec::new()
            }
        }
        _ => {
            if wanted {
                Vec::new()
            } else {
                vec![Vec::new()]
            }
        }
    }
}

fn chosen(set: ValueSet, count: usize, wanted: bool) -> ValueSet {
    if wanted { set } else { ValueSet::first_values(count) & !set }
}

fn all(model: &Model, planner: &Planner, parts: &[Constraint], wanted: bool) -> Vec<Vec<Goal>> {
    let mut joined: Vec<Vec<Goal>> = vec![Vec::new()];
    for part in parts {
        let inner = configurations(model, planner, part, wanted);
        joined = joined
            .iter()
            .flat_map(|left| inner.iter().map(|right| left.iter().chain(right).copied().collect()))
            .take(MAX_CONFIGURATIONS)
            .collect();
    }
    joined
}
