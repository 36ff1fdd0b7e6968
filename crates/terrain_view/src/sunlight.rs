//! Which ground the sun reaches: an image of the shadows that hills and obstacles throw.
//!
//! The image is swept once, away from the sun: the shadow over a pixel is as high as that over its neighbor toward the
//! sun, less what the light falls on the way. It takes time linear in its pixels, and is made again only when the ground,
//! the obstacles or the sun have changed.

use glam::{Vec2, Vec3};

use crate::ground::Ground;
use crate::outline::is_inside;
use crate::volume::Volume;

/// How high the ground is, with what stands on it, in pixels that cover all of it, rows from the south.
#[derive(Clone, Debug)]
pub struct Relief {
    width: u32,
    height: u32,
    pixel_m: Vec2,
    heights_m: Vec<f32>,
}

/// How much of the sun reaches the ground: 0 in the shadow, 255 in the light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sunlight {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Rows from the south.
    pub pixels: Vec<u8>,
}

/// Larger images are slow to sweep while the sun moves.
const MAX_SIDE: u32 = 768;
/// Pixels per cell of a coarse map, at most.
const MAX_PER_CELL: u32 = 4;
/// The height over which light fades to shadow, as a part of what light falls over a pixel; edges are soft by it.
const SOFT_PIXELS: f32 = 1.2;

impl Relief {
    /// The relief of `ground` with `volumes` on it.
    pub fn new(ground: &Ground, volumes: &[Volume]) -> Self {
        let side = ground.width.max(ground.height).max(1);
        let per_cell = (MAX_SIDE / side).clamp(1, MAX_PER_CELL);
        let pixels = |cells: u32| (cells * per_cell).clamp(1, MAX_SIDE);
        let (width, height) = (pixels(ground.width), pixels(ground.height));
        let cells = Vec2::new(ground.width as f32, ground.height as f32);
        let pixel_m = cells * ground.cell_m / Vec2::new(width as f32, height as f32);
        // Pixel (0, 0) has the south-west corner of cell (0, 0).
        let corner = ground.origin_m - ground.cell_m / 2.0;
        let place = |column: u32, row: u32| corner + (Vec2::new(column as f32, row as f32) + 0.5) * pixel_m;
        let mut heights_m: Vec<f32> = (0..height)
            .flat_map(|row| (0..width).map(move |column| (column, row)))
            .map(|(column, row)| ground.height_at(place(column, row)))
            .collect();
        for volume in volumes {
            let [low, high] = volume.bounds();
            let first = ((low - corner) / pixel_m).floor().max(Vec2::ZERO);
            let last = ((high - corner) / pixel_m).ceil().min(Vec2::new(width as f32, height as f32));
            for row in first.y as u32..last.y.max(0.0) as u32 {
                for column in first.x as u32..last.x.max(0.0) as u32 {
                    let at = place(column, row);
                    if is_inside(&volume.outline_m, at)
                        && let Some(height_m) = heights_m.get_mut((row * width + column) as usize)
                    {
                        *height_m = height_m.max(ground.height_at(at) + volume.height_m);
                    }
                }
            }
        }
        Self { width, height, pixel_m, heights_m }
    }

    /// Returns where the light of a sun in the direction `toward` reaches.
    pub fn lit_from(&self, toward: Vec3) -> Sunlight {
        let flat = toward.truncate().length();
        let (width, height) = (self.width as usize, self.height as usize);
        let mut pixels = vec![255; self.heights_m.len()];
        if flat < 1e-3 {
            return Sunlight { width: self.width, height: self.height, pixels };
        }
        // Pixels toward the sun, at least one of them whole.
        let way = toward.truncate() / flat / self.pixel_m;
        let along_columns = way.x.abs() >= way.y.abs();
        let (lines, across, step) = if along_columns {
            (width, height, way / way.x.abs())
        } else {
            (height, width, way / way.y.abs())
        };
        let (forward, aside) = if along_columns { (step.x, step.y) } else { (step.y, step.x) };
        let fall_m = (step * self.pixel_m).length() * toward.z / flat;
        let soft_m = (fall_m * SOFT_PIXELS).max(0.02);
        let index = |line: usize, place: usize| {
            if along_columns { place * width + line } else { line * width + place }
        };
        let mut before: Vec<f32> = Vec::new();
        let mut shadow_m = vec![0.0; across];
        for turn in 0..lines {
            // The first line is the one at the border that faces the sun.
            let line = if forward > 0.0 { lines - 1 - turn } else { turn };
            for (place, shadow_m) in shadow_m.iter_mut().enumerate() {
                let at = index(line, place);
                let ground_m = self.heights_m[at];
                let thrown_m = between(&before, place as f32 + aside) - fall_m;
                *shadow_m = ground_m.max(thrown_m);
                let depth = ((thrown_m - ground_m) / soft_m).clamp(0.0, 1.0);
                pixels[at] = (255.0 * (1.0 - depth)).round() as u8;
            }
            before.clone_from(&shadow_m);
        }
        Sunlight { width: self.width, height: self.height, pixels }
    }
}

/// The value between two neighbors of a line; nothing is thrown from beyond the map.
fn between(line: &[f32], at: f32) -> f32 {
    let floor = at.floor();
    let part = at - floor;
    let value = |index: f32| {
        if index < 0.0 {
            f32::NEG_INFINITY
        } else {
            line.get(index as usize).copied().unwrap_or(f32::NEG_INFINITY)
        }
    };
    if part < 1e-4 { value(floor) } else { value(floor) * (1.0 - part) + value(floor + 1.0) * part }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat() -> Ground {
        Ground::new(200, 200, 1.0, Vec2::splat(0.5), &vec![0.0; 200 * 200])
    }

    fn lit(light: &Sunlight, east_m: f32, north_m: f32) -> u8 {
        let pixel = |meters: f32, pixels: u32| (meters / 200.0 * pixels as f32) as u32;
        light.pixels[(pixel(north_m, light.height) * light.width + pixel(east_m, light.width)) as usize]
    }

    fn tower() -> Volume {
        let corners = [[95.0, 95.0], [105.0, 95.0], [105.0, 105.0], [95.0, 105.0]];
        Volume { outline_m: corners.map(Vec2::from).to_vec(), height_m: 20.0 }
    }

    #[test]
    fn a_tower_throws_a_shadow_as_long_as_it_is_high_away_from_a_sun_at_45_degrees() {
        let relief = Relief::new(&flat(), &[tower()]);
        for (toward, shade, light) in [
            (Vec3::new(-1.0, 0.0, 1.0), [120.0, 100.0], [80.0, 100.0]),
            (Vec3::new(1.0, 0.0, 1.0), [80.0, 100.0], [120.0, 100.0]),
            (Vec3::new(0.0, -1.0, 1.0), [100.0, 120.0], [100.0, 80.0]),
            (Vec3::new(0.0, 1.0, 1.0), [100.0, 80.0], [100.0, 120.0]),
            (Vec3::new(-1.0, -0.8, 1.2), [112.0, 110.0], [88.0, 90.0]),
        ] {
            let swept = relief.lit_from(toward.normalize());
            assert_eq!(lit(&swept, shade[0], shade[1]), 0, "{toward}");
            assert_eq!(lit(&swept, light[0], light[1]), 255, "{toward}");
            assert_eq!(lit(&swept, 100.0, 100.0), 255, "{toward}: its roof is in the light");
        }
        let swept = relief.lit_from(Vec3::new(-1.0, 0.0, 1.0).normalize());
        assert_eq!(lit(&swept, 128.0, 100.0), 255, "the shadow ends 20 m behind the tower");
    }

    #[test]
    fn a_sun_straight_above_throws_no_shadow_and_level_ground_has_none() {
        let relief = Relief::new(&flat(), &[tower()]);
        assert!(relief.lit_from(Vec3::Z).pixels.iter().all(|&light| light == 255));
        let level = Relief::new(&flat(), &[]).lit_from(Vec3::new(0.9, 0.3, 0.2).normalize());
        assert!(level.pixels.iter().all(|&light| light == 255));
    }
}
