//! Maps of rectangles, an exact check of paths that shares nothing with the planners, and the shortest path there is.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use terrain::{ConfigurationSpace, GridFrame, Occupancy};
use tpn::generate::Rng;

/// Cells in a row and in a column.
pub(crate) const SIZE: usize = 512;
/// Where all paths start and end, in cells.
pub(crate) const ENDS: [[f64; 2]; 2] = [[8.0, 8.0], [503.0, 503.0]];
/// Keeps the reference path off the corners of obstacles, which belong to them.
const CORNER_GAP: f64 = 1e-3;

/// A map; row 0 is the southern one.
pub(crate) struct Map {
    pub(crate) occupied: Vec<bool>,
    pub(crate) space: ConfigurationSpace,
}

impl Map {
    /// Rectangles on a fifth of the map, none near its south-west and north-east corner, and a way between these.
    pub(crate) fn generated(seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        loop {
            let mut occupied = vec![false; SIZE * SIZE];
            let mut count = 0;
            while count < SIZE * SIZE / 5 {
                let (width, height) = (rng.between(8, 44) as usize, rng.between(8, 44) as usize);
                let (left, low) =
                    (rng.below((SIZE - width) as u64) as usize, rng.below((SIZE - height) as u64) as usize);
                let is_near = |corner: f64| {
                    let reaches = |from: usize, length: usize| {
                        (from as f64) < corner + 16.0 && (from + length) as f64 > corner - 16.0
                    };
                    reaches(left, width) && reaches(low, height)
                };
                if is_near(ENDS[0][0]) || is_near(ENDS[1][0]) {
                    continue;
                }
                for row in low..low + height {
                    for cell in &mut occupied[row * SIZE + left..row * SIZE + left + width] {
                        count += usize::from(!std::mem::replace(cell, true));
                    }
                }
            }
            let frame = GridFrame::new(SIZE as u32, SIZE as u32, 1.0);
            let space = ConfigurationSpace::new(Occupancy::from_obstacles(frame, &occupied), 0.0);
            if !space.are_separated(ENDS[0].into(), ENDS[1].into()) {
                return Self { occupied, space };
            }
        }
    }

    /// The map as a PGM picture whose first row is the southern one: 0 is occupied.
    pub(crate) fn pgm(&self) -> Vec<u8> {
        let mut bytes = format!("P5\n{SIZE} {SIZE}\n255\n").into_bytes();
        bytes.extend(self.occupied.iter().map(|&occupied| if occupied { 0 } else { 255 }));
        bytes
    }

    fn is_occupied(&self, column: i64, row: i64) -> bool {
        let inside = |at: i64| (0..SIZE as i64).contains(&at);
        inside(column) && inside(row) && self.occupied[row as usize * SIZE + column as usize]
    }

    /// Returns whether a path passes through the inside of an occupied cell, by more than a millionth of it.
    pub(crate) fn cuts(&self, path: &[[f64; 2]]) -> bool {
        path.windows(2).any(|ends| self.segment_cuts(ends[0], ends[1]))
    }

    fn segment_cuts(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let low = [a[0].min(b[0]), a[1].min(b[1])].map(|value| value.floor() as i64);
        let high = [a[0].max(b[0]), a[1].max(b[1])].map(|value| value.floor() as i64);
        let slope = (b[0] - a[0]) / (b[1] - a[1]);
        (low[1]..=high[1]).any(|row| {
            // The columns that the segment passes within the row, and one more on each side.
            let at = |y: f64| a[0] + slope * (y.clamp(a[1].min(b[1]), a[1].max(b[1])) - a[1]);
            let (left, right) = if slope.is_finite() {
                let ends = [at(row as f64), at(row as f64 + 1.0)];
                (ends[0].min(ends[1]).floor() as i64 - 1, ends[0].max(ends[1]).floor() as i64 + 1)
            } else {
                (low[0], high[0])
            };
            (left.max(low[0])..=right.min(high[0]))
                .any(|column| self.is_occupied(column, row) && passes(a, b, [column as f64, row as f64]))
        })
    }

    /// The length of the shortest path: A* from corner to corner of the obstacles in sight of each other.
    pub(crate) fn shortest(&self) -> f64 {
        let mut points = ENDS.to_vec();
        for row in 0..=SIZE as i64 {
            for column in 0..=SIZE as i64 {
                // A convex corner has one of its four cells occupied; the point is moved a little into the free ones.
                for (dx, dy) in [(0, 0), (-1, 0), (0, -1), (-1, -1)] {
                    let (beside, above) = (-1 - dx, -1 - dy);
                    if self.is_occupied(column + dx, row + dy)
                        && !self.is_occupied(column + beside, row + dy)
                        && !self.is_occupied(column + dx, row + above)
                    {
                        let away = |inside: i64| if inside == 0 { -CORNER_GAP } else { CORNER_GAP };
                        let point = [column as f64 + away(dx), row as f64 + away(dy)];
                        let is_inside = point.iter().all(|&value| value > 0.0 && value < SIZE as f64);
                        if is_inside && !self.is_occupied(column + beside, row + above) {
                            points.push(point);
                        }
                    }
                }
            }
        }
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let mut costs = vec![f64::INFINITY; points.len()];
        let mut done = vec![false; points.len()];
        costs[0] = 0.0;
        // Non-negative numbers order as their bits do.
        let mut open = BinaryHeap::from([(Reverse(0_u64), 0)]);
        while let Some((_, at)) = open.pop() {
            if at == 1 {
                return costs[1];
            }
            if std::mem::replace(&mut done[at], true) {
                continue;
            }
            for next in 0..points.len() {
                let cost = costs[at] + distance(points[at], points[next]);
                if !done[next] && cost < costs[next] && !self.segment_cuts(points[at], points[next]) {
                    costs[next] = cost;
                    open.push((Reverse((cost + distance(points[next], points[1])).to_bits()), next));
                }
            }
        }
        f64::INFINITY
    }
}

/// Returns whether a segment passes through the inside of the unit square whose lower left corner is given.
fn passes(a: [f64; 2], b: [f64; 2], low: [f64; 2]) -> bool {
    const INSET: f64 = 1e-6;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let along = b[axis] - a[axis];
        let (from, to) = (low[axis] + INSET - a[axis], low[axis] + 1.0 - INSET - a[axis]);
        if along == 0.0 {
            if from > 0.0 || to < 0.0 {
                return false;
            }
        } else {
            let (first, second) = (from / along, to / along);
            enter = enter.max(first.min(second));
            leave = leave.min(first.max(second));
        }
    }
    enter < leave
}
