//! Obstacles as volumes: prisms on the ground, with sides and a lid that follow it.
//!
//! The language declares where an obstacle is, and not how high it is. It is drawn as high as its size suggests.

use glam::{Vec2, Vec3};

use crate::ground::Ground;
use crate::outline::is_inside;
use crate::shapes::Shapes;

/// A prism that stands on the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct Volume {
    /// Its corners, in meters.
    pub outline_m: Vec<Vec2>,
    /// Its height over the ground, in meters.
    pub height_m: f32,
}

/// How high and how low obstacles are drawn, in meters.
const HEIGHTS_M: [f32; 2] = [2.0, 6.0];
/// The foot of a volume is so deep in the ground, which the lines between its corners do not follow exactly.
const FOOT_M: f32 = 0.6;
/// The longest edge of a lid in cells of the map, and how often edges are halved.
const EDGE_CELLS: f32 = 4.0;
const MAX_HALVINGS: u32 = 5;

impl Volume {
    /// The volume of an obstacle with this outline.
    pub fn new(outline_m: Vec<Vec2>) -> Self {
        let sides = || outline_m.iter().zip(outline_m.iter().cycle().skip(1));
        let around_m: f32 = sides().map(|(a, b)| a.distance(*b)).sum();
        // The mean width of a wall, the radius of a disc.
        let width_m = doubled_area(&outline_m).abs() / around_m.max(1e-3);
        let height_m = (0.7 * width_m).clamp(HEIGHTS_M[0], HEIGHTS_M[1]);
        Self { outline_m, height_m }
    }

    /// The corners of the rectangle around it, in meters.
    pub fn bounds(&self) -> [Vec2; 2] {
        let corners = || self.outline_m.iter().copied();
        [corners().reduce(Vec2::min).unwrap_or_default(), corners().reduce(Vec2::max).unwrap_or_default()]
    }

    /// The middle of its lid.
    pub fn top_m(&self, ground: &Ground) -> Vec3 {
        let middle = self.outline_m.iter().copied().sum::<Vec2>() / self.outline_m.len().max(1) as f32;
        ground.drape(middle, self.height_m)
    }

    /// Draws its sides and its lid.
    pub fn draw(&self, shapes: &mut Shapes, ground: &Ground, color: [f32; 4]) {
        let mut outline = self.outline_m.clone();
        outline.dedup();
        if doubled_area(&outline) < 0.0 {
            outline.reverse();
        }
        for (&from, &to) in outline.iter().zip(outline.iter().cycle().skip(1)) {
            let pieces = (from.distance(to) / (ground.cell_m * EDGE_CELLS)).ceil().clamp(1.0, 64.0) as u32;
            let at = |index: u32| from.lerp(to, index as f32 / pieces as f32);
            for piece in 0..pieces {
                let (a, b) = (at(piece), at(piece + 1));
                let foot = [a, b].map(|place| ground.drape(place, -FOOT_M));
                let top = [a, b].map(|place| ground.drape(place, self.height_m));
                shapes.quad([foot[0], foot[1], top[1], top[0]], color);
            }
        }
        let longest_m = ground.cell_m * EDGE_CELLS;
        for triangle in triangles(&outline) {
            self.lid(shapes, ground, triangle, (longest_m, MAX_HALVINGS), color);
        }
    }

    /// A part of the lid, halved at its longest edge until it follows the ground.
    fn lid(
        &self,
        shapes: &mut Shapes,
        ground: &Ground,
        [a, b, c]: [Vec2; 3],
        (longest_m, halvings): (f32, u32),
        color: [f32; 4],
    ) {
        let edges = [[a, b, c], [b, c, a], [c, a, b]];
        let length = |edge: &[Vec2; 3]| edge[0].distance_squared(edge[1]);
        let longest = edges.into_iter().max_by(|left, right| length(left).total_cmp(&length(right)));
        if let Some([from, to, other]) = longest
            && halvings > 0
            && from.distance(to) > longest_m
        {
            let middle = from.midpoint(to);
            let rest = (longest_m, halvings - 1);
            self.lid(shapes, ground, [from, middle, other], rest, color);
            self.lid(shapes, ground, [middle, to, other], rest, color);
            return;
        }
        shapes.triangle([a, b, c].map(|place| ground.drape(place, self.height_m)), color);
    }
}

/// Twice the area inside an outline; negative if it goes clockwise.
fn doubled_area(outline: &[Vec2]) -> f32 {
    let sides = outline.iter().zip(outline.iter().cycle().skip(1));
    sides.map(|(a, b)| a.perp_dot(*b)).sum()
}

/// The triangles of a counter-clockwise outline, by cutting off its ears; takes quadratic time. Of an outline that crosses
/// itself, some may be missing.
fn triangles(outline: &[Vec2]) -> Vec<[Vec2; 3]> {
    let mut left: Vec<Vec2> = outline.to_vec();
    let mut found = Vec::new();
    while left.len() > 3 {
        let count = left.len();
        let ear = (0..count).find(|&at| {
            let corners = [left[(at + count - 1) % count], left[at], left[(at + 1) % count]];
            let turns_left = (corners[1] - corners[0]).perp_dot(corners[2] - corners[1]) > 0.0;
            turns_left && left.iter().all(|corner| corners.contains(corner) || !is_inside(&corners, *corner))
        });
        let Some(at) = ear else { return found };
        found.push([left[(at + count - 1) % count], left[at], left[(at + 1) % count]]);
        left.remove(at);
    }
    if let [a, b, c] = left[..] {
        found.push([a, b, c]);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::circle_outline;

    fn corners(points: &[[f32; 2]]) -> Vec<Vec2> {
        points.iter().map(|&point| Vec2::from(point)).collect()
    }

    fn area(triangles: &[[Vec2; 3]]) -> f32 {
        triangles.iter().map(|[a, b, c]| (*b - *a).perp_dot(*c - *a) / 2.0).sum()
    }

    #[test]
    fn the_triangles_of_an_outline_with_a_notch_cover_it_and_not_the_notch() {
        let outline =
            corners(&[[0., 0.], [10., 0.], [10., 10.], [6., 10.], [6., 4.], [4., 4.], [4., 10.], [0., 10.]]);
        let found = triangles(&outline);
        assert!((area(&found) - 88.0).abs() < 1e-3, "{}", area(&found));
        assert!(found.iter().all(|it| !is_inside(it, Vec2::new(5.0, 8.0))));
    }

    #[test]
    fn a_volume_has_outward_sides_whichever_way_its_outline_goes_and_a_lid_on_the_ground() {
        // A slope that rises one meter in ten.
        let heights: Vec<f32> = (0..60 * 60).map(|cell| (cell % 60) as f32 * 0.1).collect();
        let ground = Ground::new(60, 60, 1.0, Vec2::ZERO, &heights);
        let mut outline = corners(&[[10., 10.], [50., 10.], [50., 50.], [10., 50.]]);
        for _ in 0..2 {
            let volume = Volume::new(outline.clone());
            let mut shapes = Shapes::default();
            volume.draw(&mut shapes, &ground, [1.0; 4]);
            let middle = Vec3::new(30.0, 30.0, 3.0);
            for corner in &shapes.triangles {
                let (at, normal) = (Vec3::from(corner.position_m), Vec3::from(corner.normal));
                let over_m = at.z - ground.height_at(at.truncate());
                let is_lid = normal.z > 0.5;
                assert!(if is_lid {
                    (over_m - volume.height_m).abs() < 1e-3
                } else {
                    normal.dot(at - middle) > 0.0
                });
            }
            outline.reverse();
        }
    }

    #[test]
    fn wide_obstacles_are_higher_than_thin_ones_within_limits() {
        let disc = |radius_m| Volume::new(circle_outline(Vec2::ZERO, radius_m)).height_m;
        let wall = Volume::new(corners(&[[0., 0.], [40., 0.], [40., 1.], [0., 1.]])).height_m;
        assert_eq!([disc(100.0), disc(0.5), wall], [HEIGHTS_M[1], HEIGHTS_M[0], HEIGHTS_M[0]]);
        assert!((HEIGHTS_M[0]..HEIGHTS_M[1]).contains(&disc(4.0)));
    }
}
