//! Solid shapes as triangles in mission coordinates: vehicles, obstacles and location posts.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec2, Vec3};

use super::ground::Ground;

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct ShapeCorner {
    /// In metres.
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
    /// Where it starts, in metres, and its width in pixels.
    pub from_width: [f32; 4],
    /// Where it ends, in metres, and how far it is moved towards the eye in depth.
    pub to_lift: [f32; 4],
    /// Red, green, blue, opacity.
    pub color: [f32; 4],
}

/// Collects triangles and lines.
#[derive(Default, Debug, Clone, PartialEq)]
pub struct Shapes {
    /// Three corners per triangle.
    pub triangles: Vec<ShapeCorner>,
    /// Segments.
    pub lines: Vec<LineSegment>,
}

const DEPTH_LIFT: f32 = 0.0012;

impl Shapes {
    fn triangle(&mut self, corners: [Vec3; 3], color: [f32; 4]) {
        let normal =
            (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Z).to_array();
        for corner in corners {
            self.triangles.push(ShapeCorner { position_m: corner.to_array(), normal, color });
        }
    }

    fn quad(&mut self, corners: [Vec3; 4], color: [f32; 4]) {
        self.triangle([corners[0], corners[1], corners[2]], color);
        self.triangle([corners[0], corners[2], corners[3]], color);
    }

    /// A straight segment.
    pub fn line(&mut self, from: Vec3, to: Vec3, width_px: f32, color: [f32; 4]) {
        self.lines.push(LineSegment {
            from_width: from.extend(width_px).to_array(),
            to_lift: to.extend(DEPTH_LIFT).to_array(),
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

    /// A wheeled rover of this length and width, its wheels on the ground at `place_m`, its nose towards
    /// `heading_rad`, pitched and rolled with the slope.
    pub fn rover(&mut self, ground: &Ground, rover: &RoverShape) {
        let normal = ground.normal_at(rover.place_m, rover.length_m / 2.0);
        let ahead = Vec3::new(rover.heading_rad.cos(), rover.heading_rad.sin(), 0.0);
        let ahead = (ahead - normal * ahead.dot(normal)).normalize_or(Vec3::X);
        let left = normal.cross(ahead);
        let turn = Mat3::from_cols(ahead, left, normal);
        let (length, width) = (rover.length_m, rover.width_m);
        let wheel = length * 0.2;
        let base = ground.drape(rover.place_m, 0.0);
        let dark = [0.13, 0.13, 0.14, 1.0];
        let body = base + normal * (wheel * 1.55);
        self.cuboid(body, Vec3::new(length * 0.46, width * 0.34, wheel * 0.55), &turn, rover.color);
        let deck = body + normal * wheel * 0.6;
        self.cuboid(
            deck,
            Vec3::new(length * 0.40, width * 0.30, wheel * 0.06),
            &turn,
            [0.09, 0.14, 0.30, 1.0],
        );
        for (along, side) in [(0.33, 1.0), (0.33, -1.0), (-0.33, 1.0), (-0.33, -1.0)] {
            let hub = base + ahead * (length * along) + left * (width * 0.42 * side) + normal * wheel;
            self.cylinder(hub, left, wheel, width * 0.09, dark);
        }
        let mast = deck + ahead * (length * 0.28);
        self.cylinder(
            mast + normal * wheel * 0.9,
            normal,
            wheel * 0.12,
            wheel * 0.9,
            [0.75, 0.75, 0.75, 1.0],
        );
        let head = mast + normal * wheel * 1.95;
        self.cuboid(
            head,
            Vec3::new(wheel * 0.25, wheel * 0.55, wheel * 0.28),
            &turn,
            [0.92, 0.92, 0.92, 1.0],
        );
    }

    /// An airship of this length that floats above `place_m`.
    pub fn blimp(&mut self, ground: &Ground, shape: &RoverShape, altitude_m: f32) {
        let ahead = Vec3::new(shape.heading_rad.cos(), shape.heading_rad.sin(), 0.0);
        let center = ground.drape(shape.place_m, altitude_m);
        const RINGS: u32 = 8;
        let turn = Mat3::from_cols(ahead, Vec3::Z.cross(ahead), Vec3::Z);
        let point = |ring: u32, side: u32| {
            let polar = ring as f32 / RINGS as f32 * std::f32::consts::PI;
            let around = side as f32 / 12.0 * std::f32::consts::TAU;
            let radius = shape.width_m / 2.0;
            let local = Vec3::new(
                polar.cos() * shape.length_m / 2.0,
                polar.sin() * around.cos() * radius,
                polar.sin() * around.sin() * radius,
            );
            center + turn * local
        };
        for ring in 0..RINGS {
            for side in 0..12 {
                let corners = [
                    point(ring, side),
                    point(ring + 1, side),
                    point(ring + 1, side + 1),
                    point(ring, side + 1),
                ];
                self.quad(corners, shape.color);
            }
        }
        let gondola = center - Vec3::Z * shape.width_m * 0.6;
        self.cuboid(gondola, Vec3::new(shape.length_m * 0.12, 0.2, 0.15), &turn, [0.2, 0.2, 0.22, 1.0]);
    }

    /// A wall around `outline_m` with a lid, its foot in the ground.
    pub fn prism(&mut self, ground: &Ground, outline_m: &[Vec2], height_m: f32, color: [f32; 4]) {
        let Some(&first) = outline_m.first() else { return };
        let middle = outline_m.iter().copied().sum::<Vec2>() / outline_m.len() as f32;
        let signed_area: f32 =
            outline_m.iter().zip(outline_m.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum();
        let mut before = first;
        let next_corners = outline_m.iter().skip(1).chain(std::iter::once(&first));
        for &next in next_corners {
            let (a, b) = if signed_area >= 0.0 { (before, next) } else { (next, before) };
            before = next;
            let pieces = (a.distance(b) / (ground.cell_m * 4.0)).ceil().clamp(1.0, 64.0) as u32;
            for piece in 0..pieces {
                let at = |index: u32| a.lerp(b, index as f32 / pieces as f32);
                let (from, to) = (at(piece), at(piece + 1));
                let (low_from, low_to) = (ground.drape(from, -0.5), ground.drape(to, -0.5));
                let (top_from, top_to) = (ground.drape(from, height_m), ground.drape(to, height_m));
                self.quad([low_from, low_to, top_to, top_from], color);
                let peak = ground.drape(middle, height_m * 1.25);
                self.triangle([top_from, top_to, peak], color);
            }
        }
    }
}

/// A vehicle as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoverShape {
    /// Where it is, in metres.
    pub place_m: Vec2,
    /// Direction of its nose, counter-clockwise from east.
    pub heading_rad: f32,
    /// Its length.
    pub length_m: f32,
    /// Its width.
    pub width_m: f32,
    /// Its colour.
    pub color: [f32; 4],
}

/// The outline of a disc.
pub fn circle_outline(center_m: Vec2, radius_m: f32) -> Vec<Vec2> {
    (0..28)
        .map(|side| center_m + Vec2::from_angle(side as f32 / 28.0 * std::f32::consts::TAU) * radius_m)
        .collect()
}
