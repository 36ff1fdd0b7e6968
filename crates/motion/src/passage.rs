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
            let ends_m = [along_m - leaving_m, along_m + leaving_m].map(|at_m| path.point_at(at_m));
            let [Some((from, _)), Some((to, _))] = ends_m else { return None };
            if !leads_past(space, [from, to], place, away_m)
                && !leads_around(space, [from, to], place, rock_m)
            {
                return Some(place);
            }
        }
        // Clearance changes by no more than the way moved.
        along_m += (room_m - away_m).max(STEP_M);
    }
    None
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
