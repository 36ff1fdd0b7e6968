//! The variables of a network that is being read, and the literals that its file prints.

use crate::network::{Literal, ValueId, ValueSet, Variable, VariableId};

/// Variables and values, complete or still collecting.
pub struct Vocabulary {
    /// Whether the document declares its variables, so that only their values count.
    pub is_complete: bool,
    /// Those declared, or those met so far.
    pub variables: Vec<Variable>,
}

impl Vocabulary {
    /// The literal of a printed condition: `X`, `X=V`, `X in {V, W}`, and `not(…)` of these.
    pub fn literal(&mut self, text: &str) -> Option<Literal> {
        let (positive, is_negated) = match text.strip_prefix("not(").and_then(|inner| inner.strip_suffix(')'))
        {
            Some(inner) => (inner, true),
            None => (text, false),
        };
        let several = positive.strip_suffix('}').and_then(|inner| inner.split_once(" in {"));
        let (name, values) = match (several, positive.split_once('=')) {
            (Some((name, values)), _) => (name, values.split(", ").collect()),
            (None, Some((name, value))) => (name, vec![value]),
            (None, None) => (positive, Vec::new()),
        };
        if name.is_empty() || values.contains(&"") {
            return None;
        }
        let index = self.variable(name, values.is_empty())?;
        let values = if values.is_empty() { vec!["true"] } else { values };
        self.literal_of(index, &values, is_negated)
    }

    /// The literal of a variable of this name with one of these values.
    pub fn one_of(&mut self, name: &str, values: &[&str]) -> Option<Literal> {
        let index = self.variable(name, false)?;
        self.literal_of(index, values, false)
    }

    fn literal_of(&mut self, index: usize, values: &[&str], is_negated: bool) -> Option<Literal> {
        let variable = &mut self.variables[index];
        let mut listed = Vec::new();
        for &value in values {
            let position = match variable.values.iter().position(|known| known == value) {
                Some(position) => position,
                None if self.is_complete || variable.closed => return None,
                None => {
                    variable.values.push(value.into());
                    variable.values.len() - 1
                }
            };
            listed.push(ValueId::from_index(position));
        }
        listed.sort_unstable();
        listed.dedup();
        let values = match (is_negated, variable.closed) {
            (false, _) => ValueSet::In(listed),
            (true, false) => ValueSet::NotIn(listed),
            (true, true) => {
                let all = (0..variable.values.len()).map(ValueId::from_index);
                ValueSet::In(all.filter(|other| !listed.contains(other)).collect())
            }
        };
        Some(Literal { variable: VariableId::from_index(index), values })
    }

    /// The variable of that name. Without declarations an atom is Boolean, and a compared variable is open.
    fn variable(&mut self, name: &str, is_atom: bool) -> Option<usize> {
        let known = self.variables.iter().position(|variable| variable.name == name);
        if known.is_some() || self.is_complete {
            return known;
        }
        let values = if is_atom { vec!["true".into(), "false".into()] } else { Vec::new() };
        self.variables.push(Variable { name: name.into(), values, closed: is_atom, is_lasting: false });
        Some(self.variables.len() - 1)
    }
}
