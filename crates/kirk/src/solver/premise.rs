//! What the solver is told comes from, by which a refutation tells what it rests on.

use tpn::VariableId;

use crate::failure::Member;
use crate::ids::CycleId;

/// What something that the solver was told comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Premise {
    /// The structure of the program, which no reason contains.
    #[default]
    Structure,
    Member(Member),
    /// That conditions of a variable exclude each other, and how long they last.
    Variable(VariableId),
    /// What a resource has, and how long its uses last; by position.
    Resource(usize),
    /// The differences of a negative cycle.
    Cycle(CycleId),
    /// Nothing that has a name.
    Unknown,
}
