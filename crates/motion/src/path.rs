//! A path in the plane: the corners that a vehicle drives through.

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};
use terrain::ConfigurationSpace;

/// A polyline in meters east and north, from its first point to its last.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Path {
    /// The corners, with both ends.
    pub points_m: Vec<Point2<f64>>,
}

impl Path {
    /// A path through these points.
    pub const fn new(points_m: Vec<Point2<f64>>) -> Self {
        Self { points_m }
    }

    /// The straight pieces in order.
    pub fn segments(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
        self.points_m.windows(2).map(|pair| (pair[0], pair[1]))
    }

    /// The length in the plane in meters.
    pub fn length_m(&self) -> f64 {
        length_m(&self.points_m)
    }

    /// The least clearance along the path in meters ([`ConfigurationSpace::segment_clearance_m`]); `None` when the path
    /// is empty or leaves the map.
    pub fn clearance_m(&self, space: &ConfigurationSpace) -> Option<f64> {
        let mut least = space.clearance_m(*self.points_m.first()?)?;
        for (a, b) in self.segments() {
            least = least.min(space.segment_clearance_m(a, b)?);
        }
        Some(least)
    }

    /// Returns whether the vehicle can drive all of it.
    pub fn is_free(&self, space: &ConfigurationSpace) -> bool {
        self.points_m.iter().all(|&point| space.is_free(point))
            && self.segments().all(|(a, b)| space.is_segment_free(a, b))
    }

    /// The point at a distance from the start along the path, in meters, and the segment it lies on; the ends beyond
    /// them. `None` on an empty path.
    pub fn point_at(&self, distance_m: f64) -> Option<(Point2<f64>, usize)> {
        let mut rest = distance_m.max(0.0);
        for (index, (a, b)) in self.segments().enumerate() {
            let length = distance(&a, &b);
            if rest <= length && length > 0.0 {
                return Some((between(a, b, rest / length), index));
            }
            rest -= length;
        }
        self.points_m.last().map(|&last| (last, self.points_m.len().saturating_sub(2)))
    }
}

/// The length of a polyline in meters.
pub fn length_m(points_m: &[Point2<f64>]) -> f64 {
    // The sum of no numbers is -0.
    points_m.windows(2).map(|pair| distance(&pair[0], &pair[1])).fold(0.0, |sum, length| sum + length)
}

/// The point at a share of the way from one point to another; exactly the ends at 0 and 1.
pub(crate) fn between(a: Point2<f64>, b: Point2<f64>, share: f64) -> Point2<f64> {
    if share >= 1.0 { b } else { a + (b - a) * share }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_along_a_path_are_found_by_their_distance() {
        let path = Path::new([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]].map(Point2::from).to_vec());
        assert_eq!(path.length_m(), 7.0);
        assert_eq!(path.point_at(2.0), Some((Point2::new(2.0, 0.0), 0)));
        assert_eq!(path.point_at(5.0), Some((Point2::new(3.0, 2.0), 1)));
        assert_eq!(path.point_at(99.0), Some((Point2::new(3.0, 4.0), 1)));
        assert_eq!(Path::default().point_at(0.0), None);
    }
}
