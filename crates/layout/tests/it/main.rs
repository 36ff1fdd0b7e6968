//! The integration tests of `layout`, in one program: each module is about one thing.

mod automaton;
mod drawings;
mod fit;
mod lists;
mod network;
mod overlay;
mod plans;
mod recover;
mod threads;
mod timeline;
