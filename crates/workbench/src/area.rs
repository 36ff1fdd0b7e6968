//! Parts of the window.

/// A part of the window: left, top, width and height, from 0 to 1.
pub type Area = [f32; 4];
