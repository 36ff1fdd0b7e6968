//! The app around the panels: their layout, bars, dialogs and keys, and a native window.
//!
//! [`Enroute`] is the whole app. It runs on a [`Host`](workbench::host::Host), which brings the planning core, storage
//! and files, and is driven from outside through [`Remote`](workbench::host_io::Remote). Its state is the
//! [`workbench`]'s and changes only by commands; panels ([`panels::Panel`]) read it and send them.

pub mod accessibility;
pub mod bar;
pub mod chord;
pub mod default_layout;
pub mod dialog;
pub mod layouts;
#[cfg(not(target_arch = "wasm32"))]
pub mod native;
mod pressed;
mod shell;
pub mod toasts;

pub use shell::Enroute;
