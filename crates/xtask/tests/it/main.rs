//! The integration tests of `xtask`, in one program: each module is about one thing.

mod citations;
mod commands;
mod cycles;
mod documentation;
mod names;
mod policy;
mod releases;
mod repository;
mod spelling;
mod wording;
