//! What compiling asks of a mission's ground.

use crate::Hidden;

/// The ground of a mission, which decides what vehicles see (SPEC 10.5).
pub trait Ground {
    /// The places from which a vehicle does not see a location.
    fn hidden(&self, vehicle: &str, location: &str) -> Vec<Hidden>;
}

/// Ground without heights: everything is in sight.
#[derive(Clone, Copy, Debug, Default)]
pub struct Level;

impl Ground for Level {
    fn hidden(&self, _vehicle: &str, _location: &str) -> Vec<Hidden> {
        Vec::new()
    }
}
