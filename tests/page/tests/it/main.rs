//! The built page in headless Chromium: real keys, clicks and wheel, and a look at what is drawn.
//!
//! All tests share one browser, and each has a context of its own in it; those that need another browser start it.
//! Nothing waits for a time to pass; everything waits for the page to say that it is so. What only the state decides is
//! tested without a browser, in `workbench` and `app`.

mod opened;

mod accessibility;
mod api;
mod attack;
mod board;
mod disk;
mod drawing;
mod editing;
mod failure;
mod firefox;
mod foreign_maps;
mod keeping;
mod language;
mod network_file;
mod offline;
mod report;
mod same;
mod search;
mod shared;
mod terrain;
mod tour;
