//! Where two polylines come near each other, whenever their vehicles are there: piece by piece.

use std::ops::Range;

use nalgebra::{Point2, Vector2, distance};

use crate::path::between;

/// A piece of one polyline that is near a piece of another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearPieces {
    /// The segments that the pieces are of.
    pub segments: [usize; 2],
    /// Where along its segment each piece starts and ends, from 0 to 1.
    pub shares: [[f64; 2]; 2],
    /// The places of both that are nearest to each other, in meters.
    pub places_m: [Point2<f64>; 2],
    /// How far apart these are, in meters.
    pub distance_m: f64,
}

/// Calls `visit` for all pieces of two polylines that come nearer to each other than `within_m`; pieces are at most `piece_m`
/// long. A polyline of one point is a vehicle that stands. Quadratic in the numbers of segments; where segments are near each other,
/// linear in the number of pieces.
pub fn near_pieces(
    one_m: &[Point2<f64>],
    other_m: &[Point2<f64>],
    within_m: f64,
    piece_m: f64,
    visit: &mut dyn FnMut(NearPieces),
) {
    for (first, a) in segments(one_m) {
        for (second, b) in segments(other_m) {
            if nearest_places(a, b).1 >= within_m {
                continue;
            }
            let parts = |of: [Point2<f64>; 2]| (distance(&of[0], &of[1]) / piece_m).ceil().max(1.0) as u32;
            let piece = |of: [Point2<f64>; 2], part: u32, parts: u32| {
                let shares = [part, part + 1].map(|end| f64::from(end) / f64::from(parts));
                (shares, shares.map(|share| between(of[0], of[1], share)))
            };
            let (parts_a, parts_b) = (parts(a), parts(b));
            for part_a in 0..parts_a {
                let (shares_a, piece_a) = piece(a, part_a, parts_a);
                for part_b in parts_around(piece_a, b, parts_b, within_m) {
                    let (shares_b, piece_b) = piece(b, part_b, parts_b);
                    let (places_m, distance_m) = nearest_places(piece_a, piece_b);
                    if distance_m < within_m {
                        let (segments, shares) = ([first, second], [shares_a, shares_b]);
                        visit(NearPieces { segments, shares, places_m, distance_m });
                    }
                }
            }
        }
    }
}

/// The parts of a segment that may be within `within_m` of a piece of another one: those whose places are not too far along the
/// segment from the place that is nearest to the middle of the piece.
fn parts_around(piece: [Point2<f64>; 2], segment: [Point2<f64>; 2], parts: u32, within_m: f64) -> Range<u32> {
    let ahead = segment[1] - segment[0];
    let length_m = distance(&segment[0], &segment[1]);
    if length_m == 0.0 {
        return 0..parts;
    }
    let middle = between(piece[0], piece[1], 0.5);
    let reach_m = within_m + 0.5 * distance(&piece[0], &piece[1]);
    let nearest = (middle - segment[0]).dot(&ahead) / (length_m * length_m);
    // A part more on each side, for rounding.
    let number = |share: f64| (share * f64::from(parts)).floor();
    let first = (number(nearest - reach_m / length_m) - 1.0).max(0.0);
    let last = (number(nearest + reach_m / length_m) + 2.0).min(f64::from(parts));
    first as u32..last.max(0.0) as u32
}

/// The segments of a polyline; of a single point one without length.
fn segments(points_m: &[Point2<f64>]) -> impl Iterator<Item = (usize, [Point2<f64>; 2])> + '_ {
    let single = (points_m.len() == 1).then(|| [points_m[0]; 2]);
    points_m.windows(2).map(|pair| [pair[0], pair[1]]).chain(single).enumerate()
}

/// The places of two segments that are nearest to each other, and their distance.
fn nearest_places(a: [Point2<f64>; 2], b: [Point2<f64>; 2]) -> ([Point2<f64>; 2], f64) {
    if let Some(place) = crossing(a, b) {
        return ([place; 2], 0.0);
    }
    let on = |segment: [Point2<f64>; 2], point: Point2<f64>| {
        let ahead = segment[1] - segment[0];
        let squared = ahead.norm_squared();
        let share =
            if squared > 0.0 { ((point - segment[0]).dot(&ahead) / squared).clamp(0.0, 1.0) } else { 0.0 };
        between(segment[0], segment[1], share)
    };
    let pairs = [[a[0], on(b, a[0])], [a[1], on(b, a[1])], [on(a, b[0]), b[0]], [on(a, b[1]), b[1]]];
    let with_distance = pairs.map(|pair| (pair, distance(&pair[0], &pair[1])));
    with_distance.into_iter().min_by(|one, other| one.1.total_cmp(&other.1)).unwrap_or(with_distance[0])
}

/// Returns where two segments cross that are not parallel.
fn crossing(a: [Point2<f64>; 2], b: [Point2<f64>; 2]) -> Option<Point2<f64>> {
    let cross = |one: Vector2<f64>, other: Vector2<f64>| one.x * other.y - one.y * other.x;
    let (along_a, along_b, offset) = (a[1] - a[0], b[1] - b[0], b[0] - a[0]);
    let area = cross(along_a, along_b);
    if area == 0.0 {
        return None;
    }
    let (share_a, share_b) = (cross(offset, along_b) / area, cross(offset, along_a) / area);
    let is_within = |share: f64| (0.0..=1.0).contains(&share);
    (is_within(share_a) && is_within(share_b)).then(|| between(a[0], a[1], share_a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(one: &[[f64; 2]], other: &[[f64; 2]], within_m: f64) -> Vec<NearPieces> {
        let points = |of: &[[f64; 2]]| of.iter().copied().map(Point2::from).collect::<Vec<_>>();
        let mut found = Vec::new();
        near_pieces(&points(one), &points(other), within_m, 0.5, &mut |near| found.push(near));
        found
    }

    #[test]
    fn paths_that_cross_are_near_around_the_crossing_alone() {
        let near = found(&[[-10.0, 0.0], [10.0, 0.0]], &[[0.0, -10.0], [0.0, 10.0]], 2.0);
        let nearest = near.iter().map(|it| it.distance_m).fold(f64::INFINITY, f64::min);
        assert_eq!(nearest, 0.0);
        let shares = near.iter().flat_map(|it| it.shares[0]);
        let (low, high) = shares.fold((1.0_f64, 0.0_f64), |(low, high), it| (low.min(it), high.max(it)));
        // 2 m to both sides of the middle of 20 m, and at most a piece more.
        assert!((0.375..=0.4).contains(&low) && (0.6..=0.625).contains(&high), "{low} to {high}");
    }

    #[test]
    fn no_part_that_is_near_is_passed_over() {
        let mut random = terrain::Random::from_seed(3);
        let mut count = 0;
        for _ in 0..300 {
            let [one, other] =
                [0, 1].map(|_| [0, 1].map(|_| Point2::new(random.range(-9.0, 9.0), random.range(-9.0, 9.0))));
            let (within_m, parts) = (random.range(0.1, 4.0), 7);
            let around = parts_around(one, other, parts, within_m);
            for part in 0..parts {
                let ends = [part, part + 1].map(|end| f64::from(end) / f64::from(parts));
                let is_near =
                    nearest_places(one, ends.map(|share| between(other[0], other[1], share))).1 < within_m;
                assert!(
                    !is_near || around.contains(&part),
                    "{one:?} {other:?} {within_m}: {part} not in {around:?}"
                );
                count += u32::from(!around.contains(&part));
            }
        }
        assert!(count > 300, "only {count} parts are passed over");
    }

    #[test]
    fn who_stands_beside_a_path_is_near_a_part_of_it() {
        let near = found(&[[3.0, 1.0]], &[[0.0, 0.0], [10.0, 0.0]], 1.5);
        assert!(near.iter().all(|it| it.segments[0] == 0 && it.distance_m >= 1.0 - 1e-12));
        assert!(near.iter().any(|it| (it.distance_m - 1.0).abs() < 1e-12));
        assert_eq!(found(&[[3.0, 1.6]], &[[0.0, 0.0], [10.0, 0.0]], 1.5), []);
    }
}
