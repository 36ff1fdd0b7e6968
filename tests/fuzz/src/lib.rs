//! Everything that reads other people's data, attacked with mutated inputs.
//!
//! A [`Reader`](readers::Reader) has seeds, which are files of its kind, and exercises whatever bytes it is given: it may
//! refuse them, and must not panic, hang, or break what it promises. What an input led to is told by a signature, and
//! an input with a new one is mutated further. Inputs that once broke something are kept in `broken/` and come first in
//! each run.

pub mod attack;
pub mod mutation;
pub mod readers;
