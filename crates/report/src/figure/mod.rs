//! The drawings of a report as SVG.

mod map;
mod network;
mod sheet;
mod timeline;

pub(crate) use map::map;
pub(crate) use network::{network, network_since};
pub(crate) use sheet::{html, under_heading};
pub use timeline::{rule_tracks, windows_before};
pub(crate) use timeline::{timeline, timeline_since};
