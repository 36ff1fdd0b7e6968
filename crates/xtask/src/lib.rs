//! What the developer commands are made of: building the page, serving it, and driving it in a browser.
//!
//! The `xtask` binary and the page's end-to-end tests share this; nothing of it is part of the product.

pub mod browser;
pub mod dependencies;
pub mod dist;
pub mod disturb;
pub mod download;
pub mod kill;
pub mod process;
pub mod server;
pub mod site;
pub mod texts;
pub mod wasm_parts;
