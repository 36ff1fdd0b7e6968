//! The map that vehicles share: what their range finders have seen that the mission's map does not show (SPEC 15).

use std::collections::BTreeMap;

use super::way::distance_to;
use nalgebra::{Point2, distance_squared};

/// Points that were seen, and when, in mission units: at most one in each square.
#[derive(Clone, Debug, Default)]
pub(super) struct SeenMap {
    points: BTreeMap<(i64, i64), (Point2<f64>, f64)>,
}

/// The side of a square in meters.
const SQUARE_M: f64 = 0.25;

impl SeenMap {
    /// Puts a point on the map, unless something was seen there before.
    pub(super) fn add(&mut self, point: Point2<f64>, time: f64) {
        let square = point.map(|value| (value / SQUARE_M).floor() as i64);
        let known = self.points.entry((square.x, square.y)).or_insert((point, time));
        if time < known.1 {
            *known = (point, time);
        }
    }

    /// Takes in what another map shows.
    pub(super) fn extend(&mut self, other: Self) {
        for (point, time) in other.points.into_values() {
            self.add(point, time);
        }
    }

    /// Returns what was seen by a time.
    pub(super) fn known_at(&self, time: f64) -> Vec<Point2<f64>> {
        self.points.values().filter(|(_, seen)| *seen <= time).map(|&(point, _)| point).collect()
    }

    /// Takes away what was seen after a time: by vehicles that stopped before.
    pub(super) fn forget_after(&mut self, time: f64) {
        self.points.retain(|_, (_, seen)| *seen <= time);
    }
}

/// Returns whether a disc that goes along a way comes nearer than `reach` meters to a point. Where it starts and ends
/// it has to be.
pub(super) fn is_blocked(way: &[Point2<f64>], points: &[Point2<f64>], reach: f64) -> bool {
    let (Some(first), Some(last)) = (way.first(), way.last()) else { return false };
    let is_at_end =
        |point: &&Point2<f64>| [first, last].iter().any(|end| distance_squared(end, point) <= reach * reach);
    let points: Vec<&Point2<f64>> = points.iter().filter(|point| !is_at_end(point)).collect();
    way.windows(2).any(|pair| {
        let is_near = |point: &&Point2<f64>| distance_to([pair[0], pair[1]], **point) < reach;
        points.iter().any(is_near)
    })
}
