//! The ground as the renderer wants it: heights with normals, sampling, and where a ray meets it.

use std::sync::Arc;

use glam::{Vec2, Vec3};

/// Heights on a regular grid; row 0 is the southernmost, column 0 the westernmost.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Meters per cell.
    pub cell_m: f32,
    /// Mission coordinates of the center of cell (0, 0).
    pub origin_m: Vec2,
    /// Heights in meters, row by row.
    pub heights_m: Arc<[f32]>,
    /// Least and greatest height.
    pub range_m: [f32; 2],
}

impl Ground {
    /// Makes ground of `heights_m`, row by row from the south. Heights that are not numbers count as the least one.
    pub fn new(width: u32, height: u32, cell_m: f32, origin_m: Vec2, heights_m: &[f32]) -> Self {
        let finite = heights_m.iter().copied().filter(|height| height.is_finite());
        let (low, high) = finite.fold((f32::MAX, f32::MIN), |(low, high), z| (low.min(z), high.max(z)));
        let range_m = if low <= high { [low, high] } else { [0.0, 0.0] };
        let mut heights: Vec<f32> =
            heights_m.iter().map(|&height| if height.is_finite() { height } else { range_m[0] }).collect();
        heights.resize(width as usize * height as usize, range_m[0]);
        Self { width, height, cell_m, origin_m, heights_m: heights.into(), range_m }
    }

    /// Flat ground of `size_m`, for a mission that names no terrain.
    pub fn flat(center_m: Vec2, size_m: f32) -> Self {
        let cells = 64;
        let cell_m = size_m / (cells - 1) as f32;
        let heights = vec![0.0; (cells * cells) as usize];
        Self::new(cells, cells, cell_m, center_m - Vec2::splat(size_m / 2.0), &heights)
    }

    /// Extent east and north in meters.
    pub fn size_m(&self) -> Vec2 {
        Vec2::new((self.width.max(1) - 1) as f32, (self.height.max(1) - 1) as f32) * self.cell_m
    }

    /// The middle, at the height of the ground.
    pub fn center_m(&self) -> Vec3 {
        let center = self.origin_m + self.size_m() / 2.0;
        center.extend(self.height_at(center))
    }

    fn cell_height(&self, column: i64, row: i64) -> f32 {
        let column = column.clamp(0, i64::from(self.width) - 1) as usize;
        let row = row.clamp(0, i64::from(self.height) - 1) as usize;
        self.heights_m[row * self.width as usize + column]
    }

    /// The height at a place, bilinear, that of the border outside.
    pub fn height_at(&self, place_m: Vec2) -> f32 {
        let cell = (place_m - self.origin_m) / self.cell_m;
        let floor = cell.floor();
        let part = cell - floor;
        let (column, row) = (floor.x as i64, floor.y as i64);
        let south =
            self.cell_height(column, row) * (1.0 - part.x) + self.cell_height(column + 1, row) * part.x;
        let north = self.cell_height(column, row + 1) * (1.0 - part.x)
            + self.cell_height(column + 1, row + 1) * part.x;
        south * (1.0 - part.y) + north * part.y
    }

    /// The place on the ground.
    pub fn drape(&self, place_m: Vec2, lift_m: f32) -> Vec3 {
        place_m.extend(self.height_at(place_m) + lift_m)
    }

    /// The upward unit normal of a cell.
    pub fn cell_normal(&self, column: u32, row: u32) -> Vec3 {
        let (column, row) = (i64::from(column), i64::from(row));
        let east = self.cell_height(column + 1, row) - self.cell_height(column - 1, row);
        let north = self.cell_height(column, row + 1) - self.cell_height(column, row - 1);
        Vec3::new(-east, -north, 2.0 * self.cell_m).normalize()
    }

    /// The upward unit normal at a place, over a base as long as a vehicle.
    pub fn normal_at(&self, place_m: Vec2, base_m: f32) -> Vec3 {
        let half = base_m.max(self.cell_m * 0.5);
        let east = self.height_at(place_m + Vec2::X * half) - self.height_at(place_m - Vec2::X * half);
        let north = self.height_at(place_m + Vec2::Y * half) - self.height_at(place_m - Vec2::Y * half);
        Vec3::new(-east, -north, 2.0 * half).normalize()
    }

    /// The place of the map that is nearest to a place.
    pub fn nearest(&self, place_m: Vec2) -> Vec2 {
        place_m.clamp(self.origin_m, self.origin_m + self.size_m())
    }

    /// Returns whether a place is on the map.
    pub fn contains(&self, place_m: Vec2) -> bool {
        let cell = (place_m - self.origin_m) / self.cell_m;
        cell.x >= 0.0
            && cell.y >= 0.0
            && cell.x <= (self.width - 1) as f32
            && cell.y <= (self.height - 1) as f32
    }

    /// Returns where a ray first meets the ground on the map.
    pub fn hit(&self, origin_m: Vec3, direction: Vec3) -> Option<Vec3> {
        let step = self.cell_m * 0.5;
        let (mut near, mut far) = (0.0_f32, 20_000.0_f32);
        // Skip to the slab of heights that the ground has.
        if direction.z.abs() > 1e-6 {
            let top = (self.range_m[1] - origin_m.z) / direction.z;
            let bottom = (self.range_m[0] - 0.01 - origin_m.z) / direction.z;
            near = near.max(top.min(bottom));
            far = far.min(top.max(bottom));
        }
        let mut before = near;
        let mut along = near;
        while along <= far + step {
            let point = origin_m + direction * along;
            if point.z <= self.height_at(point.truncate()) {
                let (mut above, mut below) = (before, along);
                for _ in 0..16 {
                    let middle = f32::midpoint(above, below);
                    let point = origin_m + direction * middle;
                    if point.z <= self.height_at(point.truncate()) {
                        below = middle;
                    } else {
                        above = middle;
                    }
                }
                let place = (origin_m + direction * below).truncate();
                return self.contains(place).then(|| self.drape(place, 0.0));
            }
            before = along;
            along += step.max((along - near) * 0.001);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_meets_a_slope_where_it_crosses_it() {
        let heights: Vec<f32> = (0..100).map(|index| (index % 10) as f32).collect();
        let ground = Ground::new(10, 10, 1.0, Vec2::ZERO, &heights);
        let hit = ground.hit(Vec3::new(4.0, 5.0, 50.0), Vec3::new(0.0, 0.0, -1.0)).expect("above the map");
        assert!((hit - Vec3::new(4.0, 5.0, 4.0)).length() < 0.01, "{hit}");
        assert!(ground.hit(Vec3::new(40.0, 5.0, 50.0), Vec3::new(0.0, 0.0, -1.0)).is_none());
    }

    #[test]
    fn the_normal_of_a_plane_leans_downhill() {
        let heights: Vec<f32> = (0..100).map(|index| (index % 10) as f32).collect();
        let ground = Ground::new(10, 10, 1.0, Vec2::ZERO, &heights);
        let expected = Vec3::new(-1.0, 0.0, 1.0).normalize();
        assert!((ground.cell_normal(5, 5) - expected).length() < 1e-5);
        assert!((ground.normal_at(Vec2::new(5.0, 5.0), 1.0) - expected).length() < 1e-5);
    }
}
