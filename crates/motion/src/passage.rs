//! Narrow passages: where one rock that the map does not show closes a path, and the way around is long.
//!
//! What drivers were measured to drive beyond their paths allows for going around such rocks nearby. Between steep slopes, one
//! rock can close the only way there is.

use nalgebra::{Point2, Vector2, distance};
use terrain::{Cell, CellState, ConfigurationSpace, GridFrame, Obstacle, Occupancy, Rock};

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
/// is at most `AROUND_M` longer; `None` if there is always one. `space` is where the vehicle can be by the map. Places near
/// the ends of the path do not count: a vehicle stops beside a rock there.
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
    None
}

/// The places on a path some meters before and after another one.
fn ends_m(path: &Path, along_m: f64, leaving_m: f64) -> Option<[Point2<f64>; 2]> {
    let [before, after] = [along_m - leaving_m, along_m + leaving_m].map(|at_m| path.point_at(at_m));
    Some([before?.0, after?.0])
}

/// Whether a vehicle can drive past a rock close on one of its sides.
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

/// Whether there is a way around a rock on the map around it.
fn leads_around(
    space: &ConfigurationSpace,
    ends_m: [Point2<f64>; 2],
    rock: Point2<f64>,
    rock_m: f64,
) -> bool {
    let longest_m = distance(&ends_m[0], &rock) + distance(&rock, &ends_m[1]) + AROUND_M;
    let mut around = map_around(space, rock, longest_m);
    around.mark(&Obstacle::Circle { center_m: rock, radius_m: rock_m }, CellState::Rock);
    let around = ConfigurationSpace::new(around, space.radius_m());
    way_around(&around, ends_m, longest_m, u32::MAX).is_some_and(|way| length_m(&way) <= longest_m)
}

/// A part of a map, so many meters across.
fn map_around(space: &ConfigurationSpace, center_m: Point2<f64>, across_m: f64) -> Occupancy {
    let map = space.frame();
    let corner = |sign: f64| map.to_cells(center_m + Vector2::repeat(sign * 0.5 * across_m));
    let low = corner(-1.0).map(|cells| cells.floor().max(0.0) as u32);
    let high = corner(1.0).map(|cells| cells.ceil().max(0.0) as u32);
    let (width, height) = (high.x.min(map.width) - low.x, high.y.min(map.height) - low.y);
    let origin_m = map.to_meters(Point2::new(f64::from(low.x), f64::from(low.y)));
    let frame = GridFrame { width, height, origin_m, ..*map };
    let of_map = |index: usize| {
        let cell = frame.cell(index);
        let of_map = Cell { column: low.x + cell.column, row: low.y + cell.row };
        space.occupancy().state(of_map) != CellState::Free
    };
    let occupied: Vec<bool> = (0..frame.cell_count()).map(of_map).collect();
    Occupancy::from_obstacles(frame, &occupied)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether one rock could close a straight path of 60 m through a gap of some meters between two walls, each so many meters
    /// wide along the path and long across it.
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
        let along = |y: f64| Path::new(vec![Point2::new(2.0, y), Point2::new(58.0, y)]);
        assert_eq!(narrow_passage(&space, &along(2.6)), None);
        assert_eq!(narrow_passage(&space, &Path::new(vec![Point2::new(2.0, 3.0)])), None);
        assert_eq!(narrow_passage(&space, &Path::new(Vec::new())), None);
    }
}
