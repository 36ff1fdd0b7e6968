//! What lies flat on the ground as one image: obstacles, and the clearance map under them.

use glam::Vec2;
use rmpl::program::ObstacleShape;
use theme::Tokens;

use crate::ground::Ground;
use crate::pick::{contains, nearest_part};
use crate::scene;

/// An image that covers the whole ground, rows from the south, premultiplied by its opacity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decal {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, opacity.
    pub pixels: Vec<[u8; 4]>,
}

/// The room that a vehicle has: meters from its rim to the nearest obstacle for each cell of the ground.
#[derive(Clone, Copy, Debug)]
pub struct ClearanceMap<'a> {
    /// One number per cell of the ground, rows from the south; negative where the vehicle cannot be.
    pub clearance_m: &'a [f32],
}

/// More room than this is as good as any.
pub const AMPLE_M: f32 = 10.0;
/// Larger images are no clearer, and slow to make while an obstacle is dragged.
const MAX_PIXELS: u32 = 1024;

impl Decal {
    /// Paints obstacles over the clearance map, if one is wanted; `None` when there is nothing to paint.
    pub fn paint(
        ground: &Ground,
        obstacles: &[ObstacleShape],
        clearance: Option<ClearanceMap<'_>>,
    ) -> Option<Self> {
        if obstacles.is_empty() && clearance.is_none() {
            return None;
        }
        let (width, height) = (ground.width.min(MAX_PIXELS), ground.height.min(MAX_PIXELS));
        let cells_per_pixel =
            Vec2::new(ground.width as f32 / width as f32, ground.height as f32 / height as f32);
        let pixels = match clearance {
            Some(map) => clearance_pixels(ground, map, width, height),
            None => vec![[0; 4]; (width * height) as usize],
        };
        let mut decal = Self { width, height, pixels };
        for shape in obstacles {
            decal.paint_obstacle(ground, cells_per_pixel, shape);
        }
        Some(decal)
    }

    fn paint_obstacle(&mut self, ground: &Ground, cells_per_pixel: Vec2, shape: &ObstacleShape) {
        let outline = scene::outline(shape);
        let low = outline.iter().copied().reduce(Vec2::min).unwrap_or_default();
        let high = outline.iter().copied().reduce(Vec2::max).unwrap_or_default();
        let pixel_m = ground.cell_m * cells_per_pixel;
        // Pixel (0, 0) has the south-west corner of cell (0, 0).
        let corner = ground.origin_m - ground.cell_m / 2.0;
        let first = ((low - corner) / pixel_m - 1.0).floor().max(Vec2::ZERO);
        let size = Vec2::new(self.width as f32, self.height as f32);
        let last = ((high - corner) / pixel_m + 1.0).ceil().min(size);
        for row in first.y as u32..last.y.max(0.0) as u32 {
            for column in first.x as u32..last.x.max(0.0) as u32 {
                let place = corner + (Vec2::new(column as f32, row as f32) + 0.5) * pixel_m;
                let depth_m =
                    if contains(shape, place) { 1.0 } else { -1.0 } * border_distance(&outline, place);
                let cover = (0.5 + depth_m / pixel_m.x).clamp(0.0, 1.0);
                if let Some(pixel) = self.pixels.get_mut((row * self.width + column) as usize)
                    && cover > 0.0
                {
                    *pixel = over(*pixel, Tokens::OBSTACLE.to_array(), cover * OBSTACLE_OPACITY);
                }
            }
        }
    }
}

const OBSTACLE_OPACITY: f32 = 0.55;
const CLEARANCE_OPACITY: f32 = 0.78;

fn clearance_pixels(ground: &Ground, map: ClearanceMap<'_>, width: u32, height: u32) -> Vec<[u8; 4]> {
    let mut pixels = Vec::with_capacity((width * height) as usize);
    for row in 0..height {
        for column in 0..width {
            let cell_row = row * ground.height / height;
            let cell_column = column * ground.width / width;
            let cell = (cell_row * ground.width + cell_column) as usize;
            let room_m = map.clearance_m.get(cell).copied().unwrap_or(0.0);
            let color = if room_m < 0.0 { Tokens::NO_ROOM } else { Tokens::ramp(room_m / AMPLE_M) };
            pixels.push(over([0; 4], color.to_array(), CLEARANCE_OPACITY));
        }
    }
    pixels
}

/// `color` with `opacity` over a premultiplied pixel.
fn over(below: [u8; 4], color: [u8; 4], opacity: f32) -> [u8; 4] {
    std::array::from_fn(|channel| {
        let top = if channel == 3 { 255.0 } else { f32::from(color[channel]) };
        (top * opacity + f32::from(below[channel]) * (1.0 - opacity)).round() as u8
    })
}

fn border_distance(outline: &[Vec2], place: Vec2) -> f32 {
    let sides = outline.iter().zip(outline.iter().cycle().skip(1));
    sides
        .map(|(&from, &to)| place.distance(from.lerp(to, nearest_part(place, from, to))))
        .fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground() -> Ground {
        Ground::new(40, 30, 1.0, Vec2::splat(0.5), &vec![0.0; 40 * 30])
    }

    #[test]
    fn an_obstacle_covers_the_ground_inside_it_and_nothing_else() {
        let corners_m = vec![[10.0, 5.0], [20.0, 5.0], [20.0, 15.0], [10.0, 15.0]];
        let decal =
            Decal::paint(&ground(), &[ObstacleShape::Polygon { corners_m }], None).expect("an obstacle");
        let opacity = |east: u32, north: u32| decal.pixels[(north * decal.width + east) as usize][3];
        assert!(opacity(15, 10) > 100);
        assert_eq!([opacity(5, 10), opacity(25, 10), opacity(15, 20), opacity(15, 2)], [0; 4]);
    }

    #[test]
    fn places_without_room_differ_from_places_with_little_and_with_ample_room() {
        let mut clearance_m = vec![20.0; 40 * 30];
        clearance_m[0] = -1.0;
        clearance_m[1] = 0.5;
        let decal = Decal::paint(&ground(), &[], Some(ClearanceMap { clearance_m: &clearance_m }));
        let pixels = decal.expect("a clearance map").pixels;
        assert!(pixels[0] != pixels[1] && pixels[1] != pixels[2] && pixels[0] != pixels[2]);
        assert_eq!(pixels[2], pixels[100]);
        assert_eq!(Decal::paint(&ground(), &[], None), None);
    }
}
