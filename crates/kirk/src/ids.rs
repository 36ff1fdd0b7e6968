//! The ids of what the planner numbers by itself; what the network numbers has the ids of `tpn`.
//!
//! Each is the position in one [`typed_index_collections::TiVec`], and one more than that in memory, so that an optional
//! id takes no more room than an id.

use std::num::NonZeroU32;

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub(crate) struct $name(NonZeroU32);

        impl From<usize> for $name {
            fn from(index: usize) -> Self {
                Self(NonZeroU32::MIN.saturating_add(index as u32))
            }
        }

        impl From<$name> for usize {
            fn from(id: $name) -> Self {
                id.0.get() as Self - 1
            }
        }
    )*};
}

ids! {
    /// A literal among the distinct ones of its variable.
    LiteralId;
    /// A choice point of the solver.
    ChoicePointId;
    /// A clause of the solver, from the problem or learned.
    ClauseId;
    /// A difference constraint of the solver.
    DifferenceId;
    /// A relaxation of an open choice in the solver.
    CommonBoundId;
    /// A weighted sum of the solver.
    LinearId;
    /// A set of intervals of the solver that exclude each other.
    ExclusionId;
    /// A resource of the solver that several tasks share at a time.
    CumulativeId;
    /// The movements of a vehicle that the solver orders.
    TourId;
    /// A tightening of a bound on the solver's trail.
    EventId;
    /// A reason that was noted on the solver's trail.
    NoteId;
    /// A negative cycle of the solver's difference constraints.
    CycleId;
    /// What a conclusion of the solver was drawn from.
    DerivationId;
    /// A state of a best-first search.
    StateId;
}
