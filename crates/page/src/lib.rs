//! A thin wasm module.
