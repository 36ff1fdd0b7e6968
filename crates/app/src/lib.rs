//! The egui front end: panels, commands, theme and renderers; also a native window.
//!
//! [`Enroute`] is the whole app. It runs on a [`host::Host`], which brings the planning core, storage and files, and
//! is driven from outside through [`host::Remote`]. Its state ([`state::AppState`]) changes only by
//! [`command::Command`]s; panels ([`panel::Panel`]) read it and send commands.

pub mod accessibility;
pub mod bar;
pub mod command;
pub mod core_queue;
pub mod dialog;
pub mod host;
pub mod icon;
pub mod layouts;
pub mod mission_file;
#[cfg(not(target_arch = "wasm32"))]
pub mod native;
pub mod outside;
pub mod panel;
mod shell;
pub mod state;
pub mod theme;
pub mod time_text;
pub mod toasts;
pub mod workspace;

pub use shell::Enroute;
