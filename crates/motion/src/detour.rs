//! What a vehicle has seen around it, and ways around that.

use std::collections::BTreeMap;

use terrain::{Cell, CellState, ConfigurationSpace, GridFrame, Obstacle, Occupancy};

use crate::geometry::{distance, squared_distance};
use crate::laser::LaserScan;
use crate::path::Path;
use crate::search::{PlannerKind, Query, Settings, find_path};
use crate::shortcut::ShortcutSettings;

/// Seen points farther away than this are forgotten, in metres.
const MEMORY_RADIUS_M: f64 = 6.0;
/// Points that share a square of this side, in metres, are kept as their mean, which evens out the laser's noise.
const SQUARE_M: f64 = 0.05;
/// Side of a cell of the grid on which detours are looked for, in metres.
const CELL_M: f64 = 0.1;

/// Points that were seen in one square.
#[derive(Clone, Copy, Debug)]
struct Seen {
    mean_m: [f64; 2],
    count: u32,
}

impl Seen {
    /// Takes another point in. Only so many count, so that a square costs nothing more in the long run.
    fn add(&mut self, point: [f64; 2]) {
        const MOST: u32 = 50;
        self.count = (self.count + 1).min(MOST);
        let share = 1.0 / f64::from(self.count);
        for (mean, value) in self.mean_m.iter_mut().zip(point) {
            *mean += (value - *mean) * share;
        }
    }
}

/// The points of all sweeps that are still near.
#[derive(Clone, Debug, Default)]
pub(crate) struct SeenPoints {
    points: BTreeMap<(i64, i64), Seen>,
}

impl SeenPoints {
    /// Adds a sweep and forgets what is far from where it was taken.
    pub(crate) fn add(&mut self, scan: &LaserScan) {
        let near = MEMORY_RADIUS_M * MEMORY_RADIUS_M;
        self.points.retain(|_, seen| squared_distance(seen.mean_m, scan.origin_m) <= near);
        for point in scan.points_m().filter(|point| squared_distance(*point, scan.origin_m) <= near) {
            let square = point.map(|value| (value / SQUARE_M).floor() as i64);
            self.points.entry((square[0], square[1])).or_insert(Seen { mean_m: point, count: 0 }).add(point);
        }
    }

    pub(crate) fn points_m(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.points.values().map(|seen| seen.mean_m)
    }

    /// Whether a disc can go straight from one place to another without coming nearer than `reach` to a seen point that
    /// lies ahead.
    pub(crate) fn is_open(&self, from: [f64; 2], to: [f64; 2], reach: f64) -> bool {
        let length = distance(from, to);
        if length == 0.0 {
            return true;
        }
        let direction = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        self.points_m().all(|point| {
            let offset = [point[0] - from[0], point[1] - from[1]];
            let along = offset[0] * direction[0] + offset[1] * direction[1];
            if along <= 0.0 {
                return true;
            }
            let past = (along - length).max(0.0);
            let across = offset[0] * direction[1] - offset[1] * direction[0];
            across * across + past * past >= reach * reach
        })
    }

    /// The free places around a vehicle whose centre keeps `reach` metres from everything, with seen points and what is
    /// occupied on the map in the way.
    pub(crate) fn surroundings(
        &self,
        here: [f64; 2],
        reach: f64,
        map: Option<&ConfigurationSpace>,
    ) -> ConfigurationSpace {
        let count = (2.0 * MEMORY_RADIUS_M / CELL_M) as u32;
        let frame = GridFrame {
            width: count,
            height: count,
            cell_size_m: CELL_M,
            origin_m: [here[0] - MEMORY_RADIUS_M, here[1] - MEMORY_RADIUS_M],
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
fn mark_map(occupancy: &mut Occupancy, map: &ConfigurationSpace, here: [f64; 2]) {
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
    here: [f64; 2],
    path: &Path,
    progress_m: f64,
) -> Option<Path> {
    const SAMPLES: u32 = 400;
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
        let settings =
            Settings { step_m: 1.0, greatest_samples: SAMPLES, ..Settings::of(PlannerKind::RrtConnect) };
        let query = Query { start_m, goal_m };
        let found =
            find_path(surroundings, query, &settings, Some(&ShortcutSettings::default()), &mut |_| false);
        let mut path = found.path.ok()?;
        if start_m != here {
            path.points_m.insert(0, here);
        }
        Some(path)
    })
}

/// The place itself, or the nearest free one on rings around it: a vehicle that came too near to something leaves first.
fn nearest_free(surroundings: &ConfigurationSpace, here: [f64; 2]) -> Option<[f64; 2]> {
    const DIRECTIONS: u32 = 24;
    if surroundings.is_free(here) {
        return Some(here);
    }
    (1..=15).flat_map(|ring| (0..DIRECTIONS).map(move |direction| (ring, direction))).find_map(
        |(ring, direction)| {
            let angle = std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
            let radius = CELL_M * f64::from(ring);
            let place = [here[0] + radius * libm::cos(angle), here[1] + radius * libm::sin(angle)];
            surroundings.is_free(place).then_some(place)
        },
    )
}

/// The nearest place on a stretch of a path: how far along the path, and how far away, in metres.
pub(crate) fn nearest_along(path: &Path, place: [f64; 2], from_m: f64, stretch_m: f64) -> (f64, f64) {
    const STEP_M: f64 = 0.1;
    let length = path.length_m();
    (0..=(stretch_m / STEP_M) as u32 + 1)
        .filter_map(|step| {
            let along = (from_m + STEP_M * f64::from(step)).min(length);
            path.point_at(along).map(|(point, _)| (along, distance(point, place)))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((from_m, 0.0))
}
