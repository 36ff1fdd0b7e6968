//! Narrow passages: where one rock that the map does not show closes a path, and the way around is long.
//!
//! What drivers were measured to drive beyond their paths allows for going around such rocks nearby. Between steep slopes, one
//! rock can close the only way there is.

use nalgebra::{Point2, Vector2, distance};
use terrain::{CellState, ConfigurationSpace, Obstacle, Rock};

use crate::path::{Path, length_m};
use crate::way_around::way_around;

/// How much longer the way around a rock may be than the path, in meters: what drivers are given for that, less the way back to
/// where it starts.
const AROUND_M: f64 = 10.0;
/// A way around leaves the path, and is back on it, so many times as far from the rock as the vehicle has to stay away from it.
const LEAVING: f64 = 2.0;
/// How far beside the rock the shortest ways around it lead, in the same unit: so far that they keep away from it.
const BESIDE: f64 = 1.2;
/// Where the path has no room for the rock before and after it, the way around leaves it at most so many meters from the rock.
const LEAVING_WITHIN_M: f64 = 7.0;
/// Places on the path that are looked at are at least so far apart, in meters.
const STEP_M: f64 = 1.0;

/// The first place of a path where a rock that the map does not show, as big as such a rock can be, would leave no way on that
/// is at most `AROUND_M` longer, or its end, if the map leaves less room than half such a rock there, so that a few rocks could
/// enclose it; `None` if there is always a way. `space` is where the vehicle can be by the map. Places near the ends of
/// the path do not count otherwise: a vehicle stops beside a rock there.
///
/// Takes time in proportion to the length of the path, most of it where the map leaves less room than a rock needs.
pub fn narrow_passage(space: &ConfigurationSpace, path: &Path) -> Option<Point2<f64>> {
    // What is seen of a rock fills whole cells of the map.
    let rock_m = 0.5 * (Rock::MAPPED_DIAMETER_M + space.frame().cell_size_m);
    let away_m = rock_m + space.radius_m();
    let leaving_m = LEAVING * away_m;
    let end_m = path.length_m() - leaving_m;
    let mut along_m = leaving_m;
    while along_m <= end_m {
        let (place, _) = path.point_at(along_m)?;
        let room_m = space.clearance_m(place)?;
        if room_m < away_m {
            let near = ends_m(path, along_m, leaving_m)?;
            if !leads_past(space, near, place, away_m) {
                let has_room = |ends_m: &[Point2<f64>; 2]| {
                    ends_m.iter().all(|&end| space.clearance_m(end).is_some_and(|room_m| room_m >= away_m))
                };
                let far = (1..)
                    .map(|step| leaving_m + f64::from(step) * STEP_M)
                    .take_while(|leaving_m| *leaving_m <= LEAVING_WITHIN_M)
                    .filter_map(|leaving_m| ends_m(path, along_m, leaving_m));
                let mut ends = far.filter(has_room).chain([near]);
                if !ends.any(|ends| leads_around(space, ends, place, rock_m)) {
                    return Some(place);
                }
            }
        }
        // Clearance changes by no more than the way moved.
        along_m += (room_m - away_m).max(STEP_M);
    }
    // Next to steep ground or an obstacle a few rocks enclose a goal.
    let is_tight = |goal: &Point2<f64>| space.clearance_m(*goal).is_some_and(|room_m| room_m < rock_m);
    path.points_m.last().copied().filter(|goal| path.length_m() > 0.0 && is_tight(goal))
}

/// The places on a path some meters before and after another one.
fn ends_m(path: &Path, along_m: f64, leaving_m: f64) -> Option<[Point2<f64>; 2]> {
    let [before, after] = [along_m - leaving_m, along_m + leaving_m].map(|at_m| path.point_at(at_m));
    Some([before?.0, after?.0])
}

/// Returns whether a vehicle can drive past a rock close on one of its sides.
fn leads_past(
    space: &ConfigurationSpace,
    [from, to]: [Point2<f64>; 2],
    rock: Point2<f64>,
    away_m: f64,
) -> bool {
    let Some(ahead) = (to - from).try_normalize(1e-9) else { return false };
    let across = Vector2::new(-ahead.y, ahead.x) * (BESIDE * away_m);
    [rock + across, rock - across]
        .into_iter()
        .any(|beside| space.is_segment_free(from, beside) && space.is_segment_free(beside, to))
}

/// Returns whether there is a way around a rock on the map around it.
fn leads_around(
    space: &ConfigurationSpace,
    ends_m: [Point2<f64>; 2],
    rock: Point2<f64>,
    rock_m: f64,
) -> bool {
    let longest_m = distance(&ends_m[0], &rock) + distance(&rock, &ends_m[1]) + AROUND_M;
    let mut around = space.occupancy().around(rock, longest_m, 1);
    around.mark(&Obstacle::Circle { center_m: rock, radius_m: rock_m }, CellState::Rock);
    let around = ConfigurationSpace::new(around, space.radius_m());
    way_around(&around, ends_m, longest_m, u32::MAX).is_some_and(|way| length_m(&way) <= longest_m)
}

#[cfg(test)]
mod tests {
    use terrain::{GridFrame, Occupancy};

    use super::*;

    /// Returns whether one rock could close a straight path of 60 m through a gap of some meters between two walls,
    /// each so many meters wide along the path and long across it.
    fn is_closed_by_a_rock(gap_m: f64, wide_m: f64, long_m: f64) -> bool {
        let mut map = Occupancy::free(GridFrame::new(120, 120, 0.6));
        let [west, east] = [36.0 - 0.5 * wide_m, 36.0 + 0.5 * wide_m];
        for (near, far) in [(0.5 * gap_m, 0.5 * gap_m + long_m), (-0.5 * gap_m - long_m, -0.5 * gap_m)] {
            let corners = [[west, 36.0 + near], [east, 36.0 + near], [east, 36.0 + far], [west, 36.0 + far]];
            let wall = Obstacle::Polygon { corners_m: corners.map(Point2::from).to_vec() };
            map.mark(&wall, CellState::Steep);
        }
        let space = ConfigurationSpace::new(map, 0.7);
        let path = Path::new(vec![Point2::new(6.0, 36.0), Point2::new(66.0, 36.0)]);
        let closed = narrow_passage(&space, &path);
        if let Some(place) = closed {
            assert!((west - 3.0..=east + 3.0).contains(&place.x), "{place}");
        }
        closed.is_some()
    }

    #[test]
    fn a_rock_closes_a_gap_that_it_leaves_no_room_in_and_that_no_short_way_leads_around() {
        assert!(is_closed_by_a_rock(4.0, 3.0, 25.0));
        assert!(is_closed_by_a_rock(4.0, 24.0, 25.0));
        assert!(!is_closed_by_a_rock(9.0, 3.0, 25.0), "there is room beside the rock");
        assert!(!is_closed_by_a_rock(4.0, 3.0, 3.0), "a short way leads around a wall");
    }

    #[test]
    fn a_path_along_one_wall_or_over_a_map_that_ends_is_not_closed() {
        let mut map = Occupancy::free(GridFrame::new(100, 12, 0.6));
        let corners = [[0.0, 0.0], [60.0, 0.0], [60.0, 1.2], [0.0, 1.2]];
        map.mark(&Obstacle::Polygon { corners_m: corners.map(Point2::from).to_vec() }, CellState::Steep);
        let space = ConfigurationSpace::new(map, 0.7);
        let along = |y: f64| Path::new([[2.0, y], [52.0, y], [58.0, 4.0]].map(Point2::from).to_vec());
        assert_eq!(narrow_passage(&space, &along(2.6)), None);
        // A goal next to the wall may be enclosed, but not where the vehicle already is.
        let goal = Point2::new(52.0, 2.6);
        let there = Path::new(vec![Point2::new(52.0, 6.0), goal]);
        assert_eq!(narrow_passage(&space, &there), Some(goal));
        assert_eq!(narrow_passage(&space, &Path::new(vec![goal, goal])), None);
        assert_eq!(narrow_passage(&space, &Path::new(vec![Point2::new(2.0, 3.0)])), None);
        assert_eq!(narrow_passage(&space, &Path::new(Vec::new())), None);
    }
}
