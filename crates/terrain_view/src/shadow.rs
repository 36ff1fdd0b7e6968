//! Shadows on the ground: the outline of a body as the sun sees it, laid on the ground.
//!
//! A shadow is the convex hull of what the body's corners throw. It needs no pass of its own, and costs no more than a few
//! triangles.

use glam::{Vec2, Vec3};

use crate::ground::Ground;
use crate::shapes::Shapes;

/// How much darker the ground is in the shadow.
pub const COLOR: [f32; 4] = [0.0, 0.0, 0.0, 0.42];

/// Lays the shadow of a body on the ground; `sun` points toward the sun, above the horizon.
pub fn cast(shapes: &mut Shapes, ground: &Ground, body: &Shapes, sun: Vec3) {
    let along = -sun.truncate() / sun.z.max(0.05);
    let thrown = body.triangles.iter().map(|corner| {
        let corner = Vec3::from(corner.position_m);
        let from = corner.truncate();
        // The ground where the shadow falls is not as high as that below the body.
        let mut at = from;
        for _ in 0..3 {
            at = from + along * (corner.z - ground.height_at(at)).max(0.0);
        }
        at
    });
    let outline = convex_hull(thrown.collect());
    let Some(center) = center(&outline) else { return };
    let lift_m = ground.cell_m * 0.1;
    let on_ground = |at: Vec2| ground.drape(at, lift_m);
    for (from, to) in outline.iter().zip(outline.iter().cycle().skip(1)) {
        shapes.triangle([on_ground(center), on_ground(*from), on_ground(*to)], COLOR);
    }
}

fn center(outline: &[Vec2]) -> Option<Vec2> {
    (outline.len() >= 3).then(|| outline.iter().sum::<Vec2>() / outline.len() as f32)
}

/// The corners of the convex hull, counter-clockwise (Andrew's monotone chain).
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for point in points {
            while let [.., before, last] = chain.as_slice()
                && (*last - *before).perp_dot(point - *last) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hull_of_a_square_with_points_inside_is_the_square() {
        let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let inside = [Vec2::splat(0.5), Vec2::new(0.5, 0.0), Vec2::new(0.2, 0.7)];
        let hull = convex_hull(inside.into_iter().chain(corners).collect());
        assert_eq!(hull, corners);
    }

    #[test]
    fn a_body_throws_its_shadow_away_from_the_sun_on_the_ground() {
        let ground = Ground::new(40, 40, 1.0, Vec2::ZERO, &[0.0; 1600]);
        let mut body = Shapes::default();
        body.cuboid(Vec3::new(20.0, 20.0, 2.0), Vec3::ONE, &glam::Mat3::IDENTITY, [1.0; 4]);
        let mut shapes = Shapes::default();
        // From the west, as high as it is far: the top at 3 m throws 3 m to the east.
        cast(&mut shapes, &ground, &body, Vec3::new(-1.0, 0.0, 1.0));
        let east = shapes.triangles.iter().map(|it| it.position_m[0]).fold(f32::MIN, f32::max);
        let west = shapes.triangles.iter().map(|it| it.position_m[0]).fold(f32::MAX, f32::min);
        assert!((east - 24.0).abs() < 1e-4 && (west - 20.0).abs() < 1e-4, "{west} to {east}");
        assert!(shapes.triangles.iter().all(|it| it.position_m[2] < 0.2));
    }
}
