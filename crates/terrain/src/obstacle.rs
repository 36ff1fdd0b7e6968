//! Obstacles as a mission declares them, and the cells that they touch.

use serde::{Deserialize, Serialize};

use crate::frame::{Cell, GridFrame};

/// The shape of an obstacle, in metres east and north.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Obstacle {
    /// A disc.
    Circle {
        /// The centre.
        center_m: [f64; 2],
        /// The radius.
        radius_m: f64,
    },
    /// A simple polygon; its last corner is joined to its first.
    Polygon {
        /// The corners, in either order of turning.
        corners_m: Vec<[f64; 2]>,
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

    /// Whether a point lies in the shape or on its border.
    pub fn contains(&self, point_m: [f64; 2]) -> bool {
        match self {
            Self::Circle { center_m, radius_m } => {
                squared_distance(*center_m, point_m) <= radius_m * radius_m
            }
            Self::Polygon { corners_m } => polygon_contains(corners_m, point_m),
        }
    }

    /// The least and greatest cells that the shape's bounding box meets; `None` when it misses the grid.
    fn cell_box(&self, frame: &GridFrame) -> Option<[Cell; 2]> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let mut cover = |point: [f64; 2], margin: f64| {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis] - margin);
                high[axis] = high[axis].max(point[axis] + margin);
            }
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
        let low = frame.to_metres([f64::from(cell.column), f64::from(cell.row)]);
        let high = frame.to_metres([f64::from(cell.column) + 1.0, f64::from(cell.row) + 1.0]);
        match self {
            Self::Circle { center_m, radius_m } => {
                let nearest = [center_m[0].clamp(low[0], high[0]), center_m[1].clamp(low[1], high[1])];
                squared_distance(*center_m, nearest) <= radius_m * radius_m
            }
            Self::Polygon { corners_m } => {
                let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])];
                polygon_contains(corners_m, middle)
                    || sides(corners_m).any(|(a, b)| segment_meets_box(a, b, low, high))
            }
        }
    }
}

fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (east, north) = (a[0] - b[0], a[1] - b[1]);
    east * east + north * north
}

/// The sides of a polygon.
fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Whether a polygon contains a point, by the parity of crossings; its border may count either way.
fn polygon_contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let mut inside = false;
    for (a, b) in sides(corners) {
        if (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) {
            inside = !inside;
        }
    }
    inside
}

/// Whether a segment shares a point with a closed box: clipping after Liang and Barsky (1984).
pub(crate) fn segment_meets_box(a: [f64; 2], b: [f64; 2], low: [f64; 2], high: [f64; 2]) -> bool {
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
        let disc = Obstacle::Circle { center_m: [2.5, 2.5], radius_m: 0.6 };
        assert_eq!(cells(&disc, &frame), [(2, 1), (1, 2), (2, 2), (3, 2), (2, 3)]);
    }

    #[test]
    fn a_thin_polygon_takes_the_cells_it_passes_without_holding_a_centre() {
        let frame = GridFrame::new(4, 3, 1.0);
        let sliver = Obstacle::Polygon { corners_m: vec![[0.1, 1.1], [3.9, 1.2], [3.9, 1.15]] };
        assert_eq!(cells(&sliver, &frame), [(0, 1), (1, 1), (2, 1), (3, 1)]);
    }

    #[test]
    fn an_obstacle_beyond_the_map_takes_no_cell() {
        let frame = GridFrame::new(4, 4, 1.0);
        let away = Obstacle::Circle { center_m: [-9.0, 2.0], radius_m: 3.0 };
        assert_eq!(cells(&away, &frame), []);
        let nothing = Obstacle::Polygon { corners_m: vec![] };
        assert_eq!(cells(&nothing, &frame), []);
    }
}
