//! What a vehicle has seen around it, and ways around that.

use std::collections::BTreeMap;

use nalgebra::{Point2, UnitComplex, Vector2, distance, distance_squared};
use parry2d_f64::query::PointQuery as _;
use parry2d_f64::shape::Segment;
use terrain::{Cell, CellState, ConfigurationSpace, GridFrame, Obstacle, Occupancy};

use crate::path::Path;
use crate::range_sensor::RangeScan;
use crate::sonar::{Echo, Echoes, SonarArray};
use crate::way_around::way_around;

/// Seen points farther away than this are dropped, in meters.
const MEMORY_RADIUS_M: f64 = 6.0;
/// Points that share a square of this side, in meters, are kept as their mean, which evens out the sensor's noise.
const SQUARE_M: f64 = 0.05;
/// Side of a cell of the grid on which detours are looked for, in meters.
const CELL_M: f64 = 0.1;

/// Points that were seen in one square.
#[derive(Clone, Copy, Debug)]
struct Seen {
    mean_m: Point2<f64>,
    count: u32,
}

impl Seen {
    /// Takes another point in. Only so many count, so that a square costs nothing more in the long run.
    fn add(&mut self, point: Point2<f64>) {
        const MAX: u32 = 50;
        self.count = (self.count + 1).min(MAX);
        let share = 1.0 / f64::from(self.count);
        self.mean_m += (point - self.mean_m) * share;
    }
}

/// The points of all sweeps that are still near.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeenPoints {
    points: BTreeMap<(i64, i64), Seen>,
    /// What sonars have heard besides.
    echoes: Echoes,
    /// Rims of vehicles to go around.
    vehicles: Vec<Point2<f64>>,
}

impl SeenPoints {
    /// Adds a sweep and forgets what is far from where it was taken.
    pub(crate) fn add(&mut self, scan: &RangeScan) {
        let near = MEMORY_RADIUS_M * MEMORY_RADIUS_M;
        self.points.retain(|_, seen| distance_squared(&seen.mean_m, &scan.origin_m) <= near);
        for point in scan.points_m().filter(|point| distance_squared(point, &scan.origin_m) <= near) {
            let square = point.map(|value| (value / SQUARE_M).floor() as i64);
            self.points.entry((square.x, square.y)).or_insert(Seen { mean_m: point, count: 0 }).add(point);
        }
    }

    /// Adds what sonars hear at the place of a sweep.
    pub(crate) fn hear(&mut self, array: &SonarArray, echoes: &[Echo], scan: &RangeScan) {
        self.echoes.add(array, echoes, scan, MEMORY_RADIUS_M);
    }

    /// Replaces the vehicles to go around, given as place and radius in meters.
    pub(crate) fn set_vehicles(&mut self, vehicles: &[(Point2<f64>, f64)]) {
        const CORNERS: u32 = 32;
        let corner = |corner: u32| std::f64::consts::TAU * f64::from(corner) / f64::from(CORNERS);
        // The polygon holds the disc.
        let outside = 1.0 / libm::cos(0.5 * corner(1));
        let rim = |&(place, radius_m): &(Point2<f64>, f64)| {
            let to_corner = Vector2::new(outside * radius_m, 0.0);
            (0..CORNERS).map(move |at| place + UnitComplex::new(corner(at)) * to_corner)
        };
        self.vehicles = vehicles.iter().flat_map(rim).collect();
    }

    pub(crate) fn points_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        let seen = self.points.values().map(|seen| seen.mean_m);
        seen.chain(self.echoes.points_m()).chain(self.vehicles.iter().copied())
    }

    /// Returns what sonars have heard that the range finder cannot see.
    pub(crate) fn heard_m(&self) -> impl Iterator<Item = Point2<f64>> + '_ {
        self.echoes.points_m()
    }

    /// Returns whether a disc can go straight from one place to another without coming nearer than `reach` to a seen
    /// point that lies ahead.
    pub(crate) fn is_open(&self, from: Point2<f64>, to: Point2<f64>, reach: f64) -> bool {
        let way = Segment::new(from, to);
        let ahead = way.scaled_direction();
        ahead == Vector2::zeros()
            || self.points_m().all(|point| {
                (point - from).dot(&ahead) <= 0.0 || way.distance_to_local_point(&point, true) >= reach
            })
    }

    /// The free places around a vehicle whose center keeps `reach` meters from everything, with seen points and what is
    /// occupied on the map in the way.
    pub(crate) fn surroundings(
        &self,
        here: Point2<f64>,
        reach: f64,
        map: Option<&ConfigurationSpace>,
    ) -> ConfigurationSpace {
        let count = (2.0 * MEMORY_RADIUS_M / CELL_M) as u32;
        let frame = GridFrame {
            width: count,
            height: count,
            cell_size_m: CELL_M,
            origin_m: here - Vector2::repeat(MEMORY_RADIUS_M),
        };
        let mut occupancy = Occupancy::free(frame);
        for point in self.points_m() {
            occupancy.mark(&Obstacle::Circle { center_m: point, radius_m: 0.0 }, CellState::Obstacle);
        }
        if let Some(map) = map {
            mark_map(&mut occupancy, map, here);
        }
        ConfigurationSpace::new(occupancy, reach)
    }
}

/// Marks the cells of a grid that are occupied on a map.
fn mark_map(occupancy: &mut Occupancy, map: &ConfigurationSpace, here: Point2<f64>) {
    let frame = *occupancy.frame();
    let distance = map.clearance_m(here).map(|clearance| clearance + map.radius_m());
    if distance.is_some_and(|distance| distance > 2.0 * MEMORY_RADIUS_M) {
        return;
    }
    for row in 0..frame.height {
        for column in 0..frame.width {
            let center_m = frame.center_m(Cell { column, row });
            let cell = map.occupancy().frame().cell_at(center_m);
            if cell.is_none_or(|cell| map.occupancy().state(cell) != CellState::Free) {
                occupancy.mark(&Obstacle::Circle { center_m, radius_m: 0.0 }, CellState::Steep);
            }
        }
    }
}

/// A way back to the path, past what stands on it: to the nearest free place at least a lookahead ahead that can be
/// reached.
pub(crate) fn find_detour(
    surroundings: &ConfigurationSpace,
    here: Point2<f64>,
    path: &Path,
    progress_m: f64,
) -> Option<Path> {
    // Every cell is looked at, so that the side on which an obstacle is passed does not change from one look to another.
    const BLOCKS: u32 = u32::MAX;
    const MAX_LENGTH_M: f64 = 4.0 * MEMORY_RADIUS_M;
    let start_m = nearest_free(surroundings, here)?;
    let [low, high] = [surroundings.frame().origin_m, surroundings.frame().far_corner_m()];
    let length = path.length_m();
    (4..=12).find_map(|step| {
        let along = (progress_m + 0.5 * f64::from(step)).min(length);
        let (goal_m, _) = path.point_at(along)?;
        let inside = (0..2).all(|axis| goal_m[axis] > low[axis] && goal_m[axis] < high[axis]);
        if !inside || !surroundings.is_free(goal_m) {
            return None;
        }
        let way = way_around(surroundings, [start_m, goal_m], MAX_LENGTH_M, BLOCKS)?;
        let before = Some(here).filter(|&here| here != start_m);
        Some(Path::new(before.into_iter().chain(way).collect()))
    })
}

/// The place itself, or the nearest free one on rings around it: a vehicle that came too near to something leaves first.
fn nearest_free(surroundings: &ConfigurationSpace, here: Point2<f64>) -> Option<Point2<f64>> {
    const DIRECTIONS: u32 = 24;
    if surroundings.is_free(here) {
        return Some(here);
    }
    (1..=15).flat_map(|ring| (0..DIRECTIONS).map(move |direction| (ring, direction))).find_map(
        |(ring, direction)| {
            let angle = std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
            let radius = CELL_M * f64::from(ring);
            let place = here + UnitComplex::new(angle) * Vector2::new(radius, 0.0);
            surroundings.is_free(place).then_some(place)
        },
    )
}

/// The nearest place on a stretch of a path: how far along the path, and how far away, in meters.
pub(crate) fn nearest_along(path: &Path, place: Point2<f64>, from_m: f64, stretch_m: f64) -> (f64, f64) {
    const STEP_M: f64 = 0.1;
    let length = path.length_m();
    (0..=(stretch_m / STEP_M) as u32 + 1)
        .filter_map(|step| {
            let along = (from_m + STEP_M * f64::from(step)).min(length);
            path.point_at(along).map(|(point, _)| (along, distance(&point, &place)))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((from_m, 0.0))
}

#[cfg(test)]
mod tests {
    use terrain::Random;

    use super::*;

    #[test]
    fn a_way_is_open_when_no_place_on_it_comes_near_a_seen_point_ahead() {
        let (mut open, mut shut) = (0, 0);
        for seed in 0..300 {
            let mut random = Random::from_seed(seed);
            let mut place = || Point2::new(random.range(-3.0, 3.0), random.range(-3.0, 3.0));
            let (from, to, seen_m) = (place(), place(), [place(), place(), place()]);
            let seen = seen_m.map(|mean_m| Seen { mean_m, count: 1 });
            let points =
                seen.into_iter().enumerate().map(|(index, seen)| ((index as i64, 0), seen)).collect();
            let reach = 0.6;
            let found = SeenPoints { points, ..SeenPoints::default() }.is_open(from, to, reach);
            // Points beside or behind the start don't count; of the others, dense samples of the way tell.
            let is_ahead = |point: &Point2<f64>| {
                (point.x - from.x) * (to.x - from.x) + (point.y - from.y) * (to.y - from.y) > 0.0
            };
            let samples = (0..=4000).map(|step| {
                let share = f64::from(step) / 4000.0;
                Point2::new(from.x + (to.x - from.x) * share, from.y + (to.y - from.y) * share)
            });
            let least = samples
                .flat_map(|at| {
                    seen_m
                        .iter()
                        .filter(|point| is_ahead(point))
                        .map(move |point| (point.x - at.x).hypot(point.y - at.y))
                })
                .fold(f64::INFINITY, f64::min);
            if (least - reach).abs() < 0.002 {
                continue;
            }
            assert_eq!(found, least > reach, "seed {seed}: {least} m");
            if found { open += 1 } else { shut += 1 }
        }
        assert!(open > 50 && shut > 50, "{open} open, {shut} shut");
    }
}
