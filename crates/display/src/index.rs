//! Finding shapes by place: grids of doubling cell size, each shape in the finest grid of which it covers few cells.
//!
//! Built in linear time by counting. A view that is zoomed out skips the grids whose shapes are too small to see.

use serde::{Deserialize, Serialize};

use crate::geometry::Rect;

/// Shapes by place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpatialIndex<T> {
    bounds: Rect,
    grids: Vec<Grid<T>>,
}

/// Shapes of about one size, by the cell that holds their upper left corner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Grid<T> {
    /// Cells are squares of this size, and no shape of the grid is larger.
    cell_size: f64,
    columns: u32,
    rows: u32,
    /// Where each cell's shapes begin in `shapes`; one more than there are cells.
    starts: Vec<u32>,
    shapes: Vec<(Rect, T)>,
}

/// Cell size of the finest grid.
const FINEST_CELL: f64 = 64.0;

impl<T> Default for SpatialIndex<T> {
    fn default() -> Self {
        Self { bounds: Rect::default(), grids: Vec::new() }
    }
}

impl<T: Copy> SpatialIndex<T> {
    /// Indexes shapes by their rectangles, which lie in `bounds`; those that stick out are found by the part inside.
    pub fn new(bounds: Rect, shapes: Vec<(Rect, T)>) -> Self {
        let finest = finest_cell(bounds, shapes.len());
        let mut levels: Vec<Vec<(Rect, T)>> = Vec::new();
        for (rect, shape) in shapes {
            let level = level_of(rect, finest);
            if levels.len() <= level {
                levels.resize_with(level + 1, Vec::new);
            }
            levels[level].push((rect, shape));
        }
        let mut cell_size = finest;
        let grids = levels.into_iter().map(|shapes| {
            let grid = Grid::new(bounds, cell_size, &shapes);
            cell_size *= 2.0;
            grid
        });
        Self { bounds, grids: grids.collect() }
    }

    /// Calls `visit` for every shape that touches `area` and is at least `min_size` wide or high.
    pub fn visit(&self, area: Rect, min_size: f64, visit: &mut dyn FnMut(T)) {
        for grid in self.grids.iter().filter(|grid| grid.cell_size >= min_size && !grid.shapes.is_empty()) {
            grid.visit(self.bounds, area, min_size, visit);
        }
    }
}

impl<T: Copy> Grid<T> {
    fn new(bounds: Rect, cell_size: f64, shapes: &[(Rect, T)]) -> Self {
        let columns = (bounds.width() / cell_size).max(0.0) as u32 + 1;
        let rows = (bounds.height() / cell_size).max(0.0) as u32 + 1;
        let mut grid = Self { cell_size, columns, rows, starts: Vec::new(), shapes: Vec::new() };
        let cells: Vec<u32> = shapes.iter().map(|(rect, _)| grid.cell_of(bounds, *rect)).collect();
        grid.starts = vec![0; columns as usize * rows as usize + 1];
        for &cell in &cells {
            grid.starts[cell as usize + 1] += 1;
        }
        for cell in 1..grid.starts.len() {
            grid.starts[cell] += grid.starts[cell - 1];
        }
        let mut next = grid.starts.clone();
        let mut order = vec![0_u32; shapes.len()];
        for (at, &cell) in cells.iter().enumerate() {
            order[next[cell as usize] as usize] = at as u32;
            next[cell as usize] += 1;
        }
        grid.shapes = order.into_iter().map(|at| shapes[at as usize]).collect();
        grid
    }

    fn column(&self, bounds: Rect, x: f64) -> u32 {
        (((x - bounds.min.x) / self.cell_size).max(0.0) as u32).min(self.columns - 1)
    }

    fn row(&self, bounds: Rect, y: f64) -> u32 {
        (((y - bounds.min.y) / self.cell_size).max(0.0) as u32).min(self.rows - 1)
    }

    fn cell_of(&self, bounds: Rect, rect: Rect) -> u32 {
        self.row(bounds, rect.min.y) * self.columns + self.column(bounds, rect.min.x)
    }

    fn visit(&self, bounds: Rect, area: Rect, min_size: f64, visit: &mut dyn FnMut(T)) {
        // A shape that begins up to one cell to the left or above may reach into the area.
        let (left, right) =
            (self.column(bounds, area.min.x - self.cell_size), self.column(bounds, area.max.x));
        let (top, bottom) = (self.row(bounds, area.min.y - self.cell_size), self.row(bounds, area.max.y));
        for row in top..=bottom {
            let first = self.starts[(row * self.columns + left) as usize] as usize;
            let last = self.starts[(row * self.columns + right) as usize + 1] as usize;
            for (rect, shape) in &self.shapes[first..last] {
                if rect.touches(area) && rect.width().max(rect.height()) >= min_size {
                    visit(*shape);
                }
            }
        }
    }
}

/// The finest cell size that leaves about as many cells as there are shapes.
fn finest_cell(bounds: Rect, count: usize) -> f64 {
    let mut cell = FINEST_CELL;
    while (bounds.width() / cell + 1.0) * (bounds.height() / cell + 1.0) > 2.0 * count as f64 + 64.0 {
        cell *= 2.0;
    }
    cell
}

/// The finest grid whose cells are no smaller than `rect`.
fn level_of(rect: Rect, finest: f64) -> usize {
    let size = rect.width().max(rect.height());
    let mut level = 0;
    let mut cell = finest;
    while cell < size {
        cell *= 2.0;
        level += 1;
    }
    level
}
