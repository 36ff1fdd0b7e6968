//! Simple temporal networks (STNs) over exact integer time: incremental consistency with undo, negative cycles as
//! explanations, windows, distances, rigid components, the dispatchable form, and windows during execution.
//!
//! A constraint `to − from ≤ weight` is an edge `from → to` of the distance graph. Nothing here knows about plans.
//! Arithmetic is checked everywhere: what does not fit into 64 bits is reported as [`Inconsistency::Overflow`] or
//! [`Overflow`], never wrapped.

mod bulk;
mod dispatch;
mod distance;
mod elimination;
mod execution;
mod heap;
mod network;
mod pairs;
mod propagation;
mod unfolding;

pub use dispatch::{DispatchEdge, Dispatchable, RigidComponent, dispatchable, rigid_components};
pub use distance::{DistanceMatrix, INFINITE};
pub use execution::{Execution, ExecutionWindows, execution_windows};
pub use heap::Heap;
pub use network::{Checkpoint, CycleEdge, Inconsistency, Overflow, PointId, Stn, Tag, Window};
pub use pairs::PairDistances;
pub use unfolding::{Refusal, Unfolding};
