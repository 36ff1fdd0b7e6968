//! The ground between two places: its profile and its length.

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};

use crate::heightfield::Terrain;

/// The ground under a straight line between two places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GroundProfile {
    /// Meters in the plan from the first place, and the height of the ground there, in order; both ends included.
    pub points_m: Vec<Point2<f64>>,
    /// The length of the ground in meters, up and down its slopes.
    pub ground_m: f64,
    /// The straight distance in space between the two places, in meters.
    pub straight_m: f64,
    /// Meters up and meters down on the way from the first place to the second.
    pub climb_m: [f64; 2],
    /// The steepest slope along the line, in radians.
    pub slope_max_rad: f64,
}

impl Terrain {
    /// The ground from one place straight to another, sampled twice per cell. `None` when one of them has no height:
    /// it is outside the map or in a cell without data. Linear in the distance.
    pub fn profile(&self, from_m: Point2<f64>, to_m: Point2<f64>) -> Option<GroundProfile> {
        let (first, last) = (self.height_at(from_m)?, self.height_at(to_m)?);
        let ground = self.drape(from_m, to_m);
        let points_m: Vec<Point2<f64>> =
            ground.iter().map(|point| Point2::new(distance(&from_m, &point.xy()), point.z)).collect();
        let plan_m = distance(&from_m, &to_m);
        let mut profile = GroundProfile {
            ground_m: 0.0,
            straight_m: (plan_m * plan_m + (last - first) * (last - first)).sqrt(),
            climb_m: [0.0, 0.0],
            slope_max_rad: 0.0,
            points_m,
        };
        for pair in profile.points_m.windows(2) {
            let piece = pair[1] - pair[0];
            profile.ground_m += piece.norm();
            profile.climb_m[usize::from(piece.y < 0.0)] += piece.y.abs();
            profile.slope_max_rad = profile.slope_max_rad.max(libm::atan2(piece.y.abs(), piece.x));
        }
        Some(profile)
    }
}
