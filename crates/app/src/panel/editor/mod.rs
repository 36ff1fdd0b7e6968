//! The mission text: a code editor that lays out only the lines on screen.

mod keyboard;

pub use keyboard::{editor_id, typed_text};
