//! The places where a disc-shaped vehicle can be, answered exactly.
//!
//! A vehicle is a point and obstacles are grown by its radius, so its heading doesn't matter (SPEC 7.1). Obstacles are
//! whole square cells. The clearance map of cell centers only decides what is far from every border; near one, the
//! query measures the distance to the squares themselves. Nothing is sampled.

use nalgebra::{Point2, distance};
use serde::{Deserialize, Serialize};

use crate::connectivity::{self, Regions};
use crate::distance::{HALF_DIAGONAL, distance_to_occupied};
use crate::frame::{Cell, GridFrame};
use crate::occupancy::{CellState, Occupancy};
use crate::walk::{Cursor, Walk, point_to_cell, segment_to_cell};

/// Why a vehicle can't be at a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Collision {
    /// The point is not on the map.
    OutsideMap,
    /// Too near to a cell, or in it.
    Cell {
        /// The cell that is nearest to the point.
        cell: Cell,
        state: CellState,
    },
}

/// Where a vehicle of some radius can be on a map.
///
/// A point is free when it lies on the map, not in an occupied cell, and no nearer to one than the radius. The border
/// of the map is not an obstacle: the vehicle's center has to stay on the map. A cell holds its west and south border, as
/// in [`GridFrame::cell_at`]; a vehicle of radius 0 can't slip between two occupied cells that share a corner.
#[derive(Clone, Debug)]
pub struct ConfigurationSpace {
    occupancy: Occupancy,
    radius_m: f64,
    /// In cells, from cell centers to the nearest occupied square; minus the distance to the nearest free one inside.
    clearance: Vec<f32>,
    flags: Vec<u8>,
    regions: Regions,
    /// The corners of the least box of cells around every cell that isn't occupied, in meters.
    free_box_m: [Point2<f64>; 2],
    /// The vehicle's radius in cells.
    pub(crate) radius: f64,
}

const OCCUPIED: u8 = 1;
/// An occupied cell with a free neighbor: the nearest occupied cell of a free point is one of these.
const BORDER: u8 = 2;

/// Distances below this many cells are rounding, not geometry.
const TOLERANCE: f64 = 1e-9;
/// Covers the rounding of clearances to single precision.
const CLEARANCE_ROUNDING: f64 = 2e-3;

impl ConfigurationSpace {
    /// The free places of a vehicle whose circumradius with its margin is `radius_m`. Linear in the number of cells.
    pub fn new(occupancy: Occupancy, radius_m: f64) -> Self {
        let frame = *occupancy.frame();
        let (width, height) = (frame.width as usize, frame.height as usize);
        let occupied: Vec<bool> = occupancy.states().iter().map(|&state| state != CellState::Free).collect();
        let free: Vec<bool> = occupied.iter().map(|occupied| !occupied).collect();
        let mut clearance = distance_to_occupied(width, height, &occupied);
        for (outside, inside) in clearance.iter_mut().zip(distance_to_occupied(width, height, &free)) {
            if *outside == 0.0 {
                *outside = -inside;
            }
        }
        let radius = (radius_m / frame.cell_size_m).max(0.0);
        let flags = border_flags(width, height, &occupied);
        let regions = Regions::label(width, height, |index| {
            possibly_free(radius, f64::from(clearance[index]), flags[index] & OCCUPIED != 0)
        });
        let free_box_m = free_box_m(&frame, &free);
        Self { occupancy, radius_m: radius_m.max(0.0), clearance, flags, regions, free_box_m, radius }
    }

    /// The free places of a vehicle of another radius on the same map. What does not depend on the radius is kept.
    pub fn with_radius_m(&self, radius_m: f64) -> Self {
        let radius_m = radius_m.max(0.0);
        let frame = *self.frame();
        let radius = radius_m / frame.cell_size_m;
        let regions = Regions::label(frame.width as usize, frame.height as usize, |index| {
            possibly_free(radius, f64::from(self.clearance[index]), self.flags[index] & OCCUPIED != 0)
        });
        Self { radius_m, regions, radius, ..self.clone() }
    }

    /// Returns where the map lies.
    pub const fn frame(&self) -> &GridFrame {
        self.occupancy.frame()
    }

    /// The cells behind this space.
    pub const fn occupancy(&self) -> &Occupancy {
        &self.occupancy
    }

    /// The vehicle's radius with its margin, in meters.
    pub const fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// The south-west and north-east corners of the least box around the free places, in meters: where to sample.
    pub const fn free_box_m(&self) -> [Point2<f64>; 2] {
        self.free_box_m
    }

    /// For display: meters from each cell's center to the nearest obstacle less the radius, row by row from the south;
    /// negative where the vehicle can't be, infinite on a map without obstacles.
    pub fn clearance_map_m(&self) -> Vec<f32> {
        let size = self.frame().cell_size_m;
        self.clearance.iter().map(|&cells| (f64::from(cells) * size - self.radius_m) as f32).collect()
    }

    /// The cell with the most room among those from `low` to before `end` whose center is surely free; the first of
    /// several. Linear in their number.
    pub fn most_open_cell(&self, low: Cell, end: Cell) -> Option<Cell> {
        let frame = self.frame();
        let (columns, rows) = (low.column..end.column.min(frame.width), low.row..end.row.min(frame.height));
        let least = (self.radius + CLEARANCE_ROUNDING) as f32;
        let mut best = None;
        for row in rows {
            for column in columns.clone() {
                let cell = Cell { column, row };
                let room = self.clearance[frame.index(cell)];
                if room >= best.map_or(least, |(most, _)| most) && best.is_none_or(|(most, _)| room > most) {
                    best = Some((room, cell));
                }
            }
        }
        best.map(|(_, cell)| cell)
    }

    /// Meters from the vehicle's rim to the nearest obstacle when its center is at a point; negative in collision
    /// and infinite on a map without obstacles. `None` outside the map. Exact outside obstacles; inside one, the depth
    /// is that of the cell's center.
    pub fn clearance_m(&self, point_m: Point2<f64>) -> Option<f64> {
        let cell = self.frame().cell_at(point_m)?;
        let point = self.frame().to_cells(point_m);
        let distance = if self.is_occupied(cell) {
            f64::from(self.clearance[self.frame().index(cell)])
        } else {
            self.nearest_occupied(point, cell).map_or(f64::INFINITY, |(distance, _)| distance)
        };
        Some(distance * self.frame().cell_size_m - self.radius_m)
    }

    /// Returns whether the vehicle's center can be at a point.
    pub fn is_free(&self, point_m: Point2<f64>) -> bool {
        let Some(cell) = self.frame().cell_at(point_m) else { return false };
        self.is_free_in_cell(self.frame().to_cells(point_m), cell)
    }

    /// Returns what is in the way of a vehicle at a point; `None` when it is free.
    pub fn collision_at(&self, point_m: Point2<f64>) -> Option<Collision> {
        let Some(own) = self.frame().cell_at(point_m) else { return Some(Collision::OutsideMap) };
        let point = self.frame().to_cells(point_m);
        if self.is_free_in_cell(point, own) {
            return None;
        }
        let cell = if self.is_occupied(own) {
            own
        } else {
            self.nearest_occupied(point, own).map_or(own, |(_, cell)| cell)
        };
        Some(Collision::Cell { cell, state: self.occupancy.state(cell) })
    }

    /// Returns whether the vehicle's center can move straight from one point to another: every point between is free,
    /// to within a billionth of a cell. Time is proportional to the number of cells passed near obstacles.
    pub fn is_segment_free(&self, from_m: Point2<f64>, to_m: Point2<f64>) -> bool {
        let (Some(first), Some(_)) = (self.frame().cell_at(from_m), self.frame().cell_at(to_m)) else {
            return false;
        };
        let (from, to) = (self.frame().to_cells(from_m), self.frame().to_cells(to_m));
        let offset = to - from;
        let length = offset.norm();
        if length == 0.0 {
            return self.is_free_in_cell(from, first);
        }
        let walk = Walk { from, direction: offset / length, length };
        self.walk_is_free(&walk) && self.is_free(to_m)
    }

    /// The least clearance in meters along a straight segment, to within a hundredth of a cell and never more than it
    /// really is by that: for display and reports. `None` when an end is outside the map.
    pub fn segment_clearance_m(&self, from_m: Point2<f64>, to_m: Point2<f64>) -> Option<f64> {
        let tolerance = 0.01 * self.frame().cell_size_m;
        let mut least = self.clearance_m(from_m)?.min(self.clearance_m(to_m)?);
        let mut pieces = vec![(from_m, to_m)];
        while let Some((a, b)) = pieces.pop() {
            let length = distance(&a, &b);
            let middle = Point2::from(0.5 * (a.coords + b.coords));
            let clearance = self.clearance_m(middle)?;
            least = least.min(clearance);
            // Clearance changes by no more than the way moved.
            if clearance - 0.5 * length < least - tolerance {
                pieces.push((a, middle));
                pieces.push((middle, b));
            }
        }
        Some(least)
    }

    /// Returns whether it is proved that no path joins two points: an outer bound of the free places falls into pieces,
    /// and the points lie in different ones. `false` proves nothing. Constant time.
    pub fn are_separated(&self, a_m: Point2<f64>, b_m: Point2<f64>) -> bool {
        let (Some(a), Some(b)) = (self.frame().cell_at(a_m), self.frame().cell_at(b_m)) else { return true };
        !self.regions.joined(self.frame().index(a), self.frame().index(b))
    }

    /// Like [`Self::are_separated`] with a sixteen times finer outer bound, which also sees gaps that are only a little
    /// too narrow for the vehicle. Linear in the number of cells: for use when a search has failed. A map of more than
    /// four million cells is not looked at more finely.
    pub fn are_separated_finely(&self, a_m: Point2<f64>, b_m: Point2<f64>) -> bool {
        self.are_separated(a_m, b_m) || connectivity::are_separated_finely(self, a_m, b_m)
    }

    pub(crate) fn is_occupied(&self, cell: Cell) -> bool {
        self.flags[self.frame().index(cell)] & OCCUPIED != 0
    }

    /// Cells from the center of a cell to the nearest occupied square.
    pub(crate) fn center_clearance(&self, cell: Cell) -> f64 {
        f64::from(self.clearance[self.frame().index(cell)])
    }

    /// Returns whether a point in units of cells, which lies in `cell`, is free.
    fn is_free_in_cell(&self, point: Point2<f64>, cell: Cell) -> bool {
        if self.is_occupied(cell) {
            return false;
        }
        let center = self.center_clearance(cell);
        self.radius == 0.0
            || center - HALF_DIAGONAL - CLEARANCE_ROUNDING >= self.radius
            || !self.near_border_cell(cell, |low| point_to_cell(point, low))
    }

    /// The distance from a point in units of cells to the nearest occupied square, and its cell.
    pub(crate) fn nearest_occupied(&self, point: Point2<f64>, own: Cell) -> Option<(f64, Cell)> {
        let center = self.center_clearance(own);
        if center == f64::INFINITY {
            return None;
        }
        let reach = center + HALF_DIAGONAL + CLEARANCE_ROUNDING;
        let mut nearest: Option<(f64, Cell)> = None;
        for cell in self.border_cells_near(own, reach) {
            let squared = point_to_cell(point, Point2::new(f64::from(cell.column), f64::from(cell.row)));
            if nearest.is_none_or(|(least, _)| squared < least) {
                nearest = Some((squared, cell));
            }
        }
        nearest.map(|(squared, cell)| (squared.sqrt(), cell))
    }

    /// The occupied border cells whose square comes within `reach` of the square of `own`, or somewhat farther away.
    fn border_cells_near(&self, own: Cell, reach: f64) -> impl Iterator<Item = Cell> + '_ {
        let frame = self.frame();
        let cells = (reach.ceil() + 1.0).min(1e9) as u32;
        let columns =
            own.column.saturating_sub(cells)..=(own.column.saturating_add(cells)).min(frame.width - 1);
        let rows = own.row.saturating_sub(cells)..=(own.row.saturating_add(cells)).min(frame.height - 1);
        rows.flat_map(move |row| columns.clone().map(move |column| Cell { column, row }))
            .filter(|&cell| self.flags[self.frame().index(cell)] & BORDER != 0)
    }

    /// Returns whether some occupied border cell around `own` is nearer than the radius by a measure of squared
    /// distance.
    fn near_border_cell(&self, own: Cell, squared_distance: impl Fn(Point2<f64>) -> f64) -> bool {
        let limit = (self.radius - TOLERANCE).max(0.0);
        let limit = limit * limit;
        let width = self.frame().width as usize;
        let cells = self.radius.ceil() as usize;
        let (column, row) = (own.column as usize, own.row as usize);
        let columns = column.saturating_sub(cells)..(column + cells + 1).min(width);
        for row in row.saturating_sub(cells)..(row + cells + 1).min(self.frame().height as usize) {
            let flags = &self.flags[row * width + columns.start..row * width + columns.end];
            for (offset, &flag) in flags.iter().enumerate() {
                if flag & BORDER != 0
                    && squared_distance(Point2::new((columns.start + offset) as f64, row as f64)) < limit
                {
                    return true;
                }
            }
        }
        false
    }

    /// Follows a segment from cell to cell, leaping over what the clearance map shows to be free.
    fn walk_is_free(&self, walk: &Walk) -> bool {
        let mut at = 0.0;
        loop {
            let mut cursor = walk.cursor(at, self.frame());
            // Near obstacles, from border to border.
            loop {
                let clearance = self.center_clearance(cursor.cell());
                let spare = clearance - self.radius - HALF_DIAGONAL - CLEARANCE_ROUNDING;
                if spare >= 1.0 {
                    at = cursor.at + spare;
                    break;
                }
                let next = cursor.crossing();
                let end = next.min(walk.length);
                if spare < 0.0 && !self.piece_is_free(walk, cursor.cell(), clearance, cursor.at, end) {
                    return false;
                }
                if next >= walk.length {
                    return true;
                }
                if !self.cross(walk, &mut cursor, next) {
                    return false;
                }
                if !cursor.in_frame(self.frame()) {
                    // Both ends are on the map: rounding placed a crossing just before an end on its border.
                    return true;
                }
            }
            if at >= walk.length {
                return true;
            }
        }
    }

    /// Returns whether the piece of a segment that lies in a cell is free.
    fn piece_is_free(&self, walk: &Walk, cell: Cell, clearance: f64, start: f64, end: f64) -> bool {
        if self.is_occupied(cell) {
            return false;
        }
        if self.radius == 0.0 {
            return true;
        }
        if clearance + HALF_DIAGONAL + CLEARANCE_ROUNDING < self.radius {
            return false;
        }
        let (a, b) = (walk.point(start), walk.point(end));
        !self.near_border_cell(cell, |low| segment_to_cell(a, b, low))
    }

    /// Moves the cursor over the border that the segment crosses at `next`; `false` when it slips through a corner
    /// beside an occupied cell.
    fn cross(&self, walk: &Walk, cursor: &mut Cursor, next: f64) -> bool {
        let before = *cursor;
        let axis = usize::from(cursor.crossings[1] < cursor.crossings[0]);
        let corner = (cursor.crossings[0] - cursor.crossings[1]).abs() <= TOLERANCE;
        walk.advance(cursor, axis, next);
        if corner {
            let mut other = before;
            walk.advance(&mut other, 1 - axis, next);
            let occupied = |cursor: &Cursor| cursor.in_frame(self.frame()) && self.is_occupied(cursor.cell());
            if occupied(cursor) || occupied(&other) {
                return false;
            }
            walk.advance(cursor, 1 - axis, next);
        }
        true
    }
}

/// Returns whether some point of a cell may be free: an outer bound.
fn possibly_free(radius: f64, clearance: f64, occupied: bool) -> bool {
    !occupied && clearance + HALF_DIAGONAL + CLEARANCE_ROUNDING >= radius
}

fn free_box_m(frame: &GridFrame, free: &[bool]) -> [Point2<f64>; 2] {
    let (mut low, mut high) = ([u32::MAX; 2], [0; 2]);
    for (index, _) in free.iter().enumerate().filter(|(_, free)| **free) {
        let Cell { column, row } = frame.cell(index);
        low = [low[0].min(column), low[1].min(row)];
        high = [high[0].max(column + 1), high[1].max(row + 1)];
    }
    if low[0] > high[0] {
        return [frame.origin_m, frame.origin_m];
    }
    [low, high].map(|corner| frame.to_meters(Point2::from(corner.map(f64::from))))
}

fn border_flags(width: usize, height: usize, occupied: &[bool]) -> Vec<u8> {
    let mut flags = vec![0; occupied.len()];
    for row in 0..height {
        for column in 0..width {
            let index = row * width + column;
            if occupied[index] {
                let beside_free = (column > 0 && !occupied[index - 1])
                    || (column + 1 < width && !occupied[index + 1])
                    || (row > 0 && !occupied[index - width])
                    || (row + 1 < height && !occupied[index + width]);
                flags[index] = if beside_free { OCCUPIED | BORDER } else { OCCUPIED };
            }
        }
    }
    flags
}
