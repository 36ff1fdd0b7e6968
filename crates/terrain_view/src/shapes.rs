//! Triangles and lines in mission coordinates, and the plain solids made of them.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec2, Vec3};

use crate::ground::Ground;

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ShapeCorner {
    /// In meters.
    pub position_m: [f32; 3],
    /// Outward unit normal.
    pub normal: [f32; 3],
    /// Red, green, blue, opacity, from 0 to 1.
    pub color: [f32; 4],
}

/// A segment drawn with constant width on the screen.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct LineSegment {
    /// Where it starts, in meters, and its width in pixels.
    pub from_width: [f32; 4],
    /// Where it ends, in meters, and by which part of its distance it is drawn nearer to the eye.
    pub to_lift: [f32; 4],
    /// Red, green, blue, opacity.
    pub color: [f32; 4],
}

/// Collects triangles and lines.
#[derive(Default, Debug, Clone, PartialEq)]
pub struct Shapes {
    /// Three corners per triangle.
    pub triangles: Vec<ShapeCorner>,
    pub lines: Vec<LineSegment>,
}

/// How much nearer to the eye lines on the ground are drawn than they are, as a part of their distance: as much as keeps
/// them above the ground between two of its samples.
const DEPTH_LIFT: f32 = 0.006;
/// The same for lines through the air, which what is in front of them covers.
const AIR_LIFT: f32 = 0.0005;

impl Shapes {
    /// Makes all lines so many times wider.
    pub fn scale_widths(&mut self, factor: f32) {
        for line in &mut self.lines {
            line.from_width[3] *= factor;
        }
    }

    /// Adds others after these.
    pub fn append(&mut self, mut others: Self) {
        self.triangles.append(&mut others.triangles);
        self.lines.append(&mut others.lines);
    }

    /// Three corners; its normal is up for a counter-clockwise order seen from above.
    pub fn triangle(&mut self, corners: [Vec3; 3], color: [f32; 4]) {
        let normal =
            (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Z).to_array();
        for corner in corners {
            self.triangles.push(ShapeCorner { position_m: corner.to_array(), normal, color });
        }
    }

    /// Four corners in a plane, in order.
    pub fn quad(&mut self, corners: [Vec3; 4], color: [f32; 4]) {
        self.triangle([corners[0], corners[1], corners[2]], color);
        self.triangle([corners[0], corners[2], corners[3]], color);
    }

    /// A straight segment on the ground.
    pub fn line(&mut self, from: Vec3, to: Vec3, width_px: f32, color: [f32; 4]) {
        self.lifted_line(from, to, (width_px, DEPTH_LIFT), color);
    }

    /// A straight segment through the air.
    pub fn air_line(&mut self, from: Vec3, to: Vec3, width_px: f32, color: [f32; 4]) {
        self.lifted_line(from, to, (width_px, AIR_LIFT), color);
    }

    fn lifted_line(&mut self, from: Vec3, to: Vec3, (width_px, lift): (f32, f32), color: [f32; 4]) {
        self.lines.push(LineSegment {
            from_width: from.extend(width_px).to_array(),
            to_lift: to.extend(lift).to_array(),
            color,
        });
    }

    /// A segment that follows the ground.
    pub fn draped_line(&mut self, ground: &Ground, ends_m: [Vec2; 2], width_px: f32, color: [f32; 4]) {
        let length = ends_m[0].distance(ends_m[1]);
        let pieces = (length / (ground.cell_m * 3.0)).ceil().clamp(1.0, 200.0) as u32;
        let lift = ground.cell_m * 0.25;
        let mut before = ground.drape(ends_m[0], lift);
        for piece in 1..=pieces {
            let place = ends_m[0].lerp(ends_m[1], piece as f32 / pieces as f32);
            let next = ground.drape(place, lift);
            self.line(before, next, width_px, color);
            before = next;
        }
    }

    /// A box of `half_m` extents around `center_m`, turned by `turn`.
    pub fn cuboid(&mut self, center_m: Vec3, half_m: Vec3, turn: &Mat3, color: [f32; 4]) {
        let corner = |x: f32, y: f32, z: f32| center_m + *turn * (half_m * Vec3::new(x, y, z));
        let faces = [
            [(1., -1., -1.), (1., 1., -1.), (1., 1., 1.), (1., -1., 1.)],
            [(-1., 1., -1.), (-1., -1., -1.), (-1., -1., 1.), (-1., 1., 1.)],
            [(1., 1., -1.), (-1., 1., -1.), (-1., 1., 1.), (1., 1., 1.)],
            [(-1., -1., -1.), (1., -1., -1.), (1., -1., 1.), (-1., -1., 1.)],
            [(-1., -1., 1.), (1., -1., 1.), (1., 1., 1.), (-1., 1., 1.)],
            [(-1., 1., -1.), (1., 1., -1.), (1., -1., -1.), (-1., -1., -1.)],
        ];
        for face in faces {
            self.quad(face.map(|(x, y, z)| corner(x, y, z)), color);
        }
    }

    /// A cylinder around `axis` (a unit vector).
    pub fn cylinder(
        &mut self,
        center_m: Vec3,
        axis: Vec3,
        radius_m: f32,
        half_length_m: f32,
        color: [f32; 4],
    ) {
        const SIDES: u32 = 14;
        let across = axis.any_orthonormal_vector();
        let other = axis.cross(across);
        let rim = |side: u32| {
            let angle = side as f32 / SIDES as f32 * std::f32::consts::TAU;
            (across * angle.cos() + other * angle.sin()) * radius_m
        };
        let (top, bottom) = (center_m + axis * half_length_m, center_m - axis * half_length_m);
        for side in 0..SIDES {
            let (a, b) = (rim(side), rim(side + 1));
            self.quad([bottom + a, bottom + b, top + b, top + a], color);
            self.triangle([top, top + a, top + b], color);
            self.triangle([bottom, bottom + b, bottom + a], color);
        }
    }

    /// The line around the top of what stands on `outline_m`.
    pub fn rim(
        &mut self,
        ground: &Ground,
        outline_m: &[Vec2],
        height_m: f32,
        (color, width_px): ([f32; 4], f32),
    ) {
        let sides = outline_m.iter().zip(outline_m.iter().cycle().skip(1));
        for (&from, &to) in sides {
            let pieces = (from.distance(to) / (ground.cell_m * 4.0)).ceil().clamp(1.0, 64.0) as u32;
            let top = |index: u32| ground.drape(from.lerp(to, index as f32 / pieces as f32), height_m);
            for piece in 0..pieces {
                self.line(top(piece), top(piece + 1), width_px, color);
            }
        }
    }

    /// A low fence around `outline_m`, its foot in the ground, its top a line.
    pub fn fence(
        &mut self,
        ground: &Ground,
        outline_m: &[Vec2],
        height_m: f32,
        wall: [f32; 4],
        rim: ([f32; 4], f32),
    ) {
        let sides = outline_m.iter().zip(outline_m.iter().cycle().skip(1));
        for (&from, &to) in sides {
            let pieces = (from.distance(to) / (ground.cell_m * 4.0)).ceil().clamp(1.0, 64.0) as u32;
            let at = |index: u32| from.lerp(to, index as f32 / pieces as f32);
            for piece in 0..pieces {
                let (a, b) = (at(piece), at(piece + 1));
                let top = [ground.drape(a, height_m), ground.drape(b, height_m)];
                self.quad([ground.drape(a, -0.3), ground.drape(b, -0.3), top[1], top[0]], wall);
                self.line(top[0], top[1], rim.1, rim.0);
            }
        }
    }
}

/// The outline of a disc.
pub fn circle_outline(center_m: Vec2, radius_m: f32) -> Vec<Vec2> {
    (0..28)
        .map(|side| center_m + Vec2::from_angle(side as f32 / 28.0 * std::f32::consts::TAU) * radius_m)
        .collect()
}
