//! Where a grid lies in the world: its cells, its corner, and the way between meters and cells.

use nalgebra::{Point2, Vector2};
use serde::{Deserialize, Serialize};

/// One cell of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Cell {
    /// From 0 in the west.
    pub column: u32,
    /// From 0 in the south.
    pub row: u32,
}

/// The extent of a grid of square cells. A value of a cell belongs to the cell's center.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GridFrame {
    /// Cells from west to east.
    pub width: u32,
    /// Cells from south to north.
    pub height: u32,
    /// The side of a cell in meters.
    pub cell_size_m: f64,
    /// The south-west corner of the grid in meters east and north.
    pub origin_m: Point2<f64>,
}

impl GridFrame {
    /// A frame whose south-west corner is the origin.
    pub const fn new(width: u32, height: u32, cell_size_m: f64) -> Self {
        Self { width, height, cell_size_m, origin_m: Point2::new(0.0, 0.0) }
    }

    /// The number of cells.
    pub const fn cell_count(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Meters from west to east and from south to north.
    pub fn extent_m(&self) -> Vector2<f64> {
        Vector2::new(f64::from(self.width), f64::from(self.height)) * self.cell_size_m
    }

    /// The north-east corner in meters.
    pub fn far_corner_m(&self) -> Point2<f64> {
        self.origin_m + self.extent_m()
    }

    /// The place of a cell in row-major storage, southernmost row first.
    pub const fn index(&self, cell: Cell) -> usize {
        cell.row as usize * self.width as usize + cell.column as usize
    }

    /// The cell at a place in row-major storage.
    pub const fn cell(&self, index: usize) -> Cell {
        Cell { column: (index % self.width as usize) as u32, row: (index / self.width as usize) as u32 }
    }

    /// A point in units of cells from the south-west corner.
    pub fn to_cells(&self, point_m: Point2<f64>) -> Point2<f64> {
        ((point_m - self.origin_m) / self.cell_size_m).into()
    }

    /// A point given in units of cells from the south-west corner, in meters.
    pub fn to_meters(&self, point_cells: Point2<f64>) -> Point2<f64> {
        self.origin_m + point_cells.coords * self.cell_size_m
    }

    /// Returns whether a point lies in the grid or on its border.
    pub fn contains(&self, point_m: Point2<f64>) -> bool {
        let far = self.far_corner_m();
        (0..2).all(|axis| point_m[axis] >= self.origin_m[axis] && point_m[axis] <= far[axis])
    }

    /// The cell that holds a point. A cell holds its west and south border; the grid's east and north border belong
    /// to its last cells. `None` outside the grid and for a point that is not a number.
    pub fn cell_at(&self, point_m: Point2<f64>) -> Option<Cell> {
        if self.width == 0 || self.height == 0 || !self.contains(point_m) {
            return None;
        }
        let point = self.to_cells(point_m);
        Some(Cell {
            column: (point.x as u32).min(self.width - 1),
            row: (point.y as u32).min(self.height - 1),
        })
    }

    /// The center of a cell in meters.
    pub fn center_m(&self, cell: Cell) -> Point2<f64> {
        self.to_meters(Point2::new(f64::from(cell.column) + 0.5, f64::from(cell.row) + 0.5))
    }
}
