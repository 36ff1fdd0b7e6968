//! Fewer corners for a shortened path.
//!
//! A taut path follows the cells of a round obstacle with a corner at each of them. An executive, a drawing and a
//! network want few corners: two that turn the same way are replaced by the point where the outer sides meet, where
//! that costs little length and stays free.

use nalgebra::{Point2, distance};
use terrain::ConfigurationSpace;

use crate::path::Path;

/// A path with the same ends and far fewer corners, at most `extra_m` longer for each corner that is left out.
///
/// Every segment of the result is free if the given path is. Passes over the path until nothing changes; each removes
/// at least one corner, so there are at most as many passes as corners.
pub fn simplify(space: &ConfigurationSpace, path: &Path, extra_m: f64) -> Path {
    let mut points = path.points_m.clone();
    loop {
        let before = points.len();
        points = drop_needless(space, &points);
        points = merge_turns(space, &points, extra_m);
        if points.len() == before {
            return Path::new(points);
        }
    }
}

/// Leaves out corners that can be driven past directly.
fn drop_needless(space: &ConfigurationSpace, points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut kept: Vec<Point2<f64>> = Vec::with_capacity(points.len());
    for (index, &point) in points.iter().enumerate() {
        if let (Some(&last), Some(&next)) = (kept.last(), points.get(index + 1))
            && space.is_segment_free(last, next)
        {
            continue;
        }
        kept.push(point);
    }
    kept
}

fn merge_turns(space: &ConfigurationSpace, points: &[Point2<f64>], extra_m: f64) -> Vec<Point2<f64>> {
    let mut kept: Vec<Point2<f64>> = Vec::with_capacity(points.len());
    let mut index = 0;
    while let Some(&point) = points.get(index) {
        let merged = match (kept.last(), points.get(index + 1), points.get(index + 2)) {
            (Some(&a), Some(&c), Some(&d)) => meeting_point(a, point, c, d).filter(|&corner| {
                let longer = distance(&a, &corner) + distance(&corner, &d)
                    - distance(&a, &point)
                    - distance(&point, &c)
                    - distance(&c, &d);
                longer <= extra_m && space.is_segment_free(a, corner) && space.is_segment_free(corner, d)
            }),
            _ => None,
        };
        if let Some(corner) = merged {
            kept.push(corner);
            index += 2;
        } else {
            kept.push(point);
            index += 1;
        }
    }
    kept
}

/// Returns where the line from `a` beyond `b` meets the line from `d` beyond `c`, if `b` and `c` turn the same way and
/// the lines meet on that side.
fn meeting_point(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>, d: Point2<f64>) -> Option<Point2<f64>> {
    let (along, middle, back) = (b - a, c - b, c - d);
    let (first, second) = (along.perp(&middle), middle.perp(&-back));
    if first * second <= 0.0 {
        return None;
    }
    let denominator = along.perp(&back);
    let beyond_b = middle.perp(&back) / denominator;
    let beyond_c = middle.perp(&along) / denominator;
    (beyond_b.is_finite() && beyond_b >= 0.0 && beyond_c >= 0.0).then(|| b + along * beyond_b)
}

#[cfg(test)]
mod tests {
    use terrain::{GridFrame, Obstacle, Occupancy};

    use super::*;
    use crate::{PlannerKind, Query, Settings, ShortcutSettings, find_path};

    #[test]
    fn a_path_around_a_disc_keeps_few_corners_and_stays_free() {
        let frame = GridFrame { width: 200, height: 200, cell_size_m: 0.6, origin_m: Point2::origin() };
        let mut occupancy = Occupancy::free(frame);
        let disc = Obstacle::Circle { center_m: Point2::new(60.0, 60.0), radius_m: 25.0 };
        occupancy.mark(&disc, terrain::CellState::Obstacle);
        let space = ConfigurationSpace::new(occupancy, 0.76);
        let query = Query { start_m: Point2::new(10.0, 58.0), goal_m: Point2::new(110.0, 61.0) };
        let settings = Settings { seed: 3, ..Settings::of(PlannerKind::RrtConnect) };
        let found = find_path(&space, query, &settings, Some(&ShortcutSettings::default()), &mut |_| false);
        let path = found.path.expect("there is a way around");
        let simplified = simplify(&space, &path, 0.3);
        let (first, last) = (simplified.points_m.first(), simplified.points_m.last());
        assert_eq!((first, last), (Some(&query.start_m), Some(&query.goal_m)));
        assert!(simplified.segments().all(|(from, to)| space.is_segment_free(from, to)));
        assert!(
            simplified.points_m.len() <= 16,
            "{} corners of {}",
            simplified.points_m.len(),
            path.points_m.len()
        );
        assert!(
            simplified.length_m() <= path.length_m() * 1.03,
            "{} {}",
            simplified.length_m(),
            path.length_m()
        );
    }

    #[test]
    fn lines_that_part_do_not_meet() {
        let [a, b, c, d, e] = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0], [2.0, 2.0]].map(Point2::from);
        assert_eq!(meeting_point(a, b, c, d), None);
        let corner = meeting_point(a, b, c, e).expect("they meet");
        assert!(distance(&corner, &Point2::new(2.0, 0.0)) < 1e-12);
    }
}
