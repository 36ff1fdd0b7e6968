//! The variables of a network that is being read, and the literals that its file prints.

use crate::network::{Literal, ValueId, ValueSet, Variable, VariableId};

/// Variables and values, complete or still collecting.
pub(crate) struct Vocabulary {
    /// Whether the document declares its variables, so that only their values count.
    pub(crate) is_complete: bool,
    /// The variables.
    pub(crate) variables: Vec<Variable>,
}

impl Vocabulary {
    /// The literal of a printed condition: `X`, `X=V`, `not(X)`, `not(X=V)`.
    pub(crate) fn literal(&mut self, text: &str) -> Option<Literal> {
        let (positive, is_negated) = match text.strip_prefix("not(").and_then(|inner| inner.strip_suffix(')'))
        {
            Some(inner) => (inner, true),
            None => (text, false),
        };
        let (name, value) =
            positive.split_once('=').map_or((positive, None), |(name, value)| (name, Some(value)));
        if name.is_empty() || value.is_some_and(str::is_empty) {
            return None;
        }
        let index = match self.variables.iter().position(|variable| variable.name == name) {
            Some(index) => index,
            None if self.is_complete => return None,
            None => {
                // Without declarations an atom is Boolean, and a compared variable is open.
                let is_atom = value.is_none();
                let values = if is_atom { vec!["true".into(), "false".into()] } else { Vec::new() };
                self.variables.push(Variable {
                    name: name.into(),
                    values,
                    closed: is_atom,
                    is_lasting: false,
                });
                self.variables.len() - 1
            }
        };
        let variable = &mut self.variables[index];
        let value = value.unwrap_or("true");
        let position = match variable.values.iter().position(|known| known == value) {
            Some(position) => position,
            None if self.is_complete || variable.closed => return None,
            None => {
                variable.values.push(value.into());
                variable.values.len() - 1
            }
        };
        let value = ValueId::from_index(position);
        let values = match (is_negated, variable.closed) {
            (false, _) => ValueSet::In(vec![value]),
            (true, false) => ValueSet::NotIn(vec![value]),
            (true, true) => {
                let all = (0..variable.values.len()).map(ValueId::from_index);
                ValueSet::In(all.filter(|&other| other != value).collect())
            }
        };
        Some(Literal { variable: VariableId::from_index(index), values })
    }
}
