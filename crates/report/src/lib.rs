//! A mission and its review as documents: one HTML file for people, and schedules for other tools.
//!
//! Every function here turns data into text; reading and writing files is the caller's. The same snapshot gives the
//! same bytes everywhere.

mod board;
pub mod calendar;
pub mod export;
mod figure;
pub mod geojson;
mod html;
mod listing;
pub mod pddl;
pub mod plandev;
mod shown;
mod style;
mod tables;

pub use figure::{rule_tracks, windows_before};
pub use html::{Document, html};

#[cfg(test)]
mod tests;
