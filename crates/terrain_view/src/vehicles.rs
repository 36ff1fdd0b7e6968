//! The vehicles as solid shapes: a wheeled rover that follows the slope under it, and an airship.

use glam::{Mat3, Vec2, Vec3};

use crate::ground::Ground;
use crate::shapes::Shapes;

/// A vehicle as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VehicleShape {
    /// Where it is, in meters.
    pub place_m: Vec2,
    /// Direction of its nose, counter-clockwise from east.
    pub heading_rad: f32,
    pub length_m: f32,
    pub width_m: f32,
    pub color: [f32; 4],
    /// How far it has driven, in lengths of its body: its wheels have turned by that.
    pub driven_lengths: f32,
}

/// The radius of a wheel, in lengths of the body.
const WHEEL: f32 = 0.2;
const CLEATS: u16 = 8;
const SPOKE: [f32; 4] = [0.42, 0.42, 0.44, 1.0];
const RUBBER: [f32; 4] = [0.11, 0.11, 0.12, 1.0];
const HUB: [f32; 4] = [0.62, 0.63, 0.66, 1.0];
const PANEL: [f32; 4] = [0.10, 0.16, 0.36, 1.0];
const METAL: [f32; 4] = [0.80, 0.81, 0.83, 1.0];
const LENS: [f32; 4] = [0.06, 0.07, 0.09, 1.0];
const GONDOLA: [f32; 4] = [0.22, 0.23, 0.26, 1.0];

impl VehicleShape {
    /// The nose, the left side and the roof of a vehicle that stands on the slope under it.
    fn axes_on(&self, ground: &Ground) -> Mat3 {
        let up = ground.normal_at(self.place_m, self.length_m / 2.0);
        let flat = Vec3::new(self.heading_rad.cos(), self.heading_rad.sin(), 0.0);
        let ahead = (flat - up * flat.dot(up)).normalize_or(Vec3::X);
        Mat3::from_cols(ahead, up.cross(ahead), up)
    }
}

/// A rover with four wheels, a solar deck, and a mast with two cameras. It stands on its wheels, pitched and rolled by
/// the slope.
pub fn rover(shapes: &mut Shapes, ground: &Ground, shape: &VehicleShape) {
    let axes = shape.axes_on(ground);
    let base = ground.drape(shape.place_m, 0.0);
    let (length, width) = (shape.length_m, shape.width_m);
    let wheel = length * WHEEL;
    let turn_rad = shape.driven_lengths / WHEEL;
    // A place on the vehicle: meters ahead, to the left and up.
    let at = |ahead: f32, left: f32, up: f32| base + axes * Vec3::new(ahead, left, up);
    let box_at =
        |shapes: &mut Shapes, center: Vec3, half: Vec3, color| shapes.cuboid(center, half, &axes, color);
    let body = wheel * 1.6;
    box_at(shapes, at(0.0, 0.0, body), Vec3::new(length * 0.46, width * 0.30, wheel * 0.5), shape.color);
    // A sloped nose says which way it goes.
    box_at(
        shapes,
        at(length * 0.47, 0.0, body - wheel * 0.15),
        Vec3::new(length * 0.05, width * 0.24, wheel * 0.3),
        METAL,
    );
    let deck = body + wheel * 0.62;
    box_at(
        shapes,
        at(-length * 0.06, 0.0, deck),
        Vec3::new(length * 0.38, width * 0.40, wheel * 0.06),
        PANEL,
    );
    for (along, side) in [(0.32, 1.0), (0.32, -1.0), (-0.32, 1.0), (-0.32, -1.0)] {
        let hub = at(length * along, width * 0.42 * side, wheel);
        let axle = axes.y_axis;
        shapes.cylinder(hub, axle, wheel, width * 0.09, RUBBER);
        shapes.cylinder(hub, axle, wheel * 0.45, width * 0.10, HUB);
        // Spokes and cleats show that it turns.
        let turn = Mat3::from_axis_angle(axle, turn_rad) * axes;
        for spoke in [
            Vec3::new(wheel * 0.92, width * 0.095, wheel * 0.12),
            Vec3::new(wheel * 0.12, width * 0.095, wheel * 0.92),
        ] {
            shapes.cuboid(hub, spoke, &turn, SPOKE);
        }
        for cleat in 0..CLEATS {
            let angle = turn_rad + f32::from(cleat) / f32::from(CLEATS) * std::f32::consts::TAU;
            let turn = Mat3::from_axis_angle(axle, angle) * axes;
            let at = hub + turn.x_axis * wheel * 0.97;
            shapes.cuboid(at, Vec3::new(wheel * 0.06, width * 0.092, wheel * 0.08), &turn, SPOKE);
        }
    }
    let mast = length * 0.30;
    shapes.cylinder(at(mast, 0.0, deck + wheel * 0.9), axes.z_axis, wheel * 0.12, wheel * 0.9, METAL);
    let head = deck + wheel * 1.95;
    box_at(shapes, at(mast, 0.0, head), Vec3::new(wheel * 0.28, wheel * 0.6, wheel * 0.28), METAL);
    for side in [-1.0, 1.0] {
        let lens = at(mast + wheel * 0.3, wheel * 0.32 * side, head);
        shapes.cylinder(lens, axes.x_axis, wheel * 0.16, wheel * 0.08, LENS);
    }
    shapes.cylinder(
        at(-length * 0.36, width * 0.26, deck + wheel * 0.7),
        axes.z_axis,
        wheel * 0.05,
        wheel * 0.7,
        METAL,
    );
}

/// An airship whose middle is at `height_m`: hull, fins and gondola.
pub fn airship(shapes: &mut Shapes, shape: &VehicleShape, height_m: f32) {
    const RINGS: u32 = 12;
    const SIDES: u32 = 16;
    let ahead = Vec3::new(shape.heading_rad.cos(), shape.heading_rad.sin(), 0.0);
    let axes = Mat3::from_cols(ahead, Vec3::Z.cross(ahead), Vec3::Z);
    let center = shape.place_m.extend(height_m);
    let (half, radius) = (shape.length_m / 2.0, shape.width_m / 2.0);
    let point = |ring: u32, side: u32| {
        let polar = ring as f32 / RINGS as f32 * std::f32::consts::PI;
        let around = side as f32 / SIDES as f32 * std::f32::consts::TAU;
        // Fuller toward the nose, as hulls are.
        let swell = radius * polar.sin() * (1.0 + 0.18 * polar.cos());
        let local = Vec3::new(polar.cos() * half, around.cos() * swell, around.sin() * swell);
        center + axes * local
    };
    for ring in 0..RINGS {
        let color = if ring == RINGS / 2 { METAL } else { shape.color };
        for side in 0..SIDES {
            let corners =
                [point(ring, side), point(ring + 1, side), point(ring + 1, side + 1), point(ring, side + 1)];
            shapes.quad(corners, color);
        }
    }
    let place = |ahead: f32, left: f32, up: f32| center + axes * Vec3::new(ahead, left, up);
    let fin = half * 0.16;
    for (left, up) in [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)] {
        let middle = place(-half * 0.78, left * radius * 0.75, up * radius * 0.75);
        let thin = radius * 0.05;
        let reach = radius * 0.42;
        let extent = Vec3::new(fin, thin + reach * f32::abs(left), thin + reach * f32::abs(up));
        shapes.cuboid(middle, extent, &axes, METAL);
    }
    let gondola = Vec3::new(half * 0.24, radius * 0.22, radius * 0.18);
    shapes.cuboid(place(half * 0.1, 0.0, -radius * 1.12), gondola, &axes, GONDOLA);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wheels_turn_with_the_way_and_are_as_before_after_a_whole_turn() {
        let ground = Ground::flat(Vec2::ZERO, 40.0);
        let drawn = |driven_lengths| {
            let shape = VehicleShape {
                place_m: Vec2::new(3.0, 4.0),
                heading_rad: 0.4,
                length_m: 2.0,
                width_m: 1.5,
                color: [1.0; 4],
                driven_lengths,
            };
            let mut shapes = Shapes::default();
            rover(&mut shapes, &ground, &shape);
            shapes.triangles
        };
        let apart = |left: &[crate::shapes::ShapeCorner], right: &[crate::shapes::ShapeCorner]| {
            let away = |(a, b): (&crate::shapes::ShapeCorner, &crate::shapes::ShapeCorner)| {
                Vec3::from(a.position_m).distance(b.position_m.into())
            };
            left.iter().zip(right).map(away).fold(0.0, f32::max)
        };
        let around = WHEEL * std::f32::consts::TAU;
        assert!(apart(&drawn(0.0), &drawn(around / 16.0)) > 0.05);
        assert!(apart(&drawn(0.0), &drawn(around)) < 1e-3);
    }
}
