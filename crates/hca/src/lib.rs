//! Hierarchical constraint automata: compilation from control programs, stepping, trace (SPEC 8).
//!
//! An [`Automaton`] is data that never changes; a [`Stepper`] holds a marking of it and takes steps from what is known
//! of the plant. Where that knowledge comes from is not this crate's business.

pub mod automaton;
pub mod clock;
pub mod compile;
pub mod condition;
pub mod dot;
mod equality;
pub mod knowledge;
pub mod locks;
pub mod marking;
mod spans;
pub mod step;
pub mod trace;
pub mod vocabulary;

pub use automaton::{
    Assertion, Automaton, Choice, ChosenBy, Composite, CompositeId, CompositeKind, Element, Location,
    LocationId, LocationKind, TestId, Transition, TransitionId,
};
pub use clock::{Clock, ClockId, ClockKind, HeldCondition};
pub use compile::{Compilation, compile, compile_text};
pub use knowledge::Estimate;
pub use locks::{Lock, LockId};
pub use marking::Marking;
pub use step::{Position, Standing, StepObserver, Stepper, Unobserved};
pub use trace::{Trace, TraceStep, trace};
pub use vocabulary::{Variable, VariableId, Vocabulary};
