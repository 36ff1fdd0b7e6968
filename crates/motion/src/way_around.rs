//! Another way around the obstacles: a coarse search for shorter paths than the one that a tree found.
//!
//! Shortening keeps a path on the side of every obstacle on which its tree happened to grow. This looks at the other
//! sides: Lazy Theta* (Nash, Koenig and Tovey 2010) over one place in each block of cells, the middle of the block or
//! its most open cell, within the ellipse of the points over which a shorter path could lead (Gammell, Srinivasa and
//! Barfoot 2014). Every edge is checked exactly; that blocks are coarse only means that a way may be missed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::{Point2, distance};
use terrain::{Cell, ConfigurationSpace};

use crate::path::Path;

/// How much more the rest of the way counts than the way so far: places nearer to the goal go first, and the way found
/// is at most this share longer than the shortest one over these places.
const EAGERNESS: f64 = 0.03;

/// A free path between two points that is shorter than `bound_m`, if the blocks show one. `blocks` is how many blocks
/// are made of the ground at most: twice as many look almost one and a half times as closely.
pub(crate) fn way_around(
    space: &ConfigurationSpace,
    ends_m: [Point2<f64>; 2],
    bound_m: f64,
    blocks: u32,
) -> Option<Vec<Point2<f64>>> {
    let blocks = Blocks::within(space, ends_m, bound_m, blocks)?;
    let start = blocks.block_of(space.frame().cell_at(ends_m[0])?)?;
    let goal = blocks.block_of(space.frame().cell_at(ends_m[1])?)?;
    (start != goal).then(|| Lattice::new(space, blocks, ends_m, [start, goal], bound_m).search()).flatten()
}

/// A free path between two places that is shorter than `bound_m`, found by looking at every cell: where trees do not get
/// through. Time is proportional to the cells within the ellipse of such paths.
pub fn way_over_cells(space: &ConfigurationSpace, ends_m: [Point2<f64>; 2], bound_m: f64) -> Option<Path> {
    way_around(space, ends_m, bound_m, u32::MAX).map(Path::new)
}

/// Square blocks of cells over a box of the map.
struct Blocks {
    /// The south-western cell of the box, in cells.
    low: [u32; 2],
    /// The cells beyond the box.
    end: [u32; 2],
    /// Cells along the side of a block.
    side: u32,
    columns: u32,
    rows: u32,
}

impl Blocks {
    /// Blocks over the box around the ellipse of the points over which a path shorter than `bound_m` could lead.
    fn within(space: &ConfigurationSpace, ends_m: [Point2<f64>; 2], bound_m: f64, most: u32) -> Option<Self> {
        let frame = space.frame();
        let cells = ends_m.map(|end| frame.to_cells(end));
        let bound = bound_m / frame.cell_size_m;
        let mut low = [0; 2];
        let mut end = [0; 2];
        for axis in 0..2 {
            // Half the extent of an ellipse along an axis, by its foci and the sum of the distances to them.
            let along = cells[1][axis] - cells[0][axis];
            let across = cells[1][1 - axis] - cells[0][1 - axis];
            let half = 0.5 * (bound * bound - across * across).max(along * along).sqrt();
            let middle = 0.5 * (cells[0][axis] + cells[1][axis]);
            let size = [frame.width, frame.height][axis];
            low[axis] = ((middle - half).floor().max(0.0) as u32).min(size.saturating_sub(1));
            end[axis] = ((middle + half).ceil().max(0.0) as u32).saturating_add(1).min(size);
        }
        let extent = [end[0].checked_sub(low[0])?, end[1].checked_sub(low[1])?];
        let area = f64::from(extent[0]) * f64::from(extent[1]);
        let side = (area / f64::from(most.max(1))).sqrt().ceil().max(1.0) as u32;
        Some(Self { low, end, side, columns: extent[0].div_ceil(side), rows: extent[1].div_ceil(side) })
    }

    fn block_of(&self, cell: Cell) -> Option<usize> {
        let column = cell.column.checked_sub(self.low[0])? / self.side;
        let row = cell.row.checked_sub(self.low[1])? / self.side;
        (column < self.columns && row < self.rows).then_some((row * self.columns + column) as usize)
    }

    /// The free place that represents a block: its middle, or else the middle of its most open cell.
    fn place(&self, space: &ConfigurationSpace, block: usize) -> Option<Point2<f64>> {
        let at = [block as u32 % self.columns, block as u32 / self.columns];
        let low = [0, 1].map(|axis| self.low[axis] + at[axis] * self.side);
        let end = [0, 1].map(|axis| (low[axis] + self.side).min(self.end[axis]));
        let middle = Cell { column: u32::midpoint(low[0], end[0]), row: u32::midpoint(low[1], end[1]) };
        let middle_m = space.frame().center_m(middle);
        if space.is_free(middle_m) {
            return Some(middle_m);
        }
        let corner = |[column, row]: [u32; 2]| Cell { column, row };
        Some(space.frame().center_m(space.most_open_cell(corner(low), corner(end))?))
    }

    /// The blocks around one.
    fn around(&self, block: usize) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let (column, row) = (block as u32 % columns, block as u32 / columns);
        let rows = row.saturating_sub(1)..(row + 2).min(rows);
        let across = column.saturating_sub(1)..(column + 2).min(columns);
        rows.flat_map(move |row| across.clone().map(move |column| (row * columns + column) as usize))
            .filter(move |&other| other != block)
    }
}

/// What the search knows of a block.
#[derive(Clone, Copy)]
struct Place {
    point_m: Point2<f64>,
    /// The length of the way to it, or infinity.
    cost_m: f64,
    parent: u32,
    state: State,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Unseen,
    /// There is no free place in it, or none on a shorter way.
    Barred,
    Open,
    Done,
}

/// The search over the blocks.
struct Lattice<'a> {
    space: &'a ConfigurationSpace,
    blocks: Blocks,
    ends_m: [Point2<f64>; 2],
    /// The blocks of the ends.
    ends: [usize; 2],
    bound_m: f64,
    places: Vec<Place>,
    /// By the length of a way through the block.
    open: BinaryHeap<(Reverse<u64>, Reverse<u32>)>,
}

impl<'a> Lattice<'a> {
    fn new(
        space: &'a ConfigurationSpace,
        blocks: Blocks,
        ends_m: [Point2<f64>; 2],
        ends: [usize; 2],
        bound_m: f64,
    ) -> Self {
        let unseen =
            Place { point_m: Point2::origin(), cost_m: f64::INFINITY, parent: 0, state: State::Unseen };
        let mut places = vec![unseen; blocks.columns as usize * blocks.rows as usize];
        for (end, point_m) in ends.into_iter().zip(ends_m) {
            places[end] = Place { point_m, state: State::Open, ..unseen };
        }
        places[ends[0]].cost_m = 0.0;
        places[ends[0]].parent = ends[0] as u32;
        let open = BinaryHeap::from([(Reverse(0), Reverse(ends[0] as u32))]);
        Self { space, blocks, ends_m, ends, bound_m, places, open }
    }

    fn search(mut self) -> Option<Vec<Point2<f64>>> {
        while let Some((_, Reverse(block))) = self.open.pop() {
            let block = block as usize;
            if self.places[block].state == State::Done || !self.is_reached(block) {
                continue;
            }
            self.places[block].state = State::Done;
            if block == self.ends[1] {
                return Some(self.way());
            }
            for next in self.blocks.around(block) {
                self.reach(next, self.places[block].parent);
            }
        }
        None
    }

    /// Returns whether the straight way from the parent is free, which is looked at only now; otherwise the way from
    /// the best block beside it is taken.
    fn is_reached(&mut self, block: usize) -> bool {
        let place = self.places[block];
        if place.cost_m.is_infinite() {
            return false;
        }
        if self.space.is_segment_free(self.places[place.parent as usize].point_m, place.point_m) {
            return true;
        }
        let mut best = (f64::INFINITY, place.parent);
        for other in self.blocks.around(block) {
            let beside = self.places[other];
            let cost_m = beside.cost_m + distance(&beside.point_m, &place.point_m);
            if beside.state == State::Done
                && cost_m < best.0
                && self.space.is_segment_free(beside.point_m, place.point_m)
            {
                best = (cost_m, other as u32);
            }
        }
        (self.places[block].cost_m, self.places[block].parent) = best;
        best.0 + distance(&place.point_m, &self.ends_m[1]) < self.bound_m
    }

    /// Notes that a block may be reached straight from `parent`.
    fn reach(&mut self, block: usize, parent: u32) {
        if self.places[block].state == State::Unseen {
            let [start, goal] = self.ends_m;
            let is_near =
                |point: &Point2<f64>| distance(&start, point) + distance(point, &goal) < self.bound_m;
            let point_m = self.blocks.place(self.space, block).filter(is_near);
            self.places[block].state = if point_m.is_some() { State::Open } else { State::Barred };
            self.places[block].point_m = point_m.unwrap_or_default();
        }
        let place = self.places[block];
        let from = self.places[parent as usize];
        let cost_m = from.cost_m + distance(&from.point_m, &place.point_m);
        let min_m = cost_m + distance(&place.point_m, &self.ends_m[1]);
        if place.state == State::Open && cost_m < place.cost_m && min_m < self.bound_m {
            (self.places[block].cost_m, self.places[block].parent) = (cost_m, parent);
            // Lengths are not negative, and such numbers order as their bits do.
            let rank_m = min_m + EAGERNESS * distance(&place.point_m, &self.ends_m[1]);
            self.open.push((Reverse(rank_m.to_bits()), Reverse(block as u32)));
        }
    }

    fn way(&self) -> Vec<Point2<f64>> {
        let mut points = Vec::new();
        let mut block = self.ends[1];
        loop {
            points.push(self.places[block].point_m);
            if block == self.ends[0] {
                points.reverse();
                return points;
            }
            block = self.places[block].parent as usize;
        }
    }
}

#[cfg(test)]
mod tests {
    use terrain::{CellState, GridFrame, Obstacle, Occupancy};

    use super::*;

    /// A wall of 60 m with one gap, 4 m wide and 20 m from its end.
    fn wall_with_a_gap() -> ConfigurationSpace {
        let mut map = Occupancy::free(GridFrame::new(100, 100, 0.6));
        for (south, north) in [(0.0, 18.0), (22.0, 60.0)] {
            let corners = [[29.0, south], [31.0, south], [31.0, north], [29.0, north]];
            let wall = Obstacle::Polygon { corners_m: corners.map(Point2::from).to_vec() };
            map.mark(&wall, CellState::Obstacle);
        }
        ConfigurationSpace::new(map, 1.2)
    }

    #[test]
    fn a_way_over_cells_leads_through_a_gap_and_is_as_short_as_asked() {
        let space = wall_with_a_gap();
        let ends_m = [Point2::new(10.0, 50.0), Point2::new(50.0, 50.0)];
        let way = way_over_cells(&space, ends_m, 100.0).expect("there is a gap");
        assert_eq!([way.points_m.first(), way.points_m.last()], [Some(&ends_m[0]), Some(&ends_m[1])]);
        assert!(way.is_free(&space), "{way:?}");
        // Straight to the gap and back are 72 m.
        assert!((70.0..76.0).contains(&way.length_m()), "{} m", way.length_m());
        assert!(way_over_cells(&space, ends_m, 60.0).is_none(), "it is longer");
        assert!(way_over_cells(&space.with_radius_m(2.5), ends_m, 100.0).is_none(), "the gap is too narrow");
    }
}
