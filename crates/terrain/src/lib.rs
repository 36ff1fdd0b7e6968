//! Elevation maps, their file formats, obstacles, slope and configuration space.
