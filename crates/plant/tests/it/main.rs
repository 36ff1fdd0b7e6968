//! The integration tests of `plant`, in one program: each module is about one thing.

mod behavior;
mod bounded;
mod branches;
mod checks;
mod estimation;
mod hitting_sets;
mod knowledge;
mod misbehaving;
mod parts;
mod planning;
