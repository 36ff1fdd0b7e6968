//! The built page in headless Chromium: real keys, clicks and wheel, and a look at what is drawn.
//!
//! Every test starts a browser of its own, one after the other: software rendering leaves no processor for a second.
//! Nothing waits for a time to pass; everything waits for the page to say that it is so.

mod opened;

mod accessibility;
mod api;
mod attack;
mod automaton;
mod board;
mod disk;
mod drawing;
mod editing;
mod execution;
mod failure;
mod firefox;
mod foreign_maps;
mod keeping;
mod language;
mod lesson;
mod network_file;
mod offline;
mod report;
mod same;
mod search;
mod terrain;
mod timeline;
