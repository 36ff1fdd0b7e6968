//! The integration tests of `workbench`, in one program: each module is about one thing.

mod board;
mod commands;
mod counters;
mod course;
mod derived;
mod diagnosing;
mod editing;
mod edits;
mod effects;
mod esterel;
mod files;
mod gallery;
mod key_sentences;
mod key_steps;
mod library;
mod manual;
mod opening;
mod path_race;
mod session;
mod transport;
mod truth;
mod wrong_attempts;
