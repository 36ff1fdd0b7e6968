//! The egui front end: panels, commands, theme and renderers; also a native window.

pub mod host;
