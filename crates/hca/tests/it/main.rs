//! The integration tests of `hca`, in one program: each module is about one thing.

mod conformance;
mod equality;
mod esterel;
mod interpreter;
mod timed;
