//! Display lists: what a drawing consists of, before anyone draws it.
//!
//! A drawing is built once, from its layout and its state, into a [`DisplayList`]: paths, rectangles, circles and texts in
//! drawing coordinates, colored by role. The screen, SVG files, pictures and reports are all made from that list. It
//! knows nothing of what it shows, of themes, or of a window; whoever draws it resolves colors and chooses the part in
//! view.
//!
//! The frame: x grows to the right, y grows downwards, and a unit is a point of the screen at zoom 1 and a user unit of
//! the SVG.

pub mod color;
pub mod geometry;
pub mod list;
pub mod text;

mod index;
mod svg;

pub use color::{Color, ColorRole, Ground, Rgb, Theme};
pub use geometry::{Piece, Point, Rect};
pub use index::SpatialIndex;
pub use list::{
    Dash, Detail, DisplayList, Fill, Group, Item, PathEnd, Run, Shape, Stroke, Target, TargetKind, arrow_head,
};
pub use svg::svg;
pub use text::{
    Anchor, Fit, Measure, Slide, Text, Weight, approximate_text_width, cut_to_width, text_width_at,
};
