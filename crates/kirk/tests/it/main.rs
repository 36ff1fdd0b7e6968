//! The integration tests of `kirk`, in one program: each module is about one thing.

mod conformance;
mod explanations;
mod families;
mod foreign;
mod instants;
mod planning_again;
mod replay;
mod searches;
mod support;
mod touching;
