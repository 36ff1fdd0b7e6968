//! Maps of slope, roughness and hazard for display and for reports, and what can be seen from where.

use nalgebra::{Matrix2, Point2, Point3, Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::frame::Cell;
use crate::heightfield::Terrain;

/// How dangerous a cell is for a vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Hazard {
    /// Below half of both limits.
    Low,
    /// Between half of a limit and the limit.
    Elevated,
    /// Beyond a limit.
    High,
    /// The map has no height there.
    Unknown,
}

/// What counts as dangerous.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HazardLimits {
    /// Slope in radians.
    pub slope_rad: f64,
    /// Roughness in metres.
    pub roughness_m: f64,
}

impl Terrain {
    /// The slope of every cell in radians (Horn 1981), row by row from the south; NaN without data.
    pub fn slope_map_rad(&self) -> Vec<f32> {
        self.map_cells(|cell| libm::atan(self.cell_gradient(cell).norm()))
    }

    /// The roughness of every cell in metres: the standard deviation of the heights of the cells within `reach` columns
    /// and rows from the plane that fits them best. NaN without data. Time is proportional to the square of the reach.
    pub fn roughness_map_m(&self, reach: u32) -> Vec<f32> {
        self.map_cells(|cell| self.roughness_m(cell, reach))
    }

    /// The hazard of every cell by slope and roughness over its direct neighbours, row by row from the south.
    pub fn hazard_map(&self, limits: &HazardLimits) -> Vec<Hazard> {
        let share = |slope: f32, roughness: f32| {
            (f64::from(slope) / limits.slope_rad).max(f64::from(roughness) / limits.roughness_m)
        };
        self.slope_map_rad()
            .into_iter()
            .zip(self.roughness_map_m(1))
            .map(|(slope, roughness)| match share(slope, roughness) {
                _ if slope.is_nan() => Hazard::Unknown,
                share if share > 1.0 => Hazard::High,
                share if share > 0.5 => Hazard::Elevated,
                _ => Hazard::Low,
            })
            .collect()
    }

    /// Whether an eye so many metres over the ground at one point sees a mark so many metres over the ground at
    /// another: whether the straight line between them stays over the ground, looked at every half cell. `false` when
    /// an end has no height.
    pub fn is_in_sight(&self, from_m: Point2<f64>, eye_m: f64, to_m: Point2<f64>, mark_m: f64) -> bool {
        let (Some(start), Some(end)) = (self.height_at(from_m), self.height_at(to_m)) else { return false };
        let (start, end) = (start + eye_m, end + mark_m);
        let ground = self.drape(from_m, to_m);
        let last = ground.len() - 1;
        ground.iter().enumerate().all(|(index, point)| {
            let share = index as f64 / last as f64;
            point.z <= start + (end - start) * share + 1e-9
        })
    }

    fn map_cells(&self, value: impl Fn(Cell) -> f64) -> Vec<f32> {
        let frame = self.frame();
        (0..frame.cell_count())
            .map(|index| {
                let cell = frame.cell(index);
                if self.is_no_data(cell) { f32::NAN } else { value(cell) as f32 }
            })
            .collect()
    }

    fn roughness_m(&self, center: Cell, reach: u32) -> f64 {
        let frame = self.frame();
        let columns = center.column.saturating_sub(reach)..=(center.column + reach).min(frame.width - 1);
        let rows = center.row.saturating_sub(reach)..=(center.row + reach).min(frame.height - 1);
        let mut points = Vec::with_capacity(((2 * reach + 1) * (2 * reach + 1)) as usize);
        for row in rows {
            for column in columns.clone() {
                if let Some(height) = self.height_of(Cell { column, row }) {
                    let east = f64::from(column) - f64::from(center.column);
                    let north = f64::from(row) - f64::from(center.row);
                    points.push(Point3::new(east, north, height));
                }
            }
        }
        deviation_from_plane(&points)
    }
}

/// The standard deviation of points from the plane that fits them best, along the third axis.
fn deviation_from_plane(points: &[Point3<f64>]) -> f64 {
    let count = points.len() as f64;
    let middle = points.iter().fold(Vector3::zeros(), |sum, point| sum + point.coords) / count;
    // The normal equations of the fit: how the plan spreads, and how the height goes with it.
    let (mut spread, mut rise) = (Matrix2::zeros(), Vector2::zeros());
    for point in points {
        let offset = point.coords - middle;
        spread += offset.xy() * offset.xy().transpose();
        rise += offset.xy() * offset.z;
    }
    let slope = slope_of_fit(spread, rise);
    let squares: f64 = points
        .iter()
        .map(|point| {
            let offset = point.coords - middle;
            let rest = offset.z - slope.x * offset.x - slope.y * offset.y;
            rest * rest
        })
        .sum();
    (squares / count).sqrt()
}

/// Solves the normal equations by Cramer's rule.
fn slope_of_fit(spread: Matrix2<f64>, rise: Vector2<f64>) -> Vector2<f64> {
    let determinant = spread.determinant();
    if determinant > 1e-12 {
        let [along_east, along_north] = [spread.column(0).into_owned(), spread.column(1).into_owned()];
        let east = Matrix2::from_columns(&[rise, along_north]).determinant();
        let north = Matrix2::from_columns(&[along_east, rise]).determinant();
        return Vector2::new(east, north) / determinant;
    }
    // Points along one line leave the slope across it open.
    let (east, north) = (spread[(0, 0)], spread[(1, 1)]);
    if east > 0.0 {
        Vector2::new(rise.x / east, 0.0)
    } else if north > 0.0 {
        Vector2::new(0.0, rise.y / north)
    } else {
        Vector2::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::GridFrame;

    fn terrain(height: impl Fn(f64, f64) -> f64) -> Terrain {
        let frame = GridFrame::new(30, 20, 1.0);
        let heights = (0..frame.cell_count())
            .map(|index| {
                let center = frame.center_m(frame.cell(index));
                height(center.x, center.y) as f32
            })
            .collect();
        Terrain::new(frame, heights)
    }

    fn at(map: &[f32], column: usize, row: usize) -> f32 {
        map[row * 30 + column]
    }

    #[test]
    fn a_slope_is_steep_but_not_rough() {
        let plane = terrain(|x, y| 0.5 * x - 0.25 * y);
        let slope = at(&plane.slope_map_rad(), 10, 10);
        assert!((slope - (0.3125_f32).sqrt().atan()).abs() < 1e-5);
        assert!(at(&plane.roughness_map_m(2), 10, 10) < 1e-6);
        assert!(at(&plane.roughness_map_m(2), 0, 19) < 1e-6);
    }

    #[test]
    fn a_chequered_ground_is_rough_but_not_steep() {
        let board = terrain(|x, y| if (x.floor() + y.floor()) as i64 % 2 == 0 { 0.3 } else { -0.3 });
        assert!(at(&board.slope_map_rad(), 10, 10) < 1e-6);
        // Nine cells of ±0.3 whose mean is a thirtieth: √(0.09 - 1/900).
        let expected = (0.09_f32 - 1.0 / 900.0).sqrt();
        assert!((at(&board.roughness_map_m(1), 10, 10) - expected).abs() < 1e-5);
        let limits = HazardLimits { slope_rad: 0.35, roughness_m: 0.2 };
        assert_eq!(board.hazard_map(&limits)[10 * 30 + 10], Hazard::High);
        let limits = HazardLimits { slope_rad: 0.35, roughness_m: 0.5 };
        assert_eq!(board.hazard_map(&limits)[10 * 30 + 10], Hazard::Elevated);
    }

    #[test]
    fn a_ridge_hides_what_is_behind_it() {
        let ridge = terrain(|x, _| if (14.0..16.0).contains(&x) { 3.0 } else { 0.0 });
        assert!(!ridge.is_in_sight(Point2::new(5.0, 5.0), 1.0, Point2::new(25.0, 5.0), 1.0));
        assert!(ridge.is_in_sight(Point2::new(5.0, 5.0), 4.0, Point2::new(25.0, 5.0), 4.0));
        assert!(ridge.is_in_sight(Point2::new(5.0, 5.0), 1.0, Point2::new(12.0, 5.0), 1.0));
        assert!(!ridge.is_in_sight(Point2::new(5.0, 5.0), 1.0, Point2::new(99.0, 5.0), 1.0));
    }
}
