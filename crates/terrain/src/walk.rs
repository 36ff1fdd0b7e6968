//! A segment walked from cell to cell of a grid, and its distance to cells, all in units of cells.

use nalgebra::{Point2, Vector2};

use crate::frame::{Cell, GridFrame};
use crate::obstacle::segment_meets_box;

/// A segment in units of cells.
pub(crate) struct Walk {
    pub(crate) from: Point2<f64>,
    pub(crate) direction: Vector2<f64>,
    pub(crate) length: f64,
}

/// A cell on a walk, and where the walk leaves it.
#[derive(Clone, Copy)]
pub(crate) struct Cursor {
    pub(crate) cell: [i64; 2],
    /// How far along the segment.
    pub(crate) at: f64,
    /// How far along the segment it crosses the next border to the side, and the next one up or down.
    pub(crate) crossings: [f64; 2],
}

impl Cursor {
    /// Returns how far along the segment it leaves this cell.
    pub(crate) fn crossing(&self) -> f64 {
        self.crossings[0].min(self.crossings[1]).max(self.at)
    }

    pub(crate) const fn cell(&self) -> Cell {
        Cell { column: self.cell[0] as u32, row: self.cell[1] as u32 }
    }

    pub(crate) fn in_frame(&self, frame: &GridFrame) -> bool {
        let inside = |value: i64, size: u32| value >= 0 && value < i64::from(size);
        inside(self.cell[0], frame.width) && inside(self.cell[1], frame.height)
    }
}

impl Walk {
    /// The point so far along the segment.
    pub(crate) fn point(&self, at: f64) -> Point2<f64> {
        self.from + self.direction * at
    }

    /// The cell of the grid so far along the segment.
    pub(crate) fn cursor(&self, at: f64, frame: &GridFrame) -> Cursor {
        let point = self.point(at);
        // Both ends are on the map, so rounding down and rounding toward zero come to the same.
        let clamp = |value: f64, size: u32| (value as i64).clamp(0, i64::from(size) - 1);
        let cell = [clamp(point[0], frame.width), clamp(point[1], frame.height)];
        Cursor { cell, at, crossings: [self.crossing_of(0, cell[0]), self.crossing_of(1, cell[1])] }
    }

    /// The cells that it passes, in order; where it leaves a cell through a corner, not the two beside it. Both ends have to
    /// be on the map.
    pub(crate) fn for_each_cell(&self, frame: &GridFrame, mut visit: impl FnMut(Cell)) {
        let mut cursor = self.cursor(0.0, frame);
        // Rounding may place a crossing just before an end on the border of the map.
        while cursor.in_frame(frame) {
            visit(cursor.cell());
            let next = cursor.crossing();
            if next >= self.length {
                break;
            }
            let crossings = cursor.crossings;
            for axis in [0, 1] {
                if crossings[axis] <= next {
                    self.advance(&mut cursor, axis, next);
                }
            }
        }
    }

    /// Returns how far along the segment it leaves a column (axis 0) or row (axis 1).
    pub(crate) fn crossing_of(&self, axis: usize, cell: i64) -> f64 {
        let direction = self.direction[axis];
        if direction > 0.0 {
            ((cell + 1) as f64 - self.from[axis]) / direction
        } else if direction < 0.0 {
            (cell as f64 - self.from[axis]) / direction
        } else {
            f64::INFINITY
        }
    }

    /// Moves the cursor to the next column (axis 0) or row (axis 1), which it enters so far along the segment.
    pub(crate) fn advance(&self, cursor: &mut Cursor, axis: usize, at: f64) {
        cursor.cell[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
        cursor.crossings[axis] = self.crossing_of(axis, cursor.cell[axis]);
        cursor.at = at;
    }
}

/// The squared distance from a point to the unit square with this south-west corner.
pub(crate) fn point_to_cell(point: Point2<f64>, low: Point2<f64>) -> f64 {
    let outside = |value: f64, low: f64| (low - value).max(value - low - 1.0).max(0.0);
    Vector2::new(outside(point.x, low.x), outside(point.y, low.y)).norm_squared()
}

/// The squared distance between a segment and the unit square with this south-west corner. When they don't meet, the
/// least distance is at an end of the segment or at a corner of the square.
pub(crate) fn segment_to_cell(a: Point2<f64>, b: Point2<f64>, low: Point2<f64>) -> f64 {
    let high = low + Vector2::repeat(1.0);
    if segment_meets_box(a, b, low, high) {
        return 0.0;
    }
    let corners = [low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)];
    corners
        .iter()
        .map(|&corner| point_to_segment(corner, a, b))
        .fold(point_to_cell(a, low).min(point_to_cell(b, low)), f64::min)
}

fn point_to_segment(point: Point2<f64>, a: Point2<f64>, b: Point2<f64>) -> f64 {
    let (side, offset) = (b - a, point - a);
    let squared = side.norm_squared();
    let share = if squared > 0.0 { (offset.dot(&side) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (offset - side * share).norm_squared()
}
