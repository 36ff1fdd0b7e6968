//! What is known of the plant in one step: a value, or nothing, for each variable.

use crate::vocabulary::VariableId;

/// Stands for "not known".
pub(crate) const UNKNOWN: u32 = u32::MAX;

/// A partial assignment to the variables of one automaton.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Estimate {
    values: Vec<u32>,
}

impl Estimate {
    /// Knows nothing about `variables` variables.
    pub fn unknown(variables: usize) -> Self {
        Self { values: vec![UNKNOWN; variables] }
    }

    /// The number of the variable's value, if it is known.
    pub fn value(&self, variable: VariableId) -> Option<u32> {
        self.values.get(variable.0 as usize).copied().filter(|&value| value != UNKNOWN)
    }

    /// Sets or forgets a variable's value.
    pub fn set(&mut self, variable: VariableId, value: Option<u32>) {
        if let Some(slot) = self.values.get_mut(variable.0 as usize) {
            *slot = value.unwrap_or(UNKNOWN);
        }
    }

    pub(crate) fn values(&self) -> &[u32] {
        &self.values
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.values.clone_from(&other.values);
    }
}
