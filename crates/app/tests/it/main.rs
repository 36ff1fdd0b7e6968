//! The integration tests of `app`, in one program: each module is about one thing.

mod automaton;
mod desk;
mod drawing;
mod editor;
mod execution;
mod lesson;
mod lesson_keys;
mod missions;
mod network;
mod panels;
mod review;
mod search;
mod shell;
mod snapshots;
mod strategy;
mod support;
mod terrain;
mod timeline;
