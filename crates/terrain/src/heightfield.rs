//! A map of heights on a regular grid, with its holes.

use nalgebra::{Point2, Point3, UnitVector3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::frame::{Cell, GridFrame};
use crate::rock::Rock;
use crate::walk::Walk;

/// Heights at the centers of the cells of a grid. Row 0 is the southernmost.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Terrain {
    frame: GridFrame,
    /// Meters above the map's datum; 0 where there is no data.
    heights_m: Vec<f32>,
    /// Whether each cell is a hole; empty when none is.
    no_data: Vec<bool>,
    /// Whether each cell is an obstacle; empty when none is.
    obstacles: Vec<bool>,
    rocks: Vec<Rock>,
    /// The area that rocks on the map cover, in square meters.
    mapped_rock_m2: f64,
}

impl Terrain {
    /// A map from heights in meters, row by row from the south. A height that is not finite is a cell without data.
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
        Self { frame, heights_m, no_data, obstacles: Vec::new(), rocks: Vec::new(), mapped_rock_m2: 0.0 }
    }

    /// A level map at height 0.
    pub fn flat(frame: GridFrame) -> Self {
        Self::new(frame, vec![0.0; frame.cell_count()])
    }

    /// The map with obstacles, row by row from the south. Their heights are theirs alone: the ground around them does not
    /// rise toward them.
    ///
    /// # Panics
    /// When there is not one entry for each cell.
    pub fn with_obstacles(mut self, obstacles: Vec<bool>) -> Self {
        assert_eq!(obstacles.len(), self.frame.cell_count(), "one entry for each cell");
        self.obstacles = if obstacles.contains(&true) { obstacles } else { Vec::new() };
        self
    }

    /// The map with rocks on it. They don't change the heights.
    pub fn with_rocks(mut self, rocks: Vec<Rock>) -> Self {
        let area_m2 = |rock: &Rock| 0.25 * std::f64::consts::PI * rock.diameter_m * rock.diameter_m;
        self.mapped_rock_m2 = rocks.iter().filter(|rock| rock.is_mapped()).map(area_m2).sum();
        self.rocks = rocks;
        self
    }

    /// The map with another size of cells and another south-west corner (SPEC 1.8 `cell`, `origin`). Heights stay;
    /// rocks move with their cells and keep their size.
    pub fn placed(mut self, cell_size_m: f64, origin_m: Point2<f64>) -> Self {
        let frame = GridFrame { cell_size_m, origin_m, ..self.frame };
        for rock in &mut self.rocks {
            rock.center_m = frame.to_meters(self.frame.to_cells(rock.center_m));
        }
        self.frame = frame;
        self
    }

    /// Returns where the map lies.
    pub const fn frame(&self) -> &GridFrame {
        &self.frame
    }

    /// Heights in meters, row by row from the south; 0 in cells without data.
    pub fn heights_m(&self) -> &[f32] {
        &self.heights_m
    }

    /// Rocks known on this map: those that its maker could see on the map and the smaller ones that only a vehicle
    /// on the spot sees ([`Rock::is_mapped`]).
    pub fn rocks(&self) -> &[Rock] {
        &self.rocks
    }

    /// The share of the ground that rocks on the map cover: it tells how many there are that the map does not show
    /// ([`cumulative_rock_area`](crate::cumulative_rock_area)).
    pub fn mapped_rock_share(&self) -> f64 {
        let extent_m = self.frame.extent_m();
        self.mapped_rock_m2 / (extent_m.x * extent_m.y)
    }

    /// Returns whether a cell has no height.
    pub fn is_no_data(&self, cell: Cell) -> bool {
        self.no_data.get(self.frame.index(cell)).copied().unwrap_or(false)
    }

    /// Returns whether a cell is an obstacle of the map itself.
    pub fn is_obstacle(&self, cell: Cell) -> bool {
        self.obstacles.get(self.frame.index(cell)).copied().unwrap_or(false)
    }

    /// The number of cells without a height.
    pub fn no_data_count(&self) -> usize {
        self.no_data.iter().filter(|&&hole| hole).count()
    }

    /// The height of the ground in a cell, if it has one; an obstacle has none. Cells beyond the border take the nearest
    /// cell's.
    fn sample(&self, column: i64, row: i64) -> Option<f64> {
        let cell = Cell {
            column: column.clamp(0, i64::from(self.frame.width) - 1) as u32,
            row: row.clamp(0, i64::from(self.frame.height) - 1) as u32,
        };
        self.height_of(cell).filter(|_| !self.is_obstacle(cell))
    }

    /// The height at a cell's center in meters; in an obstacle, that of the obstacle.
    pub fn height_of(&self, cell: Cell) -> Option<f64> {
        (!self.is_no_data(cell)).then(|| f64::from(self.heights_m[self.frame.index(cell)]))
    }

    /// The height at a point in meters, interpolated between the four nearest cell centers. `None` outside the map and
    /// in a cell without data; a neighbor without data takes the height of the point's own cell.
    pub fn height_at(&self, point_m: Point2<f64>) -> Option<f64> {
        self.bilinear(point_m).map(|patch| patch.height())
    }

    /// Meters up for each meter east and for each meter north at a point, of the interpolated surface.
    pub fn gradient_at(&self, point_m: Point2<f64>) -> Option<Vector2<f64>> {
        self.bilinear(point_m).map(|patch| patch.gradient(self.frame.cell_size_m))
    }

    /// The steepest slope on the way along some points, in radians: of all cells that it passes, the greatest
    /// [`Self::cell_gradient`]. By the same gradient [`Occupancy`](crate::Occupancy) says which cells are too steep for a
    /// vehicle, so a path through free cells is never steeper than the vehicle climbs. What lies outside the map is level.
    /// Linear in the number of cells passed.
    pub fn steepest_slope_rad(&self, points_m: &[Point2<f64>]) -> f64 {
        let mut steepest = 0.0_f64;
        let mut take = |cell: Cell| steepest = steepest.max(self.cell_gradient(cell).norm_squared());
        points_m.iter().filter_map(|&point| self.frame.cell_at(point)).for_each(&mut take);
        for pair in points_m.windows(2) {
            let (from, to) = (self.frame.to_cells(pair[0]), self.frame.to_cells(pair[1]));
            let length = (to - from).norm();
            let are_inside = pair.iter().all(|&point| self.frame.cell_at(point).is_some());
            if length > 0.0 && are_inside {
                Walk { from, direction: (to - from) / length, length }.for_each_cell(&self.frame, &mut take);
            }
        }
        libm::atan(steepest.sqrt())
    }

    /// The upward unit normal (east, north, up) at a point.
    pub fn normal_at(&self, point_m: Point2<f64>) -> Option<UnitVector3<f64>> {
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

    /// Meters up for each meter east and north at a cell, over its eight neighbors (Horn 1981). 0 without data.
    pub fn cell_gradient(&self, cell: Cell) -> Vector2<f64> {
        let (column, row) = (i64::from(cell.column), i64::from(cell.row));
        let Some(center) = self.height_of(cell) else { return Vector2::zeros() };
        let near = |east: i64, north: i64| self.sample(column + east, row + north).unwrap_or(center);
        let side = |a: f64, b: f64, c: f64| a + 2.0 * b + c;
        let east = side(near(1, 1), near(1, 0), near(1, -1)) - side(near(-1, 1), near(-1, 0), near(-1, -1));
        let north = side(near(-1, 1), near(0, 1), near(1, 1)) - side(near(-1, -1), near(0, -1), near(1, -1));
        let scale = 1.0 / (8.0 * self.frame.cell_size_m);
        Vector2::new(east, north) * scale
    }

    /// The length of the ground under a straight segment, in meters: at least its plan length. Where the map has no
    /// height the ground counts as level.
    pub fn draped_length_m(&self, from_m: Point2<f64>, to_m: Point2<f64>) -> f64 {
        self.drape(from_m, to_m).windows(2).map(|pair| nalgebra::distance(&pair[0], &pair[1])).sum()
    }

    /// Points of the ground (east, north, up) under a straight segment, no farther apart than half a cell, with both
    /// ends. Where the map has no height, the last known one continues.
    pub fn drape(&self, from_m: Point2<f64>, to_m: Point2<f64>) -> Vec<Point3<f64>> {
        let length = nalgebra::distance(&from_m, &to_m);
        let pieces = (length / (0.5 * self.frame.cell_size_m)).ceil().clamp(1.0, 1e6) as u32;
        let mut up = (0..=pieces).find_map(|piece| self.height_at(along(from_m, to_m, piece, pieces)));
        (0..=pieces)
            .map(|piece| {
                let point = along(from_m, to_m, piece, pieces);
                up = self.height_at(point).or(up);
                Point3::new(point.x, point.y, up.unwrap_or(0.0))
            })
            .collect()
    }

    pub(crate) fn bilinear(&self, point_m: Point2<f64>) -> Option<Patch> {
        let own = self.height_of(self.frame.cell_at(point_m)?)?;
        let point = self.frame.to_cells(point_m);
        let (column, row) = ((point.x - 0.5).floor(), (point.y - 0.5).floor());
        let near =
            |east: i64, north: i64| self.sample(column as i64 + east, row as i64 + north).unwrap_or(own);
        Some(Patch {
            corners: [near(0, 0), near(1, 0), near(0, 1), near(1, 1)],
            corner: Point2::new(column + 0.5, row + 0.5),
            fraction: Vector2::new(point.x - 0.5 - column, point.y - 0.5 - row),
        })
    }
}

/// The upward unit normal (east, north, up) of a surface with this gradient.
fn normal_of_gradient(gradient: Vector2<f64>) -> UnitVector3<f64> {
    let scale = 1.0 / (1.0 + gradient.x * gradient.x + gradient.y * gradient.y).sqrt();
    UnitVector3::new_unchecked(Vector3::new(-gradient.x, -gradient.y, 1.0) * scale)
}

/// The surface between four cell centers.
pub(crate) struct Patch {
    /// Heights in the south-west, south-east, north-west and north-east.
    pub(crate) corners: [f64; 4],
    /// The south-west center, in cells.
    pub(crate) corner: Point2<f64>,
    /// From the south-west center, in cells.
    fraction: Vector2<f64>,
}

impl Patch {
    fn height(&self) -> f64 {
        let (x, y) = (self.fraction.x, self.fraction.y);
        let south = self.corners[0] + (self.corners[1] - self.corners[0]) * x;
        let north = self.corners[2] + (self.corners[3] - self.corners[2]) * x;
        south + (north - south) * y
    }

    fn gradient(&self, cell_size_m: f64) -> Vector2<f64> {
        let (x, y) = (self.fraction.x, self.fraction.y);
        let [south_west, south_east, north_west, north_east] = self.corners;
        let east = (south_east - south_west) * (1.0 - y) + (north_east - north_west) * y;
        let north = (north_west - south_west) * (1.0 - x) + (north_east - south_east) * x;
        Vector2::new(east, north) / cell_size_m
    }
}

fn along(from: Point2<f64>, to: Point2<f64>, piece: u32, pieces: u32) -> Point2<f64> {
    if piece == pieces {
        return to;
    }
    let fraction = f64::from(piece) / f64::from(pieces);
    from + (to - from) * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane that rises 0.3 m for each meter east and falls 0.1 m for each meter north.
    fn plane() -> Terrain {
        let frame = GridFrame { width: 9, height: 7, cell_size_m: 0.5, origin_m: Point2::new(10.0, -4.0) };
        let heights = (0..frame.cell_count())
            .map(|index| {
                let center = frame.center_m(frame.cell(index));
                (0.3 * center.x - 0.1 * center.y) as f32
            })
            .collect();
        Terrain::new(frame, heights)
    }

    #[test]
    fn a_plane_is_reproduced_between_cell_centers() {
        let terrain = plane();
        for point in [[10.6, -3.1], [12.0, -2.0], [14.2, -0.8]].map(Point2::from) {
            let expected = 0.3 * point[0] - 0.1 * point[1];
            assert!((terrain.height_at(point).unwrap() - expected).abs() < 1e-5);
            let gradient = terrain.gradient_at(point).unwrap();
            assert!((gradient.x - 0.3).abs() < 1e-4 && (gradient.y + 0.1).abs() < 1e-4);
        }
        let gradient = terrain.cell_gradient(Cell { column: 4, row: 3 });
        assert!((gradient.x - 0.3).abs() < 1e-4 && (gradient.y + 0.1).abs() < 1e-4);
    }

    #[test]
    fn outside_the_map_there_is_no_height() {
        assert_eq!(plane().height_at(Point2::new(9.9, -3.0)), None);
        assert_eq!(plane().height_at(Point2::new(f64::NAN, -3.0)), None);
    }

    #[test]
    fn a_hole_has_no_height_and_does_not_disturb_its_neighbors() {
        let frame = GridFrame::new(3, 1, 1.0);
        let terrain = Terrain::new(frame, vec![5.0, f32::NAN, 5.0]);
        assert_eq!(terrain.no_data_count(), 1);
        assert_eq!(terrain.height_at(Point2::new(1.5, 0.5)), None);
        assert_eq!(terrain.height_at(Point2::new(0.9, 0.5)), Some(5.0));
        assert_eq!(terrain.height_range_m(), Some([5.0, 5.0]));
    }

    #[test]
    fn the_ground_is_longer_than_the_plan_on_a_slope() {
        let length = plane().draped_length_m(Point2::new(10.5, -2.0), Point2::new(13.5, -2.0));
        assert!((length - 3.0 * (1.0_f64 + 0.09).sqrt()).abs() < 1e-4, "{length}");
    }
}
