//! Whether two points over the ground see each other: exact over the interpolated surface, without samples.
//!
//! The surface between cell centers is bilinear, and a cell without height, or an obstacle, gives its neighbors theirs
//! (see [`Terrain::height_at`]). So on each quarter of a cell the ground under a straight line is a quadratic of the
//! way along it, whose greatest height over the line has a closed form.

use nalgebra::{Point2, Point3, Vector2};
use serde::{Deserialize, Serialize};

use crate::heightfield::{Patch, Terrain};

/// Whether two places see each other over the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LineOfSight {
    /// Where the ground first rises over the line (east, north, up); `None` if it does so nowhere.
    pub blocked_at_m: Option<Point3<f64>>,
}

/// Ground that is over the line by no more than this many meters only touches it. The error of the arithmetic is a
/// thousandth of that on maps of up to a thousand kilometers.
const TOUCH_M: f64 = 1e-9;

impl Terrain {
    /// Whether a point `heights_m[0]` over the ground at one place and a point `heights_m[1]` over the ground at another
    /// see each other; a line that touches the ground is clear. Declared obstacles and rocks don't count, cells that are
    /// obstacles of the map count with their heights. Where a cell on the way has no height, nothing is in the way.
    ///
    /// `None` if one of the places has no height. Linear in the number of cells on the way.
    pub fn line_of_sight(
        &self,
        from_m: Point2<f64>,
        to_m: Point2<f64>,
        heights_m: [f64; 2],
    ) -> Option<LineOfSight> {
        let first = self.height_at(from_m)? + heights_m[0];
        let last = self.height_at(to_m)? + heights_m[1];
        let line = Line {
            from: self.frame().to_cells(from_m),
            direction: self.frame().to_cells(to_m) - self.frame().to_cells(from_m),
            first,
            rise: last - first,
        };
        let mut quarters = Quarters::new(&line);
        let mut at = 0.0;
        while at < 1.0 {
            let next = quarters.next_border().min(1.0);
            let middle = self.frame().to_meters(line.point(f64::midpoint(at, next)));
            let patch = if next > at { self.bilinear(middle) } else { None };
            if let Some(share) = patch.and_then(|patch| line.first_over(&patch, [at, next])) {
                let place = from_m + (to_m - from_m) * share;
                let blocked_at_m = Some(Point3::new(place.x, place.y, line.height(share)));
                return Some(LineOfSight { blocked_at_m });
            }
            at = next;
        }
        Some(LineOfSight { blocked_at_m: None })
    }
}

/// A straight line through the air, over the plane in cells; places on it are shares of its length.
struct Line {
    from: Point2<f64>,
    direction: Vector2<f64>,
    /// Its height at its first point, in meters.
    first: f64,
    /// How much higher its last point is.
    rise: f64,
}

impl Line {
    fn point(&self, share: f64) -> Point2<f64> {
        self.from + self.direction * share
    }

    fn height(&self, share: f64) -> f64 {
        self.first + self.rise * share
    }

    /// The first share between two at which the ground of `patch`, on which the line is between them, is over the line.
    fn first_over(&self, patch: &Patch, [start, end]: [f64; 2]) -> Option<f64> {
        // The height of the ground over the line is constant + slope·s + bend·s², with s the share beyond `start`.
        let [south_west, south_east, north_west, north_east] = patch.corners;
        let (east, north) = (south_east - south_west, north_west - south_west);
        let twist = north_east - north_west - south_east + south_west;
        let at = self.point(start) - patch.corner;
        let way = self.direction;
        let constant = south_west + east * at.x + north * at.y + twist * at.x * at.y - self.height(start);
        let slope = east * way.x + north * way.y + twist * (at.x * way.y + at.y * way.x) - self.rise;
        let bend = twist * way.x * way.y;
        let length = end - start;
        let over = |s: f64| constant + (slope + bend * s) * s;
        if over(0.0) > TOUCH_M {
            return Some(start);
        }
        let top = -slope / (2.0 * bend);
        let has_top = bend < 0.0 && top > 0.0 && top < length;
        let highest = if has_top { top } else { length };
        if over(highest) <= TOUCH_M {
            return None;
        }
        // It crosses the line once between here and there: the quadratic rises, or begins below and ends above.
        let under_root = (slope * slope - 4.0 * bend * constant).max(0.0).sqrt();
        let share = if slope + under_root > 0.0 {
            -2.0 * constant / (slope + under_root)
        } else {
            (under_root - slope) / (2.0 * bend)
        };
        Some(start + share.clamp(0.0, highest))
    }
}

/// The borders of quarters of cells that a line crosses, in order.
struct Quarters {
    /// For each axis: the share at which the line crosses its next border, and the shares between two borders.
    axes: [(f64, f64); 2],
    crossed: [f64; 2],
}

impl Quarters {
    fn new(line: &Line) -> Self {
        let axis = |axis: usize| {
            let (from, way) = (2.0 * line.from[axis], 2.0 * line.direction[axis]);
            let border = if way > 0.0 { from.floor() + 1.0 } else { from.ceil() - 1.0 };
            if way == 0.0 { (f64::INFINITY, 0.0) } else { ((border - from) / way, 1.0 / way.abs()) }
        };
        Self { axes: [axis(0), axis(1)], crossed: [0.0; 2] }
    }

    /// The share at which the line crosses the next border.
    fn next_border(&mut self) -> f64 {
        let at = |axis: usize| {
            let (first, step) = self.axes[axis];
            // Multiplied instead of added up, so that errors don't grow with the distance.
            if step == 0.0 { f64::INFINITY } else { first + step * self.crossed[axis] }
        };
        let axis = usize::from(at(1) < at(0));
        let border = at(axis);
        self.crossed[axis] += 1.0;
        border
    }
}
