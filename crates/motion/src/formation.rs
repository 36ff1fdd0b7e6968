//! Vehicles that keep formation behind a leader (SPEC 1.8 `moves`).

use nalgebra::{Point2, UnitComplex, Vector2, distance};
use terrain::ConfigurationSpace;

use crate::path::{Path, between};

/// Where the followers of a leader drive: in a wedge, left and right behind it, that closes to a column where the ground
/// is narrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Formation {
    /// Meters between the centers of two vehicles, at least: more than the sum of their circumradii.
    pub spacing_m: f64,
}

/// How far to the side of the path followers drive, in spacings.
const SIDE_SPACINGS: f64 = 0.5;
/// One that hangs back does so by so many spacings at a time, and so many times at most.
const STEP_SPACINGS: f64 = 0.125;
const MAX_HANGING: u32 = 64;
/// If a place is taken, rings around it are searched: the distance between two rings in spacings, and their number.
const RING_SPACINGS: f64 = 0.25;
const MAX_RINGS: u32 = 24;

impl Formation {
    /// Returns where the leader and `followers` vehicles behind it are when the leader has come `traveled_m` along its
    /// path.
    ///
    /// Follower `k` (from 1) is `k` spacings behind along the path and half a spacing, or as much of it as is free, to
    /// the left when `k` is odd and to the right when it is even. One that would come nearer than the spacing to a
    /// vehicle before it hangs back along the path. Before the path's start, followers stand behind it where that is
    /// free, and otherwise on the nearest free place around it.
    pub fn positions_m(
        self,
        space: &ConfigurationSpace,
        path: &Path,
        traveled_m: f64,
        followers: u32,
    ) -> Vec<Point2<f64>> {
        let Some((leader, _)) = path.point_at(traveled_m) else { return Vec::new() };
        let mut positions = vec![leader];
        let traveled = traveled_m.min(path.length_m());
        for follower in 1..=followers {
            let side = if follower % 2 == 1 { SIDE_SPACINGS } else { -SIDE_SPACINGS };
            let step = STEP_SPACINGS * self.spacing_m;
            // A turn may bring the leader back past its followers: hanging back further than this does not help.
            let mut hanging = 0;
            let place = loop {
                let along = traveled - f64::from(follower) * self.spacing_m - f64::from(hanging) * step;
                let place = self.place_beside(space, path, along, side);
                if self.keeps_apart(place, &positions) || hanging == MAX_HANGING {
                    break place;
                }
                hanging += 1;
            };
            let place = if self.keeps_apart(place, &positions) && space.is_free(place) {
                place
            } else {
                self.nearest_place(space, place, &positions)
            };
            positions.push(place);
        }
        positions
    }

    /// Returns where they are when the leader has come to the end of its path.
    pub fn end_m(self, space: &ConfigurationSpace, path: &Path, followers: u32) -> Vec<Point2<f64>> {
        self.positions_m(space, path, path.length_m(), followers)
    }

    /// No follower of so many is farther from its leader than this, in meters, by ways that are free.
    pub fn reach_m(self, followers: usize) -> f64 {
        let hanging = STEP_SPACINGS * f64::from(MAX_HANGING);
        let ring = RING_SPACINGS * f64::from(MAX_RINGS);
        self.spacing_m * (followers as f64 + SIDE_SPACINGS + hanging + ring)
    }

    fn keeps_apart(self, place: Point2<f64>, others: &[Point2<f64>]) -> bool {
        others.iter().all(|&other| distance(&place, &other) >= self.spacing_m * (1.0 - 1e-9))
    }

    /// The place at a distance along the path, which may be before its start, and as far to the side as is free.
    fn place_beside(self, space: &ConfigurationSpace, path: &Path, along_m: f64, side: f64) -> Point2<f64> {
        let center = point_before_or_on(path, along_m);
        // The direction is taken over a spacing to both sides, so that a corner turns the formation gradually.
        let behind = point_before_or_on(path, along_m - 0.5 * self.spacing_m);
        let ahead = point_before_or_on(path, along_m + 0.5 * self.spacing_m);
        let length = distance(&behind, &ahead);
        if length == 0.0 {
            return center;
        }
        let forward = (ahead - behind) / length;
        let left = Vector2::new(-forward.y, forward.x);
        [1.0, 0.5, 0.25, 0.0]
            .map(|share| center + left * (share * side * self.spacing_m))
            .into_iter()
            .find(|&place| space.is_segment_free(center, place))
            .unwrap_or(center)
    }

    /// The nearest free place on rings around a place that keeps apart from the others; the place itself when there is
    /// none.
    fn nearest_place(
        self,
        space: &ConfigurationSpace,
        place: Point2<f64>,
        others: &[Point2<f64>],
    ) -> Point2<f64> {
        const DIRECTIONS: u32 = 24;
        (1..=MAX_RINGS)
            .flat_map(|ring| (0..DIRECTIONS).map(move |direction| (ring, direction)))
            .map(|(ring, direction)| {
                let angle = std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
                let radius = RING_SPACINGS * self.spacing_m * f64::from(ring);
                place + UnitComplex::new(angle) * Vector2::new(radius, 0.0)
            })
            .find(|&candidate| space.is_free(candidate) && self.keeps_apart(candidate, others))
            .unwrap_or(place)
    }
}

/// The point at a distance along a path, which is prolonged straight back before its start.
fn point_before_or_on(path: &Path, along_m: f64) -> Point2<f64> {
    let Some((first, next)) = path.segments().find(|(a, b)| a != b) else {
        return path.points_m.first().copied().unwrap_or_default();
    };
    if along_m < 0.0 {
        return between(first, next, along_m / distance(&first, &next));
    }
    path.point_at(along_m).map_or(first, |(point, _)| point)
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrain::{CellState, GridFrame, Obstacle, Occupancy};

    fn assert_apart_and_free(space: &ConfigurationSpace, path: &Path, followers: u32, formation: Formation) {
        let length = path.length_m();
        for step in 0..=400 {
            let traveled = length * f64::from(step) / 400.0;
            let places = formation.positions_m(space, path, traveled, followers);
            assert_eq!(places.len() as u32, followers + 1);
            for (index, &place) in places.iter().enumerate() {
                assert!(space.is_free(place), "vehicle {index} at {place:?} after {traveled} m");
                for &other in &places[..index] {
                    let apart = distance(&place, &other);
                    assert!(
                        apart >= formation.spacing_m * (1.0 - 1e-6),
                        "{apart} m apart after {traveled} m"
                    );
                }
            }
        }
    }

    #[test]
    fn followers_keep_apart_and_off_obstacles_around_corners() {
        let mut occupancy = Occupancy::free(GridFrame::new(100, 100, 0.6));
        for (center, radius_m) in [([20.0, 26.0], 4.0), ([38.0, 30.0], 5.0), ([20.0, 16.0], 2.5)] {
            occupancy.mark(&Obstacle::Circle { center_m: center.into(), radius_m }, CellState::Obstacle);
        }
        let space = ConfigurationSpace::new(occupancy, 0.8);
        let path = Path::new(
            [[10.0, 8.0], [12.0, 20.0], [29.0, 21.0], [29.0, 45.0], [50.0, 46.0]].map(Point2::from).to_vec(),
        );
        assert!(path.is_free(&space));
        assert_apart_and_free(&space, &path, 3, Formation { spacing_m: 2.0 });
    }

    #[test]
    fn a_leader_that_turns_back_does_not_run_into_its_followers() {
        let space = ConfigurationSpace::new(Occupancy::free(GridFrame::new(100, 100, 0.6)), 0.8);
        let path = Path::new([[10.0, 30.0], [40.0, 30.0], [10.0, 30.5]].map(Point2::from).to_vec());
        assert_apart_and_free(&space, &path, 2, Formation { spacing_m: 2.0 });
    }
}
