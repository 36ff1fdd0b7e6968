//! Obstacles as a mission declares them, and the cells that they touch.

use nalgebra::{Point2, Vector2, distance_squared};
use parry2d_f64::query::PointQuery as _;
use parry2d_f64::shape::Ball;
use parry2d_f64::utils::point_in_poly2d;
use serde::{Deserialize, Serialize};

use crate::frame::{Cell, GridFrame};

/// The shape of an obstacle, in meters east and north.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Obstacle {
    Circle {
        center_m: Point2<f64>,
        radius_m: f64,
    },
    /// A simple polygon; its last corner is joined to its first.
    Polygon {
        /// The corners, in either order of turning.
        corners_m: Vec<Point2<f64>>,
    },
}

impl Obstacle {
    /// Calls `mark` with every cell that shares a point with the shape, each once. A map is coarse, so a cell that is
    /// only partly covered counts whole (SPEC 7.1).
    pub fn for_each_cell(&self, frame: &GridFrame, mut mark: impl FnMut(Cell)) {
        let Some([low, high]) = self.cell_box(frame) else { return };
        for row in low.row..=high.row {
            for column in low.column..=high.column {
                let cell = Cell { column, row };
                if self.touches_cell(frame, cell) {
                    mark(cell);
                }
            }
        }
    }

    /// Returns whether a point lies in the shape; the border of a polygon may count either way.
    pub fn contains(&self, point_m: Point2<f64>) -> bool {
        match self {
            Self::Circle { center_m, radius_m } => {
                Ball::new(*radius_m).contains_local_point(&Point2::from(point_m - center_m))
            }
            Self::Polygon { corners_m } => point_in_poly2d(&point_m, corners_m),
        }
    }

    /// The least and greatest cells that the shape's bounding box meets; `None` when it misses the grid.
    fn cell_box(&self, frame: &GridFrame) -> Option<[Cell; 2]> {
        let mut low = Point2::from([f64::INFINITY; 2]);
        let mut high = Point2::from([f64::NEG_INFINITY; 2]);
        let mut cover = |point: Point2<f64>, margin: f64| {
            low = low.inf(&(point - Vector2::repeat(margin)));
            high = high.sup(&(point + Vector2::repeat(margin)));
        };
        match self {
            Self::Circle { center_m, radius_m } => cover(*center_m, *radius_m),
            Self::Polygon { corners_m } => corners_m.iter().for_each(|&corner| cover(corner, 0.0)),
        }
        let (low, high) = (frame.to_cells(low), frame.to_cells(high));
        let size = [f64::from(frame.width), f64::from(frame.height)];
        let misses = |axis: usize| !(low[axis] < size[axis] && high[axis] >= 0.0);
        if misses(0) || misses(1) {
            return None;
        }
        let clamp = |value: f64, axis: usize| value.clamp(0.0, size[axis] - 1.0) as u32;
        // A shape that ends on a border also touches the cell before it.
        Some([
            Cell { column: clamp(low[0] - 1.0, 0), row: clamp(low[1] - 1.0, 1) },
            Cell { column: clamp(high[0], 0), row: clamp(high[1], 1) },
        ])
    }

    fn touches_cell(&self, frame: &GridFrame, cell: Cell) -> bool {
        let low = frame.to_meters(Point2::new(f64::from(cell.column), f64::from(cell.row)));
        let high = frame.to_meters(Point2::new(f64::from(cell.column) + 1.0, f64::from(cell.row) + 1.0));
        match self {
            Self::Circle { center_m, radius_m } => {
                let nearest = center_m.sup(&low).inf(&high);
                distance_squared(center_m, &nearest) <= radius_m * radius_m
            }
            Self::Polygon { corners_m } => {
                let middle = Point2::from(0.5 * (low.coords + high.coords));
                point_in_poly2d(&middle, corners_m)
                    || sides(corners_m).any(|(a, b)| segment_meets_box(a, b, low, high))
            }
        }
    }
}

/// The sides of a polygon.
fn sides(corners: &[Point2<f64>]) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Returns whether a segment shares a point with a closed box: clipping after Liang and Barsky (1984).
pub(crate) fn segment_meets_box(a: Point2<f64>, b: Point2<f64>, low: Point2<f64>, high: Point2<f64>) -> bool {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let step = b[axis] - a[axis];
        if step == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return false;
            }
            continue;
        }
        let (first, second) = ((low[axis] - a[axis]) / step, (high[axis] - a[axis]) / step);
        enter = enter.max(first.min(second));
        leave = leave.min(first.max(second));
    }
    enter <= leave
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(obstacle: &Obstacle, frame: &GridFrame) -> Vec<(u32, u32)> {
        let mut cells = Vec::new();
        obstacle.for_each_cell(frame, |cell| cells.push((cell.column, cell.row)));
        cells
    }

    #[test]
    fn a_disc_takes_every_cell_it_touches() {
        let frame = GridFrame::new(5, 5, 1.0);
        let disc = Obstacle::Circle { center_m: Point2::new(2.5, 2.5), radius_m: 0.6 };
        assert_eq!(cells(&disc, &frame), [(2, 1), (1, 2), (2, 2), (3, 2), (2, 3)]);
    }

    #[test]
    fn a_thin_polygon_takes_the_cells_it_passes_without_holding_a_center() {
        let frame = GridFrame::new(4, 3, 1.0);
        let sliver =
            Obstacle::Polygon { corners_m: [[0.1, 1.1], [3.9, 1.2], [3.9, 1.15]].map(Point2::from).to_vec() };
        assert_eq!(cells(&sliver, &frame), [(0, 1), (1, 1), (2, 1), (3, 1)]);
    }

    #[test]
    fn an_obstacle_beyond_the_map_takes_no_cell() {
        let frame = GridFrame::new(4, 4, 1.0);
        let away = Obstacle::Circle { center_m: Point2::new(-9.0, 2.0), radius_m: 3.0 };
        assert_eq!(cells(&away, &frame), []);
        let nothing = Obstacle::Polygon { corners_m: vec![] };
        assert_eq!(cells(&nothing, &frame), []);
    }

    #[test]
    fn a_polygon_holds_the_points_from_which_a_ray_crosses_its_sides_an_odd_number_of_times() {
        let (mut inside, mut outside) = (0, 0);
        for seed in 0..200 {
            let mut random = crate::Random::from_seed(seed);
            let mut place = || Point2::new(random.range(0.0, 9.0), random.range(0.0, 9.0));
            let corners_m: Vec<Point2<f64>> = (0..3 + seed % 5).map(|_| place()).collect();
            for _ in 0..20 {
                let point = place();
                let crosses = |&(a, b): &(Point2<f64>, Point2<f64>)| {
                    (a.y > point.y) != (b.y > point.y)
                        && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
                };
                let is_inside = sides(&corners_m).filter(crosses).count() % 2 == 1;
                let found = Obstacle::Polygon { corners_m: corners_m.clone() }.contains(point);
                assert_eq!(found, is_inside, "seed {seed}: {point} in {corners_m:?}");
                if found { inside += 1 } else { outside += 1 }
            }
        }
        assert!(inside > 200 && outside > 200, "{inside} inside, {outside} outside");
    }
}
