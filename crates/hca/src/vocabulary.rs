//! The variables that an automaton's conditions speak of, and the values that they can have.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use smol_str::SmolStr;

/// Which variables there are before a program is compiled.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Vocabulary {
    /// Variables whose values are all known. Other variables have open domains: the values that the program writes,
    /// and at least one more.
    pub domains: BTreeMap<SmolStr, Vec<SmolStr>>,
    /// Variables that only the program itself sets: asserting one makes it true for the step and no longer (SPEC 8.2).
    pub program_variables: BTreeSet<SmolStr>,
}

/// Index of a variable in its automaton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct VariableId(pub u32);

/// A variable of an automaton.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Variable {
    /// What it is called.
    pub name: SmolStr,
    /// Its values; the index is the value's number.
    pub values: Vec<SmolStr>,
    /// Whether it has no other values than these. An open domain has one more value number, for all others.
    pub closed: bool,
    /// Whether only the program sets it.
    pub is_program_variable: bool,
}

impl Variable {
    /// Returns how many value numbers there are.
    pub const fn value_count(&self) -> u32 {
        self.values.len() as u32 + if self.closed { 0 } else { 1 }
    }

    /// The number of `value`; an open domain counts unknown values as the one number after its known ones.
    pub fn value_number(&self, value: &str) -> Option<u32> {
        let known = self.values.iter().position(|known| known == value).map(|at| at as u32);
        known.or_else(|| (!self.closed).then_some(self.values.len() as u32))
    }
}
