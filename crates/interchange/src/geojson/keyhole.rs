//! Polygons with holes as polygons without: each hole is cut open along a line to the border.

use nalgebra::Point2;

type Ring = Vec<Point2<f64>>;

/// How many of the nearest corners are tried for the end of a cut.
const TRIED: usize = 100;

/// One ring with the area between the border and the holes. Holes are joined from the east to the west, each from its
/// easternmost corner by the shortest line to a corner that crosses no side (after Held 2001); a hole from which no such
/// line leads to one of the nearest corners is left out, so that it counts as filled.
pub fn without_holes(border: Ring, mut holes: Vec<Ring>) -> Ring {
    let mut ring = border;
    holes.retain(|hole| hole.len() >= 3);
    for hole in &mut holes {
        if (signed_area(hole) > 0.0) == (signed_area(&ring) > 0.0) {
            hole.reverse();
        }
        let east = (0..hole.len()).max_by(|&a, &b| hole[a].x.total_cmp(&hole[b].x)).unwrap_or(0);
        hole.rotate_left(east);
    }
    holes.sort_by(|a, b| a[0].x.total_cmp(&b[0].x));
    while let Some(mut hole) = holes.pop() {
        let Some(outer) = visible(&ring, &hole, &holes) else { continue };
        let ends = [hole[0], ring[outer]];
        hole.extend(ends);
        let rest = ring.split_off(outer + 1);
        ring.extend(hole.into_iter().chain(rest));
    }
    ring
}

/// The nearest corner of the ring to which a straight line from the first corner of a hole crosses nothing.
fn visible(ring: &[Point2<f64>], hole: &[Point2<f64>], others: &[Ring]) -> Option<usize> {
    let from = hole[0];
    let away = |(outer, to): (usize, &Point2<f64>)| (nalgebra::distance_squared(&from, to), outer);
    let mut corners: Vec<(f64, usize)> = ring.iter().enumerate().map(away).collect();
    corners.sort_by(|a, b| a.0.total_cmp(&b.0));
    let rings = || [ring, hole].into_iter().chain(others.iter().map(Vec::as_slice));
    let is_free = |outer: &usize| !rings().any(|other| crosses(from, ring[*outer], other));
    corners.into_iter().take(TRIED).map(|(_, outer)| outer).find(is_free)
}

/// Returns whether a line crosses a side of a ring other than at the line's own ends.
fn crosses(from: Point2<f64>, to: Point2<f64>, ring: &[Point2<f64>]) -> bool {
    let turn = |a: Point2<f64>, b: Point2<f64>, c: Point2<f64>| (b - a).perp(&(c - a));
    ring.iter().zip(ring.iter().cycle().skip(1)).any(|(&a, &b)| {
        if [a, b].iter().any(|end| *end == from || *end == to) {
            return false;
        }
        turn(from, to, a) * turn(from, to, b) <= 0.0 && turn(a, b, from) * turn(a, b, to) <= 0.0
    })
}

/// Twice the area, above 0 for a ring that turns to the left.
fn signed_area(ring: &[Point2<f64>]) -> f64 {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a.coords.perp(&b.coords)).sum()
}
