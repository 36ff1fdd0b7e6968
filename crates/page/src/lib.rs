//! The front end as a wasm module for the page. Nothing is decided here: the app crate is the front end, and the files
//! of `web/` load this module and put `window.enroute` in place.
#![cfg(target_arch = "wasm32")]

mod core_link;
mod front_end;
mod glue;
mod host;
mod painter;
mod refusal;

pub use front_end::{FrontEnd, start, uses_key};
