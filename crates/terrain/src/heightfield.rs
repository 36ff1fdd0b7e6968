//! A map of heights on a regular grid, with its holes.

use serde::{Deserialize, Serialize};

use crate::frame::{Cell, GridFrame};
use crate::rock::Rock;

/// Heights at the centres of the cells of a grid. Row 0 is the southernmost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terrain {
    frame: GridFrame,
    /// Metres above the map's datum; 0 where there is no data.
    heights_m: Vec<f32>,
    /// Whether each cell is a hole; empty when none is.
    no_data: Vec<bool>,
    rocks: Vec<Rock>,
}

impl Terrain {
    /// A map from heights in metres, row by row from the south. A height that is not finite is a cell without data.
    ///
    /// # Panics
    /// When there is not one height for each cell, or a grid without cells.
    pub fn new(frame: GridFrame, mut heights_m: Vec<f32>) -> Self {
        assert_eq!(heights_m.len(), frame.cell_count(), "one height for each cell");
        assert!(!heights_m.is_empty(), "a map has cells");
        let mut no_data = Vec::new();
        if heights_m.iter().any(|height| !height.is_finite()) {
            no_data = heights_m.iter().map(|height| !height.is_finite()).collect();
            heights_m.iter_mut().filter(|height| !height.is_finite()).for_each(|height| *height = 0.0);
        }
        Self { frame, heights_m, no_data, rocks: Vec::new() }
    }

    /// A level map at height 0.
    pub fn flat(frame: GridFrame) -> Self {
        Self::new(frame, vec![0.0; frame.cell_count()])
    }

    /// The map with rocks on it. They don't change the heights.
    pub fn with_rocks(mut self, rocks: Vec<Rock>) -> Self {
        self.rocks = rocks;
        self
    }

    /// The map with another size of cells and another south-west corner (SPEC 1.8 `cell`, `origin`). Heights stay;
    /// rocks move with their cells and keep their size.
    pub fn placed(mut self, cell_size_m: f64, origin_m: [f64; 2]) -> Self {
        let frame = GridFrame { cell_size_m, origin_m, ..self.frame };
        for rock in &mut self.rocks {
            rock.center_m = frame.to_metres(self.frame.to_cells(rock.center_m));
        }
        self.frame = frame;
        self
    }

    /// Where the map lies.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Heights in metres, row by row from the south; 0 in cells without data.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Rocks known on this map: those that its maker could see on the map and the smaller ones that only a vehicle
    /// on the spot sees ([`Rock::is_mapped`]).
    pub fn rocks(&self) -> &[Rock] {
        &self.rocks
    }

    /// Whether a cell has no height.
    pub fn is_no_data(&self, cell: Cell) -> bool {
        self.no_data.get(self.frame.index(cell)).copied().unwrap_or(false)
    }

    /// The number of cells without a height.
    pub fn no_data_count(&self) -> usize {
        self.no_data.iter().filter(|&&hole| hole).count()
    }

    /// The height of a cell, if it has one. Cells beyond the border take the nearest cell's.
    fn sample(&self, column: i64, row: i64) -> Option<f64> {
        let cell = Cell {
            column: column.clamp(0, i64::from(self.frame.width) - 1) as u32,
            row: row.clamp(0, i64::from(self.frame.height) - 1) as u32,
        };
        (!self.is_no_data(cell)).then(|| f64::from(self.heights_m[self.frame.index(cell)]))
    }

    /// The height at a cell's centre in metres.
    pub fn height_of(&self, cell: Cell) -> Option<f64> {
        self.sample(i64::from(cell.column), i64::from(cell.row))
    }

    /// The height at a point in metres, interpolated between the four nearest cell centres. `None` outside the map and
    /// in a cell without data; a neighbour without data takes the height of the point's own cell.
    pub fn height_at(&self, point_m: [f64; 2]) -> Option<f64> {
        self.bilinear(point_m).map(|patch| patch.height())
    }

    /// Metres up for each metre east and for each metre north at a point, of the interpolated surface.
    pub fn gradient_at(&self, point_m: [f64; 2]) -> Option<[f64; 2]> {
        self.bilinear(point_m).map(|patch| patch.gradient(self.frame.cell_size_m))
    }

    /// The steepest slope at a point, in radians.
    pub fn slope_at(&self, point_m: [f64; 2]) -> Option<f64> {
        self.gradient_at(point_m).map(|[east, north]| libm::atan((east * east + north * north).sqrt()))
    }

    /// The upward unit normal (east, north, up) at a point.
    pub fn normal_at(&self, point_m: [f64; 2]) -> Option<[f64; 3]> {
        self.gradient_at(point_m).map(normal_of_gradient)
    }

    /// The least and the greatest height, or `None` when no cell has data.
    pub fn height_range_m(&self) -> Option<[f32; 2]> {
        let mut range: Option<[f32; 2]> = None;
        for (index, &height) in self.heights_m.iter().enumerate() {
            if !self.no_data.get(index).copied().unwrap_or(false) {
                let [low, high] = range.unwrap_or([height, height]);
                range = Some([low.min(height), high.max(height)]);
            }
        }
        range
    }

    /// Metres up for each metre east and north at a cell, over its eight neighbours (Horn 1981). 0 without data.
    pub fn cell_gradient(&self, cell: Cell) -> [f64; 2] {
        let (column, row) = (i64::from(cell.column), i64::from(cell.row));
        let Some(center) = self.sample(column, row) else { return [0.0, 0.0] };
        let near = |east: i64, north: i64| self.sample(column + east, row + north).unwrap_or(center);
        let side = |a: f64, b: f64, c: f64| a + 2.0 * b + c;
        let east = side(near(1, 1), near(1, 0), near(1, -1)) - side(near(-1, 1), near(-1, 0), near(-1, -1));
        let north = side(near(-1, 1), near(0, 1), near(1, 1)) - side(near(-1, -1), near(0, -1), near(1, -1));
        let scale = 1.0 / (8.0 * self.frame.cell_size_m);
        [east * scale, north * scale]
    }

    /// The length of the ground under a straight segment, in metres: at least its plan length. Where the map has no
    /// height the ground counts as level.
    pub fn draped_length_m(&self, from_m: [f64; 2], to_m: [f64; 2]) -> f64 {
        self.drape(from_m, to_m).windows(2).map(|pair| distance3(pair[0], pair[1])).sum()
    }

    /// Points of the ground (east, north, up) under a straight segment, no farther apart than half a cell, with both
    /// ends. Where the map has no height, the last known one goes on.
    pub fn drape(&self, from_m: [f64; 2], to_m: [f64; 2]) -> Vec<[f64; 3]> {
        let (east, north) = (to_m[0] - from_m[0], to_m[1] - from_m[1]);
        let length = (east * east + north * north).sqrt();
        let pieces = (length / (0.5 * self.frame.cell_size_m)).ceil().clamp(1.0, 1e6) as u32;
        let mut up = (0..=pieces).find_map(|piece| self.height_at(along(from_m, to_m, piece, pieces)));
        (0..=pieces)
            .map(|piece| {
                let point = along(from_m, to_m, piece, pieces);
                up = self.height_at(point).or(up);
                [point[0], point[1], up.unwrap_or(0.0)]
            })
            .collect()
    }

    fn bilinear(&self, point_m: [f64; 2]) -> Option<Patch> {
        let own = self.height_of(self.frame.cell_at(point_m)?)?;
        let [x, y] = self.frame.to_cells(point_m);
        let (column, row) = ((x - 0.5).floor(), (y - 0.5).floor());
        let near =
            |east: i64, north: i64| self.sample(column as i64 + east, row as i64 + north).unwrap_or(own);
        Some(Patch {
            corners: [near(0, 0), near(1, 0), near(0, 1), near(1, 1)],
            fraction: [x - 0.5 - column, y - 0.5 - row],
        })
    }
}

/// The upward unit normal (east, north, up) of a surface with this gradient.
pub(crate) fn normal_of_gradient([east, north]: [f64; 2]) -> [f64; 3] {
    let scale = 1.0 / (1.0 + east * east + north * north).sqrt();
    [-east * scale, -north * scale, scale]
}

/// The surface between four cell centres.
struct Patch {
    /// South-west, south-east, north-west, north-east.
    corners: [f64; 4],
    /// From the south-west centre, in cells.
    fraction: [f64; 2],
}

impl Patch {
    fn height(&self) -> f64 {
        let [x, y] = self.fraction;
        let south = self.corners[0] + (self.corners[1] - self.corners[0]) * x;
        let north = self.corners[2] + (self.corners[3] - self.corners[2]) * x;
        south + (north - south) * y
    }

    fn gradient(&self, cell_size_m: f64) -> [f64; 2] {
        let [x, y] = self.fraction;
        let [south_west, south_east, north_west, north_east] = self.corners;
        let east = (south_east - south_west) * (1.0 - y) + (north_east - north_west) * y;
        let north = (north_west - south_west) * (1.0 - x) + (north_east - south_east) * x;
        [east / cell_size_m, north / cell_size_m]
    }
}

fn along(from: [f64; 2], to: [f64; 2], piece: u32, pieces: u32) -> [f64; 2] {
    if piece == pieces {
        return to;
    }
    let fraction = f64::from(piece) / f64::from(pieces);
    [from[0] + (to[0] - from[0]) * fraction, from[1] + (to[1] - from[1]) * fraction]
}

fn distance3(a: [f64; 3], b: [f64; 3]) -> f64 {
    let offset = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
    (offset[0] * offset[0] + offset[1] * offset[1] + offset[2] * offset[2]).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane that rises 0.3 m for each metre east and falls 0.1 m for each metre north.
    fn plane() -> Terrain {
        let frame = GridFrame { width: 9, height: 7, cell_size_m: 0.5, origin_m: [10.0, -4.0] };
        let heights = (0..frame.cell_count())
            .map(|index| {
                let [x, y] = frame.center_m(frame.cell(index));
                (0.3 * x - 0.1 * y) as f32
            })
            .collect();
        Terrain::new(frame, heights)
    }

    #[test]
    fn a_plane_is_reproduced_between_cell_centres() {
        let terrain = plane();
        for point in [[10.6, -3.1], [12.0, -2.0], [14.2, -0.8]] {
            let expected = 0.3 * point[0] - 0.1 * point[1];
            assert!((terrain.height_at(point).unwrap() - expected).abs() < 1e-5);
            let [east, north] = terrain.gradient_at(point).unwrap();
            assert!((east - 0.3).abs() < 1e-4 && (north + 0.1).abs() < 1e-4);
        }
        let [east, north] = terrain.cell_gradient(Cell { column: 4, row: 3 });
        assert!((east - 0.3).abs() < 1e-4 && (north + 0.1).abs() < 1e-4);
    }

    #[test]
    fn outside_the_map_there_is_no_height() {
        assert_eq!(plane().height_at([9.9, -3.0]), None);
        assert_eq!(plane().height_at([f64::NAN, -3.0]), None);
    }

    #[test]
    fn a_hole_has_no_height_and_does_not_disturb_its_neighbours() {
        let frame = GridFrame::new(3, 1, 1.0);
        let terrain = Terrain::new(frame, vec![5.0, f32::NAN, 5.0]);
        assert_eq!(terrain.no_data_count(), 1);
        assert_eq!(terrain.height_at([1.5, 0.5]), None);
        assert_eq!(terrain.height_at([0.9, 0.5]), Some(5.0));
        assert_eq!(terrain.height_range_m(), Some([5.0, 5.0]));
    }

    #[test]
    fn the_ground_is_longer_than_the_plan_on_a_slope() {
        let length = plane().draped_length_m([10.5, -2.0], [13.5, -2.0]);
        assert!((length - 3.0 * (1.0_f64 + 0.09).sqrt()).abs() < 1e-4, "{length}");
    }
}
