//! Elevation maps, their file formats, obstacles, slope and configuration space.
//!
//! * [`Terrain`] is a map of heights; [`asset`] makes the ones that example missions name, and [`mod@format`] reads files.
//! * [`Occupancy`] says which cells of a map a kind of vehicle can't stand on, and why.
//! * [`ConfigurationSpace`] answers exactly whether a vehicle of some radius can be at a point or drive along a
//!   segment, and proves when a place can't be reached.
//!
//! Coordinates are meters east and north. Row 0 of a grid is its southernmost row, and its origin is its south-west
//! corner. Everything here is a pure function of its arguments and gives the same bits natively and in wasm.

pub mod format;

mod configuration;
mod connectivity;
mod crater;
mod distance;
mod frame;
mod heightfield;
mod line_of_sight;
mod noise;
mod obstacle;
mod occupancy;
mod profile;
mod random;
mod recipe;
mod rock;
mod walk;

pub use configuration::{Collision, ConfigurationSpace};
pub use distance::distance_to_occupied;
pub use frame::{Cell, GridFrame};
pub use heightfield::Terrain;
pub use line_of_sight::LineOfSight;
pub use obstacle::Obstacle;
pub use occupancy::{CellState, Occupancy, Traversability};
pub use profile::GroundProfile;
pub use random::Random;
pub use recipe::{Craters, Dunes, Fan, RECIPES, Recipe, Relief, asset, asset_names, generate};
pub use rock::{Rock, cumulative_rock_area, scatter_rocks};
