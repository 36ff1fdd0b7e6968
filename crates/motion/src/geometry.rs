//! Points and lengths in the plane.

/// The distance between two points.
pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    squared_distance(a, b).sqrt()
}

pub(crate) fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (east, north) = (b[0] - a[0], b[1] - a[1]);
    east * east + north * north
}

/// The point at a share of the way from one point to another; exactly the ends at 0 and 1.
pub(crate) fn between(a: [f64; 2], b: [f64; 2], share: f64) -> [f64; 2] {
    if share >= 1.0 {
        return b;
    }
    [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share]
}
