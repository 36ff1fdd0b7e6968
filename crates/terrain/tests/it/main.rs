//! The integration tests of `terrain`, in one program: each module is about one thing.

mod configuration_space;
mod formats;
mod geotiff;
mod ros_maps;
mod sight;
