//! Simple temporal networks with uncertainty (STNUs) over exact integer time: dynamic and strong controllability,
//! incrementally and with undo; conflicts and relaxations as explanations; the dispatchable form with waits and its
//! dispatcher; the environment as an adversary; files; generators.
//!
//! Some durations are *contingent*: the environment chooses them within their ranges, and the executive sees when they
//! end. A network is *dynamically controllable* if the executive can choose the other times as it goes, reacting at
//! once, so that every constraint holds whatever the environment chooses (Morris, Muscettola and Vidal, 2001; Morris,
//! 2014). Nothing here knows about plans. Arithmetic is checked: what does not fit into 64 bits is [`Undecided::Overflow`], never wrapped.

pub mod adversary;
mod checker;
mod conflict;
mod dispatchable;
mod dispatcher;
mod format;
pub mod generate;
mod graph;
mod network;
mod reduction;
mod relaxation;
mod strong;

pub use checker::{Checker, Checkpoint, Refusal, Stop, Undecided, Verdict, check};
pub use conflict::{Conflict, MAX_STEPS, Member, Part, Step, conflict_among, minimal, part_edge};
pub use dispatchable::{Dispatchable, Wait};
pub use dispatcher::{DispatchError, Dispatcher, Status, Window};
pub use format::{Document, Layout, ParseError};
pub use network::{Edge, EdgeId, Link, LinkError, LinkId, Network, NetworkSize, PointId};
pub use relaxation::{Relaxation, relax, relaxations};
pub use strong::{StrongVerdict, check_strong};
