//! Parts of ways that vehicles take when theirs is blocked.

use motion::Path;
use nalgebra::{Point2, UnitComplex, Vector2, distance};

/// A stretch leads nearer to something if it is so much nearer, in meters.
const NEARER_M: f64 = 0.05;

/// The place itself, or the nearest free one around it: what a vehicle has come close to fills whole cells.
pub(crate) fn nearest_free(is_free: impl Fn(Point2<f64>) -> bool, here: Point2<f64>) -> Option<Point2<f64>> {
    const DIRECTIONS: u32 = 24;
    const RING_M: f64 = 0.2;
    if is_free(here) {
        return Some(here);
    }
    (1..=20).flat_map(|ring| (0..DIRECTIONS).map(move |direction| (ring, direction))).find_map(
        |(ring, direction)| {
            let angle = std::f64::consts::TAU * f64::from(direction) / f64::from(DIRECTIONS);
            let radius = RING_M * f64::from(ring);
            let place = here + UnitComplex::new(angle) * Vector2::new(radius, 0.0);
            is_free(place).then_some(place)
        },
    )
}

/// Returns how far a place is from a straight stretch, in meters.
pub(super) fn distance_to([from, to]: [Point2<f64>; 2], place: Point2<f64>) -> f64 {
    let ahead = to - from;
    let length = ahead.norm_squared();
    let share = if length > 0.0 { ((place - from).dot(&ahead) / length).clamp(0.0, 1.0) } else { 0.0 };
    distance(&(from + ahead * share), &place)
}

/// Returns whether a straight stretch leads no nearer to what has been seen than its start is, but where it stays out
/// of reach.
pub(super) fn gets_past(
    mut seen_m: impl Iterator<Item = Point2<f64>>,
    stretch: [Point2<f64>; 2],
    reach_m: f64,
) -> bool {
    seen_m.all(|point| distance_to(stretch, point) >= distance(&stretch[0], &point).min(reach_m) - NEARER_M)
}

/// The corners of a path from a distance along it on, with the place at that distance.
pub(super) fn rest_of(path: &Path, from_m: f64) -> Vec<Point2<f64>> {
    let Some((place, segment)) = path.point_at(from_m) else { return Vec::new() };
    let mut points = vec![place];
    points.extend(path.points_m.iter().skip(segment + 1).filter(|&&point| point != place));
    points
}

/// The corners of a path up to a distance along it, with the place at that distance.
pub(super) fn until(path: &Path, to_m: f64) -> Vec<Point2<f64>> {
    let Some((place, segment)) = path.point_at(to_m) else { return Vec::new() };
    let mut points: Vec<Point2<f64>> = path.points_m.iter().take(segment + 1).copied().collect();
    points.push(place);
    points
}
