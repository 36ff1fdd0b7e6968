//! The integration tests of `terrain`, in one program: each module is about one thing.

mod configuration_space;
mod formats;
mod geotiff;
mod line_of_sight;
mod profile;
mod ros_maps;
