//! The planning core as a wasm module for a web worker. Nothing is planned here: the mission crate is the core.
#![cfg(target_arch = "wasm32")]

use wasm_bindgen::prelude::*;

/// The version of the core.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
