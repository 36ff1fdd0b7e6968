//! Outlines on the ground.

use glam::Vec2;

/// Returns whether a place is inside an outline.
pub fn is_inside(corners: &[Vec2], point: Vec2) -> bool {
    let sides = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossings = sides.filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    });
    crossings.count() % 2 == 1
}
