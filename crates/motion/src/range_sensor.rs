//! A simulated planar range sensor in a world that is finer than the map (SPEC 7.4).

use nalgebra::{Point2, UnitComplex, Vector2};
use parry2d_f64::query::Ray;
use serde::{Deserialize, Serialize};
use terrain::Random;

use crate::fine_world::FineWorld;

/// What a range sensor can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeSensor {
    /// The angle that it sweeps, centered ahead, in radians.
    pub field_of_view_rad: f64,
    /// The angle between two rays in radians.
    pub resolution_rad: f64,
    /// How far it sees in meters.
    pub range_m: f64,
    /// Standard deviation of a measured range in meters.
    pub noise_m: f64,
}

impl RangeSensor {
    /// Like the SICK units that such robots carried: 180° in steps of 1°, 8 m, 1.5 cm.
    pub const SICK: Self = Self {
        field_of_view_rad: std::f64::consts::PI,
        resolution_rad: std::f64::consts::PI / 180.0,
        range_m: 8.0,
        noise_m: 0.015,
    };
}

/// What a range sensor measures in one sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RangeScan {
    /// Where it was taken, in meters.
    pub origin_m: Point2<f64>,
    /// The direction of the first ray, the rightmost, in radians.
    pub first_ray_rad: f64,
    /// The angle between two rays in radians.
    pub resolution_rad: f64,
    /// The measured range of each ray in meters; `None` when it met nothing.
    pub ranges_m: Vec<Option<f64>>,
}

impl RangeScan {
    /// The measured points in meters.
    pub fn points_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.ranges_m.iter().enumerate().filter_map(|(ray, range)| {
            let range = (*range)?;
            let angle = self.first_ray_rad + self.resolution_rad * ray as f64;
            Some(self.origin_m + UnitComplex::new(angle) * Vector2::new(range, 0.0))
        })
    }
}

impl RangeSensor {
    /// One sweep by a vehicle at a place and heading.
    pub fn scan(
        &self,
        world: &FineWorld,
        origin_m: Point2<f64>,
        heading_rad: f64,
        random: &mut Random,
    ) -> RangeScan {
        let near = world.around(origin_m, self.range_m);
        let rays = (self.field_of_view_rad / self.resolution_rad).round().clamp(0.0, 1e5) as u32;
        let first_ray_rad = heading_rad - 0.5 * self.field_of_view_rad;
        let ranges_m = (0..=rays)
            .map(|ray| {
                let angle = first_ray_rad + self.resolution_rad * f64::from(ray);
                let ray = Ray::new(origin_m, UnitComplex::new(angle) * Vector2::x());
                let range = near.cast(&ray, self.range_m)?;
                Some((range + self.noise_m * random.gaussian()).max(0.0))
            })
            .collect();
        RangeScan { origin_m, first_ray_rad, resolution_rad: self.resolution_rad, ranges_m }
    }
}

#[cfg(test)]
mod tests {
    use terrain::Obstacle;

    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn world() -> FineWorld {
        let mut world = FineWorld::default();
        world.add(&Obstacle::Circle { center_m: Point2::new(5.0, 0.0), radius_m: 1.0 });
        world.add(&Obstacle::Polygon {
            corners_m: [[-2.0, 3.0], [2.0, 3.0], [2.0, 4.0], [-2.0, 4.0]].map(Point2::from).to_vec(),
        });
        world
    }

    #[test]
    fn rays_end_at_the_nearest_surface() {
        let exact = RangeSensor { noise_m: 0.0, ..RangeSensor::SICK };
        let scan = exact.scan(&world(), Point2::origin(), FRAC_PI_2, &mut Random::from_seed(1));
        assert_eq!(scan.ranges_m.len(), 181);
        // The rightmost ray looks east at the disc, the middle one north at the wall, the leftmost west at nothing.
        assert!((scan.ranges_m[0].unwrap() - 4.0).abs() < 1e-9);
        assert!((scan.ranges_m[90].unwrap() - 3.0).abs() < 1e-9);
        assert_eq!(scan.ranges_m[180], None);
        for point in scan.points_m() {
            assert!(world().distance_m(point) < 1e-9, "{point:?} is on no surface");
        }
    }

    #[test]
    fn noise_has_its_standard_deviation_and_its_seed() {
        let look = |seed| {
            RangeSensor::SICK.scan(&world(), Point2::origin(), FRAC_PI_2, &mut Random::from_seed(seed))
        };
        assert_eq!(look(4), look(4));
        assert_ne!(look(4), look(5));
        let errors: Vec<f64> = (0..2000).map(|seed| look(seed).ranges_m[90].unwrap() - 3.0).collect();
        let deviation = (errors.iter().map(|error| error * error).sum::<f64>() / 2000.0).sqrt();
        assert!((deviation - 0.015).abs() < 0.001, "{deviation}");
    }

    #[test]
    fn nothing_is_seen_beyond_the_range() {
        let short = RangeSensor { range_m: 2.5, ..RangeSensor::SICK };
        for heading in [0.0, FRAC_PI_2, PI] {
            let scan = short.scan(&world(), Point2::origin(), heading, &mut Random::from_seed(1));
            assert!(scan.ranges_m.iter().all(Option::is_none));
        }
    }
}
