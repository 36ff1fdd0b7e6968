//! The terrain view: the ground in three dimensions, with what stands on it, moves over it and is painted onto it.
//!
//! It draws an image and says what is under a point of it. What the user does with that, and everything written over
//! the image, is the terrain panel's.

pub mod camera;
pub mod dash;
pub mod decal;
mod detail;
pub mod driving;
pub mod flight;
pub mod frame;
pub mod gpu;
pub mod ground;
pub mod navigate;
mod outline;
pub mod pace;
pub mod pick;
mod rocks;
pub mod scale;
pub mod scene;
mod shadow;
pub mod shapes;
mod sights;
pub mod sun;
pub mod sunlight;
pub mod tour;
mod tree;
mod vehicles;
pub mod volume;
