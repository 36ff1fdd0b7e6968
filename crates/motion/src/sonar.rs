//! Simulated sonars, beside the range finder: wide cones of short range that see what lies below the range finder's plane
//! (SPEC 7.4). The ATRV-Jr carried 17 of them.
//!
//! An echo says how far the nearest thing in a cone is, and not in which direction: it is an arc, and a later sweep that
//! hears nothing there takes it away again (Moravec and Elfes 1985). What the range finder sees in the same cone explains an
//! echo, so that only what that cannot see is left.

use nalgebra::{Point2, UnitComplex, Vector2};
use parry2d_f64::query::Ray;
use serde::{Deserialize, Serialize};
use terrain::Random;

use crate::fine_world::FineWorld;
use crate::range_sensor::RangeScan;
use crate::trajectory::heading_difference;

/// What the sonars of a vehicle can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SonarArray {
    /// How many look ahead, evenly over half a circle.
    pub count: u32,
    /// The angle of each cone in radians.
    pub beam_width_rad: f64,
    /// How far they hear in meters.
    pub range_m: f64,
    /// Standard deviation of a measured range in meters.
    pub noise_m: f64,
}

impl SonarArray {
    /// Like the Polaroid units of those years: cones of 25°, 4 m, 3 cm; those 13 of the ATRV-Jr's 17 that look ahead.
    pub const POLAROID: Self =
        Self { count: 13, beam_width_rad: 25.0 * std::f64::consts::PI / 180.0, range_m: 4.0, noise_m: 0.03 };

    /// One sweep at a place and heading: how far each cone is empty, the rightmost first.
    pub fn sweep(
        &self,
        world: &FineWorld,
        origin_m: Point2<f64>,
        heading_rad: f64,
        random: &mut Random,
    ) -> Vec<Echo> {
        let near = world.around(origin_m, self.range_m);
        let pitch = std::f64::consts::PI / f64::from(self.count.max(2) - 1);
        let echo = |index: u32| {
            let bearing_rad = heading_rad - std::f64::consts::FRAC_PI_2 + pitch * f64::from(index);
            let rays = (0..=RAYS).map(|ray| {
                let part = f64::from(ray) / f64::from(RAYS) - 0.5;
                UnitComplex::new(bearing_rad + part * self.beam_width_rad) * Vector2::x()
            });
            let ranges = rays.filter_map(|ahead| near.cast_low(&Ray::new(origin_m, ahead), self.range_m));
            let range_m = ranges.min_by(f64::total_cmp);
            (bearing_rad, range_m)
        };
        (0..self.count)
            .map(echo)
            .map(|(bearing_rad, range)| Echo {
                bearing_rad,
                range_m: range.map(|range| (range + self.noise_m * random.gaussian()).max(0.0)),
            })
            .collect()
    }
}

/// Rays that a cone is looked through by, but one.
const RAYS: u32 = 12;
/// The range finder explains an echo by what is at most this much farther, in meters.
const EXPLAINED_M: f64 = 0.3;
/// An echo takes away what was heard nearer than its range, but for this much, in meters.
const CARVED_M: f64 = 0.15;
/// The places of an arc are so far apart, in meters.
const ARC_STEP_M: f64 = 0.1;

/// What one sonar hears.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Echo {
    /// Where its cone looks, in radians counter-clockwise from east.
    pub bearing_rad: f64,
    /// How far the nearest thing in it is, in meters; `None` where it hears nothing.
    pub range_m: Option<f64>,
}

/// What sonars have heard that the range finder cannot see, as far as later sweeps have not denied it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Echoes {
    points_m: Vec<Point2<f64>>,
}

impl Echoes {
    /// Takes in a sweep of an array, made with a scan of the range finder at the same place.
    pub(crate) fn add(&mut self, array: &SonarArray, sweep: &[Echo], scan: &RangeScan, memory_m: f64) {
        let here = scan.origin_m;
        let half_rad = 0.5 * array.beam_width_rad;
        self.points_m.retain(|point| (point - here).norm() <= memory_m);
        let bearing = |point: &Point2<f64>| libm::atan2(point.y - here.y, point.x - here.x);
        for echo in sweep {
            let is_within =
                |point: &Point2<f64>| heading_difference(echo.bearing_rad, bearing(point)).abs() <= half_rad;
            let empty_m = echo.range_m.unwrap_or(array.range_m) - CARVED_M;
            self.points_m.retain(|point| (point - here).norm() >= empty_m || !is_within(point));
        }
        for echo in sweep {
            let Some(range_m) = echo.range_m else { continue };
            let is_seen = |point: Point2<f64>| {
                (point - here).norm() <= range_m + EXPLAINED_M
                    && heading_difference(echo.bearing_rad, bearing(&point)).abs() <= half_rad
            };
            if scan.points_m().any(is_seen) {
                continue;
            }
            let places = (range_m * array.beam_width_rad / ARC_STEP_M).ceil().max(1.0) as u32;
            for place in 0..=places {
                let part = f64::from(place) / f64::from(places) - 0.5;
                let ahead = UnitComplex::new(echo.bearing_rad + part * array.beam_width_rad);
                let point = here + ahead * Vector2::new(range_m, 0.0);
                // Where another cone is empty that far, nothing can be.
                let is_denied = sweep.iter().any(|other| {
                    heading_difference(other.bearing_rad, bearing(&point)).abs() <= half_rad
                        && other.range_m.unwrap_or(array.range_m) > range_m + CARVED_M
                });
                if !is_denied && self.points_m.iter().all(|known| (known - point).norm() > 0.5 * ARC_STEP_M) {
                    self.points_m.push(point);
                }
            }
        }
    }

    pub(crate) fn points_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.points_m.iter().copied()
    }
}

#[cfg(test)]
mod tests {
    use terrain::Obstacle;

    use super::*;
    use crate::range_sensor::RangeSensor;

    fn circle(x: f64, y: f64, radius_m: f64) -> Obstacle {
        Obstacle::Circle { center_m: Point2::new(x, y), radius_m }
    }

    /// Returns what is heard from the origin, looking east.
    fn heard(world: &FineWorld) -> Vec<Point2<f64>> {
        let (array, mut echoes) = (SonarArray { noise_m: 0.0, ..SonarArray::POLAROID }, Echoes::default());
        let exact = RangeSensor { noise_m: 0.0, ..RangeSensor::SICK };
        let scan = exact.scan(world, Point2::origin(), 0.0, &mut Random::from_seed(1));
        let sweep = array.sweep(world, Point2::origin(), 0.0, &mut Random::from_seed(1));
        echoes.add(&array, &sweep, &scan, 6.0);
        echoes.points_m().collect()
    }

    #[test]
    fn a_sonar_hears_what_lies_below_the_range_finders_plane_as_far_as_it_is() {
        let mut world = FineWorld::default();
        world.add_low(&circle(3.0, 0.0, 0.5));
        let scan = RangeSensor::SICK.scan(&world, Point2::origin(), 0.0, &mut Random::from_seed(1));
        assert_eq!(scan.points_m().count(), 0, "the range finder looks over it");
        let points = heard(&world);
        assert!(!points.is_empty());
        for point in &points {
            // The cones beside it hear its sides, which are a little farther.
            assert!((2.49..2.6).contains(&point.coords.norm()), "{point}");
            assert!(point.y.abs() < 0.8, "{point}");
        }
        let mut far = FineWorld::default();
        far.add_low(&circle(5.0, 0.0, 0.5));
        assert!(heard(&far).is_empty(), "it is out of reach");
    }

    #[test]
    fn an_echo_of_what_the_range_finder_sees_is_nothing_new() {
        let mut world = FineWorld::default();
        world.add(&circle(3.0, 0.0, 0.5));
        world.add(&circle(1.0, 2.0, 0.3));
        assert!(heard(&world).is_empty(), "{:?}", heard(&world));
    }

    #[test]
    fn what_is_not_heard_any_more_is_not_there() {
        let mut world = FineWorld::default();
        world.add_low(&circle(3.0, 0.0, 0.5));
        let (array, mut echoes) = (SonarArray { noise_m: 0.0, ..SonarArray::POLAROID }, Echoes::default());
        let mut look = |world: &FineWorld| {
            let mut random = Random::from_seed(1);
            let scan = RangeSensor::SICK.scan(world, Point2::origin(), 0.0, &mut random);
            let sweep = array.sweep(world, Point2::origin(), 0.0, &mut random);
            echoes.add(&array, &sweep, &scan, 6.0);
            echoes.points_m().count()
        };
        assert!(look(&world) > 0);
        assert_eq!(look(&FineWorld::default()), 0);
    }
}
