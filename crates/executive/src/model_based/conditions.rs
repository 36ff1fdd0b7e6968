//! What a program asks of its plant, as conditions over the plant's modes and variables (SPEC 8.3, SPEC3 17.4).

use hca::{Automaton, VariableId as ProgramVariableId};
use plant::{Formula, Model};
use rmpl::control::{Constraint, ConstraintKind, Name};

use super::system::Binding;

/// Of so many combinations of values of the program's own variables a condition is looked at; one that leaves more open is
/// not entailed.
const MAX_COMBINATIONS: usize = 4096;

/// What a program's variables represent, and what it sets of its own ones in a step.
pub(super) struct Asker<'program> {
    pub(super) automaton: &'program Automaton,
    pub(super) model: &'program Model,
    /// By number of the variable.
    pub(super) bindings: &'program [Binding],
    /// Values by number.
    pub(super) settings: Vec<(ProgramVariableId, u32)>,
}

impl Asker<'_> {
    /// Returns what the plant has to make true for a constraint to hold, whatever the program's own variables are that
    /// it does not set in this step.
    pub(super) fn condition(mut self, constraint: &Constraint) -> Formula {
        let mut open = Vec::new();
        self.open_variables(constraint, &mut open);
        let count = |id: &ProgramVariableId| {
            self.automaton.variables.get(id.0 as usize).map_or(0, |variable| variable.value_count() as usize)
        };
        let combinations = open.iter().map(count).fold(1, usize::saturating_mul);
        if combinations > MAX_COMBINATIONS {
            return Formula::Constant(false);
        }
        let counts: Vec<usize> = open.iter().map(count).collect();
        let set = self.settings.len();
        let each = (0..combinations).map(|number| {
            self.settings.truncate(set);
            let mut rest = number;
            for (id, count) in open.iter().zip(&counts) {
                self.settings.push((*id, (rest % count) as u32));
                rest /= count;
            }
            self.formula(constraint)
        });
        Formula::All(each.collect())
    }

    /// The program's own variables of a constraint that it does not set.
    fn open_variables(&self, constraint: &Constraint, into: &mut Vec<ProgramVariableId>) {
        match &constraint.kind {
            ConstraintKind::Not(inner) => self.open_variables(inner, into),
            ConstraintKind::And(parts) | ConstraintKind::Or(parts) => {
                for part in parts {
                    self.open_variables(part, into);
                }
            }
            ConstraintKind::Equals { variable, .. } => {
                if let Some((id, Binding::Program)) = self.binding(variable)
                    && !into.contains(&id)
                    && self.setting(id).is_none()
                {
                    into.push(id);
                }
            }
            _ => {}
        }
    }

    fn binding(&self, variable: &Name) -> Option<(ProgramVariableId, Binding)> {
        let id = self.automaton.variable(&variable.text)?;
        Some((id, *self.bindings.get(id.0 as usize)?))
    }

    /// The value of a variable of the program's own; of several the one that was set last.
    fn setting(&self, id: ProgramVariableId) -> Option<u32> {
        self.settings.iter().rev().find(|(known, _)| *known == id).map(|(_, value)| *value)
    }

    fn formula(&self, constraint: &Constraint) -> Formula {
        let all = |parts: &[Constraint]| parts.iter().map(|part| self.formula(part)).collect();
        match &constraint.kind {
            ConstraintKind::True => Formula::Constant(true),
            ConstraintKind::False | ConstraintKind::Parameter(_) | ConstraintKind::Unreadable => {
                Formula::Constant(false)
            }
            ConstraintKind::Not(inner) => self.model.opposite(self.formula(inner)),
            ConstraintKind::And(parts) => Formula::All(all(parts)),
            ConstraintKind::Or(parts) => Formula::Any(all(parts)),
            ConstraintKind::Equals { variable, value } => {
                self.equality(variable, value).unwrap_or(Formula::Constant(false))
            }
        }
    }

    fn equality(&self, variable: &Name, value: &Name) -> Option<Formula> {
        let (id, binding) = self.binding(variable)?;
        Some(match binding {
            Binding::Mode(component) => {
                Model::mode_is(component, self.model.mode_named(component, &value.text)?)
            }
            Binding::Plant(plant) => {
                let values = &self.model.variables.get(plant.0 as usize)?.values;
                self.model.value_is(plant, values.iter().position(|known| *known == value.text)? as u8)
            }
            Binding::Program => {
                let number = self.automaton.variables.get(id.0 as usize)?.value_number(&value.text)?;
                Formula::Constant(self.setting(id) == Some(number))
            }
        })
    }
}
