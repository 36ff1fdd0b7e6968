//! The integration tests of `executive`, in one program: each module is about one thing.

mod entailment;
mod instants;
mod model_based;
mod pinned;
mod progress;
mod proof;
mod rewards;
mod runs;
mod states;
mod strategy;
mod uncertain;
